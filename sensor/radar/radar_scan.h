/* sensor/radar/radar_scan.h: a beam that scans a sector: its real-beam picture, that picture sharpened by Doppler, and
 * both on the pixels of the frame.
 *
 * The beam steps through positions in azimuth about the antenna's down axis, an odd number, from left to right; each is
 * one coherent interval, they follow each other without pause, and the middle one is the frame's own at its time. The
 * antenna and what it sees move on meanwhile.
 *
 *     real beam    mean power of a position's pulses over range (relative to the reference, which is followed)
 *     sharpened    of the position that comes nearest in azimuth, the pulses summed for the Doppler of still ground
 *                  there, which the antenna's own velocity gives; over the pattern's loss off the position's axis.
 *                  Resolution width lambda R / (2 T |v . (down x d)|), which is lambda R / (2 v T sin psi) for level
 *                  flight: width is the Doppler window's at half power. Where that is no finer than the two-way beam,
 *                  where the other side of the velocity is within a beamwidth, or Doppler folds over within the beam,
 *                  the real beam stands in its place (`sharpened` 0)
 *     on pixels    value at the range and azimuth of what the pixel shows, moved on to when the beam's axis meets it
 *
 * The sharpened picture takes the ground as level, at the height of the reference point; the pixels have their own
 * directions. What moves is displaced in it, as in every picture by Doppler. Between positions the real beam is a cubic
 * (Catmull and Rom's) of the logarithm: exact for a Gaussian beam. */
#ifndef SENSOR_RADAR_RADAR_SCAN_H
#define SENSOR_RADAR_RADAR_SCAN_H

#include "sensor/radar/radar_preset.h"

enum { scan_positions_most = 1001, scan_azimuths_most = 4001 };

typedef struct ScanPlan {
    int    positions;               /* odd; 1: the beam stares */
    double step_rad, interval_s;    /* between positions */
} ScanPlan;

/* Positions over a sector, a share of the (one-way) beamwidth apart. STATUS_BAD_VALUE, logged: too many, or more than
 * 2^27 samples in all. */
Status scan_plan(ScanPlan *out, const RadarPreset *preset, double sector_rad, double step_share);

/* Arrays are in the frame's arena. */
typedef struct RadarScan {
    ScanPlan plan;
    int      columns;               /* of range, as in the map: the nearest first */
    double   beam_rad;              /* width of the two-way beam at half power */
    double   noise_w, sharp_noise_w;/* thermal, in a cell of either picture */
    double  *power_w;               /* [positions][columns] */
    int      azimuths;              /* of the sharpened picture, from that of the first position on */
    double   azimuth_step_rad;
    double  *sharp_w;               /* [azimuths][columns] */
    float   *resolution_m;          /* [azimuths][columns]: across, at half power, of what stands there */
    uint8_t *sharpened;             /* [azimuths][columns] */
    double   sharpened_share;       /* of these cells */
    int      width, height;         /* of the frame's pixels; 0: none were given */
    float   *view_w, *view_sharp_w; /* [height][width]; NAN: sky, or out of sector or window */
} RadarScan;

#endif
