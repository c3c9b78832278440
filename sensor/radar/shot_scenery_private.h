/* sensor/radar/shot_scenery_private.h: scenery (buildings, works, clutter) in a shot of the radar.
 *
 *     shot_scenery.c   what is near the beam; walls, roofs and other flat faces, and the ground before walls
 *     shot_things.c    clutter: vehicles, machines, animals, stores
 *     shot_told.c      which detections are of it
 *
 * It hides what is behind it by shot_hidden, as relief and entities do. Its points are made once for all positions of
 * the beam, as those of the ground. */
#ifndef SENSOR_RADAR_SHOT_SCENERY_PRIVATE_H
#define SENSOR_RADAR_SHOT_SCENERY_PRIVATE_H

#include "render/scattering/built/facade_echo.h"
#include "render/trace/parts/parts.h"
#include "sensor/radar/seeker_radar_private.h"

enum { piece_block = 256 }; /* sight lines of a call */

typedef struct ShotScenery {
    const SceneryFrame *frame;
    const Scenery      *of;
    const int          *list;  /* [count]: objects near the rectangle that the main lobe lights, ascending */
    int                 count; /* of list */
    int                 boxes;
    double (*box)[4]; /* [boxes]: of cells of buildings: west, south, east, north */
    double widest;    /* sine off the axis of the main lobe's null */
} ShotScenery;

/* Whether an object may return anything: it is there, and within beam and window. */
bool shot_scenery_lit(const RadarShot *shot, int object);
/* The number of a source among the frame's; adds it if it is new. */
Status shot_source(int *out, RadarShot *shot, int object, uint64_t id);
/* The band of the clutter table that is nearest to the radar's. */
ClutterBand shot_band(const RadarShot *shot);
/* Whether waves pass from the antenna to a place on the ground, and from there to a place above it. */
bool shot_ground_is_seen(const RadarShot *shot, const double p_ground_enu[3], const double p_enu[3]);
/* Adds the points of faces of buildings and works; of clutter. */
Status shot_faces(RadarShot *shot);
Status shot_things(RadarShot *shot);

#endif
