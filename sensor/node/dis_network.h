/* sensor/node/dis_network.h: the addresses of the configuration: where a node listens, where it and a replay send. */
#ifndef SENSOR_NODE_DIS_NETWORK_H
#define SENSOR_NODE_DIS_NETWORK_H

#include "dis/udp.h"
#include "sensor/settings/config.h"

/* exercise.port, or 3000 where it is chosen or any. */
DisUdpConfig dis_network(const Config *config);

/* The destination, for messages. */
enum { dis_network_to_size = dis_udp_address_size + 16 };
void dis_network_to(char out[dis_network_to_size], const DisUdpConfig *udp);

#endif
