/* sensor/detector/photons.h: radiance to electrons, and shot noise. */
#ifndef SENSOR_DETECTOR_PHOTONS_H
#define SENSOR_DETECTOR_PHOTONS_H

#include "pitviper_response.h"

/* In-band photon radiance of a blackbody, photons / (s m2 sr), and its derivative in T (may be NULL). 0 < low_m <
 * high_m, temp_k > 0, else NaN. Relative error < 1e-10 for 180 .. 1500 K (tests/sensor/test_photons.c, against 25
 * digits). */
double photon_band(double low_m, double high_m, double temp_k, double *derivative);

/* Mean wavelength of the in-band photons of a blackbody, m: the effective wavelength of the
 * band. 4.36 um for 3.4 .. 4.8 um at 300 K, whose centre is 4.1. Ranges and error as photon_band. */
double photon_mean_wavelength_m(double low_m, double high_m, double temp_k);

/* Both of what a band sees, each photon weighted by its response. */
double photon_seen(const SpectralBand *band, double temp_k, double *derivative);
double photon_seen_wavelength_m(const SpectralBand *band, double temp_k);

typedef struct PhotonDetector {
    double                  low_m, high_m; /* the band */
    const SpectralResponse *response; /* NULL: all of it alike; the greatest is 1, at which qe and transmission are */
    double                  f_number, transmission; /* of the optics, including the loss by obscuration */
    double                  qe;                     /* electrons per photon on the whole pixel */
    double                  pitch_m, integration_s;
    double                  dark_e, read_e; /* in the integration time; rms */
    double                  well_e;
} PhotonDetector;

/* Electrons per (photon / (s m2 sr)): solid angle pi / (4 N^2 + 1) x pitch^2 x transmission x QE x time. */
double photon_etendue(const PhotonDetector *d);
/* Electrons from a blackbody, and their derivative per kelvin. */
double photon_electrons(const PhotonDetector *d, double temp_k, double *per_k);
/* Noise equivalent temperature difference at temp_k, K, from shot noise of signal and dark current, read noise, and the
 * quantisation step count_e / sqrt(12); extra_e: rms of anything else. */
double photon_netd_k(const PhotonDetector *d, double temp_k, double count_e, double extra_e);

/* Electrons as a function of in-band radiance: for emission from the photons of the blackbody of that radiance, for
 * reflected light from the photon energy at the band centre (of a response, the mean wavelength that it weighs). */
typedef struct PhotonTable PhotonTable;
/* emitted: false uses the band centre for all radiances. */
Status photon_table_create(PhotonTable **out, const PhotonDetector *d, bool emitted);
void   photon_table_destroy(PhotonTable *table);
/* >= 0; linear from 0 below 180 K and beyond 1500 K. Relative error < 1e-6 between. NaN and inf are returned
 * unchanged. */
double photon_table_electrons(const PhotonTable *table, double radiance_w_m2_sr);

#endif
