/* tests/bench/render/precision_air.c: the air tables of a frame against the atmosphere they are made from. */
#include "tests/bench/suites.h"

#include "render/air/air_private.h"
#include "tests/bench/bench.h"

#include <stdlib.h>

enum { paths = 1000, all_bands = (1 << AIR_BAND_COUNT) - 1, skies = 1000 };

/* One eye and its view; the sun is 45 degrees up. */
typedef struct AirSet {
    const Atmosphere  *atmosphere;
    const PlanckTable *planck[2];
    Sun                sun;
    double             eye_m;
    int                paths; /* .. the most */
    View               view;
    Arena             *arena;
    Air                air;
    Hits               hits;
    Rays               rays;
    float              temp_k[hits_capacity];
    AirPaths           veils[AIR_BAND_COUNT];
    PathAir            path[AIR_BAND_COUNT][paths];
    Status             status;
} AirSet;

/* Looks 20 degrees wide, 10 degrees down from up there and level from the ground, 40 degrees beside the sun. */
static void look(AirSet *s)
{
    const double down_rad = s->eye_m < 10 ? 0 : 10 * rad_per_deg, a = s->sun.azimuth_rad + 40 * rad_per_deg;
    const double ahead[3] = {sin(a) * cos(down_rad), cos(a) * cos(down_rad), -sin(down_rad)},
                 right[3] = {cos(a), -sin(a), 0};
    double down[3];
    v3_cross(down, ahead, right);
    s->view = (View){
        .p_enu = {0, 0, s->eye_m}, .width = 720, .height = 486, .focal_px = view_focal_px(720, 20 * rad_per_deg)};
    for (int k = 0; k < 3; k++) {
        s->view.r_enu_from_cam[3 * k] = right[k];
        s->view.r_enu_from_cam[3 * k + 1] = down[k];
        s->view.r_enu_from_cam[3 * k + 2] = ahead[k];
    }
}

static void make_air(void *user)
{
    AirSet         *s = user;
    const Weather   weather = weather_default();
    const AirEye    eye = {s->eye_m, all_bands, &s->view};
    const AirSource source = {s->atmosphere, s->planck[0], s->planck[1], 0, 0};
    arena_reset(s->arena);
    s->status = air_at(&s->air, &source, &weather, &s->sun, &eye, NULL, s->arena);
}

/* Makes paths to the ground or some of the way to it; level and rising ones reach 20 km. */
static void make_paths(AirSet *s)
{
    s->hits.count = s->rays.count = s->paths;
    for (int i = 0; i < s->paths; i++) {
        double d[3];
        view_ray(d, &s->view, 720 * random_uniform(21, 0, 0, (uint64_t)i), 486 * random_uniform(21, 1, 0, (uint64_t)i));
        const double to_ground_m = d[2] < -1e-4 ? s->eye_m / -d[2] : 2e4;
        s->hits.range_m[i] =
            fmin(to_ground_m, 2e4) * (i % 3 ? 0.9999 : 0.05 + 0.9 * random_uniform(21, 2, 0, (uint64_t)i));
        for (int c = 0; c < 3; c++) s->rays.d_enu[c][i] = d[c], s->rays.o_enu[c][i] = 0;
        s->temp_k[i] = (float)(280 + 40 * random_uniform(21, 3, 0, (uint64_t)i));
    }
}

static void ask_veils(void *user)
{
    AirSet *s = user;
    air_paths_of(s->veils, &s->air, all_bands, &s->hits, &s->rays, s->temp_k);
    bench_keep(s->veils);
}

static void ask_atmosphere(void *user)
{
    AirSet       *s = user;
    const double *sun = s->air.light.sun_d_enu;
    for (int i = 0; i < s->paths; i++) {
        const double r = s->hits.range_m[i], up = s->rays.d_enu[2][i], level = sqrt(1 - up * up);
        const double along =
            (s->rays.d_enu[0][i] * sun[0] + s->rays.d_enu[1][i] * sun[1]) / (level * hypot(sun[0], sun[1]));
        const AirPath path = {.observer_m = s->eye_m,
                              .range_m = r,
                              .sun_zenith_rad = 0.5 * pi_rad - s->sun.elevation_rad,
                              .target_m = fmax(s->eye_m + r * up + r * r * level * level / (2 * earth_radius_m), 0),
                              .rel_azimuth_rad = acos(clamp(along, -1, 1))};
        for (int b = 0; b < AIR_BAND_COUNT; b++)
            atmosphere_path(&s->path[b][i], s->air.light.atmosphere, s->air.light.weather.visibility_m, (AirBand)b,
                            &path, (double)s->temp_k[i]);
        for (int b = 0; b < AIR_BAND_COUNT; b++) s->path[b][i].scattered_w_m2_sr *= s->air.light.scattered_scale[b];
    }
    bench_keep(s->path);
}

/* Computes the error, %, of the apparent radiance in these bands of a warm body, or of one of 10 % reflectance in the
 * open, seen through the path. */
static int seen_errors(double *error, const AirSet *s, int first, int end)
{
    int n = 0;
    for (int b = first; b < end; b++)
        for (int i = 0; i < s->paths; i++) {
            const PathAir *want = &s->path[b][i];
            const bool     warm = b >= AIR_MWIR;
            const double   tau = warm ? want->transmittance : want->sun_transmittance;
            const double   bare =
                warm ? planck_table_radiance(s->planck[b - AIR_MWIR], (double)s->temp_k[i])
                       : 0.1 / pi_rad * (s->air.light.sun_w_m2[b] * s->air.light.sun_d_enu[2] + s->air.light.sky_w_m2[b]);
            const double added = want->thermal_w_m2_sr + (b == AIR_LWIR ? 0 : want->scattered_w_m2_sr);
            const double got = bare * (double)s->veils[b].transmittance[i] + (double)s->veils[b].added_w_m2_sr[i];
            error[n++] = 100 * fabs(got / (bare * tau + added) - 1);
        }
    return n;
}

/* ---- tables with every second node ---------------------------------------------------------------- */

/* Replaces odd nodes by the mean of their neighbours, as a table of half as many nodes along this axis would give.
 * lines: outer x inner of them; stride: that of the axis, in values. */
static void thin(float *table, int outer, size_t outer_stride, int nodes, size_t stride, int inner)
{
    for (int a = 0; a < outer; a++)
        for (int k = 1; k + 1 < nodes; k += 2)
            for (int i = 0; i < inner; i++) {
                float *at = table + (size_t)a * outer_stride + (size_t)k * stride + i;
                *at = 0.5f * (at[-(ptrdiff_t)stride] + at[stride]);
            }
}

static void thin_depths(AirTable *t)
{
    enum { heat = 2 * air_warm_values };
    for (int g = 0; g < t->lights; g++) {
        float *depth = t->light[g]->depth[0];
        thin(depth, 1, 0, t->rows + 1, (size_t)air_range_row * air_lights, air_range_row * air_lights);
        thin(depth, t->rows + 1, (size_t)air_range_row * air_lights, air_range_row, air_lights, air_lights);
    }
    for (int k = 0; k < air_temps - 1; k++) {
        float *value = t->heat->value[k][0];
        thin(value, 1, 0, t->rows + 1, (size_t)air_range_row * heat, air_range_row * heat);
        thin(value, t->rows + 1, (size_t)air_range_row * heat, air_range_row, heat, heat);
    }
}

static void thin_scattered(AirTable *t)
{
    for (int g = 0; g < t->lights; g++) {
        float *source = t->light[g]->log2_source[0][0];
        thin(source, t->turns + 1, (size_t)air_slope_nodes * air_lights, air_slopes + 1,
             (size_t)air_share_row * air_lights, air_share_row * air_lights);
        thin(source, (t->turns + 1) * (air_slopes + 1), (size_t)air_share_row * air_lights, air_share_row, air_lights,
             air_lights);
        thin(source, 1, 0, t->turns + 1, (size_t)air_slope_nodes * air_lights, air_slope_nodes * air_lights);
    }
}

enum { ways = 4, eyes = 3 };
typedef enum AirWay { AIR_ONE_BY_ONE, AIR_TABLED, AIR_THIN_DEPTHS, AIR_THIN_SCATTERED } AirWay;

/* Errors of the tables, and the errors of tables of half their resolution. */
static double table_bytes(const AirTable *t, AirWay way)
{
    const double depths = t->lights * (double)sizeof t->light[0]->depth + (double)sizeof *t->heat;
    const double scattered = t->lights * (double)sizeof t->light[0]->log2_source;
    if (way == AIR_ONE_BY_ONE) return 1;
    return depths / (way == AIR_THIN_DEPTHS ? 4 : 1) + scattered / (way == AIR_THIN_SCATTERED ? 8 : 1);
}

typedef struct AirFrames {
    AirSet set[eyes];
    AirWay way;
} AirFrames;

static void ask_frames(void *user)
{
    AirFrames *f = user;
    for (int e = 0; e < eyes; e++) {
        if (f->way == AIR_ONE_BY_ONE) ask_atmosphere(&f->set[e]);
        else ask_veils(&f->set[e]);
    }
}

static Status tunable_paths(Bench *bench, AirFrames *frame)
{
    static const char *const name[ways] = {"asked one by one", "tables of the frame", "every second height and range",
                                           "every second slope, share, azimuth"};
    static double            error[eyes * AIR_BAND_COUNT * paths];
    BenchWork                work[ways];
    BenchTime                fill;
    BenchSetting             seen[ways] = {0}, warm[ways] = {0};
    for (int w = 0; w < ways; w++) {
        frame[w].way = (AirWay)w;
        for (int e = 0; e < eyes; e++) {
            AirSet *s = &frame[w].set[e];
            make_air(s);
            if (s->status != STATUS_OK) return s->status;
            make_paths(s);
            if (w == 0) ask_atmosphere(s);
            else memcpy(s->path, frame[0].set[e].path, sizeof s->path);
            if (w == AIR_THIN_DEPTHS) thin_depths(s->air.table);
            if (w == AIR_THIN_SCATTERED) thin_scattered(s->air.table);
            if (w > 0) ask_veils(s);
        }
        seen[w] = (BenchSetting){.setting = name[w],
                                 .is_default = w == AIR_TABLED,
                                 .bytes = table_bytes(frame[w].set[0].air.table, (AirWay)w)};
        warm[w] = seen[w];
        for (int thermal = 0; thermal < 2 && w > 0; thermal++) {
            int n = 0;
            for (int e = 0; e < eyes; e++)
                n += seen_errors(error + n, &frame[w].set[e], thermal ? AIR_MWIR : 0,
                                 thermal ? AIR_BAND_COUNT : AIR_MWIR);
            qsort(error, (size_t)n, sizeof *error, bench_by_value);
            (thermal ? warm : seen)[w].error = error[n - 1];
        }
        work[w] = (BenchWork){ask_frames, &frame[w], eyes * frame[w].set[0].hits.count};
    }
    for (int w = 0; w < ways; w++) seen[w].also = warm[w].error, warm[w].also = seen[w].error;
    seen[0].also_is = "of thermal bands, %", warm[0].also_is = "of visible bands, %";
    const BenchWork making = {make_air, &frame[0].set[1], 1};
    bench_time(&fill, bench, &making, 1);
    bench_tunable(bench,
                  &(BenchTunable){"air before a pixel, visible", "render/air/air_private.h", "a path, seven bands", "%",
                                  "largest, of radiance seen from 2, 300, 3000 m; the atmosphere asked for it", 2},
                  work, seen, ways);
    for (int w = 0; w < ways; w++) warm[w].time = seen[w].time;
    bench_tunable_rows(
        bench,
        &(BenchTunable){"air before a pixel, thermal", "render/air/air_private.h", "a path, seven bands", "%",
                        "largest, of radiance seen from 2, 300, 3000 m; the atmosphere asked for it", 0.5},
        warm, ways - 1);
    BenchRow row = bench_row_of("air before a pixel: to make a frame's tables, one thread", &fill, NULL, 1);
    row.ratio = fill.median_s / (720 * 486 * (seen[0].time.median_s - seen[1].time.median_s));
    row.to = "what they save";
    bench_add(bench, &row);
    return STATUS_OK;
}

/* ---- the sky ------------------------------------------------------------------------------------- */

typedef struct SkySet {
    const AirSet *from;
    Air           air;
    bool          asked; /* of the atmosphere */
    double        d_enu[skies][3], out[skies];
} SkySet;

static void ask_skies(void *user)
{
    SkySet       *s = user;
    const double  zenith_rad = 0.5 * pi_rad - s->from->sun.elevation_rad;
    const double *sun = s->air.light.sun_d_enu;
    for (int i = 0; i < skies; i++) {
        const double *d = s->d_enu[i];
        if (s->asked) {
            SkyAir       sky;
            const double along = (d[0] * sun[0] + d[1] * sun[1]) / (hypot(d[0], d[1]) * hypot(sun[0], sun[1]));
            atmosphere_sky(&sky, s->air.light.atmosphere, s->air.light.weather.visibility_m, AIR_G, 0, acos(d[2]),
                           zenith_rad, acos(clamp(along, -1, 1)));
            s->out[i] = sky.scattered_w_m2_sr * s->air.light.scattered_scale[AIR_G];
        } else {
            s->out[i] = daylight_sky(&s->air.light, AIR_G, d);
        }
    }
    bench_keep(s->out);
}

/* Samples the visible sky in random directions, as seen from the ground. */
static void tunable_sky(Bench *bench, const AirSet *from)
{
    enum { settings = 3 };
    static const char *const name[settings] = {"asked one by one", "25 heights x 13 azimuths",
                                               "13 heights x 7 azimuths"};
    static SkySet            set[settings];
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    for (int k = 0; k < settings; k++) {
        set[k] = (SkySet){.from = from, .air = from->air, .asked = k == 0};
        AirSky *sky = &set[k].air.light.sky[AIR_G];
        if (k == 2) {
            thin(sky->scattered_w_m2_sr[0], 1, 0, air_sky_ups + 1, air_sky_azimuths + 1, air_sky_azimuths + 1);
            thin(sky->scattered_w_m2_sr[0], air_sky_ups + 1, air_sky_azimuths + 1, air_sky_azimuths + 1, 1, 1);
        }
        for (int i = 0; i < skies; i++) {
            const double up = 0.01 + 0.98 * random_uniform(23, 0, 0, (uint64_t)i), flat = sqrt(1 - up * up);
            const double turn = 2 * pi_rad * random_uniform(23, 1, 0, (uint64_t)i);
            set[k].d_enu[i][0] = flat * sin(turn), set[k].d_enu[i][1] = flat * cos(turn), set[k].d_enu[i][2] = up;
        }
        ask_skies(&set[k]);
        double square = 0;
        for (int i = 0; i < skies; i++) square += pow(set[k].out[i] / set[0].out[i] - 1, 2);
        work[k] = (BenchWork){ask_skies, &set[k], skies};
        point[k] = (BenchSetting){.setting = name[k],
                                  .error = 100 * sqrt(square / skies),
                                  .is_default = k == 1,
                                  .bytes = k == 0   ? 1
                                           : k == 1 ? (double)sizeof *sky
                                                    : 0.35 * (double)sizeof *sky};
    }
    bench_tunable(bench,
                  &(BenchTunable){"radiance of the sky", "render/air/air.h", "a direction, 0.5-0.6 um", "%",
                                  "rms, the atmosphere asked for it", 2},
                  work, point, settings);
}

/* ---- its light on a plane ------------------------------------------------------------------------ */

enum { planes = 64 };

typedef struct PlaneSet {
    Air    air;
    int    steps; /* of height, and four times as many of azimuth; 0: the table */
    double n_enu[planes][3], out[planes];
} PlaneSet;

static void ask_planes(void *user)
{
    PlaneSet *s = user;
    for (int i = 0; i < planes; i++) {
        const double *n = s->n_enu[i];
        if (s->steps == 0) {
            s->out[i] = daylight_on_plane(&s->air.light, AIR_G, n);
            continue;
        }
        double sum = 0;
        for (int h = 0; h < s->steps; h++)
            for (int a = 0; a < 4 * s->steps; a++) {
                const double rise = (h + 0.5) / s->steps * 0.5 * pi_rad, turn = (a + 0.5) * pi_rad / (2 * s->steps);
                const double d[3] = {cos(rise) * sin(turn), cos(rise) * cos(turn), sin(rise)}, cosine = v3_dot(d, n);
                if (cosine > 0) sum += daylight_sky(&s->air.light, AIR_G, d) * cos(rise) * cosine;
            }
        s->out[i] = sum * 0.5 * pi_rad / s->steps * 0.5 * pi_rad / s->steps;
    }
    bench_keep(s->out);
}

static void tunable_planes(Bench *bench, const AirSet *from)
{
    enum { settings = 4 };
    static const char *const name[settings] = {"summed over 8 x 32 directions", "summed over 24 x 96 directions",
                                               "17 tilts x 13 azimuths", "9 tilts x 7 azimuths"};
    static const int         steps[settings] = {8, 24, 0, 0};
    static PlaneSet          set[settings], fine;
    BenchWork                work[settings];
    BenchSetting             point[settings] = {0};
    for (int k = -1; k < settings; k++) {
        PlaneSet *s = k < 0 ? &fine : &set[k];
        s->air = from->air;
        s->steps = k >= 0 ? steps[k] : bench_quick(bench) ? 64 : 128;
        if (k == 3) {
            float *plane = s->air.light.plane_w_m2[AIR_G][0];
            thin(plane, 1, 0, air_plane_ups + 1, air_plane_azimuths + 1, air_plane_azimuths + 1);
            thin(plane, air_plane_ups + 1, air_plane_azimuths + 1, air_plane_azimuths + 1, 1, 1);
        }
        for (int i = 0; i < planes; i++) {
            const double up = 2 * random_uniform(24, 0, 0, (uint64_t)i) - 1, flat = sqrt(1 - up * up);
            const double turn = 2 * pi_rad * random_uniform(24, 1, 0, (uint64_t)i);
            s->n_enu[i][0] = flat * sin(turn), s->n_enu[i][1] = flat * cos(turn), s->n_enu[i][2] = up;
        }
        ask_planes(s);
        if (k < 0) continue;
        const double level = s->air.light.sky_w_m2[AIR_G];
        for (int i = 0; i < planes; i++) bench_worst(&point[k].error, 100 * fabs(s->out[i] - fine.out[i]) / level);
        work[k] = (BenchWork){ask_planes, s, planes};
        point[k].setting = name[k];
        point[k].is_default = k == 2;
        point[k].bytes = k < 2 ? 1 : (k == 2 ? 1 : 0.35) * sizeof s->air.light.plane_w_m2[0];
    }
    bench_tunable(bench,
                  &(BenchTunable){"light of the sky on a plane", "render/air/air.h", "a plane, 0.5-0.6 um", "%",
                                  "largest over that of a level one; 64 x 256 directions or more", 1},
                  work, point, settings);
}

/* ---- the sun and the sky by band ----------------------------------------------------------------- */

/* All light on level ground at 23 km, W/m2, by SPECTRL2 (pvlib 0.16.1) with LOWTRAN7's haze, water and ozone
 * (tests/system/sunlight_judge.py): the sun 60, 40, 25, 18, 8 degrees up. Its scattered light of b and g is less than
 * that of discrete ordinates (tests/render/test_solar.c), the more the lower the sun. */
static void row_bands(Bench *bench, const Atmosphere *atmosphere)
{
    enum { suns = 5, shown = 4 };
    static const double up_deg[suns] = {60, 40, 25, 18, 8};
    static const struct {
        AirBand band;
        double  limit[2], level_w_m2[suns];
    } of[shown] = {{AIR_B, {10.5, 14.5}, {132.71, 89.63, 49.41, 31.05, 10.46}},
                   {AIR_G, {4, 14.5}, {140.92, 97.28, 55.09, 34.65, 9.79}},
                   {AIR_R, {4, 8}, {123.22, 86.52, 50.59, 32.71, 9.52}},
                   {AIR_NIR, {4, 8}, {286.97, 204.00, 122.87, 82.08, 26.47}}};
    for (int k = 0; k < shown; k++)
        for (int low = 0; low < 2; low++) {
            char   what[64];
            double worst = 0;
            for (int i = low ? suns - 1 : 0; i < (low ? suns : suns - 1); i++) {
                SunAir sun;
                atmosphere_sun(&sun, atmosphere, 23000, of[k].band, 0, (90 - up_deg[i]) * rad_per_deg);
                const double level =
                    sun.direct_normal_w_m2 * sin(up_deg[i] * rad_per_deg) + sun.diffuse_horizontal_w_m2;
                bench_worst(&worst, 100 * fabs(level / of[k].level_w_m2[i] - 1));
            }
            snprintf(what, sizeof what, "daylight, %s, sun %s", air_band_name(of[k].band),
                     low ? "8 degrees up" : "from 18 degrees");
            BenchRow row = bench_row(what);
            row.error = worst, row.error_limit = of[k].limit[low], row.error_unit = "%";
            row.against = "largest, all light on level ground at 23 km, SPECTRL2 (pvlib)";
            bench_add(bench, &row);
        }
}

/* ---- the suite ------------------------------------------------------------------------------------ */

Status bench_precision_air(Bench *bench)
{
    static const double eye_m[eyes] = {2, 300, 3000};
    static AirFrames    frame[ways];
    Atmosphere         *atmosphere = NULL;
    PlanckTable        *planck[2] = {NULL};
    Status              status = atmosphere_open(&atmosphere, "us1976");
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        double low_m, high_m;
        air_band_edges(&low_m, &high_m, (AirBand)(AIR_MWIR + k));
        status = planck_table_create(&planck[k], low_m, high_m);
    }
    for (int w = 0; w < ways && status == STATUS_OK; w++)
        for (int e = 0; e < eyes; e++) {
            AirSet      *s = &frame[w].set[e];
            const double elevation_rad = 45 * rad_per_deg, azimuth_rad = 2.1;
            s->atmosphere = atmosphere;
            s->planck[0] = planck[0], s->planck[1] = planck[1];
            s->sun = (Sun){.azimuth_rad = azimuth_rad,
                           .elevation_rad = elevation_rad,
                           .distance_au = 1,
                           .d_enu = {cos(elevation_rad) * sin(azimuth_rad), cos(elevation_rad) * cos(azimuth_rad),
                                     sin(elevation_rad)}};
            s->eye_m = eye_m[e];
            s->paths = bench_quick(bench) ? paths / 4 : paths;
            look(s);
            if (!(s->arena = arena_create())) status = STATUS_NO_MEMORY;
        }
    bench_progress(bench, "air");
    if (status == STATUS_OK) status = tunable_paths(bench, frame);
    if (status == STATUS_OK) {
        tunable_sky(bench, &frame[AIR_TABLED].set[0]);
        tunable_planes(bench, &frame[AIR_TABLED].set[0]);
        row_bands(bench, atmosphere);
    } else {
        log_error("bench: precision: air: %s", status_name(status));
    }
    for (int w = 0; w < ways; w++)
        for (int e = 0; e < eyes; e++) arena_destroy(frame[w].set[e].arena);
    for (int k = 0; k < 2; k++) planck_table_destroy(planck[k]);
    atmosphere_close(atmosphere);
    return status;
}
