/* sensor/publish/consumers/consumers.h: makes the consumers of this folder; klv, memory, video and Data PDUs have
 * folders of their own (publish/.../consume_*.h).
 *
 * Their arguments must outlive them. Folders and files that they write are made by their begin. */
#ifndef SENSOR_PUBLISH_CONSUMERS_CONSUMERS_H
#define SENSOR_PUBLISH_CONSUMERS_CONSUMERS_H

#include "sensor/publish/coco/coco.h"
#include "sensor/publish/consumers/consumer.h"
#include "sensor/publish/files/frame_files.h"

/* Makes frame.display of every frame put, in order, by a camera of its own; in a list it comes before the consumers
 * that want it. counts: it makes raw counts too. */
Status consume_displays(Consumer **out, const Config *config, const Sensors *sensors, Pool *pool, bool counts);

/* OUT/frames, raw and profiles (frame_files.h). patient: a frame that cannot be written is dropped, reported, and
 * writing is retried at intervals (consumer.h). */
typedef struct PictureFiles {
    const char   *out;
    const Config *config;
    Pool         *pool; /* of the thread that puts */
    bool          patient;
} PictureFiles;
Status consume_pictures(Consumer **out, const PictureFiles *made_of);

/* OUT/radar: NNNNNN.csv, the range profile; .exr, the map of range and Doppler; .png, the same to look at. Of frames
 * with a measurement of a radar (radar_of). */
Status consume_radar(Consumer **out, const PictureFiles *made_of);

/* Writes OUT/latest/BAND.png: the newest display of each band, 8 bits, replaced as a whole. patient: as above. */
Status consume_latest(Consumer **out, const char *folder, bool patient);

/* OUT/truth.jsonl, a line per frame. patient: a line that cannot be written is dropped; failed: how many, when
 * closed. */
Status consume_truth_lines(Consumer **out, const char *folder, bool patient, int *failed);

/* OUT/coco.json. */
Status consume_coco(Consumer **out, const char *folder, const Config *config, const char *config_sha256);

/* Passes each frame to a function: health of a live node, tests. targets: its record has its targets. */
typedef void FrameCall(void *user, const Frame *frame);
Status       consume_by_call(Consumer **out, FrameCall *call, void *user, bool targets);

/* Takes the hash of each frame (hashes false: none) and calls done for each when it has been published. It is the last
 * of a list. */
typedef void FrameDone(void *user, const Frame *frame);
Status       consume_hashes(Consumer **out, FrameDone *done, void *user, bool hashes);

#endif
