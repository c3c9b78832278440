/* sensor/publish/video/udp_video.c: sends MPEG-TS over UDP.
 *
 * Sources: ip(7), udp(7). A connected socket learns that its receiver is absent (ICMP) with a later send, which then
 * fails and sends nothing: that datagram is sent again at once. */
#include "sensor/publish/video/udp_video.h"

#include <arpa/inet.h>
#include <errno.h>
#include <net/if.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

enum { send_buffer_octets = 4 << 20, url_size = 40 };
/* Without a refusal for so long the receiver is there again: routers limit how often they report. */
static const double back_after_s = 2;

struct UdpVideo {
    int                socket;
    struct sockaddr_in to;
    bool               connected;
    char               url[url_size];
    StreamCounters     counters;
    bool               away;           /* reported */
    double             refused_s;      /* wall clock: the last refusal */
    uint64_t           refused_before; /* when it was reported: refused, and without a route */
};

static bool set_flag(int socket, int level, int name, int value)
{
    return setsockopt(socket, level, name, &value, sizeof value) == 0;
}

/* Without a route sends fail until there is one. */
static bool is_no_route(int error)
{
    return error == ENETUNREACH || error == EHOSTUNREACH || error == ENETDOWN || error == EHOSTDOWN;
}

/* 0, or the error. */
static int connect_to(UdpVideo *u)
{
    u->connected = connect(u->socket, (const struct sockaddr *)&u->to, sizeof u->to) == 0;
    return u->connected ? 0 : errno;
}

static bool choose_interface(const UdpVideo *u, const char *interface)
{
    const struct ip_mreqn through = {.imr_ifindex = (int)if_nametoindex(interface)};
    return through.imr_ifindex && setsockopt(u->socket, IPPROTO_IP, IP_MULTICAST_IF, &through, sizeof through) == 0;
}

Status udp_video_open(UdpVideo **out, const StreamUrl *to, const char *interface, int ttl)
{
    const bool  group  = publish_stream_multicast(to);
    const char *failed = NULL;
    UdpVideo   *u      = calloc(1, sizeof *u);
    if (!u) return STATUS_NO_MEMORY;
    u->to = (struct sockaddr_in){.sin_family = AF_INET, .sin_port = htons(to->port)};
    memcpy(&u->to.sin_addr, to->address, sizeof to->address);
    snprintf(u->url, sizeof u->url, "udp://%u.%u.%u.%u:%u", to->address[0], to->address[1], to->address[2],
             to->address[3], to->port);
    u->socket = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (u->socket < 0) failed = "open a socket for";
    else if (group && *interface && !choose_interface(u, interface)) failed = "use network.interface for";
    else if (!set_flag(u->socket, IPPROTO_IP, IP_MULTICAST_TTL, ttl) ||
             !set_flag(u->socket, IPPROTO_IP, IP_MULTICAST_LOOP, 1) ||
             !set_flag(u->socket, SOL_SOCKET, SO_BROADCAST, 1))
        failed = "set the options of";
    const int reached = failed ? 0 : connect_to(u);
    if (reached && !is_no_route(reached)) {
        failed = "connect to";
        errno  = reached;
    }
    if (failed) {
        log_error("video: cannot %s %s: %s", failed, u->url, strerror(errno));
        udp_video_close(u, NULL);
        return STATUS_IO;
    }
    set_flag(u->socket, SOL_SOCKET, SO_SNDBUF, send_buffer_octets); /* what the system allows is enough */
    *out = u;
    return STATUS_OK;
}

static uint64_t unsent(const StreamCounters *c) { return c->refused + c->no_route; }

void udp_video_close(UdpVideo *u, StreamCounters *sum)
{
    if (!u) return;
    const StreamCounters *c = &u->counters;
    if (unsent(c) || c->lost)
        log_info("video: %s: datagrams: sent=%llu refused=%llu no_route=%llu lost=%llu", u->url, (unsigned long long)c->sent,
                 (unsigned long long)c->refused, (unsigned long long)c->no_route, (unsigned long long)c->lost);
    if (c->sent == 0 && c->no_route)
        log_warn("video: %s: there was never a route to it, so nothing was sent; check publish.stream and this machine's "
                 "network (ip route get ADDRESS)", u->url);
    if (sum) {
        sum->sent += c->sent;
        sum->refused += c->refused;
        sum->no_route += c->no_route;
        sum->lost += c->lost;
    }
    if (u->socket >= 0) close(u->socket);
    free(u);
}

/* 0, or the error. */
static int try_send(UdpVideo *u, const uint8_t *bytes, size_t count)
{
    const int away = u->connected ? 0 : connect_to(u);
    return away ? away : send(u->socket, bytes, count, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0 ? 0 : errno;
}

static void note_refused(UdpVideo *u, int error)
{
    u->refused_s = wall_clock_s();
    if (!u->away) {
        u->away           = true;
        u->refused_before = unsent(&u->counters);
        if (error == ECONNREFUSED) log_info("video: %s: no program receives it at present; sending goes on", u->url);
        else log_warn("video: %s: no route to it: %s; sending goes on, for when there is one", u->url, strerror(error));
    }
    if (error == ECONNREFUSED) u->counters.refused++;
    else u->counters.no_route++;
}

static void note_sent(UdpVideo *u)
{
    u->counters.sent++;
    if (!u->away || wall_clock_s() - u->refused_s < back_after_s) return;
    u->away = false;
    log_info("video: %s: received again; %llu datagrams were not", u->url,
             (unsigned long long)(unsent(&u->counters) - u->refused_before));
}

void udp_video_send(UdpVideo *u, const uint8_t *bytes, size_t count)
{
    int error = try_send(u, bytes, count);
    if (error == ECONNREFUSED) { /* of an earlier datagram; this one was not sent */
        note_refused(u, error);
        error = try_send(u, bytes, count);
    }
    if (error == 0) note_sent(u);
    else if (error == ECONNREFUSED || is_no_route(error)) note_refused(u, error);
    else u->counters.lost++;
}
