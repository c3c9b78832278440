/* dis/log_pcap.h: the packets of a capture file one after the other: pcap and pcapng, compressed or not.
 *
 * pcap in either byte order, stamps in micro- or nanoseconds, and the form with longer packet headers that patched
 * libpcaps wrote. pcapng with any number of sections, each in its own byte order, and of interfaces, each with its own
 * link layer, resolution and offset of time. */
#ifndef DIS_LOG_PCAP_H
#define DIS_LOG_PCAP_H

#include "dis/log_stream.h"

typedef struct DisCapture DisCapture;

typedef struct DisCapturePacket {
    double         capture_s; /* Unix time: dis_unix_s; no sooner than 1970, no later than 2255 */
    int            link;      /* LINKTYPE_ of its interface */
    size_t         octets;    /* captured, of at most 256 KiB */
    const uint8_t *bytes;     /* until the next packet */
    uint64_t       at;        /* offset of bytes in the file; UINT64_MAX: it is compressed, or a pipe */
} DisCapturePacket;

/* A file that is no capture, or cannot be read: a logged reason and the status. */
Status dis_capture_open(DisCapture **out, const char *path);
/* tap: as dis_stream_open_tapped has it; dis_capture_drain: reads the rest of the file for it. */
Status dis_capture_open_tapped(DisCapture **out, const char *path, DisStreamTap *tap, void *user);
void   dis_capture_drain(DisCapture *capture);
int    dis_capture_file(const DisCapture *capture); /* its descriptor */
void   dis_capture_close(DisCapture *capture);

/* False: no more, because the file ends or because of an error, see dis_capture_problem. */
bool        dis_capture_next(DisCapturePacket *out, DisCapture *capture);
const char *dis_capture_problem(const DisCapture *capture); /* NULL: the file ended as it should */
/* STATUS_OK, also where the file is cut or damaged; else what was read must not be used. */
Status      dis_capture_status(const DisCapture *capture);
/* Comments of its blocks of interface statistics so far, a line each; those beyond 16 MiB in all are left out. */
const char *dis_capture_notes(const DisCapture *capture);
/* Of interface i of the present section; -1: there is none. */
int         dis_capture_link(const DisCapture *capture, int i);

#endif
