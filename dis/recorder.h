/* dis/recorder.h: datagrams into a capture file: pcapng (or pcap where the name ends so), nanoseconds, raw IP headers
 * made up from what is known of the sender. What dis_log_open reads again has the same octets and times. */
#ifndef DIS_RECORDER_H
#define DIS_RECORDER_H

#include "dis/pdu.h"

typedef struct DisRecorder DisRecorder;

/* comment: of the section, e.g. what made it; may be NULL; pcap has no place for it. STATUS_IO, logged with the path.
 * The folder must exist. A file that is there already is replaced. */
Status dis_recorder_open(DisRecorder **out, const char *path, const char *comment);
/* from: IPv4 as ::ffff:a.b.c.d, NULL: loopback. IPv4 or IPv6 by what it is; sent to the loopback broadcast or ff02::1.
 * octets <= 65507. Buffered. The first failure is logged; every later call returns STATUS_IO without a word. */
Status dis_recorder_add(DisRecorder *recorder, int64_t capture_ns, const uint8_t from[16], uint16_t port,
                        const uint8_t *bytes, size_t octets);
/* To the disk, so that what a killed program had recorded is whole. */
Status dis_recorder_flush(DisRecorder *recorder);
/* NULL is fine. STATUS_IO when anything was not written. */
Status dis_recorder_close(DisRecorder *recorder);

#endif
