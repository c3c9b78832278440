/* render/heat/patch_set.h: the patches of models (entities/models/patches.h), each cut at its first use, or ahead of
 * it by a thread of its own. */
#ifndef RENDER_HEAT_PATCH_SET_H
#define RENDER_HEAT_PATCH_SET_H

#include "entities/models/patches.h"
#include "entities/table/snapshot.h"

typedef struct PatchSet {
    int      models;
    Patches *of;  /* [models] */
    bool    *cut; /* [models] */
    struct PatchCut **ahead; /* [models]: being cut; NULL: not */
} PatchSet;

Status patch_set_create(PatchSet *out, int models);
void   patch_set_destroy(PatchSet *set); /* accepts zeroes */
/* One thread at a time. model: the built one, not its coarse form. STATUS_NO_MEMORY. */
Status patch_set_need(PatchSet *set, int index, const Model *model);
/* Begins to cut a model in another thread, for which patch_set_need then waits. Where there is none to be had, that
 * cuts it. */
void   patch_set_begin(PatchSet *set, int index, const Model *model);

/* Temperature of an entity's surface at a place of one of its parts, of node axes, K; NAN: none is known. Its model
 * must have been needed. */
static inline double patch_set_temp_k(const PatchSet *set, const Snapshot *snapshot, int entity, int part,
                                      const double p_node[3], const double n_node[3])
{
    const SnapshotEntity *e = &snapshot->entity[entity];
    if (e->first_patch < 0 || e->model < 0 || e->model >= set->models || !set->cut[e->model]) return NAN;
    const Patches *patches = &set->of[e->model];
    if (e->patches != patches->count) return NAN; /* of a file, for another model */
    return patches_value(patches, snapshot->patch_k + e->first_patch, part, p_node, n_node);
}

#endif
