/* tests/bench/render/stability_light.c: black bodies of 1 K to 10,000 K, air from the ground to space, smoke as
 * thick as a wall, surfaces that are black and mirrors. References: Planck's law integrated in long double,
 * conservation of energy, and the isothermal cavity. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"
#include "render/materials/planck.h"
#include "render/light/surface_light.h"
#include "render/smoke/smoke.h"

#include <stdlib.h>

typedef struct Light {
    PlanckTable *mwir, *lwir;
    Atmosphere  *atmosphere;
    Arena       *arena;
} Light;

static const struct {
    double low_m, high_m;
} band_m[2] = {{3.4e-6, 4.8e-6}, {8e-6, 12e-6}};

static void worse(double *worst, double error)
{
    if (!(error <= *worst)) *worst = isnan(error) ? INFINITY : error;
}

/* ---- Planck ------------------------------------------------------------------------------------- */

/* Planck's law by Simpson's rule over x = h c / (wavelength k T), scaled by e^x1 so that nothing underflows on the way:
 * ln of the radiance. 20,000 steps where the integrand is not yet gone: some 1e-15. */
static long double ln_planck(double low_m, double high_m, double temp_k)
{
    const long double h = 6.62607015e-34L, c = 299792458, k = 1.380649e-23L, hc_kt = h * c / (k * temp_k);
    const long double x1 = hc_kt / high_m, x2 = fminl(hc_kt / low_m, x1 + 60);
    const int         steps = 20000;
    long double       sum = 0;
    for (int i = 0; i <= steps; i++) {
        const long double x = x1 + (x2 - x1) * i / steps;
        sum += x * x * x * expl(x1 - x) / -expm1l(-x) * (i == 0 || i == steps ? 1 : i % 2 ? 4 : 2);
    }
    return logl(sum * (x2 - x1) / steps / 3) - x1 + logl(2 * h * c * c) - 4 * logl(hc_kt);
}

static double planck_wide(void *user, bool quick)
{
    double    worst = 0;
    const int temps = quick ? 40 : 400;
    (void)user;
    for (int i = 0; i <= temps; i++)
        for (int b = 0; b < 2; b++) {
            const double t = pow(10, 4.0 * i / temps), got = planck_band(band_m[b].low_m, band_m[b].high_m, t, NULL);
            const long double want = ln_planck(band_m[b].low_m, band_m[b].high_m, t);
            /* negligible: 0, or a tiny remainder */
            if (want < -700) worse(&worst, got >= 0 && got < 1e-303 ? 0 : INFINITY);
            else worse(&worst, fabs((double)expm1l(logl(got) - want)));
        }
    return worst;
}

/* Temperature to radiance and back by the exact functions. Where radiance has underflowed there is no inverse: NaN. */
static double planck_round_trip(void *user, bool quick)
{
    double    worst_k = 0;
    const int temps = quick ? 400 : 20000;
    (void)user;
    for (int i = 0; i <= temps; i++)
        for (int b = 0; b < 2; b++) {
            const double t = pow(10, 4.0 * i / temps), l = planck_band(band_m[b].low_m, band_m[b].high_m, t, NULL);
            const double back_k = planck_band_inverse(band_m[b].low_m, band_m[b].high_m, l);
            if (l < 1e-300) worse(&worst_k, l > 0 || isnan(back_k) ? 0 : INFINITY);
            else worse(&worst_k, fabs(back_k - t));
        }
    return worst_k;
}

/* Holds the table's radiance in a float, as a picture does, and turns it back into a temperature, for all temperatures
 * whose radiance a float holds. A step of a float is worth 6e-8 of the radiance: 1 mK at 10,000 K. */
static double table_round_trip(void *user, bool quick)
{
    const Light *light = user;
    double       worst_k = 0;
    const int    temps = quick ? 4000 : 200000;
    for (int i = 0; i <= temps; i++)
        for (int b = 0; b < 2; b++) {
            const double t = pow(10, 4.0 * i / temps);
            const float  l = (float)planck_table_radiance(b ? light->lwir : light->mwir, t);
            double       back_k;
            planck_table_temps(&back_k, b ? light->lwir : light->mwir, &l, 1);
            if (l < 1e-37f) worse(&worst_k, l > 0 || isnan(back_k) ? 0 : INFINITY);
            else worse(&worst_k, fabs(back_k - t));
        }
    return worst_k;
}

/* Eight temperatures at a time, valid, invalid and NaN, in every lane: counts results that differ from one at a time
 * by more than a float, or are a number where there is none. */
static double table_by_eights(void *user, bool quick)
{
    static const float odd[] = {0,   -0.0f, -300,     1e-40f, 1e-30f, 1,        3,         179.99f,
                                180, 1500,  1500.01f, 1e4f,   1e30f,  INFINITY, -INFINITY, NAN};
    const Light       *light = user;
    Dice               dice = {.stream = 30};
    double             wrong = 0;
    for (int n = quick ? 2000 : 50000; n > 0; n--) {
        float temp_k[8], l[8];
        for (int k = 0; k < 8; k++)
            temp_k[k] = n % 2 ? odd[(int)stress_uniform(&dice, 0, sizeof odd / sizeof *odd)]
                              : (float)stress_log_uniform(&dice, 1, 1e4);
        planck_table_radiance8(l, light->lwir, temp_k);
        for (int k = 0; k < 8; k++) {
            const double want = planck_table_radiance(light->lwir, (double)temp_k[k]);
            if (!(temp_k[k] > 0 && temp_k[k] < INFINITY)) wrong += !isnan(l[k]);
            else wrong += !(fabs((double)l[k] - want) <= 5e-6 * want + 1e-37) && !((double)l[k] == want);
        }
    }
    return wrong;
}

/* ---- air ---------------------------------------------------------------------------------------- */

static double path_values(void *user, bool quick)
{
    const Light *light = user;
    Dice         dice = {.stream = 31};
    double       wrong = 0;
    for (int n = quick ? 10000 : 300000; n > 0; n--) {
        const AirPath path = {
            .observer_m = n % 7 ? stress_uniform(&dice, -100, 25000) : stress_log_uniform(&dice, 1e-3, 1e9),
            .target_m = n % 5 ? stress_uniform(&dice, -100, 25000) : stress_log_uniform(&dice, 1e-3, 1e9),
            .range_m = n % 3   ? stress_log_uniform(&dice, 1e-300, 1e12)
                       : n % 2 ? 0
                               : stress_log_uniform(&dice, 1, 2e5),
            .sun_zenith_rad = n % 4 ? stress_uniform(&dice, 0, pi_rad) : 0.5 * pi_rad,
            .rel_azimuth_rad = n % 6 ? stress_uniform(&dice, -pi_rad, pi_rad) : 0};
        const AirBand band = (AirBand)(n % AIR_BAND_COUNT);
        PathAir       p;
        SkyAir        sky;
        atmosphere_path(&p, light->atmosphere, stress_log_uniform(&dice, 1, 1e7), band, &path,
                        stress_log_uniform(&dice, 1, 1e4));
        wrong += !(p.transmittance >= 0 && p.transmittance <= 1) +
                 !(p.sun_transmittance >= 0 && p.sun_transmittance <= 1) +
                 !(p.thermal_w_m2_sr >= 0 && isfinite(p.thermal_w_m2_sr)) +
                 !(p.scattered_w_m2_sr >= 0 && isfinite(p.scattered_w_m2_sr));
        atmosphere_sky(&sky, light->atmosphere, stress_log_uniform(&dice, 1, 1e7), band, path.observer_m,
                       stress_uniform(&dice, 0, pi_rad), path.sun_zenith_rad, path.rel_azimuth_rad);
        wrong += !(sky.thermal_w_m2_sr >= 0 && isfinite(sky.thermal_w_m2_sr)) +
                 !(sky.scattered_w_m2_sr >= 0 && isfinite(sky.scattered_w_m2_sr));
    }
    return wrong;
}

/* Tries the parameters of frames: eyes from below the ground to space, suns from nadir to zenith, rays of zero length,
 * of 1000 km and to the sky, straight up and down. */
static double veil_values(void *user, bool quick)
{
    static const double eye_m[] = {-50, 0, 2, 300, 19999, 20000, 1e6},
                        sun_rad[] = {-1.5707963267948966, -0.01, 0, 0.01, 1.5707963267948966};
    static Air      air;
    static AirPaths veils[AIR_BAND_COUNT];
    static Hits     hits;
    static Rays     rays;
    static float    temp_k[hits_capacity];
    const Light    *light = user;
    Dice            dice = {.stream = 32};
    double          wrong = 0;
    for (int e = 0; e < 7; e++)
        for (int s = 0; s < 5; s++) {
            const double    east = s % 2 ? 0 : cos(sun_rad[s]);
            const Sun       sun = {.elevation_rad = sun_rad[s],
                                   .distance_au = 1,
                                   .d_enu = {east, cos(sun_rad[s]) - east, sin(sun_rad[s])}};
            const AirSource source = {light->atmosphere, light->mwir, light->lwir, 0, 0};
            const AirEye    eye = {.height_m = eye_m[e], .bands = (1 << AIR_BAND_COUNT) - 1};
            Weather         weather = weather_default();
            weather.visibility_m = e % 2 ? 100 : 300000;
            weather.air_temp_k = s % 2 ? 220 : 330;
            if (quick && (e + s) % 3) continue;
            arena_reset(light->arena);
            if (air_at(&air, &source, &weather, &sun, &eye, NULL, light->arena) != STATUS_OK) return INFINITY;
            hits.count = rays.count = hits_capacity;
            for (int i = 0; i < hits_capacity; i++) {
                double d[3];
                stress_direction(d, &dice);
                if (i % 16 == 0) d[0] = d[1] = 0, d[2] = i % 32 ? -1 : 1;
                if (i % 16 == 1) d[2] = 0, v3_normalize(d, d);
                for (int c = 0; c < 3; c++) rays.d_enu[c][i] = d[c];
                rays.o_enu[0][i] = rays.o_enu[1][i] = i % 8 ? 0 : 2e5;
                rays.o_enu[2][i] = eye_m[e];
                hits.range_m[i] = i % 5 == 0 ? INFINITY : i % 5 == 1 ? 0 : stress_log_uniform(&dice, 1e-3, 1e6);
                temp_k[i] = i % 9 == 0 ? NAN : (float)stress_log_uniform(&dice, 1, 1e4);
            }
            air_paths_of(veils, &air, (1 << AIR_BAND_COUNT) - 1, &hits, &rays, temp_k);
            for (int b = 0; b < AIR_BAND_COUNT; b++)
                for (int i = 0; i < hits_capacity; i++) {
                    const float *const share[3] = {veils[b].transmittance, veils[b].sun_transmittance,
                                                   veils[b].air_transmittance};
                    for (int k = 0; k < 3; k++) wrong += !(share[k][i] >= 0 && share[k][i] <= 1);
                    wrong += !(veils[b].added_w_m2_sr[i] >= 0 && isfinite(veils[b].added_w_m2_sr[i]));
                    const double d[3] = {rays.d_enu[0][i], rays.d_enu[1][i], rays.d_enu[2][i]};
                    const double sky = daylight_sky(&air.light, (AirBand)b, d),
                                 plane = daylight_on_plane(&air.light, (AirBand)b, d);
                    wrong += !(sky >= 0 && isfinite(sky)) + !(plane >= 0 && isfinite(plane));
                }
        }
    return wrong;
}

/* ---- smoke --------------------------------------------------------------------------------------- */

/* Spheroids from transparent to opaque, also needles of 1e6:1, of uniform radiance in front of a background of the
 * same: they must be invisible, and transmittance stays in 0 .. 1. */
static double smoke(void *user, bool quick)
{
    enum { volumes = 40 };
    static Rays      rays;
    static SmokeRays out;
    Dice             dice = {.stream = 33};
    double           worst = 0;
    (void)user;
    for (int round = quick ? 5 : 50; round > 0; round--) {
        SmokeVolume v[volumes];
        SmokeGas    gas[volumes];
        int         list[volumes];
        double      far_m[hits_capacity];
        for (int k = 0; k < volumes; k++) {
            v[k] = (SmokeVolume){.along_m = stress_log_uniform(&dice, 1e-2, 1e4),
                                 .even = k % 2,
                                 .d_sun_enu = {0, 0, 1},
                                 .billow = k % 3 ? 0 : stress_uniform(&dice, 0, 0.6)};
            v[k].across_m = k % 4 ? v[k].along_m : v[k].along_m * 1e-6;
            stress_direction(v[k].p_enu, &dice);
            v3_scale(v[k].p_enu, stress_log_uniform(&dice, 1, 1000), v[k].p_enu);
            stress_direction(v[k].axis_enu, &dice);
            v[k].range_m = v3_length(v[k].p_enu);
            for (int b = 0; b < smoke_bands; b++)
                v[k].extinction_per_m[b] = b == 0 ? 0 : stress_log_uniform(&dice, 1e-300, b == 1 ? 1e-290 : 1e12),
                v[k].source[b] = 7;
            gas[k] = (SmokeGas){.co2_atm = stress_log_uniform(&dice, 1e-300, 1e6),
                                .h2o_atm = k % 4 ? stress_log_uniform(&dice, 1e-300, 1e6) : 0,
                                .source = {7, 7}};
            const double gas_k = stress_log_uniform(&dice, 1, 1e5);
            for (int band = 0; band < 2; band++) smoke_gas_weights(gas[k].weight[band], (HotGasBand)band, gas_k);
            smoke_gas_passed_at(gas[k].passed, gas_k, stress_log_uniform(&dice, 1e-3, 1e6));
            if (k % 3 == 0) v[k].gas = &gas[k];
            list[k] = k;
        }
        rays.count = hits_capacity;
        for (int i = 0; i < hits_capacity; i++) {
            double    d[3];
            const int k = i % volumes;
            stress_direction(d, &dice);
            if (i % 2) v3_normalize(d, v[k].p_enu);
            for (int c = 0; c < 3; c++) rays.o_enu[c][i] = i % 5 ? 0 : v[k].p_enu[c], rays.d_enu[c][i] = d[c];
            far_m[i] = i % 7 ? INFINITY : i % 3 ? v[k].range_m : 0;
        }
        smoke_trace_rays(&out, v, list, volumes, &rays, far_m, (1 << smoke_bands) - 1);
        for (int i = 0; i < hits_capacity && out.any; i++)
            for (int b = 0; b < smoke_bands; b++) {
                const double t = (double)out.transmittance[b][i];
                worse(&worst, t >= 0 && t <= 1 ? fabs(t + (double)out.added[b][i] / 7 - 1) : INFINITY);
            }
    }
    return worst;
}

/* ---- surfaces -------------------------------------------------------------------------------------- */

/* Surfaces black, white and mirrors, smooth and rough, face-on to edge-on, in an isothermal cavity: each has the
 * radiance Planck(T). The quick form that frames use. */
static double cavity(void *user, bool quick)
{
    static const float  rho[4] = {0, 1e-30f, 0.5f, 1}, gloss[3] = {0, 0.5f, 1}, roughness[4] = {0, 0.001f, 0.2f, 1};
    static Air          air;
    static AirPaths     veils[AIR_BAND_COUNT];
    static Hits         hits;
    static Rays         rays;
    static SurfaceLight surface;
    static uint16_t     material[hits_capacity];
    static float        arrives[hits_capacity];
    static float        temp_k[hits_capacity], out_mwir[hits_capacity], out_lwir[hits_capacity];
    const Light        *light = user;
    Material            row[48];
    Materials           materials = {.count = 48, .material = row};
    Dice                dice = {.stream = 34};
    double              worst = 0;
    memset(row, 0, sizeof row);
    for (int m = 0; m < 48; m++)
        row[m].rho_mwir = row[m].rho_lwir = rho[m % 4], row[m].gloss = gloss[m / 4 % 3],
        row[m].roughness = roughness[m / 12];
    for (int step = 0; step <= (quick ? 6 : 40); step++) {
        const double t_k = pow(10, 1.5 + 2.5 * step / (quick ? 6 : 40)), up[3] = {0, 0, 1};
        double       of_band[AIR_BAND_COUNT] = {0};
        of_band[AIR_MWIR] = planck_table_radiance(light->mwir, t_k);
        of_band[AIR_LWIR] = planck_table_radiance(light->lwir, t_k);
        air_even(&air, up, 0, of_band, step % 2 ? 1e-4 : 0, light->mwir, light->lwir);
        arena_reset(light->arena);
        if (surface_light_prepare(&surface, &air, &materials, light->arena) != STATUS_OK) return INFINITY;
        hits.count = rays.count = hits_capacity;
        for (int i = 0; i < hits_capacity; i++) {
            double d[3], n[3];
            stress_direction(d, &dice);
            stress_direction(n, &dice);
            if (i % 8 == 0) v3_add_scaled(n, n, -v3_dot(n, d), d), v3_normalize(n, n); /* edge-on */
            if (i % 8 == 1) v3_scale(n, -1, d);
            if (v3_dot(n, d) > 0) v3_scale(n, -1, n);
            for (int c = 0; c < 3; c++) rays.d_enu[c][i] = d[c], hits.n_enu[c][i] = hits.n_geo[c][i] = (float)n[c];
            hits.range_m[i] = stress_log_uniform(&dice, 0.1, 2e5);
            material[i] = (uint16_t)(i % 48);
            temp_k[i] = (float)t_k;
            arrives[i] = 1;
        }
        air_paths_of(veils, &air, 1 << AIR_MWIR | 1 << AIR_LWIR, &hits, &rays, temp_k);
        float *const       out[AIR_BAND_COUNT] = {[AIR_MWIR] = out_mwir, [AIR_LWIR] = out_lwir};
        const SurfaceBlock block = {
            .hits = &hits, .rays = &rays, .material = material, .temp_k = temp_k, .sun = arrives, .veils = veils};
        surface_light_shade(out, &surface, &block);
        for (int i = 0; i < hits_capacity; i++)
            for (int b = AIR_MWIR; b <= AIR_LWIR; b++)
                if (of_band[b] > 1e-30) worse(&worst, fabs((double)out[b][i] / of_band[b] - 1));
    }
    return worst;
}

Status bench_stability_light(Bench *bench)
{
    static const StressCase cases[] = {
        {"light: Planck in band, 1 .. 10,000 K", planck_wide, 1e-12, "relative", "Simpson's rule in long double"},
        {"light: and back, to where it underflows", planck_round_trip, 1e-6, "K", "the temperature put in"},
        {"light: the table, a float of it, and back", table_round_trip, 2e-3, "K", "the temperature put in"},
        {"light: eight temperatures, some none", table_by_eights, 0, "values",
         "one at a time; NaN where there is none"},
        {"light: paths and skies, 0 m .. 1e9 km, 1 m .. 10,000 km of sight", path_values, 0, "values",
         "finite, not below 0; shares 0 .. 1"},
        {"light: a frame's air, eyes -50 m .. 1000 km, sun all round", veil_values, 0, "values",
         "finite, not below 0; shares 0 .. 1"},
        {"light: smoke, nothing to a wall, in its own radiance", smoke, 1e-6, "relative",
         "nothing shows; transmittance in 0 .. 1"},
        {"light: surfaces 0 .. 1 in an isothermal cavity, 30 .. 10,000 K", cavity, 1e-4, "relative",
         "Planck(T), everywhere"},
    };
    Light  light = {.arena = arena_create()};
    Status status = light.arena ? atmosphere_open(&light.atmosphere, "us1976") : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = planck_table_create(&light.mwir, band_m[0].low_m, band_m[0].high_m);
    if (status == STATUS_OK) status = planck_table_create(&light.lwir, band_m[1].low_m, band_m[1].high_m);
    if (status == STATUS_OK) stress_cases(bench, cases, sizeof cases / sizeof *cases, &light);
    planck_table_destroy(light.mwir);
    planck_table_destroy(light.lwir);
    atmosphere_close(light.atmosphere);
    arena_destroy(light.arena);
    return status;
}
