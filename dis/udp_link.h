/* dis/udp_link.h: monitors whether the interface, address and group of a socket still exist; for udp.c only.
 *
 * An interface that is deleted and recreated has another index: the socket that was bound to it, and the group that was
 * joined on it, never receive again, without an error. So the kernel's notifications (rtnetlink(7)) are read, and the
 * state is also polled once a second for cases without one. */
#ifndef DIS_UDP_LINK_H
#define DIS_UDP_LINK_H

#include "dis/udp_socket.h"

typedef enum DisLinkState {
    DIS_LINK_UP,
    DIS_LINK_GONE,       /* the named interface does not exist */
    DIS_LINK_DOWN,       /* it does, and is set down */
    DIS_LINK_NO_CARRIER, /* it is set up, and nothing is at its other end */
    DIS_LINK_NO_ADDRESS, /* the address that is listened on is no longer one of this machine's */
    DIS_LINK_NO_ROUTE,   /* no interface leads to the group */
} DisLinkState;

typedef struct DisLink {
    int          watch;        /* announcements; -1: none, or a sender */
    bool         listens;
    bool         lost;         /* its interface was deleted since the socket was made */
    DisLinkState state, said;  /* reported: the state last logged */
    int64_t      since_ns;     /* of the state; monotonic */
} DisLink;

/* To be polled for POLLIN; -1 where the system has none. */
int  dis_link_watch(void);
/* Reads all announcements; notes whether an interface that the socket depends on was deleted. */
void dis_link_read(DisLink *link, int socket, const DisSocketAddress *to, const DisTie *tie);
/* Polls the state, and joins the group again where no interface was named. remake: the socket must be recreated; the
 * caller then clears lost. Once a second and after notifications. */
void dis_link_check(DisLink *link, bool *remake, int socket, const DisSocketAddress *to, const DisTie *tie,
                   const DisUdpConfig *config);
/* Of the last read or poll: one line when it is no longer up, one when it is again; one more when the reason is another
 * for two seconds. where: of dis_udp_where. dis_link_unreported: to be checked again in a tenth of a second. */
static inline bool dis_link_unreported(const DisLink *link) { return link->state != link->said; }
void dis_link_report(DisLink *link, const char *where, const DisUdpConfig *config);
/* `the interface eth0 is down`, for people. */
enum { dis_link_text_size = 256 };
void dis_link_text(char out[dis_link_text_size], DisLinkState state, const DisUdpConfig *config);

#endif
