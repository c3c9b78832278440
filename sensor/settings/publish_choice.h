/* sensor/settings/publish_choice.h: what publish.* asks for: truth planes, shared memory, videos and streams. */
#ifndef SENSOR_SETTINGS_PUBLISH_CHOICE_H
#define SENSOR_SETTINGS_PUBLISH_CHOICE_H

#include "sensor/settings/config.h"
#include "render/frame/planes.h"

/* ---- truth planes ------------------------------------------------------------------------------------- */

/* Truth planes written to files (publish.planes, --planes), by their names in render/frame/planes.h. All that are not
 * made for the file are computed in any case: truth.jsonl, coco.json and the hash of a frame do not depend on the
 * choice. */

/* all, none, or a list of names with commas. False: it is neither, and the set is empty. */
bool publish_planes_parse(PlaneSet *planes, const char *text);
/* The i-th name, in the order of help: those of every run, of bands, of plants; NULL at the end. */
const char *publish_planes_name(int i);
/* What is wrong with a list that is refused: "; NAME is named twice", "; did you mean NAME?", or "". */
void publish_planes_why(char *out, size_t out_size, const char *text);

/* ---- shared memory ------------------------------------------------------------------------------------ */

/* Checks publish.memory, the name of a ring, and publish.memory_planes. sensor: whether a band has one.
 * STATUS_BAD_VALUE, logged with what to do. Part of config_check. */
Status publish_memory_check(const Config *config, bool sensor);

/* ---- videos and streams ------------------------------------------------------------------------------- */

/* An IPv4 address and a port. */
typedef struct StreamUrl {
    uint8_t  address[4]; /* as written: 239 1 2 3 */
    uint16_t port;
} StreamUrl;

/* udp://A.B.C.D:PORT, decimal without leading zeros, port 1 .. 65535, nothing behind it. False: *out is unchanged; why:
 * what is wrong, in static storage. */
bool               publish_stream_parse(StreamUrl *out, const char **why, const char *text);
static inline bool publish_stream_multicast(const StreamUrl *url) { return url->address[0] >> 4 == 14; }
enum { publish_stream_port_step = 2 }; /* from one band to the next */

/* The kind of publish.video, by the end of its name. */
typedef enum VideoKind { VIDEO_NONE, VIDEO_FOLDER, VIDEO_MP4, VIDEO_MKV, VIDEO_TS } VideoKind;
VideoKind video_kind(const char *path);

/* STATUS_BAD_VALUE, logged: contradictions between these settings, with a next step. Without FFmpeg's libraries
 * videos and streams are refused. Part of config_check. */
Status publish_video_check(const Config *config);

#endif
