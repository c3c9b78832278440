/* sensor/truth/frame_error.h: the error budget of a frame and of a radar's map, and errors of single pixels, in
 * kelvin of apparent temperature: how they are spread over an image or a target. A root mean square is that of the
 * few hottest pixels, such as an exhaust that may be a pixel off; the median and the share beyond a kelvin say what
 * most pixels are like. */
#ifndef SENSOR_TRUTH_FRAME_ERROR_H
#define SENSOR_TRUTH_FRAME_ERROR_H

#include "sensor/truth/truth.h"
#include "sensor/radar/radar_frame.h"

/* ---- pixels -------------------------------------------------------------------------------------- */

/* Pixels by their expected error: 64 bins a decade from 1e-4 K on; smaller and larger ones in the first and last. */
enum { error_bins_a_decade = 64, error_bins = 8 * error_bins_a_decade };
typedef struct ErrorSpread {
    double px[error_bins];
    double all_px, beyond_px; /* expected to be off by more than 1 K */
    double squares_px_k2;
} ErrorSpread;

/* So many pixels whose expected error squared is this. */
void error_spread_add(ErrorSpread *spread, double square_k2, double px);
void error_spread_join(ErrorSpread *spread, const ErrorSpread *more);
/* Within 4 %; NaN: no pixels. */
double error_spread_median_k(const ErrorSpread *spread);
double error_spread_rms_k(const ErrorSpread *spread);
/* Share of the pixels that are off by more than 1 K, each by chance: normally distributed with its expected error. 0 ..
 * 1; NaN: no pixels. */
double error_spread_beyond(const ErrorSpread *spread);

/* A target that may be off by way_px in an unknown direction. It is described by at most some 1024 of its pixels,
 * evenly spread, and by the pixels at that distance from them. */
typedef struct DisplacedTarget {
    const Picture      *picture;
    const TargetPixels *px;
    int                 index; /* of the snapshot */
    const float        *value; /* thermal plane */
    const PlanckTable  *planck;
    double              way_px;
    double              further_k2; /* squared errors from other sources */
    double              air_k;      /* air temperature, for the errors of its heat; NaN: they are left out */
} DisplacedTarget;

/* Adds the pixels whose value would change, or that are the target's, to touched; of these the target's own to own. */
void error_spread_of_displaced(ErrorSpread *touched, ErrorSpread *own, const DisplacedTarget *target);

/* Share of a pixel that the target covers. id: its index + 1. */
static inline double pixel_share_of(const Picture *p, const TargetPixels *px, uint32_t id, size_t at)
{
    if (px->small && p->covered && p->covered[at] > 0) return (double)p->covered[at];
    return p->entity[at] == id;
}

/* ---- a frame ------------------------------------------------------------------------------------- */

/* A frame's error budget: the renderer's own estimates, and the contributions that only
 * the node knows: the age of its entities' reports and the chord error of their models.
 *
 * Dead reckoning. An entity rendered a few pixels off has the error by which the pixels change over that
 * displacement: over small displacements the squared differences of neighbouring pixels on and around it, over large
 * ones its difference from its surroundings. The displacement is that of its last correction (snapshot_drift); the
 * direction is unknown, and half of the squares counts. Its shadow is not included. For a single frame the estimate
 * is right within a factor of 2 in three of four cases, limited by the unknown path of a single vehicle; over many
 * frames in nine of ten (tests/sensor/test_frame_error.c). Facets of models lie within models.sag_m of the surface,
 * two thirds of it in the mean, and shift outlines likewise; and a ground-clamped entity rises and tilts with the
 * error of the ground (render/frame/render.h).
 *
 * Heat. Temperatures of the ground are off by what its elements, its steps of time and its facets leave out: 0.03 K and
 * 0.5 % of how far a place is from the air (tests/sensor/test_error_budget.c: within a factor of 2); those of parts by
 * their steps and their past (vehicle_heat_error_k). What materials, weather and tables leave out, 0.6 to 1.6 K on
 * measured days, is not included. */

typedef enum ErrorSource {
    ERROR_SAMPLING,
    ERROR_LEVEL_OF_DETAIL,
    ERROR_TABLES,
    ERROR_HEAT,
    ERROR_DEAD_RECKONING,
    ERROR_TOTAL,
    error_sources
} ErrorSource;

/* rms over the image, as a share of the band's mean; of the optical band the root of its channels' mean square.
 * kelvin: of apparent temperature, by its slope at the mean. Both are those of the brightest pixels, if these may be
 * off: a hot exhaust that is displaced by a pixel outweighs all others. Of the pseudo-radar, whose power is that of a
 * few mirrors, the share says nothing, and truth.jsonl does not have it. median_k, beyond_1k: of the pixels' expected
 * errors, in apparent temperature without linearizing what a displacement changes: half of the pixels are better; share
 * of those that are off by more than 1 K. Against finely sampled frames the median is right to 20 %, the share to a
 * factor of 2 in LWIR and of 4 in MWIR (tests/sensor/test_frame_error_spread.c). NaN: no such band, or none. */
typedef struct FrameError {
    double share[BAND_COUNT][error_sources], kelvin[BAND_COUNT][error_sources];
    double median_k[BAND_COUNT], beyond_1k[BAND_COUNT];
    /* PlantPrice of the picture: of its planes as shares of the band's mean; of the optical band the mean of its
     * channels. plants.rays 0: every plant is in full detail, and these are NaN */
    PlantPrice plants;
    double     plants_bias[BAND_COUNT], plants_bias_se[BAND_COUNT], plants_rms[BAND_COUNT];
} FrameError;

/* The frame that is judged. */
typedef struct FrameErrorOf {
    const Picture       *picture;
    const World         *world;
    const Snapshot      *snapshot;
    const RenderRequest *request;
    double               sag_m;   /* models.sag_m */
    bool                 clamped; /* entities stand on the ground */
    double               air_k;   /* of the weather; NaN: heat is left out */
} FrameErrorOf;

/* Computes the errors of a frame. target: receives error_px, the rms displacement of each on the image by dead
 * reckoning, facets and the ground's error (all of it, as if it lay across the line of sight), and the errors of its
 * bands. False: the picture has no budget or no truth planes. */
bool frame_error(FrameError *out, const FrameErrorOf *of, Target *target, int targets);

/* ---- a radar's map ------------------------------------------------------------------------------- */

/* A radar's error budget, in the manner of a band's: of its map of range and Doppler, by source.
 *
 * Sampling is by the grid of ray tubes on entities, level of detail by scattering centres in place of what the tubes
 * hit; tables are the gridding of echoes over delay and Doppler. Dead reckoning displaces echoes in range: of complex
 * cells that leaves no phase, so it counts how far the map's magnitudes change, those of a point that moves by one of
 * three components of the last correction (snapshot_drift).
 *
 * An entity's power in the map is that of its one look, by its signal to noise: right in the mean over looks, as its
 * centres add up or cancel. The echoes of ground, rain and plants are functions of their cells: without error but that
 * of gridding. What physical optics, models, materials and given signatures are wrong by is not included; noise and
 * clutter are the radar's own. */

/* share: rms error over the cells of the sum channel, over the rms of these. db: standard deviation that it gives the
 * cross section of an entity, and so of a detection, over entities by their power: 10 log10(1 + sqrt(2) error / field).
 * NaN: heat; db of dead reckoning, and of all while no entity is in sight. */
typedef struct RadarError {
    double share[error_sources], db[error_sources];
} RadarError;

void radar_error(RadarError *out, const RadarFrame *radar, const Snapshot *snapshot);

/* Error that gridding leaves in an echo, over its amplitude; rms over the interval (tests/sensor/test_radar_error.c).
 */
double radar_error_of_gridding(void);

#endif
