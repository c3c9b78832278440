/* tests/bench/render/precision_heat.c: the ground's heat: steps in time, elements in depth, slopes, cells of shade, and
 * shade of past hours as a sum against ground that was shaded. */
#include "tests/scenes/heat_day.h"
#include "tests/bench/suites.h"

#include "render/heat/heat.h"
#include "tests/bench/bench.h"
#include "terrain/ground/landscape.h"

#include <stdlib.h>

static const double day_s = 86400, look_s = 600, lit_all_day_h[2] = {0, 0};
enum { day_looks = 144 };

static HeatConfig config_of(const HeatDay *day, double step_s, int facets, double begin_h)
{
    HeatConfig c = heat_default_config();
    c.step_s = step_s, c.facets = facets, c.unix_s = heat_day_unix_s + 3600 * begin_h, c.weather = heat_day,
    c.user = day;
    return c;
}

/* ---- a day of level ground --------------------------------------------------------------------- */

/* Temperatures of every kind of ground, after a day of spin-up, at even times; each is interpolated between two times
 * of the heat's own grid. */
typedef struct DaySet {
    const GroundKinds *kinds;
    GroundGrid         grid;
    double             step_s;
    double             temp_k[ground_kinds][day_looks];
    int                nodes; /* of bare soil */
} DaySet;

static void run_day(void *user)
{
    DaySet              *s = user;
    const HeatDay        day = heat_day_default();
    const GroundExposure level = {{0, 0, 1}, 1, 1, 0};
    for (int k = 1; k < ground_kinds; k++) {
        Column        layers;
        ColumnFactors factors;
        GroundColumn  column;
        GroundWeather w[2];
        double        last_k = 0, at_s = -day_s;
        if (ground_layers(&layers, &s->kinds->kind[k], &s->grid) != STATUS_OK) {
            for (int i = 0; i < day_looks; i++) s->temp_k[k][i] = NAN;
            continue;
        }
        if (k == SURFACE_BARE_SOIL) s->nodes = layers.nodes;
        column_factors(&factors, &layers, s->step_s);
        ground_column_start(&column, &s->kinds->kind[k], &layers, day.air_k + 3);
        column.factors = &factors;
        heat_day(&w[0], heat_day_unix_s + at_s, &day);
        for (int i = 0; at_s < day_s - 1e-3;) {
            heat_day(&w[1], heat_day_unix_s + at_s + s->step_s, &day);
            last_k = column.state.temp_k[0];
            ground_column_step(&column, s->grid.tolerance_k, &w[0], &w[1], &level, s->step_s);
            at_s += s->step_s;
            w[0] = w[1];
            for (; i < day_looks && i * look_s <= at_s + 1e-3; i++)
                s->temp_k[k][i] =
                    column.state.temp_k[0] + (at_s - i * look_s) / s->step_s * (last_k - column.state.temp_k[0]);
        }
    }
    bench_keep(s->temp_k);
}

/* Finds the largest and the rms difference, over kinds and times. */
static void compare_days(BenchSetting *point, const DaySet *a, const DaySet *fine)
{
    double sum = 0;
    for (int k = 1; k < ground_kinds; k++)
        for (int i = 0; i < day_looks; i++) {
            const double off_k = a->temp_k[k][i] - fine->temp_k[k][i];
            bench_worst(&point->error, fabs(off_k));
            sum += off_k * off_k;
        }
    point->also = sqrt(sum / ((ground_kinds - 1) * day_looks));
}

static void tunable_step(Bench *bench, const GroundKinds *kinds)
{
    enum { settings = 6 };
    static const double      step_s[settings] = {60, 300, 600, 900, 1800, 3600};
    static const char *const name[settings] = {"60 s", "300 s", "600 s", "900 s", "1800 s", "3600 s"};
    static DaySet            set[settings], fine;
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    fine = (DaySet){.kinds = kinds, .grid = ground_grid_default, .step_s = 30};
    fine.grid.tolerance_k = 1e-3;
    run_day(&fine);
    for (int k = 0; k < settings; k++) {
        set[k] = (DaySet){.kinds = kinds, .grid = ground_grid_default, .step_s = step_s[k]};
        run_day(&set[k]);
        work[k] = (BenchWork){run_day, &set[k], 2 * (ground_kinds - 1)};
        point[k] = (BenchSetting){
            .setting = name[k], .also_is = "rms, K", .is_default = step_s[k] == heat_default_config().step_s};
        compare_days(&point[k], &set[k], &fine);
    }
    bench_tunable(bench,
                  &(BenchTunable){"steps of the ground's heat", "heat.step_s", "a day of one column", "K",
                                  "largest, of all kinds over a day, steps of 30 s to 0.001 K", 0.1},
                  work, point, settings);
}

static void tunable_elements(Bench *bench, const GroundKinds *kinds)
{
    enum { settings = 7 };
    static const struct {
        double first_m, growth;
    } grid[settings] = {{0.04, 1.8}, {0.02, 1.6}, {0.01, 1.5}, {0.005, 1.4}, {0.003, 1.3}, {0.002, 1.2}, {0.001, 1.15}};
    static char   name[settings][64];
    static DaySet set[settings], fine;
    BenchWork     work[settings];
    BenchSetting  point[settings] = {0};
    fine = (DaySet){.kinds = kinds, .grid = ground_grid_default, .step_s = 600};
    fine.grid.first_m = 0.0007, fine.grid.growth = 1.15;
    run_day(&fine);
    for (int k = 0; k < settings; k++) {
        set[k] = (DaySet){.kinds = kinds, .grid = ground_grid_default, .step_s = 600};
        set[k].grid.first_m = grid[k].first_m, set[k].grid.growth = grid[k].growth;
        run_day(&set[k]);
        snprintf(name[k], sizeof name[k], "%g mm, growing by %g: %d of soil", 1e3 * grid[k].first_m, grid[k].growth,
                 set[k].nodes - 1);
        work[k] = (BenchWork){run_day, &set[k], 2 * (ground_kinds - 1)};
        point[k] = (BenchSetting){
            .setting = name[k], .also_is = "rms, K", .is_default = grid[k].first_m == ground_grid_default.first_m};
        compare_days(&point[k], &set[k], &fine);
    }
    bench_tunable(bench,
                  &(BenchTunable){"elements of the ground's heat", "render/heat/ground_column_private.h",
                                  "a day of one column", "K", "largest, of all kinds over a day, elements from 0.7 mm",
                                  0.1},
                  work, point, settings);
}

/* ---- slopes ------------------------------------------------------------------------------------- */

enum { slopes = 120, slope_times = 3, slope_kinds = 4 };
static const int shown_kinds[slope_kinds] = {SURFACE_GRASS, SURFACE_BARE_SOIL, SURFACE_ROAD, SURFACE_SAND};

static double slope_time_h(int t) { return 9 + 4 * t; }

typedef struct FacetSet {
    Heat  *heat;
    Arena *arena;
    double unix_s;
} FacetSet;

/* Goes one step of the grid further. */
static void step_heat(void *user)
{
    FacetSet *s = user;
    HeatNow  *now;
    arena_reset(s->arena);
    s->unix_s += 1800;
    if (heat_now(&now, s->heat, s->unix_s, s->arena) == STATUS_OK) bench_keep(now);
}

/* Makes slopes of up to 45 degrees, then walls. */
static void slope_normal(double n_enu[3], int i)
{
    const double up = i < slopes / 2 ? 0.7071 + 0.2929 * random_uniform(19, 0, 0, (uint64_t)i)
                                     : 0.7071 * random_uniform(19, 0, 0, (uint64_t)i);
    const double turn = 2 * pi_rad * random_uniform(19, 1, 0, (uint64_t)i);
    n_enu[0] = sqrt(1 - up * up) * cos(turn), n_enu[1] = sqrt(1 - up * up) * sin(turn), n_enu[2] = up;
}

static Status slopes_by_themselves(double temp_k[slope_kinds][slopes][slope_times], const GroundKinds *kinds,
                                   const HeatConfig *config)
{
    static HeatPiece piece;
    for (int k = 0; k < slope_kinds; k++)
        for (int i = 0; i < slopes; i++) {
            double n_enu[3];
            slope_normal(n_enu, i);
            const Status status = heat_piece_begin(&piece, &kinds->kind[shown_kinds[k]], config, n_enu, lit_all_day_h);
            if (status != STATUS_OK) return status;
            for (int t = 0; t < slope_times; t++)
                temp_k[k][i][t] = heat_piece_at(&piece, heat_day_unix_s + 3600 * slope_time_h(t));
        }
    return STATUS_OK;
}

static Status tunable_facets(Bench *bench, const GroundKinds *kinds, Pool *pool)
{
    enum { settings = 5 };
    static const int         facets[settings] = {3, 5, 7, 9, 17};
    static const char *const name[settings] = {"3 x 3", "5 x 5", "7 x 7", "9 x 9", "17 x 17"};
    static double            own_k[slope_kinds][slopes][slope_times];
    FacetSet                 set[settings] = {{0}};
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    const HeatDay            day = heat_day_default();
    HeatConfig               c = config_of(&day, 1800, 3, 6);
    const int                count = bench_quick(bench) ? settings - 1 : settings;
    Status                   status = STATUS_OK;
    c.pool = pool, c.spin_up_s = 12 * 3600;
    bench_progress(bench, "slopes of the ground's heat");
    status = slopes_by_themselves(own_k, kinds, &c);
    for (int f = 0; f < count && status == STATUS_OK; f++) {
        set[f].arena = arena_create();
        c.facets = facets[f];
        status = set[f].arena ? heat_create(&set[f].heat, kinds, &c, NULL, 0) : STATUS_NO_MEMORY;
        for (int t = 0; t < slope_times && status == STATUS_OK; t++) {
            HeatNow *now;
            set[f].unix_s = heat_day_unix_s + 3600 * slope_time_h(t);
            arena_reset(set[f].arena);
            status = heat_now(&now, set[f].heat, set[f].unix_s, set[f].arena);
            for (int k = 0; k < slope_kinds && status == STATUS_OK; k++)
                for (int i = 0; i < slopes; i++) {
                    double n_enu[3];
                    slope_normal(n_enu, i);
                    const double off_k = heat_ground_k(now, shown_kinds[k], n_enu, 0, 1, 1) - own_k[k][i][t];
                    *(i < slopes / 2 ? &point[f].error : &point[f].also) +=
                        off_k * off_k / (0.5 * slopes * slope_times * slope_kinds);
                }
        }
        point[f].error = sqrt(point[f].error), point[f].also = sqrt(point[f].also);
        work[f] = (BenchWork){step_heat, &set[f], 1};
        point[f].setting = name[f], point[f].also_is = "rms, steeper, K",
        point[f].is_default = facets[f] == heat_default_config().facets;
        point[f].bytes = (double)heat_bytes(set[f].heat);
    }
    if (status == STATUS_OK)
        bench_tunable(bench,
                      &(BenchTunable){"slopes of the ground's heat", "heat.facets", "a step of all kinds", "K",
                                      "rms, slopes up to 45 degrees run by themselves", 1.2},
                      work, point, count);
    for (int f = 0; f < count; f++) {
        heat_destroy(set[f].heat);
        arena_destroy(set[f].arena);
    }
    return status;
}

/* ---- cells of shade ----------------------------------------------------------------------------- */

typedef struct ShadeSet {
    const Elevation *elevation;
    float            d_enu[3][shadow_most_slots];
    int              slots;
    double           cell_m;
    ShadowMap       *map;
    Pool            *pool;
    Status           status;
} ShadeSet;

/* Makes groves and hedges, 12 m high, with clearings. */
static void groves(ShadowStand *out, const void *user, double x_m, double y_m)
{
    (void)user;
    const double wave = sin(x_m / 23) + sin(y_m / 31) + sin((x_m + 2 * y_m) / 57),
                 hedge = fabs(fmod(fabs(x_m + 0.3 * y_m), 180) - 90);
    const bool grove = wave > 1.3, row = hedge < 4;
    *out = grove ? (ShadowStand){4, 2, 14, 0.3f} : row ? (ShadowStand){5, 0, 5, 0.5f} : (ShadowStand){0, 0, 0, 1};
}

static void cast(void *user)
{
    ShadeSet *s = user;
    heat_shadow_destroy(s->map);
    s->map = NULL;
    s->status = heat_shadow_create(
        &s->map,
        &(ShadowOf){
            .elevation = s->elevation, .cell_m = s->cell_m, .slots = s->slots, .d_enu = s->d_enu, .plants = groves},
        s->pool);
    bench_keep(s->map);
}

/* Computes the rms difference, and the share of places that are off by more than 1 K. */
static void compare_shade(BenchSetting *point, const ShadeSet *a, const ShadeSet *fine, const HeatNow *now,
                          double half_m)
{
    enum { places = 20000 };
    const HeatScene scene[2] = {{.now = now, .shadow = a->map}, {.now = now, .shadow = fine->map}};
    double          sum = 0;
    for (int i = 0; i < places; i++) {
        const double p_enu[3] = {half_m * (2 * random_uniform(23, 0, 0, (uint64_t)i) - 1),
                                 half_m * (2 * random_uniform(23, 1, 0, (uint64_t)i) - 1), 0};
        double       lifted_k, temp_k[2], n_enu[3] = {0, 0, 1};
        for (int k = 0; k < 2; k++)
            temp_k[k] = heat_scene_ground_k(&lifted_k, &scene[k], SURFACE_GRASS, p_enu, n_enu, 1);
        sum += (temp_k[0] - temp_k[1]) * (temp_k[0] - temp_k[1]);
        point->also += (fabs(temp_k[0] - temp_k[1]) > 1) * 100.0 / places;
    }
    point->error = sqrt(sum / places);
}

static Status tunable_shade(Bench *bench, const GroundKinds *kinds, Pool *pool)
{
    enum { settings = 5 };
    static const double      cell_m[settings] = {4, 8, 16, 32, 64};
    static const char *const name[settings] = {"4 m", "8 m", "16 m", "32 m", "64 m"};
    static ShadeSet          set[settings], fine;
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    const Geodetic           origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    const HeatDay            day = heat_day_default();
    const double             wide_m = 1000;
    HeatConfig               c = config_of(&day, 1800, 3, 15);
    LocalFrame               frame;
    Landscape                landscape = {0};
    Heat                    *heat = NULL;
    HeatNow                 *now = NULL;
    Arena                   *arena = arena_create();
    double                   times_s[2];
    bench_progress(bench, "cells of shade");
    Status status = arena ? local_frame_at(&frame, &origin) : STATUS_NO_MEMORY;
    c.pool = pool;
    if (status == STATUS_OK) status = landscape_quick(&landscape, times_s, &frame, wide_m, wide_m, pool);
    if (status == STATUS_OK) status = heat_create(&heat, kinds, &c, NULL, 0);
    if (status == STATUS_OK) status = heat_now(&now, heat, c.unix_s, arena);
    if (status == STATUS_OK) {
        fine = (ShadeSet){.elevation = &landscape.elevation, .cell_m = 2, .pool = pool};
        fine.slots = heat_slots(fine.d_enu, heat);
        cast(&fine);
        status = fine.status;
    }
    for (int k = 0; k < settings && status == STATUS_OK; k++) {
        set[k] = fine;
        set[k].map = NULL, set[k].cell_m = cell_m[k];
        cast(&set[k]);
        status = set[k].status;
        if (status != STATUS_OK) break;
        compare_shade(&point[k], &set[k], &fine, now, 0.48 * wide_m);
        point[k].setting = name[k], point[k].also_is = "of the places off by over 1 K, %",
        point[k].is_default = cell_m[k] == 16;
        point[k].bytes = (double)heat_shadow_bytes(set[k].map);
        work[k] = (BenchWork){cast, &set[k], 1};
    }
    if (status == STATUS_OK)
        bench_tunable(bench,
                      &(BenchTunable){"cells of past shade", "heat.shadow_m", "a map of hills and groves", "K",
                                      "rms of grass at 15 h, cells of 2 m", 2.4},
                      work, point, settings);
    for (int k = 0; k < settings; k++) {
        heat_shadow_destroy(set[k].map);
        set[k].map = NULL;
    }
    heat_shadow_destroy(fine.map);
    heat_destroy(heat);
    if (landscape.elevation.level_count) landscape_destroy(&landscape);
    arena_destroy(arena);
    return status;
}

/* ---- shade of past hours ------------------------------------------------------------------------- */

enum { shade_windows = 3, shade_looks = 12 };
static const struct {
    const char *name;
    double      from_to_h[2];
} windows[shade_windows] = {{"morning", {6, 10}}, {"noon", {10, 14}}, {"afternoon", {14, 18}}};

/* Slots of Heat are half hours of the day with the sun up, in order. */
static void shade_slots(uint8_t shadow[heat_day_slots], const HeatDay *day, const double from_to_h[2])
{
    int slot = 0;
    memset(shadow, 0, heat_day_slots);
    for (int i = 0; i < heat_day_slots; i++) {
        GroundWeather w;
        const double  hour = 0.5 * (i + 0.5);
        heat_day(&w, heat_day_unix_s + 3600 * hour, day);
        if (!(w.sun_d_enu[2] > 0)) continue;
        shadow[slot++] = hour > from_to_h[0] && hour < from_to_h[1] ? 255 : 0;
    }
}

static Status shade_rows(Bench *bench, const GroundKinds *kinds, Pool *pool)
{
    /* limits while in shadow and afterwards; measured, the worst of the three: 0.94, 0.22; 4.6, 1.8; 3.9, 1.7; 5.1, 1.8
     */
    static const double limit_k[slope_kinds][2] = {{1.2, 0.4}, {5.5, 2.2}, {4.8, 2.2}, {6.2, 2.2}};
    static HeatPiece    piece[slope_kinds][shade_windows];
    const HeatDay       day = heat_day_default();
    HeatConfig          c = config_of(&day, 600, 3, 8);
    const double        level[3] = {0, 0, 1};
    double worst_k[slope_kinds][shade_windows][2] = {{{0}}}, lowered_k[slope_kinds][shade_windows][2] = {{{0}}},
           worst_bits = 0;
    Heat  *heat = NULL;
    Arena *arena = arena_create();
    bench_progress(bench, "shade of past hours");
    c.pool = pool;
    Status status = arena ? heat_create(&heat, kinds, &c, NULL, 0) : STATUS_NO_MEMORY;
    for (int k = 0; k < slope_kinds; k++)
        for (int w = 0; w < shade_windows && status == STATUS_OK; w++)
            status = heat_piece_begin(&piece[k][w], &kinds->kind[shown_kinds[k]], &c, level, windows[w].from_to_h);
    for (int t = 0; t < shade_looks && status == STATUS_OK; t++) { /* 9 .. 20 h */
        const double hour = 9 + t, unix_s = heat_day_unix_s + 3600 * hour;
        HeatNow     *now;
        arena_reset(arena);
        status = heat_now(&now, heat, unix_s, arena);
        for (int k = 0; k < slope_kinds && status == STATUS_OK; k++)
            for (int w = 0; w < shade_windows; w++) {
                uint8_t shadow[heat_day_slots];
                shade_slots(shadow, &day, windows[w].from_to_h);
                const double taken = heat_taken(now, shown_kinds[k], level, shadow),
                             want_k = heat_piece_at(&piece[k][w], unix_s);
                const double lit_k = piece[k][w].level.state.temp_k[0];
                if (hour <= windows[w].from_to_h[0]) continue;
                const bool after = hour > windows[w].from_to_h[1];
                bench_worst(&worst_k[k][w][after],
                            fabs(heat_ground_k(now, shown_kinds[k], level, taken, 1, 1) - want_k));
                bench_worst(&lowered_k[k][w][after], lit_k - want_k);
                bench_worst(&worst_bits, fabs(heat_ground_k(now, shown_kinds[k], level, 0, 1, 1) - lit_k));
            }
    }
    for (int k = 0; k < slope_kinds && status == STATUS_OK; k++)
        for (int w = 0; w < 2 * shade_windows; w++) {
            char      what[96];
            const int window = w / 2, after = w % 2;
            snprintf(what, sizeof what, "shade of the %s, %s, %s: colder by", windows[window].name,
                     after ? "afterwards" : "in it", kinds->kind[shown_kinds[k]].name);
            BenchRow row = bench_row(what);
            row.median = lowered_k[k][window][after], row.unit = "K";
            row.error = worst_k[k][window][after], row.error_limit = limit_k[k][after], row.error_unit = "K";
            row.against = "largest, 9 to 20 h, ground shaded in those hours";
            bench_add(bench, &row);
        }
    if (status == STATUS_OK)
        bench_stress(bench, "shade of past hours: ground that was never shaded", worst_bits, 1e-4, "K",
                     "the same columns run by themselves");
    heat_destroy(heat);
    arena_destroy(arena);
    return status;
}

/* ---- the suite ---------------------------------------------------------------------------------- */

Status bench_precision_heat(Bench *bench)
{
    static GroundKinds kinds;
    Pool              *pool = NULL;
    Status             status = heat_day_kinds(&kinds);
    if (status == STATUS_OK) status = pool_create(&pool, bench_threads(bench));
    if (status == STATUS_OK) {
        tunable_step(bench, &kinds);
        tunable_elements(bench, &kinds);
        status = tunable_facets(bench, &kinds, pool);
    }
    if (status == STATUS_OK) status = tunable_shade(bench, &kinds, pool);
    if (status == STATUS_OK) status = shade_rows(bench, &kinds, pool);
    if (status != STATUS_OK) log_error("bench: precision: heat: %s", status_name(status));
    pool_destroy(pool);
    return status;
}
