/* tests/bench/entities/stability_pdus.c: every number of a PDU at the ends of floating point. Each must be
 * refused and counted, or every snapshot that follows must be finite. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"

#include "dis/pdu/decode.h"
#include "dis/pdu/octets.h"
#include "entities/motion/dead_reckoning.h"
#include "entities/table/entity_table.h"

#include <float.h>
#include <stdlib.h>

/* ---- PDUs ----------------------------------------------------------------------------------- */

/* As bits: the fields are written as octets, so that signalling NaNs and denormals arrive. */
static const uint32_t singles[] = {0x00000000, 0x80000000, 0x00000001,           0x80000001, 0x007FFFFF, 0x00800000,
                                   0x7F7FFFFF, 0xFF7FFFFF, 0x7F800000,           0xFF800000, 0x7FC00000, 0x7F800001,
                                   0xFFC00000, 0x5F800000, 0xDF800000,           0x1F800000, 0x3FC90FDB, 0xBFC90FDB,
                                   0x3FC90FDA, 0x40490FDB, 0x469C4000 /* 2e4 */, 0xC69C4001, 0x41A00001 /* 20 */};
static const double   doubles[] = {0,
                                   -0.0,
                                   5e-324,
                                   -5e-324,
                                   2.2250738585072009e-308,
                                   DBL_MIN,
                                   DBL_MAX,
                                   -DBL_MAX,
                                   INFINITY,
                                   -INFINITY,
                                   NAN,
                                   1e154,
                                   1.4e154,
                                   -1e155,
                                   1e-160,
                                   6378137,
                                   -6378137,
                                   1e5,
                                   99999.999999,
                                   1e8,
                                   100000000.00000001,
                                   -1e8,
                                   1e38};
enum { single_count = sizeof singles / sizeof *singles, double_count = sizeof doubles / sizeof *doubles };

typedef struct Field {
    int  at;
    bool wide;
} Field;

static const Field state_fields[] = {{36, false},  {40, false},  {44, false},  {48, true},   {56, true},
                                     {64, true},   {72, false},  {76, false},  {80, false},  {104, false},
                                     {108, false}, {112, false}, {116, false}, {120, false}, {124, false},
                                     {152, false}, {168, false}, {184, false}};
static const Field update_fields[] = {{20, false}, {24, false}, {28, false}, {32, true},  {40, true},  {48, true},
                                      {56, false}, {60, false}, {64, false}, {80, false}, {96, false}, {112, false}};
static const Field fire_fields[] = {{40, true},  {48, true},  {56, true}, {80, false},
                                    {84, false}, {88, false}, {92, false}};
static const Field detonation_fields[] = {{36, false}, {40, false}, {44, false}, {48, true}, {56, true},
                                          {64, true},  {88, false}, {92, false}, {96, false}};

typedef struct World {
    Catalog     *catalog;
    EntityTable *table;
    Arena       *arena;
    LocalFrame   frame;
    DisCounters  counters;
    double       t_s;
    uint16_t     entity;
    double       cases, refused, bad;
} World;

static Status world_open(World *w)
{
    const EntityTableConfig config = entity_table_default_config();
    const Geodetic          origin = {0, 0, 0};
    char                    catalog[512];
    *w = (World){.arena = arena_create(), .t_s = 100};
    if (!w->arena) return STATUS_NO_MEMORY;
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;
    Status status = catalog_open(&w->catalog, catalog, 0.05);
    if (status == STATUS_OK) status = entity_table_create(&w->table, &config, w->catalog);
    return status == STATUS_OK ? local_frame_at(&w->frame, &origin) : status;
}

static void world_close(World *w)
{
    entity_table_destroy(w->table);
    catalog_close(w->catalog);
    arena_destroy(w->arena);
}

/* Makes a good report of a tank with smoke, fire and dust, a helicopter, or a missile with its motor burning, on the
 * equator. */
static size_t good_state(uint8_t *out, size_t room, const World *w, int kind, int algorithm)
{
    static const DisEntityType types[3] = {{1, 1, 222, 1, 1, 1, 0}, {1, 2, 225, 20, 1, 0, 0}, {2, 2, 225, 1, 1, 3, 0}};
    DisEntityState            *s = calloc(1, sizeof *s);
    if (!s) return 0;
    *s = (DisEntityState){.header = {.version = 7, .exercise = 1, .type = dis_pdu_entity_state, .family = 1},
                          .id = {1, 1, w->entity},
                          .force = 1,
                          .type = types[kind],
                          .dead_reckoning = (uint8_t)algorithm,
                          .p_ecef = {6378137, 10, 20},
                          .velocity_mps = {5, -3, 8},
                          .acceleration_mps2 = {1, 2, 3},
                          .angular_rate_rps = {0.1f, -0.2f, 0.3f},
                          .psi_rad = 0.3f,
                          .theta_rad = -1.5f,
                          .phi_rad = 0.2f,
                          .appearance = UINT32_C(0x004081F8),
                          .variable_count = 3};
    static const uint32_t parameter[3] = {4096 + 11, 4096 + 12, 4416 + 13};
    for (int r = 0; r < 3; r++) s->variable[r] = (DisVariableParameter){.parameter = parameter[r], .value = 0.2f};
    const size_t octets = dis_encode_entity_state(out, room, s);
    free(s);
    return octets;
}

static size_t good_other(uint8_t *out, size_t room, const World *w, uint8_t type)
{
    const DisHeader     header = {.version = 7, .exercise = 1, .type = type, .family = 2};
    const DisEntityId   id = {1, 1, w->entity};
    const DisDescriptor shell = {.type = {2, 2, 225, 2, 1, 0, 0}, .warhead = 1000, .quantity = 1, .rate = 1};
    if (type == dis_pdu_fire) {
        const DisFire fire = {.header = header,
                              .firing = id,
                              .event = {1, 1, w->entity},
                              .p_ecef = {6378137, 10, 20},
                              .descriptor = shell,
                              .velocity_mps = {500, 0, 0},
                              .range_m = 2000};
        return dis_encode_fire(out, room, &fire);
    }
    if (type == dis_pdu_detonation) {
        static DisDetonation burst; /* static, since it is large; all fields but those set below stay zero */
        burst.header = header, burst.firing = id, burst.event = (DisEventId){1, 1, w->entity}, burst.descriptor = shell;
        burst.p_ecef[0] = 6378137, burst.velocity_mps[1] = 500, burst.result = (uint8_t)(1 + w->entity % 5);
        return dis_encode_detonation(out, room, &burst);
    }
    static DisEntityStateUpdate update;
    update.header = header, update.id = id, update.appearance = UINT32_C(0x004081F8), update.variable_count = 3;
    update.p_ecef[0] = 6378137, update.velocity_mps[1] = 5;
    static const uint32_t parameter[3] = {4096 + 11, 4096 + 12, 4416 + 13};
    for (int r = 0; r < 3; r++) update.variable[r] = (DisVariableParameter){.parameter = parameter[r], .value = 0.2f};
    return dis_encode_entity_state_update(out, room, &update);
}

static void tell(World *w, const uint8_t *pdu, size_t octets)
{
    static DisPdu  decoded;
    DisHeader      header;
    const uint8_t *found, *at = pdu;
    while (dis_next_pdu(&header, &found, &at, pdu + octets, &w->counters))
        if (dis_decode(&decoded, found, header.length) == STATUS_OK)
            entity_table_pdu(w->table, &decoded, w->t_s, &w->counters);
}

static uint64_t all_refusals(const World *w)
{
    const EntityCounters *e = entity_table_counters(w->table);
    uint64_t sum = e->motion_refused + e->unknown_articulation + entity_table_effect_counters(w->table)->refused;
    for (int d = 0; d < DIS_DROP_COUNT; d++) sum += w->counters.dropped[d];
    return sum;
}

static bool finite_all(const double *v, int count)
{
    for (int i = 0; i < count; i++)
        if (!isfinite(v[i])) return false;
    return true;
}

static bool is_rotation(const double r[9])
{
    double crooked = 0;
    stress_off_rotation(&crooked, r);
    return crooked <= 1e-12;
}

static bool entity_is_sound(const SnapshotEntity *e)
{
    bool sound = v3_is_finite(e->p_ecef) && v3_is_finite(e->v_ecef_mps) && v3_is_finite(e->w_body_rps) &&
                 is_rotation(e->r_ecef_from_body) && isfinite(e->age_s) && isfinite(e->position_error_m) &&
                 v3_length(e->p_ecef) >= 9e4 && v3_length(e->p_ecef) <= 1.1e8;
    const EntityDrives *d = &e->drives;
    const float         share[6] = {d->engine, d->flying, d->alive, d->burning, d->motor, d->flare};
    for (int h = 0; h < 6; h++) sound = sound && share[h] >= 0 && share[h] <= 1;
    sound = sound && isfinite(d->since_s) && d->speed_mps >= 0 && d->fired_kg[0] >= 0 && d->fired_kg[1] >= 0 &&
            isfinite(d->fired_kg[1]);
    return sound;
}

static bool puff_is_sound(const World *w, const EffectTable *table, const EffectPuff *p)
{
    static const double far_m = 1.1e8;
    const Weather       weather = weather_default();
    EffectVolume        v;
    const double        numbers[] = {p->age_s, p->throw_s, p->scale, p->mass_kg, p->along_m, p->above_m};
    if (!finite_all(numbers, sizeof numbers / sizeof *numbers) || !v3_is_finite(p->throw_mps) ||
        !(v3_length(p->p_ecef) <= far_m))
        return false;
    if (!(fabs(v3_length(p->up_ecef) - 1) <= 1e-12 && fabs(v3_length(p->axis_ecef) - 1) <= 1e-12)) return false;
    if (!effect_volume(&v, table, p, &weather, &w->frame)) return true;
    const double more[] = {v.along_m, v.across_m, v.temp_k};
    return finite_all(more, 3) && v3_is_finite(v.p_enu) && v3_is_finite(v.axis_enu) &&
           finite_all(v.extinction_per_m, effect_band_count) && v.across_m > 0 && v.temp_k > 0;
}

static bool nodes_are_sound(World *w, const Snapshot *s, int index)
{
    if (s->entity[index].model < 0) return true;
    const Model *model = catalog_model(w->catalog, s->entity[index].model);
    NodePose    *pose = arena_alloc(w->arena, (size_t)model->node_count, sizeof *pose);
    double      *value = arena_alloc(w->arena, (size_t)model->node_count, sizeof *value);
    bool         sound = pose && value;
    if (!sound) return false;
    snapshot_pose(pose, value, s, index, model);
    for (int n = 0; n < model->node_count; n++)
        sound = sound && v3_is_finite(pose[n].p_body) && v3_length(pose[n].p_body) < 1e3 &&
                is_rotation(pose[n].r_body_from_node);
    return sound;
}

static bool world_is_sound(World *w)
{
    static const double later_s[] = {0, 0.013, 3, 11.9, 131, 1e4};
    bool                sound = true;
    for (size_t k = 0; k < sizeof later_s / sizeof *later_s && sound; k++) {
        Snapshot s;
        arena_reset(w->arena);
        if (entity_table_snapshot(&s, w->table, w->t_s + later_s[k], w->arena) != STATUS_OK) return false;
        for (int e = 0; e < s.count; e++) sound = sound && entity_is_sound(&s.entity[e]);
        for (int e = 0; e < s.count && sound; e++) sound = nodes_are_sound(w, &s, e);
        for (int p = 0; p < s.puff_count; p++) sound = sound && puff_is_sound(w, s.effect_table, &s.puff[p]);
    }
    return sound;
}

static void poke(uint8_t *pdu, const Field *field, int value)
{
    if (!field->wide) {
        dis_store_u32(pdu + field->at, singles[value]);
        return;
    }
    uint64_t bits;
    memcpy(&bits, &doubles[value], sizeof bits);
    dis_store_u32(pdu + field->at, (uint32_t)(bits >> 32));
    dis_store_u32(pdu + field->at + 4, (uint32_t)bits);
}

/* Sets one field, or it and its two neighbours of the same kind, to one value; sends a good report before it and
 * another after it. */
static void stress_pdu(World *w, uint8_t type, const Field *field, int left, int value, int kind, int algorithm,
                       bool together)
{
    uint8_t      pdu[512];
    const size_t state_octets = good_state(pdu, sizeof pdu, w, kind, algorithm);
    const bool   of_entity = type == dis_pdu_entity_state || type == dis_pdu_entity_state_update;
    if (type != dis_pdu_entity_state || value % 2) tell(w, pdu, state_octets);
    w->t_s += 0.5;
    const uint64_t refused = all_refusals(w);
    const size_t   octets = type == dis_pdu_entity_state ? state_octets : good_other(pdu, sizeof pdu, w, type);
    for (int f = 0; f < (together ? 3 : 1) && f < left; f++)
        if (field[f].wide == field->wide) poke(pdu, &field[f], value);
    tell(w, pdu, octets);
    bool sound = world_is_sound(w);
    w->refused += all_refusals(w) > refused;
    if (of_entity && sound) { /* what follows the report must not remember it */
        w->t_s += 0.7;
        tell(w, pdu, good_state(pdu, sizeof pdu, w, kind, algorithm));
        sound = world_is_sound(w);
    }
    w->cases++;
    w->bad += !sound;
    DisRemoveEntity gone = {.receiving = {1, 1, w->entity}};
    entity_table_remove(w->table, &gone, w->t_s);
    w->entity = (uint16_t)(w->entity % 60000 + 1);
    w->t_s += 200; /* smoke and bursts have ended */
}

Status bench_stability_pdus(Bench *bench)
{
    static const struct {
        const char  *what;
        uint8_t      type;
        const Field *field;
        int          fields;
    } row[4] = {
        {"Entity State", dis_pdu_entity_state, state_fields, sizeof state_fields / sizeof *state_fields},
        {"Entity State Update", dis_pdu_entity_state_update, update_fields,
         sizeof update_fields / sizeof *update_fields},
        {"Fire", dis_pdu_fire, fire_fields, sizeof fire_fields / sizeof *fire_fields},
        {"Detonation", dis_pdu_detonation, detonation_fields, sizeof detonation_fields / sizeof *detonation_fields}};
    World  w;
    Status status = world_open(&w);
    for (int r = 0; r < 4 && status == STATUS_OK; r++) {
        char what[96];
        bench_progress(bench, row[r].what);
        w.cases = w.refused = w.bad = 0;
        w.entity = 1;
        for (int f = 0; f < row[r].fields; f++)
            for (int v = 0; v < (row[r].field[f].wide ? double_count : single_count); v++)
                for (int variant = 0; variant < (row[r].type == dis_pdu_entity_state ? 54 : 6); variant++) {
                    /* each number is tried with some of the variants, which differ from number to number */
                    if ((variant + 7 * v + 5 * f) % (bench_quick(bench) ? 54 : 5) != 0 &&
                        row[r].type == dis_pdu_entity_state)
                        continue;
                    if (bench_quick(bench) && (variant + 7 * v + 5 * f) % 6 != 0) continue;
                    stress_pdu(&w, row[r].type, row[r].field + f, row[r].fields - f, v, variant % 3,
                               1 + variant / 6 % 9, variant / 3 % 2);
                }
        if (!(w.refused > 0 && w.refused < w.cases))
            w.bad = INFINITY; /* some of these numbers are good, some are none */
        snprintf(what, sizeof what, "%s: each float at its extremes, not sound afterwards", row[r].what);
        bench_stress(bench, what, w.bad, 0, "inputs", "refused and counted, or all finite");
    }
    if (status != STATUS_OK) log_error("bench: stability: the entity table: %s", status_name(status));
    world_close(&w);
    return status;
}
