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
    float *warmth_k;         /* added to the class's temperature, mean 0 */
    float *radar;            /* factor of the backscatter, mean 1, > 0 */
    float *slope_x, *slope_y;/* rise of the detail's height eastwards and northwards, metres a metre */
} GroundDetail;

#endif
