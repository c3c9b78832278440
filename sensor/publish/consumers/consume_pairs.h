/* sensor/publish/consumers/consume_pairs.h: each frame four times - with and without the target, with and without
 * noise - from one run, one seed and one noise field.
 *
 *     OUT/frames, raw                 with, noisy: as without pairs
 *     OUT/pairs/clean                 with, noiseless
 *     OUT/pairs/background            without, noisy; its radiance, truth and profiles too
 *     OUT/pairs/background_clean      without, noiseless
 *     OUT/pairs.jsonl                 a line per frame: removed entities, every file, values of black and white
 *
 * Radiance and radar contain no detector noise: a noiseless member names those of its noisy one. Without: the entity
 * is not drawn, and neither are its shadow, its echoes, the light it reflects onto others, its smoke, dust and flames,
 * and what it left on the ground: where it stood or stands, its tracks. All else stays: the ground, burnt ground, the
 * other entities and what is theirs, motion for the smear. Each member has detectors of its own: exposure, gain, level
 * and coupling follow its own image. Noise is a function of (seed, frame, pixel), the same for all; without a sensor
 * its sigma, too, is that of the frame with the target.
 *
 * A frame costs a second rendering, the files of a second frame, and three more runs of each band's detector
 * (tests/system/test_pairs.sh). */
#ifndef SENSOR_PUBLISH_CONSUMERS_CONSUME_PAIRS_H
#define SENSOR_PUBLISH_CONSUMERS_CONSUME_PAIRS_H

#include "sensor/frame/field.h"
#include "sensor/publish/consumers/consumers.h"

/* The inputs of the members. */
typedef struct PairsOf {
    const char    *out;    /* the run's folder; those below it are created */
    const Config  *config; /* publish.pairs: target or all */
    const char    *config_sha256;
    Pool          *pool;
    unsigned       bands, raw;
    const Sensors *sensors;
} PairsOf;

extern const FieldTable pair_fields; /* a line of pairs.jsonl */
/* Requires each frame without its target too (Frame.without). */
Status consume_pairs(Consumer **out, const PairsOf *made_of);
/* Which entities a frame is rendered without. */
typedef struct PairsTaken {
    bool        all; /* every entity but the host; else only aim */
    DisEntityId aim;
    int         host; /* snapshot index of the entity that stays; -1: none */
} PairsTaken;

/* Fills frame->without->snapshot: frame->seen.snapshot with the same indices, without the entities to be taken and
 * without their smoke and marks. Lists the ids of these entities in frame->taken. */
Status pairs_take_away(Frame *frame, const PairsTaken *take);

#endif
