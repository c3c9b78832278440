/* sensor/radar/radar_points.h: the point echoes of a frame: ground and plants once for all positions of the beam, entities and
 * rain anew for each.
 *
 * Left out of a position (beam.c): points farther off its axis than their own `widest` (entities: u = 16, ground: the
 * main lobe's null), and beyond its range window. tests/sensor/test_scan.c: what that leaves out. */
#ifndef SENSOR_RADAR_RADAR_POINTS_H
#define SENSOR_RADAR_RADAR_POINTS_H

#include "pitviper.h"

#include <complex.h>

typedef struct RadarPoint {
    double         p_enu[3], v_enu_mps[3];
    double         path_m, path_per_pulse_m; /* as Echo's, at the frame's time */
    double complex same, other;              /* scattered, m: received as transmitted, and in the other polarisation */
    double         share;                    /* of the amplitude that is in sight */
    double         widest, room_m;           /* counts so far off an axis (sine), and beyond the window */
    bool           own;                      /* of one position, not the frame's: place and path are those at its instant */
} RadarPoint;

typedef struct RadarPoints {
    int         count, capacity;
    RadarPoint *point;
} RadarPoints;

/* Room for as many behind the last, not yet counted; NULL: no memory. */
RadarPoint *points_room(RadarPoints *points, int more);
void        points_free(RadarPoints *points);

#endif
