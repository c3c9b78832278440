/* sensor/detector/bad_pixels.h: detectors that do not answer, shout, or come and go; shown, or patched from
 * neighbours. */
#ifndef SENSOR_DETECTOR_BAD_PIXELS_H
#define SENSOR_DETECTOR_BAD_PIXELS_H

#include "pitviper.h"

enum { PIXEL_GOOD, PIXEL_DEAD, PIXEL_HOT, PIXEL_BLINKING };

/* map [height][width], of PIXEL_*: a function of seed and stream. share: expected, 0 .. 0.2. clustered: of the
 * faults, the part that takes each of its 8 neighbours along with a chance of one half. Half are dead, a quarter
 * hot, a quarter blinking; a cluster is of one kind. */
void bad_pixels_make(uint8_t *map, int width, int height, double share, double clustered, uint64_t seed,
                     uint32_t stream);
/* Dead: 0. Hot: full. Blinking: full in half of the spells of 8 frames, by lot, and as it is else. */
void bad_pixels_show(uint16_t *count, const uint8_t *map, int width, int height, uint16_t full, uint64_t seed,
                     uint32_t stream, int frame);
/* Each takes the mean of the good ones nearest around it (a ring of 1, then 2, ... to 8 px; none there: as it is). */
void bad_pixels_replace(uint16_t *count, const uint8_t *map, int width, int height);

#endif
