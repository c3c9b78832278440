/* entities/table/entity_report.c: applies an Entity State or its Update to the entity's slot. */
#include "entities/table/entity_table_private.h"

#include "dis/clock/exercise_clock.h"

/* shorter than the time in which a launcher uses an id again */
static const double after_detonation_s = 1;

/* Above escape velocity (11.2 km/s), and above the acceleration of a gun-launched round in flight. */
static const double largest_speed_mps = 2e4, largest_acceleration_mps2 = 1e4;

/* Heartbeats of IEEE 1278.1-2012: 55 or 60 s for land, sea, life forms, the environment and stationary entities; 5 s
 * for air, space and munitions. Timeout is 2.4 of them. Before version 7 practice is 5 s for all. */
static double timeout_of(const EntityTable *table, const EntitySlot *slot, uint8_t version)
{
    const double *v = slot->reported.v_mps;
    const bool    flies = slot->type.domain == dis_domain_air || slot->type.domain == dis_domain_space;
    const bool    quick = slot->type.kind == dis_kind_munition || (slot->type.kind == dis_kind_platform && flies);
    const bool    stands = v[0] == 0 && v[1] == 0 && v[2] == 0 && slot->type.kind != dis_kind_munition;
    return version >= 7 && (!quick || stands) ? table->config.timeout_land_v7_s : table->config.timeout_s;
}

/* Converts three floats to double. Returns false, and sets zeros, when one is not finite or their length is above the
 * limit. */
static bool sanitize(double out[3], const float in[3], double longest)
{
    const double v[3] = {in[0], in[1], in[2]};
    const bool   good = v3_length(v) <= longest; /* false for NaN too */
    for (int i = 0; i < 3; i++) out[i] = good ? v[i] : 0;
    return good;
}

/* Whether a report is stale, that is, older than the entity's latest; it is then counted. */
static bool is_late(EntityTable *table, const EntitySlot *slot, double t_s)
{
    if (!(t_s < slot->report_s)) return false;
    table->counters.late++;
    return true;
}

/* Whether a report is of a removed entity: it is older than the end; or the end was a Detonation, and it follows right
 * after it, or calls the munition destroyed (VR-Forces sends one such report before the one that deactivates). Only
 * checked when an entity would be created. */
static bool has_ended(const EntityTable *table, const DisEntityState *pdu, double t_s)
{
    const bool destroyed = (pdu->appearance >> dis_appearance_damage_shift & 3) == dis_damage_destroyed;
    return tombstones_ended(table->tombstones, pdu->id, t_s, destroyed ? table->config.timeout_s : after_detonation_s);
}

/* Entities of the focus are exempt from the rate. */
static bool exceeds_rate(EntityTable *table, DisEntityId id, double t_s)
{
    if (dis_entity_id_compare(id, table->focus.host) == 0 || dis_entity_id_compare(id, table->focus.also) == 0)
        return false;
    if (entity_rate_take(table->rate, id, t_s)) return false;
    table->counters.over_rate++;
    return true;
}

/* Advances extrapolated state to t_s before the next report replaces it. Distance travelled is the dead-reckoned one,
 * so that wheels never jump; its error is that of the position, a metre. With a static algorithm the displacement
 * between reports is used. */
static void close_interval(EntitySlot *slot, const double p_next_ecef[3], const double r_next[9], double t_s)
{
    Motion motion;

    slot->spin_s = entity_slot_spin(slot, t_s);
    slot->spin_from_s = t_s;
    drives_pause(&slot->drives, t_s - entity_slot_running(slot, t_s));
    slot->articulation.t_s += t_s - entity_slot_time(slot, t_s); /* joints have followed their rates in its own time */
    dead_reckon(&motion, &slot->reported, entity_slot_dt(slot, t_s));
    double missed_m[3], turn[9];
    v3_sub(missed_m, p_next_ecef, motion.p_ecef);
    m3_tmul(turn, motion.r_ecef_from_body, r_next);
    slot->missed.m = v3_length(missed_m);
    slot->missed.rad = acos(clamp(0.5 * (turn[0] + turn[4] + turn[8] - 1), -1, 1));
    slot->missed.s = fmax(t_s - slot->report_s, 0);
    if (slot->reported.algorithm == 1) slot->distance_m += entity_slot_forward(slot, p_next_ecef, r_next);
    else slot->distance_m += entity_slot_forward(slot, motion.p_ecef, motion.r_ecef_from_body);
    if (!isfinite(slot->distance_m) || fabs(slot->distance_m) > 1e9) slot->distance_m = 0;
}

/* Notes by how much a report's time has moved against its sender's stamps since the last one, so that the pose
 * continues from where it was shown. A move below 0.1 ms is ignored; beyond 5 s the sender has begun anew. */
static void take_shift(const EntityTable *table, EntitySlot *slot, uint32_t stamp, bool is_first, double t_s)
{
    static const double least_s = 1e-4, most_s = 5;
    const uint32_t      before = slot->stamp;
    slot->stamp = stamp;
    if (is_first || isnan(table->arrival_s) || !before || !stamp || !table->by_stamp) {
        slot->shift_s = 0;
        return;
    }
    const double left_s = entity_slot_shift_left(slot->shift_s, table->arrival_s - slot->shift_from_s);
    const double moved_s = t_s - slot->report_s - dis_timestamp_step_s(before, stamp);
    const double shift_s = (slot->shift_s != 0 ? left_s : 0) + (fabs(moved_s) >= least_s ? moved_s : 0);
    slot->shift_s = fabs(shift_s) <= most_s ? shift_s : 0;
    slot->shift_from_s = table->arrival_s;
}

/* Takes in position, velocity and attitude, which both kinds of report have. */
static void take_place(EntityTable *table, EntitySlot *slot, const double p_ecef[3], const float v_mps[3],
                       const float euler_rad[3], bool is_first, double t_s)
{
    double r[9];
    r_ecef_from_body_euler(r, euler_rad[0], euler_rad[1], euler_rad[2]);
    if (is_first) slot->spin_s = slot->spin_from_s = t_s, slot->missed.s = 0;
    else close_interval(slot, p_ecef, r, t_s);

    memcpy(slot->reported.p_ecef, p_ecef, sizeof slot->reported.p_ecef);
    memcpy(slot->reported.r_ecef_from_body, r, sizeof r);
    if (!sanitize(slot->reported.v_mps, v_mps, largest_speed_mps)) table->counters.motion_refused++;
}

/* Vertical component of the velocity, upwards positive. */
static double climb_mps(const Kinematics *k)
{
    double v_ecef_mps[3], up[3];
    memcpy(v_ecef_mps, k->v_mps, sizeof v_ecef_mps);
    if (dead_reckoning_in_body_axes(k->algorithm)) m3_mul_v3(v_ecef_mps, k->r_ecef_from_body, k->v_mps);
    return v3_normalize(up, k->p_ecef) ? v3_dot(v_ecef_mps, up) : 0;
}

/* What both kinds of report contain besides place and motion. */
typedef struct ReportedState {
    uint8_t                     version;
    uint32_t                    appearance;
    const DisVariableParameter *record;
    int                         records;
} ReportedState;

/* Takes in appearance, heat, articulation and times: the end of both kinds of report. */
static void take_state(EntityTable *table, EntitySlot *slot, const ReportedState *state, bool is_first, double t_s)
{
    const uint32_t appearance = state->appearance;
    slot->appearance = appearance;
    slot->report_s = t_s;
    slot->paused_s = 0;
    if (slot->stopped && slot->reports_on) slot->stop_s = t_s;
    else if (slot->stopped && t_s > slot->stop_s) table->stopped_count--, slot->stopped = false;
    slot->timeout_s = timeout_of(table, slot, state->version);
    slot->hold_s = table->config.extrapolation_limit_s * (slot->timeout_s / table->config.timeout_s);

    const Kinematics   *k = &slot->reported;
    const bool          frozen = entity_slot_frozen(slot), turns = !frozen && dead_reckoning_turns(k->algorithm);
    const DriveEvidence evidence = {.type = slot->type,
                                    .appearance = appearance,
                                    .speed_mps = frozen ? 0 : v3_length(k->v_mps),
                                    .climb_mps = frozen ? 0 : climb_mps(k),
                                    .turn_rps = turns ? k->w_body_rps[2] : 0};
    const bool          was_destroyed = slot->drives.destroyed;
    if (is_first) drives_begin(&slot->drives, &evidence, t_s);
    else drives_report(&slot->drives, &evidence, t_s);
    table->changes += is_first || slot->drives.destroyed != was_destroyed;

    table->counters.unknown_articulation +=
        (uint64_t)articulation_report(&slot->articulation, state->record, state->records, t_s, slot->hold_s);
    entity_effects_report(table, slot, t_s);
    entity_marks_report(table, slot, is_first, t_s);
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
        if (has_ended(table, pdu, t_s)) {
            table->counters.late++;
            return STATUS_OK;
        }
        if (exceeds_rate(table, pdu->id, t_s)) return STATUS_OK;
        slot = entity_slot_new(table, pdu->id, t_s);
        entity_slot_rank(table, slot, pdu->p_ecef, t_s);
        if (!entity_slot_admit(table, slot, t_s)) return STATUS_UNSUPPORTED;
        table->counters.created++;
    } else {
        entity_slot_rank(table, slot, pdu->p_ecef, t_s);
    }
    if (!is_first) entity_marks_before(table, slot, t_s);
    if (is_first || !same_type(slot->type, pdu->type)) {
        if (!is_first) entity_marks_end(table, slot, false, t_s);
        slot->type = pdu->type;
        slot->model = catalog_find(table->catalog, pdu->type, &slot->origin, NULL);
        slot->roles = table->model_roles[slot->model];
        entity_effects_outlet(table, slot->model);
        slot->articulation.count = 0;
    }
    slot->force = pdu->force;
    memcpy(slot->marking, pdu->marking, sizeof pdu->marking);

    take_place(table, slot, pdu->p_ecef, pdu->velocity_mps, euler_rad, is_first, t_s);
    take_shift(table, slot, pdu->header.timestamp, is_first, t_s);
    slot->reported.algorithm = pdu->dead_reckoning >= 1 && pdu->dead_reckoning <= 9 ? pdu->dead_reckoning : 1;
    if (!sanitize(slot->reported.a_mps2, pdu->acceleration_mps2, largest_acceleration_mps2))
        table->counters.motion_refused++;
    if (!sanitize(slot->reported.w_body_rps, pdu->angular_rate_rps, table->config.rate_limit_rps))
        table->counters.motion_refused++;
    const ReportedState state = {pdu->header.version, pdu->appearance, pdu->variable, pdu->variable_count};
    take_state(table, slot, &state, is_first, t_s);
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
    entity_slot_rank(table, slot, pdu->p_ecef, t_s);
    entity_marks_before(table, slot, t_s);
    take_place(table, slot, pdu->p_ecef, pdu->velocity_mps, euler_rad, false, t_s);
    take_shift(table, slot, pdu->header.timestamp, false, t_s);
    const ReportedState state = {pdu->header.version, pdu->appearance, pdu->variable, pdu->variable_count};
    take_state(table, slot, &state, false, t_s);
    return STATUS_OK;
}
