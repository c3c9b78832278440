/* sensor/publish/video/video_output.h: the outputs of an encoded video: a file or a stream. */
#ifndef SENSOR_PUBLISH_VIDEO_VIDEO_OUTPUT_H
#define SENSOR_PUBLISH_VIDEO_VIDEO_OUTPUT_H

#include "sensor/frame/publish_counters.h"
#include "sensor/settings/publish_choice.h"
#include "sensor/publish/consumers/consumer.h"
#include "sensor/publish/video/video_transport.h"
#include "sensor/publish/video/video_names.h"

/* ---- MPEG-TS over UDP ---------------------------------------------------------------------------- */

/* Sends MPEG-TS over UDP: datagrams of at most 7 packets, to a host or a group.
 *
 * Never waits: what the kernel does not take at once is lost and counted. A receiver that is absent or vanishes is
 * reported once, and once more when it is back. */

typedef struct VideoUdp VideoUdp;

/* interface: its name; empty: the system's choice. ttl: of multicast; local programs receive it in any case. Logged. */
Status video_udp_open(VideoUdp **out, const StreamUrl *to, const char *interface, int ttl);

/* ---- an output of either kind -------------------------------------------------------------------- */

/* One destination of an encoded video: a stream or a file.
 *
 * A file that cannot be written: patient, the frames it lacks are counted, reported once, and writing is retried at
 * intervals (consumer.h), beginning with a key frame; otherwise it is an error. A stream never fails. */

typedef struct VideoOutput {
    VideoKind         kind;
    KlvMode           klv;
    bool              patient;
    VideoUdp         *udp;                   /* of a stream, open; NULL: a file */
    StreamCounters   *sent;                  /* its counters are added to these at the end; NULL: nowhere */
    char              path[video_path_size]; /* of a file */
    char              title[32];
    struct VideoFile *file;
    Transport        *transport; /* NULL: not yet, or not at present */
    bool              needs_key; /* nothing can be decoded before one */
    RetryBackoff      retry;
} VideoOutput;

/* Whether the next frame must be a key frame for this output. */
bool   video_output_needs_key(const VideoOutput *output);
Status video_output_put(VideoOutput *output, const Encoder *encoder, const VideoPacket *packet, int64_t pts_90k,
                        const uint8_t *klv, size_t klv_count);
/* Ends the file, or the stream. */
Status video_output_close(VideoOutput *output);

#endif
