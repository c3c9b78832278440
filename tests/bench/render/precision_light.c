/* tests/bench/render/precision_light.c: black bodies by table, light on surfaces eight at a time, smoke along a
 * ray. */
#include "tests/bench/suites.h"

#include "render/light/optical.h"
#include "render/materials/planck.h"
#include "render/light/surface_light.h"
#include "render/light/thermal.h"
#include "render/smoke/smoke.h"
#include "tests/bench/bench.h"

#include <stdlib.h>

/* ---- black bodies ------------------------------------------------------------------------------ */

static const double low_m = 3.4e-6, high_m = 4.8e-6, coldest_k = 180, hottest_k = 1500;
enum { temps = 2048, most_cells = 4096 };

typedef enum PlanckWay { PLANCK_CLOSED, PLANCK_CUBIC, PLANCK_LINEAR, PLANCK_TABLE, PLANCK_EIGHT } PlanckWay;

typedef struct PlanckSet {
    PlanckWay          way;
    int                cells;
    const PlanckTable *table;
    const float       *temp_k;
    double             u0, per_u, (*c)[4]; /* a table of the bench's own, in 1 / T */
    double             out[temps];
} PlanckSet;

static void own_table(PlanckSet *s)
{
    const double step = (1 / coldest_k - 1 / hottest_k) / s->cells;
    double       value[2] = {0}, slope[2] = {0};
    s->u0 = 1 / hottest_k;
    s->per_u = 1 / step;
    for (int i = 0; i <= s->cells; i++) {
        const double u = s->u0 + i * step;
        value[0] = value[1], slope[0] = slope[1];
        value[1] = planck_band(low_m, high_m, 1 / u, &slope[1]);
        slope[1] *= -step / (u * u);
        if (i == 0) continue;
        const double rise = value[1] - value[0];
        double      *c = s->c[i - 1];
        c[0] = value[0];
        c[1] = s->way == PLANCK_LINEAR ? rise : slope[0];
        c[2] = s->way == PLANCK_LINEAR ? 0 : 3 * rise - 2 * slope[0] - slope[1];
        c[3] = s->way == PLANCK_LINEAR ? 0 : slope[0] + slope[1] - 2 * rise;
    }
}

static void ask_planck(void *user)
{
    PlanckSet *s = user;
    for (int i = 0; i < temps; i += s->way == PLANCK_EIGHT ? 8 : 1) {
        const double temp_k = (double)s->temp_k[i];
        if (s->way == PLANCK_EIGHT) {
            float eight[8];
            planck_table_radiance8(eight, s->table, s->temp_k + i);
            for (int k = 0; k < 8; k++) s->out[i + k] = (double)eight[k];
        } else if (s->way == PLANCK_TABLE) {
            s->out[i] = planck_table_radiance(s->table, temp_k);
        } else if (s->way == PLANCK_CLOSED) {
            s->out[i] = planck_band(low_m, high_m, temp_k, NULL);
        } else {
            const double at = (1 / temp_k - s->u0) * s->per_u;
            const int    cell = at > 0 ? at < s->cells ? (int)at : s->cells - 1 : 0;
            const double t = at - cell, *c = s->c[cell];
            s->out[i] = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
        }
    }
    bench_keep(s->out);
}

static Status tunable_planck(Bench *bench)
{
    enum { settings = 8 };
    static const struct {
        const char *name;
        PlanckWay   way;
        int         cells;
    } setting[settings] = {{"straight lines, 1024 cells", PLANCK_LINEAR, 1024},
                           {"straight lines, 4096 cells", PLANCK_LINEAR, 4096},
                           {"cubics, 64 cells", PLANCK_CUBIC, 64},
                           {"cubics, 256 cells", PLANCK_CUBIC, 256},
                           {"cubics, 1024 cells", PLANCK_CUBIC, 1024},
                           {"its table, one at a time", PLANCK_TABLE, 0},
                           {"its table, eight at a time", PLANCK_EIGHT, 0},
                           {"closed form", PLANCK_CLOSED, 0}};
    static PlanckSet set[settings];
    static double    own[settings][most_cells][4];
    static float     temp_k[temps];
    BenchWork        work[settings];
    BenchSetting     point[settings] = {0};
    PlanckTable     *table;
    const Status     status = planck_table_create(&table, low_m, high_m);
    if (status != STATUS_OK) return status;
    for (int i = 0; i < temps; i++)
        temp_k[i] = (float)(coldest_k + 1 + (hottest_k - coldest_k - 2) * random_uniform(1, 0, 0, (uint64_t)i));
    for (int k = 0; k < settings; k++) {
        double worst = 0;
        set[k] = (PlanckSet){
            .way = setting[k].way, .cells = setting[k].cells, .table = table, .temp_k = temp_k, .c = own[k]};
        if (set[k].cells) own_table(&set[k]);
        ask_planck(&set[k]);
        for (int i = 0; i < temps; i++) {
            double       per_k;
            const double want = planck_band(low_m, high_m, (double)temp_k[i], &per_k);
            bench_worst(&worst, fabs(set[k].out[i] - want) / per_k);
        }
        work[k] = (BenchWork){ask_planck, &set[k], temps};
        point[k] = (BenchSetting){.setting = setting[k].name,
                                  .error = worst,
                                  .is_default = set[k].way == PLANCK_EIGHT,
                                  .bytes = set[k].cells                 ? set[k].cells * sizeof own[0][0]
                                           : set[k].way == PLANCK_TABLE ? planck_table_cells * 4.0 * sizeof(double)
                                           : set[k].way == PLANCK_EIGHT ? planck_table_cells * 4.0 * sizeof(float)
                                                                        : 1};
    }
    bench_tunable(bench,
                  &(BenchTunable){"radiance of a black body", "render/materials/planck.c", "a temperature, 3.4-4.8 um",
                                  "K", "largest, closed form, 180 .. 1500 K", 5e-4},
                  work, point, settings);
    planck_table_destroy(table);
    return STATUS_OK;
}

/* The inverse. */
typedef struct InverseSet {
    int                way; /* 0: by itself, 1: table, 2: table, four at a time */
    const PlanckTable *table;
    const float       *radiance;
    double             out[temps];
} InverseSet;

static void ask_inverse(void *user)
{
    InverseSet *s = user;
    if (s->way == 2) planck_table_temps(s->out, s->table, s->radiance, temps);
    for (int i = 0; s->way < 2 && i < temps; i++)
        s->out[i] = s->way ? planck_table_temp(s->table, (double)s->radiance[i])
                           : planck_band_inverse(low_m, high_m, (double)s->radiance[i]);
    bench_keep(s->out);
}

static Status tunable_inverse(Bench *bench)
{
    enum { settings = 3 };
    static const char *const name[settings] = {"solved", "table", "table, four at a time"};
    static InverseSet        set[settings];
    static float             radiance[temps];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    PlanckTable             *table;
    const Status             status = planck_table_create(&table, low_m, high_m);
    if (status != STATUS_OK) return status;
    for (int i = 0; i < temps; i++)
        radiance[i] =
            (float)planck_band(low_m, high_m, coldest_k + 1 + (hottest_k - coldest_k - 2) * (i + 0.5) / temps, NULL);
    for (int k = 0; k < settings; k++) {
        double worst = 0;
        set[k] = (InverseSet){.way = k, .table = table, .radiance = radiance};
        ask_inverse(&set[k]);
        for (int i = 0; i < temps; i++) { /* the size of one Newton step from the result is its error */
            double       per_k;
            const double back = planck_band(low_m, high_m, set[k].out[i], &per_k);
            bench_worst(&worst, fabs(back - (double)radiance[i]) / per_k);
        }
        work[k] = (BenchWork){ask_inverse, &set[k], temps};
        point[k] = (BenchSetting){.setting = name[k], .error = worst, .is_default = k == 2};
    }
    bench_tunable(bench,
                  &(BenchTunable){"temperature of a radiance", "render/materials/planck.c", "a radiance, 3.4-4.8 um",
                                  "K", "largest, closed form, 180 .. 1500 K", 1e-6},
                  work, point, settings);
    planck_table_destroy(table);
    return STATUS_OK;
}

/* ---- light on surfaces -------------------------------------------------------------------------- */

typedef struct LightSet {
    bool             eight;
    const Air       *air;
    const Materials *materials;
    SurfaceLight     light;
    Hits             hits;
    Rays             rays;
    AirPaths         veils[AIR_BAND_COUNT];
    uint16_t         material[hits_capacity];
    float            sun[hits_capacity];
    float            texture[hits_capacity], temp_k[hits_capacity], out[AIR_BAND_COUNT][hits_capacity];
} LightSet;

enum { light_hits = 1016 };

static double dice(uint32_t stream, int i, double low, double high)
{
    return low + (high - low) * random_uniform(17, stream, 0, (uint64_t)i);
}

static void make_hits(LightSet *s)
{
    s->hits.count = s->rays.count = light_hits;
    for (int i = 0; i < light_hits; i++) {
        const double up = dice(0, i, i % 4 ? 0.95 : 0.2, 1), turn = dice(1, i, 0, 2 * pi_rad), flat = sqrt(1 - up * up);
        const double n[3] = {flat * cos(turn), flat * sin(turn), up};
        double       d[3];
        for (int draw = 0; draw == 0 || v3_dot(n, d) > -0.01; draw++) { /* towards the surface, and down */
            const double down = dice(2, i + 4096 * draw, 0.02, 1), way = dice(3, i + 4096 * draw, 0, 2 * pi_rad);
            const double level = sqrt(1 - down * down);
            d[0] = level * cos(way), d[1] = level * sin(way), d[2] = -down;
        }
        s->hits.range_m[i] = fmin(300 / -d[2], 20000);
        for (int c = 0; c < 3; c++) {
            s->rays.o_enu[c][i] = c == 2 ? 300 : 0;
            s->rays.d_enu[c][i] = d[c];
            s->hits.n_enu[c][i] = s->hits.n_geo[c][i] = (float)n[c];
        }
        s->hits.surface[i] = (uint8_t)(1 + i / 8 % (SURFACE_COUNT - 1));
        s->material[i] = (uint16_t)s->materials->surface[s->hits.surface[i]];
        s->sun[i] = dice(4, i, 0, 1) < 0.3 ? 0.0F : 1.0F;
        s->texture[i] = (float)dice(5, i, 0.6, 1.4);
        s->temp_k[i] = (float)dice(6, i, 270, 330);
    }
}

static void shade(void *user)
{
    LightSet *s = user;
    if (s->eight) {
        float       *out[AIR_BAND_COUNT];
        SurfaceBlock block = {.hits = &s->hits,
                              .rays = &s->rays,
                              .material = s->material,
                              .temp_k = s->temp_k,
                              .sun = s->sun,
                              .veils = s->veils};
        for (int b = 0; b < AIR_BAND_COUNT; b++) out[b] = s->out[b], block.texture[b] = s->texture;
        surface_light_shade(out, &s->light, &block);
    } else {
        static Facing facing;
        daylight_facing(&facing, &s->air->light, s->materials, &s->hits, &s->rays, s->material);
        for (int b = 0; b < AIR_BAND_COUNT; b++) {
            if (b < AIR_MWIR)
                optical_shade(s->out[b], b, s->air, s->materials, &s->hits, &s->rays, s->material, s->texture, s->sun,
                              NULL, NULL, &s->veils[b], &facing);
            else
                thermal_shade(s->out[b], b == AIR_MWIR ? BAND_MWIR : BAND_LWIR, s->air, s->materials, &s->hits,
                              &s->rays, s->material, s->temp_k, s->sun, NULL, NULL, &s->veils[b], &facing);
        }
    }
    bench_keep(s->out);
}

static Status tunable_shading(Bench *bench, const Air *air, const Materials *materials, Arena *arena)
{
    static LightSet set[2];
    BenchWork       work[2];
    BenchSetting    point[2] = {{.setting = "one at a time, in double"},
                                {.setting = "eight at a time, in float", .is_default = true}};
    for (int k = 0; k < 2; k++) {
        set[k].eight = k, set[k].air = air, set[k].materials = materials;
        make_hits(&set[k]);
        air_paths_of(set[k].veils, air, (1 << AIR_BAND_COUNT) - 1, &set[k].hits, &set[k].rays, set[k].temp_k);
        const Status status = surface_light_prepare(&set[k].light, air, materials, arena);
        if (status != STATUS_OK) return status;
        shade(&set[k]);
        work[k] = (BenchWork){shade, &set[k], light_hits};
    }
    for (int b = 0; b < AIR_BAND_COUNT; b++)
        for (int i = 0; i < light_hits; i++)
            bench_worst(&point[1].error, 100 * fabs((double)set[1].out[b][i] / (double)set[0].out[b][i] - 1));
    bench_tunable(bench,
                  &(BenchTunable){"light on the ground", "render/light/surface_light.c", "a hit, seven bands", "%",
                                  "largest, the plain form in double", 0.01},
                  work, point, 2);
    return STATUS_OK;
}

/* ---- smoke -------------------------------------------------------------------------------------- */

enum { smoke_rays = 128, smoke_volumes = 10 };

typedef struct SmokeSet {
    int         steps; /* uniform ones along the ray; 0: smoke_trace_rays */
    SmokeVolume volume[smoke_volumes];
    Rays        rays;
    double      far_m[smoke_rays];
    SmokeRays   out;
} SmokeSet;

/* Makes overlapping puffs 100 .. 160 m away, of different brightness, without a pattern. */
static void make_smoke(SmokeSet *s)
{
    for (int v = 0; v < smoke_volumes; v++) {
        SmokeVolume *to = &s->volume[v];
        *to = (SmokeVolume){.p_enu = {dice(20, v, 100, 160), dice(21, v, -8, 8), dice(22, v, -4, 4)},
                            .axis_enu = {0, 0.6, 0.8},
                            .along_m = dice(23, v, 4, 12),
                            .across_m = dice(24, v, 3, 9),
                            .d_sun_enu = {0, 0, 1}};
        to->range_m = v3_length(to->p_enu);
        for (int b = 0; b < smoke_bands; b++) {
            to->extinction_per_m[b] = dice(25, v, 0.02, 0.3);
            to->source[b] = dice(26, v, 5, 40);
        }
    }
    s->rays.count = smoke_rays;
    for (int r = 0; r < smoke_rays; r++) {
        const double y = dice(27, r, -0.07, 0.07), z = dice(28, r, -0.03, 0.03), n = 1 / sqrt(1 + y * y + z * z);
        s->rays.d_enu[0][r] = n, s->rays.d_enu[1][r] = n * y, s->rays.d_enu[2][r] = n * z;
        s->far_m[r] = 400;
    }
}

static void march(void *user)
{
    SmokeSet *s = user;
    if (s->steps == 0) {
        int list[smoke_volumes];
        for (int v = 0; v < smoke_volumes; v++) list[v] = v;
        smoke_trace_rays(&s->out, s->volume, list, smoke_volumes, &s->rays, s->far_m, 1);
    }
    for (int r = 0; s->steps > 0 && r < smoke_rays; r++) {
        const double o[3] = {0, 0, 0}, d[3] = {s->rays.d_enu[0][r], s->rays.d_enu[1][r], s->rays.d_enu[2][r]};
        const double near_m = 80, step_m = 100.0 / s->steps;
        double       through = 1, added = 0;
        for (int k = 0; k < s->steps; k++) {
            double depth = 0, shown = 0;
            for (int v = 0; v < smoke_volumes; v++) {
                const SmokeVolume *at = &s->volume[v];
                const double       here =
                    at->extinction_per_m[0] * smoke_column_m(at, o, d, near_m + k * step_m, near_m + (k + 1) * step_m);
                depth += here, shown += here * at->source[0];
            }
            if (!(depth > 0)) continue;
            added += through * -expm1(-depth) * shown / depth;
            through *= exp(-depth);
        }
        s->out.transmittance[0][r] = (float)through, s->out.added[0][r] = (float)added;
    }
    bench_keep(&s->out);
}

static void tunable_smoke(Bench *bench)
{
    enum { settings = 5 };
    static const int         steps[settings] = {10, 30, 100, 300, 0};
    static const char *const name[settings] = {"steps of 10 m", "steps of 3.3 m", "steps of 1 m", "steps of 0.33 m",
                                               "cuts where puffs begin and end"};
    static SmokeSet          set[settings], fine = {.steps = 10000};
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    make_smoke(&fine);
    if (bench_quick(bench)) fine.steps = 2000;
    march(&fine);
    for (int k = 0; k < settings; k++) {
        set[k].steps = steps[k];
        make_smoke(&set[k]);
        march(&set[k]);
        for (int r = 0; r < smoke_rays; r++)
            bench_worst(&point[k].error, fabs((double)(set[k].out.added[0][r] + 20 * set[k].out.transmittance[0][r]) /
                                                  (double)(fine.out.added[0][r] + 20 * fine.out.transmittance[0][r]) -
                                              1) *
                                             100);
        work[k] = (BenchWork){march, &set[k], smoke_rays};
        point[k].setting = name[k];
        point[k].is_default = k == settings - 1;
    }
    bench_tunable(bench,
                  &(BenchTunable){"smoke along a ray", "render/smoke/smoke.h", "a ray through ten puffs, one band", "%",
                                  "largest, even steps of 1 cm", 4},
                  work, point, settings);
}

/* ---- the suite ---------------------------------------------------------------------------------- */

static Status light_with_air(Bench *bench)
{
    Atmosphere   *atmosphere = NULL;
    PlanckTable  *mwir = NULL, *lwir = NULL;
    Materials     materials = {0};
    Arena        *arena = arena_create();
    static Air    air;
    char          path[512], surfaces[512];
    const Sun     sun = {.elevation_rad = 0.9, .distance_au = 1, .azimuth_rad = 0, .d_enu = {0, cos(0.9), sin(0.9)}};
    const AirEye  eye = {.height_m = 300, .bands = (1 << AIR_BAND_COUNT) - 1};
    const Weather weather = weather_default();
    Status        status = arena ? atmosphere_open(&atmosphere, "us1976") : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = planck_table_create(&mwir, 3.4e-6, 4.8e-6);
    if (status == STATUS_OK) status = planck_table_create(&lwir, 8e-6, 12e-6);
    if (status == STATUS_OK &&
        (!etc_path(path, sizeof path, "materials.csv") || !etc_path(surfaces, sizeof surfaces, "surfaces.csv")))
        status = STATUS_BAD_VALUE;
    if (status == STATUS_OK) status = materials_open(&materials, path, surfaces, NULL);
    const AirSource source = {atmosphere, mwir, lwir, 0, 0};
    if (status == STATUS_OK) status = air_at(&air, &source, &weather, &sun, &eye, NULL, arena);
    if (status == STATUS_OK) status = tunable_shading(bench, &air, &materials, arena);
    materials_close(&materials);
    atmosphere_close(atmosphere);
    planck_table_destroy(mwir);
    planck_table_destroy(lwir);
    arena_destroy(arena);
    return status;
}

Status bench_precision_light(Bench *bench)
{
    Status status = tunable_planck(bench);
    if (status == STATUS_OK) status = tunable_inverse(bench);
    if (status == STATUS_OK) status = light_with_air(bench);
    if (status == STATUS_OK) tunable_smoke(bench);
    else log_error("bench: precision: %s", status_name(status));
    return status;
}
