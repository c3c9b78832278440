/* terrain/probe.c: the probes of terrain: geodesy, geoid, sun and weather, one row at a time. */
#include "terrain/probe.h"

#include "terrain/earth/refraction.h"
#include "terrain/earth/geoid.h"
#include "terrain/earth/geodesy.h"
#include "terrain/earth/sun.h"

#include <stdlib.h>

static bool place_of(Geodetic *out, double lat_deg, double lon_deg, double h_m)
{
    *out = (Geodetic){lat_deg * rad_per_deg, lon_deg * rad_per_deg, h_m};
    return fabs(lat_deg) <= 90 && fabs(lon_deg) <= 360 && fabs(h_m) <= 1e8;
}

/* ---- sun ------------------------------------------------------------------------------------ */

static const char *sun_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    (void)state;
    double   unix_s;
    Geodetic place;
    Sun      sun;
    if (!text_to_unix_s(&unix_s, in[0].text)) return "utc must look like 2026-06-21T10:00:00Z, 1900 .. 2100";
    if (!place_of(&place, in[1].number, in[2].number, in[3].number))
        return "lat_deg within 90, lon_deg within 360, h_m within 1e8";
    if (sun_at(&sun, unix_s, &place, in[4].number, in[5].number, in[6].number) != STATUS_OK)
        return "pressure_mbar in 0 .. 1200, temp_c in -150 .. 100, delta_t_s within 1000";
    out[0].number = 90 - sun.elevation_rad / rad_per_deg;
    out[1].number = sun.azimuth_rad / rad_per_deg;
    out[2].number = sun.distance_au;
    return NULL;
}

/* ---- geoid ---------------------------------------------------------------------------------- */

static Status geoid_probe_open(void **state, int argc, char **argv)
{
    Geoid *geoid = calloc(1, sizeof *geoid);
    if (!geoid) return STATUS_NO_MEMORY;
    const Status status = geoid_open(geoid, argc > 1 ? argv[1] : NULL);
    if (status != STATUS_OK) {
        free(geoid);
        return status;
    }
    *state = geoid;
    return STATUS_OK;
}

static const char *geoid_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    Geodetic place;
    if (!place_of(&place, in[0].number, in[1].number, 0)) return "lat_deg within 90, lon_deg within 360";
    out[0].number = geoid_height_m(state, place.lat_rad, place.lon_rad);
    return isfinite(out[0].number) ? NULL : "the grid has no value there";
}

static void geoid_probe_close(void *state)
{
    geoid_close(state);
    free(state);
}

/* ---- geodesy -------------------------------------------------------------------------------- */

static const char *geodesy_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    (void)state;
    const double lat_deg = in[0].number, lon_deg = in[1].number, h_m = in[2].number;
    double       p_ecef[3] = {in[3].number, in[4].number, in[5].number};
    const int    geodetic = !isnan(lat_deg) + !isnan(lon_deg) + !isnan(h_m);
    const int    ecef = !isnan(p_ecef[0]) + !isnan(p_ecef[1]) + !isnan(p_ecef[2]);
    const int    origin = !isnan(in[6].number) + !isnan(in[7].number) + !isnan(in[8].number);
    Geodetic     place;
    if (!(geodetic == 3 && ecef == 0) && !(geodetic == 0 && ecef == 3))
        return "give lat_deg, lon_deg, h_m or x_m, y_m, z_m: all of one, none of the other";
    if (geodetic) {
        if (!place_of(&place, lat_deg, lon_deg, h_m) || ecef_from_geodetic(p_ecef, NULL, &place) != STATUS_OK)
            return "lat_deg within 90, lon_deg within 360, h_m within 1e8";
    } else if (geodetic_from_ecef(&place, p_ecef) != STATUS_OK) {
        return "x_m, y_m, z_m is not a valid position";
    }
    out[0].number = place.lat_rad / rad_per_deg;
    out[1].number = place.lon_rad / rad_per_deg;
    out[2].number = place.h_m;
    for (int k = 0; k < 3; k++) out[3 + k].number = p_ecef[k];
    if (origin == 0) return NULL;

    Geodetic   at;
    LocalFrame frame;
    double     p_enu[3];
    if (origin != 3 || !place_of(&at, in[6].number, in[7].number, in[8].number) ||
        local_frame_at(&frame, &at) != STATUS_OK)
        return "origin_lat_deg within 90, origin_lon_deg within 360, origin_h_m within 1e8: all or none";
    enu_from_ecef(p_enu, &frame, p_ecef);
    for (int k = 0; k < 3; k++) out[6 + k].number = p_enu[k];
    return NULL;
}

/* ---- weather -------------------------------------------------------------------------------- */

Status probe_weather(WeatherCourse **out, Geodetic *place, int argc, char **argv)
{
    static char         clear[] = "clear";
    WeatherCourseConfig config = {.base = weather_default(), .air_range_k = 10};
    double              lat_deg = 0, lon_deg = 0;
    if ((argc != 1 && argc != 2 && argc != 4) ||
        (argc == 4 && !(text_to_double(&lat_deg, argv[2]) && fabs(lat_deg) <= 90 && text_to_double(&lon_deg, argv[3]) &&
                        fabs(lon_deg) <= 360))) {
        log_error("probe: %s takes FILE, `clear` or `constant`, then LAT_DEG within 90 and LON_DEG within 360",
                  argv[0]);
        return STATUS_BAD_VALUE;
    }
    config.latitude_rad = lat_deg * rad_per_deg;
    config.longitude_rad = lon_deg * rad_per_deg;
    const Status status = weather_course_open(out, argc > 1 ? argv[1] : clear, &config);
    if (status != STATUS_OK) return status;
    log_info("weather: %s", weather_course_about(*out));
    *place = (Geodetic){.lat_rad = config.latitude_rad, .lon_rad = config.longitude_rad};
    return STATUS_OK;
}

static Status weather_probe_open(void **state, int argc, char **argv)
{
    WeatherCourse *course;
    Geodetic       place;
    const Status   status = probe_weather(&course, &place, argc, argv);
    if (status == STATUS_OK) *state = course;
    return status;
}

static const char *weather_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    Weather w;
    weather_at(&w, state, in[0].number);
    const double number[] = {w.air_temp_k,  w.humidity,     w.pressure_mbar, w.wind_mps, w.wind_from_rad / rad_per_deg,
                             w.direct_w_m2, w.diffuse_w_m2, w.longwave_w_m2, w.cloud,    w.rain_mm_h,
                             w.visibility_m};
    for (size_t i = 0; i < sizeof number / sizeof *number; i++) out[i].number = number[i];
    return NULL;
}

static void weather_probe_close(void *state) { weather_course_close(state); }

/* By parabolas: the sea sinks by d^2 / 2R, and a line of sight by bend d^2. */
static const char *horizon_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    static const double earth_m = 6371e3;
    const double        eye_m = in[0].number, range_m = in[1].number;
    (void)state;
    if (!(eye_m >= 0 && eye_m <= 1e6)) return "eye_m is 0 .. 1e6";
    if (range_m < 0) return "range_m is below 0";
    for (int band = REFRACTION_OPTICAL; band <= REFRACTION_RADAR; band++) {
        const double bend = refraction_bend((RefractionBand)band, eye_m, 0), flat = 0.5 / earth_m - bend;
        const double horizon_m = sqrt(eye_m / flat), beyond_m = fmax(range_m - horizon_m, 0);
        ProbeValue  *to = out + 4 * band;
        to[0].number = 2 * sqrt(flat * eye_m) / rad_per_deg;
        to[1].number = horizon_m;
        to[2].number = bend * range_m * range_m;
        to[3].number = isnan(range_m) ? NAN : flat * beyond_m * beyond_m;
    }
    return NULL;
}

const Probe terrain_probes[] = {
    {.name = "horizon",
     .help =
         "horizon at sea with refraction, of light and of radar: its dip and distance; how far air raises a thing at "
         "range_m, and how much of it the sea hides",
     .in = "eye_m,range_m?",
     .out = "dip_deg,horizon_m,raised_m,hidden_m,radar_dip_deg,radar_horizon_m,radar_raised_m,radar_hidden_m",
     .row = horizon_row},
    {.name = "sun",
     .help = "apparent place of the sun (ERFA; parallax and refraction as NREL SPA); delta_t_s: TT - UT1",
     .in = "utc$,lat_deg,lon_deg,h_m,pressure_mbar,temp_c,delta_t_s?",
     .out = "zenith_deg,azimuth_deg,distance_au",
     .row = sun_row},
    {.name = "geoid",
     .arguments = "[GRID.gtx]",
     .help = "height of the geoid above the ellipsoid (EGM96 of proj-data, cubic)",
     .in = "lat_deg,lon_deg",
     .out = "n_m",
     .open = geoid_probe_open,
     .row = geoid_row,
     .close = geoid_probe_close},
    {.name = "geodesy",
     .help = "WGS 84: geodetic to Earth-centred or back, and east, north, up about an origin (GeographicLib)",
     .in = "lat_deg?,lon_deg?,h_m?,x_m?,y_m?,z_m?,origin_lat_deg?,origin_lon_deg?,origin_h_m?",
     .out = "geodetic_lat_deg,geodetic_lon_deg,geodetic_h_m,ecef_x_m,ecef_y_m,ecef_z_m,east_m,north_m,up_m",
     .row = geodesy_row},
    {.name = "weather",
     .arguments = PROBE_WEATHER_ARGUMENTS,
     .help = "weather at a time: EPW, TMY3 or CSV file, or a clear day of 288.15 K on average with a range of 10 K",
     .in = "unix_s",
     .out = "air_temp_k,humidity,pressure_mbar,wind_mps,wind_from_deg,direct_w_m2,diffuse_w_m2,longwave_w_m2,cloud,"
            "rain_mm_h,visibility_m",
     .open = weather_probe_open,
     .row = weather_row,
     .close = weather_probe_close},
};
const int terrain_probe_count = sizeof terrain_probes / sizeof *terrain_probes;
