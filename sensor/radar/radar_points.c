/* sensor/radar/radar_points.c: the points of a frame, which grow and last. */
#include "sensor/radar/seeker_radar_private.h"

#include <stdlib.h>

RadarPoint *radar_points_room(RadarPoints *points, int more)
{
    if (more > INT32_MAX / 2 - points->count) return NULL;
    const int need = points->count + more;
    if (need > points->capacity) {
        const int   capacity = need > 2 * points->capacity ? need : 2 * points->capacity;
        RadarPoint *grown = realloc(points->point, (size_t)capacity * sizeof *grown);
        if (!grown) return NULL;
        points->point = grown;
        points->capacity = capacity;
    }
    return points->point + points->count;
}

void radar_points_free(RadarPoints *points)
{
    free(points->point);
    *points = (RadarPoints){0};
}
