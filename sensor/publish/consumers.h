/* sensor/publish/consumers.h: the consumers that there are, each in a file of its own.
 *
 * What they are given must outlive them. Folders and files that they write begin empty. */
#ifndef SENSOR_PUBLISH_CONSUMERS_H
#define SENSOR_PUBLISH_CONSUMERS_H

#include "sensor/publish/coco.h"
#include "sensor/publish/consumer.h"
#include "sensor/publish/frame_files.h"
#include "sensor/publish/retry_backoff.h"

/* Detectors of each band, taken over by the consumer that is made of them, also when that fails. */
typedef struct Chains {
    Chain *band[BAND_COUNT];
} Chains;
void chains_destroy(Chains *chains);

/* OUT/frames, raw and profiles (frame_files.h). level: of its displays, [BAND_COUNT], the caller's, so that others in
 * the same thread may read what they last showed. spare: NULL, or detectors for frames that are left out: the memory of
 * an automatic level takes part of those too, so that what is shown later does not depend on what was left out; with
 * them a frame that cannot be written is left out, told, and tried again now and then (patience.h). */
typedef struct PictureFiles {
    const char   *out;
    const Config *config;
    Pool         *pool;      /* of the thread that puts */
    FrameLevel   *level;
    Chains        chains;
    Chains       *spare;
} PictureFiles;
Status consume_pictures(Consumer **out, const PictureFiles *made_of);

/* OUT/truth.jsonl, a line a frame. patient: a line that cannot be written is left out; failed: how many, when
 * closed. */
Status consume_truth_lines(Consumer **out, const char *folder, bool patient, int *failed);

/* OUT/coco.json. */
Status consume_coco(Consumer **out, const char *folder, const Config *config, const char *config_sha256);

/* Each frame's record, to a function: DIS records of a live node, tests. */
typedef void FrameCall(void *user, const FrameRecord *record);
Status consume_by_call(Consumer **out, FrameCall *call, void *user);

/* The hash of each frame, and that it has been published: the last of a list. done is called for each. */
typedef void FrameDone(void *user, const Frame *frame);
Status consume_hashes(Consumer **out, FrameDone *done, void *user);

#endif
