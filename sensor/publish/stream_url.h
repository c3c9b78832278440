/* sensor/publish/stream_url.h: addresses of the video streams: publish.stream is that of the first band, each further
 * band is at a port higher by 2 (RTP readers take the odd one for RTCP). */
#ifndef SENSOR_PUBLISH_STREAM_URL_H
#define SENSOR_PUBLISH_STREAM_URL_H

#include "pitviper.h"

enum { stream_url_size = 144, stream_port_step = 2 };

/* `udp://HOST:PORT` of stream n, from 0, with HOST as it stands in url. False, and empty: url has another form, or the
 * port is beyond 65535. */
bool stream_url(char out[stream_url_size], const char *url, int n);

#endif
