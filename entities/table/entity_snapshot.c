/* entities/table/entity_snapshot.c: the table at one instant: all entities extrapolated, in the order of ids.
 *
 * Entities are processed in chunks with slots that stay in cache; those of one algorithm in a chunk go through
 * dead_reckon_arrays together. */
#include "entities/table/entity_table_private.h"

#include <limits.h>
#include <stddef.h>

static const double timeout_per_heartbeat = 2.4; /* IEEE 1278.1 */

/* How far from the truth an extrapolated position may be: nothing at its report, growing evenly to the standard's
 * threshold of 1 m at the sender's heartbeat, and from there as an unreported acceleration of 1 m/s2 would carry
 * it. Beyond hold_s the entity is held while it moves on at speed_mps. An estimate for error budgets, not a bound:
 * a sender's own threshold may differ, and a missile's motor start misses by 12 m. */
static double position_error_m(double age_s, double heartbeat_s, double hold_s, double speed_mps)
{
    static const double threshold_m = 1, unreported_mps2 = 1;

    const double age = fmax(age_s, 0), beyond = fmax(fmin(age, fmax(hold_s, heartbeat_s)) - heartbeat_s, 0);
    return threshold_m * fmin(age / heartbeat_s, 1) + 0.5 * unreported_mps2 * beyond * beyond +
           speed_mps * fmax(age - hold_s, 0);
}

/* ---- order -------------------------------------------------------------------------------- */

typedef struct Ordered {
    uint64_t key;
    int      slot;
} Ordered;

/* Sorts by id: radix sort, one octet per pass over the six octets of an id; a pass where all octets are equal is
 * skipped. Returns that of the two arrays which holds the result. */
static Ordered *sort_by_id(Ordered *from, Ordered *to, int count)
{
    for (int shift = 0; shift < 48; shift += 8) {
        int start[256] = {0}, at = 0;
        for (int i = 0; i < count; i++) start[from[i].key >> shift & 255]++;
        if (start[from[0].key >> shift & 255] == count) continue;
        for (int digit = 0; digit < 256; digit++) {
            const int here = start[digit];
            start[digit] = at;
            at += here;
        }
        for (int i = 0; i < count; i++) to[start[from[i].key >> shift & 255]++] = from[i];
        Ordered *const swap = from;
        from = to;
        to = swap;
    }
    return from;
}

/* ---- limit of rendered entities -------------------------------------------------------------- */

/* Squared distance of an entity's reported (not extrapolated) position from the focus, as an integer that sorts in the
 * same order. */
static uint64_t nearness(const EntityTable *table, const EntitySlot *slot)
{
    const EntityFocus *focus = &table->focus;
    double             d[3], d2_m2;
    uint64_t           bits;
    if (!focus->placed || dis_entity_id_compare(slot->id, focus->host) == 0 ||
        dis_entity_id_compare(slot->id, focus->also) == 0)
        return 0;
    v3_sub(d, slot->reported.p_ecef, focus->p_ecef);
    d2_m2 = v3_dot(d, d);
    memcpy(&bits, &d2_m2, sizeof bits);
    return bits;
}

/* Finds the `wanted`-th smallest value by radix select, one octet per pass, from the highest. *at_it: how many of the
 * values equal to it are among the first `wanted`. */
static uint64_t last_wanted(int *at_it, const uint64_t *value, int count, int wanted)
{
    uint64_t prefix = 0;
    for (int shift = 56; shift >= 0; shift -= 8) {
        const uint64_t mask = shift == 56 ? 0 : ~UINT64_C(0) << (shift + 8);
        int            digit = 0, of[256] = {0};
        for (int i = 0; i < count; i++)
            if ((value[i] & mask) == prefix) of[value[i] >> shift & 255]++;
        for (; of[digit] < wanted; digit++) wanted -= of[digit];
        prefix |= (uint64_t)digit << shift;
    }
    *at_it = wanted;
    return prefix;
}

/* Of `count` entities in the order of ids, keeps the config.shown nearest to the focus, in that order; at equal
 * distance those with lower ids. */
static Status keep_nearest(Ordered *order, int *count, const EntityTable *table, Arena *arena)
{
    const int wanted = table->config.shown;
    if (*count <= wanted) return STATUS_OK;
    uint64_t *near = arena_alloc(arena, (size_t)*count, sizeof *near);
    if (!near) return STATUS_NO_MEMORY;
    for (int i = 0; i < *count; i++) near[i] = nearness(table, table->slot + order[i].slot);
    int            at_it, kept = 0;
    const uint64_t last = last_wanted(&at_it, near, *count, wanted);
    for (int i = 0; i < *count; i++) {
        if (near[i] > last || (near[i] == last && at_it-- <= 0)) continue;
        order[kept++] = order[i];
    }
    *count = kept;
    return STATUS_OK;
}

/* ---- motion ------------------------------------------------------------------------------- */

enum { block_count = 128 }; /* entities in a chunk, and most entities of one algorithm in a block */

/* The arrays of one block for dead_reckon_arrays: 22 inputs, 15 outputs, 37 KB. */
typedef struct MotionBlock {
    double in[22][block_count], out[15][block_count];
} MotionBlock;

static void block_arrays(KinematicsArrays *k, MotionArrays *m, MotionBlock *block, int count)
{
    int a = 0;
    for (int i = 0; i < 3; i++) {
        k->p_ecef[i] = block->in[a++];
        k->v_mps[i] = block->in[a++];
        k->a_mps2[i] = block->in[a++];
        k->w_body_rps[i] = block->in[a++];
    }
    for (int i = 0; i < 9; i++) k->r_ecef_from_body[i] = block->in[a++];
    k->dt_s = block->in[a++];
    k->count = count;
    a = 0;
    for (int i = 0; i < 3; i++) {
        m->p_ecef[i] = block->out[a++];
        m->v_ecef_mps[i] = block->out[a++];
    }
    for (int i = 0; i < 9; i++) m->r_ecef_from_body[i] = block->out[a++];
}

/* Whether a position is near the Earth. An extrapolated one that is not comes from an invalid report. */
static bool is_near_earth(const double p_ecef[3])
{
    const double r_m = v3_length(p_ecef);
    return r_m >= 1e5 && r_m <= 1e8;
}

/* Extrapolates entities of one algorithm. member[count]: their indices into entity and order. */
static void reckon_block(SnapshotEntity *entity, const EntityTable *table, const Ordered *order, int algorithm,
                         const int *member, int count, double t_s)
{
    MotionBlock      block;
    KinematicsArrays k;
    MotionArrays     m;

    block_arrays(&k, &m, &block, count);
    for (int b = 0; b < count; b++) {
        const EntitySlot *slot = table->slot + order[member[b]].slot;
        for (int i = 0; i < 3; i++) {
            k.p_ecef[i][b] = slot->reported.p_ecef[i];
            k.v_mps[i][b] = slot->reported.v_mps[i];
            k.a_mps2[i][b] = slot->reported.a_mps2[i];
            k.w_body_rps[i][b] = slot->reported.w_body_rps[i];
        }
        for (int i = 0; i < 9; i++) k.r_ecef_from_body[i][b] = slot->reported.r_ecef_from_body[i];
        k.dt_s[b] = entity_slot_dt(slot, t_s);
    }
    dead_reckon_arrays(&m, algorithm, &k);

    for (int b = 0; b < count; b++) {
        const EntitySlot *slot = table->slot + order[member[b]].slot;
        const bool        stands = entity_slot_frozen(slot) || slot->stopped;
        SnapshotEntity   *e = entity + member[b];
        for (int i = 0; i < 3; i++) {
            e->p_ecef[i] = m.p_ecef[i][b];
            e->v_ecef_mps[i] = stands ? 0 : m.v_ecef_mps[i][b];
            e->w_body_rps[i] = stands || !dead_reckoning_turns(algorithm) ? 0 : slot->reported.w_body_rps[i];
        }
        for (int i = 0; i < 9; i++) e->r_ecef_from_body[i] = m.r_ecef_from_body[i][b];
        if (is_near_earth(e->p_ecef)) continue;
        memcpy(e->p_ecef, slot->reported.p_ecef, sizeof e->p_ecef);
        memset(e->v_ecef_mps, 0, sizeof e->v_ecef_mps);
    }
}

/* Prefetches the slots of a chunk, which lie far apart, since they are in no order of ids. */
static void fetch_slots(const EntityTable *table, const Ordered *order, int first, int end)
{
    for (int e = first; e < end; e++) {
        const char *slot = (const char *)(table->slot + order[e].slot);
        for (size_t at = 0; at < offsetof(EntitySlot, articulation) + 64; at += 64) __builtin_prefetch(slot + at);
    }
}

/* Extrapolates entities first .. end - 1, those of each algorithm together. */
static void reckon_chunk(SnapshotEntity *entity, const EntityTable *table, const Ordered *order, int first, int end,
                         double t_s)
{
    int member[10][block_count], members[10] = {0};

    for (int e = first; e < end; e++) {
        const int a = table->slot[order[e].slot].reported.algorithm;
        member[a][members[a]++] = e;
    }
    for (int a = 1; a < 10; a++)
        if (members[a] > 0) reckon_block(entity, table, order, a, member[a], members[a], t_s);
}

/* ---- the rest of an entity ---------------------------------------------------------------- */

/* Replaces a reported position by the model's origin: the centre of its base, on the ground where it is clamped; z
 * points down. */
static void place_origin(SnapshotEntity *e, const EntityTable *table, const EntitySlot *slot)
{
    const double height_m = catalog_model(table->catalog, slot->model)->height_m;
    if (slot->origin == ORIGIN_CENTRE)
        for (int i = 0; i < 3; i++) e->p_ecef[i] += e->r_ecef_from_body[3 * i + 2] * 0.5 * height_m;
    contact_set(e, &table->config.ground, catalog_model(table->catalog, slot->model));
}

/* What drives the joints of an entity that is still at its reported position. Only rolling parts need the distance. */
static JointDrive drive_joints(const EntitySlot *slot, const SnapshotEntity *e, double t_s)
{
    const bool   stands = entity_slot_frozen(slot) || slot->stopped;
    const double forward_m =
        entity_slot_dt(slot, t_s) != 0 ? entity_slot_forward(slot, e->p_ecef, e->r_ecef_from_body) : 0;
    return (JointDrive){.spin_s = entity_slot_spin(slot, t_s),
                        .distance_m = slot->distance_m + forward_m,
                        .speed_mps = stands ? 0 : v3_length(e->v_ecef_mps)};
}

/* What moves an entity's joints: its reports, and its drives at the entity's own time. */
typedef struct Joints {
    const Articulation *articulation;
    JointDrive          drive;
    double              time_s, hold_s;
} Joints;

static void pose_nodes(NodePose *pose, double *joint_value, const Model *model, const Joints *joints,
                       const SnapshotEntity *e)
{
    articulation_joint_values(joint_value, model, joints->articulation, &joints->drive, joints->time_s, joints->hold_s);
    entity_effects_wreck_joints(joint_value, model, e, joints->articulation->count);
    model_pose(pose, model, joint_value);
}

void snapshot_pose(NodePose *pose, double *joint_value, const Snapshot *snapshot, int index, const Model *model)
{
    const SnapshotEntity *e = &snapshot->entity[index];
    if (snapshot->node) {
        memcpy(pose, snapshot->node + e->first_node, (size_t)model->node_count * sizeof *pose);
        return;
    }
    const SnapshotJoints *joints = &snapshot->joints[index];
    Articulation          articulation;
    articulation.t_s = joints->report_s;
    articulation.count = joints->count;
    if (joints->count > 0)
        memcpy(articulation.joint, snapshot->joint_report + joints->first,
               (size_t)joints->count * sizeof *articulation.joint);
    pose_nodes(pose, joint_value, model, &(Joints){&articulation, joints->drive, joints->time_s, joints->hold_s}, e);
}

static void keep_joints(SnapshotJoints *to, JointReport *report, const EntitySlot *slot, const SnapshotEntity *e,
                        double t_s)
{
    to->report_s = slot->articulation.t_s;
    to->hold_s = slot->hold_s;
    to->time_s = entity_slot_time(slot, t_s);
    to->drive = drive_joints(slot, e, t_s);
    memcpy(report + to->first, slot->articulation.joint, (size_t)to->count * sizeof *report);
}

static void finish_entity(SnapshotEntity *e, SnapshotJoints *joints, JointReport *report, const EntityTable *table,
                          const EntitySlot *slot, double t_s)
{
    const bool stands = entity_slot_frozen(slot) || slot->stopped;

    e->id = slot->id;
    e->type = slot->type;
    e->force = slot->force;
    memcpy(e->marking, slot->marking, sizeof e->marking);
    e->appearance = slot->appearance;
    e->model = slot->model;
    e->age_s = fmax(t_s - slot->report_s, 0);
    const double moved_s = fmax(e->age_s - slot->paused_s, 0); /* while it is stopped its error does not grow */
    e->position_error_m = stands ? 0
                                 : position_error_m(moved_s, slot->timeout_s / timeout_per_heartbeat, slot->hold_s,
                                                    v3_length(e->v_ecef_mps));
    snapshot_drift(&e->drift_m, &e->drift_rad, moved_s, &slot->missed, e->position_error_m,
                   slot->timeout_s / timeout_per_heartbeat);
    if (stands) e->drift_m = e->drift_rad = 0;
    drives_at(&e->drives, &slot->drives, entity_slot_running(slot, t_s));
    e->exhaust = table->outlet[slot->model].is_there ? &table->outlet[slot->model].jet : NULL;
    e->first_patch = -1, e->patches = 0, e->dt_k = 0;

    keep_joints(joints, report, slot, e, t_s);

    place_origin(e, table, slot); /* comes last, since the distance travelled is measured between reported positions */
}

/* Entities in chunks, which are independent and distributed over the threads. */
typedef struct Chunks {
    Snapshot          *snapshot;
    const EntityTable *table;
    const Ordered     *order;
} Chunks;

static void finish_chunk(void *user, int worker, int chunk)
{
    (void)worker;
    const Chunks *all = user;
    Snapshot     *snapshot = all->snapshot;
    const int     first = chunk * block_count;
    const int     end = snapshot->count - first < block_count ? snapshot->count : first + block_count;
    fetch_slots(all->table, all->order, first, end);
    reckon_chunk(snapshot->entity, all->table, all->order, first, end, snapshot->t_s);
    for (int e = first; e < end; e++)
        finish_entity(snapshot->entity + e, snapshot->joints + e, snapshot->joint_report, all->table,
                      all->table->slot + all->order[e].slot, snapshot->t_s);
}

/* Adds the puffs attached to entities, then those emitted by entities and shots. */
static Status add_puffs(Snapshot *snapshot, const EntityTable *table, const Ordered *order, Arena *arena)
{
    EffectPuff *carried = NULL, some[entity_carried_max];
    int         count = 0;
    for (int pass = 0; pass < 2; pass++) {
        const int found = count;
        if (pass == 1 && found == 0) break;
        if (pass == 1 && !(carried = arena_alloc(arena, (size_t)found, sizeof *carried))) return STATUS_NO_MEMORY;
        count = 0;
        for (int e = 0; e < snapshot->count; e++) {
            const int more =
                entity_effects_carried(some, table, table->slot + order[e].slot, snapshot->entity + e, snapshot->t_s);
            if (pass == 1) memcpy(carried + count, some, (size_t)more * sizeof *some);
            count += more;
            if (pass == 1 && count == found) break;
        }
    }
    return entity_effects_snapshot(snapshot, table, carried, count, arena);
}

/* Whether an entity is a cloud of chaff: by its model, or as a cartridge of chaff and flare (SISO-REF-010, expendables,
 * category 3), which is a flare too. */
static bool is_chaff(const EntityTable *table, const EntitySlot *slot)
{
    return catalog_is_chaff(table->catalog, slot->model) || (slot->type.kind == 8 && slot->type.category == 3);
}

static Status add_chaff(Snapshot *snapshot, const EntityTable *table, int clouds, Arena *arena)
{
    Ordered *order = arena_alloc(arena, (size_t)clouds + 1, sizeof *order);
    Ordered *scratch = arena_alloc(arena, (size_t)clouds + 1, sizeof *scratch);
    snapshot->chaff = arena_alloc(arena, (size_t)clouds + 1, sizeof *snapshot->chaff);
    if (!order || !scratch || !snapshot->chaff) return STATUS_NO_MEMORY;
    for (int s = 0; s < table->slot_end; s++) {
        const EntitySlot *slot = table->slot + s;
        if (entity_slot_lives(slot) && !entity_slot_silent(slot, snapshot->t_s) && is_chaff(table, slot))
            order[snapshot->chaff_count++] = (Ordered){entity_key(slot->id), s};
    }
    order = sort_by_id(order, scratch, snapshot->chaff_count);
    for (int c = 0; c < snapshot->chaff_count; c++) {
        const EntitySlot *slot = table->slot + order[c].slot;
        SnapshotEntity    e = {0};
        const int         only = 0;
        reckon_block(&e, table, &order[c], slot->reported.algorithm, &only, 1, snapshot->t_s);
        SnapshotChaff *to = &snapshot->chaff[c];
        *to = (SnapshotChaff){.id = slot->id, .age_s = fmax(snapshot->t_s - slot->created_s, 0)};
        memcpy(to->p_ecef, e.p_ecef, sizeof to->p_ecef);
        memcpy(to->v_ecef_mps, e.v_ecef_mps, sizeof to->v_ecef_mps);
    }
    return STATUS_OK;
}

Status entity_table_snapshot(Snapshot *out, const EntityTable *table, double t_s, Arena *arena)
{
    enum { ahead = 12 }; /* slots prefetched ahead */
    Snapshot snapshot = {.t_s = t_s};

    if (!isfinite(t_s)) return STATUS_BAD_VALUE;
    const size_t capacity = (size_t)table->count + 1;
    Ordered     *order = arena_alloc(arena, capacity, sizeof *order);
    Ordered     *scratch = arena_alloc(arena, capacity, sizeof *scratch);
    if (!order || !scratch) return STATUS_NO_MEMORY;

    int clouds = 0;
    for (int s = 0; s < table->slot_end; s++) {
        const EntitySlot *slot = table->slot + s;
        if (s + ahead < table->slot_end) { /* of a slot only the first two cache lines are read here */
            __builtin_prefetch(slot + ahead);
            __builtin_prefetch((const char *)(slot + ahead) + 64);
        }
        if (!entity_slot_lives(slot) || entity_slot_silent(slot, t_s)) continue;
        clouds += is_chaff(table, slot);
        if (!catalog_has_shape(table->catalog, slot->model)) continue;
        order[snapshot.count++] = (Ordered){entity_key(slot->id), s};
    }
    if (snapshot.count > 0) order = sort_by_id(order, scratch, snapshot.count);
    const int    found = snapshot.count;
    const Status nearest = keep_nearest(order, &snapshot.count, table, arena);
    if (nearest != STATUS_OK) return nearest;
    snapshot.left_out = found - snapshot.count;
    snapshot.entity = arena_alloc(arena, (size_t)snapshot.count + 1, sizeof *snapshot.entity);
    if (!snapshot.entity) return STATUS_NO_MEMORY;

    snapshot.joints = arena_alloc(arena, (size_t)snapshot.count + 1, sizeof *snapshot.joints);
    if (!snapshot.joints) return STATUS_NO_MEMORY;
    int *trailing = arena_alloc(arena, (size_t)snapshot.count + 1, sizeof *trailing);
    if (!trailing) return STATUS_NO_MEMORY;
    int reports = 0, trails = 0;
    for (int e = 0; e < snapshot.count; e++) {
        const EntitySlot *slot = table->slot + order[e].slot;
        if (e + ahead < snapshot.count) {
            const EntitySlot *next = table->slot + order[e + ahead].slot;
            __builtin_prefetch(&next->model);
            __builtin_prefetch(&next->trails);
            __builtin_prefetch(&next->articulation.count);
        }
        const int nodes = catalog_model(table->catalog, slot->model)->node_count;
        if (nodes > INT_MAX - snapshot.node_count || slot->articulation.count > INT_MAX - reports)
            return STATUS_NO_MEMORY;
        snapshot.entity[e].first_node = snapshot.node_count;
        snapshot.node_count += nodes;
        snapshot.joints[e].first = reports;
        snapshot.joints[e].count = slot->articulation.count;
        reports += slot->articulation.count;
        if (slot->trails) trailing[trails++] = order[e].slot;
    }
    snapshot.joint_report = arena_alloc(arena, (size_t)reports + 1, sizeof *snapshot.joint_report);
    if (!snapshot.joint_report) return STATUS_NO_MEMORY;
    Pool     *pool = table->config.pool;
    const int chunks = (snapshot.count + block_count - 1) / block_count;

    Chunks all = {&snapshot, table, order};
    if (pool) pool_run(pool, chunks, finish_chunk, &all);
    else
        for (int chunk = 0; chunk < chunks; chunk++) finish_chunk(&all, 0, chunk);
    Status status = add_puffs(&snapshot, table, order, arena);
    if (status == STATUS_OK && clouds > 0) status = add_chaff(&snapshot, table, clouds, arena);
    if (status == STATUS_OK) status = entity_marks_snapshot(&snapshot, table, trailing, trails, arena);
    if (status == STATUS_OK) *out = snapshot;
    return status;
}

bool entity_table_pose_nodes(SnapshotEntity *out, NodePose *node, double *joint_value, const EntityTable *table,
                             EntityHandle handle, double t_s)
{
    if (!isfinite(t_s) || !entity_table_alive(table, handle)) return false;
    const EntitySlot *slot = table->slot + handle.slot;
    if (entity_slot_silent(slot, t_s)) return false;

    SnapshotEntity e = {.id = slot->id,
                        .type = slot->type,
                        .force = slot->force,
                        .appearance = slot->appearance,
                        .model = slot->model,
                        .age_s = fmax(t_s - slot->report_s, 0)};
    const Ordered  order = {entity_key(slot->id), (int)handle.slot};
    const int      only = 0;
    reckon_block(&e, table, &order, slot->reported.algorithm, &only, 1, t_s);
    if (node) {
        const Joints joints = {&slot->articulation, drive_joints(slot, &e, t_s), entity_slot_time(slot, t_s),
                               slot->hold_s};
        pose_nodes(node, joint_value, catalog_model(table->catalog, slot->model), &joints, &e);
    }
    place_origin(&e, table, slot);
    *out = e;
    return true;
}

bool entity_table_pose(SnapshotEntity *out, const EntityTable *table, EntityHandle handle, double t_s)
{
    return entity_table_pose_nodes(out, NULL, NULL, table, handle, t_s);
}
