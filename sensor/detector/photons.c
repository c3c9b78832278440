/* sensor/detector/photons.c: in-band photon radiance, electrons, and noise-equivalent temperature difference. */
#include "sensor/detector/photons.h"

#include "render/materials/planck.h"

#include <stdlib.h>

/* Exact since the 2019 SI. */
static const double h_j_s = 6.62607015e-34, c_mps = 299792458.0, k_j_k = 1.380649e-23;

/* The positive half of the 8-point Gauss-Legendre rule on [-1, 1] (Abramowitz & Stegun, table 25.4). */
static const double gauss_node[4] = {0.1834346424956498049394761424, 0.5255324099163289858177390492,
                                     0.7966664774136267395915539365, 0.9602898564975362316835608686};
static const double gauss_weight[4] = {0.3626837833783619829651504493, 0.3137066458778872873379622020,
                                       0.2223810344533744705443559944, 0.1012285362903762591525313543};

double photon_band(double low_m, double high_m, double temp_k, double *derivative)
{
    enum { panels = 16 };
    if (!(low_m > 0 && high_m > low_m && isfinite(high_m) && temp_k > 0)) {
        if (derivative) *derivative = NAN;
        return NAN;
    }
    const double hc = h_j_s * c_mps, half_m = 0.5 * (high_m - low_m) / panels;
    double       sum = 0, slope = 0;
    for (int p = 0; p < panels; p++)
        for (int i = 0; i < 8; i++) {
            const double at = i < 4 ? -gauss_node[i] : gauss_node[i - 4];
            const double w_m = low_m + half_m * (2 * p + 1 + at), x = hc / (w_m * k_j_k * temp_k);
            const double q = gauss_weight[i & 3] * half_m * planck_radiance(w_m, temp_k) * w_m / hc;
            sum += q;
            slope += q * x / (temp_k * -expm1(-x));
        }
    if (derivative) *derivative = slope;
    return sum;
}

double photon_mean_wavelength_m(double low_m, double high_m, double temp_k)
{
    /* a photon's energy is hc / wavelength: ratio of photons times wavelength to photons, both by the same nodes */
    enum { panels = 16 };
    if (!(low_m > 0 && high_m > low_m && isfinite(high_m) && temp_k > 0)) return NAN;
    const double half_m = 0.5 * (high_m - low_m) / panels;
    double       photons = 0, moment = 0;
    for (int p = 0; p < panels; p++)
        for (int i = 0; i < 8; i++) {
            const double at = i < 4 ? -gauss_node[i] : gauss_node[i - 4], w_m = low_m + half_m * (2 * p + 1 + at);
            const double q = gauss_weight[i & 3] * planck_radiance(w_m, temp_k) * w_m;
            photons += q;
            moment += q * w_m;
        }
    return moment / photons;
}

double photon_seen(const SpectralBand *band, double temp_k, double *derivative)
{
    const SpectralResponse *r = band->response;
    if (!r || !(temp_k > 0)) return photon_band(band->low_m, band->high_m, temp_k, derivative);
    const double hc = h_j_s * c_mps;
    double       sum = 0, slope = 0;
    for (int i = 0; i < r->nodes; i++) {
        const double w_m = r->node_m[i], x = hc / (w_m * k_j_k * temp_k);
        const double q = r->weight_m[i] * planck_radiance(w_m, temp_k) * w_m / hc;
        sum += q;
        slope += q * x / (temp_k * -expm1(-x));
    }
    if (derivative) *derivative = slope;
    return sum;
}

double photon_seen_wavelength_m(const SpectralBand *band, double temp_k)
{
    const SpectralResponse *r = band->response;
    if (!r || !(temp_k > 0)) return photon_mean_wavelength_m(band->low_m, band->high_m, temp_k);
    double photons = 0, moment = 0;
    for (int i = 0; i < r->nodes; i++) {
        const double q = r->weight_m[i] * planck_radiance(r->node_m[i], temp_k) * r->node_m[i];
        photons += q;
        moment += q * r->node_m[i];
    }
    return moment / photons;
}

static SpectralBand seen_by(const PhotonDetector *d) { return (SpectralBand){d->low_m, d->high_m, d->response}; }

/* Mean wavelength of equal light at all wavelengths. */
static double middle_m(const SpectralBand *band)
{
    const SpectralResponse *r = band->response;
    double                  sum = 0, moment = 0;
    for (int i = 0; r && i < r->nodes; i++) sum += r->weight_m[i], moment += r->weight_m[i] * r->node_m[i];
    return r ? moment / sum : 0.5 * (band->low_m + band->high_m);
}

double photon_etendue(const PhotonDetector *d)
{
    const double solid_angle_sr = pi_rad / (4 * d->f_number * d->f_number + 1);
    return solid_angle_sr * d->pitch_m * d->pitch_m * d->transmission * d->qe * d->integration_s;
}

double photon_electrons(const PhotonDetector *d, double temp_k, double *per_k)
{
    double             slope;
    const SpectralBand seen = seen_by(d);
    const double       k = photon_etendue(d), q = photon_seen(&seen, temp_k, &slope);
    if (per_k) *per_k = k * slope;
    return k * q;
}

double photon_netd_k(const PhotonDetector *d, double temp_k, double count_e, double extra_e)
{
    double       per_k;
    const double n = photon_electrons(d, temp_k, &per_k);
    return sqrt(n + d->dark_e + d->read_e * d->read_e + count_e * count_e / 12 + extra_e * extra_e) / per_k;
}

/* ---- table ------------------------------------------------------------------------------------ */

/* Photons per watt depend weakly on temperature: they are tabulated at even steps of the logarithm of radiance, and
 * linear between. */
enum { knots = 4096 };

struct PhotonTable {
    double low, high, per_log; /* logarithms of the ends; knots per unit of it. per_log 0: one ratio for all */
    double ratio[knots];       /* electrons / (W/(m2 sr)) */
};

Status photon_table_create(PhotonTable **out, const PhotonDetector *d, bool emitted)
{
    PhotonTable *t = calloc(1, sizeof *t);
    if (!t) return STATUS_NO_MEMORY;
    const SpectralBand seen = seen_by(d);
    const double       k = photon_etendue(d);
    t->ratio[0] = k * middle_m(&seen) / (h_j_s * c_mps);
    if (emitted) {
        t->low = log(planck_seen(&seen, 180, NULL));
        t->high = log(planck_seen(&seen, 1500, NULL));
        t->per_log = (knots - 1) / (t->high - t->low);
        for (int i = 0; i < knots; i++) {
            const double radiance = exp(t->low + i / t->per_log);
            const double temp_k = planck_seen_inverse(&seen, radiance);
            t->ratio[i] = k * photon_seen(&seen, temp_k, NULL) / radiance;
        }
    }
    *out = t;
    return STATUS_OK;
}

void photon_table_destroy(PhotonTable *table) { free(table); }

double photon_table_electrons(const PhotonTable *t, double radiance)
{
    if (!(radiance > 0)) return isnan(radiance) ? NAN : 0;
    if (t->per_log == 0) return radiance * t->ratio[0];
    const double at = clamp((log(radiance) - t->low) * t->per_log, 0, knots - 1);
    const int    i = at < knots - 2 ? (int)at : knots - 2;
    return radiance * (t->ratio[i] + (at - i) * (t->ratio[i + 1] - t->ratio[i]));
}
