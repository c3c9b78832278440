/* render/heat/patch_view.h: what each patch of an entity sees, by rays against its own parts as they are posed: sky,
 * ground, the ground beneath it, other patches, and the sun.
 *
 * Shares are of the hemisphere over the patch, weighted by the cosine: 12 rays from each of four points, the same
 * for every entity. Error: some 0.05 of a share (tests/render/test_vehicle_heat.c). What other entities take of that
 * is seen apart from it, by the same rays: tests/render/test_vehicle_neighbours.c. A patch that lies inside the
 * model (open_share 0) sees nothing: all its shares are 0. */
#ifndef RENDER_HEAT_PATCH_VIEW_H
#define RENDER_HEAT_PATCH_VIEW_H

#include "entities/models/patches.h"
#include "render/heat/jet_path.h"
#include "render/parts/parts.h"

enum { patch_view_rays = 12, patch_partners = 8, patch_near_rays = 24, near_partners = 6, patch_others = 8 };

typedef struct PatchView {
    float   sky, ground, under;       /* under: ground within the outline of the entity, in its shade */
    uint8_t partners;                 /* the rest: other patches, at most so many; shares add up to 1 */
    uint8_t partner[patch_partners];
    float   share[patch_partners];
} PatchView;

/* What other entities take of a patch's view, in rays of patch_points patch_near_rays. */
typedef struct NearView {
    uint8_t sky, ground, under, own;  /* that met these before, own: its entity's parts; the sum met others */
    uint8_t partners;                 /* patches of others, at most so many: the most seen ones stand for all */
    uint8_t slot[near_partners], patch[near_partners], rays[near_partners]; /* slot: which of the others */
} NearView;

/* An entity as it is posed now, at the origin of ENU. */
typedef struct PatchPose {
    const Patches *patches;
    const Model   *model;
    const PosedEntity *posed;         /* at p_enu 0; another one: from there */
    const NodePose    *node;
    double r_enu_from_body[9];
    double above_m;                   /* of its base over the ground */
} PatchPose;

void patch_view_look(PatchView *out, const PatchPose *pose, int patch);
/* other[others]: at most patch_others; NULL among them: gone. Of these, patches, model and posed are read. */
void patch_view_near(NearView *out, const PatchPose *pose, int patch, const PatchPose *const *other, int others);
/* out[patches->count]. Share of the direct sun that each patch takes: mean cosine of its points, 0 where its own
 * parts, or others, are between. */
void patch_view_sun(float *out, const PatchPose *pose, const double sun_d_enu[3], const PosedEntity *const *other, int others);
/* Of a jet that flows past a patch: means over its points, 0 where its own parts are between them and the jet
 * upstream. */
void patch_view_gas(float *excess_k, float *speed_mps, const PatchPose *pose, int patch, const JetPath *path);
/* Unit normal of a patch, ENU. */
void patch_view_normal(double n_enu[3], const PatchPose *pose, int patch);

#endif
