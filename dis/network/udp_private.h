/* dis/network/udp_private.h: the socket, its network, and the queue of datagrams; for udp.c, under its locks. */
#ifndef DIS_NETWORK_UDP_PRIVATE_H
#define DIS_NETWORK_UDP_PRIVATE_H

#include "dis/network/udp.h"

#include <netinet/in.h>
#include <sys/socket.h>

/* ---- udp_socket.c: a socket from address and interface names ----------------------------------- */

typedef union DisSocketAddress {
    struct sockaddr         any;
    struct sockaddr_in      v4;
    struct sockaddr_in6     v6;
    struct sockaddr_storage storage;
} DisSocketAddress;

static inline socklen_t dis_socket_address_octets(const DisSocketAddress *address)
{
    return address->any.sa_family == AF_INET6 ? sizeof address->v6 : sizeof address->v4;
}

/* The address in the form of DisArrival: IPv4 as ::ffff:a.b.c.d. */
void dis_socket_address_octets16(uint8_t out[16], const DisSocketAddress *address);

/* What a socket depends on: an interface, a group, an address. */
typedef struct DisTie {
    unsigned interface;  /* index of the interface when the socket was made; 0: none was named */
    bool     narrow;     /* the socket is bound to that interface */
    bool     group, own; /* group: it has joined one; own: it is bound to an address of this machine */
} DisTie;

/* Makes a socket that sends to *to. listen: it is also bound, and joins the group. Failures as of dis_udp_open. */
Status dis_udp_socket(int *out, DisSocketAddress *to, DisTie *tie, const DisUdpConfig *config, bool listen);

/* Joins a group (IGMP, MLD). interface: its index; 0: the system chooses. Returns false with errno set. */
bool dis_udp_join(int socket, const DisSocketAddress *group, unsigned interface);
bool dis_udp_leave(int socket, const DisSocketAddress *group, unsigned interface);
bool dis_udp_is_own(const DisSocketAddress *address); /* whether it is an address of this machine now */

/* ---- udp_link.c: loss and return of the network ------------------------------------------------ */

/* Monitors whether the interface, address and group of a socket still exist.
 *
 * An interface that is deleted and recreated has another index: the socket that was bound to it, and the group that was
 * joined on it, never receive again, without an error. So the kernel's notifications (rtnetlink(7)) are read, and the
 * state is also polled once a second for cases without one. */
typedef enum DisLinkState {
    DIS_LINK_UP,
    DIS_LINK_GONE,       /* the named interface does not exist */
    DIS_LINK_DOWN,       /* it does, and is set down */
    DIS_LINK_NO_CARRIER, /* it is set up, and nothing is at its other end */
    DIS_LINK_NO_ADDRESS, /* the address that is listened on is no longer one of this machine's */
    DIS_LINK_NO_ROUTE,   /* no interface leads to the group */
} DisLinkState;

typedef struct DisLink {
    int          watch; /* socket of the kernel's notifications; -1: there is none, or this is a sender */
    bool         listens;
    bool         lost;        /* the interface was deleted since the socket was made */
    DisLinkState state, said; /* said: the state that was logged last */
    int64_t      since_ns;    /* when the state began, by the monotonic clock */
} DisLink;

/* A descriptor of the kernel's notifications, to be polled for POLLIN; -1 where the system has none. */
int dis_link_watch(void);
/* Reads all announcements; notes whether an interface that the socket depends on was deleted. */
void dis_link_read(DisLink *link, int socket, const DisSocketAddress *to, const DisTie *tie);
/* Polls the state, and joins the group again where no interface was named. remake: the socket must be recreated; the
 * caller then clears lost. Once a second and after notifications. */
void dis_link_check(DisLink *link, bool *remake, int socket, const DisSocketAddress *to, const DisTie *tie,
                    const DisUdpConfig *config);
/* Logs what the last read or poll found: one line when the link is no longer up, one when it is again, and one more
 * when another reason has held for two seconds. where: as dis_udp_where gives it. dis_link_unreported: the link is to
 * be checked again in a tenth of a second. */
static inline bool dis_link_unreported(const DisLink *link) { return link->state != link->said; }
void               dis_link_report(DisLink *link, const char *where, const DisUdpConfig *config);

/* ---- udp_ring.c: the queue --------------------------------------------------------------------- */

/* A ring buffer. Each datagram is contiguous after its record. A datagram taken is valid until the next take. Memory is
 * allocated once.
 *
 * Record and octets are whole units, so that a gap at the end of the ring holds at least this. */
typedef struct DisRingRecord {
    int64_t  capture_ns;
    uint32_t octets; /* UINT32_MAX: nothing more before the end of the ring */
    uint16_t from_port;
    uint8_t  from[16];
} DisRingRecord;

/* Positions count octets since the beginning: held <= next <= end <= held + octets. */
typedef struct DisRing {
    uint8_t *bytes;
    uint64_t octets, held, next, end; /* octets from held to next belong to the caller that took them */
} DisRing;

Status dis_ring_create(DisRing *out, uint64_t octets);
void   dis_ring_destroy(DisRing *ring); /* accepts a zeroed ring */
/* head: the record, with its number of octets, which are copied from bytes. Returns false when the ring is full; the
 * oldest datagrams stay. */
bool dis_ring_put(DisRing *ring, const DisRingRecord *head, const uint8_t *bytes);
/* The next record, not after until_ns, with its octets behind it; NULL: none. The record taken before becomes invalid.
 * */
const DisRingRecord *dis_ring_take(DisRing *ring, int64_t until_ns);
static inline bool   dis_ring_waits(const DisRing *ring) { return ring->next != ring->end; }

#endif
