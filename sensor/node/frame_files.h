/* sensor/node/frame_files.h: one frame's pictures into OUT/frames/<band>/NNNNNN.exr and .png. */
#ifndef SENSOR_NODE_FRAME_FILES_H
#define SENSOR_NODE_FRAME_FILES_H

#include "render/render.h"
#include "sensor/node/config.h"
#include "sensor/publish/plane_hash.h"

typedef struct FrameFiles {
    const char     *out;            /* folder of this host; exists, with its subfolders */
    const Config   *config;
    const World    *world;
    const Picture  *picture;
    const Snapshot *snapshot;
    const RenderRequest *request;
    const char     *host, *config_sha256;
    int             frame;
    double          time_s, unix_s;
    bool            png;
} FrameFiles;

/* clear: takes away what an earlier run left in OUT (known by its truth.jsonl or run.json), nothing else.
 * prepare: that, and makes OUT and the folders below it for these bands; a clear message when the place
 * cannot be written. */
void   frame_files_clear(const char *out);
Status frame_files_prepare(const char *out, unsigned bands);
/* Sigma of the detector's noise in one optical channel, W/(m2 sr): a share of the picture's mean. */
double frame_optical_sigma(const Picture *picture, const Config *config);
/* Writes everything of the frame, a task a file. hash: over all planes, before encoding. */
Status frame_files_write(char hash[sha256_text_size], const FrameFiles *frame, Pool *pool);

#endif
