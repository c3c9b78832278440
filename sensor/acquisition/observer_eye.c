/* sensor/acquisition/observer_eye.c: contrast threshold and transfer of an observer's eyes, in closed forms. */
#include "sensor/acquisition/observer_eye.h"

double eye_threshold(double u, double luminance_cd_m2, double field_deg)
{
    const double near = 1 + u / 3,
                 a = 540 * pow(1 + 0.7 / luminance_cd_m2, -0.2) / (1 + 12 / (field_deg * near * near));
    const double b = 0.3 * pow(1 + 100 / luminance_cd_m2, 0.15), c = 0.06;
    return exp(b * u) / (a * u * sqrt(1 + c * exp(b * u)));
}

double eye_transfer(double f, double luminance_cd_m2)
{
    static const double cd_m2_per_fl = 3.4262590996;
    /* of two eyes: 0.5 mm less than of one */
    const double pupil_mm = -9.011 + 13.23 * exp(-log10(luminance_cd_m2 / cd_m2_per_fl) / 21.082) - 0.5;
    const double f0 = exp(3.663 - 0.0216 * pupil_mm * pupil_mm * log(pupil_mm)) / 43.69,
                 power = 0.7155 + 0.277 / sqrt(pupil_mm);
    return exp(-pow(f / f0, power * power) - 0.375 * pow(f, 1.21) - 0.4441 * f * f);
}

double eye_channel(double f_noise, double f)
{
    const double octaves = log(f_noise / f);
    return exp(-2.2 * octaves * octaves);
}
