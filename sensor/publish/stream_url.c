/* sensor/publish/stream_url.c: addresses of the video streams, one per band. */
#include "sensor/publish/stream_url.h"

bool stream_url(char out[stream_url_size], const char *url, int n)
{
    static const char scheme[] = "udp://";
    const char       *colon    = strrchr(url, ':');
    int               port = 0, digits = 0;
    *out = 0;
    if (strncmp(url, scheme, strlen(scheme)) != 0 || !colon || colon <= url + strlen(scheme)) return false;
    for (const char *at = colon + 1; *at; at++, digits++) {
        if (*at < '0' || *at > '9' || digits == 5) return false;
        port = 10 * port + (*at - '0');
    }
    if (digits == 0 || port < 1 || port + stream_port_step * n > 65535) return false;
    const int length = snprintf(out, stream_url_size, "%.*s:%d", (int)(colon - url), url, port + stream_port_step * n);
    if (length < stream_url_size) return true;
    *out = 0;
    return false;
}
