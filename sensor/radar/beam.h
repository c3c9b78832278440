/* sensor/radar/beam.h: the point echoes of a frame, and what one beam receives of them.
 *
 * Entities and ground are turned into points once a frame, for all positions of the beam. A position is a Making with
 * an axis of its own, an instant of its own (after_s, from the frame's time) and the antenna where it is then; points
 * have moved by their own velocities. A path and its growth are those at the frame's time plus the change of the range
 * of the point since: exact for what moves evenly.
 *
 * Left out of a position: points farther off its axis than their own `widest` (entities: u = 16, ground: the main
 * lobe's null), and beyond its range window. tests/sensor/test_scan.c: what that leaves out. */
#ifndef SENSOR_RADAR_BEAM_H
#define SENSOR_RADAR_BEAM_H

#include "pitviper.h"

#include <complex.h>

typedef struct RadarPoint {
    double         p_enu[3], v_enu_mps[3];
    double         path_m, path_per_pulse_m; /* as Echo's, at the frame's time */
    double complex same, other;              /* scattered, m: received as transmitted, and in the other polarisation */
    double         share;                    /* of the amplitude that is in sight */
    double         widest, room_m;           /* sine off an axis, and metres beyond the window, within which it counts */
} RadarPoint;

typedef struct RadarPoints {
    int         count, capacity;
    RadarPoint *point;
} RadarPoints;

/* Room for as many behind the last, not yet counted; NULL: no memory. */
RadarPoint *points_room(RadarPoints *points, int more);
void        points_free(RadarPoints *points);

typedef struct Making Making;
enum { beam_batch = 1 << 16 }; /* echoes of a round */

/* A position of the beam: turned about the antenna's down axis to the right, after_s from the frame's time. */
void   beam_at(Making *out, const Making *making, double azimuth_rad, double after_s);
/* Adds the echoes of all points to the radar's grid; sum_alone: to its sum channel only. In the order of the points, for
 * any number of threads. */
void   beam_echoes(const Making *beam, bool sum_alone);

#endif
