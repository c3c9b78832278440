/* entities/table/entity_table.c: slots, reports and ends. How a slot becomes a pose: snapshot.c. */
#include "entities/table/entity_table_private.h"

#include <stdlib.h>

enum { capacity_limit = 1 << 22 };

static const uint16_t all_ids = 0xFFFF;

/* No launcher uses an id again so soon. */
static const double after_detonation_s = 1;

/* Faster than anything that leaves the Earth (11.2 km/s), and harder than a gun-launched round once it flies. */
static const double largest_speed_mps = 2e4, largest_acceleration_mps2 = 1e4;

EntityTableConfig entity_table_default_config(void)
{
    return (EntityTableConfig){.capacity = 16384, .shown = capacity_limit, .timeout_s = 12, .timeout_land_v7_s = 132,
                               .extrapolation_limit_s = 12, .rate_limit_rps = 20, .ambient_s = 3600};
}

static bool config_is_usable(const EntityTableConfig *config)
{
    const double positive[4] = {config->timeout_s, config->timeout_land_v7_s, config->extrapolation_limit_s,
                                config->rate_limit_rps};
    for (int i = 0; i < 4; i++)
        if (!(positive[i] > 0 && positive[i] <= 1e6)) return false;
    return config->capacity > 0 && config->capacity <= capacity_limit && config->shown > 0 && config->ambient_s >= 0;
}

Status entity_table_create(EntityTable **out, const EntityTableConfig *config, const Catalog *catalog,
                           const char *heat_path)
{
    if (!config_is_usable(config)) {
        log_error("entity_table: configuration out of range: capacity=%d of 1 .. %d, times and rates above 0 up to 1e6",
                  config->capacity, capacity_limit);
        return STATUS_BAD_VALUE;
    }
    Status       status = STATUS_NO_MEMORY;
    EntityTable *table = calloc(1, sizeof *table);
    if (!table) return status;

    table->config = *config;
    table->catalog = catalog;
    const int slots = config->capacity + 1;
    table->slot = calloc((size_t)slots, sizeof *table->slot);
    table->free_slot = calloc((size_t)slots, sizeof *table->free_slot);
    table->model_roles = calloc((size_t)catalog_model_count(catalog), sizeof *table->model_roles);
    if (!table->slot || !table->free_slot || !table->model_roles) goto fail;
    status = entity_index_create(&table->index, slots);
    if (status == STATUS_OK) status = entity_ranks_create(&table->ranks, slots, config->capacity);
    if (status != STATUS_OK) goto fail;
    status = heat_table_open(&table->heat, heat_path);
    if (status != STATUS_OK) goto fail;
    char path[4096];
    status = STATUS_BAD_VALUE;
    if (etc_path(path, sizeof path, "effects.csv")) status = effect_history_create(&table->effects, path);
    if (status != STATUS_OK) goto fail;
    for (int m = 0; m < catalog_model_count(catalog); m++)
        table->model_roles[m] = heat_roles(catalog_model(catalog, m), &table->heat);

    *out = table;
    return STATUS_OK;

fail:
    entity_table_destroy(table);
    return status;
}

void entity_table_destroy(EntityTable *table)
{
    if (!table) return;
    entity_index_destroy(&table->index);
    entity_ranks_destroy(table->ranks);
    effect_history_destroy(table->effects);
    free(table->slot);
    free(table->free_slot);
    free(table->model_roles);
    free(table);
}

/* ---- slots -------------------------------------------------------------------------------- */

EntitySlot *entity_slot_find(const EntityTable *table, DisEntityId id)
{
    const int s = entity_index_find(&table->index, entity_key(id));
    return s < 0 ? NULL : table->slot + s;
}

/* There is room for one more than the table keeps: entity_room_make. */
static EntitySlot *new_slot(EntityTable *table, DisEntityId id, double t_s)
{
    const int   s    = table->free_count > 0 ? table->free_slot[--table->free_count] : table->slot_end++;
    EntitySlot *slot = table->slot + s;
    const uint32_t generation = slot->generation + 1;
    memset(slot, 0, sizeof *slot);
    slot->generation = generation;
    slot->id = id;
    slot->created_s = t_s;
    entity_index_insert(&table->index, entity_key(id), s);
    table->count++;
    return slot;
}

void entity_slot_free(EntityTable *table, EntitySlot *slot)
{
    const int s = (int)(slot - table->slot);
    entity_ranks_remove(table->ranks, s);
    entity_index_remove(&table->index, entity_key(slot->id));
    table->stopped_count -= slot->stopped;
    slot->generation++;
    table->free_slot[table->free_count++] = s;
    table->count--;
}

void entity_slot_remove(EntityTable *table, EntitySlot *slot, double t_s, uint64_t *counter)
{
    if (counter != &table->counters.evicted) /* which may come back */
        table->grave[table->grave_next++ % entity_grave_count] =
            (EntityGrave){entity_key(slot->id) + 1, t_s, counter == &table->counters.detonated};
    entity_effects_end(table, slot, t_s);
    entity_slot_free(table, slot);
    ++*counter;
}

/* Whether a report speaks of one who is gone: it is older than the end; or the end was a Detonation, and it comes
 * right after it, or calls the munition destroyed (VR-Forces sends one such report before the one that deactivates).
 * Only asked when an entity would be created. */
static bool is_ghost(const EntityTable *table, const DisEntityState *pdu, double t_s)
{
    const uint64_t key = entity_key(pdu->id) + 1;
    const bool destroyed = (pdu->appearance >> dis_appearance_damage_shift & 3) == dis_damage_destroyed;
    for (int g = 0; g < entity_grave_count; g++) {
        const EntityGrave *grave = table->grave + g;
        if (grave->key_plus_1 != key) continue;
        const double after_s = !grave->detonated ? 0 : destroyed ? table->config.timeout_s : after_detonation_s;
        if (t_s < grave->end_s + after_s) return true;
    }
    return false;
}

int entity_table_count(const EntityTable *table) { return table->count; }

EntityHandle entity_table_find(const EntityTable *table, DisEntityId id)
{
    const int s = entity_index_find(&table->index, entity_key(id));
    return s < 0 ? (EntityHandle){0} : (EntityHandle){(uint32_t)s, table->slot[s].generation};
}

bool entity_table_alive(const EntityTable *table, EntityHandle handle)
{
    return handle.slot < (uint32_t)table->slot_end && handle.generation & 1 &&
           table->slot[handle.slot].generation == handle.generation;
}

bool entity_table_type(DisEntityType *out, const EntityTable *table, EntityHandle handle)
{
    if (!entity_table_alive(table, handle)) return false;
    *out = table->slot[handle.slot].type;
    return true;
}

const EntityCounters *entity_table_counters(const EntityTable *table) { return &table->counters; }

const EffectCounters *entity_table_effect_counters(const EntityTable *table)
{
    return effect_history_counters(table->effects);
}

/* ---- what a report means ------------------------------------------------------------------ */

/* Heartbeats of IEEE 1278.1-2012: 55 or 60 s for land, sea, life forms, the environment and whatever stands; 5 s
 * for air, space and munitions. Timeout is 2.4 of them. Before version 7 practice is 5 s for everybody. */
static double timeout_of(const EntityTable *table, const EntitySlot *slot, uint8_t version)
{
    const double *v = slot->reported.v_mps;
    const bool flies = slot->type.domain == dis_domain_air || slot->type.domain == dis_domain_space;
    const bool quick = slot->type.kind == dis_kind_munition || (slot->type.kind == dis_kind_platform && flies);
    const bool stands = v[0] == 0 && v[1] == 0 && v[2] == 0 && slot->type.kind != dis_kind_munition;
    return version >= 7 && (!quick || stands) ? table->config.timeout_land_v7_s : table->config.timeout_s;
}

/* Narrow in, wide out; false and zero when it is not finite or longer than anything real. */
static bool believe(double out[3], const float in[3], double longest)
{
    const double v[3] = {in[0], in[1], in[2]};
    const bool   good = v3_length(v) <= longest; /* false for NaN */
    for (int i = 0; i < 3; i++) out[i] = good ? v[i] : 0;
    return good;
}

/* A report that no longer counts: older than the one we have. */
static bool is_late(EntityTable *table, const EntitySlot *slot, double t_s)
{
    if (!(t_s < slot->report_s)) return false;
    table->counters.late++;
    return true;
}

double entity_slot_spin(const EntitySlot *slot, double t_s)
{
    if (entity_slot_frozen(slot) || slot->stopped) return slot->spin_s;
    return slot->spin_s + fmax(0, fmin(t_s, heat_runs_until(&slot->heat)) - slot->spin_from_s);
}

/* Chord times mean heading: within 4 % of the arc up to a radian of turn. */
double entity_slot_forward(const EntitySlot *slot, const double p_ecef[3], const double r_ecef_from_body[9])
{
    const double *r0 = slot->reported.r_ecef_from_body;
    const double sum[3] = {r0[0] + r_ecef_from_body[0], r0[3] + r_ecef_from_body[3], r0[6] + r_ecef_from_body[6]};
    double forward[3], moved[3];
    if (!v3_normalize(forward, sum)) return 0;
    v3_sub(moved, p_ecef, slot->reported.p_ecef);
    return v3_dot(moved, forward);
}

/* Brings what runs on between reports up to t_s, before the next report replaces what it ran on. The way is the
 * dead-reckoned one, so that a wheel never jumps; its difference from the truth is the position's, a metre. A
 * static algorithm has no way of its own: there the reports' own displacement counts. */
static void close_interval(EntitySlot *slot, const double p_next_ecef[3], const double r_next[9], double t_s)
{
    Motion motion;

    slot->spin_s = entity_slot_spin(slot, t_s);
    slot->spin_from_s = t_s;
    dead_reckon(&motion, &slot->reported, entity_slot_dt(slot, t_s));
    double missed_m[3], turn[9];
    v3_sub(missed_m, p_next_ecef, motion.p_ecef);
    m3_tmul(turn, motion.r_ecef_from_body, r_next);
    slot->missed_m   = v3_length(missed_m);
    slot->missed_rad = acos(clamp(0.5 * (turn[0] + turn[4] + turn[8] - 1), -1, 1));
    slot->missed_s   = fmax(t_s - slot->report_s, 0);
    if (slot->reported.algorithm == 1) slot->distance_m += entity_slot_forward(slot, p_next_ecef, r_next);
    else slot->distance_m += entity_slot_forward(slot, motion.p_ecef, motion.r_ecef_from_body);
    if (!isfinite(slot->distance_m) || fabs(slot->distance_m) > 1e9) slot->distance_m = 0;
}

/* Place, velocity and attitude, which both kinds of report carry. */
static void take_place(EntityTable *table, EntitySlot *slot, const double p_ecef[3], const float v_mps[3],
                       const float euler_rad[3], bool is_first, double t_s)
{
    double r[9];
    r_ecef_from_body_euler(r, euler_rad[0], euler_rad[1], euler_rad[2]);
    if (is_first) slot->spin_s = slot->spin_from_s = t_s, slot->missed_s = 0;
    else close_interval(slot, p_ecef, r, t_s);

    memcpy(slot->reported.p_ecef, p_ecef, sizeof slot->reported.p_ecef);
    memcpy(slot->reported.r_ecef_from_body, r, sizeof r);
    if (!believe(slot->reported.v_mps, v_mps, largest_speed_mps)) table->counters.motion_refused++;
}

/* Appearance, heat, articulation and times: the end of both kinds of report. */
static void take_state(EntityTable *table, EntitySlot *slot, uint8_t version, uint32_t appearance,
                       const DisVariableParameter *record, int record_count, bool is_first, double t_s)
{
    slot->appearance = appearance;
    slot->report_s = t_s;
    table->stopped_count -= slot->stopped;
    slot->stopped = false;
    slot->paused_s = 0;
    slot->timeout_s = timeout_of(table, slot, version);
    slot->hold_s = table->config.extrapolation_limit_s * (slot->timeout_s / table->config.timeout_s);

    const HeatEvidence evidence = {.type = slot->type, .appearance = appearance,
                                   .speed_mps = entity_slot_frozen(slot) ? 0 : v3_length(slot->reported.v_mps)};
    if (is_first) heat_begin(&slot->heat, &table->heat, &evidence, t_s, table->config.ambient_s);
    else heat_report(&slot->heat, &table->heat, &evidence, t_s);

    table->counters.unknown_articulation +=
        (uint64_t)articulation_report(&slot->articulation, record, record_count, t_s, slot->hold_s);
    entity_effects_report(table, slot, t_s);
}

static bool same_type(DisEntityType a, DisEntityType b)
{
    return a.kind == b.kind && a.domain == b.domain && a.country == b.country && a.category == b.category &&
           a.subcategory == b.subcategory && a.specific == b.specific && a.extra == b.extra;
}

Status entity_table_entity_state(EntityTable *table, const DisEntityState *pdu, double t_s)
{
    const float euler_rad[3] = {pdu->psi_rad, pdu->theta_rad, pdu->phi_rad};
    EntitySlot *slot = entity_slot_find(table, pdu->id);

    if (slot && is_late(table, slot, t_s)) return STATUS_OK;
    if (slot && entity_slot_silent(slot, t_s)) {
        entity_slot_remove(table, slot, t_s, &table->counters.timed_out);
        slot = NULL;
    }
    if (pdu->appearance >> dis_appearance_deactivated_bit & 1) {
        if (slot) entity_slot_remove(table, slot, t_s, &table->counters.deactivated);
        return STATUS_OK;
    }
    const bool is_first = !slot;
    if (is_first) {
        if (is_ghost(table, pdu, t_s)) {
            table->counters.late++;
            return STATUS_OK;
        }
        slot = new_slot(table, pdu->id, t_s);
        entity_room_rank(table, slot, pdu->p_ecef, t_s);
        if (!entity_room_make(table, slot, t_s)) return STATUS_UNSUPPORTED;
        table->counters.created++;
    } else {
        entity_room_rank(table, slot, pdu->p_ecef, t_s);
    }
    if (is_first || !same_type(slot->type, pdu->type)) {
        slot->type = pdu->type;
        slot->model = catalog_find(table->catalog, pdu->type, &slot->origin, NULL);
        slot->roles = table->model_roles[slot->model];
        slot->articulation.count = 0;
    }
    slot->force = pdu->force;
    memcpy(slot->marking, pdu->marking, sizeof pdu->marking);

    take_place(table, slot, pdu->p_ecef, pdu->velocity_mps, euler_rad, is_first, t_s);
    slot->reported.algorithm = pdu->dead_reckoning >= 1 && pdu->dead_reckoning <= 9 ? pdu->dead_reckoning : 1;
    if (!believe(slot->reported.a_mps2, pdu->acceleration_mps2, largest_acceleration_mps2))
        table->counters.motion_refused++;
    if (!believe(slot->reported.w_body_rps, pdu->angular_rate_rps, table->config.rate_limit_rps))
        table->counters.motion_refused++;
    take_state(table, slot, pdu->header.version, pdu->appearance, pdu->variable, pdu->variable_count, is_first, t_s);
    return STATUS_OK;
}

Status entity_table_entity_state_update(EntityTable *table, const DisEntityStateUpdate *pdu, double t_s)
{
    const float euler_rad[3] = {pdu->psi_rad, pdu->theta_rad, pdu->phi_rad};
    EntitySlot *slot = entity_slot_find(table, pdu->id);

    if (slot && is_late(table, slot, t_s)) return STATUS_OK;
    if (slot && entity_slot_silent(slot, t_s)) {
        entity_slot_remove(table, slot, t_s, &table->counters.timed_out);
        slot = NULL;
    }
    if (!slot) {
        table->counters.updates_without_entity++;
        return STATUS_OK;
    }
    if (pdu->appearance >> dis_appearance_deactivated_bit & 1) {
        entity_slot_remove(table, slot, t_s, &table->counters.deactivated);
        return STATUS_OK;
    }
    entity_room_rank(table, slot, pdu->p_ecef, t_s);
    take_place(table, slot, pdu->p_ecef, pdu->velocity_mps, euler_rad, false, t_s);
    take_state(table, slot, pdu->header.version, pdu->appearance, pdu->variable, pdu->variable_count, false, t_s);
    return STATUS_OK;
}

/* ---- events ------------------------------------------------------------------------------- */

void entity_table_fire(EntityTable *table, const DisFire *pdu, double t_s)
{
    effect_history_fire(table->effects, pdu, t_s);
    EntitySlot *firing = entity_slot_find(table, pdu->firing), *munition = entity_slot_find(table, pdu->munition);
    if (firing) heat_fire(&firing->heat, &table->heat, t_s);
    if (munition && munition->type.kind == dis_kind_munition) heat_launch(&munition->heat, &table->heat, t_s);
}

/* A munition does not outlive its Detonation; not every sender says so with a last Entity State. Version 7 also
 * detonates things that are no munition and may stay. */
void entity_table_detonation(EntityTable *table, const DisDetonation *pdu, double t_s)
{
    effect_history_detonation(table->effects, pdu, t_s);
    EntitySlot *munition = entity_slot_find(table, pdu->munition);
    if (!munition || munition->type.kind != dis_kind_munition || t_s < munition->created_s) return;
    entity_slot_remove(table, munition, t_s, &table->counters.detonated);
}

static bool part_matches(uint16_t asked, uint16_t is) { return asked == is || asked == all_ids; }

static bool id_matches(DisEntityId asked, DisEntityId is)
{
    return part_matches(asked.site, is.site) && part_matches(asked.application, is.application) &&
           part_matches(asked.entity, is.entity);
}

/* Start and Stop name a simulation: entity 0 is the application itself, and so all that it simulates. */
static bool simulation_matches(DisEntityId asked, DisEntityId is)
{
    if (asked.entity == 0 && asked.site != 0) asked.entity = all_ids;
    return id_matches(asked, is);
}

void entity_table_remove(EntityTable *table, const DisRemoveEntity *pdu, double t_s)
{
    const DisEntityId asked = pdu->receiving;
    if (asked.site != all_ids && asked.application != all_ids && asked.entity != all_ids) {
        EntitySlot *slot = entity_slot_find(table, asked);
        if (slot) entity_slot_remove(table, slot, t_s, &table->counters.removed);
        return;
    }
    for (int s = 0; s < table->slot_end; s++) {
        EntitySlot *slot = table->slot + s;
        if (entity_slot_lives(slot) && id_matches(asked, slot->id))
            entity_slot_remove(table, slot, t_s, &table->counters.removed);
    }
}

void entity_table_stop(EntityTable *table, const DisStopFreeze *pdu, double t_s)
{
    if (table->stopped_count == table->count) return; /* said over and over, it must not cost a walk each time */
    for (int s = 0; s < table->slot_end; s++) {
        EntitySlot *slot = table->slot + s;
        if (!entity_slot_lives(slot) || slot->stopped || !simulation_matches(pdu->receiving, slot->id)) continue;
        const double stop_s = fmax(t_s, slot->report_s);
        slot->spin_s = entity_slot_spin(slot, stop_s);
        slot->spin_from_s = stop_s;
        slot->stop_s = stop_s;
        slot->stopped = true;
        table->stopped_count++;
        entity_effects_report(table, slot, stop_s);
    }
}

/* Goes on from where it stood: the pause does not count as motion. */
void entity_table_start(EntityTable *table, const DisStartResume *pdu, double t_s)
{
    if (table->stopped_count == 0) return;
    for (int s = 0; s < table->slot_end; s++) {
        EntitySlot *slot = table->slot + s;
        if (!entity_slot_lives(slot) || !slot->stopped || !simulation_matches(pdu->receiving, slot->id)) continue;
        slot->paused_s += fmax(0, t_s - slot->stop_s);
        slot->spin_from_s = fmax(t_s, slot->stop_s);
        slot->stopped = false;
        table->stopped_count--;
        entity_effects_report(table, slot, fmax(t_s, slot->stop_s));
    }
}

void entity_table_expire(EntityTable *table, double t_s)
{
    for (int s = 0; s < table->slot_end; s++) {
        EntitySlot *slot = table->slot + s;
        if (entity_slot_lives(slot) && entity_slot_silent(slot, t_s))
            entity_slot_remove(table, slot, t_s, &table->counters.timed_out);
    }
}

/* ---- by type ------------------------------------------------------------------------------ */

static void count_drop(DisCounters *counters, Status status)
{
    if (status == STATUS_UNSUPPORTED) counters->dropped[DIS_DROP_TABLE_FULL]++;
    else if (status == STATUS_BAD_VALUE) counters->dropped[DIS_DROP_BAD_COUNT]++;
    else if (status != STATUS_OK) counters->dropped[DIS_DROP_TRUNCATED]++;
}

static Status take_entity_state(EntityTable *table, const uint8_t *octets, size_t count, double t_s,
                                DisCounters *counters)
{
    DisEntityState pdu;
    DisDrop why;
    const Status status = dis_decode_entity_state(&pdu, octets, count);
    if (status != STATUS_OK) return status;
    const float euler_rad[3] = {pdu.psi_rad, pdu.theta_rad, pdu.phi_rad};
    if (dis_entity_is_usable(&why, pdu.id, pdu.p_ecef, pdu.velocity_mps, euler_rad))
        return entity_table_entity_state(table, &pdu, t_s);
    counters->dropped[why]++;
    return STATUS_OK;
}

static Status take_entity_state_update(EntityTable *table, const uint8_t *octets, size_t count, double t_s,
                                       DisCounters *counters)
{
    DisEntityStateUpdate pdu;
    DisDrop why;
    const Status status = dis_decode_entity_state_update(&pdu, octets, count);
    if (status != STATUS_OK) return status;
    const float euler_rad[3] = {pdu.psi_rad, pdu.theta_rad, pdu.phi_rad};
    if (dis_entity_is_usable(&why, pdu.id, pdu.p_ecef, pdu.velocity_mps, euler_rad))
        return entity_table_entity_state_update(table, &pdu, t_s);
    counters->dropped[why]++;
    return STATUS_OK;
}

static Status take_warfare(EntityTable *table, uint8_t type, const uint8_t *octets, size_t count, double t_s)
{
    if (type == dis_pdu_fire) {
        DisFire pdu;
        const Status status = dis_decode_fire(&pdu, octets, count);
        if (status == STATUS_OK) entity_table_fire(table, &pdu, t_s);
        return status;
    }
    DisDetonation pdu;
    const Status status = dis_decode_detonation(&pdu, octets, count);
    if (status == STATUS_OK) entity_table_detonation(table, &pdu, t_s);
    return status;
}

static Status take_management(EntityTable *table, uint8_t type, const uint8_t *octets, size_t count, double t_s)
{
    Status status;
    if (type == dis_pdu_remove_entity) {
        DisRemoveEntity pdu;
        status = dis_decode_remove_entity(&pdu, octets, count);
        if (status == STATUS_OK) entity_table_remove(table, &pdu, t_s);
    } else if (type == dis_pdu_start_resume) {
        DisStartResume pdu;
        status = dis_decode_start_resume(&pdu, octets, count);
        if (status == STATUS_OK) entity_table_start(table, &pdu, t_s);
    } else {
        DisStopFreeze pdu;
        status = dis_decode_stop_freeze(&pdu, octets, count);
        if (status == STATUS_OK) entity_table_stop(table, &pdu, t_s);
    }
    return status;
}

void entity_table_pdu(EntityTable *table, const DisHeader *header, const uint8_t *pdu, double t_s,
                      DisCounters *counters)
{
    const size_t octets = header->length;
    Status status = STATUS_OK;

    if (!isfinite(t_s)) return;
    switch (header->type) {
    case dis_pdu_entity_state: status = take_entity_state(table, pdu, octets, t_s, counters); break;
    case dis_pdu_entity_state_update: status = take_entity_state_update(table, pdu, octets, t_s, counters); break;
    case dis_pdu_fire:
    case dis_pdu_detonation: status = take_warfare(table, header->type, pdu, octets, t_s); break;
    case dis_pdu_remove_entity:
    case dis_pdu_start_resume:
    case dis_pdu_stop_freeze: status = take_management(table, header->type, pdu, octets, t_s); break;
    default: break;
    }
    count_drop(counters, status);
}
