/* dis/udp_socket.h: opens a socket from address and interface names; for udp.c only. */
#ifndef DIS_UDP_SOCKET_H
#define DIS_UDP_SOCKET_H

#include "dis/udp_config.h"

#include <netinet/in.h>
#include <sys/socket.h>

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

/* As in DisArrival: IPv4 as ::ffff:a.b.c.d. */
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
#endif
