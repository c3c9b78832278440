/* sensor/publish/video/consume_video.h: the consumer that publishes videos and streams (publish.video, publish.stream).
 *
 *     stream        per band MPEG-TS over UDP, with metadata; band i of the run at the port plus 2 i
 *     folder        per band FOLDER/BAND.ts, with metadata, and BAND.mp4; ffv1: FOLDER/BAND.mkv
 *     a file        all bands side by side; metadata in a .ts of one band
 *
 * A band is encoded once for all of its destinations. Time stamps are exercise time; frames left out leave gaps. */
#ifndef SENSOR_PUBLISH_VIDEO_CONSUME_VIDEO_H
#define SENSOR_PUBLISH_VIDEO_CONSUME_VIDEO_H

#include "sensor/publish/consumer.h"
#include "sensor/publish/klv/klv.h"
#include "sensor/settings/config.h"

/* A recogniser's targets in this frame, or NULL: none are known. Valid until the next call. */
typedef const KlvTargets *VideoDetections(void *user, const Frame *frame, Band band);

typedef enum VideoTo { VIDEO_TO_STREAM = 1, VIDEO_TO_FILE = 2 } VideoTo;

typedef struct VideoOf {
    const Config    *config;
    unsigned         to;          /* VideoTo: which of those that are configured; encoded once for both */
    unsigned         bands;       /* rendered */
    double           rate_hz;     /* of the run */
    const char      *host_folder; /* of several hosts in a run: this one's, below that of the videos; NULL: the only one */
    bool             patient;     /* live: what cannot be encoded or written is counted and retried */
    const Geoid     *geoid;       /* NULL: no heights above mean sea level */
    VideoDetections *detections;  /* publish.vmti=atr; NULL: none */
    void            *user;
} VideoOf;

/* STATUS_UNSUPPORTED, logged: built without FFmpeg's libraries; or a file or stream of several hosts. */
Status consume_video(Consumer **out, const VideoOf *of);

/* Of a configuration: what there is to publish; 0: nothing. */
unsigned video_wanted(const Config *config);

/* Whether a video that this run would replace exists, and its path. */
enum { video_found_size = 4096 };
bool   video_earlier(char found[video_found_size], const Config *config, unsigned bands, const char *host_folder);

/* Per stream the lines that a person types to watch it, each with its newline. Empty: there is no stream. */
void   video_watch_lines(char *out, size_t out_size, const Config *config, unsigned bands);

#endif
