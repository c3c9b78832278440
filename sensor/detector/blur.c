/* sensor/detector/blur.c: modulation transfer in closed forms, and its application to a plane. */
#include "sensor/detector/blur_private.h"
#include "sensor/detector/transform.h"

#include <stdlib.h>

/* Overlap of two unit circles whose centres are 2 x apart, over the area of one. */
static double lens(double x) { return x < 1 ? 2 / pi_rad * (acos(x) - x * sqrt(1 - x * x)) : 0; }

double mtf_aperture(double x, double obscuration)
{
    const double e = obscuration;
    x = fabs(x);
    if (!(x < 1)) return x >= 1 ? 0 : NAN;
    if (x == 0) return 1; /* to the bit, so that a mean is kept */
    if (!(e > 0)) return lens(x);

    /* the autocorrelation of an annulus is that of the outer disc plus that of the inner disc, less twice their
     * cross-correlation */
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

/* Computes sinc(w f) over the transfer of averaging n samples at (k + 0.5) / n of a pixel, k = 0 .. n - 1. */
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

double mtf_jitter(const MtfChain *c, double fx, double fy) { return mtf_gauss(c->jitter_px, sqrt(fx * fx + fy * fy)); }

double mtf_chain(const MtfChain *c, double fx, double fy)
{
    return mtf_optics(c, fx, fy) * mtf_footprint(c, fx, fy) * mtf_smear(c, fx, fy) * mtf_jitter(c, fx, fy);
}

/* ---- a plane, by cosine and sine transforms ----------------------------------------------------- */

struct Blur {
    int        width, height;
    double    *value, *odd;       /* [height][width]: plane or cosine coefficients; coefficients of the odd part */
    double    *pass;              /* [height][width]: the chain without smear, over 4 width height */
    double    *along, *odd_along; /* [width] */
    Transform *cosines, *back, *back_odd;
};

/* The frequency at which the chain is evaluated for frequency f of a row or column: f itself to 0.4, then bending to a
 * level end at 0.5 (slope and curvature continuous at both), so that the chain's mirror image beyond Nyquist joins
 * without a kink. A kink rings: 1 / n^2 with alternating sign, 0.4 % of a contrast four pixels away, visible as
 * stripes next to an exhaust. Tapered, the point spread of a chain with optics is positive to within rounding,
 * as a real one is. */
double blur_tapered(double f_cyc_px)
{
    static const double from = 0.4, width = 0.1;
    const double        f = fabs(f_cyc_px), u = (f - from) / width;
    return u <= 0 ? f_cyc_px : copysign(from + width * u * (1 - u * u * (1 - 0.5 * u)), f_cyc_px);
}

/* The transfer of an oblique smear differs between fx and -fx, which are the same frequency at 0.5: without this the
 * step there rings with 1 / n along rows and columns. */
static double odd_share(double f_cyc_px)
{
    const double u = clamp((fabs(f_cyc_px) - 0.4) / 0.1, 0, 1);
    return 1 - u * u * u * (10 - u * (15 - 6 * u));
}

double blur_smear_pass(const double smear_px[2], double fx, double fy)
{
    const double along = smear_px[0] * blur_tapered(fx), down = smear_px[1] * blur_tapered(fy);
    const double plus = mtf_sinc(along + down), minus = mtf_sinc(along - down);
    return 0.5 * (plus + minus) + 0.5 * (plus - minus) * odd_share(fx) * odd_share(fy);
}

Status blur_create(Blur **out, int width, int height, const MtfChain *chain)
{
    const size_t count = (size_t)width * (size_t)height;
    MtfChain     still = *chain;
    Blur        *b = calloc(1, sizeof *b);
    if (!b) return STATUS_NO_MEMORY;
    still.smear_px[0] = still.smear_px[1] = 0;
    b->width = width;
    b->height = height;
    b->value = transform_alloc(count);
    b->odd = transform_alloc(count);
    b->pass = transform_alloc(count);
    b->along = transform_alloc((size_t)width);
    b->odd_along = transform_alloc((size_t)width);
    Status status = b->value && b->odd && b->pass && b->along && b->odd_along ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK)
        status = transform_create(&b->cosines, TRANSFORM_COSINES, height, width, b->value, b->value);
    if (status == STATUS_OK)
        status = transform_create(&b->back, TRANSFORM_COSINES_BACK, height, width, b->value, b->value);
    if (status == STATUS_OK)
        status = transform_create(&b->back_odd, TRANSFORM_SINES_BACK, height, width, b->odd, b->odd);
    if (status != STATUS_OK) {
        blur_destroy(b);
        return status;
    }
    for (int r = 0; r < height; r++)
        for (int c = 0; c < width; c++)
            b->pass[(size_t)r * (size_t)width + (size_t)c] =
                mtf_chain(&still, blur_tapered(0.5 * c / width), blur_tapered(0.5 * r / height)) /
                (4.0 * (double)count);
    *out = b;
    return STATUS_OK;
}

void blur_destroy(Blur *b)
{
    if (!b) return;
    transform_destroy(b->cosines);
    transform_destroy(b->back);
    transform_destroy(b->back_odd);
    transform_free(b->value);
    transform_free(b->odd);
    transform_free(b->pass);
    transform_free(b->along);
    transform_free(b->odd_along);
    free(b);
}

/* cos(a x) cos(b y) smeared along (dx, dy) is even cos cos + odd sin sin, with the half sum and half difference of the
 * sinc at (fx, fy) and at (fx, -fy). The sine transform counts its frequencies from 1: one place up and to the left. */
static void smear(Blur *b, const double smear_px[2], bool oblique)
{
    const int w = b->width, h = b->height;
    if (oblique) memset(b->odd, 0, (size_t)w * (size_t)h * sizeof *b->odd);
    for (int c = 0; c < w; c++) {
        b->along[c] = smear_px[0] * blur_tapered(0.5 * c / w);
        b->odd_along[c] = odd_share(0.5 * c / w);
    }
    for (int r = 0; r < h; r++) {
        const double down = smear_px[1] * blur_tapered(0.5 * r / h), share = odd_share(0.5 * r / h);
        for (int c = 0; c < w; c++) {
            const size_t at = (size_t)r * (size_t)w + (size_t)c;
            const double along = b->along[c];
            const double plus = mtf_sinc(along + down), minus = oblique ? mtf_sinc(along - down) : plus;
            if (oblique && r > 0 && c > 0)
                b->odd[at - (size_t)w - 1] = 0.5 * (minus - plus) * share * b->odd_along[c] * b->value[at];
            b->value[at] *= 0.5 * (plus + minus);
        }
    }
}

void blur_apply(Blur *b, float *out, const float *in, const double smear_px[2])
{
    blur_apply_with(b, out, in, smear_px, NULL);
}

void blur_apply_with(Blur *b, float *out, const float *in, const double smear_px[2], const double *more)
{
    const size_t count = (size_t)b->width * (size_t)b->height;
    const bool   oblique = smear_px[0] != 0 && smear_px[1] != 0;
    for (size_t i = 0; i < count; i++) b->value[i] = isfinite(in[i]) ? in[i] : 0;
    transform_run(b->cosines);
    for (size_t i = 0; i < count; i++) b->value[i] *= b->pass[i];
    if (smear_px[0] != 0 || smear_px[1] != 0) smear(b, smear_px, oblique);
    transform_run(b->back);
    if (oblique) {
        transform_run(b->back_odd);
        for (size_t i = 0; i < count; i++) b->value[i] += b->odd[i];
    }
    for (size_t i = 0; more && i < count; i++) b->value[i] += more[i];
    for (size_t i = 0; i < count; i++) out[i] = isfinite(in[i]) ? (float)(b->value[i] > 0 ? b->value[i] : 0) : in[i];
}
