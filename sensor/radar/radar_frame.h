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

/* What the ground near an entity adds by mirroring (render/radar/ground_bounce.h); hh, vv, hv, m^2, as if wholly visible. */
typedef struct RadarBounceTruth {
    double coherence; /* share of the amplitude that the ground mirrors, the larger polarisation; 0: left out */
    double once_m2[3], twice_m2[3];    /* by the ground one way (both ways round together), by the ground both ways */
    double rcs_m2[3];                  /* of all paths together, the direct one included */
} RadarBounceTruth;
/* One of an entity's scattering centres. */
typedef struct RadarScatterer {
    double hh_m2, vv_m2;               /* its cross section */
    double p_body[3];                  /* m: middle of its path's first and last mirror */
    int    bounce, part;               /* mirrors on its path, 0: an edge; of the model, -1: of a given signature */
    bool   seen;                       /* nothing else is in its way */
} RadarScatterer;

enum { radar_strongest = 8 };

/* Truth of one entity within beam and range window. */
typedef struct RadarTruth {
    int    entity;                     /* index in the snapshot */
    double range_m, range_rate_mps;    /* of the origin of its model */
    double appears_m; /* range at which its echo is on the profile: folded over, coupled to its range rate */
    double cos_right, cos_down;
    bool   given;                      /* by a signature of radar.given, else by its model */
    double visible;         /* share of its centres' power that relief, plants and other entities leave in sight */
    double rcs_m2[3];       /* hh, vv, hv, at the centre frequency, as if wholly visible and without ground */
    double rcs_error_db[3]; /* standard deviation, by the grid of tubes (render/radar/signature_error.h); NAN: given */
    double map_error;       /* error of the map's cells over its centres' power: tubes, and what centres leave out */
    double snr; /* by the radar equation, of the centres in sight, in one cell of the map; 0: there is none */
    int    centres;                    /* scattering centres that it was summed from */
    int    strongest_count;
    RadarScatterer strongest[radar_strongest]; /* of them, by the mean of hh and vv */
    RadarBounceTruth bounce;
} RadarTruth;

typedef struct RadarFrame {
    const RadarPreset *preset;
    double          reference_m, reference_rate_mps; /* the middle of the range window, and how it moves */
    WaveformTiming  timing;
    double          ground_rate_mps;   /* of still ground on the axis */
    double notch_mps; /* detections so near to the ground's range rate in their direction count as ground */
    double v_enu_mps[3], aim_m,
        aim_v_enu_mps[3];              /* as in its RadarScene: of the antenna; to the aim, NAN: none; of it */
    uint32_t        number;            /* likewise: for its noise */
    double          air_db;            /* one way, over the reference range */
    RangeDoppler    map;
    double complex *profile; /* [2][samples]: range profiles of the middle pulse, sqrt(W): the transmitted polarisation,
                              * the other */
    double         *profile_w;         /* [samples]: sum channel, mean power of all pulses */
    double         *mti_w;             /* [samples]: the same behind the canceller, its gain for noise being 1 */
    int             detections, detections_in_all; /* the strongest; how many passed the threshold */
    const Detection *detection;
    int             targets;
    const RadarTruth *target;
    ReceiverReport  receiver;
    const RadarScan *scan;             /* NULL: the beam stares */
    int             ground_cells, ground_hidden; /* scatterers of the ground; of them, hidden by relief or entities */
    double          rain_1_m;          /* backscatter of rain by its volume, m2/m3 */
    int             echoes;            /* of entities, before any goes by way of the ground */
    int             crowns, clouds;    /* plants, and clouds of chaff, within beam and window */
    double          spent_s;           /* wall clock */
} RadarFrame;

#endif
