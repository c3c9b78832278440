/* sensor/detector/level.h: gain and level: the values displayed as black and white.
 *
 * Pure functions on planes of `count` values, no allocation; the state of an automatic level is held by the caller.
 * Values that are not finite do not affect the levels. */
#ifndef SENSOR_DETECTOR_LEVEL_H
#define SENSOR_DETECTOR_LEVEL_H

#include "pitviper.h"

typedef struct DetectorConfig {
    double gain;        /* 1: full scale spans level low .. high; 2: half of that span, about its middle */
    double offset;      /* added after gain, in full scales */
    double noise_sigma; /* per pixel, in the plane's own unit; 0: none */
    int    bits;        /* 8 or 16 */
    bool   auto_level;  /* low and high from the plane, else the two manual ones */
    double percentile_low, percentile_high; /* 0 .. 1 */
    double margin;                          /* automatic: added on both sides, in spans */
    double min_span;  /* automatic: never less, in the plane's unit; from 0 up where it would reach below */
    double highlight; /* automatic: white is at most the value at 90 % plus this many times the distance from that
                       * at 10 %, of the pixels below fire_from: fires take no grey levels from the rest;
                       * 0: percentile_high alone */
    double fire_from; /* hotter than any ground; ignored where it is half of the pixels */
    double plateau;   /* share of the pixels that counts in a bin of plateau equalisation (below); 0: linear */
    double step;      /* between neighbouring values of the plane: 1 of counts, 0 of radiance */
    double level_low, level_high; /* manual, in the plane's unit */
    bool   display_gamma;         /* sRGB transfer curve after gain and level: visible light on a screen */
} DetectorConfig;

/* gain 1, offset 0, no noise, 8 bits, automatic linear level 1 % .. 99 % with a margin of 0.05; nothing is a fire. */
DetectorConfig detector_default_config(void);
/* STATUS_BAD_VALUE, with one log line (field, value, range), for a value outside the ranges above. */
Status detector_check_config(const DetectorConfig *config);

/* Values of black and white, in the plane's unit; high > low always. */
typedef struct DetectorLevel {
    double low, high;
} DetectorLevel;

/* Gain and level from the finite values of one or several planes together (R G B: one gain, so colours
 * stay). Percentiles are order statistics of all values, exact. A constant plane, or one constant to
 * rounding, lands in the middle of the scale. Planes without a finite value: 0 .. 1. */
DetectorLevel detector_level(const DetectorConfig *config, const float *const *plane, int plane_count, size_t count);

/* An automatic level with a time constant: the state of the last frame approaches `now` by 1 - exp(-step_s /
 * time_s). Where it is further away than two spans of `now` (low or high, whichever is further), so that the
 * picture would be nearly black or white, it is put within two spans at once and follows with a tenth of time_s
 * until it is within 0.03 of a span: within 0.42 time_s. Smaller steps settle to 5 % in 3 time_s. Both are the same
 * at any frame rate. time_s 0: immediately. quick: state too, false at first: it is catching up. */
void detector_level_follow(DetectorLevel *state, bool *quick, DetectorLevel now, double step_s, double time_s);

/* ---- plateau equalisation ----------------------------------------------------------------------- */

/* Grey levels go where the pixels are, as in the automatic gain control of thermal cameras.
 *
 * A histogram is summed, each bin counting for at most a plateau, and the sum is the grey level: a wide plateau is
 * histogram equalisation, a narrow one gives each value that occurs the same. Source: V. E. Vickers, "Plateau
 * equalization algorithm for real-time display of high-quality infrared imagery", Optical Engineering 35 (1996) 1921.
 */
enum { curve_steps = 256 };

/* The curve: the value that is displayed at k / curve_steps of full scale, ascending; it is linear between. */
typedef struct DetectorCurve {
    double value[curve_steps + 1];
} DetectorCurve;

/* Makes the curve of one plane by config->plateau, min_span and step count. Bins are min_span / 64 wide, or one step,
 * from the least value up; values beyond bin 16384 count in it. The slope is at most full scale over min_span; where
 * the curve then needs only part of the scale, that part is about the middle. Without finite values the curve spans 0
 * .. 1. */
void detector_plateau(DetectorCurve *out, const DetectorConfig *config, const float *plane, size_t count);

/* A curve with a time constant, as detector_level_follow; its span is that of the middle eight tenths of the grey
 * levels. */
void detector_plateau_follow(DetectorCurve *state, bool *quick, const DetectorCurve *now, double step_s, double time_s);

/* Grey levels by the curve; gain, offset and bits of config. NaN and what is below the curve: 0. out as
 * detector_display's. */
void detector_display_curve(void *out, const float *in, size_t count, const DetectorConfig *config,
                            const DetectorCurve *curve);

#endif
