/* render/scattering/clutter/foliage_fan.h: the foliage on rays that leave one place in a cone.
 *
 * The cone is cut into small ranges of direction, each with a list of the crowns that its rays may meet, so that a ray
 * need not walk over the squares of foliage.h: 0.1 to 0.4 us in woods. The result has the bits of foliage_loss_db:
 * crowns are asked in the same order, each in the same squares, and only those are left out that a ray misses. */
#ifndef RENDER_SCATTERING_CLUTTER_FOLIAGE_FAN_H
#define RENDER_SCATTERING_CLUTTER_FOLIAGE_FAN_H

#include "render/scattering/clutter/foliage.h"

typedef struct FoliageFan FoliageFan;

typedef struct FoliageFanOf {
    double o_enu[3];    /* where the rays start */
    double axis[3][3];  /* right, down, ahead: unit, at right angles */
    double half, far_m; /* tangent of half the cone's angle, to the right and down; its length. Rays that leave it are
                         * asked as foliage_loss_db does */
} FoliageFanOf;

/* In the arena. *out NULL: no fan, of a cone that holds too much of the foliage, or for want of memory. */
void foliage_fan_create(FoliageFan **out, const Foliage *foliage, const FoliageFanOf *of, Arena *arena);
/* Whether it is of rays from here. NULL: not. */
bool foliage_fan_is_from(const FoliageFan *fan, const double o_enu[3]);
/* As foliage_loss_db from its start. Thread-safe, no allocation. */
double foliage_fan_loss_db(const FoliageFan *fan, const double d_enu[3], double range_m);

#endif
