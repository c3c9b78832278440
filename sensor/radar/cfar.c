/* sensor/radar/cfar.c: see cfar.h. */
#include "sensor/radar/cfar.h"

#include <stdlib.h>

double cfar_multiplier(int training, double pfa)
{
    if (training < 1 || training > 100000 || !(pfa > 0 && pfa < 1)) return NAN;
    return training * expm1(-log(pfa) / training);
}

/* Log of the rate of false alarms, falling in a. */
static double ordered_log_pfa(int training, int rank, double a)
{
    double sum = 0;
    for (int i = 0; i < rank; i++) sum -= log1p(a / (training - i));
    return sum;
}

double cfar_ordered_multiplier(int training, int rank, double pfa)
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

double cfar_detection(int training, double pfa, double snr)
{
    const double a = cfar_multiplier(training, pfa);
    return exp(-training * log1p(a / (training * (1 + snr))));
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
        const int     left = column > across ? column - across : 0, right = column + across < columns ? column + across : columns - 1;
        const bool    guarded = abs(dr) <= c->guard[0];
        const int     left_end = guarded ? column - c->guard[1] : right + 1; /* one stretch, or two beside the guard */
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

int cfar_detect(CfarHit *out, int most, const CfarConfig *c, const double *power, int rows, int columns)
{
    enum { least_training = 4, most_training = 1 << 16 };
    const bool fits = rows >= 1 && columns >= 1 && c->guard[0] >= 0 && c->guard[1] >= 0 && c->training[0] >= 0 &&
                      c->training[1] >= 0 && c->guard[0] + c->training[0] < 4096 && c->guard[1] + c->training[1] < 4096 &&
                      c->pfa > 0 && c->pfa < 1 && c->ordered >= 0 && c->ordered <= 1;
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
                multiplier[n] = c->ordered > 0 ? cfar_ordered_multiplier(n, rank, c->pfa) : cfar_multiplier(n, c->pfa);
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
