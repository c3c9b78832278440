/* sensor/node/dis_network.c: the addresses of the configuration. */
#include "sensor/node/dis_network.h"

#include "dis/log.h"

DisUdpConfig dis_network(const Config *config)
{
    DisUdpConfig udp = dis_udp_default_config();
    if (config->exercise.port != dis_port_default && config->exercise.port != dis_port_any)
        udp.port = config->exercise.port;
    _Static_assert(sizeof udp.address == sizeof config->network.address, "one address");
    memcpy(udp.address, config->network.address, sizeof udp.address);
    memcpy(udp.interface, config->network.interface, sizeof udp.interface);
    udp.ttl          = config->network.ttl;
    udp.queue_octets = config->network.queue_mb << 20;
    return udp;
}

void dis_network_to(char out[dis_network_to_size], const DisUdpConfig *udp)
{
    snprintf(out, dis_network_to_size, "%s port %d", *udp->address ? udp->address : "255.255.255.255", udp->port);
}
