/* sensor/radar/seeker_radar.h: the radar of a seeker: from a snapshot to what its receiver and processing make of
 * it.
 *
 * At the frame's time a coherent interval is centred. The beam is the sensor's boresight; the range window is about
 * the reference: the range to the aim, else to the ground along the boresight. Within beam and window
 *
 *     entities   by their scattering centres (render/radar), each with its own range rate from the motion of its part
 *     ground     by scatterers fixed to it (render/radar/clutter.h), where relief, plants and entities leave it in sight
 *
 * go through the radar equation, the antenna's pattern at their own direction, and the air (radar_path.h) into the
 * samples of four channels; then receiver and processing. Phases are those of double ranges. A beam that scans
 * (radar_scan.h) has further intervals before and after.
 *
 * Left out: entities farther off the axis than u = 16 (two-way pattern below -80 dB) and ground beyond the main
 * lobe's null; ground bounce and what one entity mirrors to another; range rates that change within the interval;
 * the internal motion of ground within the interval (it moves between intervals). An entity partly hidden gives its
 * visible share of power. */
#ifndef SENSOR_RADAR_SEEKER_RADAR_H
#define SENSOR_RADAR_SEEKER_RADAR_H

#include "render/frame/world.h"
#include "render/scene/view.h"
#include "sensor/radar/radar_frame.h"

typedef struct SeekerRadarConfig {
    const char *preset;          /* a row of etc/radars.csv */
    const char *catalog;         /* path; its models are built anew, as fine as the wavelength needs */
    const char *isa;
    bool        ground;          /* scatterers of the ground */
    double      scan_rad;        /* sector that the beam scans, about the boresight; 0: it stares */
    double      scan_step;       /* between its positions, over the beamwidth */
    double      warp_m;          /* unevenness of surfaces, rms (render/radar/warp.h) */
    double      wind_mps;
    uint64_t    seed;
} SeekerRadarConfig;

typedef struct SeekerRadar SeekerRadar;

Status seeker_radar_create(SeekerRadar **out, const SeekerRadarConfig *config);
void   seeker_radar_destroy(SeekerRadar *radar); /* accepts NULL */

typedef struct RadarScene {
    const World    *world;
    const Snapshot *snapshot;
    const View     *view;        /* where the antenna is, and its axes */
    int             hidden;      /* snapshot index of the host, -1: none; it is not in its own way */
    double          v_enu_mps[3];/* of the antenna */
    double          reference_m; /* range to the aim; NAN: to the ground ahead */
    double          reference_v_enu_mps[3]; /* of the aim; 0: of the ground */
    double          t_s;         /* exercise time */
    const Weather  *weather;     /* at the ground */
    uint32_t        number;      /* of the frame: for its noise */
    const float    *range_m;     /* [view height][width]: of what each pixel shows, INFINITY: sky. NULL: no pixels */
    const uint32_t *entity;      /* likewise: snapshot index + 1, 0: none */
} RadarScene;

/* *out in the arena. */
Status seeker_radar_measure(const RadarFrame **out, SeekerRadar *radar, const RadarScene *scene, Pool *pool, Arena *arena);

#endif
