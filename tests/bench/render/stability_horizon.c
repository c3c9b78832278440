/* tests/bench/render/stability_horizon.c: lines of sight that bend, and the Earth beyond the terrain's outline, under
 * stress: eyes from below the sea to space, at the poles and the antimeridian, rays that graze the Earth. References:
 * the ellipsoid's tangent in closed form, the mean of an exponential, the same picture without skips. */
#include "tests/bench/suites.h"
#include "tests/scenes/ocean.h"
#include "tests/scenes/stress_world.h"

static const double earth_m = 6371e3, equator_m = 6378137, pole_m = 6356752.314245; /* mean; WGS 84 */

/* Latitude and longitude of origins, degrees; a quick run takes the first three. */
static const double origin_deg[][2] = {{90, 0}, {0, 180}, {34.4, -108.9}, {-90, 30}, {89.9, -179.999}, {-60, -180}};
enum { origins = sizeof origin_deg / sizeof *origin_deg, quick_origins = 3 };

typedef struct Horizon {
    StressWorld w; /* over sea */
    Rays        rays;
    Hits        hits;
} Horizon;

static bool go_to(Horizon *h, int k)
{
    const Geodetic origin = {origin_deg[k][0] * rad_per_deg, origin_deg[k][1] * rad_per_deg, 0};
    landscape_destroy(&h->w.landscape);
    memset(&h->w.landscape, 0, sizeof h->w.landscape);
    h->w.world.landscape = &h->w.landscape;
    stress_clear(&h->w);
    return ocean_create(&h->w.landscape, &h->w.world.frame, &origin) == STATUS_OK;
}

/* As an eye over the origin sees; NULL: no memory. */
static const Visibility *see(Horizon *h, double eye_m, bool bent)
{
    Visibility      *v;
    VisibilityConfig config = {.tracer = h->w.world.tracer,
                               .ground = &h->w.landscape,
                               .frame = &h->w.world.frame,
                               .snapshot = &h->w.snapshot,
                               .eye_enu = {0, 0, eye_m}};
    if (bent) config.bend_per_m = world_bend(&h->w.world, REFRACTION_OPTICAL, config.eye_enu);
    arena_reset(h->w.arena);
    return visibility_create_seen(&v, &config, h->w.arena) == STATUS_OK ? v : NULL;
}

static void aim(Horizon *h, int i, double eye_m, double azimuth_rad, double dip_rad)
{
    const double d[3] = {cos(dip_rad) * sin(azimuth_rad), cos(dip_rad) * cos(azimuth_rad), -sin(dip_rad)};
    for (int c = 0; c < 3; c++) h->rays.o_enu[c][i] = c == 2 ? eye_m : 0, h->rays.d_enu[c][i] = d[c];
    h->rays.far_m[i] = INFINITY;
}

static void trace(Horizon *h, const Visibility *v, int count, bool bent)
{
    VisibilityCounters unused = {0};
    h->rays.count = count, h->rays.bent = bent;
    visibility_first_hit(&h->hits, v, &h->rays, visibility_all_but(-1), &unused);
}

static bool meets(Horizon *h, const Visibility *v, double eye_m, double azimuth_rad, double dip_rad, bool bent)
{
    aim(h, 0, eye_m, azimuth_rad, dip_rad);
    trace(h, v, 1, bent);
    return h->hits.kind[0] == hit_ground;
}

/* Of the lowest line of sight that meets nothing. */
static double traced_dip_rad(Horizon *h, const Visibility *v, double eye_m, double azimuth_rad, bool bent)
{
    double low = 0, high = 0.5 * pi_rad;
    for (int n = 0; n < 50; n++) {
        const double middle = 0.5 * (low + high);
        *(meets(h, v, eye_m, azimuth_rad, middle, bent) ? &high : &low) = middle;
    }
    return low;
}

/* Of the ellipsoid, by the tangent cone from a point: in axes that make it a unit sphere, a line from o along d touches
 * it where (o d)^2 = d^2 (o^2 - 1). */
static double tangent_dip_rad(const Horizon *h, double eye_m, double azimuth_rad)
{
    const LocalFrame *frame = &h->w.world.frame;
    double            low = 0, high = 0.5 * pi_rad;
    for (int n = 0; n < 60; n++) {
        const double middle = 0.5 * (low + high), eye[3] = {0, 0, eye_m};
        const double d_enu[3] = {cos(middle) * sin(azimuth_rad), cos(middle) * cos(azimuth_rad), -sin(middle)};
        double       o[3], d[3];
        ecef_from_enu(o, frame, eye);
        m3_mul_v3(d, frame->r_ecef_from_enu, d_enu);
        for (int c = 0; c < 3; c++) o[c] /= c < 2 ? equator_m : pole_m, d[c] /= c < 2 ? equator_m : pole_m;
        const double along = v3_dot(o, d), room = along * along - v3_dot(d, d) * (v3_dot(o, o) - 1);
        *(room > 0 && along < 0 ? &high : &low) = middle;
    }
    return low;
}

/* ---- refraction ----------------------------------------------------------------------------------- */

/* Wrong are: values that are not within 0 and the sea's; another than the mean of exp(-h / scale) between the two
 * heights, above the ellipsoid; a larger one from higher up; anything but 0 of what is no number. */
static double any_bend(void *user, bool quick)
{
    static const double scale_m[] = {11000, 7350};
    Dice                dice = {.stream = 43};
    double              wrong = 0;
    (void)user;
    for (int n = quick ? 2000 : 100000; n > 0; n--) {
        const RefractionBand band = n % 2 ? REFRACTION_RADAR : REFRACTION_OPTICAL;
        const double         sea = (1 - 1 / (n % 2 ? 4.0 / 3 : 1.149)) / (2 * earth_m), scale = scale_m[n % 2];
        const double         eye_m = n % 9 == 0 ? -50 : n % 9 == 1 ? 0 : stress_log_uniform(&dice, 1e-3, 1e9) - 1000;
        const double         ground_m = n % 7 == 0 ? eye_m : stress_uniform(&dice, -400, 9000);
        const double         got = refraction_bend(band, eye_m, ground_m);
        const double         low = fmax(fmin(eye_m, ground_m), 0), apart = fmax(fmax(eye_m, ground_m), 0) - low;
        const double         mean = exp(-low / scale) * (apart > 0 ? -expm1(-apart / scale) * scale / apart : 1);
        wrong += !(got >= 0 && got <= sea) + !(fabs(got / sea - mean) <= 1e-12 * mean + 1e-300);
        wrong += !(refraction_bend(band, fmax(eye_m, ground_m) + 1, ground_m) <= got);
        wrong += refraction_bend(band, n % 2 ? NAN : INFINITY, ground_m) != 0;
    }
    return wrong;
}

/* The dip by rays that bend over the sea, where a normal section has Euler's radius R, over an Earth of the curvature
 * 1 / R - 2 bend; % of it. */
static double bent_dips(void *user, bool quick)
{
    static const double eyes_m[] = {2, 20, 100, 1000, 5000, 14e3, 50e3, 99e3};
    Horizon            *h = user;
    double              worst = 0;
    for (int k = 0; k < (quick ? quick_origins : origins); k++) {
        const double s = sin(origin_deg[k][0] * rad_per_deg), e2 = 1 - pole_m * pole_m / (equator_m * equator_m);
        const double across_m = equator_m / sqrt(1 - e2 * s * s), along_m = across_m * (1 - e2) / (1 - e2 * s * s);
        if (!go_to(h, k)) return INFINITY;
        for (int n = 0; n < 8; n++) {
            const double      azimuth = 0.4 + 0.7 * n, east = sin(azimuth) * sin(azimuth);
            const double      bend = world_bend(&h->w.world, REFRACTION_OPTICAL, (const double[3]){0, 0, eyes_m[n]});
            const double      curvature = east / across_m + (1 - east) / along_m - 2 * bend;
            const Visibility *v = see(h, eyes_m[n], true);
            if (!v) return INFINITY;
            const double got = traced_dip_rad(h, v, eyes_m[n], azimuth, true);
            bench_worse(&worst, 100 * (got / acos(1 / (1 + curvature * eyes_m[n])) - 1));
        }
    }
    return fabs(worst);
}

/* ---- beyond the outline --------------------------------------------------------------------------- */

static double straight_dips(void *user, bool quick)
{
    static const double eyes_m[] = {14e3, 20e3, 50e3, 99e3, 1e6};
    Horizon            *h = user;
    double              worst = 0;
    for (int k = 0; k < (quick ? quick_origins : origins); k++) {
        if (!go_to(h, k)) return INFINITY;
        for (int n = 0; n < 5; n++) {
            const Visibility *v = see(h, eyes_m[n], false);
            if (!v) return INFINITY;
            for (int a = 0; a < 8; a++)
                bench_worse(&worst, traced_dip_rad(h, v, eyes_m[n], 0.25 * pi_rad * a, false) -
                                        tangent_dip_rad(h, eyes_m[n], 0.25 * pi_rad * a));
        }
    }
    return 1e6 * fabs(worst);
}

static double height_m(const Horizon *h, int i)
{
    const double p_enu[3] = {h->hits.p_enu[0][i], h->hits.p_enu[1][i], h->hits.p_enu[2][i]};
    double       p_ecef[3];
    Geodetic     at;
    ecef_from_enu(p_ecef, &h->w.world.frame, p_enu);
    return geodetic_from_ecef(&at, p_ecef) == STATUS_OK ? at.h_m : NAN;
}

/* Rays within 1e-15 to 1e-2 of the tangent, straight down and up, level and at random. Wrong are: a hit without a range
 * or a place, off the sea by more than what its coarse cells are, with a normal that is none or faces away; a miss with
 * a range; one that misses below the tangent or hits above it by more than 1e-4. */
static double any_ray(void *user, bool quick)
{
    static const double eyes_m[] = {-50, 0, 2, 14e3, 99e3, 1e6};
    Horizon            *h = user;
    Dice                dice = {.stream = 44};
    double              wrong = 0;
    for (int k = 0; k < (quick ? quick_origins : origins); k++) {
        if (!go_to(h, k)) return INFINITY;
        for (int n = 0; n < 12; n++) {
            const double      eye_m = eyes_m[n / 2];
            const bool        bent = n % 2;
            const Visibility *v = see(h, eye_m, bent);
            double            off[hits_capacity];
            if (!v) return INFINITY;
            for (int i = 0; i < hits_capacity; i++) {
                const double azimuth = i % 4 == 0 ? 0.5 * pi_rad * (i / 4) : stress_uniform(&dice, 0, 2 * pi_rad);
                const double tangent = eye_m > 0 ? tangent_dip_rad(h, eye_m, azimuth) : 0;
                off[i] = i % 3 == 2 ? stress_uniform(&dice, -1.5, 1.5) - tangent
                                    : (i % 3 ? 1 : -1) * stress_log_uniform(&dice, 1e-15, 1e-2);
                aim(h, i, eye_m, azimuth, tangent + off[i]);
            }
            for (int i = 0; i < 2; i++) /* exactly down and up */
                h->rays.d_enu[0][i] = h->rays.d_enu[1][i] = 0, h->rays.d_enu[2][i] = 2 * i - 1, off[i] = 1 - 2 * i;
            trace(h, v, hits_capacity, bent);
            for (int i = 0; i < hits_capacity; i++) {
                const bool   met = h->hits.kind[i] == hit_ground;
                const double range_m = h->hits.range_m[i];
                const double level = hypot(h->rays.d_enu[0][i], h->rays.d_enu[1][i]);
                const double sunk = bent && met ? 2 * visibility_bend(v) * range_m * level * level : 0;
                double       facing = -(double)h->hits.n_geo[2][i] * sunk, size = 0;
                for (int c = 0; c < 3; c++) {
                    facing += (double)h->hits.n_geo[c][i] * h->rays.d_enu[c][i];
                    size += (double)h->hits.n_geo[c][i] * (double)h->hits.n_geo[c][i];
                }
                if (!met) wrong += range_m != INFINITY;
                if (met) wrong += !(range_m >= 0 && range_m < INFINITY);
                if (eye_m < 1) continue; /* on or under the water: no more than that is asked */
                if (met) wrong += !(fabs(height_m(h, i)) < 5) + !(fabs(size - 1) < 1e-5) + !(facing < 1e-6);
                if (!bent && eye_m > 1e3) wrong += (off[i] > 1e-4 && !met) + (off[i] < -1e-4 && met);
            }
        }
    }
    return wrong;
}

/* Step in the height of hits from one side of the outline to the other, 1e-12 rad apart: the ellipsoid is raised to the
 * lowest ground of the outline, whose cells are chords of the sea. */
static double outline_step(void *user, bool quick)
{
    static const double eyes_m[] = {30e3, 50e3, 99e3};
    Horizon            *h = user;
    double              worst = 0;
    for (int k = 0; k < (quick ? quick_origins : origins); k++) {
        if (!go_to(h, k)) return INFINITY;
        for (int n = 0; n < 6; n++) {
            const double      eye_m = eyes_m[n / 2];
            const bool        bent = n % 2;
            const Visibility *v = see(h, eye_m, bent);
            if (!v) return INFINITY;
            for (int a = 0; a < 16; a++) {
                const double azimuth = 0.1 + 0.39 * a;
                double       out = tangent_dip_rad(h, eye_m, azimuth), in = 1.5, height[2];
                if (bent) out = traced_dip_rad(h, v, eye_m, azimuth, true) + 1e-9;
                while (in - out > 1e-12) {
                    const double middle = 0.5 * (in + out);
                    (void)meets(h, v, eye_m, azimuth, middle, bent);
                    *(visibility_is_beyond(v, h->hits.p_enu[0][0], h->hits.p_enu[1][0]) ? &out : &in) = middle;
                }
                for (int side = 0; side < 2; side++) {
                    if (!meets(h, v, eye_m, azimuth, side ? in : out, bent)) return INFINITY;
                    height[side] = height_m(h, 0);
                }
                bench_worse(&worst, height[1] - height[0]);
            }
        }
    }
    return fabs(worst);
}

/* ---- pictures ------------------------------------------------------------------------------------- */

/* Level, over the horizon and straight down: values that are none, and those that differ when nothing is skipped. */
static double any_picture(void *user, bool quick)
{
    static const double eyes_m[] = {-50, 0, 2, 14e3, 99e3};
    Horizon            *h = user;
    StressWorld        *w = &h->w;
    double              wrong = 0;
    Arena              *kept = arena_create(), *own = w->arena;
    if (!kept) return INFINITY;
    for (int k = 0; k < (quick ? 2 : origins); k++)
        for (int n = 0; n < 15; n++) {
            const double  eye_m = eyes_m[n / 3], eye[3] = {0, 0, eye_m};
            const double  dip = n % 3 == 1 ? acos(earth_m / (earth_m + fmax(eye_m, 0))) : 0;
            const double  level[3] = {0.6 * cos(dip), 0.8 * cos(dip), -sin(dip)}, down[3] = {0, 0, -1};
            const View    view = stress_view(eye, n % 3 == 2 ? down : level, 0, 33, 24, n % 2 ? 40 : 2000);
            RenderRequest request = stress_request(&view);
            request.refraction = true;
            if ((n == 0 && !go_to(h, k)) || stress_real_air(w, 0.5, fmax(eye_m, 0)) != STATUS_OK) {
                arena_destroy(kept);
                return INFINITY;
            }
            w->arena = kept;
            bool          made = stress_render(w, &request);
            const Picture first = w->picture;
            w->arena = own;
            request.skips_off = skips_all_off;
            made = made && stress_render(w, &request);
            wrong += made ? stress_bad_values(&first) +
                                stress_differences(&first, 0, 0, &w->picture, 0, 0, view.width, view.height)
                          : INFINITY;
        }
    arena_destroy(kept);
    return wrong;
}

Status bench_stability_horizon(Bench *bench)
{
    static const StressCase cases[] = {
        {"refraction: eyes -1 km .. 1e6 km, ground -400 m .. 9 km", any_bend, 0, "values",
         "0 .. the sea's; the mean of exp(-h / scale); 0 of no number"},
        {"refraction: dip from 2 m .. 99 km, poles, antimeridian", bent_dips, 0.15, "% of it",
         "a sphere of Euler's radius, flatter by the bend"},
        {"beyond: dip from 14 .. 1000 km, poles, antimeridian", straight_dips, 5, "urad", "the ellipsoid's tangent"},
        {"beyond: tangent, level, down and up, eyes -50 m .. 1000 km", any_ray, 0, "values",
         "finite, on the sea, faced; met below the tangent"},
        {"beyond: height across the outline, eyes at 30 .. 99 km", outline_step, 1, "m",
         "no step, but the chords of coarse cells"},
        {"beyond: pictures level, over the horizon, straight down", any_picture, 0, "values",
         "finite, not below 0; nothing skipped, to the bit"},
    };
    static Horizon h;
    Status         status = stress_world_open(&h.w, bench_threads(bench));
    if (status != STATUS_OK) return status;
    stress_cases(bench, cases, sizeof cases / sizeof *cases, &h);
    h.w.world.landscape = NULL;
    stress_world_close(&h.w);
    return STATUS_OK;
}
