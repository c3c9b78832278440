/* dis/udp_config.h: addresses for receiving and sending DIS datagrams. */
#ifndef DIS_UDP_CONFIG_H
#define DIS_UDP_CONFIG_H

#include "pitviper.h"

enum { dis_udp_address_size = 64 };

/* Where to listen and to send. */
typedef struct DisUdpConfig {
    char address[dis_udp_address_size]; /* Destination address, numeric IPv4 or IPv6. Received on the port:
                                         * a multicast group: it is joined, nothing else is received
                                         * an address of this machine: datagrams to it, and no other program may listen
                                         * a broadcast, or empty for 255.255.255.255: all IPv4 datagrams
                                         * another machine's: all datagrams, and no other program may listen */
    char interface[32];                 /* name, `eth0`: the only interface used (implied by an address of this
                                         * machine); empty: receives on all, and the system chooses where to send */
    int  port;                          /* 1 .. 65535 */
    int  ttl;                           /* hops of multicast, 0 .. 255; 0: this machine alone */
    int  queue_octets;                  /* most that waits to be taken, headers of 32 octets included, 131072 .. 2^30;
                                         * beyond: the oldest stay, new ones are counted lost */
} DisUdpConfig;

#endif
