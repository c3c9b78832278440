/* render/air/atmosphere_solar.c: reads and interpolates etc/atmosphere/solar.csv: the sun's direct and diffuse light,
 * all wavelengths. */
#include "render/air/atmosphere_private.h"

/* Interpolated is the logarithm of direct light's optical depth, and of diffuse light, over the logarithms of
 * visibility, water and air mass, and over height: each is nearly straight. */
enum { solar_axes = 4, solar_values = 2, solar_reach = 4 };

static const double solar_top_w_m2 = 1361;   /* only a scale of depth: above every direct light */
static const double solar_least_step = 1e-4; /* between nodes, in these coordinates: slopes stay finite */

static double height_itself(double m) { return m; }
static double air_mass_of(double deg) { return slant_x(deg * rad_per_deg); }

/* Axes and values in the coordinates above. */
static Status to_coordinates(Grid *grid, const char *path, const GridColumn *axis)
{
    static double (*const along[solar_axes])(double) = {log, log, height_itself, air_mass_of};
    size_t nodes = 1;
    for (int a = 0; a < solar_axes; a++) {
        nodes *= (size_t)grid->nodes[a];
        for (int k = 0; k < grid->nodes[a]; k++) {
            double *x = grid->axis[a];
            x[k] = along[a](x[k]);
            if (k == 0 || x[k] - x[k - 1] >= solar_least_step) continue;
            log_error("atmosphere: %s: two values of %s are nearly the same", path, axis[a].name);
            return STATUS_BAD_VALUE;
        }
    }
    for (size_t k = 0; k < nodes; k++) {
        double *v = grid->value + k * solar_values;
        v[0] = log(log(solar_top_w_m2 / v[0])), v[1] = log(v[1]);
    }
    return STATUS_OK;
}

Status solar_open(Grid *solar)
{
    static const GridColumn axis[solar_axes] = {{"visibility_m", 10, 1e6},
                                                {"water_mm", 1e-3, 200},
                                                {"ground_m", 0, 9000},
                                                {"sun_zenith_deg", 0, 90}},
                            value[solar_values] = {{"direct_w_m2", 1e-30, 1360}, {"diffuse_w_m2", 1e-9, 1360}};
    char path[512];
    if (!etc_path(path, sizeof path, "atmosphere/solar.csv")) {
        log_error("atmosphere: path too long: solar.csv");
        return STATUS_BAD_VALUE;
    }
    const Status status = grid_open(solar, path, axis, solar_axes, value, solar_values);
    return status == STATUS_OK ? to_coordinates(solar, path, axis) : status;
}

/* Nodes about a value of an axis, and their shares in the cubic through the two nearest, whose slopes there are those
 * of the parabola through a node and its neighbours: smooth from one interval to the next. Two nodes: a straight line.
 */
typedef struct Reach {
    int    first, count;
    double share[solar_reach];
} Reach;

/* Adds a share of the slope at a node, of three or more. */
static void add_slope(Reach *reach, const double *x, int nodes, int node, double share)
{
    const int middle = node < 1 ? 1 : node < nodes - 1 ? node : nodes - 2;
    for (int j = middle - 1; j <= middle + 1; j++) {
        const int    a = j == middle - 1 ? middle : middle - 1, b = j == middle + 1 ? middle : middle + 1;
        const double slope = ((x[node] - x[a]) + (x[node] - x[b])) / ((x[j] - x[a]) * (x[j] - x[b]));
        reach->share[j - reach->first] += share * slope;
    }
}

static void reach_of(Reach *out, const double *x, int nodes, double at)
{
    double       t;
    const int    i = interval_of(&t, x, nodes, at), low = i > 0 ? i - 1 : 0;
    const int    count = nodes < solar_reach ? nodes : solar_reach;
    const double s = 1 - t;
    *out = (Reach){.first = low < nodes - count ? low : nodes - count, .count = count};
    double *share = out->share + (i - out->first);
    share[0] = nodes > 2 ? (1 + 2 * t) * s * s : s;
    if (nodes > 1) share[1] = nodes > 2 ? (1 + 2 * s) * t * t : t;
    if (nodes < 3) return;
    add_slope(out, x, nodes, i, t * s * s * (x[i + 1] - x[i]));
    add_slope(out, x, nodes, i + 1, -t * t * s * (x[i + 1] - x[i]));
}

void atmosphere_solar(SunAir *out, const Atmosphere *atmosphere, const SolarAir *air, double sun_zenith_rad)
{
    const Grid  *grid = &atmosphere->solar;
    const double at[solar_axes] = {log(air->visibility_m), log(fmax(air->water_mm, 1e-9)), air->ground_m,
                                   slant_x(sun_zenith_rad)};
    Reach        r[solar_axes];
    double       sum[solar_values] = {0};
    for (int a = 0; a < solar_axes; a++) reach_of(&r[a], grid->axis[a], grid->nodes[a], at[a]);
    for (int v = 0; v < r[0].count; v++)
        for (int w = 0; w < r[1].count; w++)
            for (int g = 0; g < r[2].count; g++) {
                const int     pair = (r[0].first + v) * grid->nodes[1] + r[1].first + w;
                const int     row = (pair * grid->nodes[2] + r[2].first + g) * grid->nodes[3] + r[3].first;
                const double *value = grid->value + (size_t)row * solar_values;
                const double  share = r[0].share[v] * r[1].share[w] * r[2].share[g];
                for (int z = 0; z < r[3].count; z++)
                    for (int c = 0; c < solar_values; c++)
                        sum[c] += share * r[3].share[z] * value[z * solar_values + c];
            }
    *out = (SunAir){solar_top_w_m2 * exp(-exp(sum[0])), fmin(exp(sum[1]), solar_top_w_m2)};
}
