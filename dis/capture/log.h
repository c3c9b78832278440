/* dis/capture/log.h: a recorded exercise: the datagrams of a pcap or pcapng file, compressed or not (log_stream.c),
 * with one link layer or one for each interface.
 *
 * Link layers: Ethernet (with any VLAN tags), Linux cooked v1 and v2, BSD loopback, raw IP. IPv4 with
 * fragments put together again (bounded), IPv6 with extension headers; UDP to `port`. */
#ifndef DIS_CAPTURE_LOG_H
#define DIS_CAPTURE_LOG_H

#include "dis/clock/exercise_clock.h"
#include "dis/pdu/pdu.h"

enum { dis_port_any = 0, dis_port_default = -1 };

/* The octets of datagrams stay in memory up to so many in all. Of each further datagram 32 octets are in memory; the
 * rest is read again from the file, or, where that is compressed or a pipe, from a scratch file in $TMPDIR. */
enum { dis_log_in_memory = 32 << 20 };
/* Limits of what a compressed file expands to: this many times the octets read, and this many octets more. */
enum { dis_stream_ratio_most = 256, dis_stream_free_octets = 1 << 24 };

typedef struct DisDatagram {
    double capture_s; /* Unix time, as dis_unix_s gives it */
    double
        packet_s; /* the packet's time in the file, which differs from capture_s where dis_log_retime replaced that */
    uint32_t packet; /* 1-based number of the packet in the file, as tshark's frame.number. The bit dis_datagram_on_disk
                        is set where dis_log_datagram must read the octets from disk */
    uint32_t octets;
    union {
        const uint8_t *bytes; /* owned by the log */
        uint64_t       at;    /* place of the octets on disk */
    };
} DisDatagram;

static const uint32_t dis_datagram_on_disk = (uint32_t)1 << 31;

/* Packets that gave no datagram, by reason. */
typedef struct DisLogCounters {
    uint64_t packets, other_link, other_protocol, other_port, cut_short, bad_fragment;
} DisLogCounters;

static inline uint64_t dis_log_dropped(const DisLogCounters *c)
{
    return c->other_link + c->other_protocol + c->other_port + c->cut_short + c->bad_fragment;
}

typedef struct DisLog {
    int            count;
    DisDatagram   *datagram; /* in file order */
    DisLogCounters counters;
    bool           truncated; /* the file ended inside a packet; what came before is here */
    bool           retimed;   /* capture_s was computed from stamps, since packet times did not keep pace with them */
    const char
         *notes;    /* notes written by dis_recorder_note, one a line; empty: none; NULL: the log is not from a file */
    bool  any_port; /* datagrams of any port were taken */
    void *storage;
    struct DisLogFile *file; /* file that holds the datagrams on disk; NULL: there are none */
} DisLog;

/* port: which UDP destination port is read. dis_port_any: every port, for payloads that start with a DIS header.
 * dis_port_default: 3000, or any port when no datagram went to 3000 (any_port is then set). A file that is not a
 * capture, or cannot be read, gives an error status and a logged reason. A truncated file gives STATUS_OK, `truncated`
 * set, and a warning. */
Status dis_log_open(DisLog *out, const char *path, int port);
/* As dis_log_open, and gives all octets of the file in order to `read`, for a hash; the file is read once. */
typedef void DisLogRead(void *user, const void *octets, size_t count);
Status       dis_log_open_read(DisLog *out, const char *path, int port, DisLogRead *read, void *user);
void         dis_log_close(DisLog *log);

/* Datagram i with its octets, which are valid until the next call but one; one thread at a time. A datagram that cannot
 * be read any more has no octets, see dis_log_failed. */
DisDatagram dis_log_datagram(const DisLog *log, int i);
/* Whether a datagram could not be read, which was logged. */
bool dis_log_failed(const DisLog *log);

/* Replaces packet times that run at another rate than the stamps of the sender with the most PDUs by times made from
 * these stamps, from the first packet on, in file order; returns true when it did. Stamps are used when they step like
 * a clock (-1 .. 120 s), span 5 s or more, and are not 20 times slower than the packets. dis_log_open calls this. */
bool dis_log_retime(DisLog *log);

/* ---- times ------------------------------------------------------------------------------------ */

/* Exercise times of all PDUs of a recording, each by what the whole recording tells of its sender's clock. */

typedef struct DisLogTimes {
    ExerciseInstant *pdu; /* [count], for each PDU that dis_next_pdu returns in order and that is of the exercise; t_s
                             is NaN where the PDU names no sender */
    size_t                 count;
    ExerciseClockAnomalies doubts;
} DisLogTimes;

/* exercise: only PDUs with this exercise id; -1: all. */
Status dis_log_times(DisLogTimes *out, const DisLog *log, int exercise);
void   dis_log_times_release(DisLogTimes *times);

/* ---- octets on disk --------------------------------------------------------------------------- */

/* Octets of a large log that stay on disk: in its file, or, where that is compressed or a pipe, in a scratch file
 * without a name. A few windows of it are in memory. */
typedef struct DisLogFile DisLogFile;

enum { dis_log_file_most = 65536 }; /* most octets of one look-up; a datagram has fewer */

/* Octets at a place, which is an offset in the log or was set by dis_log_file_keep. They are valid until the next call
 * but one; one thread at a time. NULL: they cannot be read any more, which is logged once. */
const uint8_t *dis_log_file_octets(DisLogFile *file, uint64_t at, size_t octets);
#endif
