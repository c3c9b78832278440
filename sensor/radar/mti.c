/* sensor/radar/mti.c: see mti.h. */
#include "sensor/radar/mti.h"

#include "render/radar/scatter.h"

/* Binomial, of unit energy. */
static void canceller(double weight[mti_rows_most], int rows)
{
    const double two[mti_rows_most] = {1, -1, 0}, three[mti_rows_most] = {1, -2, 1};
    for (int i = 0; i < mti_rows_most; i++) weight[i] = rows == 2 ? two[i] / sqrt(2) : three[i] / sqrt(6);
}

static double wave_rad_m(const Waveform *wave) { return 2 * pi_rad * wave->centre_hz / light_mps; }

void mti_profile(double *out, const double *pulse, const Waveform *wave, int rows, double clutter_path_m)
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

double mti_gain(const Waveform *wave, int rows, double path_m)
{
    double         weight[mti_rows_most];
    double complex sum = 0;
    canceller(weight, rows);
    for (int i = 0; i < rows; i++) sum += weight[i] * cexp(-I * wave_rad_m(wave) * path_m * i);
    return creal(sum) * creal(sum) + cimag(sum) * cimag(sum);
}

bool mti_moves(double rate_mps, double ground_mps, double notch_mps, double blind_mps)
{
    const double off_mps = rate_mps - ground_mps;
    return fabs(off_mps - blind_mps * nearbyint(off_mps / blind_mps)) > notch_mps;
}
