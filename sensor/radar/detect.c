/* sensor/radar/detect.c: thresholds of constant false alarms, detections between cells, and moving targets. */
#include "sensor/radar/detect_private.h"
#include "render/scattering/scatter.h"

#include <stdlib.h>

double detect_cfar_multiplier(int training, double pfa)
{
    if (training < 1 || training > 100000 || !(pfa > 0 && pfa < 1)) return NAN;
    return training * expm1(-log(pfa) / training);
}

/* Log of the false-alarm rate, which falls with a. */
static double ordered_log_pfa(int training, int rank, double a)
{
    double sum = 0;
    for (int i = 0; i < rank; i++) sum -= log1p(a / (training - i));
    return sum;
}

double detect_ordered_multiplier(int training, int rank, double pfa)
{
    if (training < 1 || training > 100000 || rank < 1 || rank > training || !(pfa > 0 && pfa < 1)) return NAN;
    double low = 0, high = 1;
    while (ordered_log_pfa(training, rank, high) > log(pfa)) {
        low = high;
        high *= 2;
        if (isinf(high)) return NAN;
    }
    for (int i = 0; i < 200 && high - low > 1e-13 * high; i++) {
        const double middle = 0.5 * (low + high);
        if (ordered_log_pfa(training, rank, middle) > log(pfa)) low = middle;
        else high = middle;
    }
    return 0.5 * (low + high);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The training cells of a place into cell[]; returns how many lie within the plane. */
static int gather(double *cell, const CfarConfig *c, const double *power, int rows, int columns, int row, int column)
{
    const int reach = c->guard[0] + c->training[0], across = c->guard[1] + c->training[1];
    int       count = 0;
    for (int dr = -reach; dr <= reach; dr++) {
        int r = row + dr;
        if (c->wrap_rows) r = (r % rows + rows) % rows;
        if (r < 0 || r >= rows) continue;
        const double *from = power + (size_t)r * (size_t)columns;
        const int     left = column > across ? column - across : 0,
                  right = column + across < columns ? column + across : columns - 1;
        const bool guarded = abs(dr) <= c->guard[0];
        const int  left_end = guarded ? column - c->guard[1] : right + 1; /* one stretch, or two beside the guard */
        for (int at = left; at < left_end; at++) cell[count++] = from[at];
        for (int at = column + c->guard[1] + 1; guarded && at <= right; at++) cell[count++] = from[at];
    }
    return count;
}

static bool greatest_of_neighbours(const CfarConfig *c, const double *power, int rows, int columns, int row, int column)
{
    const size_t own = (size_t)row * (size_t)columns + (size_t)column;
    for (int dr = -1; dr <= 1; dr++)
        for (int dc = -1; dc <= 1; dc++) {
            int r = row + dr;
            if (c->wrap_rows) r = (r % rows + rows) % rows;
            if (r < 0 || r >= rows || column + dc < 0 || column + dc >= columns) continue;
            const size_t other = (size_t)r * (size_t)columns + (size_t)(column + dc);
            if (power[other] > power[own] || (power[other] == power[own] && other < own)) return false;
        }
    return true;
}

int detect_cfar(CfarHit *out, int most, const CfarConfig *c, const double *power, int rows, int columns)
{
    enum { least_training = 4, most_training = 1 << 16 };
    const bool fits = rows >= 1 && columns >= 1 && c->guard[0] >= 0 && c->guard[1] >= 0 && c->training[0] >= 0 &&
                      c->training[1] >= 0 && c->guard[0] + c->training[0] < 4096 &&
                      c->guard[1] + c->training[1] < 4096 && c->pfa > 0 && c->pfa < 1 && c->ordered >= 0 &&
                      c->ordered <= 1;
    if (!fits) return -1;
    const int block = (2 * (c->guard[0] + c->training[0]) + 1) * (2 * (c->guard[1] + c->training[1]) + 1);
    /* a wrapped window wider than the plane would count cells twice */
    if (block > most_training || (c->wrap_rows && 2 * (c->guard[0] + c->training[0]) + 1 > rows)) return -1;
    double *cell = malloc((size_t)block * sizeof *cell), *multiplier = malloc(((size_t)block + 1) * sizeof *multiplier);
    if (!cell || !multiplier) {
        free(cell);
        free(multiplier);
        return -1;
    }
    for (int n = 0; n <= block; n++) multiplier[n] = NAN; /* by number of training cells, on first use */

    int found = 0;
    for (int row = 0; row < rows; row++)
        for (int column = 0; column < columns; column++) {
            const double own = power[(size_t)row * (size_t)columns + (size_t)column];
            if (!(own > 0) || !greatest_of_neighbours(c, power, rows, columns, row, column)) continue;
            const int n = gather(cell, c, power, rows, columns, row, column);
            if (n < least_training) continue;
            const int rank = (int)fmax(1, round(c->ordered * n));
            if (isnan(multiplier[n]))
                multiplier[n] =
                    c->ordered > 0 ? detect_ordered_multiplier(n, rank, c->pfa) : detect_cfar_multiplier(n, c->pfa);
            double sum = 0, statistic, mean = 0;
            for (int i = 0; i < n; i++) sum += cell[i];
            if (c->ordered > 0) {
                qsort(cell, (size_t)n, sizeof *cell, ascending);
                statistic = cell[rank - 1];
                for (int i = 0; i < rank; i++) mean += 1.0 / (n - i); /* of the k-th smallest of n of mean 1 */
                mean = statistic / mean;
            } else {
                statistic = mean = sum / n;
            }
            if (!(own > multiplier[n] * statistic)) continue;
            if (found < most) out[found] = (CfarHit){row, column, own, mean};
            found++;
        }
    free(cell);
    free(multiplier);
    return found;
}

/* ---- detections --------------------------------------------------------------------------------- */

static double power_at(const RangeDoppler *map, int row, int column)
{
    const double complex v = map->cell[(size_t)row * (size_t)map->columns + (size_t)column];
    return creal(v) * creal(v) + cimag(v) * cimag(v);
}

/* Imbalance of a peak's neighbours for a point that lies `cells` from the peak's cell: the difference of their
 * amplitudes over that of the peak. It rises over 0 .. 0.5. */
static double imbalance(const IntervalPlan *plan, bool doppler, double cells)
{
    return (fabs(interval_lobe(plan, doppler, 1 - cells)) - fabs(interval_lobe(plan, doppler, 1 + cells))) /
           interval_lobe(plan, doppler, cells);
}

/* Finds where a point lies whose peak and neighbours have these powers, in cells from the middle one, -0.5 .. 0.5.
 * *rise: the factor from the peak's power to the point's. */
static double place(double *rise, const IntervalPlan *plan, bool doppler, double before, double peak, double after)
{
    const double measured = (sqrt(after) - sqrt(before)) / sqrt(peak);
    double       low = 0, high = 0.5;
    for (int i = 0; i < 30; i++) {
        const double middle = 0.5 * (low + high);
        if (imbalance(plan, doppler, middle) < fabs(measured)) low = middle;
        else high = middle;
    }
    const double lobe = interval_lobe(plan, doppler, low);
    *rise = 1 / (lobe * lobe);
    return copysign(low, measured);
}

static void measure(Detection *d, const RangeDoppler *map, const IntervalPlan *plan, const CfarHit *hit,
                    const Antenna *antenna, const DetectScale *scale)
{
    const int    row = hit->row, column = hit->column, rows = map->rows;
    const size_t plane = (size_t)map->rows * (size_t)map->columns,
                 at = (size_t)row * (size_t)map->columns + (size_t)column;
    double inside = 0, rise[2] = {1, 1};
    if (column > 0 && column < map->columns - 1)
        inside =
            place(&rise[0], plan, false, power_at(map, row, column - 1), hit->power, power_at(map, row, column + 1));
    const double between = place(&rise[1], plan, true, power_at(map, (row + rows - 1) % rows, column), hit->power,
                                 power_at(map, (row + 1) % rows, column));
    const double power_w = hit->power * rise[0] * rise[1];
    *d = (Detection){.row = row, .column = column, .snr = power_w / hit->floor - 1};
    d->range_m = scale->range_m + (column + inside - map->columns / 2) * map->metre_per_column;
    d->range_rate_mps = scale->range_rate_mps + (row + between - rows / 2) * map->mps_per_row;

    const double complex sum = conj(map->cell[at]);
    antenna_direction(&d->cos_right, &d->cos_down, antenna, creal(map->cell[plane + at] * sum) / hit->power,
                      creal(map->cell[2 * plane + at] * sum) / hit->power);
    const double gain = antenna_gain(antenna, d->cos_right, d->cos_down).sum, g2 = gain * gain,
                 r2 = d->range_m * d->range_m;
    d->rcs_m2 = power_w * r2 * r2 * exp(2 * scale->air_np_m * d->range_m) / (scale->unit_w * g2 * g2);
}

static int stronger(const void *a, const void *b)
{
    const CfarHit *x = a, *y = b;
    if (x->power != y->power) return x->power < y->power ? 1 : -1;
    return x->row != y->row ? x->row - y->row : x->column - y->column;
}

int detect(Detection *out, int most, const RangeDoppler *map, const IntervalPlan *plan, const CfarConfig *config,
           const Antenna *antenna, const DetectScale *scale)
{
    const int count = map->rows * map->columns;
    const int capacity = ((map->rows + 1) / 2) * ((map->columns + 1) / 2); /* of peaks among eight neighbours */
    double   *power = malloc((size_t)count * sizeof *power);
    CfarHit  *hit = malloc((size_t)capacity * sizeof *hit);
    int       found = -1;
    if (power && hit) {
        for (int i = 0; i < count; i++) power[i] = power_at(map, i / map->columns, i % map->columns);
        found = detect_cfar(hit, capacity, config, power, map->rows, map->columns);
        if (found > 0) {
            qsort(hit, (size_t)found, sizeof *hit, stronger);
            for (int i = 0; i < found && i < most; i++) measure(&out[i], map, plan, &hit[i], antenna, scale);
        }
    }
    free(power);
    free(hit);
    return found;
}

/* ---- moving targets ----------------------------------------------------------------------------- */

/* Binomial, of unit energy. */
static void canceller(double weight[mti_rows_most], int rows)
{
    const double two[mti_rows_most] = {1, -1, 0}, three[mti_rows_most] = {1, -2, 1};
    for (int i = 0; i < mti_rows_most; i++) weight[i] = rows == 2 ? two[i] / sqrt(2) : three[i] / sqrt(6);
}

static double wave_rad_m(const Waveform *wave) { return 2 * pi_rad * wave->centre_hz / light_mps; }

void detect_mti_profile(double *out, const double *pulse, const Waveform *wave, int rows, double clutter_path_m)
{
    const int      samples = wave->samples, last = wave->pulses - rows;
    double         weight[mti_rows_most];
    double complex factor[mti_rows_most];
    canceller(weight, rows);
    for (int i = 0; i < mti_rows_most; i++) factor[i] = weight[i] * cexp(I * wave_rad_m(wave) * clutter_path_m * i);
    for (int m = 0; m < samples; m++) out[m] = 0;
    for (int n = 0; n <= last; n++)
        for (int m = 0; m < samples; m++) {
            double re = 0, im = 0;
            for (int i = 0; i < rows; i++) {
                const double *v = pulse + 2 * ((size_t)(n + i) * (size_t)samples + (size_t)m);
                re += v[0] * creal(factor[i]) - v[1] * cimag(factor[i]);
                im += v[0] * cimag(factor[i]) + v[1] * creal(factor[i]);
            }
            out[m] += (re * re + im * im) / (last + 1);
        }
}

double detect_mti_gain(const Waveform *wave, int rows, double path_m)
{
    double         weight[mti_rows_most];
    double complex sum = 0;
    canceller(weight, rows);
    for (int i = 0; i < rows; i++) sum += weight[i] * cexp(-I * wave_rad_m(wave) * path_m * i);
    return creal(sum) * creal(sum) + cimag(sum) * cimag(sum);
}

bool detect_moves(double rate_mps, double ground_mps, double notch_mps, double blind_mps)
{
    const double off_mps = rate_mps - ground_mps;
    return fabs(off_mps - blind_mps * nearbyint(off_mps / blind_mps)) > notch_mps;
}
