/* entities/table/entity_marks.c: which marks an entity leaves on the ground, by its type and motion. Whatever is
 * recorded follows from PDUs: nothing from a snapshot, a timeout or a tick. */
#include "entities/table/entity_table_private.h"
#include "entities/traces/vehicle_traces.h"

static const double moving_mps = 0.3;  /* the limit of drives.c */
static const double stood_s = 60;      /* shorter stands leave no mark */
static const double near_ground_m = 3; /* the elevation of senders differs from ours by metres */
static const double stood_least_s = 300, stood_most_s = 3 * 86400, again_s = 3600;

/* ---- the entity ------------------------------------------------------------------------------- */

static EntityMarks *marks_of(const EntityTable *table, const EntitySlot *slot)
{
    return &table->mark[slot - table->slot];
}

static bool is_vehicle(const EntitySlot *slot)
{
    return slot->type.kind == dis_kind_platform && slot->type.domain == dis_domain_land;
}

static bool is_aircraft(const EntitySlot *slot)
{
    return slot->type.kind == dis_kind_platform && slot->type.domain == dis_domain_air;
}

/* Whether an aircraft is parked on the ground. A hovering helicopter has no speed either, so without elevation data
 * none is parked. */
static bool is_on_ground(const EntityTable *table, const EntitySlot *slot, const double p_ecef[3])
{
    if (contact_applies(slot->type)) return true;
    return is_aircraft(slot) && fabs(contact_above_m(&table->config.ground, p_ecef)) <= near_ground_m;
}

/* The model's origin, the centre of the base, for a reported position. */
static void base_of(double p_base_ecef[3], const EntitySlot *slot, const Model *model, const double p_ecef[3],
                    const double r_ecef_from_body[9])
{
    const double below_m = slot->origin == ORIGIN_CENTRE ? 0.5 * model->height_m : 0;
    for (int i = 0; i < 3; i++) p_base_ecef[i] = p_ecef[i] + r_ecef_from_body[3 * i + 2] * below_m;
}

/* Moves a base to where its entity is shown: onto the ground, if it is clamped to it. */
static void settle(double p_base_ecef[3], const EntityTable *table, const EntitySlot *slot, const double v_ecef_mps[3])
{
    contact_move(p_base_ecef, slot->type, v_ecef_mps, &table->config.ground);
}

/* ---- stands ----------------------------------------------------------------------------------- */

static double lasts_until_s(const EntitySlot *slot) { return slot->report_s + slot->paused_s + slot->timeout_s; }

/* Finds what an entity's exhaust did from this place, after a report. Returns false when its engine runs again, which
 * begins another stand. */
static bool blows(EntityTable *table, const EntitySlot *slot, EntityMarks *m, bool is_first, double t_s)
{
    static const double before_s = 3600; /* render/heat/vehicle_heat.h assumes this time of the engine's past as well */
    const ModelOutlet  *outlet = &table->outlet[slot->model];
    const DriveUntil   *engine = &slot->drives.engine;
    GroundBlow         *b = &m->blow;
    const bool          began = b->to_s > b->from_s;
    if (!outlet->is_there) return true;
    if (!(drives_engine(&slot->drives, t_s) > 0)) {
        if (began) b->to_s = fmin(b->to_s, t_s);
        return true;
    }
    if (began && b->to_s < t_s) return false;
    if (!began) {
        const ExhaustJet *jet = &outlet->jet;
        *b = (GroundBlow){.radius_m = (float)jet->radius_m,
                          .speed_mps = (float)jet->speed_mps,
                          .excess_k = (float)jet->excess_k,
                          .from_s = is_first ? fmax(t_s - before_s, m->from_s) : t_s};
        for (int k = 0; k < 3; k++) b->at_m[k] = (float)jet->at_body[k], b->d[k] = (float)jet->d_body[k];
    }
    b->to_s = entity_slot_frozen(slot) || slot->stopped ? INFINITY : engine->until_s;
    return true;
}

/* Sets place and attitude of a stand, as the entity is shown there. */
static void set_place(GroundStand *stand, const EntityTable *table, const EntitySlot *slot, const EntityMarks *m)
{
    SnapshotEntity e = {.type = slot->type};
    memcpy(e.p_ecef, m->p_ecef, sizeof e.p_ecef);
    memcpy(e.r_ecef_from_body, m->r_ecef_from_body, sizeof e.r_ecef_from_body);
    contact_set(&e, &table->config.ground, catalog_model(table->catalog, slot->model));
    memcpy(stand->p_ecef, e.p_ecef, sizeof stand->p_ecef);
    memcpy(stand->r_ecef_from_body, e.r_ecef_from_body, sizeof stand->r_ecef_from_body);
}

/* How long it has stood that stands at its first report. Nothing in DIS says so. */
static double stood_before_s(const EntityTable *table, const EntitySlot *slot)
{
    enum { stream = 83 };
    if (!isnan(table->config.stood_s)) return table->config.stood_s;
    return stood_least_s *
           pow(stood_most_s / stood_least_s, random_uniform(table->config.seed, stream, 0, entity_key(slot->id)));
}

static void begin_stand(EntityTable *table, EntitySlot *slot, const double p_ecef[3], bool is_first, double t_s)
{
    EntityMarks *m = marks_of(table, slot);
    m->stands = true;
    m->from_s = is_first ? t_s - stood_before_s(table, slot) : t_s;
    m->stand = 0;
    m->blow = (GroundBlow){0};
    memcpy(m->p_ecef, p_ecef, sizeof m->p_ecef);
    memcpy(m->r_ecef_from_body, slot->reported.r_ecef_from_body, sizeof m->r_ecef_from_body);
    if (!is_first) return;
    GroundStand stand = {.from_s = m->from_s, .to_s = lasts_until_s(slot), .owner = entity_key(slot->id) + 1};
    set_place(&stand, table, slot, m);
    m->stand = ground_stand_again(&m->from_s, table->ground, &stand, t_s - again_s);
    if (m->stand) ground_stand_until(table->ground, m->stand, stand.to_s);
}

static const ModelStand *stood_of(EntityTable *table, const EntitySlot *slot)
{
    static const uint32_t thin = UINT32_C(1) << HEAT_GUN | UINT32_C(1) << HEAT_ROTOR;
    ModelStand           *s = &table->stood[slot->model];
    double                low_m[3], high_m[3];
    if (s->known) return s;
    model_box_without(low_m, high_m, catalog_model(table->catalog, slot->model), thin);
    for (int k = 0; k < 3; k++) s->low_m[k] = (float)low_m[k], s->high_m[k] = (float)high_m[k];
    s->known = true;
    return s;
}

/* A recorded stand, and what its exhaust does, last until to_s. */
static void lasts(EntityTable *table, const EntityMarks *m, double to_s)
{
    GroundBlow blow = m->blow;
    blow.to_s = fmin(blow.to_s, to_s);
    ground_stand_until(table->ground, m->stand, to_s);
    if (blow.to_s > blow.from_s) ground_stand_blows(table->ground, m->stand, &blow);
}

/* Records a stand with the first report that finds it old enough, or that ends it. */
static void record_stand(EntityTable *table, const EntitySlot *slot, EntityMarks *m, double to_s, double t_s)
{
    if (m->stand) {
        lasts(table, m, to_s);
        return;
    }
    if (!(t_s - m->from_s >= stood_s)) return;
    GroundBlow blow = m->blow;
    blow.to_s = fmin(blow.to_s, to_s);
    const ModelStand *box = stood_of(table, slot);
    GroundStand       stand = {.from_s = m->from_s, .to_s = to_s, .owner = entity_key(slot->id) + 1, .blow = blow};
    set_place(&stand, table, slot, m);
    memcpy(stand.low_m, box->low_m, sizeof stand.low_m);
    memcpy(stand.high_m, box->high_m, sizeof stand.high_m);
    m->stand = ground_stand_open(table->ground, &stand);
}

static void end_stand(EntityTable *table, const EntitySlot *slot, EntityMarks *m, double t_s)
{
    if (m->stands) record_stand(table, slot, m, t_s, t_s);
    m->stands = false;
    m->stand = 0;
}

/* ---- trails ----------------------------------------------------------------------------------- */

/* Categories of land platforms with tracks, where the model does not show them: tanks, armoured fighting vehicles,
 * self-propelled artillery, tracked utility vehicles (SISO-REF-010). */
static bool is_tracked(const EntitySlot *slot)
{
    const uint8_t c = slot->type.category;
    if (slot->roles >> HEAT_TRACK & 1) return true;
    if (slot->roles >> HEAT_WHEEL & 1) return false;
    return c == 1 || c == 2 || c == 4 || c == 8 || c == 9;
}

static GroundTrack track_of(const EntitySlot *slot, const Model *model)
{
    GroundTrack track = vehicle_track(model, is_tracked(slot));
    track.owner = entity_key(slot->id) + 1;
    return track;
}

static double speed_of(const EntitySlot *slot)
{
    return entity_slot_frozen(slot) ? 0 : v3_length(slot->reported.v_mps);
}

/* Interval of the points of an extrapolated path: 3 degrees of course at a time, but not below 1 m; a power of two of
 * 1/16 s. INFINITY: it is straight. */
static double step_of(const EntitySlot *slot, double span_s, int most)
{
    static const double turn_rad = 3 * rad_per_deg, least_m = 1, tick_s = 0.0625;
    const int           algorithm = slot->reported.algorithm;
    const double        speed_mps = speed_of(slot);
    const bool          body = dead_reckoning_in_body_axes(algorithm);
    const double        w_rps = body && dead_reckoning_turns(algorithm) ? v3_length(slot->reported.w_body_rps) : 0;
    const double        turn_rps = w_rps + v3_length(slot->reported.a_mps2) / fmax(speed_mps, 1);
    if (algorithm <= 1 || !(speed_mps > 0) || !(turn_rps * span_s > turn_rad)) return INFINITY;
    double step_s = tick_s;
    while (2 * step_s <= fmax(turn_rad / turn_rps, least_m / speed_mps) || step_s * most < span_s) step_s *= 2;
    return step_s;
}

/* Where the points of a trail go: into the history of its owner, or into out[count]. */
typedef struct TrailSink {
    const EntityTable *table;
    const EntitySlot  *slot;
    GroundHistory     *history;
    GroundTrack       *out;
    int                count;
} TrailSink;

static void put_point(TrailSink *sink, GroundTrail *trail, const double p_ecef[3], double t_s, bool last)
{
    if (sink->history) ground_trail_point(sink->history, trail, p_ecef, t_s, last);
    else sink->count += ground_trail_tail(sink->out + sink->count, trail, p_ecef, t_s, last);
}

static void path_point(TrailSink *sink, GroundTrail *trail, double own_s, bool last)
{
    const EntityTable *table = sink->table;
    const EntitySlot  *slot = sink->slot;
    Motion             motion;
    double             p_ecef[3];
    dead_reckon(&motion, &slot->reported, own_s - slot->report_s);
    base_of(p_ecef, slot, catalog_model(table->catalog, slot->model), motion.p_ecef, motion.r_ecef_from_body);
    settle(p_ecef, table, slot, motion.v_ecef_mps);
    put_point(sink, trail, p_ecef, own_s + slot->paused_s, last);
}

/* Follows the extrapolated path after from_s up to its end, which is included or not. Times are the entity's own. */
static void follow(TrailSink *sink, GroundTrail *trail, double from_s, double to_s, int most, bool with_end)
{
    const double step_s = step_of(sink->slot, to_s - from_s, most), first = floor(from_s / step_s) + 1;
    for (int i = 0; isfinite(step_s) && i < most && (first + i) * step_s < to_s; i++)
        path_point(sink, trail, (first + i) * step_s, false);
    if (with_end && to_s > from_s) path_point(sink, trail, to_s, true);
}

/* End of the extrapolation for t_s, in the entity's own time. */
static double own_end_s(const EntitySlot *slot, double t_s) { return slot->report_s + entity_slot_dt(slot, t_s); }

enum { most_points = 64, most_tail_points = 7 };

void entity_marks_before(EntityTable *table, EntitySlot *slot, double t_s)
{
    if (!slot->trails) return;
    EntityMarks *m = marks_of(table, slot);
    TrailSink    sink = {.table = table, .slot = slot, .history = table->ground};
    const double to_s = own_end_s(slot, t_s);
    follow(&sink, &m->trail, m->followed_s, to_s, most_points, false);
    m->followed_s = to_s;
}

/* Continues an entity's trail after a report. */
static void report_trail(EntityTable *table, EntitySlot *slot, EntityMarks *m, const double p_base_ecef[3],
                         double speed_mps, double t_s)
{
    const bool moves = speed_mps >= moving_mps;
    Motion     motion;
    double     p_ecef[3] = {p_base_ecef[0], p_base_ecef[1], p_base_ecef[2]};
    if (!moves && !m->trail.on) return;
    dead_reckon(&motion, &slot->reported, 0);
    settle(p_ecef, table, slot, motion.v_ecef_mps);
    if (m->trail.on) {
        m->trail.speed_mps = fmax(m->trail.speed_mps, speed_mps);
        ground_trail_point(table->ground, &m->trail, p_ecef, t_s, !moves);
    } else if (moves) {
        m->trail =
            (GroundTrail){.on = true, .t_s = t_s, .shape = track_of(slot, catalog_model(table->catalog, slot->model))};
        memcpy(m->trail.p_ecef, p_ecef, sizeof m->trail.p_ecef);
    }
    m->trail.speed_mps = speed_mps;
    m->trail.on = slot->trails = moves;
    m->followed_s = t_s;
}

/* ---- reports ---------------------------------------------------------------------------------- */

void entity_marks_report(EntityTable *table, EntitySlot *slot, bool is_first, double t_s)
{
    const bool vehicle = is_vehicle(slot), aircraft = is_aircraft(slot);
    if (!vehicle && !aircraft && !contact_applies(slot->type)) return;
    const double speed_mps = speed_of(slot);
    const bool   still = speed_mps < moving_mps;
    if (!(fabs(t_s) < effect_latest_s) || (aircraft && !still && !slot->marks)) return;

    EntityMarks *m = marks_of(table, slot);
    if (!slot->marks) memset(m, 0, sizeof *m);
    slot->marks = true;
    double        p_ecef[3];
    const double *r = slot->reported.r_ecef_from_body;
    base_of(p_ecef, slot, catalog_model(table->catalog, slot->model), slot->reported.p_ecef, r);
    if (vehicle) report_trail(table, slot, m, p_ecef, speed_mps, t_s);

    if (m->stands && !(still && ground_stand_same_place(p_ecef, r, m->p_ecef, m->r_ecef_from_body)))
        end_stand(table, slot, m, t_s);
    if (m->stands && !blows(table, slot, m, false, t_s)) end_stand(table, slot, m, t_s);
    if (!m->stands && still && is_on_ground(table, slot, p_ecef)) {
        begin_stand(table, slot, p_ecef, is_first, t_s);
        blows(table, slot, m, is_first, t_s);
    }
    if (m->stands) record_stand(table, slot, m, lasts_until_s(slot), t_s);
    table->counters.marks_forgotten = (uint64_t)ground_history_forgotten(table->ground);
}

/* stopped entities do not time out, and an engine that runs does so until they go on */
void entity_marks_stop(EntityTable *table, EntitySlot *slot, double t_s)
{
    if (!slot->marks) return;
    EntityMarks *m = marks_of(table, slot);
    if (m->stands) {
        if (m->blow.to_s > t_s) m->blow.to_s = INFINITY;
        lasts(table, m, INFINITY);
    }
    if (!slot->trails) return;
    TrailSink    sink = {.table = table, .slot = slot, .history = table->ground};
    const double to_s = own_end_s(slot, t_s);
    follow(&sink, &m->trail, m->followed_s, to_s, most_points, true);
    m->followed_s = to_s;
}

void entity_marks_start(EntityTable *table, EntitySlot *slot, double t_s)
{
    if (!slot->marks) return;
    EntityMarks *m = marks_of(table, slot);
    if (m->stands) {
        if (m->blow.to_s == INFINITY) m->blow.to_s = slot->drives.engine.until_s + slot->paused_s;
        lasts(table, m, fmax(t_s, lasts_until_s(slot)));
    }
    if (!slot->trails) return;
    m->trail.t_s = m->followed_s + slot->paused_s; /* the time of the pause is not part of its speed */
    m->trail.piece = 0;
}

/* After a timeout, a stand ends at the time when the entity was due to report. The path since its last report was never
 * confirmed, and is left out. */
void entity_marks_end(EntityTable *table, EntitySlot *slot, bool silent, double t_s)
{
    if (!slot->marks) return;
    EntityMarks *m = marks_of(table, slot);
    if (!silent) {
        entity_marks_stop(table, slot, t_s);
        end_stand(table, slot, m, t_s);
        table->counters.marks_forgotten = (uint64_t)ground_history_forgotten(table->ground);
    }
    slot->marks = slot->trails = false;
}

/* ---- bursts ----------------------------------------------------------------------------------- */

/* Estimates, as a burst of 1 kg of explosive on bare soil leaves 2.5 m of scorched ground about a crater of 0.4 m; both
 * scale with the cube root of the charge. Heat: 100 kJ/m2. Within a factor of two. A penetrator burns no ground. */
void entity_marks_detonation(EntityTable *table, const DisDetonation *pdu, double t_s)
{
    static const double radius_m = 2.5, crater_m = 0.4;
    static const float  heat_j_m2 = 1e5f;
    const double        r_m = v3_length(pdu->p_ecef), size = cbrt(effect_charge_kg(&pdu->descriptor, false));
    if (!(r_m >= 1e5 && r_m <= 1e8) || !(fabs(t_s) < effect_latest_s) || effect_is_kinetic(&pdu->descriptor) ||
        effect_result_is_none(pdu->result) || effect_result_is_water(pdu->result))
        return;
    if (!effect_result_is_ground(pdu->result) &&
        !(fabs(contact_above_m(&table->config.ground, pdu->p_ecef)) <= near_ground_m))
        return;
    GroundBurn burn = {
        .t_s = t_s, .radius_m = (float)(radius_m * size), .crater_m = (float)(crater_m * size), .heat_j_m2 = heat_j_m2};
    static const DisEntityType vehicle = {.kind = dis_kind_platform, .domain = dis_domain_land};
    static const double        still[3] = {0};
    memcpy(burn.p_ecef, pdu->p_ecef, sizeof burn.p_ecef);
    contact_move(burn.p_ecef, vehicle, still,
                 &table->config.ground); /* moved by the same share as a vehicle at this place would be */
    ground_burn(table->ground, &burn);
    table->counters.marks_forgotten = (uint64_t)ground_history_forgotten(table->ground);
}

/* ---- at one instant ----------------------------------------------------------------------------- */

Status entity_marks_snapshot(Snapshot *snapshot, const EntityTable *table, const int *trailing, int count, Arena *arena)
{
    enum { most_tail = most_tail_points + 1, most_trailing = (ground_tracks_most - ground_track_capacity) / most_tail };
    GroundTrack *tail;
    if (count > most_trailing) count = most_trailing;
    const int    room = most_tail * count;
    const Status status = ground_marks_at(&snapshot->marks, &tail, table->ground, snapshot->t_s, room, arena);
    if (status != STATUS_OK) return status;
    TrailSink sink = {.table = table, .out = tail};
    for (int i = 0; i < count; i++) {
        const EntitySlot *slot = table->slot + trailing[i];
        GroundTrail       trail = marks_of(table, slot)->trail;
        sink.slot = slot;
        follow(&sink, &trail, marks_of(table, slot)->followed_s, own_end_s(slot, snapshot->t_s), most_tail_points,
               true);
    }
    snapshot->marks.tracks += sink.count;
    return STATUS_OK;
}
