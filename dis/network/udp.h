/* dis/network/udp.h: DIS datagrams over UDP: unicast, broadcast or multicast, IPv4 or IPv6, on a chosen interface.
 *
 * A separate thread reads datagrams from the socket into a bounded queue, so that none is lost while the caller is
 * busy. Arrival times are the kernel's, never decreasing, whole nanoseconds; steps of the system clock are removed.
 * Memory is allocated at dis_udp_open and never grows. Linux only.
 *
 * The loss of the network (interface deleted or down, address removed, no route to the group) is reported once, and
 * once more when it is back; sockets are then bound and groups joined again. */
#ifndef DIS_NETWORK_UDP_H
#define DIS_NETWORK_UDP_H

#include "dis/pdu/pdu.h"

enum { dis_udp_address_size = 64 };

/* Where to listen and to send. */
typedef struct DisUdpConfig {
    char address[dis_udp_address_size]; /* Destination address, numeric IPv4 or IPv6. Received on the port:
                                         * a multicast group: it is joined, nothing else is received
                                         * an address of this machine: datagrams to it, and no other program may listen
                                         * a broadcast, or empty for 255.255.255.255: all IPv4 datagrams
                                         * another machine's: all datagrams, and no other program may listen */
    char interface[32];                 /* name, `eth0`: the only interface used (implied by an address of this
                                         * machine); empty: receives on all, and the system chooses where to send */
    int port;                           /* 1 .. 65535 */
    int ttl;                            /* hops of multicast, 0 .. 255; 0: this machine alone */
    int queue_octets; /* capacity of the queue of datagrams not taken yet, with their headers of 32 octets, 131072 ..
                         2^30; when it is full new datagrams are dropped and counted */
} DisUdpConfig;

enum { dis_max_datagram = 65535 };

/* `239.1.2.3 port 3000 on eth0`, for people. */
enum { dis_udp_where_size = 128 };
void dis_udp_where(char out[dis_udp_where_size], const DisUdpConfig *config);

/* Broadcast on port 3000, 1 hop, a queue of 32 MiB: 170 000 Entity States. */
DisUdpConfig dis_udp_default_config(void);

typedef struct DisUdpCounters {
    uint64_t datagrams, octets; /* datagrams read off the socket: taken + waiting + lost_queue */
    uint64_t lost_kernel;       /* datagrams that found the socket's buffer full, by the kernel's own count */
    uint64_t lost_queue;        /* datagrams dropped because the queue was full */
    uint64_t sent, send_failed;
    int      send_error; /* errno of the latest failed send */
    bool     away;       /* the interface, its address or the way to the group is not available; already
                          * reported */
} DisUdpCounters;

typedef struct DisUdp DisUdp;

/* One datagram as taken; bytes are the taker's until its next take. */
typedef struct DisArrival {
    int64_t        capture_ns; /* Unix time; dis_unix_s converts it to the time of a recording */
    uint32_t       octets;     /* may be 0 */
    const uint8_t *bytes;
    uint8_t        from[16]; /* IPv4 as ::ffff:a.b.c.d */
    uint16_t       from_port;
} DisArrival;

/* STATUS_BAD_VALUE or STATUS_IO with one logged line: which address, port or interface, why, and what to do next. */
Status dis_udp_open(DisUdp **out, const DisUdpConfig *config);        /* listens, and may send */
Status dis_udp_open_sender(DisUdp **out, const DisUdpConfig *config); /* sends only: no port is bound */
/* Accepts NULL. No thread may be inside another function of this socket. */
void dis_udp_close(DisUdp *udp);

/* From this call on, tap is called for each datagram received, before it is queued, even when the queue is full. It is
 * called by the receiving thread or by the one that closes a tick, one at a time. With NULL none is called, and after
 * the call no call of the earlier one is still running. tap must not call functions of this file. */
typedef void (*DisUdpTap)(void *user, const DisArrival *arrival);
void dis_udp_tap(DisUdp *udp, DisUdpTap tap, void *user);
/* Queues what has arrived so far; after it has returned no datagram gets an arrival time at or before until_ns: a later
 * one with such a kernel time stamp gets until_ns + 1. Then call dis_udp_take(.., until_ns) until it returns false.
 * A live node closes a frame's tick this way, so its recording replays bit-identically: dis_unix_ns_until
 * gives the until_ns of a frame time. One thread at a time. */
void dis_udp_close_tick(DisUdp *udp, int64_t until_ns);
/* Takes the next datagram in order of arrival, not after until_ns (INT64_MAX: any). Returns false when none waits. One
 * thread at a time. */
bool dis_udp_take(DisArrival *out, DisUdp *udp, int64_t until_ns);
/* Waits until the queue is not empty (true) or until the Unix time until_ns (false). */
bool dis_udp_wait(DisUdp *udp, int64_t until_ns);
/* A full or missing network is counted and returns STATUS_IO; it is never fatal. Thread-safe. */
Status         dis_udp_send(DisUdp *udp, const uint8_t *bytes, size_t octets);
DisUdpCounters dis_udp_counters(const DisUdp *udp);
/* Unix time in nanoseconds by the clock that stamps arrivals (steady_clock.h): it does not move when the system clock
 * is set. */
int64_t dis_udp_now_ns(void);
/* Sleeps until that Unix time, or until a signal. */
void dis_udp_sleep_until(int64_t until_ns);
/* The address that dis_udp_send sends to, in the form of DisArrival's from. */
void dis_udp_destination(uint8_t to[16], const DisUdp *udp);

#endif
