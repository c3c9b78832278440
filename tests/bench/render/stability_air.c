/* tests/bench/render/stability_air.c: the air under stress: any weather, any eye and any ray give numbers that can be,
 * and nothing jumps where it becomes another law: at the horizontal, the tables' top, freezing, the edge of haze and
 * fog. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"
#include "tests/bench/render/air_bench.h"

enum { all_bands = (1 << AIR_BAND_COUNT) - 1, rays_each = 64 };

typedef struct Any {
    AirBench of;
    Status   status;
    Hits     hits;
    Rays     rays;
    AirPaths out[AIR_BAND_COUNT];
} Any;

static void look(Any *a, const Weather *weather, double sun_rad, double eye_m)
{
    static Air      air;
    const AirSource source = {a->of.atmosphere, a->of.planck[0], a->of.planck[1], 0, 0};
    const AirEye    eye = {.height_m = eye_m, .bands = all_bands};
    const Sun       sun = {.elevation_rad = sun_rad, .distance_au = 1, .d_enu = {0, cos(sun_rad), sin(sun_rad)}};
    arena_reset(a->of.arena);
    a->status = air_at(&air, &source, weather, &sun, &eye, NULL, a->of.arena);
    if (a->status == STATUS_OK) air_paths_of(a->out, &air, all_bands, &a->hits, &a->rays, NULL);
}

static void aim(Any *a, int i, double azimuth_rad, double up_rad, double range_m)
{
    const double d[3] = {cos(up_rad) * sin(azimuth_rad), cos(up_rad) * cos(azimuth_rad), sin(up_rad)};
    for (int c = 0; c < 3; c++) a->rays.d_enu[c][i] = d[c], a->rays.o_enu[c][i] = 0;
    a->hits.range_m[i] = range_m;
}

/* 210 to 330 K, dry to saturated, 100 m to 300 km, to 200 mm/h, every kind of fog, from 400 m below 0 to 1000 km. */
static double any_weather(void *user, bool quick)
{
    Any   *a = user;
    Dice   dice = {.stream = 41};
    double wrong = 0;
    for (int n = quick ? 10 : 200; n > 0; n--) {
        Weather weather = weather_default();
        weather.air_temp_k = stress_uniform(&dice, 210, 330);
        weather.humidity = n % 5 == 0 ? n % 2 : stress_uniform(&dice, 0, 1);
        weather.visibility_m = stress_log_uniform(&dice, 100, 3e5);
        weather.rain_mm_h = n % 3 == 0 ? stress_log_uniform(&dice, 1e-9, 200) : 0;
        weather.fog = (WeatherFog)(n % 4);
        const double eye_m = n % 7 == 0 ? 0 : n % 7 == 1 ? 20000 : stress_log_uniform(&dice, 1, 1e6) - 400;
        a->hits.count = a->rays.count = rays_each;
        for (int i = 0; i < rays_each; i++)
            aim(a, i, stress_uniform(&dice, 0, 6.3), i == 0 ? 0 : asin(stress_uniform(&dice, -1, 1)),
                i % 3 == 0 ? INFINITY : stress_log_uniform(&dice, 1e-3, 1e6));
        look(a, &weather, stress_uniform(&dice, -0.3, 1.57), eye_m);
        if (a->status != STATUS_OK) return INFINITY;
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            for (int i = 0; i < rays_each; i++) {
                const float tau = a->out[b].transmittance[i], added = a->out[b].added_w_m2_sr[i];
                wrong += !(tau >= 0 && tau <= 1) + !(added >= 0 && isfinite(added));
            }
    }
    return wrong;
}

/* What a level, a falling and a sky ray see, before and after a step of 1e-9 of one quantity; % of what was. */
static double step_of(Any *a, const Weather pair[2], const double eye_m[2], const double up_rad[2])
{
    static float before[AIR_BAND_COUNT][2][3];
    double       worst = 0;
    for (int side = 0; side < 2; side++) {
        a->hits.count = a->rays.count = 3;
        aim(a, 0, 1, up_rad[side], INFINITY), aim(a, 1, 2, up_rad[side], 3000), aim(a, 2, 3, 0.5, INFINITY);
        look(a, &pair[side], 0.6, eye_m[side]);
        if (a->status != STATUS_OK) return INFINITY;
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            for (int i = 0; i < 3; i++) {
                const float now[2] = {a->out[b].transmittance[i], a->out[b].added_w_m2_sr[i]};
                for (int k = 0; k < 2; k++) {
                    const double was = (double)before[b][k][i];
                    if (side == 1) bench_worse(&worst, 100 * ((double)now[k] - was) / fmax(fabs(was), 1e-3));
                    before[b][k][i] = now[k];
                }
            }
    }
    return fabs(worst);
}

/* At 20 km, the tables' top, rays of higher eyes begin where they enter the air: 0.3 % of short paths' scattered light.
 */
static double no_steps(void *user, bool quick)
{
    (void)quick;
    static const double eye_m[][2] = {
        {100, 100},    {1000 - 1e-6, 1000 + 1e-6}, {20000 - 1e-5, 20000 + 1e-5}, {100, 100}, {100, 100}, {100, 100},
        {10000, 10000}};
    double worst = 0;
    for (int n = 0; n < 7; n++) {
        Weather      pair[2] = {weather_default(), weather_default()};
        const double up_rad[2] = {n == 0 || n == 6 ? -1e-9 : -0.02, n == 0 || n == 6 ? 1e-9 : -0.02};
        for (int side = 0; side < 2; side++) {
            const double tiny = side ? 1e-9 : -1e-9;
            Weather     *w = &pair[side];
            if (n == 3) w->visibility_m = 2000 * (1 + tiny);
            if (n == 4) w->visibility_m = 1000 * (1 + tiny);
            if (n == 5) w->rain_mm_h = side ? 1e-12 : 0;
        }
        bench_worse(&worst, step_of(user, pair, eye_m[n], up_rad));
    }
    return fabs(worst);
}

Status bench_stability_air(Bench *bench)
{
    static const StressCase cases[] = {
        {"air: any weather, eyes to 1000 km, any ray", any_weather, 0, "values",
         "transmittance 0 .. 1, radiance finite and not below 0"},
        {"air: across the horizontal, 1 and 20 km, fog's limits, first rain", no_steps, 0.5, "%", "no jump"},
    };
    static Any   any;
    const Status status = air_bench_open(&any.of);
    if (status == STATUS_OK) stress_cases(bench, cases, sizeof cases / sizeof *cases, &any);
    air_bench_close(&any.of);
    return status;
}
