/* entities/exercise/cast_ground.c: the ground of an exercise, from files or synthetic, and the routes over it. */

#include "entities/exercise/cast_private.h"
#include "terrain/culture/culture_invented.h"
#include "terrain/from_files/elevation_import.h"
#include "terrain/ground/placed.h"
#include "terrain/store/store.h"

#include <stdlib.h>

static const double horizon_m = 60000;

/* Radii of curvature of WGS 84 at the place's height. */
static void set_curvature(ExerciseGround *ground)
{
    static const double a_m = 6378137, e2 = 0.0066943799901413165;
    const double        s = sin(ground->frame.origin.lat_rad), w2 = 1 - e2 * s * s, prime_m = a_m / sqrt(w2);
    ground->half_curvature[0] = 0.5 / (prime_m + ground->frame.origin.h_m);
    ground->half_curvature[1] = 0.5 / (prime_m * (1 - e2) / w2 + ground->frame.origin.h_m);
}

/* z of the place's ENU plane at (x, y). A store has a frame of its own, whose verticals lean by 0.16 mrad a kilometre
 * between the origins: the place is followed along the vertical line, to 1 mm in three steps. */
static double post_at(const ExerciseGround *ground, double x_m, double y_m)
{
    if (!ground->stored.cover) return elevation_height(&ground->elevation, x_m, y_m, NULL);
    double z_m = exercise_level_at(NULL, ground, x_m, y_m);
    for (int step = 0; step < 3; step++) {
        double p_ecef[3], p_store[3], p_enu[3] = {x_m, y_m, z_m};
        ecef_from_enu(p_ecef, &ground->frame, p_enu);
        enu_from_ecef(p_store, &ground->stored.frame, p_ecef);
        p_store[2] = elevation_height(&ground->stored.elevation, p_store[0], p_store[1], NULL);
        ecef_from_enu(p_ecef, &ground->stored.frame, p_store);
        enu_from_ecef(p_enu, &ground->frame, p_ecef);
        z_m = p_enu[2];
    }
    return z_m;
}

Status exercise_ground_create(ExerciseGround *out, const Scenario *scenario)
{
    ExerciseGround ground = {.swell_m = scenario->ground.swell_m, .smooth_m = scenario->ground.smooth_m};
    const Geodetic origin = {scenario->place.lat_deg * rad_per_deg, scenario->place.lon_deg * rad_per_deg,
                             scenario->place.height_m};
    Status         status = local_frame_at(&ground.frame, &origin);
    if (status != STATUS_OK) return status;
    for (uint64_t i = 0; i < 2; i++)
        ground.phase_rad[i] = 2 * pi_rad * random_uniform((uint64_t)scenario->seed, 1, 0, i);
    set_curvature(&ground);
    const bool invented = scenario->ground.planted;
    if (invented + (*scenario->ground.store != 0) + (*scenario->ground.elevation != 0) > 1) {
        log_error("scenario: ground.store, ground.elevation and ground.planted exclude each other: leave one of them");
        return STATUS_BAD_VALUE;
    }
    if (invented) {
        LandscapeConfig land = landscape_default_config();
        land.seed = (uint64_t)scenario->ground.seed;
        land.relief_m = scenario->ground.relief_m;
        land.spacing_m = scenario->ground.spacing_m;
        status = landscape_placed(&ground.stored, &land, &origin, NULL);
        if (status != STATUS_OK) return status;
        ground.real = true;
        const CultureConfig all = {.seed = land.seed, .half_width_m = 1e6};
        if (scenario->ground.buildings) status = culture_invent(&ground.culture, &ground.stored, &all);
        if (status != STATUS_OK) {
            landscape_destroy(&ground.stored);
            return status;
        }
    }
    if (*scenario->ground.store) {
        status = store_open_landscape(&ground.stored, scenario->ground.store, (uint64_t)scenario->seed);
        if (status != STATUS_OK) return status;
        ground.real = true;
        if (!isfinite(post_at(&ground, 0, 0))) {
            log_error("scenario: ground.store: %s has no ground at place.lat_deg, place.lon_deg: %.4f, %.4f; `pitviper "
                      "terrain info` says where it lies",
                      scenario->ground.store, scenario->place.lat_deg, scenario->place.lon_deg);
            landscape_destroy(&ground.stored);
            return STATUS_BAD_VALUE;
        }
    }
    if (*scenario->ground.elevation) {
        static const ElevationVertical vertical[] = {[SCENARIO_VERTICAL_FILE] = ELEVATION_BY_FILE,
                                                     [SCENARIO_VERTICAL_GEOID] = ELEVATION_GEOID,
                                                     [SCENARIO_VERTICAL_ELLIPSOID] = ELEVATION_ELLIPSOID};
        ElevationReport                report;
        const ElevationFiles           files = {.paths = scenario->ground.elevation,
                                                .geoid_path = scenario->ground.geoid,
                                                .vertical = vertical[scenario->ground.vertical],
                                                .horizon_m = horizon_m};
        status = elevation_import(&ground.elevation, &report, &files, &ground.frame, NULL, 0);
        if (status != STATUS_OK) return status;
        ground.real = true;
    }
    *out = ground;
    return STATUS_OK;
}

void exercise_ground_destroy(ExerciseGround *ground)
{
    elevation_destroy(&ground->elevation);
    landscape_destroy(&ground->stored);
    culture_free(&ground->culture);
    *ground = (ExerciseGround){0};
}

double exercise_level_at(double slope[2], const ExerciseGround *ground, double x_m, double y_m)
{
    const double cx = ground->half_curvature[0], cy = ground->half_curvature[1];
    if (slope) {
        slope[0] = -2 * cx * x_m;
        slope[1] = -2 * cy * y_m;
    }
    return -(cx * x_m * x_m + cy * y_m * y_m);
}

static void weights(double w[4], double d[4], double t)
{
    const double s = 1 - t;
    w[0] = s * s * s / 6, w[1] = (4 - 3 * t * t * (2 - t)) / 6;
    w[2] = (4 - 3 * s * s * (2 - s)) / 6, w[3] = t * t * t / 6;
    d[0] = -0.5 * s * s, d[1] = t * (1.5 * t - 2), d[2] = s * (2 - 1.5 * s), d[3] = 0.5 * t * t;
}

/* Heights themselves as the spline's coefficients: bumps are smoothed, hills keep their position. */
static double smoothed(double slope[2], const ExerciseGround *ground, double x_m, double y_m)
{
    const double h = ground->smooth_m, i = floor(x_m / h), j = floor(y_m / h);
    double       wx[4], dx[4], wy[4], dy[4], z = 0, zx = 0, zy = 0;
    weights(wx, dx, x_m / h - i);
    weights(wy, dy, y_m / h - j);
    for (int b = 0; b < 4; b++)
        for (int a = 0; a < 4; a++) {
            const double x = (i + a - 1) * h, y = (j + b - 1) * h;
            double       post = post_at(ground, x, y);
            if (!isfinite(post)) post = exercise_level_at(NULL, ground, x, y); /* beyond the horizon */
            z += wy[b] * wx[a] * post;
            zx += wy[b] * dx[a] * post;
            zy += dy[b] * wx[a] * post;
        }
    if (slope) slope[0] = zx / h, slope[1] = zy / h;
    return z;
}

double exercise_ground_at(double slope[2], const ExerciseGround *ground, double x_m, double y_m)
{
    static const double east_m = 66, north_m = 95;
    if (ground->real) return smoothed(slope, ground, x_m, y_m);
    const double level = exercise_level_at(slope, ground, x_m, y_m);
    const double u = x_m / east_m + ground->phase_rad[0], v = y_m / north_m + ground->phase_rad[1];
    const double sin_u = sin(u), cos_v = cos(v);
    if (slope) {
        slope[0] += ground->swell_m / east_m * cos(u) * cos_v;
        slope[1] -= ground->swell_m / north_m * sin_u * sin(v);
    }
    return level + ground->swell_m * sin_u * cos_v;
}

/* ---- routes: a spline through points ---------------------------------------------------------------- */

/* Second derivatives of the cubic spline through value[i] at u[i]; natural ends. scratch: count. */
static void natural_spline(double *second, const double *u, const double *value, int stride, int count, double *scratch)
{
    second[0] = scratch[0] = 0;
    for (int i = 1; i < count - 1; i++) {
        const double before = u[i] - u[i - 1], after = u[i + 1] - u[i], share = before / (before + after);
        const double pivot = share * second[i - 1] + 2;
        const double slope = (value[stride * (i + 1)] - value[stride * i]) / after -
                             (value[stride * i] - value[stride * (i - 1)]) / before;
        second[i] = (share - 1) / pivot;
        scratch[i] = (6 * slope / (before + after) - share * scratch[i - 1]) / pivot;
    }
    second[count - 1] = 0;
    for (int i = count - 2; i >= 0; i--) second[i] = second[i] * second[i + 1] + scratch[i];
}

static double spline_at(const double *u, const double *value, int stride, const double *second, int i, double at)
{
    const double h = u[i + 1] - u[i], a = (u[i + 1] - at) / h, b = 1 - a;
    return a * value[stride * i] + b * value[stride * (i + 1)] +
           ((a * a * a - a) * second[i] + (b * b * b - b) * second[i + 1]) * h * h / 6;
}

/* A loop is solved as three rounds of its points with natural ends, of which the middle one is used: the effect of an
 * end decays by a factor of 0.27 per point, so short loops use more rounds. */
enum { around = 24, most_rolled = route_max_points + 2 * around + 2 };

typedef struct Through {
    int    count, first, last; /* rolled out; the part that counts */
    double u[most_rolled], p[most_rolled][3], second[3][most_rolled];
} Through;

static void through_points(Through *t, const double (*point)[3], int count, bool loop)
{
    double    scratch[most_rolled];
    const int extra = loop ? around : 0;
    t->count = count + 2 * extra + (loop ? 1 : 0);
    t->first = extra;
    t->last = extra + count - (loop ? 0 : 1);
    for (int i = 0; i < t->count; i++) {
        const int k = ((i - extra) % count + count) % count;
        memcpy(t->p[i], point[k], sizeof t->p[i]);
        t->u[i] = i == 0 ? 0 : t->u[i - 1] + hypot(t->p[i][0] - t->p[i - 1][0], t->p[i][1] - t->p[i - 1][1]);
    }
    for (int c = 0; c < 3; c++) natural_spline(t->second[c], t->u, &t->p[0][c], 3, t->count, scratch);
}

/* ---- routes: evenly by arc length --------------------------------------------------------------------- */

enum { pieces = 256, knots_a_leg = 32 }; /* a leg is measured as so many chords */

static void at_u(double p[3], const Through *t, int leg, double share)
{
    const double u = t->u[leg] + share * (t->u[leg + 1] - t->u[leg]);
    for (int c = 0; c < 3; c++) p[c] = spline_at(t->u, &t->p[0][c], 3, t->second[c], leg, u);
}

/* Solves (c[i-1] + 4 c[i] + c[i+1]) / 6 = sample[i]; at the ends c runs on straight. */
static void control_from_samples(double (*control)[3], const double (*sample)[3], int count, bool loop)
{
    for (int i = 0; i < count + 3; i++)
        for (int c = 0; c < 3; c++) {
            const int k = i - 1;
            const int wrapped = loop ? (k + count) % count : k < 0 ? 0 : k >= count ? count - 1 : k;
            control[i][c] = sample[wrapped][c];
        }
    /* Gauss-Seidel: an error shrinks by four at each sweep */
    for (int sweep = 0; sweep < 28; sweep++) {
        for (int c = 0; c < 3; c++) {
            if (loop) {
                for (int k = 0; k < count; k++) {
                    control[k + 1][c] = (6 * sample[k][c] - control[k][c] - control[k + 2][c]) / 4;
                    if (k == 0) control[count + 1][c] = control[1][c];
                    if (k == 1) control[count + 2][c] = control[2][c];
                    if (k == count - 1) control[0][c] = control[count][c];
                }
            } else {
                for (int k = 0; k < count; k++) {
                    if (k == 0 || k == count - 1) control[k + 1][c] = sample[k][c];
                    else control[k + 1][c] = (6 * sample[k][c] - control[k][c] - control[k + 2][c]) / 4;
                }
                control[0][c] = 2 * control[1][c] - control[2][c];
                control[count + 1][c] = 2 * control[count][c] - control[count - 1][c];
                control[count + 2][c] = 2 * control[count + 1][c] - control[count][c];
            }
        }
    }
}

/* Parameter of each sample along the legs: cumulative chord lengths, then look-up. */
static void sample_evenly(double (*sample)[3], int samples, double step_m, const Through *t, const double *length_m)
{
    const int chords = (t->last - t->first) * pieces;
    int       k = 0;
    for (int i = 0; i < samples; i++) {
        const double want = i * step_m;
        while (k < chords - 1 && length_m[k + 1] < want) k++;
        const double share = clamp((want - length_m[k]) / (length_m[k + 1] - length_m[k]), 0, 1);
        at_u(sample[i], t, t->first + k / pieces, (k % pieces + share) / pieces);
    }
}

static double *measure(const Through *t)
{
    const int chords = (t->last - t->first) * pieces;
    double   *length_m = calloc((size_t)chords + 1, sizeof *length_m), p[3], q[3];
    if (!length_m) return NULL;
    at_u(p, t, t->first, 0);
    for (int k = 0; k < chords; k++) {
        double    middle[3];
        const int leg = t->first + k / pieces;
        at_u(middle, t, leg, (k % pieces + 0.5) / pieces);
        at_u(q, t, leg, (k % pieces + 1.0) / pieces);
        const double whole = hypot(q[0] - p[0], q[1] - p[1]);
        const double halves = hypot(middle[0] - p[0], middle[1] - p[1]) + hypot(q[0] - middle[0], q[1] - middle[1]);
        length_m[k + 1] = length_m[k] + halves + (halves - whole) / 3; /* Richardson extrapolation: the error of chords
                                                                        * is quadratic */
        memcpy(p, q, sizeof p);
    }
    return length_m;
}

Status route_create(Route *out, const double (*point)[3], int count, bool loop)
{
    if (count < (loop ? 3 : 2) || count > route_max_points) return STATUS_BAD_VALUE;
    for (int i = 0; i < count - (loop ? 0 : 1); i++) {
        const double *a = point[i], *b = point[(i + 1) % count];
        if (!(hypot(a[0] - b[0], a[1] - b[1]) >= 0.1)) return STATUS_BAD_VALUE;
    }
    Through *t = calloc(1, sizeof *t);
    if (!t) return STATUS_NO_MEMORY;
    through_points(t, point, count, loop);
    double *length_m = measure(t);
    if (!length_m) {
        free(t);
        return STATUS_NO_MEMORY;
    }
    const int legs = t->last - t->first, steps = legs * knots_a_leg;
    Route     route = {.loop = loop, .length_m = length_m[legs * pieces], .knots = loop ? steps : steps + 1};
    route.step_m = route.length_m / steps;
    route.control = calloc((size_t)route.knots + 3, sizeof *route.control);
    double(*sample)[3] = calloc((size_t)route.knots, sizeof *sample);
    if (route.control && sample) {
        sample_evenly(sample, route.knots, route.step_m, t, length_m);
        control_from_samples(route.control, (const double(*)[3])sample, route.knots, loop);
    }
    const bool done = route.control && sample;
    free(sample);
    free(length_m);
    free(t);
    if (!done) {
        free(route.control);
        return STATUS_NO_MEMORY;
    }
    *out = route;
    return STATUS_OK;
}

void route_destroy(Route *route)
{
    free(route->control);
    *route = (Route){0};
}

static void spline_point(RoutePoint *out, const Route *route, int k, double t)
{
    const double(*c)[3] = (const double(*)[3])route->control + k;
    const double s = 1 - t, per = 1 / route->step_m;
    const double w[4] = {s * s * s / 6, (4 - 3 * t * t * (2 - t)) / 6, (4 - 3 * s * s * (2 - s)) / 6, t * t * t / 6};
    const double d[4] = {-0.5 * s * s, t * (1.5 * t - 2), s * (2 - 1.5 * s), 0.5 * t * t};
    const double e[4] = {s, 3 * t - 2, 3 * s - 2, t};
    for (int i = 0; i < 3; i++) {
        out->p[i] = w[0] * c[0][i] + w[1] * c[1][i] + w[2] * c[2][i] + w[3] * c[3][i];
        out->d[i] = (d[0] * c[0][i] + d[1] * c[1][i] + d[2] * c[2][i] + d[3] * c[3][i]) * per;
        out->dd[i] = (e[0] * c[0][i] + e[1] * c[1][i] + e[2] * c[2][i] + e[3] * c[3][i]) * per * per;
    }
}

void route_at(RoutePoint *out, const Route *route, double distance_m)
{
    if (route->loop) distance_m -= route->length_m * floor(distance_m / route->length_m);
    const double inside = clamp(distance_m, 0, route->length_m), at = inside / route->step_m;
    const int    last = route->loop ? route->knots - 1 : route->knots - 2, k = (int)fmin(floor(at), last);
    spline_point(out, route, k, at - k);
    if (inside == distance_m) return;
    for (int i = 0; i < 3; i++) {
        out->p[i] += (distance_m - inside) * out->d[i];
        out->dd[i] = 0;
    }
}
