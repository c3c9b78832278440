/* sensor/truth/truth.h: ground truth per target and frame, to train and evaluate an automatic target recogniser.
 *
 * A value that was not computed is NaN here and absent in the files. */
#ifndef SENSOR_TRUTH_TRUTH_H
#define SENSOR_TRUTH_TRUTH_H

#include "render/frame/render.h"
#include "render/frame/world.h"
#include "sensor/acquisition/acquisition.h"
#include "sensor/acquisition/criteria.h"

/* The target's pixels are those with its id in the truth planes. A small one (TargetPixels.small) has its own
 * samples instead, and a ring of pixels without any small target. */
typedef struct TargetBand {
    double contrast_k;           /* mean of the target's pixels less mean of a ring of its own area, apparent K */
    double dt_rss_k;             /* root of the squared mean difference plus the target's variance */
    double contrast;             /* optical, radar: the same difference over the ring's mean, dimensionless */
    double snr;                  /* contrast over the ring's sigma and the detector's noise together; of a small target:
                                  * times the share it has of the pixel it fills most. Optical, without a ring: its own
                                  * mean over the noise. 0: no contrast; NaN: no ring, or neither clutter nor noise */
    double intensity_w_sr;       /* in-band, at the aperture: its own radiance times the area it fills, at its range */
    double intensity_error_w_sr; /* rms sampling error; of a small target, in a frame with a budget */
    double
        veil_transmittance; /* transmittance of smoke and dust in front of it, mean over its visible pixels; 1: none */
    double cycles, ttp_v;   /* that an observer resolves on its visible part; its TTP value; without a sensor NaN */
    double p[acquisition_tasks];        /* of that observer's tasks, by ttp_v */
    double error_rms_k, error_median_k; /* thermal: of its pixels, by its position, heat and tables (frame_error.h) */
} TargetBand;

typedef struct Target {
    int         index; /* of the snapshot */
    double      range_m, closing_mps, aspect_rad, depression_rad;
    double      los_az_rad, los_el_rad; /* from the host, in its own ENU */
    double      los_rate_rps[2];        /* inertial; camera right and up */
    double      boresight_error_rad[2]; /* camera right and up */
    double      pixels;                 /* area, parts of pixels too */
    double      visible_fraction;       /* of its area on the image; 1: an occluder is not named; NaN: no sample */
    int         box[4];                 /* visible pixels; empty: all 0 */
    double      amodal_box[4];          /* of its vertices, not clipped to the image */
    double      foliage_fraction;       /* of its area on the image, hidden by plants; NaN: there are none */
    const char *occluder;               /* "ground", "trees", "scenery", "entity" with occluder_index >= 0, or NULL */
    int         occluder_index;
    double      error_px; /* rms displacement on the image (frame_error.h) */
    TargetBand  band[BAND_COUNT];
} Target;

/* Hidden share of a target below which it is not occluded: the resolution of a fraction with two decimals, and the
 * share that tracks of vehicles are below uneven ground (up to 0.9 % in etc/scenarios/demo.yaml). */
static const double truth_occluded_least = 0.01;

/* Detector noise, for snr: sigma in W/(m2 sr) per optical channel, in K for the thermal bands. */
typedef struct TruthNoise {
    double optical_w_m2_sr, netd_mwir_k, netd_lwir_k;
    /* what an observer of a band's sensor resolves, at the noise of the frame's mean radiance; NULL: there is none */
    const Acquisition *observed[BAND_COUNT];
    MrtdNoise          bars[BAND_COUNT];
} TruthNoise;

/* The sensor's position and motion, for line of sight and its rate. */
typedef struct EyeState {
    double p_ecef[3], v_ecef_mps[3];
    double r_ecef_from_cam[9];
    int    host_index; /* never a target; -1 */
} EyeState;

/* Targets in the field of view, by snapshot index. out: capacity snapshot->count. Returns the count.
 * The picture must hold truth planes. */
int truth_targets(Target *out, const Picture *picture, const World *world, const Snapshot *snapshot,
                  const RenderRequest *request, const EyeState *eye, const TruthNoise *noise);

/* ---- the footprint of the image on the ground: the terrain alone, without entities --------------- */

/* Where a line of sight meets the ground. */
typedef struct GroundPoint {
    bool   known;                      /* false: it does not, within the terrain */
    double lat_rad, lon_rad, height_m; /* WGS 84, above the ellipsoid */
    double range_m;                    /* from the sensor */
} GroundPoint;
/* The boresight, then the image's corners. */
typedef enum FootprintPoint {
    FOOTPRINT_CENTRE,
    FOOTPRINT_UPPER_LEFT,
    FOOTPRINT_UPPER_RIGHT,
    FOOTPRINT_LOWER_RIGHT,
    FOOTPRINT_LOWER_LEFT,
    FOOTPRINT_COUNT
} FootprintPoint;

/* Five rays in double over the terrain's posts, in some microseconds. Corners are the outer corners of the corner
 * pixels, where the lens shows them; lines of sight bend as in the images. A sensor below the ground: none known. */
void truth_footprint(GroundPoint out[FOOTPRINT_COUNT], const World *world, const RenderRequest *request);

/* Map area, m2, of the ground that the image shows within truth_ground_far_m of the sensor: what a recogniser has
 * searched. By 8192 rays over the terrain's posts; plants on it count as ground. Over a plain within 0.5 % where no
 * horizon is in the image, within 3 % where that range is. 0: none is seen, or there is no terrain. */
static const double truth_ground_far_m = 10e3;
double              truth_ground_area(const World *world, const RenderRequest *request);

#endif
