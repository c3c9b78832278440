/* sensor/radar/detect_private.h: detections: what passes a threshold of constant false alarms, where it is, and whether
 * it moves. */
#ifndef SENSOR_RADAR_DETECT_PRIVATE_H
#define SENSOR_RADAR_DETECT_PRIVATE_H

#include "sensor/radar/antenna_private.h"
#include "sensor/radar/interval_private.h"

/* ---- thresholds --------------------------------------------------------------------------------- */

/* Detection at a constant rate of false alarms in power that noise or clutter fills.
 *
 * A cell is compared with the mean of training cells about it (cell averaging), or with the k-th smallest of them
 * (ordered statistic, which a second target among them disturbs less). In exponentially distributed power of one
 * mean the rate of false alarms is exact:
 *
 *     cell averaging   pfa = (1 + a / N)^-N                          threshold = a mean
 *     ordered          pfa = prod_{i < k} (N - i) / (N - i + a)      threshold = a (k-th smallest)
 *
 * Sources: Finn & Johnson, RCA Review 29, 1968; Rohling, IEEE Trans. AES-19(4), 1983. */

/* Multiplier for training cells, 1 .. 100000, and a pfa between 0 and 1; else NaN. Relative error 1e-12. */
double detect_cfar_multiplier(int training, double pfa);
/* rank 1 .. training. Relative error 1e-12. */
double detect_ordered_multiplier(int training, int rank, double pfa);

typedef struct CfarConfig {
    double pfa; /* in a cell, above 0, below 1 */
    int    guard[2],
        training[2];  /* cells on each side in rows and columns: guard are left out, training beyond them counted */
    double ordered;   /* 0: cell averaging; else the rank's share of the training cells, 0 .. 1 */
    bool   wrap_rows; /* rows go round: Doppler */
} CfarConfig;

typedef struct CfarHit {
    int    row, column;
    double power, floor; /* of the cell; mean power of noise there by the training cells */
} CfarHit;

/* power[rows][columns], not below 0. The cells over their threshold that are greatest among their eight neighbours
 * (equal ones: the first), in order of row and column: at most `most`; returns how many there are, or -1: no memory
 * or a bad configuration. Cells with fewer than 4 training cells within the plane are never hits. */
int detect_cfar(CfarHit *out, int most, const CfarConfig *config, const double *power, int rows, int columns);

/* ---- detections --------------------------------------------------------------------------------- */

/* What of a detection is scenery's. */
typedef struct DetectedScenery {
    double   share;  /* of its power that scenery makes by itself */
    int      source; /* of RadarFrame.source, from 1: the brightest of that; 0: it is not of scenery */
    uint64_t id;     /* of that: of the building's record, or the thing's */
    uint8_t class;   /* SceneryClass; 0: built */
} DetectedScenery;

/* The detections of a map of range and Doppler: where, how fast, in which direction, how strong.
 *
 * Peaks of the sum channel over a threshold of constant false alarms. Range, Doppler and power between
 * cells by comparing the peak's two neighbours with the response to a point; directions by the ratios of the
 * difference channels to the sum in the peak's cell; cross-section by the radar equation, at the direction found. */
typedef struct Detection {
    int             row, column;
    double          range_m;             /* of the reference, plus */
    double          range_rate_mps;      /* likewise; folds over at half the interval of the map */
    double          cos_right, cos_down; /* direction, along the antenna's axes */
    double          snr;                 /* power over the noise about it, less 1 */
    double          rcs_m2;              /* if one echo from where it was found */
    DetectedScenery scenery;             /* of the caller */
    bool            moving; /* clear of the ground's range rate in its direction (detect_moves); of the caller */
} Detection;

/* What a map's reference stands for. */
typedef struct DetectScale {
    double range_m, range_rate_mps; /* of the reference */
    double unit_w;                  /* received from 1 m2 at 1 m with antenna gains of 1, before the air */
    double air_np_m;                /* power attenuation of the air, one way, 1/m */
} DetectScale;

/* plan: that made the map. As detect_cfar: strongest first, ties by row and column; at most `most`, returns how many
 * there are; -1: no memory or a bad configuration. */
int detect(Detection *out, int most, const RangeDoppler *map, const IntervalPlan *plan, const CfarConfig *config,
           const Antenna *antenna, const DetectScale *scale);

/* ---- moving targets ----------------------------------------------------------------------------- */

/* Moving-target indication: a delay-line canceller over the rows of an interval, and whether a detection moves
 * against the ground.
 *
 * The canceller of 2 or 3 rows takes the differences of range-compressed rows, with the binomial weights 1, -1 or
 * 1, -2, 1, after the ground's own phase from row to row is taken out (clutter lock: the radar knows its own
 * velocity). Of clutter with autocorrelation rho over a row it improves the ratio of signal to clutter, the signal
 * averaged over all Doppler frequencies, by 1 / (1 - rho(1)) and 3 / (3 - 4 rho(1) + rho(2)) (Skolnik, Radar
 * Handbook, 3rd ed., ch. 2; Barton, Modern Radar System Analysis, 1988, ch. 5). Targets at multiples of the blind
 * speed go with it. */
enum { mti_rows_most = 3 };

/* Mean power over rows behind the canceller of `rows` 2 or 3: out[samples] from `pulse` of interval_pulses. So
 * scaled that white noise keeps its power. clutter_path_m: growth of the ground's two-way path from row to row,
 * against the reference's. */
void detect_mti_profile(double *out, const double *pulse, const Waveform *wave, int rows, double clutter_path_m);
/* Power gain of the canceller for a target whose path grows by path_m more than the clutter's, white noise's being 1.
 */
double detect_mti_gain(const Waveform *wave, int rows, double path_m);
/* A range rate is clear of the ground's: farther than notch_mps from it and all that look alike, every blind_mps. */
bool detect_moves(double rate_mps, double ground_mps, double notch_mps, double blind_mps);

#endif
