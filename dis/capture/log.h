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

/* Datagrams of up to so many octets in all are in memory; of the rest 32 octets each are, and they are read from the
 * file, or, where that is compressed or a pipe, from a scratch file in $TMPDIR. */
enum { dis_log_in_memory = 32 << 20 };
/* What a compressed file expands to: at most so many times what was read, and so many octets beyond it. */
enum { dis_stream_ratio_most = 256, dis_stream_free_octets = 1 << 24 };

typedef struct DisDatagram {
    double   capture_s; /* Unix time: dis_unix_s */
    double   packet_s;  /* the same as in the file, where dis_log_retime made another */
    uint32_t packet;    /* 1-based number of the packet in the file, as tshark's frame.number. With
                         * dis_datagram_on_disk: of a large log, whose datagrams dis_log_datagram reads */
    uint32_t octets;
    union {
        const uint8_t *bytes; /* owned by the log */
        uint64_t       at;    /* on disk */
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
    int                count;
    DisDatagram       *datagram; /* in file order */
    DisLogCounters     counters;
    bool               truncated; /* the file ended inside a packet; what came before is here */
    bool               retimed;   /* packet times did not keep pace with the stamps: made from these */
    const char        *notes;     /* of dis_recorder_note, a line each; empty: none; NULL: not of a file */
    bool               any_port;  /* datagrams of any port were taken */
    void              *storage;
    struct DisLogFile *file; /* of datagrams on disk; NULL: none */
} DisLog;

/* port: of the UDP destination. dis_port_any: every port, payloads that start with a DIS header.
 * dis_port_default: 3000, and when no datagram went there, any port (sets any_port). A file that is not
 * a capture, or cannot be read: a logged reason and the status. A truncated file: STATUS_OK, `truncated` set, a
 * warning. */
Status dis_log_open(DisLog *out, const char *path, int port);
/* The same, the file being read once. read: gets all of its octets in order, for a hash. */
typedef void DisLogRead(void *user, const void *octets, size_t count);
Status       dis_log_open_read(DisLog *out, const char *path, int port, DisLogRead *read, void *user);
void         dis_log_close(DisLog *log);

/* Datagram i with its octets, which are valid until the next call but one; one thread at a time. One that cannot be
 * read any more has none, see dis_log_failed. */
DisDatagram dis_log_datagram(const DisLog *log, int i);
/* Whether a datagram could not be read, which was logged. */
bool dis_log_failed(const DisLog *log);

/* dis_log_open does this. Packet times that run at another rate than the stamps of the sender with the most PDUs are
 * replaced by these, from the first packet on, in file order; true when they were. Stamps are used when
 * they step like a clock (-1 .. 120 s), span 5 s or more, and are not 20 times slower than the packets. */
bool dis_log_retime(DisLog *log);

/* ---- times ------------------------------------------------------------------------------------ */

/* Exercise times of all PDUs of a recording, each by what the whole recording tells of its sender's clock. */

typedef struct DisLogTimes {
    ExerciseInstant *pdu; /* [count]: of every PDU of dis_next_pdu, in its order, that is of the exercise; t_s NaN
                           * for one that names no sender */
    size_t                 count;
    ExerciseClockAnomalies doubts;
} DisLogTimes;

/* exercise: only this id; -1: all. */
Status dis_log_times(DisLogTimes *out, const DisLog *log, int exercise);
void   dis_log_times_release(DisLogTimes *times);

/* ---- octets on disk --------------------------------------------------------------------------- */

/* Octets of a large log that stay on disk: in its file, or, where that is compressed or a pipe, in a scratch file
 * without a name. A few windows of it are in memory. */
typedef struct DisLogFile DisLogFile;

enum { dis_log_file_most = 65536 }; /* octets of one look-up; a datagram has fewer */

/* Octets at a place: an offset in the log, or of dis_log_file_keep. Valid until the next call but one; one thread at a
 * time. NULL: they cannot be read any more, which is logged once. */
const uint8_t *dis_log_file_octets(DisLogFile *file, uint64_t at, size_t octets);
#endif
