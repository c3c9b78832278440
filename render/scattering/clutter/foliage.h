/* render/scattering/clutter/foliage.h: standing plants as volumes of foliage: what a ray loses in them, and what
 * they send back.
 *
 * A plant's crown is a spheroid: from where its prototype's leaves begin to its top, as wide as the circle that
 * holds nine tenths of its leaves. Losses along rays go by the length inside crowns (where crowns overlap, twice),
 * by the row of the clutter table of the plant's kind: conifers, broadleaf trees, scrub for bushes and hedges.
 * Trunks take nothing, bare trees as much as trees in leaf, and crowns stand still. */
#ifndef RENDER_SCATTERING_CLUTTER_FOLIAGE_H
#define RENDER_SCATTERING_CLUTTER_FOLIAGE_H

#include "render/trace/plants/plants.h"
#include "render/scattering/clutter/clutter_table_private.h"
#include "terrain/woods/woods.h"

typedef struct Foliage Foliage;

typedef struct FoliageCrown {
    float   centre_m[3];    /* from the origin of the woods */
    float   across_m, up_m; /* half axes */
    uint8_t surface;        /* SurfaceClass of its row */
} FoliageCrown;

/* Makes the foliage of all standing plants of woods, which need not outlive it. Each plant is listed in every square of
 * 16 m that it reaches into (the squares are larger where there would be more than four million). It takes 24 octets a
 * plant and some 10 more. */
Status       foliage_create(Foliage **out, const Woods *woods, const Plants *plants, const ClutterTable *table,
                            ClutterBand band);
void         foliage_destroy(Foliage *foliage);     /* accepts NULL */
const Woods *foliage_woods(const Foliage *foliage); /* by which it was made: to compare only */

/* Crowns, in the order of Woods.plant; and the origin that they count from, ENU. */
int                 foliage_count(const Foliage *foliage);
const FoliageCrown *foliage_crown(const Foliage *foliage, int index);
const double       *foliage_origin(const Foliage *foliage);
/* Indices of the crowns whose middle is in low <= x, y < high (m, ENU), by squares from the south-west: returns how
 * many there are; writes the first `most`. */
int foliage_in(int *index, int most, const Foliage *foliage, const double low_m[2], const double high_m[2]);

/* Loss along a ray to range_m from o_enu in direction d_enu (unit), dB, one way: of the length in crowns, linear for 14
 * m and then less (clutter_foliage_db), each class with its share. depth_m (may be NULL): that length. Thread-safe, no
 * allocation: 0.1 us where the ray stays above the plants, some us in woods. Lengths against a march in steps of 2 cm:
 * tests/render/test_foliage.c. */
double foliage_loss_db(double *depth_m, const Foliage *foliage, const double o_enu[3], const double d_enu[3],
                       double range_m);

/* Whether a place is where plants stand or could: within the squares whose plants stand. */
bool foliage_reaches(const Foliage *foliage, double x_m, double y_m);

#endif
