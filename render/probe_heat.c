/* render/probe_heat.c: `pitviper probe heat-ground`: the ground's heat for rows of CSV, as frames have it, without a scene.
 *
 * Each local day (by the sun's mean time at the place) is an exercise of its own: warmed up over the two days before its
 * midnight, so that a row's answer depends on no other row. Rows in the order of time are answered without starting again. */
#include "render/probe_private.h"

#include "render/frame/heat_drive.h"
#include "terrain/probe.h"

#include <stdlib.h>

typedef struct HeatProbe {
    Materials    materials;
    GroundKinds  kinds;
    PlanckTable *planck[2];
    Atmosphere  *atmosphere;
    WeatherCourse *course;
    HeatDrive    drive;
    Arena       *arena;
    Pool        *pool;
    Heat        *heat;         /* of the day of drive.exercise_s; NULL: none yet */
} HeatProbe;

static const double day_s = 86400;

void heat_probe_close(void *state)
{
    HeatProbe *p = state;
    heat_destroy(p->heat);
    pool_destroy(p->pool);
    arena_destroy(p->arena);
    weather_course_close(p->course);
    atmosphere_close(p->atmosphere);
    for (int k = 0; k < 2; k++) planck_table_destroy(p->planck[k]);
    materials_close(&p->materials);
    free(p);
}

static Status open_tables(HeatProbe *p)
{
    char materials[512], surfaces[512], ground[512];
    if (!etc_path(materials, sizeof materials, "materials.csv") || !etc_path(surfaces, sizeof surfaces, "surfaces.csv") ||
        !etc_path(ground, sizeof ground, "ground_heat.csv")) {
        log_error("probe: path of the tables is too long; set PITVIPER_ETC to a shorter one");
        return STATUS_BAD_VALUE;
    }
    Status status = materials_open(&p->materials, materials, surfaces, NULL);
    if (status == STATUS_OK) status = ground_kinds_open(&p->kinds, ground, &p->materials);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        double low_m, high_m;
        air_band_edges(&low_m, &high_m, (AirBand)(AIR_MWIR + k));
        status = planck_table_create(&p->planck[k], low_m, high_m);
    }
    if (status == STATUS_OK) status = atmosphere_open(&p->atmosphere, "us1976");
    return status;
}

Status heat_probe_open(void **state, int argc, char **argv)
{
    HeatProbe *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    Status status = probe_weather(&p->course, &p->drive.place, argc, argv);
    if (status == STATUS_OK) status = open_tables(p);
    if (status == STATUS_OK) status = pool_create(&p->pool, thread_processors() < ground_kinds ? thread_processors() : ground_kinds);
    if (status == STATUS_OK && !(p->arena = arena_create())) status = STATUS_NO_MEMORY;
    if (status != STATUS_OK) {
        heat_probe_close(p);
        return status;
    }
    p->drive.course = p->course;
    p->drive.source = (AirSource){p->atmosphere, p->planck[0], p->planck[1], 0};
    *state = p;
    return STATUS_OK;
}

/* The heat of the day of a time. */
static Status warm(HeatProbe *p, double unix_s)
{
    const double east_s = day_s * p->drive.place.lon_rad / (2 * pi_rad), begin_s = floor((unix_s + east_s) / day_s) * day_s - east_s;
    if (p->heat && p->drive.exercise_s == begin_s) return STATUS_OK;
    heat_destroy(p->heat);
    p->heat = NULL;
    p->drive.exercise_s = begin_s;
    HeatConfig config = heat_default_config();
    config.unix_s = begin_s, config.weather = heat_drive_weather, config.user = &p->drive, config.pool = p->pool;
    return heat_create(&p->heat, &p->kinds, &config, NULL, 0);
}

static double or_zero(const ProbeValue *value) { return isnan(value->number) ? 0 : value->number; }

static const char *balance(ProbeValue *out, const GroundColumn *ground, const GroundWeather *w, const GroundExposure *e)
{
    SurfaceFlux  flux;
    const double surface_k = ground->state.temp_k[0];
    ground_flux(&flux, ground, w, e);
    out[1].number = w->air.temp_k;
    out[2].number = flux.absorbed_w_m2;
    out[3].number = w->direct_w_m2;
    out[4].number = w->diffuse_w_m2;
    out[5].number = w->longwave_w_m2;
    out[6].number = surface_film_w_m2k(&flux, surface_k);
    out[7].number = surface_latent_w_m2(&flux, surface_k);
    return NULL;
}

const char *heat_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    static const double least_s = -2208988800, most_s = 4102444800; /* 1900, 2100 */
    HeatProbe   *p = state;
    const double unix_s = in[0].number, slope_deg = or_zero(&in[2]), aspect_rad = or_zero(&in[3]) * rad_per_deg;
    const double shade = or_zero(&in[4]), depth_m = or_zero(&in[5]);
    const int    kind = ground_kind_find(in[1].text);
    if (!(unix_s >= least_s && unix_s < most_s)) return "unix_s must be a time in 1900 .. 2100";
    if (kind < 0) return "surface is no row of etc/ground_heat.csv";
    if (!(slope_deg >= 0 && slope_deg <= 90)) return "slope_deg must be in 0 .. 90";
    if (!(fabs(aspect_rad) <= 4 * pi_rad)) return "aspect_deg must be within 720";
    if (!(shade >= 0 && shade <= 1)) return "shade must be in 0 .. 1";
    if (depth_m != 0 && (slope_deg != 0 || shade != 0)) return "depth_m is of level ground in the open: slope_deg and shade must be 0";

    HeatNow      *now;
    GroundColumn  ground;
    GroundWeather w;
    arena_reset(p->arena);
    if (warm(p, unix_s) != STATUS_OK || heat_now(&now, p->heat, unix_s, p->arena) != STATUS_OK) return "out of memory";
    heat_level(&ground, p->heat, kind, now->share);
    const double bottom_m = ground.column->depth_m[ground.column->nodes - 1];
    if (!(depth_m >= 0 && depth_m <= bottom_m)) {
        snprintf(out[0].buffer, sizeof out[0].buffer, "depth_m must be in 0 .. %.4g", bottom_m);
        return out[0].buffer;
    }
    const double   slope_rad = slope_deg * rad_per_deg;
    GroundExposure e = {{sin(slope_rad) * sin(aspect_rad), sin(slope_rad) * cos(aspect_rad), cos(slope_rad)}, 1 - shade, 1,
                        ground.state.temp_k[0]};
    const double surface_k = heat_ground_k(now, kind, e.n_enu, shade, 1, 1);
    out[0].number = depth_m > 0 ? column_temp_k(&ground.state, ground.column, depth_m) : surface_k;
    ground.state.temp_k[0] = surface_k; /* its water is that of level ground */
    heat_drive_weather(&w, unix_s, &p->drive);
    return balance(out, &ground, &w, &e);
}
