/* sensor/radar/radar_frame.h: what a seeker's radar measured in one coherent interval about a frame's time, with its
 * truth; and, if its beam scans, in those before and after.
 *
 * Immutable once made; all arrays are in the frame's arena. Ranges are in m from the antenna to the place, range
 * rates in m/s, above 0: receding. Directions are cosines along the sensor's right and down axes. */
#ifndef SENSOR_RADAR_RADAR_FRAME_H
#define SENSOR_RADAR_RADAR_FRAME_H

#include "sensor/radar/detect.h"
#include "sensor/radar/radar_preset.h"
#include "sensor/radar/radar_scan.h"

/* Truth of one entity within beam and range window. */
typedef struct RadarTruth {
    int    entity;                     /* index in the snapshot */
    double range_m, range_rate_mps;    /* of the origin of its model */
    double cos_right, cos_down;
    double visible;                    /* share of its box that relief, plants and other entities leave */
    double rcs_m2[3];                  /* hh, vv, hv, at the centre frequency, as if wholly visible */
    double snr;                        /* by the radar equation, in its cell of the map, if it were a point; 0: none of it is seen */
    int    centres;                    /* scattering centres that it was summed from */
    double strongest_m2;               /* of the strongest of them, vertical polarisation both ways */
    double strongest_body[3];          /* where, m, body axes */
    int    strongest_bounce;           /* mirrors on its path */
    int    strongest_part;             /* of the model */
} RadarTruth;

typedef struct RadarFrame {
    const RadarPreset *preset;
    double          reference_m, reference_rate_mps; /* the middle of the range window, and how it moves */
    double          air_db;            /* one way, over the reference range */
    RangeDoppler    map;
    double complex *profile;           /* [2][samples]: range profiles of the middle pulse, sqrt(W): the transmitted polarisation, the
                                        * other */
    double         *profile_w;         /* [samples]: sum channel, mean power of all pulses */
    int             detections, detections_in_all; /* the strongest; how many passed the threshold */
    const Detection *detection;
    int             targets;
    const RadarTruth *target;
    ReceiverReport  receiver;
    const RadarScan *scan;             /* NULL: the beam stares */
    int             ground_cells, ground_hidden; /* scatterers of the ground; of them, hidden */
    double          spent_s;           /* wall clock */
} RadarFrame;

#endif
