/* render/light/part_temps.h: where temperatures of entities' surfaces come from, in one frame. */
#ifndef RENDER_LIGHT_PART_TEMPS_H
#define RENDER_LIGHT_PART_TEMPS_H

#include "render/heat/patch_set.h"
#include "render/visibility/visibility.h"

typedef struct PartTemps {
    const Snapshot   *snapshot;
    const PatchSet   *patches;    /* all models of snapshot.patch_k have been needed */
    const Visibility *visibility; /* of the same snapshot: poses */
} PartTemps;

#endif
