/* sensor/radar/seeker_radar_private.h: one interval in the making, shared by what adds echoes to it. */
#ifndef SENSOR_RADAR_SEEKER_RADAR_PRIVATE_H
#define SENSOR_RADAR_SEEKER_RADAR_PRIVATE_H

#include "render/radar/centres.h"
#include "render/radar/clutter_cache.h"
#include "render/radar/foliage.h"
#include "render/radar/given_list.h"
#include "render/radar/ground_bounce.h"
#include "render/radar/radar_path.h"
#include "render/radar/signatures.h"
#include "sensor/radar/echo.h"
#include "sensor/radar/radar_points.h"
#include "sensor/radar/seeker_radar.h"
#include "sensor/radar/signature_library.h"

enum { beam_batch = 1 << 16 }; /* echoes of a round */

struct SeekerRadar {
    RadarPreset    preset;
    bool           ground, in_band; /* in_band: of the clutter table */
    double         wind_mps, chaff_dipoles;
    uint64_t       seed;
    Catalog       *catalog;      /* its own: as fine as the wavelength needs */
    RadarMaterials materials;
    SignatureLibrary *library;   /* NULL: none */
    Signatures    *signatures;
    uint64_t       left_out;     /* updates, for want of signatures */
    GivenList     *given;        /* NULL: none */
    Centres        centres;      /* of the target at work */
    ClutterTable   clutter;
    GroundTable    mirror;       /* how the ground reflects */
    bool           ground_bounce;
    ClutterGrid    cells;
    ClutterCache  *drawn;        /* NULL without ground */
    ClutterBand    band;
    Foliage       *foliage;      /* of the world's plants; NULL: none stand */
    GasLines       gases;
    RadarAir       air;
    EchoGrid      *echoes;
    IntervalPlan  *plan;
    RadarPoints    points;       /* of the frame at work */
    int            target_points;/* of them, of entities: the first */
    Arena         *position;     /* what one position of a scan needs; NULL: it stares */
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
    double            aim_m;                       /* range that the window is asked to be about */
    double            reference_m;                 /* middle of the range window now */
    double            reference_rate_mps;          /* of the aim: rates of echoes are against it */
    double            window_rate_mps;             /* at which the window's middle moves: that, or 0 */
    double            after_s;                     /* since the frame's time */
    double            scan_half_rad;               /* the beam will turn so far to both sides */
    double            sweep_m;                     /* and ranges will change by up to this */
    double            half_window_m;               /* of range */
    double            near_m, far_m;               /* ranges between which echoes can be in it, fold by fold */
    double            reach;                       /* RadarScene.reach */
    double            widest;                      /* sine off the axis beyond which entities are left out */
    double            air_np_m;                    /* power, one way, 1/m */
    int               missing;                     /* entities whose signatures are still to be made */
    const struct ChaffCloud *chaff;                /* [chaff_count] */
    int               chaff_count;
    double            base_m;                      /* height of the ground at the reference, ENU */
    Pool             *pool;
    Arena            *arena;
} Making;

/* From the antenna to a place: range, unit direction, cosines along right and down, whether it is ahead and its
 * echo within the window (grown by more_m), if by folding over. */
typedef struct Sight {
    double range_m, d_enu[3], cos_right, cos_down;
    bool   within;
} Sight;
void making_sight(Sight *out, const Making *making, const double p_enu[3], double more_m);
/* Sine of the angle off the beam's axis, off the nearest of its axes if it will turn. */
double making_off_axis(const Making *making, const Sight *sight);

/* Range rate of a place that moves, relative to the antenna; and over the reference's as growth of the two-way path
 * a pulse. */
double making_range_rate(const Making *making, const Sight *sight, const double v_enu_mps[3]);

/* The range at which a profile has its echo: folded over, and coupled to its range rate. */
double making_appears_m(const Making *making, const Sight *sight, double range_rate_mps);

/* Its amplitudes in the four channels: what is scattered (m, received h or v along the antenna's right and up by
 * transmitted), at a range and direction, through the air, the foliage on the way (render/radar/foliage.h) and chaff. */
void making_amplitudes(double complex amplitude[interval_channels], const Making *making, const Sight *sight,
                       const ScatterMatrix *s);

/* An entity at work. */
typedef struct Target {
    const SnapshotEntity *entity;
    int            index, model;            /* in the snapshot; in the radar's catalog */
    const Model   *of;
    double         p_enu[3], v_enu_mps[3], r_enu_from_body[9];
    ScatterAntenna antenna;                 /* seen from it */
    const NodePose *pose;                   /* [node_count], body axes, as in its list of hits */
    double        *joint;
} Target;
/* Velocity of a point of a node, ENU: of the entity, its turning, and what spins and rolls on it. node -1: of none. */
void making_target_velocity(double v_enu_mps[3], const Target *target, int node, const double p_body[3]);

/* Makes fewer echoes of a target's, where the radar tells few of them apart; returns how many are left. x: their paths,
 * growth of the paths, cosines to the right and down; spins: those whose part does. */
enum { merge_axes = 4 };
int making_merge(RadarPoint *point, const double (*x)[merge_axes], const bool *spins, int count, const Making *making);

/* Adds the echoes of an entity by way of the ground, whose field is direct without it (body bases), and their truth. With
 * signatures missing: asks for its own alone. */
Status making_bounce(Making *making, const Target *target, const ScatterMatrix *direct, RadarTruth *truth);
/* Which centres of an entity of the snapshot the antenna sees: seen[centres->count]. Centres share a sight line within
 * cells of a 47th of their extent, of 0.05 m at least, so that the edge of a shadow is as fine as that; a line that
 * meets the entity itself first is clear. Those of many mirrors stand for the middle of their path. */
Status radar_sight_centres(bool *seen, const Making *making, int entity, const double p_enu[3],
                           const double r_enu_from_body[9], const Centres *centres);
/* Where relief, a plant or an entity is met more than slack_m[i] before the place that sight[i] leads to from from_enu.
 * own: snapshot index of an entity that is in nothing's way, -1: none. count: up to hits_capacity. */
void making_hidden(bool *hidden, const Making *making, const double from_enu[3], const Sight *sight,
                   const double *slack_m, int count, int own);
/* Sets near_m and far_m about reference_m. */
void making_reach(Making *making);
/* Rectangle in plan about what the main lobe lights within the window. */
void making_lit_rectangle(double low_m[2], double high_m[2], const Making *making);
/* Sine off the axis of the main lobe's null. */
double making_null(const Making *making);

/* Adds the echoes of entities to the radar's points, and their truth to the frame. */
Status making_targets(Making *making);
/* Those of entities in one position of a scan. */
Status making_targets_anew(Making *beam);
/* Adds those of the ground. */
Status making_ground(Making *making);
/* Before any echo: what weakens all of them on their way, foliage and chaff; its loss to a sight's place in nepers of
 * power, one way. */
Status making_volume_open(Making *making);
double making_volume_np(const Making *making, const Sight *sight);
/* Adds the echoes of foliage and chaff to the radar's points. */
Status making_volume(Making *making);
/* Those of the rain in one position of the beam. */
Status making_rain(Making *beam);

/* A position of the beam: turned about the antenna's down axis to the right, after_s from the frame's time. */
void   beam_at(Making *out, const Making *making, double azimuth_rad, double after_s);
/* Adds the echoes of all points, and of the rain in this position, to the radar's grid; sum_alone: to its sum channel
 * only. In the order of the points, for any number of threads. */
Status beam_echoes(Making *beam, bool sum_alone);
/* All positions but the middle one, whose interval is given, measured anew; then the pictures of the frame. */
Status making_scan(Making *making, Interval *middle);

#endif
