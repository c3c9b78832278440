/* sensor/node/pairs.h: each frame four times - with and without what is looked at, with and without noise - from one
 * run, one seed and one noise field.
 *
 *     OUT/frames, raw                 with, noisy: as ever
 *     OUT/pairs/clean                 with, noiseless
 *     OUT/pairs/background            without, noisy; its radiance, truth and profiles too
 *     OUT/pairs/background_clean      without, noiseless
 *     OUT/pairs.jsonl                 a line a frame: what was taken away, every file, what black and white stand for
 *
 * Radiance and radar hold no detector noise: a noiseless member names those of its noisy one. Without: the entity is not
 * drawn, and with it go its shadow, its echoes and the light it threw on others. All else stays: the ground, the other
 * entities, smoke and dust, its own too (they hang in the air; their veil is the same in both), motion for the smear. Each
 * member has detectors of its own: exposure, gain, level and coupling follow what it sees. Noise is a function of (seed,
 * frame, pixel), the same for all; without a sensor its sigma, too, is that of the frame with the target.
 *
 * A frame costs a second rendering, the files of a second frame, and three more runs of each band's detector
 * (tests/system/test_pairs.sh). */
#ifndef SENSOR_NODE_PAIRS_H
#define SENSOR_NODE_PAIRS_H

#include "sensor/node/session.h"
#include "sensor/node/frame_files.h"

typedef struct Pairs Pairs;

/* As publish.pairs says. Makes the folders below out, which are clear; shared must outlive it. raw: bands. */
Status pairs_open(Pairs **out, const SessionShared *shared, const char *folder, unsigned raw);
/* The other members of a frame that has been written. sha256: of its planes; aim: what is taken away, unless all are;
 * host: snapshot index, stays; -1. */
Status pairs_frame(Pairs *pairs, const FrameFiles *files, const char *sha256, const Air *air,
                   const double r_host_from_enu[9], DisEntityId aim, int host, Arena *arena);
/* STATUS_IO, logged, when pairs.jsonl could not be finished. NULL is fine. */
Status pairs_close(Pairs *pairs);

#endif
