/* sensor/detector/line_scan_private.h: an image scanned line by line: time of each pixel, motion of the scene in that
 * time, noise along the lines, and AC coupling.
 *
 * The frame's time is that of the image centre, where truth is valid. Based on the first FLIR model of
 * Muuss & Lorenzo (1995): bi-directional scan, alternate lines taken left to right and right to left, and a
 * rolling sequence of ten frames of noise that is correlated along that path. */
#ifndef SENSOR_DETECTOR_LINE_SCAN_PRIVATE_H
#define SENSOR_DETECTOR_LINE_SCAN_PRIVATE_H

#include "pitviper.h"

typedef struct LineScan {
    double line_s;        /* from line to line; 0: global shutter */
    double active;        /* share of line_s in which the columns of the image are scanned */
    bool   bidirectional; /* odd rows run right to left */
    bool   by_columns; /* lines are columns, left to right: a mirror sweeps one column of detectors over the image, so
                        * that each row comes from a detector of its own. active: share in which the rows pass */
} LineScan;

/* Time at which an image position (px; pixel centres at 0.5) is scanned, relative to the frame's time. */
double line_scan_time_s(const LineScan *scan, int width, int height, double column_px, int row);

/* out: the scanned image of a scene that moves by rate_px_s (column, row). Each value is resampled from `in` at its
 * own time; mirrored at the edges. 16 taps of a Kaiser-windowed sine at 1/256 px: within
 * 0.6 % to 0.4 cycles a pixel (tests/sensor/test_scan.c). Not in place. line: scratch [max(width, height) +
 * line_scan_taps]. */
enum { line_scan_taps = 16 };
void line_scan_resample(float *out, const float *in, int width, int height, const LineScan *scan,
                        const double rate_px_s[2], float *line);

/* Index along the path of the scan: 0 .. width * height - 1. */
static inline size_t line_scan_path(const LineScan *scan, int width, int row, int column)
{
    return (size_t)row * (size_t)width + (size_t)(scan->bidirectional && row % 2 ? width - 1 - column : column);
}

/* Unit-variance noise correlated along the path (by columns: along each row, whose detector has its own), rho(k) =
 * exp(-k / correlation_px); frame `index` of a cyclic pool: 0 .. line_scan_pool - 1. */
enum { line_scan_pool = 10 };
typedef struct LineNoise {
    double   correlation_px;
    uint64_t seed;
    uint32_t stream;
    int      index;
} LineNoise;
void line_scan_noise(float *out, int width, int height, const LineScan *scan, const LineNoise *noise);

/* AC coupling between detector and amplifier: a first-order high pass along each line in the direction of its scan,
 * each value held for cutoff_hz x pixel_s = fc_t: a step droops to exp(-2 pi fc_t) per pixel. At the start of each
 * line the capacitor is charged to the plane's mean (direct current restored on a reference during the turn), and
 * that mean is added again, so the level is preserved and lines are independent. A hot object is followed by a dark
 * trail: to the right, or on returning lines to the left. */
void line_scan_couple(float *plane, int width, int height, const LineScan *scan, double fc_t);

#endif
