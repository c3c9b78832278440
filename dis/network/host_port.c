/* dis/network/host_port.c: HOST:PORT into an address of a socket. */
#include "dis/network/host_port.h"

#include <arpa/inet.h>

bool host_port_parse(HostPort *out, const char *text)
{
    char        host[INET6_ADDRSTRLEN];
    const char *colon = strrchr(text, ':');
    const bool  v6 = *text == '[';
    long long   port;
    if (!colon || !text_to_long(&port, colon + 1) || port < 1 || port > 65535) return false;
    const char  *begin = text + v6;
    const size_t length = (size_t)(colon - begin) - (size_t)v6;
    if (colon < begin + v6 || (v6 && colon[-1] != ']') || length >= sizeof host) return false;
    memcpy(host, begin, length);
    host[length] = 0;
    memset(out, 0, sizeof *out);
    out->any.sa_family = v6 ? AF_INET6 : AF_INET;
    if (v6) out->v6.sin6_port = htons((uint16_t)port);
    else out->v4.sin_port = htons((uint16_t)port);
    return inet_pton(out->any.sa_family, host, v6 ? (void *)&out->v6.sin6_addr : (void *)&out->v4.sin_addr) == 1;
}

socklen_t host_port_size(const HostPort *a) { return a->any.sa_family == AF_INET6 ? sizeof a->v6 : sizeof a->v4; }
