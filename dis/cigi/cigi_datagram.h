/* dis/cigi/cigi_datagram.h: the packets of a CIGI datagram, read and written, and what is wrong with them. */
#ifndef DIS_CIGI_CIGI_DATAGRAM_H
#define DIS_CIGI_CIGI_DATAGRAM_H

#include "dis/cigi/cigi.h"

/* Why octets were dropped. */
typedef enum CigiDrop {
    CIGI_DROP_SHORT,      /* fewer octets than the first packet needs */
    CIGI_DROP_FIRST,      /* the first packet is neither IG Control nor Start of Frame, as the sender's must be */
    CIGI_DROP_VERSION,    /* not of CIGI 3 */
    CIGI_DROP_MAGIC,      /* the byte swap magic number is neither 0x8000 nor 0x0080 */
    CIGI_DROP_SIZE,       /* a size that is 0 or no multiple of 8: what follows in the datagram is lost */
    CIGI_DROP_SIZE_LONG,  /* a size beyond the datagram: likewise */
    CIGI_DROP_SIZE_SHORT, /* a size below what its packet needs: the packet is skipped */
    CIGI_DROP_NOT_FINITE, /* a packet with NaN or infinity in a field: skipped */
    CIGI_DROP_SECOND,     /* another IG Control or Start of Frame in a datagram: skipped */
    CIGI_DROP_COUNT
} CigiDrop;

const char *cigi_drop_name(CigiDrop drop);  /* in run.json */
const char *cigi_drop_cause(CigiDrop drop); /* a few words for people */
const char *cigi_packet_name(uint8_t id);   /* `Entity Control`; `unknown packet` */

typedef struct CigiCounters {
    uint64_t datagrams;    /* those whose first packet is right */
    uint64_t packets[256]; /* read, by id */
    uint64_t skipped[256]; /* well-formed packets that this program does not read, by id */
    uint64_t dropped[CIGI_DROP_COUNT];
} CigiCounters;

typedef enum CigiSender { CIGI_FROM_HOST, CIGI_FROM_IG } CigiSender;

/* The packets of one datagram, whose octets are the caller's. */
typedef struct CigiReader {
    const uint8_t *at, *end;
    CigiOrder      order;
    CigiSender     sender;
} CigiReader;

/* Reads the first packet: IG Control of a host, Start of Frame of an IG. STATUS_TRUNCATED, STATUS_BAD_VALUE, or
 * STATUS_UNSUPPORTED for another version of CIGI: counted by reason, and nothing of the datagram is to be used. Nothing
 * is logged. counters is added to. */
Status cigi_open(CigiReader *out, CigiPacket *first, CigiCounters *counters, const uint8_t *datagram, size_t octets,
                 CigiSender sender);
/* The next packet of those above that a sender of its kind sends; others are skipped by their size, and counted. False:
 * there is none. Of a packet that is longer than its layout what follows is not read. */
bool cigi_next(CigiPacket *out, CigiReader *reader, CigiCounters *counters);

/* Writes one packet, with the version, size and magic number of 3.3 whatever the struct says. Returns its octets; 0:
 * capacity is too small, or the id is none of the above. A value that is wider than its bits is cut. */
size_t cigi_write(uint8_t *out, size_t capacity, const CigiPacket *packet, CigiOrder order);

#endif
