/* sensor/framefile/frame_ground.h: the ground of a frame file: in the file, or the terrain store that it names. */
#ifndef SENSOR_FRAMEFILE_FRAME_GROUND_H
#define SENSOR_FRAMEFILE_FRAME_GROUND_H

#include "sensor/framefile/frame_content.h"
#include "sensor/settings/config.h"

/* Parts may be of a hostile file. Failures are logged. */
Status frame_ground_open(Landscape *out, const LandscapeParts *parts);
/* The plants on it, into a world over that ground; nothing for a file without. woods must outlive the world, and is
 * destroyed by the caller, also on failure. */
Status frame_ground_plant(World *world, Woods *woods, const FrameFile *file, const Config *config, const char *isa,
                          Pool *pool);

#endif
