/* sensor/radar/detect.c: see detect.h. */
#include "sensor/radar/detect.h"

#include <stdlib.h>

static double power_at(const RangeDoppler *map, int row, int column)
{
    const double complex v = map->cell[(size_t)row * (size_t)map->columns + (size_t)column];
    return creal(v) * creal(v) + cimag(v) * cimag(v);
}

/* How much stronger one neighbour of a peak is than the other, over the peak, as amplitudes, for a point that lies
 * `cells` from the peak's cell: rises over 0 .. 0.5. */
static double imbalance(const IntervalPlan *plan, bool doppler, double cells)
{
    return (fabs(interval_lobe(plan, doppler, 1 - cells)) - fabs(interval_lobe(plan, doppler, 1 + cells))) /
           interval_lobe(plan, doppler, cells);
}

/* Where a point lies whose peak and neighbours have these powers, in cells from the middle one, -0.5 .. 0.5. *rise:
 * factor of its power there. */
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

static void measure(Detection *d, const RangeDoppler *map, const IntervalPlan *plan, const CfarHit *hit, const Antenna *antenna,
                    const DetectScale *scale)
{
    const int    row = hit->row, column = hit->column, rows = map->rows;
    const size_t plane = (size_t)map->rows * (size_t)map->columns, at = (size_t)row * (size_t)map->columns + (size_t)column;
    double       inside = 0, rise[2] = {1, 1};
    if (column > 0 && column < map->columns - 1)
        inside = place(&rise[0], plan, false, power_at(map, row, column - 1), hit->power,
                       power_at(map, row, column + 1));
    const double between = place(&rise[1], plan, true, power_at(map, (row + rows - 1) % rows, column), hit->power,
                                 power_at(map, (row + 1) % rows, column));
    const double power_w = hit->power * rise[0] * rise[1];
    *d = (Detection){.row = row, .column = column, .snr = power_w / hit->floor - 1};
    d->range_m = scale->range_m + (column + inside - map->columns / 2) * map->metre_per_column;
    d->range_rate_mps = scale->range_rate_mps + (row + between - rows / 2) * map->mps_per_row;

    const double complex sum = conj(map->cell[at]);
    antenna_direction(&d->cos_right, &d->cos_down, antenna, creal(map->cell[plane + at] * sum) / hit->power,
                      creal(map->cell[2 * plane + at] * sum) / hit->power);
    const double gain = antenna_gain(antenna, d->cos_right, d->cos_down).sum, g2 = gain * gain, r2 = d->range_m * d->range_m;
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
        found = cfar_detect(hit, capacity, config, power, map->rows, map->columns);
        if (found > 0) {
            qsort(hit, (size_t)found, sizeof *hit, stronger);
            for (int i = 0; i < found && i < most; i++) measure(&out[i], map, plan, &hit[i], antenna, scale);
        }
    }
    free(power);
    free(hit);
    return found;
}
