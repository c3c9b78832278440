/* entities/scenario/exercise_ground.c: the ground of an exercise, from files or synthetic. */
#include "entities/scenario/exercise_ground.h"

#include "terrain/landscape/elevation_import.h"
#include "terrain/store/store.h"

static const double horizon_m = 60000;

/* Radii of curvature of WGS 84 at the place's height. */
static void set_curvature(ExerciseGround *ground)
{
    static const double a_m = 6378137, e2 = 0.0066943799901413165;
    const double s = sin(ground->frame.origin.lat_rad), w2 = 1 - e2 * s * s, prime_m = a_m / sqrt(w2);
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
    if (*scenario->ground.store && *scenario->ground.elevation) {
        log_error("scenario: ground.store and ground.elevation exclude each other: leave one of them out");
        return STATUS_BAD_VALUE;
    }
    if (*scenario->ground.store) {
        status = landscape_open_store(&ground.stored, scenario->ground.store, (uint64_t)scenario->seed);
        if (status != STATUS_OK) return status;
        ground.real = true;
        if (!isfinite(post_at(&ground, 0, 0))) {
            log_error("scenario: ground.store: %s has no ground at place.lat_deg, place.lon_deg: %.4f, %.4f; `pitviper "
                      "terrain info` says where it lies", scenario->ground.store, scenario->place.lat_deg,
                      scenario->place.lon_deg);
            landscape_destroy(&ground.stored);
            return STATUS_BAD_VALUE;
        }
    }
    if (*scenario->ground.elevation) {
        const char          *vertical = scenario->ground.vertical;
        ElevationReport      report;
        const ElevationFiles files = {.paths = scenario->ground.elevation, .geoid_path = scenario->ground.geoid,
                                      .vertical = *vertical == 'g'   ? ELEVATION_GEOID
                                                  : *vertical == 'e' ? ELEVATION_ELLIPSOID
                                                                     : ELEVATION_BY_FILE,
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
