/* dis/cigi/cigi_link.c: the socket of a CIGI host and this image generator. */
#include "dis/cigi/cigi_link.h"

#include "dis/network/host_port.h"

#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

enum { most_octets = 65536 };

struct CigiLink {
    int      socket;
    HostPort host;
    uint64_t foreign, unsent;
    uint8_t  datagram[most_octets];
};

bool cigi_link_address_good(const char *host_port)
{
    HostPort address;
    return host_port_parse(&address, host_port);
}

bool cigi_link_recorded(const char *host_port) { return strcmp(host_port, "recorded") == 0; }

Status cigi_link_open(CigiLink **out, const char *host_port, int own_port)
{
    CigiLink *link = calloc(1, sizeof *link);
    if (!link) return STATUS_NO_MEMORY;
    link->socket = -1;
    if (!host_port_parse(&link->host, host_port)) {
        log_error("cigi: '%s' is not HOST:PORT with a numeric address, for example 127.0.0.1:8004", host_port);
        cigi_link_close(link);
        return STATUS_BAD_VALUE;
    }
    HostPort own = {.any.sa_family = link->host.any.sa_family};
    if (own.any.sa_family == AF_INET6) own.v6.sin6_port = htons((uint16_t)own_port), own.v6.sin6_addr = in6addr_any;
    else own.v4.sin_port = htons((uint16_t)own_port), own.v4.sin_addr.s_addr = htonl(INADDR_ANY);
    link->socket = socket(own.any.sa_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (link->socket < 0 || bind(link->socket, &own.any, host_port_size(&own)) != 0) {
        log_error("cigi: cannot listen on port %d: %s%s", own_port, strerror(errno),
                  errno == EADDRINUSE ? "; another program has it: choose another (exercise.cigi_port)" : "");
        cigi_link_close(link);
        return STATUS_IO;
    }
    *out = link;
    return STATUS_OK;
}

void cigi_link_close(CigiLink *link)
{
    if (!link) return;
    if (link->socket >= 0) close(link->socket);
    free(link);
}

static bool from_host(const HostPort *from, const HostPort *host)
{
    if (from->any.sa_family != host->any.sa_family) return false;
    if (host->any.sa_family == AF_INET6)
        return memcmp(&from->v6.sin6_addr, &host->v6.sin6_addr, sizeof host->v6.sin6_addr) == 0;
    return from->v4.sin_addr.s_addr == host->v4.sin_addr.s_addr;
}

bool cigi_link_receive(const uint8_t **datagram, size_t *octets, CigiLink *link, double wait_s)
{
    struct pollfd what = {.fd = link->socket, .events = POLLIN};
    HostPort      from;
    socklen_t     size = sizeof from;
    if (poll(&what, 1, (int)(1e3 * wait_s)) != 1) return false;
    const ssize_t got = recvfrom(link->socket, link->datagram, sizeof link->datagram, MSG_DONTWAIT, &from.any, &size);
    if (got < 0) return false;
    if (!from_host(&from, &link->host)) {
        link->foreign++;
        return false;
    }
    *datagram = link->datagram;
    *octets = (size_t)got;
    return true;
}

void cigi_link_send(CigiLink *link, const uint8_t *datagram, size_t octets)
{
    const ssize_t sent =
        sendto(link->socket, datagram, octets, MSG_DONTWAIT, &link->host.any, host_port_size(&link->host));
    link->unsent += sent != (ssize_t)octets;
}

void cigi_link_host(uint8_t address[16], uint16_t *port, const CigiLink *link)
{
    static const uint8_t mapped[12] = {[10] = 0xFF, [11] = 0xFF};
    const bool           v6 = link->host.any.sa_family == AF_INET6;
    if (v6) {
        memcpy(address, &link->host.v6.sin6_addr, 16);
    } else {
        memcpy(address, mapped, sizeof mapped);
        memcpy(address + sizeof mapped, &link->host.v4.sin_addr, 4);
    }
    *port = ntohs(v6 ? link->host.v6.sin6_port : link->host.v4.sin_port);
}

uint64_t cigi_link_foreign(const CigiLink *link) { return link->foreign; }
uint64_t cigi_link_unsent(const CigiLink *link) { return link->unsent; }
