/* sensor/detector/detector.h: from radiance to what a screen shows: noise, gain and level, quantisation.
 *
 * A first detector. Pure functions on planes of `count` pixels, no memory of earlier frames, no allocation.
 * Noise is a function of (seed, stream, frame, pixel), so a plane may be cut into pieces in any way and
 * done by any thread. NaN shows as 0, -inf as 0, +inf as full scale; none of them moves the levels. */
#ifndef SENSOR_DETECTOR_DETECTOR_H
#define SENSOR_DETECTOR_DETECTOR_H

#include "pitviper.h"

typedef struct DetectorConfig {
    double gain;            /* 1: full scale spans level low .. high; 2: half of that span, about its middle */
    double offset;          /* added after gain, in full scales */
    double noise_sigma;     /* per pixel, in the plane's own unit; 0: none */
    int    bits;            /* 8 or 16 */
    bool   auto_level;      /* low and high from the plane, else the two manual ones */
    double percentile_low, percentile_high; /* 0 .. 1 */
    double margin;          /* automatic: added on both sides, in spans */
    double min_span;        /* automatic: never less, in the plane's unit */
    double level_low, level_high;           /* manual, in the plane's unit */
    bool   display_gamma;   /* sRGB transfer curve after gain and level: visible light on a screen */
} DetectorConfig;

/* gain 1, offset 0, no noise, 8 bits, automatic level 1 % .. 99 % with a margin of 0.05. */
DetectorConfig detector_default_config(void);
/* STATUS_BAD_VALUE and one log line (field, value, range) for anything outside the ranges above. */
Status detector_check_config(const DetectorConfig *config);

/* What black and white stand for, in the plane's unit; high > low always. */
typedef struct DetectorLevel {
    double low, high;
} DetectorLevel;

/* out[i] = in[i] + noise_sigma N(0, 1) for pixels first .. first + count - 1 of the frame; in and out begin
 * at `first` and may be the same. Non-finite values stay as they are. */
void detector_noise(float *out, const float *in, size_t first, size_t count, double noise_sigma, uint64_t seed,
                    uint32_t stream, uint32_t frame);

/* Gain and level from the finite values of one or several planes together (R G B: one gain, so colours
 * stay). Percentiles are order statistics of all values, exact. A constant plane, or one constant to
 * rounding, lands in the middle of the scale. Planes without a finite value: 0 .. 1. */
DetectorLevel detector_level(const DetectorConfig *config, const float *const *plane, int plane_count, size_t count);

/* Quantisation to config->bits: monotone, saturating, rounding to nearest. out: uint8_t or uint16_t [count]. */
void detector_display(void *out, const float *in, size_t count, const DetectorConfig *config, DetectorLevel level);
/* Three planes to RGB interleaved, one level for all three. out: uint8_t or uint16_t [3 * count]. */
void detector_display_rgb(void *out, const float *const in[3], size_t count, const DetectorConfig *config,
                          DetectorLevel level);

/* Radar: decibels below the brightest finite pixel. 0 dB is full scale, -dynamic_range_db and below is 0, as
 * is any pixel <= 0 or NaN. Power in, linear; bits 8 or 16. */
static const double detector_radar_range_db = 60;
void detector_display_db(void *out, const float *power, size_t count, double dynamic_range_db, int bits);

#endif
