/* render/scattering/clutter/clutter_table.c: reads what the ground of each surface class sends back, and the forms
 * its figures go into. */
#include "render/scattering/clutter/clutter_table_private.h"

#include "pitviper_table.h"

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

typedef struct Row {
    SurfaceClass surface;
    int          band;
    ClutterRow   of; /* NaN: figures of the other model that are not given */
} Row;

#define FIELD(member) TABLE_AT(Row, member)

static const TableColumn columns[] = {
    {"surface", TABLE_NAMED, FIELD(surface), SURFACE_NAMED, .key = true},
    {"band", TABLE_CHOICE, FIELD(band), .choices = "Ku, Ka, W", .key = true},
    {"model", TABLE_CHOICE, FIELD(of.model), .choices = "gamma, git"},
    {"gamma_db", TABLE_DOUBLE, FIELD(of.gamma), .low = -60, .high = 20, .absent = TABLE_EMPTY, .otherwise = NAN},
    {"a", TABLE_DOUBLE, FIELD(of.a), .low = 1e-9, .high = 1e3, .absent = TABLE_EMPTY, .otherwise = NAN},
    {"b", TABLE_DOUBLE, FIELD(of.b), .low = 0, .high = 10, .absent = TABLE_EMPTY, .otherwise = NAN},
    {"c", TABLE_DOUBLE, FIELD(of.c), .low = 0, .high = 1, .absent = TABLE_EMPTY, .otherwise = NAN},
    {"d", TABLE_DOUBLE, FIELD(of.d), .low = 0, .high = 100, .absent = TABLE_EMPTY, .otherwise = NAN},
    {"roughness_mm", TABLE_DOUBLE, FIELD(of.roughness_m), .low = 0, .high = 1e5, .unit = 1e-3, .absent = TABLE_EMPTY,
     .otherwise = NAN},
    {"nu", TABLE_DOUBLE, FIELD(of.nu), .low = 0, .high = 1e4},
    {"texture_m", TABLE_DOUBLE, FIELD(of.texture_m), .low = 0.1, .high = 1e4},
    {"hh_vv_db", TABLE_DOUBLE, FIELD(of.hh), .low = -30, .high = 30},
    {"hv_vv_db", TABLE_DOUBLE, FIELD(of.hv), .low = -60, .high = 10},
    {"rho", TABLE_DOUBLE, FIELD(of.rho), .low = 0, .high = 1},
    {"motion", TABLE_DOUBLE, FIELD(of.motion), .low = 0, .high = 10},
    {"still", TABLE_DOUBLE, FIELD(of.still), .low = 0, .high = 1e6},
    {"extent_mm", TABLE_DOUBLE, FIELD(of.extent_m), .low = 0, .high = 1e3, .unit = 1e-3},
    {"foliage_db_m", TABLE_DOUBLE, FIELD(of.foliage_db_m), .low = 0, .high = 100},
};
static const TableFormat format = {"clutter", columns, sizeof columns / sizeof *columns, .every = true,
                                   .next = "etc/reference/radar_clutter.md explains the columns"};

/* Whether a figure is there, which only rows of one model need; without it 0. */
static bool given(double *figure)
{
    if (!isnan(*figure)) return true;
    *figure = 0;
    return false;
}

static Status take_row(void *user, const void *read, const TableRows *rows, int number)
{
    static const double      smallest_nu = 0.05;
    static const char *const of_git[] = {"a", "b", "c", "d", "roughness_mm"};
    const Row               *row = read;
    ClutterRow              *to = &((ClutterTable *)user)->row[row->surface][row->band];
    const bool               git = row->of.model == CLUTTER_GIT;
    *to = row->of;
    double *const figure[] = {&to->a, &to->b, &to->c, &to->d, &to->roughness_m};
    for (int k = 0; k < 5; k++)
        if (!given(figure[k]) && git) return table_rows_refuse(rows, number, of_git[k], "a number, which git needs");
    if (!given(&to->gamma)) {
        if (!git) return table_rows_refuse(rows, number, "gamma_db", "a number, which gamma needs");
    } else {
        to->gamma = pow(10, 0.1 * to->gamma);
    }
    to->hh = pow(10, 0.1 * to->hh);
    to->hv = pow(10, 0.1 * to->hv);
    if (to->nu != 0 && to->nu < smallest_nu) return table_rows_refuse(rows, number, "nu", "0 or 0.05 .. 10000");
    if (to->nu == 0) to->nu = INFINITY;
    else fill_texture(to);
    return STATUS_OK;
}

Status clutter_table_open(ClutterTable *out, const char *path)
{
    ClutterTable table;
    Row          row;
    const Status status = table_each(&format, path, &row, sizeof row, take_row, &table);
    if (status != STATUS_OK) return status;
    memcpy(table.row[SURFACE_NONE], table.row[SURFACE_BARE_SOIL], sizeof table.row[SURFACE_NONE]);
    *out = table;
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
