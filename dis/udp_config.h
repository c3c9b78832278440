/* dis/udp_config.h: where DIS datagrams are heard and sent. */
#ifndef DIS_UDP_CONFIG_H
#define DIS_UDP_CONFIG_H

#include "pitviper.h"

enum { dis_udp_address_size = 64 };

/* Where to listen and to send. */
typedef struct DisUdpConfig {
    char address[dis_udp_address_size]; /* IPv4 or IPv6 in numbers, where to send. What is heard on the port:
                                         * a multicast group: it is joined, nothing else is heard
                                         * an address of this machine: what comes to it, and no other program may listen
                                         * a broadcast, or empty for 255.255.255.255: whatever comes by IPv4
                                         * another machine's: whatever comes, and no other program may listen */
    char interface[32];                 /* name, `eth0`: nothing comes or leaves elsewhere (an address of this machine
                                         * is that already); empty: all, and the system chooses where to send */
    int  port;                          /* 1 .. 65535 */
    int  ttl;                           /* hops of multicast, 0 .. 255; 0: this machine alone */
    int  queue_octets;                  /* most that waits to be taken, headers of 32 octets included, 131072 .. 2^30;
                                         * beyond: the oldest stay, new ones are counted lost */
} DisUdpConfig;

#endif
