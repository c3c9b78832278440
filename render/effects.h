/* render/effects.h: puffs of the snapshot as volumes that shine, scatter and hide: once a frame. */
#ifndef RENDER_EFFECTS_H
#define RENDER_EFFECTS_H

#include "entities/snapshot.h"
#include "render/air.h"
#include "render/veil.h"

typedef struct EffectScene {
    int         count;
    VeilVolume *volume; /* sorted by range */
} EffectScene;

/* Volumes that the view can see, with the air between them and the eye. bands: 1 << band of veil.h that will be asked
 * for. ground_rho: of the lit ground below, by optical channel. No puffs: count 0, and nothing is done. */
Status effects_scene(EffectScene *out, const Snapshot *snapshot, const LocalFrame *frame, const View *view,
                     const Air *air, const float *ground_rho, unsigned bands, Arena *arena);

#endif
