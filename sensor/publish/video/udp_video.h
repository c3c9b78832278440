/* sensor/publish/video/udp_video.h: sends MPEG-TS over UDP: datagrams of at most 7 packets, to a host or a group.
 *
 * Never waits: what the kernel does not take at once is lost and counted. A receiver that is absent or vanishes is
 * reported once, and once more when it is back. */
#ifndef SENSOR_PUBLISH_VIDEO_UDP_VIDEO_H
#define SENSOR_PUBLISH_VIDEO_UDP_VIDEO_H

#include "sensor/settings/video_choice.h"

typedef struct UdpVideoCounters {
    uint64_t sent, refused, lost; /* datagrams: taken by the kernel; no receiver or no route; full buffers */
} UdpVideoCounters;

typedef struct UdpVideo UdpVideo;

/* interface: its name; empty: the system's choice. ttl: of multicast; local programs receive it in any case. Logged. */
Status udp_video_open(UdpVideo **out, const StreamUrl *to, const char *interface, int ttl);
void   udp_video_close(UdpVideo *udp); /* NULL is valid */
/* count: at most 7 packets of 188 octets. */
void   udp_video_send(UdpVideo *udp, const uint8_t *bytes, size_t count);
const UdpVideoCounters *udp_video_counters(const UdpVideo *udp);

#endif
