/* sensor/score/interval.c: score intervals of shares and of counts, over sequences. */
#include "sensor/score/interval.h"

static const double z_95 = 1.9599639845400543; /* standard normal, 97.5 % */

double interval_samples(double sum_w, double sum_w2) { return sum_w2 > 0 ? sum_w * sum_w / sum_w2 : 0; }

Interval interval_of_share(double share, double samples)
{
    if (!(samples > 0)) return (Interval){NAN, NAN};
    const double z2 = z_95 * z_95, per = 1 / (1 + z2 / samples), middle = share + z2 / (2 * samples);
    const double half = z_95 * sqrt(share * (1 - share) / samples + z2 / (4 * samples * samples));
    /* at 0 and 1 the bound is that to the bit */
    return (Interval){share > 0 ? per * (middle - half) : 0, share < 1 ? per * (middle + half) : 1};
}

Interval interval_of_count(double mean, double samples, double dispersion)
{
    if (!(samples > 0)) return (Interval){NAN, NAN};
    /* the means m for which (mean - m)^2 = z^2 dispersion m / samples */
    const double c = z_95 * z_95 * dispersion / samples, half = sqrt(mean * c + c * c / 4);
    return (Interval){mean > 0 ? mean + c / 2 - half : 0, mean + c / 2 + half};
}

double interval_dispersion(double sum_x, double sum_x2_w, double sum_w, double sum_w2)
{
    const double samples = interval_samples(sum_w, sum_w2);
    if (!(samples > 1) || !(sum_x > 0)) return 1;
    const double mean = sum_x / sum_w;
    /* the variance of x / w about their common mean, with weights w, without bias where it does not depend on w */
    const double variance = (sum_x2_w - mean * sum_x) / (sum_w * (1 - 1 / samples));
    return variance > mean ? variance / mean : 1;
}
