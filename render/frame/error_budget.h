/* render/frame/error_budget.h: how wrong a frame is, from the frame itself. What each figure holds, and what it does
 * not:
 *
 *   sampling         Pixels of edge_samples x edge_samples rays: from the differences among their own samples, by
 *                    mean_variance_factor. Small targets: the same of their cells, and what the pixel behind them differs by. All
 *                    others: some are traced again with four times the rays a side; which, is drawn by how much they
 *                    differ from their neighbours. Nothing that is thinner than those rays lie apart is found.
 *   level_of_detail  Ground: what the picked pixels would show if the ground were known at every second post, by its
 *                    normals and by how far it moves on the image. What is missing below the posts' distance is taken
 *                    to be as much again: where hills are as high as they are long (terrain/landscape/landscape.c)
 *                    each halving of that distance brings half of what is left. Shadows and what stands behind a crest
 *                    are left out.
 *   tables           A few pixels, the bright ones first, their air asked path by path and their light in double
 *                    (air_paths_directly, optical_shade, thermal_shade), against what the frame's tables and eight-wide
 *                    shading give. The light of the sky on a plane is the table's in both; errors of the atmosphere
 *                    itself are no part.
 *
 * Draws are counter-based and belong to places on the picture: the same for any number of threads. */
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
