/* sensor/settings/video_choice.h: what publish.video, publish.stream and publish.video_codec ask for.
 *
 * Compiled with and without FFmpeg's libraries: without them both keys are refused, with a next step. */
#ifndef SENSOR_SETTINGS_VIDEO_CHOICE_H
#define SENSOR_SETTINGS_VIDEO_CHOICE_H

#include "pitviper.h"

/* An IPv4 address and a port. */
typedef struct StreamUrl {
    uint8_t  address[4]; /* as written: 239 1 2 3 */
    uint16_t port;
} StreamUrl;

/* udp://A.B.C.D:PORT, decimal without leading zeros, port 1 .. 65535, nothing behind it. False: *out is unchanged; why:
 * what is wrong, in static storage. */
bool stream_url_parse(StreamUrl *out, const char **why, const char *text);
static inline bool stream_url_multicast(const StreamUrl *url) { return url->address[0] >> 4 == 14; }
enum { stream_port_step = 2 }; /* from one band to the next */

/* Of publish.video, by the end of its name. */
typedef enum VideoKind { VIDEO_NONE, VIDEO_FOLDER, VIDEO_MP4, VIDEO_MKV, VIDEO_TS } VideoKind;
VideoKind video_kind(const char *path);

typedef enum VideoCodec { VIDEO_H264, VIDEO_H264_10, VIDEO_HEVC_12, VIDEO_FFV1 } VideoCodec;
VideoCodec video_codec(const char *name); /* of the setting */

/* STATUS_BAD_VALUE, logged: contradictions between these settings, with a next step. Part of config_check. */
Status video_choice_check(const char *video, const char *stream, const char *codec, const char *bands);

#endif
