/* sensor/radar/gridding.c: see gridding.h. */
#include "sensor/radar/gridding.h"

#include <stdlib.h>

enum { width = gridding_width };
static const double beta = 2.30 * width; /* Barnett et al., equation 1.14, for twice the points */

/* |x| <= 1 is its support. */
static double kernel(double x)
{
    const double inside = 1 - x * x;
    return inside > 0 ? exp(beta * (sqrt(inside) - 1)) : 0;
}

/* Transform of the kernel at an angle of phase a grid point, by the midpoint rule: the kernel and its transform
 * vanish at both ends to e^-beta, so that 400 points leave 1e-9. */
static double kernel_transform(double rad_per_point)
{
    enum { points = 400 };
    double sum = 0;
    for (int i = 0; i < points; i++) {
        const double x = (i + 0.5) / points;
        sum += kernel(x) * cos(rad_per_point * x * width / 2);
    }
    return sum / points * width;
}

double *gridding_corrections(int count, int points)
{
    double *of = malloc((size_t)count * sizeof *of);
    for (int i = 0; i < count && of; i++) of[i] = 1 / kernel_transform(2 * pi_rad * (i - count / 2) / points);
    return of;
}

int gridding_spread(double weight[gridding_width], double turns, int points)
{
    const double at = turns * points;
    const double first = ceil(at - width / 2.0);
    for (int i = 0; i < width; i++) weight[i] = kernel((first + i - at) / (width / 2.0));
    const double round = first - points * floor(first / points);
    return round < points ? (int)round : 0;
}
