/* tests/dis/udp_peer.h: plain sockets on the other side, and ports that are free. */
#ifndef TESTS_DIS_UDP_PEER_H
#define TESTS_DIS_UDP_PEER_H

#include "tests/check.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

static const int64_t peer_patience_ns = 120000000000; /* a test that waits longer than this has failed */

/* What the system would give: free now, and not given again soon. */
static inline int free_port(void)
{
    struct sockaddr_in at = {.sin_family = AF_INET};
    socklen_t          octets = sizeof at;
    const int          s = socket(AF_INET, SOCK_DGRAM, 0);
    CHECK(s >= 0 && bind(s, (struct sockaddr *)&at, sizeof at) == 0);
    CHECK(getsockname(s, (struct sockaddr *)&at, &octets) == 0);
    close(s);
    return ntohs(at.sin_port);
}

/* A socket that sends to 127.0.0.1 or ::1, at this port. -1: no such family here. */
static inline int peer_socket(bool v6, int port)
{
    const struct sockaddr_in to4 = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const struct sockaddr_in6 to6 = {
        .sin6_family = AF_INET6, .sin6_port = htons((uint16_t)port), .sin6_addr = IN6ADDR_LOOPBACK_INIT};
    const struct sockaddr *to = v6 ? (const struct sockaddr *)&to6 : (const struct sockaddr *)&to4;
    const int              s = socket(v6 ? AF_INET6 : AF_INET, SOCK_DGRAM, 0);
    if (s < 0) return -1;
    if (connect(s, to, v6 ? sizeof to6 : sizeof to4) == 0) return s;
    close(s);
    return -1;
}

/* Our own socket that is bound to the port, found among what this process has open. */
static inline int socket_at_port(int port)
{
    for (int s = 3; s < 256; s++) {
        struct sockaddr_in at;
        socklen_t          octets = sizeof at;
        if (getsockname(s, (struct sockaddr *)&at, &octets) != 0 || at.sin_family != AF_INET) continue;
        if (ntohs(at.sin_port) == port) return s;
    }
    return -1;
}

#endif
