/* dis/network/host_port.h: HOST:PORT as settings have it, with a numeric address. */
#ifndef DIS_NETWORK_HOST_PORT_H
#define DIS_NETWORK_HOST_PORT_H

#include "pitviper.h"

#include <netinet/in.h>

typedef union HostPort {
    struct sockaddr     any;
    struct sockaddr_in  v4;
    struct sockaddr_in6 v6;
} HostPort;

/* IPv4, or IPv6 in brackets; port 1 .. 65535. False: it is no such text, and *out is not to be used. */
bool      host_port_parse(HostPort *out, const char *text);
socklen_t host_port_size(const HostPort *address);

#endif
