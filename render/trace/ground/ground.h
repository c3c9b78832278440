/* render/trace/ground/ground.h: rays against the nested height field, in double; one ray at a time (ground.c), eight
 * at a time (ground8.c), and tiles of coherent rays (ground_sweep.c), all with the same bits.
 *
 * Along a ray, its height over the surface is linear between the points where its track crosses a line of posts or a
 * cell's diagonal. The hit is the first change of sign between two such points, so no ray passes between two triangles.
 * The result depends on the ray and its cell alone, not on the traversal of the max pyramid, on skips or on the other
 * rays.
 *
 * Rays may bend (Ground.bend_per_m): their height is then a parabola that opens downwards, taken as linear between
 * those points (within 0.3 mm in cells of 300 m), and never lower in between than at both ends.
 *
 * The ground is solid: a ray that starts below it, enters through the side of the outermost level, or meets a step
 * between two levels, is stopped there. */
#ifndef RENDER_TRACE_GROUND_GROUND_H
#define RENDER_TRACE_GROUND_GROUND_H

#include "terrain/elevation/elevation.h"

/* One level in tracer units: lengths in cells, heights in posts. */
typedef struct GroundLevel {
    const uint16_t      *stored; /* posts, in tiles */
    const ElevationTile *tile;
    bool                 plain;                             /* every tile has base 0 and shift 0 */
    const uint16_t      *pyramid[elevation_pyramid_levels]; /* NULL below elevation_pyramid_first */
    int                  pyramid_nx[elevation_pyramid_levels];
    int32_t              pyramid_base, pyramid_shift;    /* posts: base + (entry << shift) */
    double               rise_unit;                      /* posts */
    const ElevationRise *rise[elevation_pyramid_levels]; /* NULL on the finest */
    int                  tiles_x, cells_x, cells_y, top; /* tiles a row; cells; index of the pyramid's single entry */
    double               x0_m, y0_m, z0_m, cells_per_m, posts_per_m;
    double               highest;  /* post */
    double               steepest; /* no edge of a cell rises by more posts */
} GroundLevel;

/* Borrows the elevation's arrays; no allocation. A user of bent rays sets bend_per_m in a copy. */
typedef struct Ground {
    const Elevation *elevation;
    int              level_count;
    double bend_per_m; /* rays sink by this times their squared horizontal distance from their origin; 0: straight */
    GroundLevel level[elevation_max_levels];
} Ground;

/* End of a ray: the cell, and which half of it. */
typedef struct GroundHit {
    int  level, i, j;
    bool north_west; /* triangle SW-NE-NW, else SW-SE-NE */
} GroundHit;

/* elevation NULL or without levels: a ground that nothing meets. */
void ground_prepare(Ground *out, const Elevation *elevation);

/* Distance to the first hit nearer than far_m along the unit direction d; INFINITY when there is none (or
 * the ray is not finite, or starts more than 1e9 m out). hit may be NULL; written only with a hit. */
double ground_first_hit(GroundHit *hit, const Ground *ground, const double o_enu[3], const double d_enu[3],
                        double far_m);

/* The same for count rays in arrays, eight at a time. range_m[i] and hit[i] (hit may be NULL) as above, to the bit,
 * independent of the other rays. */
void ground_first_hits(double *range_m, GroundHit *hit, const Ground *ground, int count, const double *const o_enu[3],
                       const double *const d_enu[3], const double *far_m);

/* The same, to the bit (tests/render/test_ground_together.c), for coherent rays: those of a tile from one eye, or
 * from its hits to the sun; others are passed to ground_first_hits. Over 12000 x 16000 posts of 1 m in tiles of
 * 1024: eye rays 1.5 to 3.8 times faster, sun rays 1.7 to 2.3 (15 degrees) and 3.4 to 4.0 (35, 60 degrees) times;
 * blocks of 16 eye rays 1.2 times. Rays that see only sky are a tenth slower. */
void ground_first_hits_together(double *range_m, GroundHit *hit, const Ground *ground, int count,
                                const double *const o_enu[3], const double *const d_enu[3], const double *far_m);

/* Whether rays are proven to meet no ground: all that begin in one box and end in another, or continue without limit
 * in a unit direction; boxes by low and high corner. False: not proven. Of rays from 0.5 m over gentle ground
 * upwards it finds most (tests/render/test_ground_clear.c). */
bool ground_is_clear(const Ground *ground, const double from[2][3], const double to[2][3]);
bool ground_is_clear_towards(const Ground *ground, const double from[2][3], const double d_enu[3]);

/* Upward unit normals at the hits hit[list[k]], k < count <= ground_normals_lanes: those of the triangles that were
 * met, and those interpolated between central differences at their posts, for shading. Results of lane k depend on its
 * hit alone; lanes from count on repeat the first. x_m, y_m: of the hits, as hit. */
enum { ground_normals_lanes = 4 };
void ground_normals(double n_geo[3][ground_normals_lanes], double n_enu[3][ground_normals_lanes], const Ground *ground,
                    const GroundHit *hit, const int *list, int count, const double *x_m, const double *y_m);

#endif
