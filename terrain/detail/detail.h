/* terrain/detail/detail.h: the ground's own detail, finer than its posts and classes: noise with the statistics of
 * the class (terrain/detail/detail.c), and what lies along roads, tracks and furrows (detail_ways.c).
 *
 * Anchored to ENU places, continuous over posts and cells, filtered to the footprint: neither aliasing nor shimmer.
 * Detail moves no surface: heights below 5 cm bend normals only, and contact and rays use the stored posts. */
#ifndef TERRAIN_DETAIL_DETAIL_H
#define TERRAIN_DETAIL_DETAIL_H

#include "terrain/ground/landscape.h"

/* ---- statistics ---------------------------------------------------------------------------------- */

/* A field of a class is g + k (g^2 - var g), where g sums the octaves, each of variance 1 and weighted for its class:
 * the second Hermite polynomial gives the skew, and its mean under any filter is that of the octaves that remain. */
typedef enum DetailField { DETAIL_ALBEDO, DETAIL_WARMTH, DETAIL_RADAR, DETAIL_HEIGHT, detail_fields } DetailField;

enum {
    detail_octaves = 8,
    /* Nodes of the footprint: four for each doubling from 1/64 m to 128 m; the first also means 0, and at the last
     * nothing remains. Nodes of its elongation: two for each doubling from 1 to 32. Between nodes: linear. */
    detail_least_log2 = -6,
    detail_doublings = 13,
    detail_sizes = 4 * detail_doublings + 1,
    detail_long_doublings = 5,
    detail_longs = 2 * detail_long_doublings + 1,
};

/* Cells of the lattices, m: exponential covariances from 0.3 m to 10 m are sums of these within 0.02. */
static const double detail_octave_m[detail_octaves] = {0.08, 0.2, 0.5, 1.25, 3.125, 7.8125, 19.53125, 48.828125};

/* Width of an octave's covariance, as a Gaussian's deviation, in cells. */
static const double detail_octave_width = 0.57;

/* For a class and a footprint: the standard deviation of each octave in each field, in the field's unit. */
typedef struct DetailWeights {
    float of[detail_fields][detail_octaves];
} DetailWeights;

/* Statistics of a field over a class. covariance = sigma^2 ((1 - far) exp(-d / length) + far exp(-d / far_length)) */
typedef struct DetailStatistics {
    double sigma, length_m, far_share, far_length_m, skew, follows; /* follows: correlation with the albedo */
} DetailStatistics;

/* Statistics of every class (etc/ground_detail.csv), and the weights of the octaves at every footprint. */
typedef struct DetailTable {
    DetailStatistics statistics[SURFACE_COUNT][detail_fields];
    float            bend[SURFACE_COUNT][detail_fields]; /* the k of DetailField, in 1 / unit of the field */
    float   follows[SURFACE_COUNT][detail_fields];       /* share of the first noise value; the rest is the second's */
    float   apart[SURFACE_COUNT][detail_fields];         /* share of the second noise value */
    uint8_t used[SURFACE_COUNT][detail_sizes][detail_longs][detail_fields]; /* octaves with a weight other than 0 */
    DetailWeights weights[SURFACE_COUNT][detail_sizes][detail_longs];
} DetailTable;

/* Makes a table from statistics alone. */
Status detail_table_create(DetailTable **out, const DetailStatistics statistics[SURFACE_COUNT][detail_fields],
                           double cut_off);
/* Logs what is wrong with the file. cut_off: octaves below this share of a field's variance are left out, their
 * variance given to the others. */
static const double detail_cut_off = 0; /* none is left out: `bench precision`: detail: weakest octave */
Status              detail_table_open(DetailTable **out, const char *path, double cut_off);
void                detail_table_close(DetailTable *table); /* accepts NULL */

/* ---- detail at places ---------------------------------------------------------------------------- */

/* Results at `count` places, in arrays [count] of the caller's. NULL: not wanted, and not computed. */
typedef struct GroundDetail {
    float *albedo;   /* factor of the reflectance, mean 1, > 0 */
    float *warmth_k; /* added to the class's temperature at night, mean 0 (by day more: render/light/thermal.c) */
    float *radar;    /* factor of the backscatter, mean 1, > 0 */
    float *slope_x,
        *slope_y; /* slope of the detail's height eastwards and northwards, metres a metre; both or neither */
} GroundDetail;

/* What a sample covers of the ground, m: across the view and along it (at grazing view longer), [count] each. */
typedef struct GroundFootprint {
    const float *across_m, *along_m;
} GroundFootprint;

/* Detail at places of known classes; elsewhere, and with table NULL, factors 1 and the rest 0. Thread-safe. A place's
 * result is independent of the others. */
void detail_at(const GroundDetail *out, const DetailTable *table, const Landscape *landscape, int count,
               const uint8_t *surface, const double *x_m, const double *y_m, const GroundFootprint *footprint);

/* Wheel paths and worn edges of roads, ruts and the grassy middle of tracks, rows of crops and furrows: multiplied into
 * the factors and added to the rest of what detail holds. Filtered to the footprint (its longer axis); nothing of it is
 * left where that is half as wide as a way, or as rows are apart. */
void detail_ways(const GroundDetail *detail, const Landscape *landscape, int count, const uint8_t *surface,
                 const double *x_m, const double *y_m, const float *footprint_m);

/* Moves a place in a field with rows (crops, furrows) onto the middle of its row; returns false when the class has no
 * rows. */
bool detail_row(double place_m[2], const Landscape *landscape, SurfaceClass surface, double x_m, double y_m);

#endif
