/* render/trace/visibility/broad_phase.h: a bounding-volume tree over spheres: finds the items that may be met
 * by a ray, or lie in a volume. It is a conservative filter: what it leaves out cannot be met, and what it lists must
 * still be tested.
 *
 * Built O(n), for entities anew each frame: the spheres are sorted along a Morton curve, four to a leaf, and the leaves
 * are the last row of a complete binary tree, so that node n has the children 2 n and 2 n + 1. Immutable once built,
 * any number of threads may query it. Boxes have a margin for the rounding of every test here: what begins strictly
 * beyond a ray's limit is left out, what begins at it is not. */
#ifndef RENDER_TRACE_VISIBILITY_BROAD_PHASE_H
#define RENDER_TRACE_VISIBILITY_BROAD_PHASE_H

#include "pitviper.h"

enum { broad_packet = 16 }; /* rays that traverse the tree together */

typedef struct BroadPhase BroadPhase;

/* item[count]: identifiers of the spheres, ascending; sphere[count]: centre and radius. Spheres that are not finite,
 * or of a negative radius, are never listed. */
Status broad_phase_create(BroadPhase **out, const int *item, const double (*sphere)[4], int count, Arena *arena);
int    broad_phase_count(const BroadPhase *tree); /* of those that may be listed */

/* Closer boxes for rays, which pass many spheres that they do not meet anything in: box_of, for each item, its own box
 * (what rays may meet of it lies in both), or false: as it was. Before any ray. */
typedef bool BroadBox(void *user, int item, double low[3], double high[3]);
void         broad_phase_tighten(BroadPhase *tree, BroadBox *box_of, void *user);

/* Items of which some point of the sphere may lie within all planes (n, d): dot(n, p) >= d, n unit; ascending. list:
 * room for all. Returns how many. */
int broad_phase_in_planes(int *list, const BroadPhase *tree, const double (*plane)[4], int planes);
/* How far things are raised for the rays of an eye that bend in air (refraction_drop): an item by what its sphere's
 * centre is. */
typedef struct BroadLift {
    double eye_enu[2], bend_per_m;
} BroadLift;
/* Likewise in a volume, by the closer boxes, for items that are raised (lift: NULL: they are not); at most `most` of
 * them in no order. -1: there are more. */
int broad_phase_some_in_planes(int *list, int most, const BroadPhase *tree, const BroadLift *lift,
                               const double (*plane)[4], int planes);
/* Items whose spheres, grown by more_m, may touch a box; ascending. */
int broad_phase_near_box(int *list, const BroadPhase *tree, const double low[3], const double high[3], double more_m);
/* Items whose spheres may be met by rays that leave a sphere in the unit direction d, at most `most` of them in no
 * order. -1: there are more. */
int broad_phase_swept(int *list, int most, const BroadPhase *tree, const double centre[3], double radius_m,
                      const double d[3]);

/* Rays that traverse the tree together; limit_m: search limit, may be reduced meanwhile, -1 ends the search. Padded
 * to a multiple of broad_packet by the caller with limits of -1. */
typedef struct BroadRays {
    double o[3][broad_packet], d[3][broad_packet], limit_m[broad_packet];
} __attribute__((aligned(64))) BroadRays;

/* Calls visit for items that some of the rays may meet within their limits, approximately nearest first. */
typedef void BroadVisit(void *user, int item);
void         broad_phase_rays(const BroadPhase *tree, BroadRays *rays, BroadVisit *visit, void *user);
/* Likewise for items that are raised; lift: NULL: they are not. */
void broad_phase_rays_raised(const BroadPhase *tree, const BroadLift *lift, BroadRays *rays, BroadVisit *visit,
                             void *user);
/* Likewise for items whose spheres, grown by more_m, some of the rays may meet, whatever closer boxes there are. */
void broad_phase_rays_near(const BroadPhase *tree, BroadRays *rays, double more_m, BroadVisit *visit, void *user);

#endif
