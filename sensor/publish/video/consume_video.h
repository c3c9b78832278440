/* sensor/publish/video/consume_video.h: the consumer that publishes videos and streams (publish.video, publish.stream).
 *
 *     stream        per band MPEG-TS over UDP, with metadata; band i of the run at the port plus 2 i
 *     folder        per band FOLDER/BAND.ts, with metadata, and BAND.mp4; ffv1: FOLDER/BAND.mkv
 *     a file        all bands side by side; metadata in a .ts of one band
 *
 * A band is encoded once for all of its destinations. Time stamps are exercise time; frames left out leave gaps. */
#ifndef SENSOR_PUBLISH_VIDEO_CONSUME_VIDEO_H
#define SENSOR_PUBLISH_VIDEO_CONSUME_VIDEO_H

#include "sensor/publish/consumers/consumer.h"
#include "sensor/frame/publish_counters.h"
#include "sensor/publish/video/video_names.h"
#include "sensor/publish/klv/consume_klv.h"

typedef struct VideoOf {
    const Config *config;
    unsigned      to;          /* VideoTo: outputs to use where they are configured; encoded once for both */
    unsigned      bands;       /* rendered */
    double        rate_hz;     /* of the run */
    const char   *host_folder; /* of several hosts: this one's, below that of the videos; NULL: the only one */
    bool          apart; /* with patient: each file is written in a thread of its own, and loses what it is late for */
    Latency      *latency;   /* files that are apart are in it, `video_file`; NULL: none is kept */
    bool          patient;   /* live: what cannot be encoded or written is counted and retried */
    const Geoid  *geoid;     /* NULL: no heights above mean sea level */
    StreamCounters *sent;    /* of all streams, added at the end; NULL: nowhere */
    Answers        *answers; /* of a recogniser, for publish.vmti=atr; outlive the consumer; NULL: none */
} VideoOf;

/* Loads FFmpeg's libraries where a video or a stream is configured, and what the letters of its labels need; a command
 * that may publish one calls it on the main thread, before its pool starts. STATUS_IO, logged with what to install. */
Status video_prepare(const Config *config);

/* STATUS_UNSUPPORTED, logged: the program was built without FFmpeg's libraries, or several hosts would share a file or
 * stream. */
Status consume_video(Consumer **out, const VideoOf *of);

#endif
