/* sensor/truth/frame_error.h: a frame's error budget: what render estimates of itself, and what only the node knows:
 * how old its entities' reports are and how coarse their models.
 *
 * Dead reckoning. An entity that is shown a few pixels off is wrong by what the pixels change over that way: over small
 * ways by the squared differences of neighbouring pixels on and about it, over long ones by what it differs by from its
 * surroundings. The way is what its last correction says (snapshot_drift); the directions are unknown, and half of the
 * squares counts. Its shadow is left out.
 * Of one frame that is right within a factor of 2 in three of four cases, which is as much as one driver's unknown way
 * allows; over many frames in nine of ten (tests/sensor/test_frame_error.c).
 * Facets of models lie within models.sag_m of the surface, two thirds of it in the mean, and shift outlines the same
 * way; and who is set onto the ground (clamped) rises and leans with its error (render/frame/error_budget.h). */
#ifndef SENSOR_TRUTH_FRAME_ERROR_H
#define SENSOR_TRUTH_FRAME_ERROR_H

#include "sensor/truth/truth.h"

typedef enum ErrorSource {
    ERROR_SAMPLING, ERROR_LEVEL_OF_DETAIL, ERROR_TABLES, ERROR_DEAD_RECKONING, ERROR_TOTAL, error_sources
} ErrorSource;

/* rms over the picture, as a share of the band's mean; of the optical band the root of its channels' mean square.
 * kelvin: of apparent temperature, by its slope at the mean. NaN: no such band, or none. */
typedef struct FrameError {
    double share[BAND_COUNT][error_sources], kelvin[BAND_COUNT][error_sources];
} FrameError;

/* False without a budget in the picture or without truth planes. */
bool frame_error(FrameError *out, const Picture *picture, const World *world, const Snapshot *snapshot,
                 const RenderRequest *request, const Target *target, int targets, double sag_m, bool clamped);

#endif
