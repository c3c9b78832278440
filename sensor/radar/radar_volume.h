/* sensor/radar/radar_volume.h: echoes of what fills a volume: rain, foliage, chaff, as points with random amplitudes.
 *
 * Each point has a complex Gaussian amplitude, so that any sum of them is one too: speckle about the mean power of the
 * volume, with the Doppler spectrum of the points' velocities. Draws are functions of seed and place (foliage), or of
 * seed, time, axis and frame number (rain and chaff, whose phases last for less than a millisecond of motion). */
#ifndef SENSOR_RADAR_RADAR_VOLUME_H
#define SENSOR_RADAR_RADAR_VOLUME_H

#include "sensor/radar/seeker_radar_private.h"

typedef struct VolumePoint {
    Sight         sight;        /* from the antenna of the Making */
    ScatterMatrix s;            /* m */
    bool          turns;        /* s is in the horizontal's basis (scatter.h): to be turned to the antenna's */
    double        v_enu_mps[3];
} VolumePoint;

/* Those that neither relief nor entities hide, for the positions of the beam less than `widest` off (RadarPoint); returns how
 * many. count: up to hits_capacity. */
int making_keep(RadarPoint *out, VolumePoint *point, int count, const Making *making, double slack_m, double widest);

/* make(out, ...) fills at most `each` points for each task, in any thread, and returns how many; they are added to the
 * radar's in order of tasks. */
typedef int (*VolumeMake)(RadarPoint *out, const Making *making, void *user, int task);
Status making_points(Making *making, int tasks, int each, VolumeMake make, void *user);

/* Of this interval and no other, for random_uniform's `frame`. */
uint32_t making_key(const Making *making);
void     making_wind(double v_enu_mps[3], const Making *making); /* towards which it blows */

/* radar_canopy.c */
Status making_canopy(Making *making);
/* radar_chaff.c */
Status making_chaff_open(Making *making);
double making_chaff_np(const Making *making, const Sight *sight);
Status making_chaff(Making *making);

#endif
