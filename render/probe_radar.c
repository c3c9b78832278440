/* render/probe_radar.c: `pitviper probe propagation`, `radar-equation`, `rcs`, `clutter` and `clutter-cell`: radio
 * waves through air, the radar equation, a target's scattered field, and ground clutter, for rows of CSV. */
#include "render/probe_private.h"
#include "render/scattering/paths/attenuation.h"
#include "render/scattering/paths/radar_path.h"
#include "render/scattering/signatures/given_signature.h"
#include "render/scattering/field/radar_model.h"
#include "render/scattering/field/total_field.h"
#include "render/scattering/clutter/clutter.h"

#include <stdlib.h>

/* ---- propagation --------------------------------------------------------------------------------- */

typedef struct PropagationProbe {
    Atmosphere *atmosphere;
    GasLines    lines;
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
    in_f,
    in_from,
    in_to,
    in_range,
    in_temp,
    in_pressure,
    in_humidity,
    in_rain,
    in_tilt,
    in_visibility,
    in_fog_top,
    in_cloud_low,
    in_cloud_high,
    in_cloud
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
    GasState       state;
    GasAttenuation gas;
    double         g_m3 = 0;
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
    const RadarPath         path = {.a_m = in[in_from].number,
                                    .b_m = in[in_to].number,
                                    .range_m = in[in_range].number,
                                    .f_ghz = in[in_f].number,
                                    .tilt_rad = or_else(in[in_tilt].number, 0) * rad_per_deg};
    RadarAir                air;
    RadarLoss               loss;
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
    const double    gain = of_db(in[1].number), loss_db = or_else(in[7].number, 0);
    const RadarLink link = {.transmitted_w = in[0].number,
                            .transmit_gain = gain,
                            .receive_gain = gain,
                            .wavelength_m = 299792458.0 / (1e9 * in[2].number),
                            .range_m = in[4].number,
                            .loss = of_db(loss_db)};
    const double    received_w = radar_received_w(&link, of_db(in[3].number));
    const double    noise_w = radar_noise_w(in[5].number, of_db(in[6].number));
    if (isnan(received_w)) return "power_w, frequency_ghz and range_m must be above 0, loss_db at least 0";
    if (isnan(noise_w)) return "bandwidth_hz must be above 0, noise_figure_db at least 0";
    out[0].number = 10 * log10(received_w);
    out[1].number = 10 * log10(noise_w);
    out[2].number = out[0].number - out[1].number;
    return NULL;
}

/* ---- rcs: the scattered field of a target ------------------------------------------------------- */

typedef struct RcsProbe {
    RadarMaterials  materials;
    Pool           *pool;
    RadarModel     *model; /* of the last row; NULL: none */
    GivenSignature *given; /* likewise, of a target given:FILE */
    char            name[512];
    double          sag_m;
    TotalField      field;
} RcsProbe;

static void drop_model(RcsProbe *p)
{
    if (p->model) radar_model_close(p->model);
    free(p->model);
    p->model = NULL;
    given_signature_close(p->given);
    p->given = NULL;
}

void rcs_probe_close(void *state)
{
    RcsProbe *p = state;
    drop_model(p);
    total_field_free(&p->field);
    pool_destroy(p->pool);
    radar_materials_close(&p->materials);
    free(p);
}

Status rcs_probe_open(void **state, int argc, char **argv)
{
    (void)argv;
    if (argc > 1) {
        log_error("rcs: usage: probe rcs: it takes no arguments");
        return STATUS_BAD_VALUE;
    }
    RcsProbe *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    Status status = radar_materials_load(&p->materials);
    if (status == STATUS_OK) status = pool_create(&p->pool, thread_processors());
    if (status == STATUS_OK) *state = p;
    else rcs_probe_close(p);
    return status;
}

/* The target of a row; that of the row before where it is the same and as fine as it must be. */
static const char *take_model(RcsProbe *p, const char *name, double sag_m)
{
    const char *given = given_signature_path(name);
    if ((p->given || (p->model && p->sag_m == sag_m)) && strcmp(p->name, name) == 0) return NULL;
    drop_model(p);
    if (snprintf(p->name, sizeof p->name, "%s", name) >= (int)sizeof p->name) return "the target's name is too long";
    p->sag_m = sag_m;
    if (given)
        return given_signature_open(&p->given, given) == STATUS_OK ? NULL
                                                                   : "no such signature, or it is broken (see the log)";
    p->model = calloc(1, sizeof *p->model);
    if (!p->model) return "out of memory";
    if (radar_model_open(p->model, name, &p->materials, sag_m) == STATUS_OK) return NULL;
    free(p->model);
    p->model = NULL;
    return "no such target, or it is broken (see the log)";
}

static const char *trace(ScatterMatrix *s, RcsProbe *p, const ScatterAntenna *tx, const ScatterAntenna *rx, double f_hz)
{
    TubeConfig config = tubes_default_config(f_hz);
    config.polygon_faces = polygon_faces_few;
    const Status status = total_field_trace(&p->field, p->model->target, tx, rx, &config, true, p->pool);
    if (status == STATUS_NO_MEMORY) return "out of memory";
    if (status != STATUS_OK) return "too near or too large (see the log)";
    return total_field_sweep(s, &(FrequencySweep){.count = 1, .first_hz = f_hz}, &p->field, p->pool) == STATUS_OK
               ? NULL
               : "out of memory";
}

static const char *look_up(ScatterMatrix *s, const RcsProbe *p, const ScatterAntenna *antenna, double f_hz,
                           bool bistatic)
{
    if (bistatic) return "a given signature is monostatic: leave rx_az_deg and rx_el_deg empty";
    if (!given_signature_knows(p->given, antenna, f_hz))
        return "the given signature ends before this look and frequency";
    given_signature_field(s, p->given, antenna, f_hz);
    return NULL;
}

const char *rcs_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    RcsProbe      *p = state;
    ScatterAntenna tx, rx;
    ScatterMatrix  s;
    const double   f_hz = in[1].number * 1e9, range_m = isnan(in[4].number) ? INFINITY : in[4].number;
    const bool     bistatic = !isnan(in[5].number) || !isnan(in[6].number);
    if (!(f_hz >= 1e8 && f_hz <= 3e11)) return "f_ghz must be in 0.1 .. 300";
    if (!(fabs(in[2].number) <= 720 && fabs(in[3].number) <= 90)) return "az_deg must be within 720, el_deg within 90";
    if (!(range_m > 0)) return "range_m must be above 0";
    if (bistatic && !(fabs(in[5].number) <= 720 && fabs(in[6].number) <= 90))
        return "rx_az_deg must be within 720 and rx_el_deg within 90, or both empty";
    const char *wrong = take_model(p, in[0].text, radar_sag_m(f_hz));
    if (wrong) return wrong;
    radar_look(&tx, in[2].number * rad_per_deg, in[3].number * rad_per_deg, range_m);
    rx = tx;
    if (bistatic) radar_look(&rx, in[5].number * rad_per_deg, in[6].number * rad_per_deg, range_m);
    wrong = p->given ? look_up(&s, p, &tx, f_hz, bistatic) : trace(&s, p, &tx, &rx, f_hz);
    if (wrong) return wrong;
    const double complex value[4] = {s.hh, s.hv, s.vh, s.vv};
    for (int i = 0; i < 4; i++) {
        out[i].number = value[i] == 0 ? NAN : rcs_dbsm(value[i]);
        out[4 + 2 * i].number = creal(value[i]);
        out[5 + 2 * i].number = cimag(value[i]);
    }
    return NULL;
}

/* ---- clutter and clutter-cell: ground clutter's table and its cells ----------------------------- */

Status clutter_probe_open(void **state, int argc, char **argv)
{
    char path[1024];
    (void)argc, (void)argv;
    if (!etc_path(path, sizeof path, "radar/clutter.csv")) {
        log_error("probe: path of the tables is too long; set PITVIPER_ETC to a shorter one");
        return STATUS_BAD_VALUE;
    }
    ClutterTable *table = malloc(sizeof *table);
    if (!table) return STATUS_NO_MEMORY;
    const Status status = clutter_table_open(table, path);
    if (status == STATUS_OK) *state = table;
    else free(table);
    return status;
}

void clutter_probe_close(void *state) { free(state); }

/* surface$, frequency_ghz, grazing_deg: the first columns of both. */
static const char *find_row(SurfaceClass *surface, ClutterBand *band, const ProbeValue *in)
{
    *surface = surface_find(in[0].text);
    if (*surface == SURFACE_NONE) return "surface is no class of etc/surfaces.csv";
    if (!clutter_band_of(band, 1e9 * in[1].number)) return "frequency_ghz must be in 12 .. 18, 27 .. 40 or 75 .. 110";
    if (!(in[2].number > 0 && in[2].number <= 90)) return "grazing_deg must be above 0 and at most 90";
    return NULL;
}

static double db(double ratio) { return 10 * log10(ratio); }

const char *clutter_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    const ClutterTable *table = state;
    SurfaceClass        surface;
    ClutterBand         band;
    const char         *why = find_row(&surface, &band, in);
    if (why) return why;
    const double wind_mps = or_else(in[3].number, 0), depth_m = or_else(in[4].number, 1);
    if (!(wind_mps >= 0 && wind_mps <= 100)) return "wind_mps must be in 0 .. 100";
    if (!(depth_m >= 0 && depth_m <= 400)) return "depth_m must be in 0 .. 400";

    const ClutterRow   *row = &table->row[surface][band];
    const double        frequency_hz = 1e9 * in[1].number, wavelength_m = light_mps / frequency_hz;
    const double        sigma0 = clutter_sigma0(row, in[2].number * rad_per_deg, wavelength_m);
    const ClutterMotion motion = clutter_motion(row, frequency_hz, wind_mps);
    out[0].number = db(sigma0);
    out[1].number = db(sigma0 * row->hh);
    out[2].number = db(sigma0 * row->hv);
    out[3].number = row->rho;
    out[4].number = isinf(row->nu) ? 0 : row->nu;
    out[5].number = row->texture_m;
    out[6].number = motion.still;
    out[7].number = motion.spread_mps;
    out[8].number = 2 * sqrt(2) * motion.spread_mps / wavelength_m; /* rms of exp(-|v| / spread): sqrt(2) spread */
    out[9].number = clutter_foliage_db(row, depth_m);
    out[10].number = clutter_foliage_volume(row);
    return NULL;
}

const char *clutter_cell_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    enum { across = 4, count = across * across };
    const ClutterTable *table = state;
    SurfaceClass        surface;
    ClutterBand         band;
    const char         *why = find_row(&surface, &band, in);
    if (why) return why;
    const double side_m = or_else(in[5].number, 1), psi = in[2].number * rad_per_deg;
    const double azimuth = or_else(in[6].number, 0) * rad_per_deg;
    const double seed = or_else(in[9].number, 0);
    ClutterLook  look = {
         .frequency_hz = 1e9 * in[1].number, .wind_mps = or_else(in[7].number, 0), .t_s = or_else(in[8].number, 0)};
    if (!(fabs(in[3].number) <= 1e6 && fabs(in[4].number) <= 1e6)) return "x_m and y_m must be within 1e6 of 0";
    if (!(side_m >= 0.01 && side_m <= 1e4)) return "side_m must be in 0.01 .. 10000";
    if (!(look.wind_mps >= 0 && look.wind_mps <= 100)) return "wind_mps must be in 0 .. 100";
    if (!(fabs(look.t_s) <= 1e9)) return "t_s must be within 1e9 of 0";
    if (!(seed >= 0 && seed <= 1e15)) return "seed must be in 0 .. 1e15";

    const ClutterGrid    grid = {side_m / across, (uint64_t)seed};
    const ScatterAntenna antenna = {{cos(psi) * sin(azimuth), cos(psi) * cos(azimuth), sin(psi)}, INFINITY};
    const double         k = 2 * pi_rad * look.frequency_hz / light_mps;
    const int            x0 = across * (int)floor(in[3].number / side_m);
    const int            y0 = across * (int)floor(in[4].number / side_m);
    ClutterCell          cell[count];
    ClutterScatterer     scatterer[count];
    ScatterMatrix        seen[count], sum = {0};
    uint8_t              kind[count];
    double               p[3][count];
    float                n[3][count];
    for (int i = 0; i < count; i++) {
        double place[2];
        cell[i] = (ClutterCell){x0 + i % across, y0 + i / across, 0};
        clutter_place(place, &grid, &cell[i]);
        p[0][i] = place[0], p[1][i] = place[1], p[2][i] = 0;
        n[0][i] = n[1][i] = 0, n[2][i] = 1;
        kind[i] = (uint8_t)surface;
    }
    clutter_draw(scatterer, &grid, table, band, count, cell, kind);
    const ClutterGround ground = {count, cell, kind, {p[0], p[1], p[2]}, {n[0], n[1], n[2]}};
    const double        far_m = 1e12;
    const double        middle[2] = {(x0 + 0.5 * across) * grid.side_m, (y0 + 0.5 * across) * grid.side_m};
    for (int a = 0; a < 3; a++) look.antenna_enu[a] = far_m * antenna.u[a];
    clutter_see(seen, &grid, table, scatterer, &ground, &look);
    for (int i = 0; i < count; i++) {
        const double         from_middle[3] = {p[0][i] - middle[0], p[1][i] - middle[1], 0};
        double               u[3];
        const double complex turn = cexp(-I * k * 2 * scatter_path(u, &antenna, from_middle));
        sum.vv += seen[i].vv * turn, sum.hh += seen[i].hh * turn, sum.hv += seen[i].hv * turn;
    }
    const double complex s[3] = {sum.vv, sum.hh, sum.hv};
    for (int i = 0; i < 3; i++) out[2 * i].number = creal(s[i]), out[2 * i + 1].number = cimag(s[i]);
    const double sigma0 = clutter_sigma0(&table->row[surface][band], psi, light_mps / look.frequency_hz);
    out[6].number =
        4 * pi_rad * (creal(sum.vv) * creal(sum.vv) + cimag(sum.vv) * cimag(sum.vv)) / (sigma0 * side_m * side_m);
    return NULL;
}
