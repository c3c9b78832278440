/* render/trace/visibility/visibility_pose.c: the entities of a frame: the spheres of all of them, and their nodes on
 * first use. */
#include "render/trace/visibility/visibility_private.h"
#include "terrain/earth/refraction.h"

static const PosedEntity not_drawn = {.model = -1};

/* Pose of entity k. */
static void place_entity(double p_enu[3], double r_enu_from_body[9], const Visibility *v, int k)
{
    const SnapshotEntity *e = &v->snapshot->entity[k];
    enu_from_ecef(p_enu, v->frame, e->p_ecef);
    m3_tmul(r_enu_from_body, v->frame->r_ecef_from_enu, e->r_ecef_from_body);
}

/* Poses an entity; only one thread at a time may call it. NULL: no memory. */
static const PosedEntity *pose_entity(const Visibility *v, int k)
{
    const SnapshotEntity *e = &v->snapshot->entity[k];
    Poser                *poser = v->poser;
    PosedEntity          *posed = arena_alloc(poser->arena, 1, sizeof *posed);
    double                p_enu[3], r_enu_from_body[9];
    if (!posed) return NULL;
    posed->node = arena_alloc(poser->arena, (size_t)parts_node_count(v->tracer, e->model) + 1, sizeof *posed->node);
    if (!posed->node) return NULL;
    const NodePose *node = poser->node;
    if (v->snapshot->node) node = &v->snapshot->node[e->first_node];
    else snapshot_pose(poser->node, poser->joint_value, v->snapshot, k, tracer_model(v->tracer, e->model));
    place_entity(p_enu, r_enu_from_body, v, k);
    parts_pose(posed, v->tracer, e->model, node, p_enu, r_enu_from_body, snapshot_damage(e));
    return posed;
}

/* Any thread computes the same bits for an entity, so the first to need it poses it. */
const PosedEntity *visibility_posed(const Visibility *v, int index)
{
    const PosedEntity *posed = atomic_load_explicit(&v->posed[index], memory_order_acquire);
    if (posed) return posed;
    if (!v->loose[index]) return &not_drawn;
    pthread_mutex_lock(&v->poser->lock);
    posed = atomic_load_explicit(&v->posed[index], memory_order_relaxed);
    if (!posed) {
        posed = pose_entity(v, index);
        if (!posed) {
            atomic_store(&v->poser->lost, true);
            posed = &not_drawn;
        }
        atomic_store_explicit(&v->posed[index], posed, memory_order_release);
    }
    pthread_mutex_unlock(&v->poser->lock);
    return posed;
}

double visibility_bend(const Visibility *v) { return v->seen.bend_per_m; }

double visibility_lift_at(const Visibility *v, const double p_enu[3])
{
    return refraction_drop(v->seen.bend_per_m, v->eye_enu, p_enu);
}

double visibility_lift(const Visibility *v, int index) { return v->lift_m ? v->lift_m[index] : 0; }

int visibility_count(const Visibility *v) { return v->count; }

void visibility_materials(Visibility *v, const Materials *materials) { v->materials = materials; }

void visibility_on_part(double p_node[3], double n_node[3], const Visibility *v, const Hits *hits, int i,
                        const double n_enu[3])
{
    const PosedEntity *posed = visibility_posed(v, (int)hits->entity[i] - 1);
    const double       p_enu[3] = {hits->p_enu[0][i], hits->p_enu[1][i], hits->p_enu[2][i]};
    parts_on_part(p_node, n_node, tracer_model(v->tracer, posed->model), posed, hits->facet[i], p_enu, n_enu);
}

Status visibility_status(const Visibility *v) { return atomic_load(&v->poser->lost) ? STATUS_NO_MEMORY : STATUS_OK; }

/* Bound of the distance by which the sphere of a posed entity may exceed that of its model: every node's sphere lies
 * in a ball about the origin, of the model's radius and that of the largest node; the entity's is about the middle
 * of a box in it. */
static double wider_m(const Model *model, double largest_node_m)
{
    const double ball_m = model->radius_m + largest_node_m;
    return (1 + 2 * sqrt(3.0)) * ball_m - model->radius_m;
}

/* The sphere of an entity of the tree, which holds it where it is and where it is raised to. lift_m: NULL: nothing is
 * raised. */
static void raise_sphere(double sphere[4], double *lift_m, const Visibility *v, int k)
{
    double p_enu[3];
    if (!lift_m) return;
    enu_from_ecef(p_enu, v->frame, v->snapshot->entity[k].p_ecef);
    lift_m[k] = visibility_lift_at(v, p_enu);
    sphere[2] += 0.5 * lift_m[k], sphere[3] += 0.5 * lift_m[k];
}

/* A model's sphere contains it in every pose (entities/models/model.h); nodes that come with the snapshot are taken
 * as they are. */
static Status bound_entities(Visibility *v, Arena *arena)
{
    const size_t count = (size_t)v->count + 1;
    int         *item = arena_alloc(arena, count, sizeof *item);
    double(*sphere)[4] = arena_alloc(arena, count, sizeof *sphere);
    double *lift_m = v->seen.bend_per_m > 0 ? arena_alloc(arena, count, sizeof *lift_m) : NULL;
    if (!item || !sphere || (v->seen.bend_per_m > 0 && !lift_m)) return STATUS_NO_MEMORY;
    v->lift_m = lift_m;
    int widest = -1;
    for (int k = 0; k < v->count; k++) {
        const SnapshotEntity *e = &v->snapshot->entity[k];
        double               *to = sphere[v->drawable];
        if (e->model < 0 || e->model >= tracer_model_count(v->tracer)) continue;
        if (tracer_need(v->tracer, e->model) != STATUS_OK) return STATUS_NO_MEMORY;
        v->loose[k] = true;
        if (v->snapshot->node) {
            const PosedEntity *posed = visibility_posed(v, k);
            if (posed->model < 0) v->loose[k] = false;
            memcpy(to, posed->centre_enu, sizeof posed->centre_enu);
            to[3] = posed->radius_m;
        } else {
            enu_from_ecef(to, v->frame, e->p_ecef);
            const Model *model = tracer_model(v->tracer, e->model);
            to[3] = model->radius_m * (1 + 1e-9) + 1e-3; /* a near miss within 20 um may count as a hit, too */
            v->loose[k] = v3_is_finite(to) && parts_node_count(v->tracer, e->model) > 0;
            if (e->model != widest)
                v->wider_m = fmax(v->wider_m, wider_m(model, parts_largest_node_m(v->tracer, e->model)));
            widest = e->model;
        }
        if (!v->loose[k]) continue;
        raise_sphere(to, lift_m, v, k);
        item[v->drawable++] = k;
    }
    return broad_phase_create(&v->tree, item, (const double(*)[4])sphere, v->drawable, arena);
}

Status visibility_create(Visibility **out, Tracer *tracer, const Landscape *ground, const LocalFrame *frame,
                         const Snapshot *snapshot, unsigned skips_off, Arena *arena)
{
    const VisibilityConfig straight = {tracer, ground, frame, snapshot, skips_off, {0, 0, 0}, 0, NULL};
    return visibility_create_seen(out, &straight, arena);
}

Status visibility_create_seen(Visibility **out, const VisibilityConfig *config, Arena *arena)
{
    const Snapshot *snapshot = config->snapshot;
    Visibility     *v = arena_alloc(arena, 1, sizeof *v);
    int             most_nodes = 1;
    if (!v) return STATUS_NO_MEMORY;
    *v = (Visibility){.tracer = config->tracer,
                      .landscape = config->ground,
                      .cells = config->cells,
                      .frame = config->frame,
                      .snapshot = snapshot,
                      .skips_off = config->skips_off,
                      .count = snapshot->count};
    ground_prepare(&v->ground, config->ground ? &config->ground->elevation : NULL);
    v->seen = v->ground;
    v->seen.bend_per_m = config->bend_per_m;
    memcpy(v->eye_enu, config->eye_enu, sizeof v->eye_enu);
    v->posed = arena_alloc(arena, (size_t)v->count + 1, sizeof *v->posed);
    v->loose = arena_alloc(arena, (size_t)v->count + 1, sizeof *v->loose);
    v->poser = arena_alloc(arena, 1, sizeof *v->poser);
    if (!v->posed || !v->loose || !v->poser) return STATUS_NO_MEMORY;
    pthread_mutex_init(&v->poser->lock, NULL); /* holds nothing that must be released */
    v->poser->arena = arena;
    Status status = visibility_add(v, &trace_ground, NULL); /* the list of what rays can meet, in its order */
    if (status == STATUS_OK) status = visibility_add(v, &trace_parts, NULL);
    if (status == STATUS_OK) status = visibility_round_earth(v, arena);
    if (status == STATUS_OK) status = bound_entities(v, arena);
    if (status != STATUS_OK) return status;
    for (int k = 0; k < v->count; k++) {
        const int nodes = v->loose[k] ? tracer_model(v->tracer, snapshot->entity[k].model)->node_count : 0;
        most_nodes = nodes > most_nodes ? nodes : most_nodes;
    }
    v->poser->node = arena_alloc(arena, (size_t)most_nodes, sizeof *v->poser->node);
    v->poser->joint_value = arena_alloc(arena, (size_t)most_nodes, sizeof *v->poser->joint_value);
    if (!v->poser->node || !v->poser->joint_value) return STATUS_NO_MEMORY;
    *out = v;
    return visibility_status(v);
}

int visibility_near(int *list, const Visibility *v, const double low[3], const double high[3], double more_m)
{
    int count = 0;
    if (skips(v->skips_off, SKIP_TREE)) return broad_phase_near_box(list, v->tree, low, high, more_m + v->wider_m);
    for (int k = 0; k < v->count; k++)
        if (v->loose[k]) list[count++] = k;
    return count;
}

/* The box of an entity that is posed already. */
static bool posed_box(void *user, int item, double low[3], double high[3])
{
    static const double near_miss_m = 1e-3; /* ample: 20 um */
    const Visibility   *v = *(const Visibility *const *)user;
    const PosedEntity  *e = atomic_load_explicit(&v->posed[item], memory_order_acquire);
    if (!e || e->model < 0) return false;
    for (int r = 0; r < 3; r++) {
        double middle = e->p_enu[r], half = near_miss_m;
        for (int c = 0; c < 3; c++) {
            middle += e->r_enu_from_body[3 * r + c] * 0.5 * (e->box_low[c] + e->box_high[c]);
            half += fabs(e->r_enu_from_body[3 * r + c]) * 0.5 * (e->box_high[c] - e->box_low[c]);
        }
        low[r] = middle - half, high[r] = middle + half;
    }
    high[2] += visibility_lift(v, item); /* where it is, and where it is raised to */
    return true;
}

void visibility_tighten(const Visibility *v)
{
    if (v->drawable > crowd_least && skips(v->skips_off, SKIP_TREE)) broad_phase_tighten(v->tree, posed_box, &v);
}
