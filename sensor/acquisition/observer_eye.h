/* sensor/acquisition/observer_eye.h: contrast threshold and transfer of an observer's eyes in front of a display. */
#ifndef SENSOR_ACQUISITION_OBSERVER_EYE_H
#define SENSOR_ACQUISITION_OBSERVER_EYE_H

#include "pitviper.h"

/* Least modulation, (Lmax - Lmin) / (Lmax + Lmin), at which both eyes see a grating half of the time.
 *
 *   f_cyc_deg        > 0, at the eye
 *   luminance_cd_m2  > 0, mean of the display
 *   field_deg        > 0, root of the display's solid angle
 *   returns          from about 0.002 at 4 cycles a degree; above 1 where none is seen
 *
 * Source: Barten, "Evaluation of subjective image quality with the square-root integral method", JOSA A 7 (1990) 2024,
 * the approximation that night vision models use. Beside Barten's full model of 1999 it is 5 to 31 % higher from 4 to
 * 20 cycles a degree, and up to 1.8 times it at 1 (tests/system/range_judge.py). */
double eye_threshold(double f_cyc_deg, double luminance_cd_m2, double field_deg);

/* Transfer of pupil, retina and tremor, by which noise on a display is seen less; f_cyc_mrad >= 0, at the eye. Two
 * eyes. Source: Overington, "Vision and Acquisition" (1976), as NVTherm's manual gives it (U.S. Army Night Vision and
 * Electronic Sensors Directorate, rev. 5, 2001). */
double eye_transfer(double f_cyc_mrad, double luminance_cd_m2);

/* Transfer of the visual channel that sees a grating of f, for noise at f_noise, both in one unit: a band of an octave
 * about f, exp(-2.2 ln^2(f_noise / f)). Source: as eye_transfer. */
double eye_channel(double f_noise, double f);

#endif
