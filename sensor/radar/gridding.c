/* sensor/radar/gridding.c: see gridding.h. */
#include "sensor/radar/gridding.h"

#include <pthread.h>
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

/* ---- weights as polynomials --------------------------------------------------------------------------- */

/* Weight i as a function of where its grid point lies, t = 0 .. 1 from the start of its stretch of the kernel: a
 * polynomial in s = 2 t - 1 through the kernel at Chebyshev's points, off by up to 1.6e-8 (sixteen exponentials a point
 * would be most of a sum's time). */
enum { degree = 10 };
static double         coefficient[degree + 1][width]; /* of s^d */
static pthread_once_t fitted = PTHREAD_ONCE_INIT;

static void fit(void)
{
    enum { points = degree + 1 };
    for (int i = 0; i < width; i++) {
        double before[points] = {1}, here[points] = {0, 1}; /* Chebyshev's polynomials by powers of s: T_0, T_1 */
        for (int n = 0; n < points; n++) {
            double sum = 0;
            for (int k = 0; k < points; k++) {
                const double angle = pi_rad * (k + 0.5) / points, t = 0.5 * (cos(angle) + 1);
                sum += kernel((t + i - width / 2.0) / (width / 2.0)) * cos(n * angle);
            }
            const double *of = n == 0 ? before : here;
            for (int d = 0; d < points; d++) coefficient[d][i] += (n == 0 ? 1.0 : 2.0) / points * sum * of[d];
            if (n == 0) continue;
            double after[points] = {0};
            for (int d = 0; d < points; d++) after[d] = (d > 0 ? 2 * here[d - 1] : 0) - before[d];
            memcpy(before, here, sizeof before);
            memcpy(here, after, sizeof here);
        }
    }
}

int gridding_spread(double weight[gridding_width], double turns, int points)
{
    pthread_once(&fitted, fit);
    const double at = turns * points, first = ceil(at - width / 2.0);
    const double s = 2 * (first - (at - width / 2.0)) - 1;
    double       sum[width];
    for (int i = 0; i < width; i++) sum[i] = coefficient[degree][i];
    for (int d = degree - 1; d >= 0; d--)
        for (int i = 0; i < width; i++) sum[i] = sum[i] * s + coefficient[d][i];
    memcpy(weight, sum, sizeof sum);
    const double round = first - points * floor(first / points);
    return round < points ? (int)round : 0;
}
