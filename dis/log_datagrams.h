/* dis/log_datagrams.h: the datagrams of a capture, and the number of packets without one. */
#ifndef DIS_LOG_DATAGRAMS_H
#define DIS_LOG_DATAGRAMS_H

#include "pitviper.h"

enum { dis_port_any = 0, dis_port_default = -1 };

/* Datagrams of up to so many octets in all are in memory; of the rest 32 octets each are, and they are read from the file,
 * or, where that is compressed or a pipe, from a scratch file in $TMPDIR. */
enum { dis_log_in_memory = 32 << 20 };

typedef struct DisDatagram {
    double         capture_s;  /* Unix time: dis_unix_s */
    double         packet_s;   /* the same as in the file, where dis_log_retime made another */
    uint32_t       packet;     /* 1-based number of the packet in the file, as tshark's frame.number. With
                                * dis_datagram_on_disk: of a large log, whose datagrams dis_log_datagram reads */
    uint32_t       octets;
    union {
        const uint8_t *bytes;  /* owned by the log */
        uint64_t       at;     /* on disk */
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
    bool           retimed;   /* packet times did not keep pace with the stamps: made from these */
    const char    *notes;     /* of dis_recorder_note, a line each; empty: none; NULL: not of a file */
    bool           any_port;  /* datagrams of any port were taken */
    void          *storage;
    struct DisLogFile *file; /* of datagrams on disk; NULL: none */
} DisLog;

#endif
