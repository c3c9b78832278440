/* sensor/publish/video/udp_video.h: sends MPEG-TS over UDP: datagrams of at most 7 packets, to a host or a group.
 *
 * Never waits: what the kernel does not take at once is lost and counted. A receiver that is absent or vanishes is
 * reported once, and once more when it is back. */
#ifndef SENSOR_PUBLISH_VIDEO_UDP_VIDEO_H
#define SENSOR_PUBLISH_VIDEO_UDP_VIDEO_H

#include "sensor/publish/sent_counters.h"
#include "sensor/settings/publish_choice.h"

typedef struct UdpVideo UdpVideo;

/* interface: its name; empty: the system's choice. ttl: of multicast; local programs receive it in any case. Logged. */
Status udp_video_open(UdpVideo **out, const StreamUrl *to, const char *interface, int ttl);
/* Adds its counters to others; NULL: nowhere. Warns if not one datagram left. NULL is valid. */
void   udp_video_close(UdpVideo *udp, StreamCounters *sum);
/* count: at most 7 packets of 188 octets. */
void   udp_video_send(UdpVideo *udp, const uint8_t *bytes, size_t count);
#endif
