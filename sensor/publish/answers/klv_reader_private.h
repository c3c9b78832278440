/* sensor/publish/answers/klv_reader_private.h: tag, length, value (SMPTE ST 336) out of octets of others. It never
 * reads beyond their end, and remembers what was wrong: read all, then ask once. */
#ifndef SENSOR_PUBLISH_ANSWERS_KLV_READER_PRIVATE_H
#define SENSOR_PUBLISH_ANSWERS_KLV_READER_PRIVATE_H

#include "pitviper.h"

#include <math.h>

typedef struct KlvReader {
    const uint8_t *at, *end;
    bool           broken;
} KlvReader;

/* at: NULL where there is no such item. */
typedef struct KlvItem {
    const uint8_t *at;
    size_t         count;
} KlvItem;

/* Of an item; there need be none. */
static inline KlvReader klv_reader(KlvItem item)
{
    return (KlvReader){item.at, item.at ? item.at + item.count : NULL, false};
}

/* BER-OID below 2^63: tags and ids. */
static inline uint64_t klv_read_oid(KlvReader *r)
{
    uint64_t value = 0;
    for (int octets = 0; octets < 9 && r->at < r->end; octets++) {
        const uint8_t octet = *r->at++;
        value = value << 7 | (octet & 0x7F);
        if (octet < 0x80) return value;
    }
    r->broken = true;
    return 0;
}

/* A BER length, short or in up to four octets, and so many octets behind it. */
static inline KlvItem klv_read_value(KlvReader *r)
{
    size_t length = 0;
    if (!r->broken && r->at < r->end) {
        length = *r->at++;
        if (length >= 0x80) {
            int octets = (int)(length & 0x7F);
            r->broken |= octets < 1 || octets > 4 || octets > r->end - r->at;
            for (length = 0; !r->broken && octets > 0; octets--) length = length << 8 | *r->at++;
        }
    } else {
        r->broken = true;
    }
    if (r->broken || length > (size_t)(r->end - r->at)) {
        r->broken = true;
        return (KlvItem){NULL, 0};
    }
    const KlvItem item = {r->at, length};
    r->at += length;
    return item;
}

/* Finds the items of these tags in a local set; the others are passed over, as the standard has it. False: the set is
 * broken, or has one of them twice. */
static inline bool klv_read_set(KlvItem *out, const unsigned *tag, int tags, KlvItem set)
{
    KlvReader r = klv_reader(set);
    for (int i = 0; i < tags; i++) out[i] = (KlvItem){NULL, 0};
    while (r.at < r.end && !r.broken) {
        const uint64_t found = klv_read_oid(&r);
        const KlvItem  item = klv_read_value(&r);
        for (int i = 0; i < tags && !r.broken; i++) {
            if (tag[i] != found) continue;
            r.broken |= out[i].at != NULL;
            out[i] = item;
        }
    }
    return !r.broken;
}

/* An unsigned number of 1 to `most` octets; where there is no item, out keeps its value. False: of another length. */
static inline bool klv_read_number(uint64_t *out, KlvItem item, size_t most)
{
    if (!item.at) return true;
    if (item.count < 1 || item.count > most) return false;
    *out = 0;
    for (size_t i = 0; i < item.count; i++) *out = *out << 8 | item.at[i];
    return true;
}

/* IMAPB(low, high, octets) of ST 1201.5. NaN: one of its special values, or beyond the range. */
static inline double klv_read_imapb(const uint8_t *at, int octets, double low, double high)
{
    const double scale = ldexp(1, 8 * octets - 1 - (int)ceil(log2(high - low)));
    const double zero = low < 0 && high > 0 ? scale * low - floor(scale * low) : 0;
    uint64_t     value = 0;
    for (int i = 0; i < octets; i++) value = value << 8 | at[i];
    const double x = ((double)value - zero) / scale + low;
    return x >= low - 1 / scale && x <= high + 1 / scale ? clamp(x, low, high) : NAN;
}

#endif
