/* render/scattering/clutter/clutter_table.c: reads what the ground of each surface class sends back, and the forms
 * its figures go into. */
#include "render/scattering/clutter/clutter_table_private.h"

static const struct {
    const char *name;
    double      low_ghz, high_ghz;
} bands[CLUTTER_BAND_COUNT] = {{"Ku", 12, 18}, {"Ka", 27, 40}, {"W", 75, 110}};

const char *clutter_band_name(ClutterBand band) { return bands[band].name; }

bool clutter_band_of(ClutterBand *out, double frequency_hz)
{
    for (int b = 0; b < CLUTTER_BAND_COUNT; b++)
        if (frequency_hz >= 1e9 * bands[b].low_ghz && frequency_hz <= 1e9 * bands[b].high_ghz) {
            *out = (ClutterBand)b;
            return true;
        }
    return false;
}

/* ---- texture: quantiles of the gamma distribution ---------------------------------------------- */

static const double deviate_end = 8;

/* ln of P(a, x) (tail: of 1 - P), the regularised incomplete gamma function, and its derivative by ln x. By the
 * series below a + 1 and the continued fraction above: each where it converges fast, and in logarithms, so that
 * tails keep their digits. Source: Abramowitz and Stegun 6.5.29, 6.5.31. */
static double log_gamma_share(double *slope, double a, double log_x, bool tail)
{
    const double x = exp(log_x), front = a * log_x - x - lgamma(a);
    double       share;
    if (x < a + 1) {
        double sum = 1 / a, term = sum;
        for (int n = 1; n < 10000 && term > 1e-17 * sum; n++) sum += term *= x / (a + n);
        const double below = front + log(sum);
        share = tail ? log1p(-exp(below)) : below;
    } else {
        double b = x + 1 - a, c = 1e300, d = 1 / b, h = d; /* Lentz */
        for (int n = 1; n < 10000; n++) {
            const double an = -n * (n - a);
            b += 2;
            d = 1 / (an * d + b);
            c = b + an / c;
            h *= c * d;
            if (fabs(c * d - 1) < 1e-16) break;
        }
        const double above = front + log(h);
        share = tail ? above : log1p(-exp(above));
    }
    *slope = exp(front - share) * (tail ? -1 : 1);
    return share;
}

/* ln of the quantiles of mean 1 at normal deviates -8 .. 8, by Newton's method from one to the next. It cannot
 * miss: the logarithms of both tails are concave in ln x, and the first is begun from below, by the first term of
 * the series. Each from the smaller of the two tails: the larger has lost it. */
static void fill_texture(ClutterRow *row)
{
    double y = 0; /* ln(nu t) */
    for (int i = 0; i < clutter_texture_nodes; i++) {
        const double deviate = deviate_end * (2.0 * i / (clutter_texture_nodes - 1) - 1);
        const double want = log(0.5 * erfc(fabs(deviate) * 0.70710678118654752440));
        if (i == 0) y = (want + lgamma(row->nu + 1)) / row->nu;
        for (int n = 0; n < 100; n++) {
            double       slope;
            const double share = log_gamma_share(&slope, row->nu, y, deviate > 0);
            const double step = fmin((want - share) / slope, 1); /* not where exp(y) is infinite */
            y += step;
            if (fabs(step) < 1e-13 * (1 + fabs(y))) break;
        }
        row->texture[i] = (float)(y - log(row->nu));
    }
}

double clutter_texture(const ClutterRow *row, double deviate)
{
    if (isinf(row->nu)) return 1;
    const double at = (clamp(deviate / deviate_end, -1, 1) + 1) * (0.5 * (clutter_texture_nodes - 1));
    const int    i = at < clutter_texture_nodes - 2 ? (int)at : clutter_texture_nodes - 2;
    const double f = at - i;
    return exp((1 - f) * (double)row->texture[i] + f * (double)row->texture[i + 1]);
}

/* ---- reading --------------------------------------------------------------------------------------- */

typedef struct Column {
    const char *name;
    size_t      offset;
    double      low, high;
    bool        decibel; /* in the file; a ratio in the row */
    int         model;   /* rows of the other model may leave it empty; -1: rows of both may */
} Column;
static const Column columns[] = {
    {"gamma_db", offsetof(ClutterRow, gamma), -60, 20, true, CLUTTER_GAMMA},
    {"a", offsetof(ClutterRow, a), 1e-9, 1e3, false, CLUTTER_GIT},
    {"b", offsetof(ClutterRow, b), 0, 10, false, CLUTTER_GIT},
    {"c", offsetof(ClutterRow, c), 0, 1, false, CLUTTER_GIT},
    {"d", offsetof(ClutterRow, d), 0, 100, false, CLUTTER_GIT},
    {"roughness_mm", offsetof(ClutterRow, roughness_m), 0, 1e5, false, CLUTTER_GIT},
    {"nu", offsetof(ClutterRow, nu), 0, 1e4, false, -1},
    {"texture_m", offsetof(ClutterRow, texture_m), 0.1, 1e4, false, -1},
    {"hh_vv_db", offsetof(ClutterRow, hh), -30, 30, true, -1},
    {"hv_vv_db", offsetof(ClutterRow, hv), -60, 10, true, -1},
    {"rho", offsetof(ClutterRow, rho), 0, 1, false, -1},
    {"motion", offsetof(ClutterRow, motion), 0, 10, false, -1},
    {"still", offsetof(ClutterRow, still), 0, 1e6, false, -1},
    {"extent_mm", offsetof(ClutterRow, extent_m), 0, 1e3, false, -1},
    {"foliage_db_m", offsetof(ClutterRow, foliage_db_m), 0, 100, false, -1},
};
enum { numbers = sizeof columns / sizeof *columns };
static const char *const text_columns[] = {"surface", "band", "model"};

static Status bad_row(const Table *table, int row, const char *what, const char *value)
{
    log_error("clutter: %s: file=%s line=%d value=\"%s\"", what, table->path, table->line[row + 1], value);
    return STATUS_BAD_VALUE;
}

static Status read_row(ClutterTable *out, bool seen[SURFACE_COUNT][CLUTTER_BAND_COUNT], const Table *table, int row,
                       const int at[numbers], const int text[3])
{
    static const double smallest_nu = 0.05;
    const char         *surface_text = table_text(table, row, text[0]), *band_text = table_text(table, row, text[1]),
               *model_text = table_text(table, row, text[2]);
    const SurfaceClass surface = surface_find(surface_text);
    int                band = 0;
    while (band < CLUTTER_BAND_COUNT && strcmp(bands[band].name, band_text) != 0) band++;
    if (surface == SURFACE_NONE) return bad_row(table, row, "no such surface", surface_text);
    if (band == CLUTTER_BAND_COUNT) return bad_row(table, row, "band is Ku, Ka or W", band_text);
    if (seen[surface][band]) return bad_row(table, row, "a second row of a surface and band", surface_text);
    seen[surface][band] = true;
    const bool git = strcmp(model_text, "git") == 0;
    if (!git && strcmp(model_text, "gamma") != 0) return bad_row(table, row, "model is gamma or git", model_text);

    ClutterRow *to = &out->row[surface][band];
    *to = (ClutterRow){.model = git ? CLUTTER_GIT : CLUTTER_GAMMA};
    for (int c = 0; c < numbers; c++) {
        double    *value = (double *)((char *)to + columns[c].offset);
        const bool foreign = columns[c].model >= 0 && columns[c].model != (int)to->model;
        if (foreign && !*table_text(table, row, at[c])) continue;
        const Status status = table_number(value, table, row, at[c], columns[c].low, columns[c].high);
        if (status != STATUS_OK) return status;
        if (columns[c].decibel) *value = pow(10, 0.1 * *value);
    }
    to->roughness_m *= 1e-3;
    to->extent_m *= 1e-3;
    if (to->nu == 0) {
        to->nu = INFINITY;
        return STATUS_OK;
    }
    if (to->nu < smallest_nu) return bad_row(table, row, "nu is 0 or 0.05 .. 10000", table_text(table, row, at[6]));
    fill_texture(to);
    return STATUS_OK;
}

Status clutter_table_open(ClutterTable *out, const char *path)
{
    Table        table = {0};
    ClutterTable read;
    bool         seen[SURFACE_COUNT][CLUTTER_BAND_COUNT] = {{false}};
    int          at[numbers], text[3];
    const char  *name[numbers];

    Status status = table_open(&table, path);
    if (status != STATUS_OK) return status;
    for (int c = 0; c < numbers; c++) name[c] = columns[c].name;
    if (!table_columns(text, &table, text_columns, 3, "clutter") ||
        !table_columns(at, &table, name, numbers, "clutter"))
        status = STATUS_BAD_VALUE;
    for (int row = 0; row < table.rows && status == STATUS_OK; row++)
        status = read_row(&read, seen, &table, row, at, text);
    table_close(&table);
    for (int s = SURFACE_NONE + 1; s < SURFACE_COUNT && status == STATUS_OK; s++)
        for (int b = 0; b < CLUTTER_BAND_COUNT && status == STATUS_OK; b++)
            if (!seen[s][b]) {
                log_error("clutter: no row: file=%s surface=%s band=%s", path, surface_name((SurfaceClass)s),
                          bands[b].name);
                status = STATUS_BAD_VALUE;
            }
    if (status != STATUS_OK) return status;
    memcpy(read.row[SURFACE_NONE], read.row[SURFACE_BARE_SOIL], sizeof read.row[SURFACE_NONE]);
    *out = read;
    return STATUS_OK;
}

/* ---- forms ------------------------------------------------------------------------------------------ */

double clutter_sigma0(const ClutterRow *row, double grazing_rad, double wavelength_m)
{
    if (!(grazing_rad > 0)) return 0;
    if (row->model == CLUTTER_GAMMA) return row->gamma * sin(grazing_rad);
    return row->a * pow(grazing_rad + row->c, row->b) * exp(-row->d / (1 + 0.1 * row->roughness_m / wavelength_m));
}

ClutterMotion clutter_motion(const ClutterRow *row, double frequency_hz, double wind_mps)
{
    static const double mph_per_mps = 1 / 0.44704;
    const double mph = wind_mps * mph_per_mps, spread_mps = mph > 0 ? 0.1048 * (log10(mph) + 0.4147) * row->motion : 0;
    if (!(spread_mps > 0)) return (ClutterMotion){.still = 1};
    const double ratio = row->still * 489.8 * pow(mph, -1.55) * pow(1e-9 * frequency_hz, -1.21);
    return (ClutterMotion){ratio / (1 + ratio), spread_mps};
}

double clutter_correlation(const ClutterMotion *motion, double lag_s, double wavelength_m)
{
    const double x = 4 * pi_rad * lag_s * motion->spread_mps / wavelength_m;
    return motion->still + (1 - motion->still) / (1 + x * x);
}

double clutter_foliage_depth(double depth_m)
{
    static const double bend_m = 14, power = 0.588;
    if (!(depth_m > 0)) return 0;
    return depth_m <= bend_m ? depth_m : bend_m * pow(depth_m / bend_m, power);
}

double clutter_foliage_db(const ClutterRow *row, double depth_m)
{
    return row->foliage_db_m * clutter_foliage_depth(depth_m);
}

double clutter_foliage_volume(const ClutterRow *row)
{
    static const double neper_per_db = 0.23025850929940456840; /* of power: ln 10 / 10 */
    return row->model == CLUTTER_GAMMA ? 2 * neper_per_db * row->foliage_db_m * row->gamma : 0;
}
