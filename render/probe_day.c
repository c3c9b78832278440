/* render/probe_day.c: tables, air and weather of a place, for probes of heat. */
#include "render/probe_day_private.h"
#include "terrain/probe.h"

static Status open_tables(ProbeDay *day)
{
    char materials[512], surfaces[512], ground[512];
    if (!etc_path(materials, sizeof materials, "materials.csv") ||
        !etc_path(surfaces, sizeof surfaces, "surfaces.csv") || !etc_path(ground, sizeof ground, "ground_heat.csv")) {
        log_error("probe: path of the tables is too long; set PITVIPER_ETC to a shorter one");
        return STATUS_BAD_VALUE;
    }
    Status status = materials_open(&day->materials, materials, surfaces, NULL);
    if (status == STATUS_OK) status = ground_kinds_open(&day->ground, ground, &day->materials);
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        const SpectralBand band = channel_band((ChannelPlace)(SPECTRAL_MWIR + k));
        status = planck_table_seen(&day->planck[k], &band);
    }
    if (status == STATUS_OK) status = atmosphere_open(&day->atmosphere, "us1976");
    return status;
}

Status probe_day_open(ProbeDay *day, int argc, char **argv)
{
    Status status = probe_weather(&day->course, &day->drive.place, argc, argv);
    if (status == STATUS_OK) status = open_tables(day);
    if (status == STATUS_OK && !(day->arena = arena_create())) status = STATUS_NO_MEMORY;
    day->drive.course = day->course;
    day->drive.source = (AirSource){day->atmosphere, day->planck[0], day->planck[1], 0, day->drive.place.h_m};
    return status;
}

void probe_day_close(ProbeDay *day)
{
    arena_destroy(day->arena);
    weather_course_close(day->course);
    atmosphere_close(day->atmosphere);
    for (int k = 0; k < 2; k++) planck_table_destroy(day->planck[k]);
    materials_close(&day->materials);
    *day = (ProbeDay){0};
}

double probe_midnight_s(double unix_s, double lon_rad)
{
    static const double day_s = 86400;
    const double        east_s = day_s * lon_rad / (2 * pi_rad);
    return floor((unix_s + east_s) / day_s) * day_s - east_s;
}

const char *probe_time_fault(double unix_s)
{
    static const double least_s = -2208988800, most_s = 4102444800; /* 1900, 2100 */
    return unix_s >= least_s && unix_s < most_s ? NULL : "unix_s must be a time in 1900 .. 2100";
}
