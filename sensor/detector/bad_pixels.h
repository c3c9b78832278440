/* sensor/detector/bad_pixels.h: dead, hot and blinking pixels; inserted, or replaced from
 * neighbours. */
#ifndef SENSOR_DETECTOR_BAD_PIXELS_H
#define SENSOR_DETECTOR_BAD_PIXELS_H

#include "pitviper.h"

enum { PIXEL_GOOD, PIXEL_DEAD, PIXEL_HOT, PIXEL_BLINKING };

/* map [height][width], of PIXEL_*: a function of seed and stream. share: expected, 0 .. 0.2. clustered: share of the
 * defects that extend to each of their 8 neighbours with probability one half. Half are dead, a quarter
 * hot, a quarter blinking; a cluster is of one kind. */
void bad_pixels_make(uint8_t *map, int width, int height, double share, double clustered, uint64_t seed,
                     uint32_t stream);
/* Dead: 0. Hot: full. Blinking: full scale in a random half of the periods of 8 frames, else unchanged. */
void bad_pixels_insert(uint16_t *count, const uint8_t *map, int width, int height, uint16_t full, uint64_t seed,
                     uint32_t stream, int frame);
/* Each becomes the mean of the nearest good pixels (a ring of 1, then 2, ... to 8 px; if none: unchanged). */
void bad_pixels_replace(uint16_t *count, const uint8_t *map, int width, int height);

#endif
