/* sensor/publish/video/video_output_private.h: the outputs of an encoded video, a file or a stream, and the
 * containers that they write. */
#ifndef SENSOR_PUBLISH_VIDEO_VIDEO_OUTPUT_PRIVATE_H
#define SENSOR_PUBLISH_VIDEO_VIDEO_OUTPUT_PRIVATE_H

#include "sensor/publish/video/video_encoder_private.h"
#include "sensor/frame/publish_counters.h"
#include "sensor/settings/publish_choice.h"
#include "sensor/publish/consumers/consumer.h"
#include "sensor/publish/video/video_names.h"

/* ---- containers (video_transport.c) ---------------------------------------------------------- */

/* A transport writes packets of video and of KLV metadata into a container: MPEG-TS, MP4 or Matroska.
 *
 * MPEG-TS: the video's PID is 0x100, the metadata's 0x101. Times are exercise time in 90 kHz, 33 bits that wrap.
 * Program tables every 0.1 s or with every frame if those are rarer, so that a receiver may join at any key frame.
 * Metadata comes just before its frame.
 *     asynchronous   stream type 0x06, registered as KLVA, stream id 0xBD, no time stamp (MISB ST 1402)
 *     synchronous    stream type 0x15, stream id 0xFC, the frame's time stamp, metadata AU cells
 * MP4 is fragmented, a fragment for each key frame, and Matroska begins a cluster there: what a run that was killed
 * leaves behind can be played. Both start at 0, and carry no metadata. */
enum { klv_octets_most = 60000 }; /* of a frame: fits into one PES packet */

/* Where the bytes go: MPEG-TS in whole packets of 188 octets, at most transport_octets at a time. seek goes to an
 * absolute position; NULL: it cannot. When one of them returns false it failed, and the transport reports that. */
enum { transport_octets = 7 * 188 };
typedef struct TransportSink {
    bool (*write)(void *user, const uint8_t *bytes, size_t count);
    bool (*seek)(void *user, int64_t position);
    void *user;
} TransportSink;

typedef struct TransportConfig {
    VideoKind     container; /* VIDEO_TS, VIDEO_MP4 or VIDEO_MKV */
    enum KlvMode  klv;       /* of VIDEO_TS */
    const char   *title;
    TransportSink sink;
} TransportConfig;

typedef struct Transport Transport;

/* Logged failures: STATUS_UNSUPPORTED: the container does not take this video; STATUS_IO: the sink's. */
Status video_transport_open(Transport **out, const TransportConfig *config, const Encoder *encoder);
/* Puts one frame: on return the sink has all of it (MP4 and Matroska: with the next key frame). klv may be NULL, count
 * klv_octets_most at most. pts_90k increases. STATUS_IO: the sink failed; nothing is logged. */
Status video_transport_put(Transport *transport, const VideoPacket *packet, int64_t pts_90k, const uint8_t *klv,
                           size_t klv_count);
/* What the container still keeps goes to the sink. STATUS_IO as above. */
Status video_transport_flush(Transport *transport);
/* Ends the file and frees it; finish false: frees it without a further byte. STATUS_IO as above. NULL is valid. */
Status video_transport_close(Transport *transport, bool finish);
/* The sink lost bytes that it had reported as written: do not record positions at the end. */
void video_transport_forget_positions(Transport *transport);

/* ---- MPEG-TS over UDP ---------------------------------------------------------------------------- */

/* Sends MPEG-TS over UDP: datagrams of at most 7 packets, to a host or a group.
 *
 * Never waits: what the kernel does not take at once is lost and counted. A receiver that is absent or vanishes is
 * reported once, and once more when it is back. */

typedef struct VideoUdp VideoUdp;

/* interface: its name; empty: the system chooses. ttl: that of multicast; local programs receive it in any case.
 * Failures are logged. */
Status video_udp_open(VideoUdp **out, const StreamUrl *to, const char *interface, int ttl);

/* ---- an output of either kind -------------------------------------------------------------------- */

/* One destination of an encoded video: a stream or a file.
 *
 * A file that cannot be written: patient, the frames it lacks are counted, reported once, and writing is retried at
 * intervals (consumer.h), beginning with a key frame; otherwise it is an error. A stream never fails. */

typedef struct VideoOutput {
    VideoKind         kind;
    enum KlvMode      klv;
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
bool video_output_needs_key(const VideoOutput *output);

/* An encoded frame and its metadata; klv_count 0: none. */
typedef struct VideoUnit {
    VideoPacket    packet;
    int64_t        pts_90k;
    const uint8_t *klv;
    size_t         klv_count;
} VideoUnit;
Status video_output_put(VideoOutput *output, const Encoder *encoder, const VideoUnit *unit);
/* Ends the file, or the stream. */
Status video_output_close(VideoOutput *output);

/* ---- an output in a thread of its own (video_writer.c) ----------------------------------------- */

/* Writes a file in a thread of its own; what that one is too late for is left out and counted, also in the ledger. */
typedef struct VideoWriter VideoWriter;
#define video_file_name "video_file" /* in the latency ledger */

/* The output is the writer's from then on, and freed with it. */
Status video_writer_open(VideoWriter **out, VideoOutput *output);
bool   video_writer_needs_key(VideoWriter *writer);
/* Copies all. */
void video_writer_put(VideoWriter *writer, Encoder *encoder, const VideoUnit *unit, const Frame *frame);
/* Writes what waits and ends the file. STATUS_IO: the disk hangs; writer and output stay as they are. */
Status video_writer_close(VideoWriter *writer);

#endif
