/* tests/bench/entities/speed_table.c: the entity table under load: reports in, snapshots out. Its error is that of
 * places, against the motion of each algorithm integrated step by step. */
#include "tests/bench/suites.h"

#include "entities/motion/dead_reckoning.h"
#include "entities/table/entity_table.h"
#include "dis/pdu/decode.h"

#include <stdlib.h>

enum { most_octets = 256, what_size = 96 };

static const double report_s = 100, later_s = 3;

typedef struct Crowd {
    Catalog     *catalog;
    EntityTable *table;
    Arena       *arena;
    int          count;
    uint8_t (*pdu)[most_octets]; /* [count] */
    size_t         *octets;      /* [count] */
    double          t_s;         /* of the reports in the table */
    DisEntityState *state;
    DisCounters     counters;
    Snapshot        snapshot;
    Status          status;
} Crowd;

static double dice(uint32_t stream, int index, double low, double high)
{
    return low + (high - low) * random_uniform(1, stream, 0, (uint64_t)index);
}

/* Tanks, trucks, helicopters and ships: their senders report the base, as models have it. On a ball of the Earth's
 * size; everything within the limits of accepted values. */
static void make_report(DisEntityState *out, int k)
{
    static const DisEntityType types[4] = {
        {1, 1, 222, 1, 1, 1, 0}, {1, 1, 222, 7, 1, 0, 0}, {1, 2, 225, 20, 1, 0, 0}, {1, 3, 225, 1, 1, 0, 0}};
    const double lat = dice(1, k, -1.4, 1.4), lon = dice(2, k, -3, 3), r_m = 6378000 + dice(3, k, 0, 3000);
    *out = (DisEntityState){.header = {.version = 7, .exercise = 1, .type = dis_pdu_entity_state, .family = 1},
                            .id = {(uint16_t)(1 + k / 20000), 1, (uint16_t)(1 + k % 20000)},
                            .force = (uint8_t)(k % 3),
                            .type = types[k % 4],
                            .dead_reckoning = (uint8_t)(1 + k / 4 % 9),
                            .p_ecef = {r_m * cos(lat) * cos(lon), r_m * cos(lat) * sin(lon), r_m * sin(lat)},
                            .psi_rad = (float)dice(4, k, -3, 3),
                            .theta_rad = (float)dice(5, k, -1.5, 1.5),
                            .phi_rad = (float)dice(6, k, -3, 3),
                            .variable_count = 2,
                            .marking_set = 1};
    for (int c = 0; c < 3; c++) {
        out->velocity_mps[c] = (float)dice(7 + (uint32_t)c, k, -30, 30);
        out->acceleration_mps2[c] = (float)dice(10 + (uint32_t)c, k, -3, 3);
        out->angular_rate_rps[c] = (float)dice(13 + (uint32_t)c, k, -0.5, 0.5);
    }
    snprintf(out->marking, sizeof out->marking, "E%d", k);
    out->variable[0] = (DisVariableParameter){.parameter = 4096 + 11, .value = (float)dice(16, k, -3, 3)};
    out->variable[1] = (DisVariableParameter){.parameter = 4416 + 13, .value = (float)dice(17, k, -0.1, 0.3)};
}

static Status crowd_open(Crowd *c, int count)
{
    EntityTableConfig config = entity_table_default_config();
    char              catalog[512];
    *c = (Crowd){.count = count,
                 .t_s = report_s,
                 .pdu = calloc((size_t)count, sizeof *c->pdu),
                 .octets = calloc((size_t)count, sizeof *c->octets),
                 .state = calloc(1, sizeof *c->state),
                 .arena = arena_create()};
    if (!c->pdu || !c->octets || !c->state || !c->arena) return STATUS_NO_MEMORY;
    if (!etc_path(catalog, sizeof catalog, "catalog.csv")) return STATUS_BAD_VALUE;
    config.capacity = count;
    Status status = catalog_open(&c->catalog, catalog, 0.01);
    if (status == STATUS_OK) status = entity_table_create(&c->table, &config, c->catalog);
    for (int k = 0; k < count && status == STATUS_OK; k++) {
        make_report(c->state, k);
        c->octets[k] = dis_encode_entity_state(c->pdu[k], most_octets, c->state);
        if (c->octets[k] == 0) status = STATUS_BAD_VALUE;
    }
    return status;
}

static void crowd_close(Crowd *c)
{
    entity_table_destroy(c->table);
    catalog_close(c->catalog);
    arena_destroy(c->arena);
    free(c->pdu);
    free(c->octets);
    free(c->state);
}

/* ---- the works -------------------------------------------------------------------------------- */

/* Lets all entities report once more, as octets. */
static void update_all(void *user)
{
    Crowd         *c = user;
    DisHeader      header;
    const uint8_t *pdu;
    static DisPdu  decoded;
    c->t_s += 0.01;
    for (int k = 0; k < c->count; k++)
        for (const uint8_t *at = c->pdu[k]; dis_next_pdu(&header, &pdu, &at, c->pdu[k] + c->octets[k], &c->counters);)
            if (dis_decode(&decoded, pdu, header.length) == STATUS_OK)
                entity_table_pdu(c->table, &decoded, c->t_s, &c->counters);
    bench_keep(c->table);
}

/* Does the same with one decoded report under the id of each entity. */
static void update_decoded(void *user)
{
    Crowd *c = user;
    c->t_s += 0.01;
    for (int k = 0; k < c->count; k++) {
        c->state->id = (DisEntityId){(uint16_t)(1 + k / 20000), 1, (uint16_t)(1 + k % 20000)};
        const Status status = entity_table_entity_state(c->table, c->state, c->t_s);
        if (status != STATUS_OK) c->status = status;
    }
    bench_keep(c->table);
}

static void snap(void *user)
{
    Crowd *c = user;
    arena_reset(c->arena);
    const Status status = entity_table_snapshot(&c->snapshot, c->table, c->t_s + later_s, c->arena);
    if (status != STATUS_OK) c->status = status;
    bench_keep(c->snapshot.entity);
}

/* ---- reference ------------------------------------------------------------------------------- */

/* R' = R [w] */
static void slope_of(double out[9], const double r[9], const double w[3])
{
    const double cross[9] = {0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0};
    m3_mul(out, r, cross);
}

/* Takes one step by Runge and Kutta's fourth order. */
static void step_attitude(double r[9], const double w[3], double h_s)
{
    double slope[4][9], at[9];
    slope_of(slope[0], r, w);
    for (int k = 1; k < 4; k++) {
        for (int i = 0; i < 9; i++) at[i] = r[i] + (k < 3 ? 0.5 : 1) * h_s * slope[k - 1][i];
        slope_of(slope[k], at, w);
    }
    for (int i = 0; i < 9; i++) r[i] += h_s / 6 * (slope[0][i] + 2 * slope[1][i] + 2 * slope[2][i] + slope[3][i]);
}

/* Integrates p' = v + a t in the world's axes, or R (v + a t) in those of a body that turns, by Simpson's rule over
 * each step. */
static void integrate(double p_ecef[3], const DisEntityState *s, double t_s)
{
    enum { steps = 3000 };
    static const double share[3] = {1, 4, 1};
    const int           a = s->dead_reckoning;
    const bool          body = a >= 6, accelerates = a == 4 || a == 5 || a >= 8;
    const double h_s = t_s / steps, w[3] = {s->angular_rate_rps[0], s->angular_rate_rps[1], s->angular_rate_rps[2]};
    double       r[9], way[3] = {0};
    r_ecef_from_body_euler(r, s->psi_rad, s->theta_rad, s->phi_rad);
    for (int k = 0; k < steps && a > 1; k++)
        for (int node = 0; node < 3; node++) { /* beginning, middle and end of the step */
            double v[3], v_ecef[3];
            if (node > 0) step_attitude(r, w, 0.5 * h_s);
            for (int j = 0; j < 3; j++)
                v[j] = (double)s->velocity_mps[j] +
                       (accelerates ? (double)s->acceleration_mps2[j] * (k + 0.5 * node) * h_s : 0);
            m3_mul_v3(v_ecef, r, v);
            v3_add_scaled(way, way, share[node] * h_s / 6, body ? v_ecef : v);
        }
    v3_add(p_ecef, s->p_ecef, way);
}

/* Finds the largest position error in a snapshot, m, over a sample of the entities. */
static double worst_place_m(Crowd *c)
{
    double worst = 0;
    update_all(c);
    snap(c);
    if (c->status != STATUS_OK || c->snapshot.count != c->count) return INFINITY;
    for (int n = 0; n < 90; n++) {
        const int k = (int)((int64_t)n * (c->count - 1) / 89);
        double    p_ecef[3], off[3];
        make_report(c->state, k);
        integrate(p_ecef, c->state, later_s);
        const int index = snapshot_find(&c->snapshot, c->state->id);
        if (index < 0) return INFINITY;
        v3_sub(off, c->snapshot.entity[index].p_ecef, p_ecef);
        if (!(v3_length(off) <= worst)) worst = v3_length(off); /* NaN shows */
    }
    return worst;
}

/* ---- the rows --------------------------------------------------------------------------------- */

static Status time_crowd(Bench *bench, int count)
{
    Crowd     c;
    BenchTime time[3];
    char      what[what_size];
    Status    status = crowd_open(&c, count);
    if (status == STATUS_OK) {
        const BenchWork          work[3] = {{update_all, &c, count}, {update_decoded, &c, count}, {snap, &c, count}};
        static const char *const name[3] = {"report: walk, decode, check, update", "report: update alone",
                                            "snapshot, an entity"};
        bench_time(time, bench, work, 3);
        const double worst_m = worst_place_m(&c);
        for (int k = 0; k < 3; k++) {
            snprintf(what, sizeof what, "table of %d: %s", count, name[k]);
            BenchRow row = bench_row_of(what, &time[k], k == 2 ? "M entities/s" : "M PDUs/s", 1e6);
            row.error = worst_m;
            row.error_limit = 4e-9; /* an ulp of a place on the Earth is 0.9 nm an axis */
            row.error_unit = "m";
            row.against = "places 3 s later, motion integrated in steps of 1 ms";
            if (k == 1) {
                row.ratio = bench_ratio(&time[1], &time[0]);
                row.to = "whole";
            }
            bench_add(bench, &row);
        }
        snprintf(what, sizeof what, "table of %d: the whole snapshot", count);
        BenchRow row = bench_row(what);
        row.median = count * time[2].median_s;
        row.best = count * time[2].best_s;
        row.unit = "s";
        bench_add(bench, &row);
        status = c.status;
    }
    if (status != STATUS_OK) log_error("bench: dis: table of %d: %s", count, status_name(status));
    crowd_close(&c);
    return status;
}

Status bench_speed_table(Bench *bench)
{
    Status status = time_crowd(bench, bench_quick(bench) ? 1000 : 10000);
    if (status == STATUS_OK) status = time_crowd(bench, bench_quick(bench) ? 4000 : 100000);
    return status;
}
