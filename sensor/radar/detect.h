/* sensor/radar/detect.h: the detections of a map of range and Doppler: where, how fast, in which direction, how
 * strong.
 *
 * Peaks of the sum channel over a threshold of constant false alarms (cfar.h). Range, Doppler and power between
 * cells by comparing the peak's two neighbours with the response to a point; directions by the ratios of the
 * difference channels to the sum in the peak's cell; cross-section by the radar equation, at the direction found. */
#ifndef SENSOR_RADAR_DETECT_H
#define SENSOR_RADAR_DETECT_H

#include "sensor/radar/antenna.h"
#include "sensor/radar/cfar.h"
#include "sensor/radar/interval.h"

typedef struct Detection {
    int    row, column;
    double range_m;                /* of the reference, plus */
    double range_rate_mps;         /* likewise; folds over at half the interval of the map */
    double cos_right, cos_down;    /* direction, along the antenna's axes */
    double snr;                    /* power over the noise about it, less 1 */
    double rcs_m2;                 /* if one echo from where it was found */
    bool   moving;                 /* clear of the ground's range rate in its direction (mti.h); of the caller */
} Detection;

/* What a map's reference stands for. */
typedef struct DetectScale {
    double range_m, range_rate_mps; /* of the reference */
    double unit_w;                  /* received from 1 m2 at 1 m with antenna gains of 1, before the air */
    double air_np_m;                /* power attenuation of the air, one way, 1/m */
} DetectScale;

/* plan: that made the map. As cfar_detect: strongest first, ties by row and column; at most `most`, returns how many
 * there are; -1: no memory or a bad configuration. */
int detect(Detection *out, int most, const RangeDoppler *map, const IntervalPlan *plan, const CfarConfig *config,
           const Antenna *antenna, const DetectScale *scale);

#endif
