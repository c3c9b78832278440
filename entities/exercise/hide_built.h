/* entities/exercise/hide_built.h: what is built about a place where something is to hide, as triangles that stop rays.
 */
#ifndef ENTITIES_EXERCISE_HIDE_BUILT_H
#define ENTITIES_EXERCISE_HIDE_BUILT_H

#include "terrain/culture/culture.h"
#include "terrain/ground/landscape.h"

typedef struct HideSolids {
    int count;
    double (*corner)[3][3]; /* [count] ENU */
    double (*about)[3];     /* [count] middle in plan, and the radius about it, m */
} HideSolids;

/* Of the records of a culture within half_m of a place along each axis, as the node makes them (scenery_buildings.h).
 */
Status hide_solids_open(HideSolids *out, const Culture *culture, const Landscape *landscape, const double about_m[2],
                        double half_m);
void   hide_solids_close(HideSolids *solids); /* accepts zeroes */

/* The triangles that may stand between what is within radius_m of a place and an observer along d (unit, ENU). Returns
 * how many there are, of which the first hide_solids_most are in the list. */
enum { hide_solids_most = 16384 };
int hide_solids_along(int list[hide_solids_most], const HideSolids *solids, const double p_enu[3], double radius_m,
                      const double d_enu[3], double range_m);
/* Whether one of the list is met by a ray. */
bool hide_solids_meet(const HideSolids *solids, const int *list, int count, const double p_enu[3],
                      const double d_enu[3]);
/* Whether a ray from o meets a triangle. */
bool hide_triangle_meets(const double corner[3][3], const double o[3], const double d[3]);

#endif
