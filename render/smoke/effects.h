/* render/smoke/effects.h: the snapshot's puffs as volumes that emit, scatter and absorb: prepared once a frame. */
#ifndef RENDER_SMOKE_EFFECTS_H
#define RENDER_SMOKE_EFFECTS_H

#include "entities/table/snapshot.h"
#include "render/air/air.h"
#include "render/smoke/smoke_volume.h"

typedef struct EffectScene {
    int         count;
    SmokeVolume *volume; /* sorted by range */
} EffectScene;

/* Volumes inside the view frustum, with the air between them and the eye. hidden: the snapshot index of the host,
 * whose own smoke its eye does not see, as it does not see its own parts (a missile's reported and interpolated
 * positions differ by more than its length at launch, and its trail must not appear ahead of its nose); -1: none.
 * bands: 1 << band of smoke_volume.h that will be requested. ground_rho: of the lit ground below, by optical
 * channel. No puffs: count 0, and nothing is done. */
Status effects_scene(EffectScene *out, const Snapshot *snapshot, int hidden, const LocalFrame *frame, const View *view,
                     const Air *air, const float *ground_rho, unsigned bands, Arena *arena);

#endif
