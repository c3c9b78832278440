/* render/probe_wall.c: `pitviper probe heat-wall`: walls and roofs of etc/constructions.csv for rows of CSV, as frames
 * have them, without a scene.
 * Rows of one construction, material and day in the order
 * of time are answered without starting again. */
#include "render/probe_day_private.h"

#include <stdlib.h>

typedef struct WallProbe {
    ProbeDay      day;
    Constructions constructions;
    SceneryHeat  *heat; /* of the day of day.drive.exercise_s, and: */
    int           construction, material;
} WallProbe;

void wall_probe_close(void *state)
{
    WallProbe *p = state;
    scenery_heat_destroy(p->heat);
    probe_day_close(&p->day);
    free(p);
}

Status wall_probe_open(void **state, int argc, char **argv)
{
    WallProbe *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    Status status = probe_day_open(&p->day, argc, argv);
    if (status == STATUS_OK) status = constructions_open_etc(&p->constructions);
    if (status == STATUS_OK) *state = p;
    else wall_probe_close(p);
    return status;
}

/* The wall of the day of a time. */
static Status warm(WallProbe *p, double unix_s, int construction, int material)
{
    HeatDrive   *drive = &p->day.drive;
    const double begin_s = probe_midnight_s(unix_s, drive->place.lon_rad);
    if (p->heat && drive->exercise_s == begin_s && p->construction == construction && p->material == material)
        return STATUS_OK;
    scenery_heat_destroy(p->heat);
    p->heat = NULL;
    drive->exercise_s = begin_s, p->construction = construction, p->material = material;
    SceneryHeatConfig c = scenery_heat_default_config();
    c.heat.unix_s = begin_s, c.heat.weather = world_heat_weather, c.heat.user = drive;
    c.east_rad = drive->place.lon_rad;
    c.ground = &p->day.ground, c.constructions = &p->constructions, c.materials = &p->day.materials;
    return scenery_heat_wall(&p->heat, &c, construction, material);
}

const char *wall_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    WallProbe   *p = state;
    const double unix_s = in[0].number, tilt_deg = isnan(in[3].number) ? 90 : in[3].number,
                 aspect_rad = isnan(in[4].number) ? 0 : in[4].number * rad_per_deg,
                 shade = isnan(in[5].number) ? 0 : in[5].number;
    const int construction = constructions_named(&p->constructions, in[1].text),
              material = materials_find(&p->day.materials, in[2].text);
    if (probe_time_fault(unix_s)) return probe_time_fault(unix_s);
    if (construction < 0) return "construction is no row of etc/constructions.csv";
    if (material < 0) return "material is no row of etc/materials.csv";
    if (!(tilt_deg >= 0 && tilt_deg <= 90)) return "tilt_deg must be in 0 .. 90";
    if (!(fabs(aspect_rad) <= 4 * pi_rad)) return "aspect_deg must be within 720";
    if (!(shade >= 0 && shade <= 1)) return "shade must be in 0 .. 1";

    SceneryTemps *temps;
    WallSeen      seen;
    const double  tilt_rad = tilt_deg * rad_per_deg;
    const double  n_enu[3] = {sin(tilt_rad) * sin(aspect_rad), sin(tilt_rad) * cos(aspect_rad), cos(tilt_rad)};
    arena_reset(p->day.arena);
    if (warm(p, unix_s, construction, material) != STATUS_OK ||
        scenery_temps_at(&temps, p->heat, unix_s, p->day.arena) != STATUS_OK)
        return "out of memory";
    scenery_wall_seen(&seen, temps, n_enu, shade);
    const double number[] = {seen.temp_k,       seen.behind_k,      seen.air_k,
                             seen.ground_k,     seen.absorbed_w_m2, seen.direct_w_m2,
                             seen.diffuse_w_m2, seen.longwave_w_m2, seen.film_w_m2k};
    for (size_t k = 0; k < sizeof number / sizeof *number; k++) out[k].number = number[k];
    return NULL;
}
