/* render/scattering/paths/radar_path.c: the air by height, integrals along a straight path over a round Earth, and
 * the radar equation as power and as voltage. */
#include "render/scattering/paths/radar_path.h"
#include "render/scattering/paths/attenuation.h"
#include "render/scattering/scatter.h"
#include "terrain/weather/weather.h"

static const double earth_m = 6371000, level_m = 100, top_m = 20000, fade_m = 2000;

/* ---- air by height ----------------------------------------------------------------------------- */

/* Partial pressure of vapour at a height. vapour_g_m3 is the density at the ground. */
static double vapour_hpa(double vapour_g_m3, double height_m, double temp_k)
{
    const double hpa = gas_vapour_hpa(vapour_g_m3 * exp(-height_m / fade_m), temp_k);
    return fmin(hpa, 0.01 * weather_saturation_pa(temp_k));
}

void radar_air_at(GasState *out, const RadarAir *air, double height_m)
{
    const double h_m = clamp(height_m, 0, top_m), at = h_m / level_m;
    const int    i = at < radar_air_levels - 2 ? (int)at : radar_air_levels - 2;
    const double w = at - i;
    out->temp_k = air->temp_k[i] + w * (air->temp_k[i + 1] - air->temp_k[i]);
    out->vapour_hpa = vapour_hpa(air->vapour_g_m3, h_m, out->temp_k);
    out->dry_hpa = exp(air->ln_hpa[i] + w * (air->ln_hpa[i + 1] - air->ln_hpa[i])) - out->vapour_hpa;
}

/* Computes d ln p / dz of moist air: -g / (R Tv). */
static double pressure_slope(double hpa, double vapour_g_m3, double height_m, double temp_k)
{
    static const double g_mps2 = 9.80665, gas_j_kgk = 287.05;
    const double        r = earth_m / (earth_m + height_m);
    return -g_mps2 * r * r * (1 - 0.378 * vapour_hpa(vapour_g_m3, height_m, temp_k) / hpa) / (gas_j_kgk * temp_k);
}

/* Highest level that is not below 0 C, straight between the levels; below 0: none is. */
static double zero_celsius_m(const RadarAir *air)
{
    static const double zero_k = 273.15;
    int                 i = radar_air_levels - 1;
    while (i >= 0 && !(air->temp_k[i] >= zero_k)) i--;
    if (i < 0 || i == radar_air_levels - 1) return i < 0 ? -1 : top_m;
    return level_m * (i + (air->temp_k[i] - zero_k) / (air->temp_k[i] - air->temp_k[i + 1]));
}

Status radar_air_of(RadarAir *out, const Atmosphere *model, const Weather *weather)
{
    RadarAir     air = {0};
    const double model_k = atmosphere_temp_k(model, 0),
                 ground_k = isnan(weather->air_temp_k) ? model_k : weather->air_temp_k;
    const double p_hpa = weather->pressure_mbar;
    if (!(ground_k >= 150 && ground_k <= 350 && p_hpa > 0 && p_hpa <= 1200 && weather->humidity >= 0 &&
          weather->humidity <= 1 && weather->rain_mm_h >= 0 && weather->rain_mm_h <= 300))
        return STATUS_BAD_VALUE;
    const double e_hpa = weather->humidity * 0.01 * weather_saturation_pa(ground_k);
    if (!(e_hpa <= 150 && e_hpa <= 0.5 * p_hpa)) return STATUS_BAD_VALUE;
    air.vapour_g_m3 = e_hpa * 216.7 / ground_k;
    for (int i = 0; i < radar_air_levels; i++) {
        const double h_m = level_m * i;
        air.temp_k[i] = atmosphere_temp_k(model, h_m) + (ground_k - model_k) * exp(-h_m / fade_m);
        if (!(air.temp_k[i] >= 150 && air.temp_k[i] <= 350)) return STATUS_BAD_VALUE;
        if (i == 0) {
            air.ln_hpa[0] = log(p_hpa);
            continue;
        }
        const double below = pressure_slope(exp(air.ln_hpa[i - 1]), air.vapour_g_m3, h_m - level_m, air.temp_k[i - 1]);
        const double above =
            pressure_slope(exp(air.ln_hpa[i - 1] + level_m * below), air.vapour_g_m3, h_m, air.temp_k[i]);
        air.ln_hpa[i] = air.ln_hpa[i - 1] + 0.5 * level_m * (below + above);
    }
    const double zero_m = zero_celsius_m(&air);
    air.rain_mm_h = weather->rain_mm_h;
    air.rain_top_m = zero_m >= 0 ? zero_m + 360 : 0;
    *out = air;
    return STATUS_OK;
}

/* ---- along a path ------------------------------------------------------------------------------- */

/* h (2 R + h) is a parabola along a straight line: low + s (s + slope), with s from end a. */
typedef struct Line {
    double length_m, low_m2, slope_m;
} Line;

static Line line_of(const RadarPath *path)
{
    Line line = {.length_m = fmax(path->range_m, fabs(path->a_m - path->b_m)),
                 .low_m2 = path->a_m * (2 * earth_m + path->a_m)};
    if (line.length_m > 0)
        line.slope_m = (path->b_m - path->a_m) * (2 * earth_m + path->a_m + path->b_m) / line.length_m - line.length_m;
    return line;
}

static double line_height_m(const Line *line, double s_m)
{
    const double q = line->low_m2 + s_m * (s_m + line->slope_m);
    return q / (sqrt(earth_m * earth_m + q) + earth_m);
}

typedef struct Span {
    double from_m, to_m;
} Span;

/* Where the path is below a height: one piece; empty: from >= to. */
static Span below(const Line *line, double height_m)
{
    const double h_m = fmin(height_m, 2 * top_m); /* no path is higher: INFINITY is everything */
    const double b = line->slope_m, c = line->low_m2 - h_m * (2 * earth_m + h_m), d = b * b - 4 * c;
    if (!(height_m > 0 && d > 0)) return (Span){0, 0};
    const double q = -0.5 * (b + copysign(sqrt(d), b)), r = q == 0 ? 0 : c / q; /* both roots without cancellation */
    return (Span){clamp(fmin(q, r), 0, line->length_m), clamp(fmax(q, r), 0, line->length_m)};
}

typedef struct Walk {
    const RadarPath *path;
    const GasLines  *lines;
    const RadarAir  *air;
    Line             line;
    int              fine;
} Walk;

/* Nodes and weights of the three-point Gauss-Legendre rule over [-1, 1]. */
static const double gauss_x[3] = {-0.77459666924148337704, 0, 0.77459666924148337704};
static const double gauss_w[3] = {5.0 / 9, 8.0 / 9, 5.0 / 9};

/* So that neither height nor length of a panel is large; the height changes most at one of the ends. */
static int panels(const Walk *walk, Span span)
{
    static const double panel_height_m = 250, panel_length_m = 10000;
    const double        mid_m = 0.5 * (span.from_m + span.to_m), middle = line_height_m(&walk->line, mid_m);
    const double        change_m =
        fabs(line_height_m(&walk->line, span.from_m) - middle) + fabs(line_height_m(&walk->line, span.to_m) - middle);
    return walk->fine * (int)(1 + fmax(change_m / panel_height_m, (span.to_m - span.from_m) / panel_length_m));
}

static void add_gas(RadarLoss *out, const Walk *walk, Span span)
{
    const int    count = panels(walk, span);
    const double half_m = 0.5 * (span.to_m - span.from_m) / count;
    double       ppm_m = 0;
    for (int i = 0; i < count; i++)
        for (int g = 0; g < 3; g++) {
            GasState       state;
            GasAttenuation gas;
            radar_air_at(&state, walk->air,
                         line_height_m(&walk->line, span.from_m + half_m * (2 * i + 1 + gauss_x[g])));
            gas_attenuation(&gas, walk->lines, walk->path->f_ghz, &state);
            out->dry_db += gauss_w[g] * half_m * 1e-3 * gas.dry_db_km;
            out->wet_db += gauss_w[g] * half_m * 1e-3 * gas.wet_db_km;
            ppm_m += gauss_w[g] * half_m * (gas.dry_ppm + gas.wet_ppm);
        }
    out->dispersion_rad += 2 * pi_rad * walk->path->f_ghz * 1e9 / light_mps * 1e-6 * ppm_m;
}

static double liquid_db(const Walk *walk, Span span, double g_m3)
{
    if (!(span.to_m > span.from_m)) return 0;
    const int    count = panels(walk, span);
    const double half_m = 0.5 * (span.to_m - span.from_m) / count;
    double       db = 0;
    for (int i = 0; i < count; i++)
        for (int g = 0; g < 3; g++) {
            GasState state;
            radar_air_at(&state, walk->air,
                         line_height_m(&walk->line, span.from_m + half_m * (2 * i + 1 + gauss_x[g])));
            if (state.temp_k < radar_frozen_k) continue;
            db += gauss_w[g] * half_m * 1e-3 * g_m3 * cloud_attenuation(walk->path->f_ghz, state.temp_k);
        }
    return db;
}

void radar_path_loss_fine(RadarLoss *out, const RadarPath *path, const GasLines *lines, const RadarAir *air, int fine)
{
    *out = (RadarLoss){NAN, NAN, NAN, NAN, NAN};
    if (!(path->a_m >= 0 && path->a_m <= top_m && path->b_m >= 0 && path->b_m <= top_m && path->range_m >= 0 &&
          path->range_m <= 1e6 && path->f_ghz >= 1 && path->f_ghz <= 1000 && isfinite(path->tilt_rad)))
        return;
    *out = (RadarLoss){0};
    const Walk  walk = {path, lines, air, line_of(path), fine};
    const Line *line = &walk.line;
    if (!(line->length_m > 0)) return;
    add_gas(out, &walk, (Span){0, line->length_m});

    const Span   wet = below(line, air->rain_top_m);
    const double elevation_rad = asin(clamp((path->b_m - path->a_m) / line->length_m, -1, 1));
    if (air->rain_mm_h > 0 && wet.to_m > wet.from_m)
        out->rain_db = 1e-3 * (wet.to_m - wet.from_m) *
                       rain_attenuation(path->f_ghz, air->rain_mm_h, elevation_rad, path->tilt_rad);

    for (int i = 0; i < radar_air_liquids; i++) {
        const RadarLiquid *layer = &air->liquid[i];
        if (!(layer->g_m3 > 0 && layer->low_m < layer->high_m)) continue;
        const Span outer = below(line, layer->high_m), inner = below(line, layer->low_m);
        if (inner.to_m > inner.from_m) {
            out->liquid_db += liquid_db(&walk, (Span){outer.from_m, inner.from_m}, layer->g_m3) +
                              liquid_db(&walk, (Span){inner.to_m, outer.to_m}, layer->g_m3);
        } else {
            out->liquid_db += liquid_db(&walk, outer, layer->g_m3);
        }
    }
}

void radar_path_loss(RadarLoss *out, const RadarPath *path, const GasLines *lines, const RadarAir *air)
{
    radar_path_loss_fine(out, path, lines, air, 1);
}

double complex radar_path_factor(const RadarLoss *loss)
{
    const double amplitude = pow(10, -radar_loss_db(loss) / 10), phase = -2 * loss->dispersion_rad; /* 2 x dB / 20 */
    return CMPLX(amplitude * cos(phase), amplitude * sin(phase));
}

/* ---- the radar equation ------------------------------------------------------------------------- */

static bool valid(const RadarLink *l)
{
    return l->transmitted_w > 0 && l->transmit_gain > 0 && l->receive_gain > 0 && l->wavelength_m > 0 &&
           l->range_m > 0 && l->loss >= 1;
}

double radar_received_w(const RadarLink *link, double rcs_m2)
{
    const double four_pi = 4 * pi_rad, w_m = link->wavelength_m, r2 = link->range_m * link->range_m;
    if (!valid(link) || !(rcs_m2 >= 0)) return NAN;
    return link->transmitted_w * link->transmit_gain * link->receive_gain * w_m * w_m * rcs_m2 /
           (four_pi * four_pi * four_pi * r2 * r2 * link->loss);
}

double complex radar_voltage(const RadarLink *link, double complex scattering_m, double complex path)
{
    if (!valid(link)) return CMPLX(NAN, NAN);
    const double waves = 2 * link->range_m / link->wavelength_m;
    const double phase = -2 * pi_rad * (waves - floor(waves)); /* whole waves first: R is a million of them */
    const double size = sqrt(link->transmitted_w * link->transmit_gain * link->receive_gain / link->loss) *
                        link->wavelength_m / (4 * pi_rad * link->range_m * link->range_m);
    return size * CMPLX(cos(phase), sin(phase)) * scattering_m * path;
}

double radar_noise_w(double bandwidth_hz, double noise_factor)
{
    static const double boltzmann_j_k = 1.380649e-23;
    if (!(bandwidth_hz > 0 && noise_factor >= 1)) return NAN;
    return boltzmann_j_k * 290 * bandwidth_hz * noise_factor;
}
