/* render/frame/error_budget.h: the error estimate of a frame, from the frame itself. What each figure includes and what
 * it leaves out:
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
 *                    are left out. Plants: change of the picked pixels, by the same rays, when none is simplified.
 *   tables           A few pixels, the bright ones first, their air computed path by path and their light in double
 *                    (air_paths_directly, optical_shade, thermal_shade), against the result of the frame's tables and
 *                    eight-wide shading. Sky irradiance comes from the table in both; errors of the atmosphere tables
 *                    themselves are not included.
 *
 * Random draws are counter-based and keyed by pixel position: the same for any number of threads. */
#ifndef RENDER_FRAME_ERROR_BUDGET_H
#define RENDER_FRAME_ERROR_BUDGET_H

#include "render/frame/sampling_variance.h"
#include "render/materials/planck.h"
#include "terrain/elevation/elevation.h"

/* Of the ground at every second post: its normal less that of all posts there, and its height less theirs, m. False
 * where there is no ground, or its level ends within two posts. */
bool error_budget_coarser(double turn_enu[3], double *rise_m, const Elevation *elevation, double x_m, double y_m);

/* rms of radiance to rms of apparent temperature about a mean, K: by the table's slope there. NaN: no radiance. */
double error_budget_kelvin(const PlanckTable *planck, double mean_w_m2_sr, double rms_w_m2_sr);

#endif
