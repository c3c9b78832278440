/* render/heat/vehicle_near.c: what neighbours do to the heat of an entity (vehicle_state_private.h). */

#include "render/heat/vehicle_state_private.h"
#include "render/heat/surface_flux_private.h"
#include "render/heat/vehicle_load_private.h"

#include <stdlib.h>

static const double jet_radii = 400; /* of an outlet, how far jet_path goes at most */

void vehicle_near_bodies(NearScene *scene)
{
    for (int i = 0; i < scene->count; i++) {
        const SnapshotEntity *e = &scene->snapshot->entity[scene->state[i]->index];
        NearBody             *b = &scene->body[i];
        *b = (NearBody){.id = e->id};
        enu_from_ecef(b->p_enu, scene->frame, e->p_ecef);
        m3_tmul_v3(b->v_enu_mps, scene->frame->r_ecef_from_enu, e->v_ecef_mps);
        if (!v3_is_finite(b->p_enu) || !v3_is_finite(b->v_enu_mps) || snapshot_is_short_lived(e)) continue;
        b->radius_m = tracer_model(scene->tracer, e->model)->radius_m;
        b->jet_m = e->exhaust && e->drives.engine > 0 ? jet_radii * e->exhaust->radius_m : 0;
    }
}

static void key_of(NearKey *out, const NearScene *scene, int me, const Neighbour *n)
{
    const SnapshotEntity *mine = &scene->snapshot->entity[scene->state[me]->index];
    const SnapshotEntity *its = &scene->snapshot->entity[scene->state[n->body]->index];
    double                to_ecef[3];
    out->id = its->id, out->why = n->why;
    v3_sub(to_ecef, its->p_ecef, mine->p_ecef);
    m3_tmul_v3(out->p_body, mine->r_ecef_from_body, to_ecef);
    m3_tmul(out->r_body, mine->r_ecef_from_body, its->r_ecef_from_body);
}

static bool moved(const NearKey *a, const NearKey *b)
{
    static const double near_m = 0.3, far_share = 0.05, turned_cos = 0.985; /* 10 degrees */
    const bool          seen_alone = a->why == NEAR_SEEN;
    double              way[3];
    v3_sub(way, b->p_body, a->p_body);
    if (v3_length(way) > fmax(near_m, seen_alone ? far_share * v3_length(a->p_body) : 0)) return true;
    for (int k = 0; k < 3; k++) { /* axes of the two poses */
        double along = 0;
        for (int i = 0; i < 3; i++) along += a->r_body[3 * i + k] * b->r_body[3 * i + k];
        if (along < turned_cos) return true;
    }
    return false;
}

static VehicleNear *new_near(int patches)
{
    VehicleNear *n = calloc(1, sizeof *n + 2 * (size_t)patches * sizeof(NearView));
    if (!n) return NULL;
    n->view = (NearView *)(void *)(n + 1);
    n->next = n->view + patches;
    return n;
}

static const double most_fill = 4; /* of one, in the account of work */

/* Begins new views of the neighbours that the entity sees. */
static void start_looking(VehicleNear *near, const Neighbours *found, const NearScene *scene, int patches)
{
    near->next_seen = 0, near->looked = 0, near->fill = 0;
    for (int k = 0; k < found->count; k++) {
        if (!(found->of[k].why & NEAR_SEEN)) continue;
        near->next_id[near->next_seen++] = scene->body[found->of[k].body].id;
        near->fill += fmin(found->of[k].fill, most_fill);
    }
    if (near->next_seen > 0) return;
    near->seen = 0, near->looked = patches;
    memset(near->view, 0, (size_t)patches * sizeof *near->view);
}

Status vehicle_near_check(bool *changed, int *left_out, const NearScene *scene, int me, const double sun_d_enu[3])
{
    VehicleState *s = scene->state[me];
    const int     patches = scene->shape[s->model].patches->count;
    Neighbours    found;
    NearKey       key[near_most];
    vehicle_neighbours_find(&found, scene->body, scene->count, me, sun_d_enu, false);
    *left_out = found.left_out;
    *changed = false;
    if (found.count == 0) {
        *changed = s->near != NULL;
        free(s->near);
        s->near = NULL;
        return STATUS_OK;
    }
    if (!s->near && !(s->near = new_near(patches))) return STATUS_NO_MEMORY;
    bool looks = false; /* those that it sees are others, or elsewhere */
    *changed = found.count != s->near->count;
    for (int k = 0; k < found.count; k++) {
        int was = 0;
        key_of(&key[k], scene, me, &found.of[k]);
        while (was < s->near->count && dis_entity_id_compare(s->near->key[was].id, key[k].id) != 0) was++;
        const bool new =
            was == s->near->count || s->near->key[was].why != key[k].why || moved(&s->near->key[was], &key[k]);
        *changed |= new;
        looks |= new &&key[k].why &NEAR_SEEN;
    }
    if (!*changed) return STATUS_OK;
    int seen = 0, was_seen = 0;
    for (int k = 0; k < found.count; k++) seen += (key[k].why & NEAR_SEEN) != 0;
    for (int k = 0; k < s->near->count; k++) was_seen += (s->near->key[k].why & NEAR_SEEN) != 0;
    memcpy(s->near->key, key, (size_t)found.count * sizeof *key);
    s->near->count = found.count;
    if (looks || seen != was_seen) start_looking(s->near, &found, scene, patches);
    return STATUS_OK;
}

/* ---- as they are posed -------------------------------------------------------------------- */

/* NULL: not drawable, or no memory, which *status says. */
static const PatchPose *pose_of(Status *status, const NearScene *scene, int body, const double p_enu[3], Arena *arena)
{
    const int             index = scene->state[body]->index;
    const SnapshotEntity *e = &scene->snapshot->entity[index];
    const Model          *model = tracer_model(scene->tracer, e->model);
    const size_t          nodes = (size_t)model->node_count;
    PatchPose            *pose = arena_alloc(arena, 1, sizeof *pose);
    PosedEntity          *posed = arena_alloc(arena, 1, sizeof *posed);
    NodePose             *node = arena_alloc(arena, nodes, sizeof *node);
    double               *joint = arena_alloc(arena, nodes, sizeof *joint), from_enu[3];
    PosedNode            *posed_node =
        arena_alloc(arena, (size_t)parts_node_count(scene->tracer, e->model) + 1, sizeof *posed_node);
    if (!pose || !posed || !node || !joint || !posed_node) {
        *status = STATUS_NO_MEMORY;
        return NULL;
    }
    *posed = (PosedEntity){.node = posed_node};
    *pose = (PatchPose){.patches = scene->shape[e->model].patches, .model = model, .posed = posed, .node = node};
    m3_tmul(pose->r_enu_from_body, scene->frame->r_ecef_from_enu, e->r_ecef_from_body);
    v3_sub(from_enu, scene->body[body].p_enu, p_enu);
    snapshot_pose(node, joint, scene->snapshot, index, model);
    parts_pose(posed, scene->tracer, e->model, node, from_enu, pose->r_enu_from_body, 0);
    return posed->model >= 0 ? pose : NULL;
}

Status vehicle_near_pose(const PatchPose *pose[near_seen_most], const NearScene *scene, const VehicleState *s,
                         const VehicleMoment *m, Arena *arena)
{
    Status status = STATUS_OK;
    for (int k = 0; k < s->near->next_seen; k++) {
        const int body = vehicle_state_find(scene->state, scene->count, s->near->next_id[k]);
        pose[k] = body >= 0 ? pose_of(&status, scene, body, m->p_enu, arena) : NULL;
    }
    return status;
}

void vehicle_near_look(VehicleState *s, const VehicleMoment *m, const PatchPose *const *pose, const KnownViews *seen)
{
    VehicleNear *near = s->near;
    const int    patches = m->shape->patches->count;
    NearView    *view = &near->next[near->looked];
    char        *record = seen->known ? seen->record + (size_t)near->looked * sizeof *view : NULL;
    if (record && seen->known[near->looked]) {
        memcpy(view, record, sizeof *view);
    } else {
        vehicle_view_near(view, &m->pose, near->looked, pose, near->next_seen);
        if (record) seen->known[near->looked] = true, memcpy(record, view, sizeof *view);
    }
    if (++near->looked < patches) return;
    memcpy(near->view, near->next, (size_t)patches * sizeof *near->view);
    memcpy(near->id, near->next_id, sizeof near->id);
    near->seen = near->next_seen;
}

/* ---- what they do ------------------------------------------------------------------------- */

/* Longwave and sunlight from what of its neighbours each patch sees. */
static Status shine(VehicleMoment *m, const NearScene *scene, const VehicleState *s, double t_s, bool past,
                    Arena *arena)
{
    const PlaceHeat    *p = &m->place;
    const size_t        patches = (size_t)m->shape->patches->count;
    const double        bright_w_m2 = p->ground_rho * (p->direct_w_m2 * fmax(p->sun_d_enu[2], 0) + p->diffuse_w_m2);
    const VehicleState *other[near_seen_most];
    m->near = NULL;
    if (!s->near || s->near->seen == 0) return STATUS_OK;
    m->near_w_m2 = arena_alloc(arena, patches, sizeof *m->near_w_m2);
    m->near_sun_w_m2 = arena_alloc(arena, patches, sizeof *m->near_sun_w_m2);
    if (!m->near_w_m2 || !m->near_sun_w_m2) return STATUS_NO_MEMORY;
    m->near = s->near->view;
    for (int k = 0; k < s->near->seen; k++) {
        const int at = vehicle_state_find(scene->state, scene->count, s->near->id[k]);
        other[k] = at < 0 || past ? NULL : scene->state[at];
    }
    for (size_t i = 0; i < patches; i++) {
        const NearView *view = &s->near->view[i];
        double          longwave_w_m2 = 0, sun_w_m2 = 0;
        int             kept = 0;
        for (int k = 0; k < view->partners; k++) {
            const VehicleState *o = other[view->slot[k]];
            double              temp_k = p->air_k, sent_w_m2 = bright_w_m2;
            if (o && view->patch[k] < scene->shape[o->model].patches->count &&
                !vehicle_state_then(&temp_k, &sent_w_m2, o, view->patch[k], t_s))
                temp_k = p->air_k, sent_w_m2 = bright_w_m2;
            longwave_w_m2 += view->rays[k] * stefan_w_m2k4 * pow(temp_k, 4);
            sun_w_m2 += view->rays[k] * sent_w_m2;
            kept += view->rays[k];
        }
        m->near_w_m2[i] = (float)(kept > 0 ? longwave_w_m2 / kept : 0);
        m->near_sun_w_m2[i] = (float)(kept > 0 ? sun_w_m2 / kept : 0);
    }
    return STATUS_OK;
}

/* Whether a jet comes near an entity at the origin. */
static bool comes_near(const JetPath *path, double radius_m)
{
    double out_m2 = 0;
    for (int k = 0; k < 3; k++) {
        const double out_m = fmax(fmax(path->box.low_m[k], -path->box.high_m[k]), 0);
        out_m2 += out_m * out_m;
    }
    return path->count > 1 && out_m2 < radius_m * radius_m;
}

static Status blow(VehicleMoment *m, const NearScene *scene, int body, Arena *arena)
{
    const SnapshotEntity *e = &scene->snapshot->entity[scene->state[body]->index];
    double                from_enu[3], r_enu_from_body[9];
    JetPath              *path = arena_alloc(arena, 1, sizeof *path);
    if (!path) return STATUS_NO_MEMORY;
    v3_sub(from_enu, scene->body[body].p_enu, m->p_enu);
    m3_tmul(r_enu_from_body, scene->frame->r_ecef_from_enu, e->r_ecef_from_body);
    vehicle_jet(path, e->exhaust, from_enu, r_enu_from_body, scene->body[body].v_enu_mps, &m->place);
    if (comes_near(path, m->model->radius_m)) m->jet[m->jets++] = path;
    return STATUS_OK;
}

Status vehicle_near_moment(NearWork *work, VehicleMoment *m, const NearScene *scene, int me, double t_s, bool past,
                           bool lately, Arena *arena)
{
    Neighbours found;
    vehicle_neighbours_find(&found, scene->body, scene->count, me, m->place.sun_d_enu, past);
    Status status = shine(m, scene, scene->state[me], t_s, past, arena);
    *work = (NearWork){0};
    m->jets = m->shades = 0;
    for (int k = 0; k < found.count && status == STATUS_OK; k++) {
        const Neighbour *n = &found.of[k];
        if (n->why & NEAR_SUN) {
            const PatchPose *pose = pose_of(&status, scene, n->body, m->p_enu, arena);
            if (pose) m->shade[m->shades++] = pose->posed;
            work->poses++;
        }
        if (n->why & NEAR_JET && lately && status == STATUS_OK) {
            status = blow(m, scene, n->body, arena);
            work->jets++;
        }
    }
    return status;
}
