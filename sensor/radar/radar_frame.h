/* sensor/radar/radar_frame.h: what a seeker's radar measured in one coherent interval about a frame's time, with
 * its truth; and, if its beam scans, in those before and after.
 *
 * Immutable once made; all arrays are in the frame's arena. Ranges are in m from the antenna to the place, range
 * rates in m/s, above 0: receding. Directions are cosines along the sensor's right and down axes. */
#ifndef SENSOR_RADAR_RADAR_FRAME_H
#define SENSOR_RADAR_RADAR_FRAME_H

#include "sensor/radar/detect_private.h"
#include "sensor/radar/radar_preset.h"

/* ---- the pictures of a sector ----------------------------------------------------------------------- */

/* A beam that scans a sector makes a real-beam picture, that picture sharpened by Doppler, and both on the pixels
 * of the frame.
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
enum { sector_positions_most = 1001, sector_azimuths_most = 4001 };

typedef struct SectorPlan {
    int    positions;            /* odd; 1: the beam stares */
    double step_rad, interval_s; /* between positions */
} SectorPlan;

/* Positions over a sector, a share of the (one-way) beamwidth apart. STATUS_BAD_VALUE, logged: too many, or more than
 * 2^27 samples in all. */
Status radar_sector_plan(SectorPlan *out, const RadarPreset *preset, double sector_rad, double step_share);

/* Arrays are in the frame's arena. */
typedef struct RadarSector {
    SectorPlan plan;
    int        columns;                /* of range, as in the map: the nearest first */
    double     beam_rad;               /* width of the two-way beam at half power */
    double     noise_w, sharp_noise_w; /* thermal, in a cell of either picture */
    double    *power_w;                /* [positions][columns] */
    int        azimuths;               /* of the sharpened picture, from that of the first position on */
    double     azimuth_step_rad;
    double    *sharp_w;               /* [azimuths][columns] */
    float     *resolution_m;          /* [azimuths][columns]: across, at half power, of what stands there */
    uint8_t   *sharpened;             /* [azimuths][columns] */
    double     sharpened_share;       /* share of these cells that are sharpened */
    int        width, height;         /* of the frame's pixels; 0: none were given */
    float     *view_w, *view_sharp_w; /* [height][width]; NAN: sky, or out of sector or window */
} RadarSector;

/* ---- truth ------------------------------------------------------------------------------------------ */

/* What the ground near an entity adds by mirroring (render/scattering/paths/ground_bounce.h); hh, vv, hv, m^2, as
 * if wholly visible. */
typedef struct RadarBounceTruth {
    double coherence; /* share of the amplitude that the ground mirrors, the larger polarisation; 0: left out */
    double once_m2[3], twice_m2[3]; /* by the ground one way (both ways round together), by the ground both ways */
    double rcs_m2[3];               /* of all paths together, the direct one included */
} RadarBounceTruth;
/* One of the scattering centres of an entity. */
typedef struct RadarScatterer {
    double hh_m2, vv_m2; /* its cross section */
    double p_body[3];    /* m: middle of its path's first and last mirror */
    int    bounce, part; /* mirrors on its path, 0: an edge; of the model, -1: of a given signature */
    bool   seen;         /* nothing else is in its way */
} RadarScatterer;

enum { radar_strongest = 8 };

/* The truth about one entity within beam and range window. */
typedef struct RadarTruth {
    int    entity;                  /* index in the snapshot */
    double range_m, range_rate_mps; /* of the origin of its model */
    double appears_m; /* range at which its echo is on the profile: folded over, coupled to its range rate */
    double cos_right, cos_down;
    bool   given;             /* by a signature of radar.given, else by its model */
    bool   coarse;            /* by a coarse signature of that (coarse.h) */
    double visible;           /* share of its centres' power that relief, plants and other entities leave in sight */
    double rcs_m2[3];         /* hh, vv, hv, at the centre frequency, as if wholly visible and without ground */
    double rcs_error_db[3];   /* standard deviation, by the grid of tubes (signature_error), or of a coarse signature
                               * (coarse_error_db); NAN: given */
    double         map_error; /* error of the map's cells over its centres' power: tubes, and what centres leave out */
    double         snr; /* by the radar equation, of the centres in sight, in one cell of the map; 0: there is none */
    int            centres; /* scattering centres that it was summed from */
    int            strongest_count;
    RadarScatterer strongest[radar_strongest]; /* of them, by the mean of hh and vv */
    RadarBounceTruth bounce;
} RadarTruth;

/* ---- scenery ---------------------------------------------------------------------------------------- */

/* Something of scenery that may return: a record of buildings, or a thing. */
typedef struct RadarSource {
    uint64_t id;     /* of the building's record, or the object's */
    int      object; /* of Scenery.object */
    uint8_t class;   /* SceneryClass; CLUTTER_NONE: built */
} RadarSource;

typedef struct RadarSceneryCount {
    int objects;                   /* near the rectangle that the main lobe lights; 0: there is none */
    int pieces, by_ground, hidden; /* pieces of faces in sight; of them with an echo by the ground too; out of sight */
    int things;                    /* of clutter, of which something is in sight */
    int skipped;                   /* triangles out of beam and window */
    int detections;                /* that are of it */
} RadarSceneryCount;

/* ---- the frame -------------------------------------------------------------------------------------- */

/* What a measurement's time goes into, in order. */
typedef enum RadarStep {
    RADAR_PREPARE, /* aim, air, the foliage by direction */
    RADAR_TARGETS, /* entities' centres, what is hidden of them */
    RADAR_GROUND,
    RADAR_VOLUMES, /* plants, chaff */
    RADAR_ECHOES,  /* of all points into the samples, rain too */
    RADAR_PROCESS, /* receiver, map, detections; positions of a beam that scans */
    RADAR_STEPS
} RadarStep;

typedef struct RadarFrame {
    const RadarPreset *preset;
    double             reference_m, reference_rate_mps; /* the middle of the range window, and how it moves */
    WaveformTiming     timing;
    double             ground_rate_mps; /* of still ground on the axis */
    double             notch_mps; /* detections so near to the ground's range rate in their direction count as ground */
    double             v_enu_mps[3], aim_m,
        aim_v_enu_mps[3];   /* as in its RadarScene: of the antenna; to the aim, NAN: none; of it */
    uint32_t        number; /* interval number, for its noise */
    bool            coarse; /* of coarse signatures (coarse.h), and without the ground's image of entities */
    double          air_db; /* one way, over the reference range */
    RangeDoppler    map;
    double complex *profile; /* [2][samples]: range profiles of the middle pulse, sqrt(W): the transmitted polarisation,
                              * the other */
    double            *profile_w; /* [samples]: sum channel, mean power of all pulses */
    double            *mti_w;     /* [samples]: the same behind the canceller, its gain for noise being 1 */
    int                detections, detections_in_all; /* the strongest; how many passed the threshold */
    const Detection   *detection;
    int                targets;
    const RadarTruth  *target;
    ReceiverReport     receiver;
    const RadarSector *scan;         /* NULL: the beam stares */
    int ground_cells, ground_hidden; /* scatterers of the ground; how many of them relief or entities hide */
    RadarSceneryCount scenery;
    int               sources; /* of scenery, near beam and window */
    RadarSource      *source;
    double            rain_1_m;                     /* backscatter of rain by its volume, m2/m3 */
    int               echoes;                       /* of entities, before any goes by way of the ground */
    int               crowns, clouds;               /* plants, and clouds of chaff, within beam and window */
    double            spent_s, step_s[RADAR_STEPS]; /* wall clock */
} RadarFrame;

#endif
