/* entities/table/entity_effects.c: emissions by an entity's appearance and motion. Appearance bits are those of
 * dis/pdu/pdu.h; a guided munition's motor burns for the time given by drives.c, independent of its bits. */
#include "entities/table/entity_table_private.h"
#include "entities/traces/exhaust.h"
#include "entities/traces/vehicle_traces.h"

static const double moving_mps = 0.3; /* the limit of drives.c: stationary entities raise no dust */

static bool motor_burns(const EntitySlot *slot, double t_s)
{
    return slot->type.kind == dis_kind_munition &&
           (slot->appearance >> dis_appearance_power_plant_bit & 1 ||
            (slot->roles >> HEAT_MOTOR & 1 && slot->drives.motor.until_s > entity_slot_running(slot, t_s)));
}

/* Distance along body z from the reported position down to the centre of the model's base. */
static double base_below_m(const EntitySlot *slot, const Model *model)
{
    return slot->origin == ORIGIN_CENTRE ? 0.5 * model->height_m : 0;
}

static void open_source(EntityTable *table, EntitySlot *slot, int place, EffectSource *source, EffectKind kind,
                        double rate)
{
    source->kind = kind;
    source->rate = rate;
    slot->effect[place] = effect_history_open(table->effects, source);
}

void entity_effects_end(EntityTable *table, EntitySlot *slot, double t_s)
{
    for (int i = 0; i < entity_effect_positions; i++) {
        effect_history_close(table->effects, slot->effect[i], t_s);
        slot->effect[i] = 0;
    }
}

void entity_effects_report(EntityTable *table, EntitySlot *slot, double t_s)
{
    const uint32_t bits = slot->appearance;
    const bool     platform = slot->type.kind == dis_kind_platform, munition = slot->type.kind == dis_kind_munition;
    const bool     air = slot->type.domain == dis_domain_air;
    const int      smoke = bits >> dis_appearance_smoke_shift & 3, trail = bits >> dis_appearance_trail_shift & 3;
    const bool     flames = bits >> dis_appearance_flaming_bit & 1;

    entity_effects_end(table, slot, t_s);
    if (!(platform || munition) || !(flames || smoke || trail || motor_burns(slot, t_s))) return;

    const Model *model = catalog_model(table->catalog, slot->model);
    const bool   stands = entity_slot_frozen(slot) || slot->stopped;
    const double below_m = base_below_m(slot, model), top_m = below_m - model->height_m;
    EffectSource source = {.key = entity_key(slot->id) + 1,
                           .from_s = t_s,
                           .to_s = slot->stopped ? INFINITY : slot->report_s + slot->paused_s + slot->timeout_s,
                           .motion = slot->reported,
                           .motion_s = slot->report_s + slot->paused_s,
                           .hold_s = slot->hold_s,
                           .scale = vehicle_effect_scale(model),
                           .below_m = below_m,
                           .grounded = contact_applies(slot->type)};
    if (stands) {
        Motion motion;
        dead_reckon(&motion, &slot->reported, entity_slot_dt(slot, t_s));
        source.motion = (Kinematics){.algorithm = 1};
        memcpy(source.motion.p_ecef, motion.p_ecef, sizeof motion.p_ecef);
        memcpy(source.motion.r_ecef_from_body, motion.r_ecef_from_body, sizeof motion.r_ecef_from_body);
    } else {
        source.speed_mps = v3_length(slot->reported.v_mps);
    }
    if (flames) {
        EffectSource fire = source;
        fire.at_body[2] = below_m - 0.75 * model->height_m;
        fire.spread_body[0] = 0.3 * model->length_m;
        fire.spread_body[1] = 0.25 * model->width_m;
        fire.spread_body[2] = 0.15 * model->height_m;
        open_source(table, slot, 0, &fire, EFFECT_FLAME, 1);
    }
    if (platform && smoke & 1) {
        EffectSource plume = source;
        plume.at_body[2] = top_m;
        plume.spread_body[0] = 0.2 * model->length_m;
        plume.spread_body[1] = 0.2 * model->width_m;
        open_source(table, slot, 1, &plume, EFFECT_SMOKE, 1);
    }
    if (platform && smoke & 2) {
        EffectSource engine = source;
        engine.at_body[0] = 0.9 * model->box_low[0];
        engine.at_body[2] = below_m - 0.7 * model->height_m;
        open_source(table, slot, 2, &engine, EFFECT_ENGINE_SMOKE, 1);
    }
    if (platform && trail && (air || source.speed_mps > moving_mps)) {
        EffectSource behind = source;
        vehicle_dust(&behind, model, below_m);
        if (air) behind.at_body[2] = below_m - 0.5 * model->height_m, behind.spread_body[1] = 0;
        open_source(table, slot, 3, &behind, air ? EFFECT_CONTRAIL : EFFECT_DUST, vehicle_trail_rate[trail]);
    }
    if (munition && (trail || motor_burns(slot, t_s))) {
        EffectSource motor = source;
        motor.scale = 1;
        motor.at_body[0] = model->box_low[0];
        motor.at_body[2] = below_m - 0.5 * model->height_m;
        if (!trail && !(bits >> dis_appearance_power_plant_bit & 1) && !stands)
            motor.to_s = fmin(motor.to_s, slot->drives.motor.until_s + slot->paused_s);
        open_source(table, slot, 3, &motor, EFFECT_MOTOR_SMOKE, trail ? vehicle_trail_rate[trail] : 1);
    }
}

typedef struct Plume {
    EffectKind         kind;
    const EffectModel *law;
    double             length_m, across_scale;
} Plume;

/* Adds one volume of gas behind the tail. Its length fluctuates: random at every fiftieth of a second, linear in
 * between. */
static int plume_behind(EffectPuff *out, const SnapshotEntity *e, const Model *model, const Plume *plume, double t_s)
{
    const EffectKind    kind = plume->kind;
    const double        across_scale = plume->across_scale;
    static const double breath_hz = 50;
    const double        at = t_s * breath_hz, floor_at = floor(at);
    double              length = 0, tail_body[3] = {0}, tail_ecef[3];
    const uint64_t      key = entity_key(e->id);

    for (int k = 0; k < 2; k++) {
        const double   share = k ? at - floor_at : 1 - (at - floor_at);
        const uint64_t breath = (uint64_t)(int64_t)floor_at + (uint64_t)k;
        length += share * plume->length_m * (0.8 + 0.4 * random_uniform(key, 78, kind, breath));
    }
    *out = (EffectPuff){.kind = kind,
                        .owner = key + 1,
                        .group = (uint32_t)(key * 31 + kind),
                        .seed = (uint32_t)(int64_t)floor_at,
                        .throw_s = 1,
                        .scale = across_scale,
                        .along_m = 0.5 * length,
                        .mass_kg = plume->law->mass_kg * across_scale * across_scale * length};
    tail_body[0] =
        model->box_low[0] - 0.36 * length; /* a seventh of it is inside the tail, since it is thin at its very end */
    tail_body[2] = -0.5 * model->height_m;
    m3_mul_v3(tail_ecef, e->r_ecef_from_body, tail_body);
    v3_add(out->p_ecef, e->p_ecef, tail_ecef);
    for (int i = 0; i < 3; i++) out->axis_ecef[i] = e->r_ecef_from_body[3 * i];
    v3_scale(out->up_ecef, 1 / v3_length(e->p_ecef), e->p_ecef);
    return 1;
}

/* Whether a model has rotors and a turbine: a rotorcraft, whose gas leaves the turbine. */
static bool is_rotorcraft(uint32_t roles) { return roles >> HEAT_ROTOR & 1 && roles >> HEAT_TURBINE & 1; }

void entity_effects_outlet(EntityTable *table, int model)
{
    ModelOutlet *outlet = &table->outlet[model];
    if (outlet->known) return;
    outlet->is_there = exhaust_outlet(&outlet->jet, catalog_model(table->catalog, model),
                                      is_rotorcraft(table->model_roles[model]), effect_history_table(table->effects));
    outlet->known = true;
}

static int exhaust_of(EffectPuff *out, const SnapshotEntity *e, const ModelOutlet *outlet, EffectKind kind,
                      double drive, double scale, const EffectTable *table, double t_s)
{
    const ExhaustSource source = {.kind = kind,
                                  .jet = &outlet->jet,
                                  .key = entity_key(e->id),
                                  .drive = outlet->is_there ? drive : 0,
                                  .scale = scale,
                                  .p_ecef = e->p_ecef,
                                  .r_ecef_from_body = e->r_ecef_from_body,
                                  .v_ecef_mps = e->v_ecef_mps};
    return exhaust_behind(out, &source, table, t_s);
}

static int fire_about(EffectPuff *out, const SnapshotEntity *e, const EffectTable *table)
{
    const uint64_t key = entity_key(e->id);
    *out = (EffectPuff){.kind = EFFECT_FLARE_FIRE,
                        .owner = key + 1,
                        .group = (uint32_t)(key * 31),
                        .throw_s = 1,
                        .scale = 1,
                        .mass_kg = table->law[EFFECT_FLARE_FIRE].mass_kg};
    memcpy(out->p_ecef, e->p_ecef, sizeof out->p_ecef);
    v3_scale(out->up_ecef, 1 / v3_length(e->p_ecef), e->p_ecef);
    memcpy(out->axis_ecef, out->up_ecef, sizeof out->axis_ecef);
    return 1;
}

int entity_effects_carried(EffectPuff out[entity_carried_max], const EntityTable *table, const EntitySlot *slot,
                           const SnapshotEntity *entity, double t_s)
{
    const Model       *model = catalog_model(table->catalog, entity->model);
    const EffectTable *effects = effect_history_table(table->effects);
    const bool         platform = slot->type.kind == dis_kind_platform, air = slot->type.domain == dis_domain_air;
    const double       drive = platform ? drives_engine(&slot->drives, entity_slot_running(slot, t_s)) : 0;
    const ModelOutlet *outlet = &table->outlet[entity->model];

    if (!(fabs(t_s) < effect_latest_s)) return 0;
    if (motor_burns(slot, t_s)) /* scale: a light missile is 1.2 m long and has 1.5 m of flame */
        return plume_behind(out, entity, model,
                            &(Plume){EFFECT_MOTOR_PLUME, &effects->law[EFFECT_MOTOR_PLUME],
                                     fmax(1.25 * model->length_m, 0.5), clamp(model->width_m / 0.3, 0.5, 4)},
                            t_s);
    if (slot->type.kind == dis_kind_expendable && slot->roles >> HEAT_FLARE & 1 &&
        slot->drives.flare.until_s > entity_slot_running(slot, t_s))
        return fire_about(out, entity, effects);
    if (platform && air && entity->appearance >> dis_appearance_afterburner_bit & 1)
        return plume_behind(out, entity, model, &(Plume){EFFECT_AFTERBURNER, &effects->law[EFFECT_AFTERBURNER], 4, 1},
                            t_s);
    if (!(drive > 0)) return 0;
    if (air && is_rotorcraft(slot->roles))
        return exhaust_of(out, entity, outlet, EFFECT_TURBINE_EXHAUST, drive, 1, effects, t_s);
    if (air && slot->roles >> HEAT_TURBINE & 1)
        return plume_behind(out, entity, model, &(Plume){EFFECT_JET_EXHAUST, &effects->law[EFFECT_JET_EXHAUST], 6, 1},
                            t_s);
    if (!air) return exhaust_of(out, entity, outlet, EFFECT_EXHAUST, drive, vehicle_effect_scale(model), effects, t_s);
    return 0;
}

/* Moves a puff onto the ground. An entity that is clamped to the ground emits smoke there, and a burst on the ground is
 * on the same ground. */
static void set_onto_ground(EffectPuff *puff, const ContactGround *ground)
{
    static const DisEntityType vehicle = {.kind = dis_kind_platform, .domain = dis_domain_land};
    double                     way_m = puff->grounded ? puff->above_m - contact_above_m(ground, puff->p_ecef) : 0;
    if (ground->landscape)
        way_m *= contact_share(vehicle, way_m); /* it is moved by the same share of the way as its entity */
    if (isfinite(way_m)) v3_add_scaled(puff->p_ecef, puff->p_ecef, way_m, puff->up_ecef);
}

/* Puffs in chunks, which are independent and distributed over the threads. */
typedef struct PuffChunks {
    EffectPuff          *puff;
    int                  count;
    const ContactGround *ground;
} PuffChunks;

enum { chunk_puffs = 64 };

static void ground_chunk(void *user, int worker, int chunk)
{
    const PuffChunks *all = user;
    const int         first = chunk * chunk_puffs;
    (void)worker;
    for (int i = first; i < first + chunk_puffs && i < all->count; i++) set_onto_ground(&all->puff[i], all->ground);
}

Status entity_effects_snapshot(Snapshot *snapshot, const EntityTable *table, const EffectPuff *carried,
                               int carried_count, Arena *arena)
{
    const size_t all = effect_history_puffs(NULL, 0, table->effects, snapshot->t_s) + (size_t)carried_count;
    const size_t count = all < effect_puff_capacity ? all : effect_puff_capacity;
    snapshot->effect_table = effect_history_table(table->effects);
    if (all == 0) return STATUS_OK;
    EffectPuff *puff = arena_alloc_raw(arena, count, sizeof *puff);
    if (!puff) return STATUS_NO_MEMORY;
    const size_t first = (size_t)carried_count < count ? (size_t)carried_count : count;
    if (first > 0) memcpy(puff, carried, first * sizeof *puff);
    if (count > first) effect_history_puffs(puff + first, count - first, table->effects, snapshot->t_s);
    PuffChunks chunks = {puff, (int)count, &table->config.ground};
    const int  tasks = ((int)count + chunk_puffs - 1) / chunk_puffs;
    if (table->config.pool) pool_run(table->config.pool, tasks, ground_chunk, &chunks);
    else
        for (int k = 0; k < tasks; k++) ground_chunk(&chunks, 0, k);
    snapshot->puff = puff;
    snapshot->puff_count = (int)count;
    snapshot->puffs_left_out = (int64_t)(all - count);
    return STATUS_OK;
}

/* A wreck's gun is at its lower stop and its turret at an arbitrary azimuth, unless the sender reports these joints. */
void entity_effects_wreck_joints(double *joint_value, const Model *model, const SnapshotEntity *entity, int reports)
{
    if (entity->type.kind != dis_kind_platform || reports > 0 ||
        (entity->appearance >> dis_appearance_damage_shift & 3) != dis_damage_destroyed)
        return;
    for (int n = 0; n < model->node_count; n++) {
        const ModelNode *node = &model->node[n];
        if (node->dis_class < 4096 || node->dis_class >= 7000) continue; /* classes 4096 .. 6999: turrets and guns */
        if (node->dis_metric == 13) joint_value[n] = node->low < node->high ? node->low : -0.1;
        if (node->dis_metric == 11)
            joint_value[n] = 0.6 * (2 * random_uniform(entity_key(entity->id), 79, 0, (uint64_t)n) - 1);
    }
}
