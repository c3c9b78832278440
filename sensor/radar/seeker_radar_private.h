/* sensor/radar/seeker_radar_private.h: one interval in the making, shared by what adds echoes to it. */
#ifndef SENSOR_RADAR_SEEKER_RADAR_PRIVATE_H
#define SENSOR_RADAR_SEEKER_RADAR_PRIVATE_H

#include "render/radar/centres.h"
#include "render/radar/clutter.h"
#include "render/radar/radar_path.h"
#include "render/radar/signatures.h"
#include "sensor/radar/echo.h"
#include "sensor/radar/radar_points.h"
#include "sensor/radar/seeker_radar.h"

enum { beam_batch = 1 << 16 }; /* echoes of a round */

struct SeekerRadar {
    RadarPreset    preset;
    bool           ground;
    double         wind_mps;
    uint64_t       seed;
    Catalog       *catalog;      /* its own: as fine as the wavelength needs */
    RadarMaterials materials;
    Signatures    *signatures;
    Centres        centres;      /* of the target at work */
    ClutterTable   clutter;
    ClutterGrid    cells;
    ClutterBand    band;
    GasLines       gases;
    RadarAir       air;
    EchoGrid      *echoes;
    IntervalPlan  *plan;
    RadarPoints    points;       /* of the frame at work */
    Echo          *batch;        /* [beam_batch] */
    ScanPlan       scan;         /* positions 1: the beam stares */
    double complex *scan_pulse;  /* [positions][pulses][samples]: compressed in range, sum channel; NULL: it stares */
};

typedef struct Making {
    SeekerRadar      *radar;
    const RadarScene *scene;
    const RadarPreset *preset;
    const Visibility *visibility;
    RadarFrame       *frame;
    double            p_enu[3];                    /* of the antenna */
    double            right[3], down[3], ahead[3]; /* its axes, ENU */
    double            reference_m;                 /* middle of the range window now */
    double            after_s;                     /* since the frame's time */
    double            scan_half_rad;               /* the beam will turn so far to both sides */
    double            sweep_m;                     /* and ranges will change by up to this */
    double            half_window_m;               /* of range */
    double            widest;                      /* sine off the axis beyond which entities are left out */
    double            air_np_m;                    /* power, one way, 1/m */
    Pool             *pool;
    Arena            *arena;
} Making;

/* From the antenna to a place: range, unit direction, cosines along right and down, whether it is ahead and within
 * the window (grown by more_m). */
typedef struct Sight {
    double range_m, d_enu[3], cos_right, cos_down;
    bool   within;
} Sight;
void making_sight(Sight *out, const Making *making, const double p_enu[3], double more_m);
/* Sine of the angle off the beam's axis, off the nearest of its axes if it will turn. */
double making_off_axis(const Making *making, const Sight *sight);
/* From the frame's time to the farthest interval in which a beam that scans still lights it, s; 0: the beam stares. */
double making_wait_s(const Making *making, const Sight *sight);

/* Range rate of a place that moves, relative to the antenna; and over the reference's as growth of the two-way path
 * a pulse. */
double making_range_rate(const Making *making, const Sight *sight, const double v_enu_mps[3]);

/* Its amplitudes in the four channels: what is scattered (m, received h or v along the antenna's right and up by
 * transmitted), at a range and direction, through the air. */
void making_amplitudes(double complex amplitude[interval_channels], const Making *making, const Sight *sight,
                       const ScatterMatrix *s);

/* Adds the echoes of entities to the radar's points, and their truth to the frame. */
Status making_targets(Making *making);
/* Adds those of the ground. */
Status making_ground(Making *making);

/* A position of the beam: turned about the antenna's down axis to the right, after_s from the frame's time. */
void   beam_at(Making *out, const Making *making, double azimuth_rad, double after_s);
/* Adds the echoes of all points to the radar's grid; sum_alone: to its sum channel only. In the order of the points,
 * for any number of threads. */
void   beam_echoes(const Making *beam, bool sum_alone);
/* All positions but the middle one, whose interval is given, measured anew; then the pictures of the frame. */
Status making_scan(Making *making, Interval *middle);

#endif
