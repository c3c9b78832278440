/* tests/sensor/colorimetry.h: colorimetry, which the program has none of: spectra to CIE L* a* b*, and CIEDE2000. */
#ifndef TESTS_SENSOR_COLORIMETRY_H
#define TESTS_SENSOR_COLORIMETRY_H

#include "tests/sensor/colour_spectra.h"

#include "pitviper.h"

#include <math.h>
#include <stddef.h>

static inline double sum_of(const double *x, const double *y, const double *z, int from, int points, bool trapezoid)
{
    double sum = 0;
    for (int i = 0; i < points; i++)
        sum += (trapezoid && (i == 0 || i == points - 1) ? 0.5 : 1) * x[from + i] * (y ? y[from + i] : 1) *
               (z ? z[from + i] : 1);
    return sum;
}

/* XYZ over that of white. reflectance: NULL for white. */
static inline void eye_sees(double over_white[3], const double *reflectance)
{
    for (int k = 0; k < 3; k++)
        over_white[k] = sum_of(daylight_spectrum, observer[k], reflectance, 0, spectrum_points, false) /
                        sum_of(daylight_spectrum, observer[k], NULL, 0, spectrum_points, false);
}

/* CIE 1976 L* a* b*. */
static inline void lab_of(double lab[3], const double over_white[3])
{
    double f[3];
    for (int k = 0; k < 3; k++) {
        const double t = over_white[k], edge = 6.0 / 29;
        f[k] = t > edge * edge * edge ? cbrt(t) : t / (3 * edge * edge) + 4.0 / 29;
    }
    lab[0] = 116 * f[1] - 16, lab[1] = 500 * (f[0] - f[1]), lab[2] = 200 * (f[1] - f[2]);
}

/* Linear sRGB to the same; IEC 61966-2-1. */
static inline void lab_of_rgb(double lab[3], const double rgb[3])
{
    static const double xyz_from_rgb[3][3] = {
        {0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};
    double over_white[3];
    for (int k = 0; k < 3; k++) {
        const double *m = xyz_from_rgb[k];
        over_white[k] = (m[0] * rgb[0] + m[1] * rgb[1] + m[2] * rgb[2]) / (m[0] + m[1] + m[2]);
    }
    lab_of(lab, over_white);
}

static inline double hue_deg(const double lab[3])
{
    const double h = atan2(lab[2], lab[1]) / rad_per_deg;
    return h < 0 ? h + 360 : h;
}

/* CIEDE2000, all weights 1: CIE 142. */
static inline double ciede2000(const double a[3], const double b[3])
{
    const double c_mean = 0.5 * (hypot(a[1], a[2]) + hypot(b[1], b[2])), c7 = pow(c_mean, 7), big = pow(25, 7);
    const double g = 0.5 * (1 - sqrt(c7 / (c7 + big)));
    const double p[3] = {a[0], (1 + g) * a[1], a[2]}, q[3] = {b[0], (1 + g) * b[1], b[2]};
    const double cp = hypot(p[1], p[2]), cq = hypot(q[1], q[2]), hp = hue_deg(p), hq = hue_deg(q);
    double       dh = cp * cq > 0 ? hq - hp : 0;
    if (dh > 180) dh -= 360;
    if (dh < -180) dh += 360;
    const double dl = q[0] - p[0], dc = cq - cp, dH = 2 * sqrt(cp * cq) * sin(0.5 * dh * rad_per_deg);
    const double l = 0.5 * (p[0] + q[0]), c = 0.5 * (cp + cq);
    double       h = hp + hq;
    if (cp * cq > 0) h = fabs(hp - hq) <= 180 ? 0.5 * h : h < 360 ? 0.5 * (h + 360) : 0.5 * (h - 360);
    const double t = 1 - 0.17 * cos((h - 30) * rad_per_deg) + 0.24 * cos(2 * h * rad_per_deg) +
                     0.32 * cos((3 * h + 6) * rad_per_deg) - 0.20 * cos((4 * h - 63) * rad_per_deg);
    const double l50 = (l - 50) * (l - 50), cc7 = pow(c, 7);
    const double sl = 1 + 0.015 * l50 / sqrt(20 + l50), sc = 1 + 0.045 * c, sh = 1 + 0.015 * c * t;
    const double turn = 30 * exp(-pow((h - 275) / 25, 2));
    const double rt = -2 * sqrt(cc7 / (cc7 + big)) * sin(2 * turn * rad_per_deg);
    const double x = dl / sl, y = dc / sc, z = dH / sh;
    return sqrt(x * x + y * y + z * z + rt * y * z);
}

/* What the three bands hold of a spectrum, R G B. */
static inline void bands_see(double w[3], const double *reflectance)
{
    for (int c = 0; c < 3; c++) w[c] = sum_of(daylight_spectrum, reflectance, NULL, 20 - 10 * c, 11, true);
}

#endif
