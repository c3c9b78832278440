/* sensor/detector/noise3d.h: three-dimensional noise: components of time, row (v) and column (h).
 *
 * Seven independent components; each is a function of (seed, stream) and of the axes in its name, of frame, row and
 * column: v, h and vh are fixed patterns. Source: D'Agostino & Webb, "Three-dimensional analysis framework
 * and measurement methodology for imaging system noise", SPIE 1488 (1991). */
#ifndef SENSOR_DETECTOR_NOISE3D_H
#define SENSOR_DETECTOR_NOISE3D_H

#include "pitviper.h"

typedef enum NoiseAxis { NOISE_TVH, NOISE_TV, NOISE_TH, NOISE_VH, NOISE_T, NOISE_V, NOISE_H, noise_axes } NoiseAxis;
extern const char *const noise_axis_name[noise_axes];

typedef struct Noise3d {
    double sigma[noise_axes];
} Noise3d;

/* Standard normal of one component. stream < 2^16; frame, row, column >= 0. */
double noise3d_unit(NoiseAxis axis, uint64_t seed, uint32_t stream, int frame, int row, int column);
/* The sum of all seven at one pixel of one frame. */
double noise3d_at(const Noise3d *noise, uint64_t seed, uint32_t stream, int frame, int row, int column);

/* plane += the components v, h and vh; plane is [height][width]. */
void noise3d_add_fixed(float *plane, int width, int height, const Noise3d *noise, uint64_t seed, uint32_t stream);
/* plane += t, tv and th, and tvh where its sigma is not 0. columns: scratch [width]. */
void noise3d_add_moving(float *plane, int width, int height, const Noise3d *noise, uint64_t seed, uint32_t stream,
                        int frame, double *columns);

/* Unbiased estimate from cube [frames][rows][columns], each at least 2: directional averages, minus the share that
 * other components leave in an average (tests/sensor/test_noise3d.c). A variance estimated below 0 gives
 * 0. STATUS_NO_MEMORY. */
Status noise3d_estimate(Noise3d *out, const float *cube, int frames, int rows, int columns);

/* Plain white noise: out[i] = in[i] + noise_sigma N(0, 1) for pixels first .. first + count - 1 of the frame; in
 * and out begin at `first` and may be the same. Non-finite values stay as they are. */
void detector_noise(float *out, const float *in, size_t first, size_t count, double noise_sigma, uint64_t seed,
                    uint32_t stream, uint32_t frame);

#endif
