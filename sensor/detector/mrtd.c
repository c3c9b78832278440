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

void mrtd_noise_of(MrtdNoise *out, const SensorPreset *p, double signal_e, double per_unit_e, double exposure)
{
    const PhotonDetector d = preset_photons(p);
    const double reference_e = p->auto_exposure ? chain_exposed_share * d.well_e : photon_electrons(&d, 300, NULL);
    const double read_e2 = d.read_e * d.read_e, floor_e2 = exposure * d.dark_e + read_e2;
    const double step_e = d.well_e / (exp2(p->bits) - 1), scale2 = p->noise_scale * p->noise_scale;
    const double ref2 = scale2 * (reference_e + (d.dark_e + read_e2));
    const double gain2 = scale2 * p->prnu * p->prnu * signal_e * signal_e;
    *out = (MrtdNoise){.tvh_e2 = scale2 * (signal_e + floor_e2) + step_e * step_e / 12,
                       .gain_e2 = p->scan.by_columns ? 0 : gain2,
                       .row_gain_e2 = p->scan.by_columns ? gain2 : 0,
                       .line_e2 = ref2 * p->line_noise * p->line_noise,
                       .per_unit_e = per_unit_e};
    for (int k = 0; k < noise_axes; k++) out->kind_e2[k] = ref2 * p->ratio.sigma[k] * p->ratio.sigma[k];
}

void mrtd_noise_emitted(MrtdNoise *out, const SensorPreset *p, double temp_k)
{
    const PhotonDetector d = preset_photons(p);
    double               per_k;
    const double         signal_e = photon_electrons(&d, temp_k, &per_k);
    mrtd_noise_of(out, p, signal_e, per_k, 1);
}

void mrtd_noise_reflected(MrtdNoise *out, const SensorPreset *p, double signal_e, double exposure)
{
    mrtd_noise_of(out, p, signal_e, signal_e, exposure);
}

void mrtd_bars(MrtdBars *out, const SensorPreset *p, double f)
{
    const double width_px = 0.5 / f, reach = p->line_noise_px;
    out->across = white_left(width_px);
    out->along = white_left(7 * width_px);
    for (int axis = 0; axis < 2; axis++) {
        out->mtf[axis] = mtf_along(p, axis, f);
        out->all[axis] = contrast(p, axis, f, 15);
        out->first[axis] = contrast(p, axis, f, 1);
        out->line_across[axis] = out->across;
        out->line_along[axis] = out->along;
    }
    if (!(reach > 0)) return;
    out->line_across[0] = line_left(width_px, reach) - line_shared(width_px, reach);
    out->line_along[1] = out->across;
    out->line_across[1] = line_left(7 * width_px, reach);
}

void mrtd_at(Mrtd *out, const MrtdBars *bars, const MrtdNoise *noise, const MrtdObserver *observer)
{
    const double  frames = fmax(observer->frames, 1), in_time = 1 / frames, across = bars->across, along = bars->along;
    const double *kind2 = noise->kind_e2, line2 = noise->line_e2 / fmin(frames, line_scan_pool);
    for (int axis = 0; axis < 2; axis++) {
        double e2 = noise->tvh_e2 * in_time * across * along + kind2[NOISE_VH] * across * along;
        e2 += axis == 0 ? kind2[NOISE_TH] * in_time * across + kind2[NOISE_H] * across
                        : kind2[NOISE_TV] * in_time * across + kind2[NOISE_V] * across;
        e2 += noise->gain_e2 * across * along;
        if (axis == 1) e2 += noise->row_gain_e2 * across;
        e2 += line2 * bars->line_across[axis] * bars->line_along[axis];

        const double threshold = observer->snr * (sqrt(e2) / noise->per_unit_e);
        out->mtf[axis] = bars->mtf[axis];
        out->all_k[axis] = bars->all[axis] > 1e-12 ? threshold / bars->all[axis] : INFINITY;
        out->first_k[axis] = bars->first[axis] > 1e-12 ? threshold / bars->first[axis] : INFINITY;
    }
}

void mrtd_predict(Mrtd *out, const SensorPreset *p, double f, const MrtdObserver *observer)
{
    MrtdNoise noise;
    MrtdBars  bars;
    mrtd_noise_emitted(&noise, p, observer->temp_k);
    mrtd_bars(&bars, p, f);
    mrtd_at(out, &bars, &noise, observer);
}
