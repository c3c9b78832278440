/* entities/scenery/scenery_smoke.c: which fires smoke, and their puffs. */
#include "entities/scenery/scenery_smoke.h"

#include "entities/scenery/scenery_puffs_private.h"

static bool smokes(const SceneryObject *o)
{
    return o->kind == SCENERY_CLUTTER && (o->class == CLUTTER_FIRE || o->class == CLUTTER_HEAP);
}

/* A source where an object stands, of the object's size. */
static void source_of(EffectSource *out, const Scenery *scenery, int object, const LocalFrame *frame)
{
    static const double   of_m[2] = {1.2, 3}; /* size of a fire, of a heap, for which their rows are */
    static const uint64_t no_entity = UINT64_C(1) << 63;
    const SceneryObject  *o = &scenery->object[object];
    const Model          *m = &scenery->model[o->model];
    const bool            heap = o->class == CLUTTER_HEAP;
    const double          size_m = fmax(m->length_m, m->width_m);
    *out = (EffectSource){.kind = heap ? EFFECT_SMOULDER_SMOKE : EFFECT_WOOD_SMOKE,
                          .key = o->id | no_entity,
                          .from_s = -effect_latest_s,
                          .to_s = effect_latest_s,
                          .motion = {.algorithm = 1},
                          .at_body = {0, 0, -0.7 * m->height_m},
                          .spread_body = {0.3 * m->length_m, 0.3 * m->width_m, 0},
                          .scale = clamp(size_m / of_m[heap], 0.3, 3),
                          .rate = 1};
    ecef_from_enu(out->motion.p_ecef, frame, o->p_enu);
    m3_mul(out->motion.r_ecef_from_body, frame->r_ecef_from_enu, o->r_enu_from_body);
}

Status scenery_smoke(Snapshot *s, const Scenery *scenery, const LocalFrame *frame, const double eye_enu[3],
                     Arena *arena)
{
    int fires = 0, count = 0;
    for (int k = 0; k < scenery->objects; k++) fires += smokes(&scenery->object[k]);
    if (fires == 0 || !s->effect_table || !scenery->smokes) return STATUS_OK;
    SceneryNear  *near = arena_alloc(arena, (size_t)fires, sizeof *near);
    EffectSource *source = arena_alloc(arena, scenery_smokes_most, sizeof *source);
    if (!near || !source) return STATUS_NO_MEMORY;
    for (int k = 0; k < scenery->objects; k++) {
        double to[3];
        if (!smokes(&scenery->object[k])) continue;
        v3_sub(to, scenery->object[k].p_enu, eye_enu);
        near[count] = (SceneryNear){v3_length(to), k};
        count += near[count].range_m < scenery_smokes_m;
    }
    count = scenery_nearest(near, count, scenery_smokes_most);
    for (int k = 0; k < count; k++) source_of(&source[k], scenery, near[k].which, frame);
    return scenery_add_puffs(s, source, count, arena);
}
