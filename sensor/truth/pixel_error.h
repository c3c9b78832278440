/* sensor/truth/pixel_error.h: errors of single pixels, in kelvin of apparent temperature: how they are spread over an
 * image or a target. A root mean square is that of the few hottest pixels, such as an exhaust that may be a pixel off;
 * the median and the share beyond a kelvin say what most pixels are like. */
#ifndef SENSOR_TRUTH_PIXEL_ERROR_H
#define SENSOR_TRUTH_PIXEL_ERROR_H

#include "sensor/truth/truth.h"

/* Pixels by their expected error: 64 bins a decade from 1e-4 K on; smaller and larger ones in the first and last. */
enum { error_bins_a_decade = 64, error_bins = 8 * error_bins_a_decade };
typedef struct ErrorSpread {
    double px[error_bins];
    double all_px, beyond_px; /* expected to be off by more than 1 K */
    double squares_px_k2;
} ErrorSpread;

/* So many pixels whose expected error squared is this. */
void   error_spread_add(ErrorSpread *spread, double square_k2, double px);
void   error_spread_join(ErrorSpread *spread, const ErrorSpread *more);
/* Within 4 %; NaN: no pixels. */
double error_spread_median_k(const ErrorSpread *spread);
double error_spread_rms_k(const ErrorSpread *spread);
/* Share of the pixels that are off by more than 1 K, each by chance: normally distributed with its expected error. 0 .. 1;
 * NaN: no pixels. */
double error_spread_beyond(const ErrorSpread *spread);

/* A target that may be way_px off, in an unknown direction: by its pixels and the pixels as far from them as that, of at
 * most some 1024 pixels evenly spread. */
typedef struct DisplacedTarget {
    const Picture      *picture;
    const TargetPixels *px;
    int                 index;      /* of the snapshot */
    const float        *value;      /* thermal plane */
    const PlanckTable  *planck;
    double              way_px;
    double              further_k2; /* squared errors from other sources */
    double              air_k;      /* for those of its heat; NaN: left out */
} DisplacedTarget;

/* Adds the pixels whose value would change, or that are the target's, to touched; of these the target's own to own. */
void   error_of_displaced(ErrorSpread *touched, ErrorSpread *own, const DisplacedTarget *target);

/* Share of a pixel that the target covers; id: index + 1. */
static inline double pixel_share_of(const Picture *p, const TargetPixels *px, uint32_t id, size_t at)
{
    if (px->small && p->covered && p->covered[at] > 0) return (double)p->covered[at];
    return p->entity[at] == id;
}

#endif
