/* sensor/detector/coupling.c: AC coupling: a first-order high pass along each line. */
#include "sensor/detector/coupling.h"

void coupling_apply(float *plane, int width, int height, const Scan *scan, double fc_t)
{
    const size_t count = (size_t)width * (size_t)height;
    const double share = -expm1(-2 * pi_rad * fc_t);
    double       mean  = 0;
    if (!(fc_t > 0)) return;
    for (size_t i = 0; i < count; i++) mean += isfinite(plane[i]) ? plane[i] : 0;
    mean /= (double)count;

    for (int r = 0; r < height; r++) {
        const bool back = scan->bidirectional && r % 2;
        double     base = mean; /* what the capacitor has taken up */
        for (int k = 0; k < width; k++) {
            float       *at = plane + (size_t)r * (size_t)width + (size_t)(back ? width - 1 - k : k);
            const double x  = *at;
            if (!isfinite(x)) continue;
            *at = (float)(x - base + mean);
            base += share * (x - base);
        }
    }
}
