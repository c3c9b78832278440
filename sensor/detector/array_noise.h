/* sensor/detector/array_noise.h: what an array of detectors adds to a picture: three-dimensional noise, and
 * defective pixels.
 *
 * Three-dimensional noise has components of time, row (v) and column (h). Seven independent components; each is a
 * function of (seed, stream) and of the axes in its name, of frame, row and column: v, h and vh are fixed patterns.
 * Source: D'Agostino & Webb, "Three-dimensional analysis framework and measurement methodology for imaging system
 * noise", SPIE 1488 (1991). */
#ifndef SENSOR_DETECTOR_ARRAY_NOISE_H
#define SENSOR_DETECTOR_ARRAY_NOISE_H

#include "pitviper.h"

typedef enum NoiseAxis { NOISE_TVH, NOISE_TV, NOISE_TH, NOISE_VH, NOISE_T, NOISE_V, NOISE_H, noise_axes } NoiseAxis;
extern const char *const noise_axis_name[noise_axes];

/* Which numbers are drawn. */
typedef struct NoiseDraw {
    uint64_t seed;
    uint32_t stream; /* below 2^16 */
    int      frame;  /* >= 0 */
} NoiseDraw;

typedef struct Noise3d {
    double sigma[noise_axes];
} Noise3d;

/* A standard normal value of one component. stream < 2^16; frame, row, column >= 0. */
double noise3d_unit(NoiseAxis axis, uint64_t seed, uint32_t stream, int frame, int row, int column);
/* The sum of all seven components at one pixel of one frame. */
double noise3d_at(const Noise3d *noise, uint64_t seed, uint32_t stream, int frame, int row, int column);

/* plane += the components v, h and vh; plane is [height][width]. */
void noise3d_add_fixed(float *plane, int width, int height, const Noise3d *noise, uint64_t seed, uint32_t stream);
/* plane += t, tv and th, and tvh where its sigma is not 0. columns: scratch [width]. */
void noise3d_add_moving(float *plane, int width, int height, const Noise3d *noise, const NoiseDraw *draw,
                        double *columns);

/* Unbiased estimate from cube [frames][rows][columns], each at least 2: directional averages, minus the share that
 * other components leave in an average (tests/sensor/test_noise3d.c). A variance estimated below 0 gives
 * 0. STATUS_NO_MEMORY. */
Status noise3d_estimate(Noise3d *out, const float *cube, int frames, int rows, int columns);

/* Plain white noise: out[i] = in[i] + noise_sigma N(0, 1) for pixels first .. first + count - 1 of the frame; in
 * and out begin at `first` and may be the same. Non-finite values stay as they are. */
void detector_noise(float *out, const float *in, size_t first, size_t count, double noise_sigma, const NoiseDraw *draw);

/* ---- dead, hot and blinking pixels: inserted, or replaced from neighbours ----------------------- */

enum { PIXEL_GOOD, PIXEL_DEAD, PIXEL_HOT, PIXEL_BLINKING };

/* map [height][width], of PIXEL_*: a function of seed and stream. share: expected, 0 .. 0.2. clustered: share of the
 * defects that extend to each of their 8 neighbours with probability one half. Half are dead, a quarter
 * hot, a quarter blinking; a cluster is of one kind. */
void bad_pixels_make(uint8_t *map, int width, int height, double share, double clustered, uint64_t seed,
                     uint32_t stream);
/* Dead: 0. Hot: full. Blinking: full scale in a random half of the periods of 8 frames, else unchanged. */
void bad_pixels_insert(uint16_t *count, const uint8_t *map, int width, int height, uint16_t full,
                       const NoiseDraw *draw);
/* Replaces each bad pixel by the mean of the nearest good pixels, in a ring of 1, then 2, ... to 8 px; where there are
 * none it stays. */
void bad_pixels_replace(uint16_t *count, const uint8_t *map, int width, int height);

#endif
