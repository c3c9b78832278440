/* render/scene/skip.h: skips: computations left out because they cannot change a bit of the result; each is named and
 * counted.
 *
 * Each may be disabled separately (RenderRequest.skips_off); the planes stay the same to the bit
 * (tests/sensor/test_skips.c, over random scenes), and `pitviper bench skip` reports what each saves. */
#ifndef RENDER_SCENE_SKIP_H
#define RENDER_SCENE_SKIP_H

#include "pitviper.h"

typedef enum Skip {
    SKIP_BLOCK,         /* view-frustum cull: entities whose sphere a block of pixels cannot see */
    SKIP_SPHERE,        /* an entity, for rays that miss its sphere or met something before it */
    SKIP_PART,          /* a part, for rays that miss the entity's box or the part's sphere */
    SKIP_GROUND_BEHIND, /* ground beyond the part that a ray met */
    SKIP_GROUND_BELOW,  /* ground that is below all of a block's rays up to the parts they met */
    SKIP_GROUND_WALK,   /* steps of the ground's pyramid that neighbouring rays share */
    SKIP_SUN_SPHERE,    /* an entity, for sun rays that miss its sphere or are stopped already */
    SKIP_SUN_STOPPED,   /* ground and plants, for sun rays that are stopped already */
    SKIP_SUN_CLEAR,     /* ground, for sun rays from where nothing towards the sun is high enough */
    SKIP_AMODAL,        /* the amodal test of an entity, for rays on which none of it is behind the hit */
    SKIP_CELL,          /* rays over a small target's box that miss it, and meeting it a second time */
    SKIP_RETRACE,       /* a pixel's first ray, when more are traced: its planes still hold its hit */
    SKIP_SMOKE,         /* smoke and dust that a block of pixels cannot see */
    SKIP_LIGHT,         /* light of sample points that a neighbouring hit has computed already in this frame, or none needs */
    SKIP_TREE,          /* entities that the tree of their spheres leaves out: blocks, rays, sun rays, places near */
    SKIP_KEPT,          /* paths from sample points whose meetings an earlier frame left (render/light/sky_kept.h) */
    SKIP_COUNT
} Skip;

enum { skips_all_off = (1 << SKIP_COUNT) - 1 };

const char *skip_name(Skip skip); /* as in run.json: "block", "sphere" ... */
const char *skip_what(Skip skip); /* one line of description, with the unit of its count */

static inline bool skips(unsigned off, Skip skip) { return !(off >> skip & 1); }

#endif
