/* render/probe_radar.c: `pitviper probe propagation` and `radar-equation`: radio waves through air, and echoes. */
#include "render/probe_private.h"

#include "render/radar/cloud_attenuation.h"
#include "render/radar/radar_equation.h"
#include "render/radar/radar_path.h"
#include "render/radar/rain_attenuation.h"

#include <stdlib.h>

/* ---- propagation --------------------------------------------------------------------------------- */

typedef struct PropagationProbe {
    Atmosphere *atmosphere;
    GasLines lines;
} PropagationProbe;

void propagation_probe_close(void *state)
{
    PropagationProbe *p = state;
    atmosphere_close(p->atmosphere);
    free(p);
}

Status propagation_probe_open(void **state, int argc, char **argv)
{
    if (argc > 2) {
        log_error("propagation: usage: probe propagation [MODEL]: a model of etc/atmosphere");
        return STATUS_BAD_VALUE;
    }
    PropagationProbe *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    Status status = gas_lines_read(&p->lines, NULL, NULL);
    if (status == STATUS_OK) status = atmosphere_open_at(&p->atmosphere, argc > 1 ? argv[1] : "us1976", 23000);
    if (status == STATUS_OK) *state = p;
    else propagation_probe_close(p);
    return status;
}

static double or_else(double given, double otherwise) { return isnan(given) ? otherwise : given; }

/* Columns of a row. */
enum {
    in_f, in_from, in_to, in_range, in_temp, in_pressure, in_humidity, in_rain, in_tilt, in_visibility, in_fog_top,
    in_cloud_low, in_cloud_high, in_cloud
};

static const char *air_of_row(RadarAir *air, const PropagationProbe *p, const ProbeValue *in)
{
    Weather weather = weather_default();
    weather.air_temp_k = in[in_temp].number; /* NaN: the model's */
    weather.pressure_mbar = or_else(in[in_pressure].number, weather.pressure_mbar);
    weather.humidity = or_else(in[in_humidity].number, weather.humidity);
    weather.rain_mm_h = or_else(in[in_rain].number, 0);
    if (!isnan(weather.air_temp_k) && !(weather.air_temp_k >= 220 && weather.air_temp_k <= 330))
        return "air_temp_k must be in 220 .. 330";
    if (!(weather.pressure_mbar >= 300 && weather.pressure_mbar <= 1100)) return "pressure_mbar must be in 300 .. 1100";
    if (!(weather.humidity >= 0 && weather.humidity <= 1)) return "humidity must be in 0 .. 1";
    if (!(weather.rain_mm_h >= 0 && weather.rain_mm_h <= 300)) return "rain_mm_h must be in 0 .. 300";
    if (radar_air_of(air, p->atmosphere, &weather) != STATUS_OK) return "this air is out of the range of P.676";

    const double visibility_m = or_else(in[in_visibility].number, INFINITY),
                 cloud_g_m3 = or_else(in[in_cloud].number, 0);
    if (!(visibility_m >= 10)) return "visibility_m must be at least 10";
    air->liquid[0] = (RadarLiquid){0, or_else(in[in_fog_top].number, INFINITY), fog_liquid_g_m3(visibility_m)};
    if (!(air->liquid[0].high_m > 0)) return "fog_top_m must be above 0";
    if (!(cloud_g_m3 >= 0 && cloud_g_m3 <= 10)) return "cloud_g_m3 must be in 0 .. 10";
    if (!(cloud_g_m3 > 0)) return NULL;
    air->liquid[1] = (RadarLiquid){in[in_cloud_low].number, in[in_cloud_high].number, cloud_g_m3};
    return air->liquid[1].low_m >= 0 && air->liquid[1].low_m < air->liquid[1].high_m
               ? NULL
               : "a cloud needs cloud_low_m, from 0 on, below cloud_high_m";
}

/* Per km, at the near end. */
static void specific(ProbeValue out[4], const PropagationProbe *p, const RadarAir *air, const RadarPath *path,
                     double elevation_rad)
{
    GasState state;
    GasAttenuation gas;
    double g_m3 = 0;
    radar_air_at(&state, air, path->a_m);
    gas_attenuation(&gas, &p->lines, path->f_ghz, &state);
    for (int i = 0; i < radar_air_liquids; i++)
        if (path->a_m >= air->liquid[i].low_m && path->a_m < air->liquid[i].high_m) g_m3 += air->liquid[i].g_m3;
    out[0].number = gas.dry_db_km;
    out[1].number = gas.wet_db_km;
    out[2].number = path->a_m < air->rain_top_m && air->rain_mm_h > 0
                        ? rain_attenuation(path->f_ghz, air->rain_mm_h, elevation_rad, path->tilt_rad)
                        : 0;
    out[3].number =
        g_m3 > 0 && state.temp_k >= radar_frozen_k ? g_m3 * cloud_attenuation(path->f_ghz, state.temp_k) : 0;
}

const char *propagation_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    const PropagationProbe *p = state;
    const RadarPath path = {.a_m = in[in_from].number,
                            .b_m = in[in_to].number,
                            .range_m = in[in_range].number,
                            .f_ghz = in[in_f].number,
                            .tilt_rad = or_else(in[in_tilt].number, 0) * rad_per_deg};
    RadarAir air;
    RadarLoss loss;
    if (!(path.f_ghz >= 1 && path.f_ghz <= 1000)) return "frequency_ghz must be in 1 .. 1000";
    if (!(path.a_m >= 0 && path.a_m <= 20000 && path.b_m >= 0 && path.b_m <= 20000))
        return "heights must be in 0 .. 20000 m";
    /* a range rounded to print may fall short of a vertical path by its last digit */
    if (!(path.range_m > 0 && path.range_m <= 1e6 && path.range_m >= 0.9999 * fabs(path.a_m - path.b_m)))
        return "range_m must be above 0, at most 1e6 and at least the difference of the heights";
    if (!(fabs(path.tilt_rad) <= 2 * pi_rad)) return "tilt_deg must be within 360";
    const char *why = air_of_row(&air, p, in);
    if (why) return why;
    radar_path_loss(&loss, &path, &p->lines, &air);
    if (isnan(loss.liquid_db)) return "fog and cloud: frequency_ghz must be in 1 .. 200";
    const double complex factor = radar_path_factor(&loss);
    out[0].number = loss.dry_db + loss.wet_db;
    out[1].number = loss.rain_db;
    out[2].number = loss.liquid_db;
    out[3].number = 2 * radar_loss_db(&loss);
    out[4].number = cabs(factor);
    out[5].number = -2 * loss.dispersion_rad;
    specific(out + 6, p, &air, &path, asin(clamp((path.b_m - path.a_m) / path.range_m, -1, 1)));
    out[10].number = air.rain_top_m;
    out[11].number = air.vapour_g_m3;
    out[12].number = air.liquid[0].g_m3;
    return NULL;
}

/* ---- radar equation ------------------------------------------------------------------------------- */

static double of_db(double db) { return pow(10, 0.1 * db); }

const char *radar_equation_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    (void)state;
    for (int i = 0; i < 8; i++)
        if (fabs(in[i].number) > (i == 0 || i == 4 || i == 5 ? 1e15 : i == 2 ? 1e6 : 300))
            return "a value is beyond all radars";
    const double gain = of_db(in[1].number), loss_db = or_else(in[7].number, 0);
    const RadarLink link = {.transmitted_w = in[0].number,
                            .transmit_gain = gain,
                            .receive_gain = gain,
                            .wavelength_m = 299792458.0 / (1e9 * in[2].number),
                            .range_m = in[4].number,
                            .loss = of_db(loss_db)};
    const double received_w = radar_received_w(&link, of_db(in[3].number));
    const double noise_w = radar_noise_w(in[5].number, of_db(in[6].number));
    if (isnan(received_w)) return "power_w, frequency_ghz and range_m must be above 0, loss_db at least 0";
    if (isnan(noise_w)) return "bandwidth_hz must be above 0, noise_figure_db at least 0";
    out[0].number = 10 * log10(received_w);
    out[1].number = 10 * log10(noise_w);
    out[2].number = out[0].number - out[1].number;
    return NULL;
}
