/* tests/bench/render/speed_air.c: what the air of a frame costs before its first ray: by the eye's height, in rain, and
 * what the weather's own air is of it. */
#include "tests/bench/suites.h"

#include "tests/bench/bench.h"
#include "tests/bench/render/air_bench.h"

enum { settings = 5, all_bands = (1 << AIR_BAND_COUNT) - 1 };

typedef struct Making {
    AirSource source;
    Weather   weather;
    Sun       sun;
    double    eye_m;
    bool      weather_only;
    Arena    *arena;
    Status    status;
} Making;

static void make(void *user)
{
    static Air        air;
    Making           *m = user;
    const AirEye      eye = {.height_m = m->eye_m, .bands = all_bands};
    const Atmosphere *in;
    arena_reset(m->arena);
    const Status status = m->weather_only ? daylight_air(&in, m->source.atmosphere, &m->weather, all_bands, m->arena)
                                          : air_at(&air, &m->source, &m->weather, &m->sun, &eye, NULL, m->arena);
    if (status != STATUS_OK) m->status = status;
    bench_keep(&air);
}

/* Largest difference between the tables of an eye and its paths one by one, from 2 degrees above the horizontal down, %
 * of the brightest. */
static double error_of(Making *m)
{
    static Air      air;
    static AirPaths table[AIR_BAND_COUNT], direct[AIR_BAND_COUNT];
    static Hits     hits;
    static Rays     rays;
    const AirEye    eye = {.height_m = m->eye_m, .bands = all_bands};
    double          worst = 0;
    arena_reset(m->arena);
    m->status = air_at(&air, &m->source, &m->weather, &m->sun, &eye, NULL, m->arena);
    if (m->status != STATUS_OK) return INFINITY;
    hits.count = rays.count = 200;
    for (int i = 0; i < hits.count; i++) {
        const double turn = 0.031 * i, up = 0.035 - 0.006 * i;
        const double d[3] = {cos(up) * sin(turn), cos(up) * cos(turn), sin(up)};
        for (int c = 0; c < 3; c++) rays.d_enu[c][i] = d[c], rays.o_enu[c][i] = 0;
        hits.range_m[i] = INFINITY;
    }
    air_paths_of(table, &air, all_bands, &hits, &rays, NULL);
    air_paths_directly(direct, &air, all_bands, &hits, &rays, NULL, table);
    for (int b = 0; b < AIR_BAND_COUNT; b++) {
        double most = 0;
        for (int i = 0; i < hits.count; i++) most = fmax(most, (double)direct[b].added_w_m2_sr[i]);
        for (int i = 0; i < hits.count && most > 0; i++)
            bench_worst(&worst, 100 * fabs((double)(table[b].added_w_m2_sr[i] - direct[b].added_w_m2_sr[i])) / most);
    }
    return worst;
}

Status bench_speed_air(Bench *bench)
{
    static const struct {
        const char *what;
        double      eye_m, rain_mm_h;
        bool        weather_only;
    } setting[settings] = {{"air: tables of a frame, eye at 2 m", 2, 0, false},
                           {"air: the same in rain of 20 mm/h", 2, 20, false},
                           {"air: the same from 10 km", 10000, 0, false},
                           {"air: the same from 99 km", 99000, 0, false},
                           {"air: of which clear air by the weather", 2, 0, true}};
    AirBench  air;
    Making    making[settings];
    BenchWork work[settings];
    BenchTime time[settings];
    Status    status = air_bench_open(&air);
    for (int k = 0; k < settings && status == STATUS_OK; k++) {
        making[k] = (Making){.source = {air.atmosphere, air.planck[0], air.planck[1], 0, 0},
                             .weather = weather_default(),
                             .sun = {.azimuth_rad = 2.1,
                                     .elevation_rad = 0.7,
                                     .distance_au = 1,
                                     .d_enu = {cos(0.7) * sin(2.1), cos(0.7) * cos(2.1), sin(0.7)}},
                             .eye_m = setting[k].eye_m,
                             .weather_only = setting[k].weather_only,
                             .arena = air.arena};
        making[k].weather.rain_mm_h = setting[k].rain_mm_h;
        work[k] = (BenchWork){make, &making[k], 1};
    }
    bench_progress(bench, "air");
    if (status == STATUS_OK) bench_time(time, bench, work, settings);
    for (int k = 0; k < settings && status == STATUS_OK; k++) {
        BenchRow row = bench_row_of(setting[k].what, &time[k], NULL, 1);
        if (k > 0) row.ratio = bench_ratio(&time[k], &time[0]), row.to = "at 2 m";
        if (!setting[k].weather_only) {
            row.error = error_of(&making[k]);
            row.error_unit = "% of the brightest";
            row.against = "largest, each path by itself";
            row.error_limit = 15;
        }
        if (making[k].status != STATUS_OK) status = making[k].status;
        else bench_add(bench, &row);
    }
    if (status != STATUS_OK) log_error("bench: speed: air: %s", status_name(status));
    air_bench_close(&air);
    return status;
}
