/* tests/scenes/plants_reference.h: hits of rays on plants judged by every quad, in long double, without boxes of
 * branches or Embree. */
#ifndef TESTS_SCENES_PLANTS_REFERENCE_H
#define TESTS_SCENES_PLANTS_REFERENCE_H

#include "render/trace/plants/forest.h"

/* The worst so far, m. INFINITY: an answer that no tolerance explains. */
typedef struct PlantErrors {
    double past_m; /* how far from an outline, across the ray, a ray passes within a nearer quad that it did not meet,
                    * or outside of the quad that it met */
    double  off_m; /* distance of a hit from the plane of its quad */
    int64_t rays, hits;
} PlantErrors;

/* Corners and outlines of the prototypes that a ray can pass at all, by a sphere about each quad. */
typedef struct PlantSpheres {
    float *sphere[PLANT_KINDS]; /* [quads][4]: centre and radius, of level 0, in the prototype's axes; standing kinds */
} PlantSpheres;
Status plant_spheres_create(PlantSpheres *out, const Plants *plants);
void   plant_spheres_destroy(PlantSpheres *spheres);

/* What forest_first_hits found for one ray, with all plants at full detail and still; hit where range_m < INFINITY. */
void plants_judge(PlantErrors *worst, const Woods *woods, const Plants *plants, const PlantSpheres *spheres,
                  const double o_enu[3], const double d_enu[3], double range_m, const ForestHit *hit);

#endif
