/* terrain/landscape/detail.h: the ground's own detail, finer than its posts and classes: noise with the statistics of
 * the class (terrain/landscape/detail.c), and what lies along roads, tracks and furrows (terrain/landscape/ways.h).
 *
 * Anchored to ENU places, continuous over posts and cells, filtered to the footprint: neither aliasing nor shimmer.
 * Detail moves no surface: heights below 5 cm bend normals only, and contact and rays use the stored posts. */
#ifndef TERRAIN_LANDSCAPE_DETAIL_H
#define TERRAIN_LANDSCAPE_DETAIL_H

#include "terrain/landscape/landscape.h"

/* Of count places, one array each, [count], the caller's. NULL: not wanted, and not computed. */
typedef struct GroundDetail {
    float *albedo;           /* factor of the reflectance, mean 1, > 0 */
    float *warmth_k;         /* added to the class's temperature at night,
        mean 0 (more by day: render/light/thermal.c) */
    float *radar;            /* factor of the backscatter, mean 1, > 0 */
    float *slope_x, *slope_y;/* rise of the detail's height eastwards and northwards, metres a metre; both or neither */
} GroundDetail;

/* What a sample covers of the ground, m: across the view and along it (at grazing view longer), [count] each. */
typedef struct GroundFootprint {
    const float *across_m, *along_m;
} GroundFootprint;

/* Statistics of every class (etc/ground_detail.csv), and the weights of the octaves at every footprint. */
typedef struct DetailTable DetailTable;

/* Logs what is wrong with the file. cut_off: octaves below this share of a field's variance are left out, their
 * variance given to the others. */
static const double detail_cut_off = 0.005; /* `bench precision`: detail: weakest octave */
Status detail_table_open(DetailTable **out, const char *path, double cut_off);
void   detail_table_close(DetailTable *table); /* accepts NULL */

/* Detail at places of known classes; elsewhere, and with table NULL, factors 1 and the rest 0. Thread-safe. A place's
 * result is independent of the others. */
void landscape_details(const GroundDetail *out, const DetailTable *table, const Landscape *landscape, int count,
                       const uint8_t *surface, const double *x_m, const double *y_m, const GroundFootprint *footprint);

#endif
