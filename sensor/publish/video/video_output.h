/* sensor/publish/video/video_output.h: one destination of an encoded video: a stream or a file.
 *
 * A file that cannot be written: patient, the frames it lacks are counted, reported once, and writing is retried at
 * intervals (retry_backoff.h), beginning with a key frame; otherwise it is an error. A stream never fails. */
#ifndef SENSOR_PUBLISH_VIDEO_VIDEO_OUTPUT_H
#define SENSOR_PUBLISH_VIDEO_VIDEO_OUTPUT_H

#include "sensor/publish/retry_backoff.h"
#include "sensor/publish/video/transport.h"
#include "sensor/publish/video/udp_video.h"
#include "sensor/publish/video/video_file.h"
#include "sensor/publish/video/video_names.h"

typedef struct VideoOutput {
    VideoKind    kind;
    KlvMode      klv;
    bool         patient;
    UdpVideo    *udp;       /* of a stream, open; NULL: a file */
    StreamCounters *sent;   /* its counters are added to these at the end; NULL: nowhere */
    char         path[video_path_size]; /* of a file */
    char         title[32];
    VideoFile   *file;
    Transport   *transport; /* NULL: not yet, or not at present */
    bool         needs_key; /* nothing can be decoded before one */
    RetryBackoff retry;
} VideoOutput;

/* Whether the next frame must be a key frame for this output. */
bool   video_output_needs_key(const VideoOutput *output);
Status video_output_put(VideoOutput *output, const Encoder *encoder, const VideoPacket *packet, int64_t pts_90k,
                        const uint8_t *klv, size_t klv_count);
/* Ends the file, or the stream. */
Status video_output_close(VideoOutput *output);

#endif
