/* dis/network/udp_link.c: notifications of the kernel, and polling of the interface.
 *
 * Sources: rtnetlink(7), netdevice(7), ip(7), ipv6(7). */
#include "dis/network/udp_private.h"

#include <errno.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <stdio.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

/* An interface is set down before it is deleted, and is down briefly after it is created: so a state must last before
 * it is logged. */
static const int64_t settle_ns = 200000000, other_ns = 2000000000;

static int64_t monotonic_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* ---- notifications ----------------------------------------------------------------------------------- */

int dis_link_watch(void)
{
    const struct sockaddr_nl at = {.nl_family = AF_NETLINK,
                                   .nl_groups = RTMGRP_LINK | RTMGRP_IPV4_IFADDR | RTMGRP_IPV6_IFADDR};
    const int                watch = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_ROUTE);
    if (watch < 0 || bind(watch, (const struct sockaddr *)&at, sizeof at) == 0) return watch;
    close(watch);
    return -1;
}

/* Notes that an interface was deleted if the socket depends on it. A named interface is known by its index. For a group
 * on an interface that the system chose, the group was joined on the deleted one if it can be left there; leaving also
 * frees one of the 20 memberships of a socket. */
static void note_deleted(DisLink *link, unsigned index, int socket, const DisSocketAddress *to, const DisTie *tie)
{
    if (tie->narrow) {
        if (index == tie->interface) link->lost = true;
    } else if (tie->group && dis_udp_leave(socket, to, index)) {
        link->lost = true;
    }
}

void dis_link_read(DisLink *link, int socket, const DisSocketAddress *to, const DisTie *tie)
{
    _Alignas(struct nlmsghdr) uint8_t buffer[16384];
    if (link->watch < 0) return;
    for (;;) {
        const ssize_t octets = recv(link->watch, buffer, sizeof buffer, MSG_DONTWAIT);
        if (octets < 0 && (errno == ENOBUFS || errno == EINTR))
            continue; /* some notifications were lost; the next poll makes up for them */
        if (octets <= 0) return;
        unsigned left = (unsigned)octets;
        for (const struct nlmsghdr *m = (const void *)buffer; NLMSG_OK(m, left); m = NLMSG_NEXT(m, left)) {
            const struct ifinfomsg *about = NLMSG_DATA(m);
            /* a bridge reports its ports in a separate family; those are not deleted interfaces */
            if (m->nlmsg_type == RTM_DELLINK && m->nlmsg_len >= NLMSG_LENGTH(sizeof *about) &&
                about->ifi_family == AF_UNSPEC)
                note_deleted(link, (unsigned)about->ifi_index, socket, to, tie);
        }
    }
}

/* ---- polling --------------------------------------------------------------------------------------- */

static DisLinkState interface_state(int socket, const char *name)
{
    struct ifreq about = {0};
    memcpy(about.ifr_name, name, strnlen(name, sizeof about.ifr_name - 1));
    if (ioctl(socket, SIOCGIFFLAGS, &about) != 0) return errno == ENODEV ? DIS_LINK_GONE : DIS_LINK_UP;
    return !(about.ifr_flags & IFF_UP)        ? DIS_LINK_DOWN
           : !(about.ifr_flags & IFF_RUNNING) ? DIS_LINK_NO_CARRIER
                                              : DIS_LINK_UP;
}

static DisLinkState look(bool *remake, const DisLink *link, int socket, const DisSocketAddress *to, const DisTie *tie,
                         const DisUdpConfig *config)
{
    if (tie->narrow) {
        const unsigned index = if_nametoindex(config->interface);
        if (index == 0) return DIS_LINK_GONE;
        /* with the same index the socket is bound to the interface again by itself, but the group is not joined */
        *remake = index != tie->interface || (link->lost && tie->group);
        return interface_state(socket, config->interface);
    }
    if (tie->group && tie->interface) { /* `ff02::1%eth0`: the name is resolved again when the socket is recreated */
        char name[IF_NAMESIZE];
        *remake = link->lost || !if_indextoname(tie->interface, name);
        return *remake ? DIS_LINK_GONE : DIS_LINK_UP;
    }
    if (tie->group) { /* EADDRINUSE, that it is joined already, is the usual result */
        if (dis_udp_join(socket, to, 0) || errno == EADDRINUSE) return DIS_LINK_UP;
        *remake = errno == ENOBUFS;
        return *remake || !link->lost
                   ? DIS_LINK_UP
                   : DIS_LINK_NO_ROUTE; /* the group is still joined, though there is no route to it */
    }
    return tie->own && !dis_udp_is_own(to) ? DIS_LINK_NO_ADDRESS : DIS_LINK_UP;
}

void dis_link_check(DisLink *link, bool *remake, int socket, const DisSocketAddress *to, const DisTie *tie,
                    const DisUdpConfig *config)
{
    *remake = false;
    const DisLinkState state = look(remake, link, socket, to, tie, config);
    if (link->state != state) link->since_ns = monotonic_ns();
    link->state = state;
    if (!*remake && state == DIS_LINK_UP) link->lost = false;
}

/* ---- reporting --------------------------------------------------------------------------------------- */

enum { link_text_size = 256 };

/* `the interface eth0 is down`, for people. */
static void link_text(char out[link_text_size], DisLinkState state, const DisUdpConfig *config)
{
    switch (state) {
    case DIS_LINK_UP:
        snprintf(out, link_text_size, "the network is there");
        break;
    case DIS_LINK_GONE:
        if (!config->interface[0]) snprintf(out, link_text_size, "the interface it was joined on is gone");
        else snprintf(out, link_text_size, "the interface %s is gone", config->interface);
        break;
    case DIS_LINK_DOWN:
        snprintf(out, link_text_size, "the interface %s is down (`ip link set %s up`)", config->interface,
                 config->interface);
        break;
    case DIS_LINK_NO_CARRIER:
        snprintf(out, link_text_size, "the interface %s has no carrier (its cable, or the other end)",
                 config->interface);
        break;
    case DIS_LINK_NO_ADDRESS:
        snprintf(out, link_text_size, "%s is no longer an address of this machine (`ip addr`)", config->address);
        break;
    case DIS_LINK_NO_ROUTE:
        snprintf(out, link_text_size, "no interface leads to %s (`ip route`; or name an interface)", config->address);
        break;
    }
}

static void say(const char *where, DisLinkState state, const DisUdpConfig *config)
{
    char text[link_text_size];
    link_text(text, state, config);
    log_warn("udp: %s: %s; nothing is heard or sent until it is back", where, text);
}

void dis_link_report(DisLink *link, const char *where, const DisUdpConfig *config)
{
    if (link->lost && link->said == DIS_LINK_UP) /* the present state */
        say(where, link->said = DIS_LINK_GONE, config);
    if (link->lost || link->state == link->said) return;
    if (link->state == DIS_LINK_UP)
        log_info("udp: %s: the network is there again, %s", where, link->listens ? "listening" : "sending");
    else if (monotonic_ns() - link->since_ns >= (link->said == DIS_LINK_UP ? settle_ns : other_ns))
        say(where, link->state, config);
    else return;
    link->said = link->state;
}
