/* sensor/detector/mrtd.c: the minimum resolvable temperature difference, from the figures of a sensor. */
#include "sensor/detector/mrtd.h"

#include "sensor/detector/chain.h"

/* Share of white noise in square pixels that remains in a mean over a length; below a pixel, that of the pixel. */
static double white_left(double length_px)
{
    return length_px > 1 ? (1 - 1 / (3 * length_px)) / length_px : 1 - length_px / 3;
}

/* For noise whose correlation is exp(-x / reach): the variance of its mean over a length, and the covariance of two
 * adjacent such means. */
static double line_left(double length_px, double reach_px)
{
    const double u = length_px / reach_px;
    return u < 1e-6 ? 1 : 2 * (u + expm1(-u)) / (u * u);
}

static double line_shared(double length_px, double reach_px)
{
    const double u = length_px / reach_px, mean = u < 1e-6 ? 1 : -expm1(-u) / u;
    return mean * mean;
}

/* The MTF of the detector's chain (chain.c), for an image averaged over whole pixels. */
static double mtf_along(const SensorPreset *p, int axis, double f)
{
    const PhotonDetector *d = &p->photons;
    const MtfChain        mtf = {.cutoff_cyc_px = d->pitch_m / (chain_wavelength_m(p, -1) * d->f_number),
                                 .obscuration = p->obscuration,
                                 .footprint_px = p->footprint,
                                 .places = 1,
                                 .jitter_px = p->jitter_px};
    const double          sweep_px = axis == 0 && p->scan.by_columns ? d->integration_s / p->scan.line_s : 0;
    return mtf_chain(&mtf, axis == 0 ? f : 0, axis == 0 ? 0 : f) * mtf_sinc(sweep_px * f);
}

/* Mean of a bar minus that of the adjacent gap, of bars of 1. */
static double contrast(const SensorPreset *p, int axis, double f, int harmonics)
{
    double sum = 0;
    for (int n = 1; n <= harmonics; n += 2) sum += mtf_along(p, axis, n * f) * mtf_sinc(n * f) / (n * n);
    return 8 / (pi_rad * pi_rad) * sum;
}

void mrtd_predict(Mrtd *out, const SensorPreset *p, double f, const MrtdObserver *observer)
{
    const PhotonDetector d = preset_photons(p);
    double               per_k;
    const double signal_e = photon_electrons(&d, observer->temp_k, &per_k), at_300_e = photon_electrons(&d, 300, NULL);
    const double floor_e2 = d.dark_e + d.read_e * d.read_e, step_e = d.well_e / (exp2(p->bits) - 1);
    const double scale2 = p->noise_scale * p->noise_scale, ref2 = scale2 * (at_300_e + floor_e2);
    const double gain2 = scale2 * p->prnu * p->prnu * signal_e * signal_e;
    const double tvh2 = scale2 * (signal_e + floor_e2) + step_e * step_e / 12;
    const double frames = fmax(observer->frames, 1), in_time = 1 / frames, width_px = 0.5 / f;
    double       kind2[noise_axes];
    for (int k = 0; k < noise_axes; k++) kind2[k] = ref2 * p->ratio.sigma[k] * p->ratio.sigma[k];

    for (int axis = 0; axis < 2; axis++) {
        const double across = white_left(width_px), along = white_left(7 * width_px);
        double       e2 = tvh2 * in_time * across * along + kind2[NOISE_VH] * across * along;
        e2 += axis == 0 ? kind2[NOISE_TH] * in_time * across + kind2[NOISE_H] * across
                        : kind2[NOISE_TV] * in_time * across + kind2[NOISE_V] * across;
        if (!p->scan.by_columns) e2 += gain2 * across * along;
        else if (axis == 1) e2 += gain2 * across; /* a row has one detector's gain */
        const double line2 = ref2 * p->line_noise * p->line_noise / fmin(frames, line_scan_pool);
        const double reach = p->line_noise_px;
        if (line2 > 0 && !(reach > 0)) e2 += line2 * across * along;
        else if (line2 > 0 && axis == 0)
            e2 += line2 * (line_left(width_px, reach) - line_shared(width_px, reach)) * along;
        else if (line2 > 0) e2 += line2 * line_left(7 * width_px, reach) * across;

        const double noise_k = sqrt(e2) / per_k, all = contrast(p, axis, f, 15), first = contrast(p, axis, f, 1);
        out->mtf[axis] = mtf_along(p, axis, f);
        out->all_k[axis] = all > 1e-12 ? observer->snr * noise_k / all : INFINITY;
        out->first_k[axis] = first > 1e-12 ? observer->snr * noise_k / first : INFINITY;
    }
}
