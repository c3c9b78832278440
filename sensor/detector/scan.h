/* sensor/detector/scan.h: a picture taken line after line: when each pixel is taken, where the scene is by then,
 * and the noise that runs along the lines.
 *
 * The frame's time is that of the picture's middle, so that truth holds there. Founded on the first FLIR model of
 * Muuss & Lorenzo (1995): bi-directional scan, alternate lines taken left to right and right to left, and a
 * rolling sequence of ten frames of noise that is correlated along that path. */
#ifndef SENSOR_DETECTOR_SCAN_H
#define SENSOR_DETECTOR_SCAN_H

#include "pitviper.h"

typedef struct Scan {
    double line_s;         /* from line to line; 0: all at once */
    double active;         /* share of line_s in which the picture's columns pass */
    bool   bidirectional;  /* odd rows run right to left */
    bool by_columns; /* lines are columns, left to right: a mirror sweeps one column of detectors over the picture, so
                      * that each row comes from a detector of its own. active: share in which the rows pass */
} Scan;

/* When a place of the picture (px; pixel centres at 0.5) is taken, less the frame's time. */
double scan_time_s(const Scan *scan, int width, int height, double column_px, int row);

/* out: the picture as its lines see it while the scene moves over it by rate_px_s (column, row). Each value is
 * taken from `in` at its own time; mirrored at the edges. 16 taps of a Kaiser-windowed sine at 1/256 px: within
 * 0.6 % to 0.4 cycles a pixel (tests/sensor/test_scan.c). Not in place. line: scratch [max(width, height) + scan_taps].
 */
enum { scan_taps = 16 };
void scan_resample(float *out, const float *in, int width, int height, const Scan *scan, const double rate_px_s[2],
                   float *line);

/* Place on the path of the scan: 0 .. width * height - 1. */
static inline size_t scan_path(const Scan *scan, int width, int row, int column)
{
    return (size_t)row * (size_t)width + (size_t)(scan->bidirectional && row % 2 ? width - 1 - column : column);
}

/* Unit-variance noise correlated along the path (by columns: along each row, whose detector has its own), rho(k) =
 * exp(-k / correlation_px); frame `index` of the pool, which a sequence walks around: 0 .. scan_pool - 1. */
enum { scan_pool = 10 };
void scan_line_noise(float *out, int width, int height, const Scan *scan, double correlation_px, uint64_t seed,
                     uint32_t stream, int index);

#endif
