/* dis/capture/recorder.h: writes datagrams to a capture file: pcapng (or pcap where the name ends so), nanoseconds, raw
 * IP headers generated from the known addresses. dis_log_open reads back the same octets and times. */
#ifndef DIS_CAPTURE_RECORDER_H
#define DIS_CAPTURE_RECORDER_H

#include "dis/pdu/pdu.h"

typedef struct DisRecorder DisRecorder;

enum { dis_recorder_ipv4_octets = 65507, dis_recorder_ipv6_octets = 65527 }; /* most octets of a datagram */

/* Whether a recording may have this name: it ends with .pcapng or .pcap, or has no ending, as /dev/stdout. If not, that
 * is logged. what: the option or key that names it. */
bool dis_recorder_name(const char *what, const char *path);
/* comment: of the section, e.g. what made it; may be NULL; pcap has no place for it. STATUS_IO, logged with the path;
 * the beginning of the file is written by then, so a place that takes nothing is known at once. The folder must exist.
 * An older recording of that name stays as it is until the first datagram or note, or begin, takes its place. */
Status dis_recorder_open(DisRecorder **out, const char *path, const char *comment);
Status dis_recorder_begin(DisRecorder *recorder);
/* Whether the file is this recording's; false while an older one is still there. */
bool dis_recorder_begun(const DisRecorder *recorder);
/* Destination of the datagrams, by which a reader filters. Default: the broadcast of loopback, or ff02::1, port 3000.
 * to: IPv4 as ::ffff:a.b.c.d; NULL: the default. A sender of the other family keeps its previous address. */
void dis_recorder_to(DisRecorder *recorder, const uint8_t to[16], uint16_t port);
/* capture_ns: Unix time. from, port: of the sender; IPv4 as ::ffff:a.b.c.d, else IPv6; NULL: loopback.
 * STATUS_BAD_VALUE, and nothing is written: more octets than IP carries, a time before 1970 (pcap: after 2106).
 * Buffered. The first failure of the disk is logged; every later call returns STATUS_IO without a word. */
Status dis_recorder_add(DisRecorder *recorder, int64_t capture_ns, const uint8_t from[16], uint16_t port,
                        const uint8_t *bytes, size_t octets);
/* A note among the datagrams, in one line, as the comment of a block of its own (interface statistics): dis_log_open
 * gives all of them as DisLog.notes. STATUS_UNSUPPORTED: pcap has no place for it. */
Status dis_recorder_note(DisRecorder *recorder, int64_t capture_ns, const char *text);
/* Hands buffered octets to the system, so that a recording is whole even when the program is killed. */
Status dis_recorder_flush(DisRecorder *recorder);
/* Accepts NULL. Returns STATUS_IO when anything was not written. */
Status dis_recorder_close(DisRecorder *recorder);

#endif
