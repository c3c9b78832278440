/* sensor/detector/plateau.h: plateau equalisation: grey levels go where the pixels are, as in the automatic gain control
 * of thermal cameras.
 *
 * A histogram is summed, each bin counting for at most a plateau, and the sum is the grey level: a wide plateau is
 * histogram equalisation, a narrow one gives each value that occurs the same. Source: V. E. Vickers, "Plateau
 * equalization algorithm for real-time display of high-quality infrared imagery", Optical Engineering 35 (1996) 1921. */
#ifndef SENSOR_DETECTOR_PLATEAU_H
#define SENSOR_DETECTOR_PLATEAU_H

#include "sensor/detector/level.h"

enum { curve_steps = 256 };

/* Value displayed at k / curve_steps of full scale, ascending; linear between. */
typedef struct DetectorCurve {
    double value[curve_steps + 1];
} DetectorCurve;

/* Of one plane: config->plateau, min_span and step count. Bins are min_span / 64 wide, or a step, from the least value up;
 * what is beyond the last of 16384 counts with it. The slope is at most full scale over min_span, about the middle of the
 * scale where that leaves some of it unused. No finite value: 0 .. 1. */
void detector_plateau(DetectorCurve *out, const DetectorConfig *config, const float *plane, size_t count);

/* A curve with a time constant, as detector_level_follow; its span is that of the middle eight tenths of the grey levels. */
void detector_plateau_follow(DetectorCurve *state, bool *quick, const DetectorCurve *now, double step_s, double time_s);

/* Grey levels by the curve; gain, offset and bits of config. NaN and what is below the curve: 0. out as detector_display's. */
void detector_display_curve(void *out, const float *in, size_t count, const DetectorConfig *config,
                            const DetectorCurve *curve);

#endif
