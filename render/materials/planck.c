/* render/materials/planck.c: blackbody radiance, spectral, in band, and from a table.
 *
 * With x = h c / (wavelength k T) the in-band radiance is 2 k^4 T^4 / (h^3 c^2) times the integral of x^3 / (e^x -
 * 1) between the band's edges. All functions below compute that integral without cancellation: positive terms summed
 * where the edges are close, tails subtracted where they are not. */
#include "render/materials/planck.h"

#include "pitviper_simd.h"

#include <stdlib.h>

/* Exact since the 2019 SI. */
static const double h_j_s = 6.62607015e-34, c_mps = 299792458.0, k_j_k = 1.380649e-23;
static const double pi4_over_15 = 6.493939402266829149096;

double planck_radiance(double wavelength_m, double temp_k)
{
    if (!(wavelength_m > 0 && temp_k > 0)) return NAN;
    const double x = h_j_s * c_mps / (wavelength_m * k_j_k * temp_k);
    const double w2 = wavelength_m * wavelength_m;

    /* half the exponent twice: e^x overflows at x = 710 although the quotient may still be a normal number
     * when the wavelength is short; 1 - e^-x through expm1, since x -> 0 in the Rayleigh-Jeans tail */
    const double half = exp(-0.5 * x);
    return 2 * h_j_s * c_mps * c_mps / (w2 * w2 * wavelength_m) * half / -expm1(-x) * half;
}

/* e^x times the tail integral of t^3 / (e^t - 1) from x to infinity, for x >= 1. Expanding 1 / (e^t - 1) in
 * powers of e^-t and integrating term by term gives polylogarithm sums; all terms are positive. */
static double scaled_tail(double x)
{
    const double decay = exp(-x);
    double       sum = 0, power = 1;
    for (int n = 1; n < 64; n++) {
        const double r = 1.0 / n;
        const double term = power * r * (x * x * x + r * (3 * x * x + r * (6 * x + r * 6)));
        sum += term;
        if (term < 1e-17 * sum) break; /* at x = 1: 37 terms */
        power *= decay;
    }
    return sum;
}

/* Integral of t^3 / (e^t - 1) from 0 to x, for 0 <= x <= 1: the Taylor series with Bernoulli numbers, whose
 * radius is 2 pi. B_2k / ((2k)! (2k + 3)), k = 1 ..; the last term is 1e-19 at x = 1. */
static double head(double x)
{
    static const double c[] = {
        1.0 / 60,
        -1.0 / 5040,
        1.0 / 272160,
        -1.0 / 13305600,
        1.0 / 622702080,
        -691.0 / 19615115520000.0,
        1.0 / 1270312243200.0,
        -3617.0 / 202741834014720000.0,
        43867.0 / 107290978560589824000.0,
        -174611.0 / 18465726242060697600000.0,
    };
    const double x2 = x * x;
    double       sum = 0;
    for (int k = (int)(sizeof c / sizeof *c) - 1; k >= 0; k--) sum = c[k] + x2 * sum;
    return x * x2 * (1.0 / 3 - x / 8 + x2 * sum);
}

/* 16-point Gauss-Legendre on [-1, 1], the positive half (Abramowitz & Stegun, table 25.4). */
static const double gauss_node[8] = {
    0.0950125098376374401853193354, 0.2816035507792589132304605015, 0.4580167776572273863424194430,
    0.6178762444026437484466717640, 0.7554044083550030338951011948, 0.8656312023878317438804678977,
    0.9445750230732325760779884155, 0.9894009349916499325961541735,
};
static const double gauss_weight[8] = {
    0.1894506104550684962853967232, 0.1826034150449235888667636680, 0.1691565193950025381893120790,
    0.1495959888165767320815017305, 0.1246289712555338720524762822, 0.0951585116824927848099251076,
    0.0622535239386478928628438370, 0.0271524594117540948517805725,
};

/* e^x1 times the integral from x1 to x1 + width of t^3 / (e^t - 1), and of t^4 e^t / (e^t - 1)^2, which is
 * what the derivative in T needs (the same integral by parts). Exact to rounding for width <= 2: the nearest
 * pole, 2 pi i, is six half-widths away. The width is given by itself, not as a difference of edges. */
static void scaled_narrow(double *value, double *slope, double x1, double width)
{
    const double half = 0.5 * width;
    double       v = 0, s = 0;
    for (int i = 0; i < 8; i++) {
        for (int side = -1; side <= 1; side += 2) {
            const double step = half * (1 + side * gauss_node[i]);
            const double t = x1 + step, q = -expm1(-t);
            const double f = gauss_weight[i] * t * t * t * exp(-step) / q;
            v += f;
            s += f * t / q;
        }
    }
    *value = half * v;
    *slope = half * s;
}

/* Above this the two edges are far enough apart that their tails differ by a factor of 1.2 or more and the
 * subtraction costs less than a decimal digit. */
static const double narrow_x = 2;

double planck_band(double low_m, double high_m, double temp_k, double *derivative)
{
    if (!(low_m > 0 && high_m > low_m && temp_k > 0)) {
        if (derivative) *derivative = NAN;
        return NAN;
    }
    const double hc_kt = h_j_s * c_mps / (k_j_k * temp_k);
    const double x1 = hc_kt / high_m, x2 = hc_kt / low_m;
    /* x2 - x1, without the digits that a difference of near edges would lose */
    const double width = isfinite(high_m) ? (high_m - low_m) / high_m * x2 : x2;

    /* value and slope carry a factor e^x1 that is applied at the end in two halves, so that neither a tail that
     * underflows by itself nor a T^4 in front of it spoils a result that is still normal */
    double value, slope;
    if (width <= narrow_x) {
        scaled_narrow(&value, &slope, x1, width);
    } else {
        const double f1 = x1 * x1 * x1 * (x1 > 0 ? x1 / -expm1(-x1) : 1); /* e^x1 x1^4 / (e^x1 - 1) */
        const double tail1 = x1 >= 1 ? scaled_tail(x1) : (pi4_over_15 - head(x1)) * exp(x1);
        double       tail2 = 0, f2 = 0;
        if (x2 - x1 < 745) {
            const double between = exp(x1 - x2);
            tail2 = between * scaled_tail(x2);
            f2 = between * x2 * x2 * x2 * x2 / -expm1(-x2);
        }
        value = tail1 - tail2;
        slope = (4 * tail1 + f1) - (4 * tail2 + f2);
    }
    const double half = exp(-0.5 * x1);
    const double kt_hc = 1 / hc_kt;
    /* 2 k^4 T^4 / (h^3 c^2) = 2 h c^2 (k T / (h c))^4 */
    const double front = 2 * h_j_s * c_mps * c_mps * kt_hc * kt_hc * kt_hc * kt_hc;
    if (derivative) *derivative = front / temp_k * slope * half * half;
    return front * value * half * half;
}

double planck_seen(const SpectralBand *band, double temp_k, double *derivative)
{
    const SpectralResponse *r = band->response;
    if (!r || !(temp_k > 0)) return planck_band(band->low_m, band->high_m, temp_k, derivative);
    double sum = 0, slope = 0;
    for (int i = 0; i < r->nodes; i++) {
        const double light = r->weight_m[i] * planck_radiance(r->node_m[i], temp_k);
        const double x = h_j_s * c_mps / (r->node_m[i] * k_j_k * temp_k);
        sum += light;
        slope += light * x / -expm1(-x);
    }
    if (derivative) *derivative = slope / temp_k;
    return sum;
}

double planck_band_inverse(double low_m, double high_m, double radiance_w_m2_sr)
{
    const SpectralBand band = {low_m, high_m, NULL};
    return planck_seen_inverse(&band, radiance_w_m2_sr);
}

double planck_seen_inverse(const SpectralBand *band, double radiance_w_m2_sr)
{
    const double low_m = band->low_m, high_m = band->high_m;
    if (!(low_m > 0 && high_m > low_m && radiance_w_m2_sr > 0 && isfinite(radiance_w_m2_sr))) return NAN;

    /* start as if the whole band were at its middle; ln L is convex and almost straight in u = 1 / T, so
     * Newton's steps there are few. Steps are held within a factor of 4 */
    const double middle_m = 0.5 * (low_m + high_m), target = log(radiance_w_m2_sr);
    const double m5 = middle_m * middle_m * middle_m * middle_m * middle_m;
    const double hc_k = h_j_s * c_mps / k_j_k;
    double       u = middle_m / hc_k * log1p(2 * h_j_s * c_mps * c_mps / m5 * (high_m - low_m) / radiance_w_m2_sr);
    for (int i = 0; i < 100; i++) {
        double       slope;
        const double value = planck_seen(band, 1 / u, &slope);
        if (!(value > 0 && slope > 0)) {
            u *= 0.75; /* too cold: underflow */
            continue;
        }
        /* d ln L / du = -(dL/dT) T^2 / L */
        const double next = clamp(u + (log(value) - target) * value * u * u / slope, 0.25 * u, 4 * u);
        const double change = fabs(next - u);
        u = next;
        if (change <= 1e-10 * u) break; /* quadratic: the error left is the square of this */
    }
    return 1 / u;
}

/* ---- table -------------------------------------------------------------------------------- */

/* Cells are uniform in 1/T, in which L is nearly an exponential of constant slope (so the relative error is
 * the same all over); each holds the cubic that has the exact value and derivative at both its ends. */
enum { table_cells = planck_table_cells, table_bins = 8192 };
static const double table_low_k = 180, table_high_k = 1500;

struct PlanckTable {
    SpectralBand band;
    double       u0, cells_per_u;
    double       knot[table_cells + 2];  /* radiance, falling: cell 0 is the hottest; and nothing below */
    double       c[table_cells][4];      /* L = c0 + t (c1 + t (c2 + t c3)), t = 0 .. 1 across the cell */
    float        narrow[table_cells][4]; /* the same */
    /* start of the search for a radiance, by the leading bits of its double: nearly uniform in its logarithm, as
     * cells are */
    int      bin_shift;
    uint64_t first_bin;
    uint16_t first_cell[table_bins]; /* none of the bin's radiances is in a hotter one */
};

static uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static void index_knots(PlanckTable *table)
{
    const uint64_t lowest = bits_of(table->knot[table_cells]), highest = bits_of(table->knot[0]);
    for (table->bin_shift = 40; (highest >> table->bin_shift) - (lowest >> table->bin_shift) >= table_bins;)
        table->bin_shift++;
    table->first_bin = lowest >> table->bin_shift;
    const uint64_t bins = (highest >> table->bin_shift) - table->first_bin + 1;
    int            cell = table_cells - 1;
    for (uint64_t bin = 0; bin < bins; bin++) { /* from the coldest */
        while (cell > 0 && bits_of(table->knot[cell]) < (table->first_bin + bin + 1) << table->bin_shift) cell--;
        table->first_cell[bin] = (uint16_t)cell;
    }
}

/* The cell of a radiance within the table: knot[cell] >= radiance >= knot[cell + 1]. */
static inline int cell_of_radiance(const PlanckTable *table, double radiance_w_m2_sr)
{
    int cell = table->first_cell[(bits_of(radiance_w_m2_sr) >> table->bin_shift) - table->first_bin];
    cell += table->knot[cell + 1] >= radiance_w_m2_sr; /* usually one of the next; the branch is unpredictable */
    cell += table->knot[cell + 1] >= radiance_w_m2_sr;
    while (table->knot[cell + 1] >= radiance_w_m2_sr) cell++;
    return cell < table_cells ? cell : table_cells - 1;
}

Status planck_table_create(PlanckTable **out, double low_m, double high_m)
{
    const SpectralBand band = {low_m, high_m, NULL};
    return planck_table_seen(out, &band);
}

Status planck_table_seen(PlanckTable **out, const SpectralBand *band)
{
    const double low_m = band->low_m, high_m = band->high_m;
    if (!(low_m > 0 && high_m > low_m && isfinite(high_m))) return STATUS_BAD_VALUE;
    PlanckTable *table = calloc(1, sizeof *table);
    if (!table) return STATUS_NO_MEMORY;

    table->band = *band;
    table->u0 = 1 / table_high_k;
    const double step = (1 / table_low_k - table->u0) / table_cells;
    table->cells_per_u = 1 / step;

    double last_value = 0, last_slope = 0;
    for (int i = 0; i <= table_cells; i++) {
        const double u = table->u0 + i * step;
        double       slope;
        const double value = planck_seen(band, 1 / u, &slope);
        slope *= -step / (u * u); /* per cell of u, from per kelvin */
        table->knot[i] = value;
        if (i > 0) {
            double      *c = table->c[i - 1];
            const double rise = value - last_value;
            c[0] = last_value;
            c[1] = last_slope;
            c[2] = 3 * rise - 2 * last_slope - slope;
            c[3] = last_slope + slope - 2 * rise;
            for (int k = 0; k < 4; k++) table->narrow[i - 1][k] = (float)c[k];
        }
        last_value = value;
        last_slope = slope;
    }
    table->knot[table_cells + 1] = -INFINITY;
    index_knots(table);
    *out = table;
    return STATUS_OK;
}

void planck_table_destroy(PlanckTable *table) { free(table); }

double planck_table_radiance(const PlanckTable *table, double temp_k)
{
    if (!(temp_k >= table_low_k && temp_k <= table_high_k)) return planck_seen(&table->band, temp_k, NULL);
    const double at = (1 / temp_k - table->u0) * table->cells_per_u;
    int          cell = (int)at;
    if (cell < 0) cell = 0; /* rounding at the hot end */
    if (cell >= table_cells) cell = table_cells - 1;
    const double t = at - cell, *c = table->c[cell];
    return c[0] + t * (c[1] + t * (c[2] + t * c[3]));
}

void planck_table_radiance8(float radiance[8], const PlanckTable *table, const float temp_k[8])
{
    const F32x8 temp = f32x8_load(temp_k);
    const F32x8 within =
        f32x8_and(f32x8_less(temp, f32x8_set(table_high_k)), f32x8_greater(temp, f32x8_set(table_low_k)));
    const F32x8 u = f32x8_set(1) / f32x8_clamp(temp, table_low_k, table_high_k) - f32x8_set(table->u0);
    const F32x8 at = f32x8_clamp(u * f32x8_set(table->cells_per_u), 0, table_cells - 1e-3), cell = f32x8_floor(at);
    int32_t     of[8];
    __m128      row[8];
    _mm256_storeu_si256((I32x8 *)of, i32x8_truncate(cell));
    for (int k = 0; k < 8; k++) row[k] = _mm_loadu_ps(table->narrow[of[k]]);
    F32x8 pair[4];
    for (int k = 0; k < 4; k++) pair[k] = _mm256_set_m128(row[k + 4], row[k]);
    const F32x8 a = _mm256_unpacklo_ps(pair[0], pair[1]), b = _mm256_unpackhi_ps(pair[0], pair[1]);
    const F32x8 c = _mm256_unpacklo_ps(pair[2], pair[3]), d = _mm256_unpackhi_ps(pair[2], pair[3]);
    const F32x8 c0 = _mm256_shuffle_ps(a, c, 0x44), c1 = _mm256_shuffle_ps(a, c, 0xee);
    const F32x8 c2 = _mm256_shuffle_ps(b, d, 0x44), c3 = _mm256_shuffle_ps(b, d, 0xee), t = at - cell;
    f32x8_store(radiance, f32x8_fma(t, f32x8_fma(t, f32x8_fma(t, c3, c2), c1), c0));
    for (unsigned other = ~f32x8_bits(within) & 0xff; other; other &= other - 1) {
        const int k = __builtin_ctz(other);
        radiance[k] = (float)planck_table_radiance(table, (double)temp_k[k]);
    }
}

static bool within_table(const PlanckTable *table, double radiance_w_m2_sr)
{
    return radiance_w_m2_sr <= table->knot[0] && radiance_w_m2_sr >= table->knot[table_cells];
}

double planck_table_temp(const PlanckTable *table, double radiance_w_m2_sr)
{
    if (!within_table(table, radiance_w_m2_sr)) return planck_seen_inverse(&table->band, radiance_w_m2_sr);
    const int low = cell_of_radiance(table, radiance_w_m2_sr);
    /* the cubic bends so little within a cell that three Newton steps from the chord reach rounding */
    const double *c = table->c[low];
    const double  fall = table->knot[low] - table->knot[low + 1];
    double        t = fall > 0 ? (table->knot[low] - radiance_w_m2_sr) / fall : 0;
    for (int i = 0; i < 3; i++) {
        const double slope = c[1] + t * (2 * c[2] + 3 * t * c[3]);
        if (!(slope < 0)) break;
        t -= (c[0] + t * (c[1] + t * (c[2] + t * c[3])) - radiance_w_m2_sr) / slope;
    }
    return 1 / (table->u0 + (low + t) / table->cells_per_u);
}

/* planck_table_temp of four within the table, step by step. */
static inline __m256d four_temps(const PlanckTable *table, __m256d radiance)
{
    double  of[4];
    int     low[4];
    __m256d top, next, row[4];
    _mm256_storeu_pd(of, radiance);
    for (int k = 0; k < 4; k++) {
        low[k] = cell_of_radiance(table, of[k]);
        row[k] = _mm256_loadu_pd(table->c[low[k]]);
    }
    const double *knot = table->knot;
    top = _mm256_setr_pd(knot[low[0]], knot[low[1]], knot[low[2]], knot[low[3]]);
    next = _mm256_setr_pd(knot[low[0] + 1], knot[low[1] + 1], knot[low[2] + 1], knot[low[3] + 1]);
    const __m256d a = _mm256_unpacklo_pd(row[0], row[1]), b = _mm256_unpackhi_pd(row[0], row[1]);
    const __m256d c = _mm256_unpacklo_pd(row[2], row[3]), d = _mm256_unpackhi_pd(row[2], row[3]);
    const __m256d c0 = _mm256_permute2f128_pd(a, c, 0x20), c1 = _mm256_permute2f128_pd(b, d, 0x20);
    const __m256d c2 = _mm256_permute2f128_pd(a, c, 0x31), c3 = _mm256_permute2f128_pd(b, d, 0x31);
    const __m256d zero = _mm256_setzero_pd(), two = _mm256_set1_pd(2), three = _mm256_set1_pd(3), fall = top - next;
    __m256d       t = _mm256_and_pd((top - radiance) / fall, _mm256_cmp_pd(fall, zero, _CMP_GT_OQ));
    for (int i = 0; i < 3; i++) {
        const __m256d slope = c1 + t * (two * c2 + three * t * c3);
        const __m256d step = (c0 + t * (c1 + t * (c2 + t * c3)) - radiance) / slope;
        t -= _mm256_and_pd(step, _mm256_cmp_pd(slope, zero, _CMP_LT_OQ));
    }
    const __m256d cell = _mm256_cvtepi32_pd(_mm_loadu_si128((const __m128i *)low)) + t;
    return _mm256_set1_pd(1) / (_mm256_set1_pd(table->u0) + cell / _mm256_set1_pd(table->cells_per_u));
}

void planck_table_temps(double *temp_k, const PlanckTable *table, const float *radiance_w_m2_sr, int count)
{
    const __m256d most = _mm256_set1_pd(table->knot[0]), least = _mm256_set1_pd(table->knot[table_cells]);
    int           i = 0;
    for (; i + 4 <= count; i += 4) {
        const __m256d radiance = _mm256_cvtps_pd(_mm_loadu_ps(radiance_w_m2_sr + i));
        const __m256d within =
            _mm256_and_pd(_mm256_cmp_pd(radiance, most, _CMP_LE_OQ), _mm256_cmp_pd(radiance, least, _CMP_GE_OQ));
        if (_mm256_movemask_pd(within) == 0xf) _mm256_storeu_pd(temp_k + i, four_temps(table, radiance));
        else
            for (int k = i; k < i + 4; k++) temp_k[k] = planck_table_temp(table, (double)radiance_w_m2_sr[k]);
    }
    for (; i < count; i++) temp_k[i] = planck_table_temp(table, (double)radiance_w_m2_sr[i]);
}
