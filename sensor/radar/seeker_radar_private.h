/* sensor/radar/seeker_radar_private.h: a seeker's radar (SeekerRadar), and one frame of it while it is measured
 * (RadarShot): what the files of this folder share.
 *
 *     seeker_radar.c   what lasts; the order of work in a shot; the echoes of all points, the receiver, detections
 *     radar_points.c   memory of the points
 *     radar_coarse.c   coarse signatures, and what is prepared of them
 *     shot_sight.c     the way from the antenna to a place, and what stands before it
 *     shot_targets.c   points of entities
 *     shot_merge.c     fewer of them where the radar tells few apart
 *     shot_ground.c    points of the ground
 *     shot_bounce.c    echoes of entities by way of it
 *     shot_volume.c    points of rain, foliage and chaff, and what these weaken
 *     shot_scenery.c   points of scenery, with its neighbours (shot_scenery_private.h)
 *     shot_sector.c    further positions of a beam that scans, and their pictures */
#ifndef SENSOR_RADAR_SEEKER_RADAR_PRIVATE_H
#define SENSOR_RADAR_SEEKER_RADAR_PRIVATE_H

#include "render/scattering/built/facade_table.h"
#include "render/scattering/built/thing_table.h"
#include "render/scattering/clutter/clutter.h"
#include "render/scattering/clutter/foliage_fan.h"
#include "render/scattering/clutter/leaf_cache.h"
#include "render/scattering/paths/ground_bounce.h"
#include "render/scattering/paths/radar_path.h"
#include "render/scattering/signatures/centres.h"
#include "render/scattering/signatures/given_signature.h"
#include "render/scattering/signatures/signatures.h"
#include "render/scattering/signatures/coarse.h"
#include "sensor/radar/echo.h"
#include "sensor/radar/seeker_radar.h"
#include "sensor/radar/signature_library.h"

/* ---- points -------------------------------------------------------------------------------------- */

/* A point echo of a frame. The points of ground and plants are made once for all positions of the beam, those of
 * entities and rain anew for each. A position leaves out points that are farther off its axis than their own `widest`
 * (entities: u = 16, ground: the main lobe's null) or beyond its range window; tests/sensor/test_scan.c has what that
 * loses. */
typedef struct RadarPoint {
    double         p_enu[3], v_enu_mps[3];
    double         path_m, path_per_pulse_m; /* as Echo's, at the frame's time */
    double complex same, other;              /* scattered, m: received as transmitted, and in the other polarisation */
    double         share;                    /* of the amplitude that is in sight */
    double         widest, room_m;           /* counts so far off an axis (sine), and beyond the window */
    bool           own;    /* made for one position of the beam: place and path are those at its instant */
    int32_t        source; /* of RadarFrame.source, from 1; 0: not of scenery */
} RadarPoint;

typedef struct RadarPoints {
    int         count, capacity;
    RadarPoint *point;
} RadarPoints;

/* Makes room for `more` points behind the last, which are not yet counted. NULL: out of memory. */
RadarPoint *radar_points_room(RadarPoints *points, int more);
void        radar_points_free(RadarPoints *points); /* accepts zeroes */

/* ---- the radar and a shot -------------------------------------------------------------------------- */

enum { beam_batch = 1 << 16 }; /* echoes of a round */

struct SeekerRadar {
    RadarPreset       preset;
    bool              ground, in_band; /* in_band: of the clutter table */
    double            wind_mps, chaff_dipoles;
    uint64_t          seed;
    Catalog          *catalog; /* its own: as fine as the wavelength needs */
    RadarMaterials    materials;
    SignatureLibrary *library; /* NULL: none */
    Signatures       *signatures;
    SignaturesConfig  fine; /* of these */
    char              catalog_path[4096];
    Catalog          *coarse_catalog; /* as fine as coarse signatures need; NULL until these are needed */
    Signatures       *coarse;         /* likewise */
    uint64_t          left_out;       /* updates, for want of signatures */
    GivenList        *given;          /* NULL: none */
    Centres           centres;        /* of the target at work */
    ClutterTable      clutter;
    GroundTable       mirror; /* how the ground reflects */
    bool              ground_bounce;
    bool              scenery; /* its echoes */
    FacadeTable       facades;
    ThingTable        things;
    ClutterGrid       cells;
    ClutterCache     *drawn; /* NULL without ground */
    ClutterBand       band;
    Foliage          *foliage; /* of the world's plants; NULL: none stand */
    LeafCache        *leaves;  /* drawn of its crowns; NULL: no foliage */
    GasLines          gases;
    RadarAir          air;
    EchoGrid         *echoes;
    IntervalPlan     *plan;
    RadarPoints       points;        /* of the frame at work */
    int               target_points; /* how many of the points are of entities; they come first */
    Arena            *position;      /* what one position of the sector needs; NULL: it stares */
    Echo             *batch;         /* [beam_batch] */
    SectorPlan        sector;        /* positions 1: the beam stares */
    double complex *sector_pulse; /* [positions][pulses][samples]: compressed in range, sum channel; NULL: it stares */
};

/* One frame of the radar while it is measured; a position of a beam that scans has one of its own. */
typedef struct RadarShot {
    SeekerRadar             *radar;
    const RadarScene        *scene;
    const RadarPreset       *preset;
    const Visibility        *visibility;
    bool                     coarse; /* with coarse signatures */
    RadarFrame              *frame;
    double                   p_enu[3];                    /* of the antenna */
    double                   right[3], down[3], ahead[3]; /* its axes, ENU */
    double                   aim_m;                       /* range that the window is asked to be about */
    double                   reference_m;                 /* middle of the range window now */
    double                   reference_rate_mps;          /* of the aim: rates of echoes are against it */
    double                   window_rate_mps;             /* at which the window's middle moves: that, or 0 */
    double                   after_s;                     /* since the frame's time */
    double                   sector_half_rad;             /* the beam will turn so far to both sides */
    double                   sweep_m;                     /* and ranges will change by up to this */
    double                   half_window_m;               /* of range */
    double                   near_m, far_m;               /* ranges between which echoes can be in it, fold by fold */
    double                   reach;                       /* RadarScene.reach */
    double                   widest;                      /* sine off the axis beyond which entities are left out */
    double                   air_np_m;                    /* power, one way, 1/m */
    int                      missing;                     /* entities whose signatures are still to be made */
    FoliageFan              *fan;                         /* foliage by direction; NULL: none is */
    const struct ChaffCloud *chaff;                       /* [chaff_count] */
    int                      chaff_count;
    double                   base_m;  /* height of the ground at the reference, ENU */
    struct ShotScenery      *scenery; /* NULL: none, or its echoes are off */
    Pool                    *pool;
    Arena                   *arena;
} RadarShot;

/* ---- radar_coarse.c --------------------------------------------------------------------------------- */

/* Has the radar's coarse signatures at hand, once. */
Status radar_coarse_open(SeekerRadar *radar);
void   radar_coarse_close(SeekerRadar *radar);

/* ---- shot_sight.c ---------------------------------------------------------------------------------- */

/* From the antenna to a place: range, unit direction, cosines along right and down, whether it is ahead and its
 * echo within the window (grown by more_m), if by folding over. */
typedef struct Sight {
    double range_m, d_enu[3], cos_right, cos_down;
    bool   within;
} Sight;
void shot_sight(Sight *out, const RadarShot *shot, const double p_enu[3], double more_m);
/* Sine of the angle off the beam's axis, off the nearest of its axes if it will turn. */
double shot_off_axis(const RadarShot *shot, const Sight *sight);

/* Range rate of a moving place relative to the antenna, m/s. */
double shot_range_rate(const RadarShot *shot, const Sight *sight, const double v_enu_mps[3]);

/* The range at which a profile has its echo: folded over, and coupled to its range rate. */
double shot_appears_m(const RadarShot *shot, const Sight *sight, double range_rate_mps);

/* Amplitudes in the four channels of what is scattered (m, received h or v along the antenna's right and up by
 * transmitted) at a range and direction, through the air, and the foliage and chaff on the way. */
void shot_amplitudes(double complex amplitude[interval_channels], const RadarShot *shot, const Sight *sight,
                     const ScatterMatrix *s);

/* The same, where the loss by foliage and chaff is known: shot_volume_np. */
void shot_amplitudes_through(double complex amplitude[interval_channels], const RadarShot *shot, const Sight *sight,
                             const ScatterMatrix *s, double volume_np);

/* An echo that foliage and chaff weaken by more than 40 dB each way is left out: all of them together are 80 dB below
 * what the same points return in the open. Nepers of power, one way. */
static const double gone_np = 9.2103403719761836;

/* Sine off the axis of the main lobe's null. */
double shot_null(const RadarShot *shot);
/* Where relief, a plant or an entity is met more than slack_m[i] before the place that sight[i] leads to from from_enu.
 * own: snapshot index of an entity that is in nothing's way, -1: none. count: up to hits_capacity. */
void shot_hidden(bool *hidden, const RadarShot *shot, const double from_enu[3], const Sight *sight,
                 const double *slack_m, int count, int own);
/* Which centres of an entity of the snapshot the antenna sees: seen[centres->count]. Centres share a sight line within
 * cells of a 47th of their extent, of 0.05 m at least, so that the edge of a shadow is as fine as that; a line that
 * meets the entity itself first is clear. Those of many mirrors stand for the middle of their path. */
Status shot_sees_centres(bool *seen, const RadarShot *shot, int entity, const double p_enu[3],
                         const double r_enu_from_body[9], const Centres *centres);

/* ---- shot_targets.c -------------------------------------------------------------------------------- */

/* An entity at work. */
typedef struct Target {
    const SnapshotEntity *entity;
    int                   index, model; /* in the snapshot; in the radar's catalog */
    const Model          *of;
    double                p_enu[3], v_enu_mps[3], r_enu_from_body[9];
    ScatterAntenna        antenna; /* seen from it */
    const NodePose       *pose;    /* [node_count], body axes, as in its list of hits */
    double               *joint;
} Target;
/* Velocity of a point of a node, ENU: that of the entity, of its turning, and of what spins and rolls on it. node -1:
 * the point is on no node. */
void shot_target_velocity(double v_enu_mps[3], const Target *target, int node, const double p_body[3]);
/* Whether a node, or one that it is on, turns by itself: it rolls, or spins, as the entity moves forward. */
bool shot_target_spins(const Target *target, int node, double forward_mps);
/* Adds the echoes of entities to the radar's points, and their truth to the frame. */
Status shot_targets(RadarShot *shot);
/* Adds the points of entities in one position of the sector. */
Status shot_targets_anew(RadarShot *beam);

/* ---- shot_merge.c ---------------------------------------------------------------------------------- */

/* What tells echoes apart: path, its growth from pulse to pulse, cosines along right and down. */
enum { merge_axes = 4 };

/* The points of a target, among those of the radar. */
typedef struct TargetPoints {
    int first, count;
    const double (*x)[merge_axes]; /* [count] */
    const bool *spins;             /* [count]: on a part that turns by itself */
} TargetPoints;

/* Makes them fewer, in their place. */
void shot_merge_points(TargetPoints *points, const RadarShot *shot);
/* The same of echoes of one target, which have the antenna's pattern in them: by path and its growth alone, so that
 * they need not be near each other in direction. Returns how many are left. */
int shot_merge_echoes(Echo *echo, const bool *spins, int count, const RadarShot *shot);

/* ---- shot_ground.c --------------------------------------------------------------------------------- */

/* Adds the echoes of the ground. */
Status shot_ground(RadarShot *shot);
/* The rectangle in plan around what the main lobe lights within the window. */
void shot_lit_rectangle(double low_m[2], double high_m[2], const RadarShot *shot);

/* ---- shot_bounce.c ---------------------------------------------------------------------------------- */

/* Adds the echoes of an entity by way of the ground, whose field is direct without it (body bases), and their
 * truth. With signatures missing it asks for its own alone. */
Status shot_bounce(RadarShot *shot, const Target *target, const ScatterMatrix *direct, RadarTruth *truth);

/* ---- shot_volume.c --------------------------------------------------------------------------------- */

/* Finds the foliage and chaff that weaken all echoes on their way; called before any echo. */
Status shot_volume_open(RadarShot *shot);
/* Lists the foliage about the beam's axis, from where its antenna is, for its many echoes; no bit depends on it. */
void shot_volume_fan(RadarShot *beam);
/* Loss by foliage and chaff on the way to a sight's place, in nepers of power, one way. */
double shot_volume_np(const RadarShot *shot, const Sight *sight);
/* Adds the echoes of foliage and chaff to the radar's points. */
Status shot_volume(RadarShot *shot);
/* Adds the points of the rain in one position of the beam. */
Status shot_rain(RadarShot *beam);

/* ---- shot_scenery.c, shot_things.c, shot_told.c ------------------------------------------------------ */

/* Finds the scenery near what is lit; called before the ground, whose classes it changes. */
Status shot_scenery_open(RadarShot *shot);
/* Adds its points. */
Status shot_scenery(RadarShot *shot);
/* The class of the ground at a place: where buildings stand as themselves, that of built ground is a road's. */
uint8_t shot_bare_surface(const RadarShot *shot, uint8_t surface, double x_m, double y_m);
/* Says of detections how much of each scenery made, and what. */
Status shot_tell(RadarShot *shot, Detection *detection);

/* ---- seeker_radar.c -------------------------------------------------------------------------------- */

/* Makes the echo of a point in a position of the beam. False: this position leaves the point out. */
bool shot_echo(Echo *out, const RadarShot *beam, const RadarPoint *point);
/* Makes a position of the beam: turned about the antenna's down axis to the right, after_s from the frame's time. */
void shot_position(RadarShot *out, const RadarShot *shot, double azimuth_rad, double after_s);
/* Adds the echoes of all points, and of the rain in this position, to the radar's grid; sum_alone: to its sum channel
 * only. In the order of the points, for any number of threads. */
Status shot_echoes(RadarShot *beam, bool sum_alone);

/* ---- shot_sector.c --------------------------------------------------------------------------------- */

/* Measures all positions of the sector but the middle one, whose interval is given; then makes the pictures. */
Status shot_sector(RadarShot *shot, Interval *middle);

#endif
