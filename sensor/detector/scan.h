/* sensor/detector/scan.h: an image scanned line by line: time of each pixel, motion of the scene in that time,
 * and noise along the lines.
 *
 * The frame's time is that of the image centre, where truth is valid. Based on the first FLIR model of
 * Muuss & Lorenzo (1995): bi-directional scan, alternate lines taken left to right and right to left, and a
 * rolling sequence of ten frames of noise that is correlated along that path. */
#ifndef SENSOR_DETECTOR_SCAN_H
#define SENSOR_DETECTOR_SCAN_H

#include "pitviper.h"

typedef struct Scan {
    double line_s;         /* from line to line; 0: global shutter */
    double active;         /* share of line_s in which the columns of the image are scanned */
    bool   bidirectional;  /* odd rows run right to left */
    bool by_columns; /* lines are columns, left to right: a mirror sweeps one column of detectors over the image, so
                      * that each row comes from a detector of its own. active: share in which the rows pass */
} Scan;

/* Time at which an image position (px; pixel centres at 0.5) is scanned, relative to the frame's time. */
double scan_time_s(const Scan *scan, int width, int height, double column_px, int row);

/* out: the scanned image of a scene that moves by rate_px_s (column, row). Each value is resampled from `in` at its
 * own time; mirrored at the edges. 16 taps of a Kaiser-windowed sine at 1/256 px: within
 * 0.6 % to 0.4 cycles a pixel (tests/sensor/test_scan.c). Not in place. line: scratch [max(width, height) + scan_taps].
 */
enum { scan_taps = 16 };
void scan_resample(float *out, const float *in, int width, int height, const Scan *scan, const double rate_px_s[2],
                   float *line);

/* Index along the path of the scan: 0 .. width * height - 1. */
static inline size_t scan_path(const Scan *scan, int width, int row, int column)
{
    return (size_t)row * (size_t)width + (size_t)(scan->bidirectional && row % 2 ? width - 1 - column : column);
}

/* Unit-variance noise correlated along the path (by columns: along each row, whose detector has its own), rho(k) =
 * exp(-k / correlation_px); frame `index` of a cyclic pool: 0 .. scan_pool - 1. */
enum { scan_pool = 10 };
void scan_line_noise(float *out, int width, int height, const Scan *scan, double correlation_px, uint64_t seed,
                     uint32_t stream, int index);

#endif
