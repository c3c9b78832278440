/* entities/scenery/scenery_exhaust.c: which engines of clutter run in view, and their gas. */
#include "entities/scenery/scenery_exhaust.h"

#include "entities/scenery/scenery_puffs_private.h"
#include "entities/traces/exhaust.h"
#include "entities/traces/vehicle_traces.h"

static bool runs(const Scenery *s, const SceneryObject *o)
{
    return o->kind == SCENERY_CLUTTER && o->state >= 0 && s->state[o->state].drives.engine > 0 &&
           !(s->state[o->state].stood_s > 0);
}

/* Where an object is, and what moves it: movers are in the order of their objects. */
static const SceneryMover *mover_of(const Scenery *s, int object, int *next)
{
    while (*next < s->movers && s->mover[*next].object < object) ++*next;
    return *next < s->movers && s->mover[*next].object == object ? &s->mover[*next] : NULL;
}

static int gas_of(EffectPuff *out, const Scenery *s, int object, const LocalFrame *frame, const EffectTable *table,
                  double t_s)
{
    static const uint64_t no_entity = UINT64_C(1) << 63;
    const SceneryObject  *o = &s->object[object];
    const Model          *model = &s->model[o->model];
    int                   next = 0;
    const SceneryMover   *mover = mover_of(s, object, &next);
    double                p_enu[3], r_enu[9], p_ecef[3], r_ecef[9], v_ecef[3] = {0};
    ExhaustJet            jet;
    if (!exhaust_outlet(&jet, model, false, table)) return 0;
    memcpy(p_enu, o->p_enu, sizeof p_enu), memcpy(r_enu, o->r_enu_from_body, sizeof r_enu);
    if (mover) scenery_pose(p_enu, r_enu, s, mover, t_s);
    ecef_from_enu(p_ecef, frame, p_enu);
    m3_mul(r_ecef, frame->r_ecef_from_enu, r_enu);
    for (int k = 0; k < 3 && mover; k++) v_ecef[k] = mover->speed_mps * r_ecef[3 * k];
    const ExhaustSource source = {.kind = EFFECT_EXHAUST,
                                  .jet = &jet,
                                  .key = (o->id | no_entity) - 1,
                                  .drive = (double)s->state[o->state].drives.engine,
                                  .scale = vehicle_effect_scale(model),
                                  .p_ecef = p_ecef,
                                  .r_ecef_from_body = r_ecef,
                                  .v_ecef_mps = v_ecef};
    return exhaust_behind(out, &source, table, t_s);
}

Status scenery_exhaust(Snapshot *s, const Scenery *scenery, const LocalFrame *frame, const SceneryCone *seen,
                       Arena *arena)
{
    static const double reach_m = 12; /* of gas in two seconds of a breeze */
    int                 running = 0, count = 0, next = 0;
    for (int k = 0; k < scenery->objects; k++) running += runs(scenery, &scenery->object[k]);
    if (running == 0 || !s->effect_table || !scenery->smokes || !(fabs(s->t_s) < effect_latest_s)) return STATUS_OK;
    SceneryNear *near = arena_alloc(arena, (size_t)running, sizeof *near);
    if (!near) return STATUS_NO_MEMORY;
    for (int k = 0; k < scenery->objects; k++) {
        const SceneryObject *o = &scenery->object[k];
        double               p_enu[3] = {o->p_enu[0], o->p_enu[1], o->p_enu[2]}, r[9];
        if (!runs(scenery, o)) continue;
        const SceneryMover *mover = mover_of(scenery, k, &next);
        if (mover) scenery_pose(p_enu, r, scenery, mover, s->t_s);
        near[count].which = k;
        count += scenery_in_cone(&near[count].range_m, seen, p_enu, reach_m, scenery_exhausts_m);
    }
    count = scenery_nearest(near, count, scenery_exhausts_most);
    EffectPuff  *at;
    size_t       room;
    const Status status = scenery_puff_room(&at, &room, s, (size_t)count * exhaust_puffs, arena);
    if (status != STATUS_OK) return status;
    for (int k = 0; k < count && room >= exhaust_puffs; k++) {
        const int puffs = gas_of(at, scenery, near[k].which, frame, s->effect_table, s->t_s);
        at += puffs, room -= (size_t)puffs, s->puff_count += puffs;
    }
    return STATUS_OK;
}
