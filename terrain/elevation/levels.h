/* terrain/elevation/levels.h: posts of a level while they are made, in float: bent over the curved Earth, joined to the
 * level around, and at last quantised and stored. */
#ifndef TERRAIN_ELEVATION_LEVELS_H
#define TERRAIN_ELEVATION_LEVELS_H

#include "terrain/earth/geodesy.h"
#include "terrain/elevation/elevation.h"

/* Values at places ((i0 + i) spacing, (j0 + j) spacing) of ENU: control points of a cubic B-spline, or posts. */
typedef struct Field {
    double spacing_m;
    int    i0, j0, nx, ny;
    float *v; /* [ny][nx] */
} Field;

Status levels_field_create(Field *out, double spacing_m, int i0, int j0, int nx, int ny);
void   levels_field_destroy(Field *field);

/* Height of the triangle of a field of posts, as elevation_height defines it; NaN outside. corner, weight: the
 * three posts and their shares. */
double levels_height(const Field *posts, double x_m, double y_m, int corner[3], double weight[3]);

enum { level_ratio = 8 }; /* ratio of the spacings of neighbouring levels, 2^3 */

typedef struct WorkLevel {
    Field  z;   /* ENU z of the surface; starts as height above the ellipsoid */
    float *cap; /* highest z that clear lines allow; NULL: no line is near */
    /* posts of the hole, inclusive, as indices of this level; hole_i1 < hole_i0: no hole */
    int      hole_i0, hole_i1, hole_j0, hole_j1;
    bool     outermost;
    uint8_t *water; /* marks posts of the sea, which nothing moves; NULL: there are none */
} WorkLevel;

static inline double smooth_step(double low, double high, double x)
{
    const double t = clamp((x - low) / (high - low), 0, 1);
    return t * t * (3 - 2 * t);
}

/* z of the ellipsoid at ENU (x, y), and dz per metre of height there. */
typedef struct Curve {
    double origin[3], east[3], north[3], up[3]; /* axes and origin on the unit sphere */
    double inv_scale[3];
} Curve;

void levels_curve(Curve *out, const LocalFrame *frame);
/* z = *z_m + h * *dz_per_h within h^2 lean^2 / 2R: 0.1 mm at 6 km, 2 cm at 400 km and h = 9 km. */
void levels_curve_at(const Curve *curve, double x_m, double y_m, double *z_m, double *dz_per_h);

/* Turns heights above the ellipsoid into ENU z, in place. */
Status levels_bend(Field *posts, const Curve *curve);
/* Blends the posts within `band` of the outline into the surface of the enclosing level, on which the outline lies. */
void levels_join(WorkLevel *level, const WorkLevel *outer, int band);
/* Quantises all levels and builds their pyramids; keeps both promises of terrain/elevation/elevation.h on seams. */
Status levels_store(Elevation *out, const WorkLevel *level, int count);
/* As levels_store, for heights from files. All levels have steps of 1/2048 m (where their heights span less than 16
 * km). Steps are coarser in tiles whose heights span more than 31 m, along a seam 23 m. */
Status levels_store_fine(Elevation *out, const WorkLevel *level, int count);

#endif
