/* dis/network/udp_socket.c: socket options of an exercise, and one log line for each failure.
 *
 * Sources: ip(7), ipv6(7), udp(7), socket(7). */
#include "dis/network/udp_private.h"

#include <errno.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <stdio.h>
#include <unistd.h>

enum {
    receive_buffer_octets = 64 << 20,
    send_buffer_octets = 4 << 20,
    least_queue_octets = 128 << 10,
    most_queue_octets = 1 << 30,
    text_size = 256
};

/* The kind of address determines how to listen for it. */
typedef enum Reach {
    REACH_OWN,       /* an address of this machine: the socket is bound to it, exclusively */
    REACH_PEER,      /* an address of another machine: all datagrams to the port, exclusively */
    REACH_BROADCAST, /* all datagrams to the port, shared with other programs */
    REACH_GROUP, /* a group, joined and bound to: only its datagrams are received, and other programs may receive them
                    too */
} Reach;

typedef struct Plan {
    const DisUdpConfig *config;
    DisSocketAddress    to;
    Reach               reach;
    unsigned            interface;                       /* index of the interface; 0: none was given */
    char                name[dis_udp_address_size + 64]; /* `239.1.2.3 port 3000 on eth0`, for messages */
} Plan;

void dis_socket_address_octets16(uint8_t out[16], const DisSocketAddress *address)
{
    static const uint8_t mapped[12] = {[10] = 0xFF, [11] = 0xFF};
    if (address->any.sa_family == AF_INET6) {
        memcpy(out, &address->v6.sin6_addr, 16);
    } else {
        memcpy(out, mapped, sizeof mapped);
        memcpy(out + 12, &address->v4.sin_addr, 4);
    }
}

/* ---- address resolution -------------------------------------------------------------------------- */

static void list_interfaces(char out[text_size])
{
    struct if_nameindex *all = if_nameindex();
    size_t               used = 0;
    out[0] = 0;
    for (int i = 0; all && all[i].if_index && used + IF_NAMESIZE + 3 < text_size; i++)
        used += (size_t)snprintf(out + used, text_size - used, "%s%s", i ? ", " : "", all[i].if_name);
    if (all) if_freenameindex(all);
    if (!used) snprintf(out, text_size, "none");
}

static bool is_broadcast(struct in_addr address)
{
    const uint32_t  host = ntohl(address.s_addr);
    struct ifaddrs *all = NULL;
    bool            found = host == INADDR_BROADCAST ||
                 host == 0x7FFFFFFF; /* the loopback interface's broadcast address is not listed by the system */
    if (found || getifaddrs(&all) != 0) return found;
    for (const struct ifaddrs *i = all; i && !found; i = i->ifa_next) {
        if (!(i->ifa_flags & IFF_BROADCAST) || !i->ifa_broadaddr || i->ifa_broadaddr->sa_family != AF_INET) continue;
        struct sockaddr_in broadcast;
        memcpy(&broadcast, i->ifa_broadaddr, sizeof broadcast);
        found = broadcast.sin_addr.s_addr == address.s_addr;
    }
    freeifaddrs(all);
    return found;
}

bool dis_udp_is_own(const DisSocketAddress *address)
{
    uint8_t         wanted[16], one[16];
    struct ifaddrs *all = NULL;
    if (address->any.sa_family == AF_INET && ntohl(address->v4.sin_addr.s_addr) >> 24 == 127) return true;
    if (getifaddrs(&all) != 0) return false;
    dis_socket_address_octets16(wanted, address);
    bool found = false;
    for (const struct ifaddrs *i = all; i && !found; i = i->ifa_next) {
        DisSocketAddress local;
        if (!i->ifa_addr || (i->ifa_addr->sa_family != AF_INET && i->ifa_addr->sa_family != AF_INET6)) continue;
        memcpy(&local, i->ifa_addr, i->ifa_addr->sa_family == AF_INET6 ? sizeof local.v6 : sizeof local.v4);
        dis_socket_address_octets16(one, &local);
        found = memcmp(one, wanted, sizeof one) == 0;
    }
    freeifaddrs(all);
    return found;
}

static bool is_link_local(const struct in6_addr *a)
{
    return IN6_IS_ADDR_LINKLOCAL(a) || IN6_IS_ADDR_MC_LINKLOCAL(a) || IN6_IS_ADDR_MC_NODELOCAL(a);
}

static Reach reach_of(const DisSocketAddress *to)
{
    if (to->any.sa_family == AF_INET) {
        if (IN_MULTICAST(ntohl(to->v4.sin_addr.s_addr))) return REACH_GROUP;
        if (is_broadcast(to->v4.sin_addr)) return REACH_BROADCAST;
    } else if (IN6_IS_ADDR_MULTICAST(&to->v6.sin6_addr)) {
        return REACH_GROUP;
    }
    return dis_udp_is_own(to) ? REACH_OWN : REACH_PEER;
}

static bool check_range(const char *what, int value, int low, int high)
{
    if (value >= low && value <= high) return true;
    log_error("udp: %s: %d is not in %d .. %d", what, value, low, high);
    return false;
}

static Status read_config(Plan *plan, const DisUdpConfig *config)
{
    const struct addrinfo hints = {
        .ai_family = AF_UNSPEC, .ai_socktype = SOCK_DGRAM, .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV};
    struct addrinfo *found = NULL;
    char             text[text_size];
    const char      *address = config->address[0] ? config->address : "255.255.255.255";
    if (!check_range("port", config->port, 1, 65535) || !check_range("ttl", config->ttl, 0, 255) ||
        !check_range("queue octets", config->queue_octets, least_queue_octets, most_queue_octets))
        return STATUS_BAD_VALUE;

    *plan = (Plan){.config = config};
    if (config->interface[0] && !(plan->interface = if_nametoindex(config->interface))) {
        list_interfaces(text);
        log_error("udp: interface: there is no `%s` on this machine, and none is waited for; it has: %s",
                  config->interface, text);
        return STATUS_BAD_VALUE;
    }
    snprintf(text, sizeof text, "%d", config->port);
    if (getaddrinfo(address, text, &hints, &found) != 0) {
        log_error("udp: address: `%s` is not an IPv4 or IPv6 address in numbers, such as 192.168.1.255, 239.1.2.3 or "
                  "ff15::d15",
                  address);
        return STATUS_BAD_VALUE;
    }
    memcpy(&plan->to, found->ai_addr, found->ai_addrlen);
    freeaddrinfo(found);

    struct sockaddr_in6 *v6 = plan->to.any.sa_family == AF_INET6 ? &plan->to.v6 : NULL;
    if (v6 ? IN6_IS_ADDR_UNSPECIFIED(&v6->sin6_addr) || IN6_IS_ADDR_V4MAPPED(&v6->sin6_addr)
           : plan->to.v4.sin_addr.s_addr == htonl(INADDR_ANY)) {
        log_error("udp: address: nothing can be sent to `%s`; leave it empty to hear all and to send "
                  "to 255.255.255.255",
                  address);
        return STATUS_BAD_VALUE;
    }
    if (v6 && is_link_local(&v6->sin6_addr)) {
        if (!v6->sin6_scope_id) v6->sin6_scope_id = plan->interface;
        if (!plan->interface) plan->interface = v6->sin6_scope_id;
        if (!v6->sin6_scope_id || v6->sin6_scope_id != plan->interface) {
            list_interfaces(text);
            log_error("udp: address: `%s` means another machine on every interface: name one of: %s", address, text);
            return STATUS_BAD_VALUE;
        }
    }
    plan->reach = reach_of(&plan->to);
    snprintf(plan->name, sizeof plan->name, "%s port %d%s%s", address, config->port, config->interface[0] ? " on " : "",
             config->interface);
    return STATUS_OK;
}

/* ---- socket set-up ------------------------------------------------------------------------------ */

/* Status, after one log line with the operation, its object, the error and a remedy. */
static Status refused(const Plan *plan, const char *what)
{
    const int   error = errno;
    const char *next = "";
    char        interfaces[text_size], text[text_size + 64];
    switch (error) {
    case EADDRINUSE:
        next = "; another program has the port: choose another port or end it (`ss -ulpn` shows which); several "
               "programs hear one exercise by a broadcast (127.255.255.255 within this machine) or a multicast group";
        break;
    case EACCES:
    case EPERM:
        next = plan->config->port < 1024 ? "; ports below 1024 are for the administrator: choose a higher one"
                                         : "; this user may not: leave the interface empty, or ask the administrator";
        break;
    case EAFNOSUPPORT:
        next = plan->to.any.sa_family == AF_INET6 ? "; this machine has no IPv6: use an IPv4 address"
                                                  : "; this machine has no IPv4: use an IPv6 address";
        break;
    case ENODEV:
    case ENETUNREACH:
    case EADDRNOTAVAIL:
        list_interfaces(interfaces);
        snprintf(text, sizeof text, "; no route leads there: name an interface that carries it, of: %s", interfaces);
        next = text;
        break;
    default:
        break;
    }
    log_error("udp: cannot %s %s: %s%s", what, plan->name, strerror(error), next);
    return STATUS_IO;
}

static bool set_flag(int socket, int level, int name, int value)
{
    return setsockopt(socket, level, name, &value, sizeof value) == 0;
}

/* Sets the largest buffer that is allowed; a size beyond the system's limit needs CAP_NET_ADMIN. */
static void set_buffer(int socket, int forced, int plain, int octets)
{
    if (!set_flag(socket, SOL_SOCKET, forced, octets)) set_flag(socket, SOL_SOCKET, plain, octets);
}

/* Sets the multicast interface, the hop limit, and loopback, so that programs of this machine receive the datagrams
 * too. */
static bool aim(const Plan *plan, int socket)
{
    const int ttl = plan->config->ttl;
    if (plan->to.any.sa_family == AF_INET6) {
        const int interface = (int)plan->interface;
        return set_flag(socket, IPPROTO_IPV6, IPV6_MULTICAST_HOPS, ttl) &&
               set_flag(socket, IPPROTO_IPV6, IPV6_MULTICAST_LOOP, 1) &&
               (!interface || set_flag(socket, IPPROTO_IPV6, IPV6_MULTICAST_IF, interface));
    }
    const struct ip_mreqn through = {.imr_ifindex = (int)plan->interface};
    return set_flag(socket, SOL_SOCKET, SO_BROADCAST, 1) && set_flag(socket, IPPROTO_IP, IP_MULTICAST_TTL, ttl) &&
           set_flag(socket, IPPROTO_IP, IP_MULTICAST_LOOP, 1) &&
           (!plan->interface || setsockopt(socket, IPPROTO_IP, IP_MULTICAST_IF, &through, sizeof through) == 0);
}

static bool bind_to(const Plan *plan, int socket)
{
    DisSocketAddress at = plan->to;
    if (plan->reach == REACH_PEER || plan->reach == REACH_BROADCAST) {
        if (at.any.sa_family == AF_INET6)
            at.v6 = (struct sockaddr_in6){.sin6_family = AF_INET6, .sin6_port = at.v6.sin6_port};
        else at.v4.sin_addr.s_addr = htonl(INADDR_ANY);
    }
    return bind(socket, &at.any, dis_socket_address_octets(&at)) == 0;
}

static bool membership(int socket, const DisSocketAddress *to, unsigned interface, int v4, int v6)
{
    if (to->any.sa_family == AF_INET6) {
        const struct ipv6_mreq group = {to->v6.sin6_addr, interface};
        return setsockopt(socket, IPPROTO_IPV6, v6, &group, sizeof group) == 0;
    }
    const struct ip_mreqn group = {.imr_multiaddr = to->v4.sin_addr, .imr_ifindex = (int)interface};
    return setsockopt(socket, IPPROTO_IP, v4, &group, sizeof group) == 0;
}

bool dis_udp_join(int socket, const DisSocketAddress *group, unsigned interface)
{
    return membership(socket, group, interface, IP_ADD_MEMBERSHIP, IPV6_ADD_MEMBERSHIP);
}

bool dis_udp_leave(int socket, const DisSocketAddress *group, unsigned interface)
{
    return membership(socket, group, interface, IP_DROP_MEMBERSHIP, IPV6_DROP_MEMBERSHIP);
}

/* Whether another socket listens on all addresses of the port: then only one of the two gets unicast datagrams. */
static bool port_shared(int port)
{
    static const char *const tables[2] = {"/proc/net/udp", "/proc/net/udp6"};
    char                     line[512], address[40];
    unsigned                 local;
    bool                     shared = false;
    for (int t = 0; t < 2 && !shared; t++) {
        FILE *table = fopen(tables[t], "r");
        while (table && !shared && fgets(line, sizeof line, table))
            shared = sscanf(line, " %*u: %39[0-9A-Fa-f]:%x", address, &local) == 2 && (int)local == port &&
                     strspn(address, "0") == strlen(address);
        if (table) fclose(table);
    }
    return shared;
}

static Status listen_there(const Plan *plan, int socket)
{
    const bool shared = plan->reach == REACH_BROADCAST || plan->reach == REACH_GROUP;
    /* both options, so that programs that set only one of them can share the port */
    if (shared && !(set_flag(socket, SOL_SOCKET, SO_REUSEADDR, 1) && set_flag(socket, SOL_SOCKET, SO_REUSEPORT, 1)))
        return refused(plan, "share");
    if (!set_flag(socket, SOL_SOCKET, SO_TIMESTAMPNS, 1) || !set_flag(socket, SOL_SOCKET, SO_RXQ_OVFL, 1))
        return refused(plan, "get arrival times for");
    set_buffer(socket, SO_RCVBUFFORCE, SO_RCVBUF, receive_buffer_octets);
    const bool other = plan->reach == REACH_BROADCAST && port_shared(plan->config->port);
    if (!bind_to(plan, socket)) return refused(plan, "listen on");
    if (plan->reach == REACH_GROUP && !dis_udp_join(socket, &plan->to, plan->interface)) return refused(plan, "join");
    if (other)
        log_info("udp: another program of this machine listens on port %d, too: a broadcast (127.255.255.255 within "
                 "this machine) or a multicast group reaches all of them, what is sent to one address only one",
                 plan->config->port);
    return STATUS_OK;
}

Status dis_udp_socket(int *out, DisSocketAddress *to, DisTie *tie, const DisUdpConfig *config, bool listen)
{
    Plan   plan;
    Status status = read_config(&plan, config);
    if (status != STATUS_OK) return status;

    const int family = plan.to.any.sa_family;
    const int made = socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (made < 0) return refused(&plan, "make a socket for");
    set_buffer(made, SO_SNDBUFFORCE, SO_SNDBUF, send_buffer_octets);
    /* datagrams to an address of this machine arrive by loopback, so no interface is used then */
    const bool narrow = config->interface[0] && plan.reach != REACH_OWN;
    if (family == AF_INET6 && !set_flag(made, IPPROTO_IPV6, IPV6_V6ONLY, 1)) status = refused(&plan, "set up");
    else if (narrow && setsockopt(made, SOL_SOCKET, SO_BINDTODEVICE, config->interface,
                                  (socklen_t)strnlen(config->interface, sizeof config->interface)) != 0)
        status = refused(&plan, "use the interface for");
    else if (!aim(&plan, made)) status = refused(&plan, "set up");
    else if (listen) status = listen_there(&plan, made);
    if (status != STATUS_OK) {
        close(made);
        return status;
    }
    *out = made;
    *to = plan.to;
    *tie = (DisTie){plan.interface, narrow, listen && plan.reach == REACH_GROUP, listen && plan.reach == REACH_OWN};
    return STATUS_OK;
}
