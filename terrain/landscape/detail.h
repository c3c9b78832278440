/* terrain/landscape/detail.h: the ground's own detail, finer than its posts and classes: noise with the statistics of
 * the class (terrain/landscape/detail.c), and what lies along roads, tracks and furrows (terrain/landscape/ways.h).
 *
 * Anchored to ENU places, continuous over posts and cells, filtered to the footprint: neither aliasing nor shimmer.
 * Detail moves no surface: heights below 5 cm bend normals only, and contact and rays use the stored posts. */
#ifndef TERRAIN_LANDSCAPE_DETAIL_H
#define TERRAIN_LANDSCAPE_DETAIL_H

#include "terrain/landscape/detail_table.h"
#include "terrain/landscape/ground_detail.h"
#include "terrain/landscape/landscape.h"

/* Detail at places of known classes; elsewhere, and with table NULL, factors 1 and the rest 0. Thread-safe. A place's
 * result is independent of the others. */
void landscape_details(const GroundDetail *out, const DetailTable *table, const Landscape *landscape, int count,
                       const uint8_t *surface, const double *x_m, const double *y_m, const GroundFootprint *footprint);

#endif
