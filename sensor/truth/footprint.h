/* sensor/truth/footprint.h: where the boresight and the corners of an image meet the ground: the terrain alone, without
 * entities. */
#ifndef SENSOR_TRUTH_FOOTPRINT_H
#define SENSOR_TRUTH_FOOTPRINT_H

#include "render/frame/world.h"

/* Where a line of sight meets the ground. */
typedef struct GroundPoint {
    bool   known;                /* false: it does not, within the terrain */
    double lat_rad, lon_rad, height_m; /* WGS 84, above the ellipsoid */
    double range_m;              /* from the sensor */
} GroundPoint;
/* The boresight, then the image's corners. */
typedef enum FootprintPoint {
    FOOTPRINT_CENTRE, FOOTPRINT_UPPER_LEFT, FOOTPRINT_UPPER_RIGHT, FOOTPRINT_LOWER_RIGHT, FOOTPRINT_LOWER_LEFT,
    FOOTPRINT_COUNT
} FootprintPoint;

/* Five rays in double over the terrain's posts, in some microseconds. Corners are the outer corners of the corner
 * pixels, where the lens shows them. Refraction is not considered, as in the images. A sensor below the ground: none
 * known. */
void footprint_of_view(GroundPoint out[FOOTPRINT_COUNT], const World *world, const View *view);

#endif
