/* sensor/truth/frame_error.h: a frame's error budget: the renderer's own estimates, and the contributions that only
 * the node knows: the age of its entities' reports and the chord error of their models.
 *
 * Dead reckoning. An entity rendered a few pixels off has the error by which the pixels change over that
 * displacement: over small displacements the squared differences of neighbouring pixels on and around it, over large
 * ones its difference from its surroundings. The displacement is that of its last correction (snapshot_drift); the
 * direction is unknown, and half of the squares counts. Its shadow is not included. For a single frame the estimate
 * is right within a factor of 2 in three of four cases, limited by the unknown path of a single vehicle; over many
 * frames in nine of ten (tests/sensor/test_frame_error.c). Facets of models lie within models.sag_m of the surface,
 * two thirds of it in the mean, and shift outlines likewise; and a ground-clamped entity rises and tilts with the
 * error of the ground (render/frame/error_budget.h).
 *
 * Heat. Temperatures of the ground are off by what its elements, its steps of time and its facets leave out: 0.03 K and
 * 0.5 % of how far a place is from the air (tests/sensor/test_error_budget.c: within a factor of 2); those of parts by their steps
 * and their past (vehicle_heat_error_k). What materials, weather and tables
 * leave out, 0.6 to 1.6 K on measured days, is not included. */
#ifndef SENSOR_TRUTH_FRAME_ERROR_H
#define SENSOR_TRUTH_FRAME_ERROR_H

#include "sensor/truth/truth.h"

typedef enum ErrorSource {
    ERROR_SAMPLING, ERROR_LEVEL_OF_DETAIL, ERROR_TABLES, ERROR_HEAT, ERROR_DEAD_RECKONING, ERROR_TOTAL, error_sources
} ErrorSource;

/* rms over the image, as a share of the band's mean; of the optical band the root of its channels' mean square.
 * kelvin: of apparent temperature, by its slope at the mean. Both are those of the brightest pixels, if these may be off:
 * a hot exhaust that is displaced by a pixel outweighs all others. Of the pseudo-radar, whose power is that of a few
 * mirrors, the share says nothing, and truth.jsonl does not have it. median_k, beyond_1k: of the pixels' expected
 * errors, in apparent temperature without linearizing what a displacement changes: half of the pixels are better; share
 * of those that are off by more than 1 K. Against finely sampled frames the median is right to 20 %, the share to a factor of 2 in
 * LWIR and of 4 in MWIR (tests/sensor/test_frame_error_spread.c). NaN: no such band, or none. */
typedef struct FrameError {
    double share[BAND_COUNT][error_sources], kelvin[BAND_COUNT][error_sources];
    double median_k[BAND_COUNT], beyond_1k[BAND_COUNT];
} FrameError;

/* target: receives error_px - the rms displacement on the image of each by dead reckoning, facets and the ground's error,
 * all of it if it lies across the line of sight - and the errors of its bands.
 * air_k: of the weather; NaN: heat is left out. False without a budget in the picture or without truth planes. */
bool frame_error(FrameError *out, const Picture *picture, const World *world, const Snapshot *snapshot,
                 const RenderRequest *request, Target *target, int targets, double sag_m, bool clamped, double air_k);

#endif
