/* dis/udp_socket.h: from names to a socket; for udp.c only. */
#ifndef DIS_UDP_SOCKET_H
#define DIS_UDP_SOCKET_H

#include "dis/udp.h"

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

/* A socket that sends to *to; listen: bound and joined too. Failures as dis_udp_open says. */
Status dis_udp_socket(int *out, DisSocketAddress *to, const DisUdpConfig *config, bool listen);

#endif
