/* sensor/publish/klv/klv_writer_private.h: tag, length, value (SMPTE ST 336) into a buffer that is never exceeded, and
 * the number formats of ST 0601 (linear) and ST 1201 (IMAPB). */
#ifndef SENSOR_PUBLISH_KLV_KLV_WRITER_PRIVATE_H
#define SENSOR_PUBLISH_KLV_KLV_WRITER_PRIVATE_H

#include "pitviper.h"

/* What does not fit is not written and sets full; nothing is written after it. */
typedef struct KlvWriter {
    uint8_t *octet;
    size_t   used, room;
    bool     full;
} KlvWriter;

void klv_put(KlvWriter *w, const void *octets, size_t count);
/* Puts the low `octets` octets, big-endian. */
void klv_put_number(KlvWriter *w, uint64_t value, int octets);
/* Puts a BER length: one octet below 128, else the long form. */
void klv_put_length(KlvWriter *w, size_t length);
/* BER-OID: seven bits an octet, the most significant first. Local set tags, target and algorithm ids. */
void klv_put_oid(KlvWriter *w, uint64_t value);

/* One item of a local set. */
void klv_item(KlvWriter *w, unsigned tag, const void *octets, size_t count);
void klv_item_number(KlvWriter *w, unsigned tag, uint64_t value, int octets);
/* Puts a number in as few octets as it needs, at least one. */
void klv_item_short(KlvWriter *w, unsigned tag, uint64_t value);
/* Puts printable ASCII, at most `most` long; other octets are left out, and blanks at either end. Nothing is put for
 * NULL or an empty text. */
void klv_item_text(KlvWriter *w, unsigned tag, const char *text, size_t most);

/* Linear maps of ST 0601: low .. high onto all values of an unsigned integer; -high .. high onto those of a signed one
 * without its lowest, which is the standard's error indicator. Rounded to the nearest step. Nothing is written for NaN
 * and for values outside the range: an absent item is unknown, a clamped one would be wrong. */
void klv_item_unsigned(KlvWriter *w, unsigned tag, int octets, double low, double high, double value);
void klv_item_signed(KlvWriter *w, unsigned tag, int octets, double high, double value);
/* Puts IMAPB(low, high, octets) of ST 1201.5, by the same rule. */
void klv_item_imapb(KlvWriter *w, unsigned tag, int octets, double low, double high, double value);
/* Puts the same without tag and length; low <= value <= high. */
void klv_put_imapb(KlvWriter *w, int octets, double low, double high, double value);

/* Computes the 16-bit sum of ST 0601 and ST 0903. */
uint16_t klv_checksum(const uint8_t *octets, size_t count);

#endif
