/* render/frame/render.h: a picture is a pure function of (world, snapshot, request). */
#ifndef RENDER_FRAME_RENDER_H
#define RENDER_FRAME_RENDER_H

#include "render/frame/picture.h"
#include "render/frame/world.h"
#include "render/light/thermal.h"
#include "render/materials/planck.h"
#include "terrain/elevation/elevation.h"

/* Number of different positions along a row (or column) of a pixel over which an edge is averaged: n^2 for the
 * rotated grid of n x n rays that edges get. The footprint of a detector must not reduce it again
 * (sensor/detector/blur_private.h). */
int render_places(int samples, int edge_samples);

/* An entity whose model is -1 keeps its index in the snapshot and is not drawn: no pixel, no shadow, no echo. */
Status render(Picture *out, const World *world, const Snapshot *snapshot, const RenderRequest *request, const Air *air,
              Pool *pool, Arena *arena);

/* ---- the error estimate ---------------------------------------------------------------------- */

/* The error estimate of a frame, from the frame itself. What each figure includes and what it leaves out:
 *
 *   sampling         Pixels of edge_samples x edge_samples rays: from the differences among their own samples, by
 *                    mean_variance_factor. Small targets: likewise from their cells, and the variation of the pixels
 *                    behind them. All others: some are re-sampled with four times the rays a side, drawn by how much
 *                    they differ from their neighbours; where targets are not refined (antialias off), up to 256 of
 *                    the pixels in their boxes besides. Details thinner than the spacing of those rays are missed.
 *   level_of_detail  Ground: change of the picked pixels if the ground were known at every second post only, by its
 *                    normals and by its displacement on the image. What is missing below the post spacing is taken
 *                    to be as much again: where hills are as high as they are long (terrain/invented/invented.c)
 *                    each halving of that spacing brings half of what is left. Shadows and what is hidden by a crest
 *                    are left out. Plants that are simplified or met in tables: difference of pixels' expected
 *                    values from those in full detail (PlantPrice).
 *   tables           A few pixels, the bright ones first, their air computed path by path and their light in double
 *                    (air_paths_directly, optical_shade, thermal_shade), against the result of the frame's tables and
 *                    eight-wide shading. Sky irradiance comes from the table in both; errors of the atmosphere tables
 *                    themselves are not included.
 *
 * Random draws are counter-based and keyed by pixel position: the same for any number of threads. */

/* Of the ground at every second post: its normal less that of all posts there, and its height less theirs, m. False
 * where there is no ground, or its level ends within two posts. */
bool render_error_coarser(double turn_enu[3], double *rise_m, const Elevation *elevation, double x_m, double y_m);

/* rms of radiance to rms of apparent temperature about a mean, K: by the table's slope there. NaN: no radiance. */
double render_error_kelvin(const PlanckTable *planck, double mean_w_m2_sr, double rms_w_m2_sr);

/* Error of a mean over n x n samples, squared, by the squared differences d of neighbours among them:
 * mean_variance_factor sum d^2 / n^4. 0.09: of our rotated grid against half planes at all angles and places it is
 * 0.115 for n = 2, 0.093, 0.087, 0.085 for 3, 4, 6 and 0.106 for 16 (tests/render/test_error_law.c). */
static const double mean_variance_factor = 0.09;

/* Squared error of the mean of n x n samples of a pixel, row by row on the rotated grid that edges get:
 * mean_variance_factor times the squared differences of neighbours over n^4. rms within 15 % over half planes,
 * n 2 .. 16. */
double render_error_variance(const float *out, int n);

#endif
