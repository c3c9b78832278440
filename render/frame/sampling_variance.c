/* render/frame/sampling_variance.c: squared error of a pixel's mean, estimated from its own samples. */
#include "render/frame/sampling_variance.h"

double error_budget_sampling_variance(const float *out, int n)
{
    double sum = 0;
    for (int row = 0; row < n; row++)
        for (int column = 0; column < n; column++) {
            const double here = (double)out[row * n + column];
            if (column + 1 < n) sum += (out[row * n + column + 1] - here) * (out[row * n + column + 1] - here);
            if (row + 1 < n) sum += (out[(row + 1) * n + column] - here) * (out[(row + 1) * n + column] - here);
        }
    return mean_variance_factor * sum / ((double)n * n * n * n);
}
