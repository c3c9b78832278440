/* tests/bench/render/stability_sun.c: the sun about the horizon, at the zenith and at the nadir. Illumination must
 * be continuous in its height: a jump from frame to frame would be visible, and there is none in nature. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"
#include "render/light/surface_light.h"

enum { places = 3 + 3, bands = AIR_BAND_COUNT, values = places * bands };

typedef struct Lit {
    PlanckTable *mwir, *lwir;
    Atmosphere  *atmosphere;
    Arena       *arena;
    Status       status;
    /* level ground, a wall that faces the sun, one that faces away; sky in three directions */
    double value[values];
} Lit;

/* Temperatures are fixed: they follow the sun by the hour, and are not tested here. */
static void light_at(Lit *lit, double elevation_rad)
{
    static Air          air;
    static AirPaths     veils[AIR_BAND_COUNT];
    static Hits         hits;
    static Rays         rays;
    static SurfaceLight surface;
    static uint16_t     material[hits_capacity];
    static float        arrives[hits_capacity];
    static float        temp_k[hits_capacity], texture[hits_capacity], out[AIR_BAND_COUNT][hits_capacity];
    static const double normal[3][3] = {{0, 0, 1}, {0, 1, 0}, {0, -1, 0}},
                        look[3][3] = {{0, 0.6, 0.8}, {0, 1, 0}, {-1, 0, 0}};
    static const double way[3][3] = {{0.8, 0, -0.6}, {0, -1, 0}, {0, 1, 0}};
    const Sun           sun = {
                  .elevation_rad = elevation_rad, .distance_au = 1, .d_enu = {0, cos(elevation_rad), sin(elevation_rad)}};
    const AirSource source = {lit->atmosphere, lit->mwir, lit->lwir, 0, 0};
    const AirEye    eye = {.height_m = 100, .bands = (1 << AIR_BAND_COUNT) - 1};
    const Weather   weather = weather_default();
    Material        row[2] = {{.roughness = 1}, {.roughness = 1}};
    Materials       materials = {.count = 2, .material = row};
    for (int c = 0; c < optical_channel_count; c++) row[1].rho[c] = materials.ground_rho[c] = 0.3f;
    row[1].rho_mwir = row[1].rho_lwir = 0.1f;
    arena_reset(lit->arena);
    lit->status = air_at(&air, &source, &weather, &sun, &eye, NULL, lit->arena);
    if (lit->status == STATUS_OK) lit->status = surface_light_prepare(&surface, &air, &materials, lit->arena);
    if (lit->status != STATUS_OK) return;
    hits.count = rays.count = 3;
    for (int i = 0; i < 3; i++) {
        for (int c = 0; c < 3; c++)
            hits.n_enu[c][i] = hits.n_geo[c][i] = (float)normal[i][c], rays.d_enu[c][i] = way[i][c];
        hits.range_m[i] = 10, hits.surface[i] = SURFACE_GRASS, material[i] = 1, temp_k[i] = 290, texture[i] = 1;
        arrives[i] = v3_dot(normal[i], sun.d_enu) > 0; /* as visibility_shadow has it of what faces away */
    }
    air_paths_of(veils, &air, (1 << AIR_BAND_COUNT) - 1, &hits, &rays, temp_k);
    float       *to[AIR_BAND_COUNT];
    SurfaceBlock block = {
        .hits = &hits, .rays = &rays, .material = material, .temp_k = temp_k, .sun = arrives, .veils = veils};
    for (int b = 0; b < bands; b++) to[b] = out[b], block.texture[b] = texture;
    surface_light_shade(to, &surface, &block);
    for (int b = 0; b < bands; b++)
        for (int i = 0; i < 3; i++) {
            lit->value[i * bands + b] = (double)out[b][i];
            lit->value[(3 + i) * bands + b] = daylight_sky(&air.light, (AirBand)b, look[i]);
        }
}

/* Finds the largest change of any value over the bracket, relative to the value's maximum in `scale`. */
static double change(const double *a, const double *b, const double *scale)
{
    double most = 0;
    for (int k = 0; k < values; k++) {
        const double part = fabs(a[k] - b[k]) / scale[k];
        if (!(part <= most)) most = isnan(part) ? INFINITY : part;
    }
    return most;
}

/* Finds by how much the change of a value in a step exceeds that in the neighbouring steps: a possible jump. */
static double stands_out(double (*at)[values], int i, int steps, const double *scale)
{
    double most = 0;
    for (int k = 0; k < values; k++) {
        const double before = i > 0 ? fabs(at[i][k] - at[i - 1][k]) : 0,
                     after = i + 1 < steps ? fabs(at[i + 2][k] - at[i + 1][k]) : 0;
        most = fmax(most, (fabs(at[i + 1][k] - at[i][k]) - fmax(before, after)) / scale[k]);
    }
    return most;
}

/* Steps from -0.6 to 0.6 degrees, and halves steps that stand out to 1e-8 degree towards the steeper half: a continuous
 * change goes to zero with the step, a jump remains. There is one of 0.3 % on walls wherever a light of the ring about
 * the sun (daylight.c) sinks below the horizon: it is switched off at once. */
static double horizon_jump(void *user, bool quick)
{
    enum { most_steps = 240 };
    static double at[most_steps + 1][values];
    double        scale[values] = {0}, worst = 0;
    bool          looked_at[most_steps] = {false};
    Lit          *lit = user;
    const int     steps = quick ? 24 : most_steps;
    const double  low = -0.6 * rad_per_deg, step = 1.2 * rad_per_deg / steps;
    for (int i = 0; i <= steps; i++) {
        light_at(lit, low + i * step);
        if (lit->status != STATUS_OK) return INFINITY;
        memcpy(at[i], lit->value, sizeof at[i]);
        for (int k = 0; k < values; k++) scale[k] = fmax(scale[k], lit->value[k]);
    }
    for (int k = 0; k < values; k++) scale[k] = fmax(scale[k], 1e-6);
    for (int n = 0; n < (quick ? 2 : 8); n++) {
        int    steepest = 0; /* the steepest step that was not tested */
        double most = -1;
        for (int i = 0; i < steps; i++) {
            const double here = looked_at[i] ? -1 : stands_out(at, i, steps, scale);
            if (here > most) most = here, steepest = i;
        }
        looked_at[steepest] = true;
        double a = low + steepest * step, b = a + step, left[values], right[values];
        memcpy(left, at[steepest], sizeof left);
        memcpy(right, at[steepest + 1], sizeof right);
        while (b - a > 1e-8 * rad_per_deg) {
            light_at(lit, 0.5 * (a + b));
            if (change(left, lit->value, scale) > change(lit->value, right, scale))
                b = 0.5 * (a + b), memcpy(right, lit->value, sizeof right);
            else a = 0.5 * (a + b), memcpy(left, lit->value, sizeof left);
        }
        worst = fmax(worst, change(left, right, scale));
    }
    return worst;
}

/* The sun anywhere, and exactly above, below and on the horizon: nothing that is not a number, nothing below 0. */
static double anywhere(void *user, bool quick)
{
    static const double odd[] = {-1.5707963267948966, -0.8,     0, 5e-324, -5e-324, 1e-9, -1e-9,
                                 1.5707963267948966,  1.5707963};
    Lit                *lit = user;
    Dice                dice = {.stream = 40};
    double              wrong = 0;
    for (int n = quick ? 20 : 300; n >= 0; n--) {
        light_at(lit, n < 9 ? odd[n] : stress_uniform(&dice, -1.57, 1.57));
        if (lit->status != STATUS_OK) return INFINITY;
        for (int k = 0; k < values; k++) wrong += !(lit->value[k] >= 0 && isfinite(lit->value[k]));
    }
    return wrong;
}

Status bench_stability_sun(Bench *bench)
{
    static const StressCase cases[] = {
        {"sun: -0.6 .. 0.6 degrees: largest jump of ground, walls, sky", horizon_jump, 5e-3, "of the most",
         "none within 1e-8 degree"},
        {"sun: anywhere, at zenith, nadir and on the horizon", anywhere, 0, "values", "finite, not below 0"},
    };
    Lit    lit = {.arena = arena_create()};
    Status status = lit.arena ? atmosphere_open(&lit.atmosphere, "us1976") : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = planck_table_create(&lit.mwir, 3.4e-6, 4.8e-6);
    if (status == STATUS_OK) status = planck_table_create(&lit.lwir, 8e-6, 12e-6);
    if (status == STATUS_OK) stress_cases(bench, cases, sizeof cases / sizeof *cases, &lit);
    planck_table_destroy(lit.mwir);
    planck_table_destroy(lit.lwir);
    atmosphere_close(lit.atmosphere);
    arena_destroy(lit.arena);
    return status;
}
