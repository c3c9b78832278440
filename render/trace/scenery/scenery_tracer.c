/* render/trace/scenery/scenery_tracer.c: makes scenery ready to be traced, and poses what drives of it. */
#include "render/trace/scenery/scenery_tracer_private.h"

#include <stdlib.h>

/* ---- made once ---------------------------------------------------------------------------------- */

static Status check(const Scenery *s)
{
    for (int k = 0; k < s->objects; k++) {
        if (s->object[k].model >= 0 && s->object[k].model < s->models) continue;
        log_error("scenery: an object's model is not there: object=%d model=%d models=%d", k, s->object[k].model,
                  s->models);
        return STATUS_BAD_VALUE;
    }
    for (int k = 0; k < s->movers; k++) {
        const SceneryMover *m = &s->mover[k];
        if (m->object >= 0 && m->object < s->objects && m->count > 0 && m->first >= 0 &&
            m->first <= s->paths - m->count)
            continue;
        log_error("scenery: what drives has no object or no path: mover=%d object=%d", k, m->object);
        return STATUS_BAD_VALUE;
    }
    for (int k = 0; k < s->harms; k++) {
        if (s->harm[k].object >= 0 && s->harm[k].object < s->objects) continue;
        log_error("scenery: what is damaged is no object: harm=%d object=%d", k, s->harm[k].object);
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

static Status trace_models(SceneryTracer *t, const char *isa)
{
    const Scenery *s = t->scenery;
    const Model  **model = calloc((size_t)s->models + 1, sizeof *model);
    if (!model) return STATUS_NO_MEMORY;
    for (int m = 0; m < s->models; m++) model[m] = s->model[m].triangle_count > 0 ? &s->model[m] : NULL;
    const Status status = tracer_create_models(&t->tracer, model, s->models, isa);
    free(model);
    return status;
}

/* Every model at rest. */
static Status rest_models(SceneryTracer *t)
{
    t->rest = arena_alloc(t->arena, (size_t)t->scenery->models + 1, sizeof *t->rest);
    if (!t->rest) return STATUS_NO_MEMORY;
    for (int m = 0; m < t->scenery->models; m++) {
        const Model *model = &t->scenery->model[m];
        t->rest[m] = arena_alloc(t->arena, (size_t)model->node_count + 1, sizeof **t->rest);
        if (!t->rest[m]) return STATUS_NO_MEMORY;
        model_pose(t->rest[m], model, NULL);
    }
    return STATUS_OK;
}

static Status pose(PosedEntity *out, const SceneryTracer *t, int object, const double p_enu[3],
                   const double r_enu_from_body[9], int of_damage, Arena *arena)
{
    const SceneryObject *o = &t->scenery->object[object];
    const int            damage = of_damage < model_damage_states ? of_damage : model_damage_states - 1;
    *out = (PosedEntity){.model = -1};
    if (parts_node_count(t->tracer, o->model) == 0) return STATUS_OK;
    out->node = arena_alloc(arena, (size_t)parts_node_count(t->tracer, o->model), sizeof *out->node);
    if (!out->node) return STATUS_NO_MEMORY;
    parts_pose(out, t->tracer, o->model, t->rest[o->model], p_enu, r_enu_from_body, damage);
    return STATUS_OK;
}

static bool box_that_stands(void *user, int object, double low[3], double high[3])
{
    const SceneryTracer *t = user;
    return parts_posed_box(low, high, &t->posed[object]);
}

static Status plant_tree(SceneryTracer *t)
{
    const size_t count = (size_t)t->scenery->objects + 1;
    int         *item = arena_alloc(t->arena, count, sizeof *item);
    double(*sphere)[4] = arena_alloc(t->arena, count, sizeof *sphere);
    if (!item || !sphere) return STATUS_NO_MEMORY;
    for (int k = 0; k < t->scenery->objects; k++) {
        const PosedEntity *e = &t->posed[k];
        if (t->mover[k] || e->model < 0) continue;
        item[t->drawable] = k;
        memcpy(sphere[t->drawable], e->centre_enu, sizeof e->centre_enu);
        sphere[t->drawable++][3] = e->radius_m;
    }
    const Status status = broad_phase_create(&t->tree, item, (const double(*)[4])sphere, t->drawable, t->arena);
    if (status != STATUS_OK) return status;
    broad_phase_tighten(t->tree, box_that_stands, t);
    return scenery_heights_create(&t->heights, t->posed, t->scenery->objects, t->arena);
}

static Status pose_objects(SceneryTracer *t)
{
    const Scenery *s = t->scenery;
    t->posed = arena_alloc(t->arena, (size_t)s->objects + 1, sizeof *t->posed);
    t->mover = arena_alloc(t->arena, (size_t)s->objects + 1, sizeof *t->mover);
    if (!t->posed || !t->mover) return STATUS_NO_MEMORY;
    for (int k = 0; k < s->movers; k++) t->mover[s->mover[k].object] = k + 1;
    for (int k = 0; k < s->objects; k++) {
        Status status = STATUS_OK;
        t->posed[k].model = -1;
        if (t->mover[k]) t->moving++;
        else
            status = pose(&t->posed[k], t, k, s->object[k].p_enu, s->object[k].r_enu_from_body, s->object[k].damage,
                          t->arena);
        if (status != STATUS_OK) return status;
    }
    t->harmed = arena_alloc(t->arena, (size_t)s->harms + 1, sizeof *t->harmed);
    if (!t->harmed) return STATUS_NO_MEMORY;
    t->moved = s->movers;
    for (int k = 0; k < s->harms; k++) {
        const int object = s->harm[k].object;
        if (t->mover[object]) continue;
        t->harmed[t->moved - s->movers] = object;
        t->mover[object] = ++t->moved;
        t->moving++;
    }
    return plant_tree(t);
}

Status scenery_tracer_create(SceneryTracer **out, const Scenery *scenery, const char *isa)
{
    Status status = check(scenery);
    if (status != STATUS_OK) return status;
    SceneryTracer *t = calloc(1, sizeof *t);
    if (!t) return STATUS_NO_MEMORY;
    t->scenery = scenery;
    t->arena = arena_create();
    status = t->arena ? trace_models(t, isa) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = rest_models(t);
    if (status == STATUS_OK) status = pose_objects(t);
    if (status == STATUS_OK) *out = t;
    else scenery_tracer_destroy(t);
    return status;
}

void scenery_tracer_destroy(SceneryTracer *t)
{
    if (!t) return;
    tracer_destroy(t->tracer);
    if (t->arena) arena_destroy(t->arena);
    free(t->row_first);
    free(t->row);
    free(t);
}

const Scenery *scenery_tracer_of(const SceneryTracer *t) { return t->scenery; }
size_t         scenery_tracer_bytes(const SceneryTracer *t) { return arena_bytes(t->arena); }

bool scenery_tracer_box(const SceneryTracer *t, int object, double low[3], double high[3])
{
    return parts_posed_box(low, high, &t->posed[object]);
}

Status scenery_tracer_materials(SceneryTracer *t, const Materials *materials, const char *path)
{
    const Scenery *s = t->scenery;
    int            parts = 0, most = 0;
    for (int m = 0; m < s->models; m++) {
        parts += s->model[m].part_count;
        most = s->model[m].part_count > most ? s->model[m].part_count : most;
    }
    int *first = calloc((size_t)s->models + 1, sizeof *first), *undamaged = calloc((size_t)most + 1, sizeof *undamaged);
    int *row = calloc((size_t)parts + 1, model_damage_states * sizeof *row);
    Status status = first && row && undamaged ? STATUS_OK : STATUS_NO_MEMORY;
    for (int m = 0, at = 0; m < s->models && status == STATUS_OK; m++) {
        int *of = row + (size_t)at * model_damage_states;
        first[m] = at;
        status = materials_of_model(undamaged, of, materials, &s->model[m], path);
        for (int p = 0; p < s->model[m].part_count; p++)
            for (int k = 0; k < (s->model[m].part[p].damage_hidden ? model_damage_states : 1); k++)
                of[p * model_damage_states + k] = undamaged[p]; /* parts of a state have its materials */
        at += s->model[m].part_count;
    }
    free(undamaged);
    if (status != STATUS_OK) {
        free(first);
        free(row);
        return status;
    }
    free(t->row_first);
    free(t->row);
    t->row_first = first, t->row = row;
    return STATUS_OK;
}

/* ---- a frame ------------------------------------------------------------------------------------ */

static bool box_that_drives(void *user, int object, double low[3], double high[3])
{
    return parts_posed_box(low, high, frame_posed(user, object));
}

static Status move_objects(SceneryFrame *f, double t_s, Arena *arena)
{
    const Scenery *s = f->of->scenery;
    const size_t   count = (size_t)f->of->moved + 1;
    int           *item = arena_alloc(arena, count, sizeof *item);
    double(*sphere)[4] = arena_alloc(arena, count, sizeof *sphere);
    int drawable = 0;
    f->moved = arena_alloc(arena, count, sizeof *f->moved);
    if (!item || !sphere || !f->moved) return STATUS_NO_MEMORY;
    for (int k = 0; k < f->of->moved; k++) f->moved[k].model = -1;
    for (int object = 0; object < s->objects; object++) { /* items ascend */
        const int mover = f->of->mover[object];
        if (!mover) continue;
        PosedEntity *e = &f->moved[mover - 1];
        double       p_enu[3], r_enu_from_body[9];
        memcpy(p_enu, s->object[object].p_enu, sizeof p_enu);
        memcpy(r_enu_from_body, s->object[object].r_enu_from_body, sizeof r_enu_from_body);
        if (mover <= s->movers) scenery_pose(p_enu, r_enu_from_body, s, &s->mover[mover - 1], t_s);
        const Status status = pose(e, f->of, object, p_enu, r_enu_from_body, scenery_damage(s, object, t_s), arena);
        if (status != STATUS_OK) return status;
        if (e->model < 0) continue;
        item[drawable] = object;
        memcpy(sphere[drawable], e->centre_enu, sizeof e->centre_enu);
        sphere[drawable++][3] = e->radius_m;
    }
    const Status status = broad_phase_create(&f->tree, item, (const double(*)[4])sphere, drawable, arena);
    if (status == STATUS_OK) broad_phase_tighten(f->tree, box_that_drives, f);
    return status;
}

Status scenery_frame_create(SceneryFrame **out, const SceneryTracer *t, const SceneryFrameOf *of, Arena *arena)
{
    SceneryFrame *f = arena_alloc(arena, 1, sizeof *f);
    if (!f) return STATUS_NO_MEMORY;
    *f =
        (SceneryFrame){.of = t, .skips_off = of->skips_off, .lift = {{of->eye_enu[0], of->eye_enu[1]}, of->bend_per_m}};
    memcpy(f->eye_enu, of->eye_enu, sizeof f->eye_enu);
    const Status status = t->moving > 0 ? move_objects(f, of->t_s, arena) : STATUS_OK;
    if (status == STATUS_OK) *out = f;
    return status;
}

uint64_t scenery_frame_hash(const SceneryFrame *f)
{
    uint64_t hash = f ? (uint64_t)(uintptr_t)f->of : 0;
    for (int k = 0; f && f->tree && k < f->of->moved; k++) {
        uint64_t bits[3 + 9];
        hash ^= (uint64_t)f->moved[k].damage;
        memcpy(bits, f->moved[k].p_enu, sizeof f->moved[k].p_enu);
        memcpy(bits + 3, f->moved[k].r_enu_from_body, sizeof f->moved[k].r_enu_from_body);
        for (int n = 0; n < 12; n++) hash = (hash ^ bits[n]) * UINT64_C(0x9E3779B97F4A7C15), hash ^= hash >> 29;
    }
    return hash;
}

const Scenery            *scenery_frame_of(const SceneryFrame *f) { return f->of->scenery; }
const struct PosedEntity *scenery_frame_posed(const SceneryFrame *f, int object) { return frame_posed(f, object); }
double                    scenery_frame_lift(const SceneryFrame *f, int object) { return frame_lift_m(f, object); }

void scenery_frame_on_body(double p_body[3], double n_body[3], const SceneryFrame *f, const Hits *hits, int i,
                           const double n_enu[3])
{
    const PosedEntity *e = frame_posed(f, (int)hits->instance[i] - 1);
    const double       p_enu[3] = {hits->p_enu[0][i], hits->p_enu[1][i], hits->p_enu[2][i]};
    double             from[3];
    v3_sub(from, p_enu, e->p_enu);
    m3_tmul_v3(p_body, e->r_enu_from_body, from);
    m3_tmul_v3(n_body, e->r_enu_from_body, n_enu);
}

static int compare(const void *a, const void *b) { return *(const int *)a - *(const int *)b; }

int scenery_frame_near(int *list, const SceneryFrame *f, const double low[3], const double high[3], double more_m)
{
    int count = broad_phase_near_box(list, f->of->tree, low, high, more_m);
    if (!f->tree) return count;
    count += broad_phase_near_box(list + count, f->tree, low, high, more_m);
    qsort(list, (size_t)count, sizeof *list, compare);
    return count;
}
