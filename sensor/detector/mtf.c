/* sensor/detector/mtf.c: closed-form modulation transfer functions of optics, detector footprint, smear and jitter. */
#include "sensor/detector/mtf.h"

/* Overlap of two unit circles whose centres are 2 x apart, over the area of one. */
static double lens(double x) { return x < 1 ? 2 / pi_rad * (acos(x) - x * sqrt(1 - x * x)) : 0; }

double mtf_aperture(double x, double obscuration)
{
    const double e = obscuration;
    x              = fabs(x);
    if (!(x < 1)) return x >= 1 ? 0 : NAN;
    if (x == 0) return 1; /* to the bit, so that a mean is kept */
    if (!(e > 0)) return lens(x);

    /* autocorrelation of an annulus: outer with outer, inner with inner, less twice outer with inner */
    const double outer = lens(x), inner = e * e * lens(x / e);
    double       cross = 2 * e * e; /* the inner circle lies wholly inside */
    if (2 * x > 1 - e) {
        cross = 0;
        if (2 * x < 1 + e) {
            const double cos_phi = clamp((1 + e * e - 4 * x * x) / (2 * e), -1, 1), phi = acos(cos_phi);
            cross = 2 * e * e - (2 * e / pi_rad * sin(phi) + (1 + e * e) / pi_rad * phi -
                                 2 * (1 - e * e) / pi_rad * atan((1 + e) / (1 - e) * tan(0.5 * phi)));
        }
    }
    return (outer + inner - cross) / (1 - e * e);
}

double mtf_sinc(double x)
{
    const double a = pi_rad * x;
    return fabs(a) < 1e-8 ? 1 : sin(a) / a;
}

double mtf_gauss(double sigma_px, double f_cyc_px)
{
    const double a = pi_rad * sigma_px * f_cyc_px;
    return exp(-2 * a * a);
}

double mtf_optics(const MtfChain *c, double fx, double fy)
{
    return isinf(c->cutoff_cyc_px) ? 1 : mtf_aperture(sqrt(fx * fx + fy * fy) / c->cutoff_cyc_px, c->obscuration);
}

/* sinc(w f) over the mean of n samples at (k + 0.5) / n of a pixel, k = 0 .. n - 1. */
static double footprint_axis(double footprint_px, int n, double f)
{
    return mtf_sinc(footprint_px * f) * mtf_sinc(f / n) / mtf_sinc(f);
}

double mtf_footprint(const MtfChain *c, double fx, double fy)
{
    return footprint_axis(c->footprint_px, c->places, fx) * footprint_axis(c->footprint_px, c->places, fy);
}

double mtf_smear(const MtfChain *c, double fx, double fy)
{
    return mtf_sinc(c->smear_px[0] * fx + c->smear_px[1] * fy);
}

double mtf_jitter(const MtfChain *c, double fx, double fy)
{
    return mtf_gauss(c->jitter_px, sqrt(fx * fx + fy * fy));
}

double mtf_chain(const MtfChain *c, double fx, double fy)
{
    return mtf_optics(c, fx, fy) * mtf_footprint(c, fx, fy) * mtf_smear(c, fx, fy) * mtf_jitter(c, fx, fy);
}
