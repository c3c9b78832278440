/* render/probe_clutter.c: `pitviper probe clutter` and `clutter-cell`: ground clutter's table and its cells. */
#include "render/probe_private.h"

#include "render/radar/clutter.h"

#include <stdlib.h>

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
    if (status == STATUS_OK)
        *state = table;
    else
        free(table);
    return status;
}

void clutter_probe_close(void *state) { free(state); }

static double given(const ProbeValue *value, double otherwise)
{
    return isnan(value->number) ? otherwise : value->number;
}

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

static const double speed_of_light_mps = 299792458.0;

const char *clutter_probe_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    const ClutterTable *table = state;
    SurfaceClass        surface;
    ClutterBand         band;
    const char         *why = find_row(&surface, &band, in);
    if (why) return why;
    const double wind_mps = given(&in[3], 0), depth_m = given(&in[4], 1);
    if (!(wind_mps >= 0 && wind_mps <= 100)) return "wind_mps must be in 0 .. 100";
    if (!(depth_m >= 0 && depth_m <= 400)) return "depth_m must be in 0 .. 400";

    const ClutterRow   *row = &table->row[surface][band];
    const double        frequency_hz = 1e9 * in[1].number, wavelength_m = speed_of_light_mps / frequency_hz;
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
    const double side_m = given(&in[5], 1), azimuth = given(&in[6], 0) * rad_per_deg, psi = in[2].number * rad_per_deg;
    const double seed = given(&in[9], 0);
    ClutterLook  look = {.frequency_hz = 1e9 * in[1].number, .wind_mps = given(&in[7], 0), .t_s = given(&in[8], 0)};
    if (!(fabs(in[3].number) <= 1e6 && fabs(in[4].number) <= 1e6)) return "x_m and y_m must be within 1e6 of 0";
    if (!(side_m >= 0.01 && side_m <= 1e4)) return "side_m must be in 0.01 .. 10000";
    if (!(look.wind_mps >= 0 && look.wind_mps <= 100)) return "wind_mps must be in 0 .. 100";
    if (!(fabs(look.t_s) <= 1e9)) return "t_s must be within 1e9 of 0";
    if (!(seed >= 0 && seed <= 1e15)) return "seed must be in 0 .. 1e15";

    const ClutterGrid    grid = {side_m / across, (uint64_t)seed};
    const ScatterAntenna antenna = {{cos(psi) * sin(azimuth), cos(psi) * cos(azimuth), sin(psi)}, INFINITY};
    const double         k = 2 * pi_rad * look.frequency_hz / speed_of_light_mps;
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
        const double from_middle[3] = {p[0][i] - middle[0], p[1][i] - middle[1], 0};
        double       u[3];
        const double complex turn = cexp(-I * k * 2 * scatter_path(u, &antenna, from_middle));
        sum.vv += seen[i].vv * turn, sum.hh += seen[i].hh * turn, sum.hv += seen[i].hv * turn;
    }
    const double complex s[3] = {sum.vv, sum.hh, sum.hv};
    for (int i = 0; i < 3; i++) out[2 * i].number = creal(s[i]), out[2 * i + 1].number = cimag(s[i]);
    const double sigma0 = clutter_sigma0(&table->row[surface][band], psi, speed_of_light_mps / look.frequency_hz);
    out[6].number = 4 * pi_rad * (creal(sum.vv) * creal(sum.vv) + cimag(sum.vv) * cimag(sum.vv)) /
                    (sigma0 * side_m * side_m);
    return NULL;
}
