/* render/probe_wall.c: `pitviper probe heat-wall`: walls and roofs of etc/constructions.csv for rows of CSV, as frames
 * have them, without a scene.
 *
 * Each local day (by the sun's mean time at the place) is an exercise of its own, warmed up over the two days before
 * its midnight, so that a row's answer depends on no other row. Rows of one construction, material and day in the order
 * of time are answered without starting again. */
#include "render/probe_private.h"
#include "render/frame/world.h"
#include "terrain/probe.h"

#include <stdlib.h>

typedef struct WallProbe {
    Materials      materials;
    GroundKinds    ground;
    Constructions  constructions;
    PlanckTable   *planck[2];
    Atmosphere    *atmosphere;
    WeatherCourse *course;
    HeatDrive      drive;
    Arena         *arena;
    SceneryHeat   *heat; /* of the day of drive.exercise_s, and: */
    int            construction, material;
} WallProbe;

static const double day_s = 86400;

void wall_probe_close(void *state)
{
    WallProbe *p = state;
    scenery_heat_destroy(p->heat);
    arena_destroy(p->arena);
    weather_course_close(p->course);
    atmosphere_close(p->atmosphere);
    for (int k = 0; k < 2; k++) planck_table_destroy(p->planck[k]);
    materials_close(&p->materials);
    free(p);
}

static Status open_tables(WallProbe *p)
{
    static const char *const file[] = {"materials.csv", "surfaces.csv", "ground_heat.csv", "constructions.csv",
                                       "construction_layers.csv"};
    char                     path[5][512];
    for (int k = 0; k < 5; k++)
        if (!etc_path(path[k], sizeof path[k], file[k])) {
            log_error("probe: path of the tables is too long; set PITVIPER_ETC to a shorter one");
            return STATUS_BAD_VALUE;
        }
    Status status = materials_open(&p->materials, path[0], path[1], NULL);
    if (status == STATUS_OK) status = ground_kinds_open(&p->ground, path[2], &p->materials);
    if (status == STATUS_OK) status = constructions_open(&p->constructions, path[3], path[4]);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        const SpectralBand band = channel_band((ChannelPlace)(SPECTRAL_MWIR + k));
        status = planck_table_seen(&p->planck[k], &band);
    }
    if (status == STATUS_OK) status = atmosphere_open(&p->atmosphere, "us1976");
    return status;
}

Status wall_probe_open(void **state, int argc, char **argv)
{
    WallProbe *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    Status status = probe_weather(&p->course, &p->drive.place, argc, argv);
    if (status == STATUS_OK) status = open_tables(p);
    if (status == STATUS_OK && !(p->arena = arena_create())) status = STATUS_NO_MEMORY;
    if (status != STATUS_OK) {
        wall_probe_close(p);
        return status;
    }
    p->drive.course = p->course;
    p->drive.source = (AirSource){p->atmosphere, p->planck[0], p->planck[1], 0, p->drive.place.h_m};
    *state = p;
    return STATUS_OK;
}

/* The wall of the day of a time. */
static Status warm(WallProbe *p, double unix_s, int construction, int material)
{
    const double east_s = day_s * p->drive.place.lon_rad / (2 * pi_rad),
                 begin_s = floor((unix_s + east_s) / day_s) * day_s - east_s;
    if (p->heat && p->drive.exercise_s == begin_s && p->construction == construction && p->material == material)
        return STATUS_OK;
    scenery_heat_destroy(p->heat);
    p->heat = NULL;
    p->drive.exercise_s = begin_s, p->construction = construction, p->material = material;
    SceneryHeatConfig c = scenery_heat_default_config();
    c.heat.unix_s = begin_s, c.heat.weather = world_heat_weather, c.heat.user = &p->drive;
    c.east_rad = p->drive.place.lon_rad;
    c.ground = &p->ground, c.constructions = &p->constructions, c.materials = &p->materials;
    return scenery_heat_wall(&p->heat, &c, construction, material);
}

const char *wall_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    static const double least_s = -2208988800, most_s = 4102444800; /* 1900, 2100 */
    WallProbe          *p = state;
    const double        unix_s = in[0].number, tilt_deg = isnan(in[3].number) ? 90 : in[3].number,
                 aspect_rad = isnan(in[4].number) ? 0 : in[4].number * rad_per_deg,
                 shade = isnan(in[5].number) ? 0 : in[5].number;
    const int construction = constructions_named(&p->constructions, in[1].text),
              material = materials_find(&p->materials, in[2].text);
    if (!(unix_s >= least_s && unix_s < most_s)) return "unix_s must be a time in 1900 .. 2100";
    if (construction < 0) return "construction is no row of etc/constructions.csv";
    if (material < 0) return "material is no row of etc/materials.csv";
    if (!(tilt_deg >= 0 && tilt_deg <= 90)) return "tilt_deg must be in 0 .. 90";
    if (!(fabs(aspect_rad) <= 4 * pi_rad)) return "aspect_deg must be within 720";
    if (!(shade >= 0 && shade <= 1)) return "shade must be in 0 .. 1";

    SceneryTemps *temps;
    WallSeen      seen;
    const double  tilt_rad = tilt_deg * rad_per_deg;
    const double  n_enu[3] = {sin(tilt_rad) * sin(aspect_rad), sin(tilt_rad) * cos(aspect_rad), cos(tilt_rad)};
    arena_reset(p->arena);
    if (warm(p, unix_s, construction, material) != STATUS_OK ||
        scenery_temps_at(&temps, p->heat, unix_s, p->arena) != STATUS_OK)
        return "out of memory";
    scenery_wall_seen(&seen, temps, n_enu, shade);
    const double number[] = {seen.temp_k,       seen.behind_k,      seen.air_k,
                             seen.ground_k,     seen.absorbed_w_m2, seen.direct_w_m2,
                             seen.diffuse_w_m2, seen.longwave_w_m2, seen.film_w_m2k};
    for (size_t k = 0; k < sizeof number / sizeof *number; k++) out[k].number = number[k];
    return NULL;
}
