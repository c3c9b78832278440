/* sensor/truth/radar_error.h: a radar's error budget, in the manner of a band's (frame_error.h): of its map of range
 * and Doppler, by source.
 *
 * Sampling is by the grid of ray tubes on entities, level of detail by scattering centres in place of what the tubes
 * hit; tables are the gridding of echoes over delay and Doppler. Dead reckoning displaces echoes in range: of complex
 * cells that leaves no phase, so it counts how far the map's magnitudes change, those of a point that moves by one of
 * three components of the last correction (snapshot_drift).
 *
 * An entity's power in the map is that of its one look, by its signal to noise: right in the mean over looks, as its
 * centres add up or cancel. The echoes of ground, rain and plants are functions of their cells: without error but that
 * of gridding. What physical optics, models, materials and given signatures are wrong by is not included; noise and
 * clutter are the radar's own. */
#ifndef SENSOR_TRUTH_RADAR_ERROR_H
#define SENSOR_TRUTH_RADAR_ERROR_H

#include "sensor/radar/radar_frame.h"
#include "sensor/truth/frame_error.h"

/* share: rms error over the cells of the sum channel, over the rms of these. db: standard deviation that it gives the
 * cross section of an entity, and so of a detection, over entities by their power: 10 log10(1 + sqrt(2) error / field).
 * NaN: heat; db of dead reckoning, and of all while no entity is in sight. */
typedef struct RadarError {
    double share[error_sources], db[error_sources];
} RadarError;

void radar_error(RadarError *out, const RadarFrame *radar, const Snapshot *snapshot);

/* Of an echo's amplitude, what gridding leaves, rms over the interval (tests/sensor/test_radar_error.c). */
double radar_gridding_error(void);
/* Squared change of a point's response that moves by so many cells of range, over its square, its phase set aside. */
double radar_moved(const RadarPreset *preset, double cells);

#endif
