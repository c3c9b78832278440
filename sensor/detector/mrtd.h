/* sensor/detector/mrtd.h: minimum resolvable temperature difference of a sensor, by four-bar targets.
 *
 * Four bars of width w = 1 / (2 f) and length 7 w, f in cycles a pixel. The observer sees the picture in square pixels,
 * adds up `frames` of them, and takes each bar's mean less that of the gap beside it; the bars are resolved where that is
 * snr times what noise makes of one bar's mean:
 *
 *     MRTD_h(f) = snr (pi^2 / 8) sigma_tvh K_h(f) sqrt(E_t E_h(f) E_v(f)) / (MTF_h(f) sinc(f))
 *
 * E_t = 1 / frames; E_h = (1 - 1 / (3 w)) / w for vertical bars, the same of 7 w for E_v: of white noise in square pixels
 * a mean over that length leaves so much (the integral of sinc^2(w x) sinc^2(x)).
 * K_h^2 = 1 + (noise of other kinds) / (sigma_tvh^2 E_t E_h E_v): fixed noise vh is not averaged by time, th and h not
 * along their columns, and what bar and gap have in common (t, v, tv) does not hide the one from the other; horizontal
 * bars by exchange. Noise along the lines, correlated as exp(-k / length), counts by what differs between bar and gap.
 * 8 / pi^2 is the first harmonic of the bars, averaged over a bar. `all` has the others too: the sum over odd n of
 * MTF(n f) sinc(n f) / n^2, which matters below 0.1 cycles a pixel.
 *
 * Source: Scott & D'Agostino, "NVEOD FLIR92 thermal imaging systems performance model", SPIE 1689 (1992); D'Agostino &
 * Webb, SPIE 1488 (1991). Left out: what an eye and a screen do beyond that; faulty pixels; AC coupling, which takes as
 * much of the noise as of the bars. Against bars through the whole detector: within 8 %, mostly 4 % (test_mrtd.c). */
#ifndef SENSOR_DETECTOR_MRTD_H
#define SENSOR_DETECTOR_MRTD_H

#include "sensor/detector/mtf.h"
#include "sensor/detector/preset.h"

typedef struct MrtdObserver {
    double snr, frames, temp_k; /* threshold; that are added up, >= 1; of the background */
} MrtdObserver;

typedef struct Mrtd {
    double mtf[2];     /* of the sensor at f, [vertical bars, horizontal bars] */
    double all_k[2];   /* K; INFINITY where nothing is left of the bars */
    double first_k[2]; /* with the first harmonic alone */
} Mrtd;

/* f_cyc_px: 0 .. 0.5, not 0. Of MWIR and LWIR sensors. */
void mrtd_predict(Mrtd *out, const SensorPreset *preset, double f_cyc_px, const MrtdObserver *observer);

#endif
