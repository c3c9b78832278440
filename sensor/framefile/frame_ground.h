/* sensor/framefile/frame_ground.h: the ground of a frame file: in the file, or the terrain store that it names. */
#ifndef SENSOR_FRAMEFILE_FRAME_GROUND_H
#define SENSOR_FRAMEFILE_FRAME_GROUND_H

#include "terrain/landscape/landscape_parts.h"

/* Parts may be of a hostile file. Failures are logged. */
Status frame_ground_open(Landscape *out, const LandscapeParts *parts);

#endif
