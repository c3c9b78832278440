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

/* What a socket depends on. */
typedef struct DisTie {
    unsigned interface;  /* index when it was made; 0: none named */
    bool     narrow;     /* bound to that interface */
    bool     group, own; /* a group was joined; bound to an address of this machine */
} DisTie;

/* A socket that sends to *to; listen: bound and joined too. Failures as of dis_udp_open. */
Status dis_udp_socket(int *out, DisSocketAddress *to, DisTie *tie, const DisUdpConfig *config, bool listen);

/* IGMP and MLD membership. interface: index; 0: the system's choice. False: errno is set. */
bool dis_udp_join(int socket, const DisSocketAddress *group, unsigned interface);
bool dis_udp_leave(int socket, const DisSocketAddress *group, unsigned interface);
bool dis_udp_is_own(const DisSocketAddress *address); /* an address of this machine now */

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
    int          watch; /* announcements; -1: none, or a sender */
    bool         listens;
    bool         lost;        /* its interface was deleted since the socket was made */
    DisLinkState state, said; /* reported: the state last logged */
    int64_t      since_ns;    /* of the state; monotonic */
} DisLink;

/* A descriptor of the kernel's notifications, to be polled for POLLIN; -1 where the system has none. */
int dis_link_watch(void);
/* Reads all announcements; notes whether an interface that the socket depends on was deleted. */
void dis_link_read(DisLink *link, int socket, const DisSocketAddress *to, const DisTie *tie);
/* Polls the state, and joins the group again where no interface was named. remake: the socket must be recreated; the
 * caller then clears lost. Once a second and after notifications. */
void dis_link_check(DisLink *link, bool *remake, int socket, const DisSocketAddress *to, const DisTie *tie,
                    const DisUdpConfig *config);
/* Logs what the last read or poll found: one line when the link is no longer up, one when it is again; one more when
 * the reason is another for two seconds. where: of dis_udp_where. dis_link_unreported: to be checked again in a tenth
 * of a second. */
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
    uint64_t octets, held, next, end; /* held .. next: the taker's */
} DisRing;

Status dis_ring_create(DisRing *out, uint64_t octets);
void   dis_ring_destroy(DisRing *ring); /* a zeroed one is fine */
/* head: with its number of octets, which follow from bytes. False: the ring is full, and the oldest are kept. */
bool dis_ring_put(DisRing *ring, const DisRingRecord *head, const uint8_t *bytes);
/* The next, not after until_ns, its octets behind it; NULL: none. The previous one becomes invalid. */
const DisRingRecord *dis_ring_take(DisRing *ring, int64_t until_ns);
static inline bool   dis_ring_waits(const DisRing *ring) { return ring->next != ring->end; }

#endif
