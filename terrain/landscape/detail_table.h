/* terrain/landscape/detail_table.h: statistics of the ground's noise, and from them the weights of its octaves.
 *
 * A field of a class is g + k (g^2 - var g), where g sums the octaves, each of variance 1 and weighted for its class:
 * the second Hermite polynomial gives the skew, and its mean under any filter is that of the octaves that remain. */
#ifndef TERRAIN_LANDSCAPE_DETAIL_TABLE_H
#define TERRAIN_LANDSCAPE_DETAIL_TABLE_H

#include "terrain/surface.h"

typedef enum DetailField { DETAIL_ALBEDO, DETAIL_WARMTH, DETAIL_RADAR, DETAIL_HEIGHT, detail_fields } DetailField;

enum {
    detail_octaves = 8,
    /* Nodes of the footprint: four for each doubling from 1/64 m to 128 m; the first also means 0, and at the last
     * nothing remains. Nodes of its elongation: two for each doubling from 1 to 32. Between nodes: linear. */
    detail_least_log2 = -6, detail_doublings = 13, detail_sizes = 4 * detail_doublings + 1,
    detail_long_doublings = 5, detail_longs = 2 * detail_long_doublings + 1,
};

/* Cells of the lattices, m: exponential covariances from 0.3 m to 10 m are sums of these within 0.02. */
static const double detail_octave_m[detail_octaves] = {0.08, 0.2, 0.5, 1.25, 3.125, 7.8125, 19.53125, 48.828125};

/* Width of an octave's covariance, as a Gaussian's deviation, in cells. */
static const double detail_octave_width = 0.57;

/* Of a class and a footprint: standard deviation of each octave in each field, in the field's unit. */
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
    float            bend[SURFACE_COUNT][detail_fields];    /* k above, 1 / unit of the field */
    float            follows[SURFACE_COUNT][detail_fields]; /* share of the first noise; the rest is of the second */
    float            apart[SURFACE_COUNT][detail_fields];   /* share of the second */
    uint8_t          used[SURFACE_COUNT][detail_sizes][detail_longs][detail_fields]; /* octaves with a weight */
    DetailWeights    weights[SURFACE_COUNT][detail_sizes][detail_longs];
} DetailTable;

/* From statistics alone. */
Status detail_table_create(DetailTable **out, const DetailStatistics statistics[SURFACE_COUNT][detail_fields],
                           double cut_off);

/* Logs what is wrong with the file. cut_off: octaves below this share of a field's variance are left out, their
 * variance given to the others. */
static const double detail_cut_off = 0; /* none is left out: `bench precision`: detail: weakest octave */
Status detail_table_open(DetailTable **out, const char *path, double cut_off);
void   detail_table_close(DetailTable *table); /* accepts NULL */

#endif
