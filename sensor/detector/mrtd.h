/* sensor/detector/mrtd.h: minimum resolvable temperature difference of a sensor, by four-bar targets.
 *
 * Four bars of width w = 1 / (2 f) and length 7 w, f in cycles a pixel. The observer model uses the image in square
 * pixels, sums `frames` of them, and takes the mean of each bar minus that of the adjacent gap; the bars are resolved
 * where that is snr times the noise of the mean of one bar:
 *
 *     MRTD_h(f) = snr (pi^2 / 8) sigma_tvh K_h(f) sqrt(E_t E_h(f) E_v(f)) / (MTF_h(f) sinc(f))
 *
 * E_t = 1 / frames; E_h = (1 - 1 / (3 w)) / w for vertical bars, the same of 7 w for E_v: the share of white noise in
 * square pixels left in a mean over that length (the integral of sinc^2(w x) sinc^2(x)).
 * K_h^2 = 1 + (noise of other kinds) / (sigma_tvh^2 E_t E_h E_v): fixed noise vh is not averaged by time, th and h not
 * along their columns, and components common to bar and gap (t, v, tv) cancel; for horizontal
 * bars axes are exchanged. Noise along the lines, correlated as exp(-k / length), counts by its difference between bar
 * and gap. 8 / pi^2 is the first harmonic of the bars, averaged over a bar. `all` includes the others: the sum over
 * odd n of MTF(n f) sinc(n f) / n^2, which matters below 0.1 cycles a pixel.
 *
 * Source: Scott & D'Agostino, "NVEOD FLIR92 thermal imaging systems performance model", SPIE 1689 (1992); D'Agostino &
 * Webb, SPIE 1488 (1991). Not modelled: eye and display; defective pixels; AC coupling, which attenuates noise and
 * bars alike. Against bars through the whole detector: within 8 %, mostly 4 % (test_mrtd.c). */
#ifndef SENSOR_DETECTOR_MRTD_H
#define SENSOR_DETECTOR_MRTD_H

#include "sensor/detector/blur_private.h"
#include "sensor/detector/preset.h"

typedef struct MrtdObserver {
    double snr, frames, temp_k; /* threshold; frames summed, >= 1; temperature of the background */
} MrtdObserver;

typedef struct Mrtd {
    double mtf[2];     /* of the sensor at f, [vertical bars, horizontal bars] */
    double all_k[2];   /* K; INFINITY where the bars have no contrast */
    double first_k[2]; /* with the first harmonic alone */
} Mrtd;

/* Predicts the MRTD of an MWIR or LWIR sensor. f_cyc_px: above 0, to 0.5. */
void mrtd_predict(Mrtd *out, const SensorPreset *preset, double f_cyc_px, const MrtdObserver *observer);

/* ---- the same in its parts: noise at a background, and bars at a frequency ------------------------- */

/* Squared noise of a pixel by kind, electrons, and the electrons of a unit of contrast. That unit is 1 K of an emitting
 * background, and a difference as large as the mean of a reflecting one: then `Mrtd` is the minimum resolvable
 * contrast, (bar - gap) / mean. */
typedef struct MrtdNoise {
    double tvh_e2, kind_e2[noise_axes]; /* of the pixel, temporal; the other kinds, as Noise3d's */
    double gain_e2, row_gain_e2;        /* differences of gain: of pixels; of rows, where a row has one detector */
    double line_e2;                     /* along the lines, of one frame */
    double per_unit_e;
} MrtdNoise;

void mrtd_noise_emitted(MrtdNoise *out, const SensorPreset *preset, double temp_k);
/* signal_e: electrons of the mean background; exposure: share of the integration time, 0 .. 1. */
void mrtd_noise_reflected(MrtdNoise *out, const SensorPreset *preset, double signal_e, double exposure);
/* Both at once: signal_e of the background at this exposure, per_unit_e of a unit of contrast. */
void mrtd_noise_of(MrtdNoise *out, const SensorPreset *preset, double signal_e, double per_unit_e, double exposure);

typedef struct MrtdBars {
    double mtf[2], all[2], first[2];      /* transfer at f; contrast of bars: all harmonics, the first */
    double across, along;                 /* share of white noise left in a mean over a bar's width; length */
    double line_across[2], line_along[2]; /* of noise along the lines, [vertical bars, horizontal bars] */
} MrtdBars;

void mrtd_bars(MrtdBars *out, const SensorPreset *preset, double f_cyc_px);
/* out->mtf is that of the bars. observer->temp_k is not used. */
void mrtd_at(Mrtd *out, const MrtdBars *bars, const MrtdNoise *noise, const MrtdObserver *observer);

#endif
