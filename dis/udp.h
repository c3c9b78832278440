/* dis/udp.h: DIS datagrams over UDP: unicast, broadcast or multicast, IPv4 or IPv6, on a chosen interface.
 *
 * A thread of its own takes datagrams off the socket as they come, so that nobody who is busy loses any; what it took
 * waits in a bounded queue. Arrival times are the kernel's, non-decreasing, whole nanoseconds. */
#ifndef DIS_UDP_H
#define DIS_UDP_H

#include "dis/pdu.h"

enum { dis_udp_address_size = 64, dis_max_datagram = 65535, dis_udp_error_size = 160 };

/* Where to listen and to send. */
typedef struct DisUdpConfig {
    char address[dis_udp_address_size];   /* IPv4 or IPv6, numeric: of a host, a broadcast or a multicast group (which is
                                           * joined); empty: listen on all, send to 255.255.255.255 */
    char interface[32];                   /* name, `eth0`; empty: the system's choice */
    int  port;                            /* 1 .. 65535 */
    int  ttl;                             /* hops of multicast, 0 .. 255; 0: this machine alone */
    int  queue_octets;                    /* most that waits to be taken; beyond: the oldest stay, new ones are counted lost */
} DisUdpConfig;

DisUdpConfig dis_udp_default_config(void);

typedef struct DisUdpCounters {
    uint64_t datagrams, octets;
    uint64_t lost_kernel;  /* the kernel's own count (SO_RXQ_OVFL) */
    uint64_t lost_queue;   /* nobody took them in time */
    uint64_t sent, send_failed;
} DisUdpCounters;

typedef struct DisUdp DisUdp;

/* One datagram as taken; bytes are the taker's until its next take. */
typedef struct DisArrival {
    int64_t        capture_ns;    /* Unix time */
    uint32_t       octets;
    const uint8_t *bytes;
    uint8_t        from[16];      /* IPv4 as ::ffff:a.b.c.d */
    uint16_t       from_port;
} DisArrival;

/* STATUS_BAD_VALUE or STATUS_IO with one logged line that names address, port or interface, why, and what to do next. */
Status dis_udp_open(DisUdp **out, const DisUdpConfig *config);   /* listens, and may send */
Status dis_udp_open_sender(DisUdp **out, const DisUdpConfig *config); /* sends only: no port is bound */
void   dis_udp_close(DisUdp *udp);

/* Everything that arrived up to now waits to be taken: after this has returned, no datagram will come out of
 * dis_udp_take with an arrival time at or before until_ns. What the kernel stamped so early and arrives later is given
 * until_ns + 1. That is how a live node closes a frame's tick, and why its recording replays to the same bits. */
void   dis_udp_close_tick(DisUdp *udp, int64_t until_ns);
/* The next in order of arrival, not after until_ns (INT64_MAX: any). False when none waits. */
bool   dis_udp_take(DisArrival *out, DisUdp *udp, int64_t until_ns);
/* Waits until something waits to be taken or the Unix time until_ns has come; true for the former. */
bool   dis_udp_wait(DisUdp *udp, int64_t until_ns);
/* A full or missing network is counted, never fatal: STATUS_IO then. Thread-safe. */
Status dis_udp_send(DisUdp *udp, const uint8_t *bytes, size_t octets);
DisUdpCounters dis_udp_counters(const DisUdp *udp);
/* Unix time in the nanoseconds that arrivals are stamped in. */
int64_t dis_udp_now_ns(void);

#endif
