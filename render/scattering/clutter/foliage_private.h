/* render/scattering/clutter/foliage_private.h: crowns in squares, and a ray in one of them: what foliage.c and
 * foliage_fan.c share. */
#ifndef RENDER_SCATTERING_CLUTTER_FOLIAGE_PRIVATE_H
#define RENDER_SCATTERING_CLUTTER_FOLIAGE_PRIVATE_H

#include "render/scattering/clutter/foliage.h"

struct Foliage {
    const Woods  *woods;
    double        origin_enu[3], wide_m[2];
    int           count;
    FoliageCrown *crown; /* [count] */
    double        side_m;
    int           nx, ny;
    uint32_t     *first;  /* [nx * ny + 1] */
    uint32_t     *listed; /* crowns that reach into a square, ascending */
    float        *top_m;  /* [nx * ny]: of the highest of them, from the origin; -INFINITY: none */
    double        db_m[SURFACE_COUNT];
};

/* fmin and fmax of what is no NaN, without a call. */
static inline double least_of(double a, double b) { return a < b ? a : b; }
static inline double most_of(double a, double b) { return a > b ? a : b; }

/* The column or row of squares that a coordinate is in. */
static inline int foliage_square_at(double m, double side_m, int count)
{
    return (int)clamp(floor(m / side_m), 0, count - 1);
}

/* A stretch of a ray between two distances from its start. The ray starts from the woods' origin. */
typedef struct Stretch {
    double o[3], d[3], from_m, to_m;
} Stretch;

/* Cuts a stretch to where one coordinate is between two values. */
static inline void stretch_cut(Stretch *s, int axis, double low, double high)
{
    const double o = s->o[axis], d = s->d[axis];
    if (d == 0) {
        if (!(o >= low && o <= high)) s->to_m = s->from_m;
        return;
    }
    const double a = (low - o) / d, b = (high - o) / d;
    s->from_m = most_of(s->from_m, least_of(a, b));
    s->to_m = least_of(s->to_m, most_of(a, b));
}

/* The whole of a ray that may have foliage: false, there is none. */
static inline bool stretch_open(Stretch *ray, const Foliage *f, const double o_enu[3], const double d_enu[3],
                                double range_m)
{
    const double room_m = f->side_m; /* of crowns beyond the edge */
    *ray = (Stretch){.to_m = range_m};
    for (int k = 0; k < 3; k++) ray->o[k] = o_enu[k] - f->origin_enu[k], ray->d[k] = d_enu[k];
    stretch_cut(ray, 0, -room_m, f->nx * f->side_m + room_m);
    stretch_cut(ray, 1, -room_m, f->ny * f->side_m + room_m);
    return ray->to_m > ray->from_m && f->count > 0;
}

/* The first and last rows of squares that a ray passes. */
static inline void stretch_rows(int *first, int *last, const Foliage *f, const Stretch *ray)
{
    const double ya = ray->o[1] + ray->d[1] * ray->from_m, yb = ray->o[1] + ray->d[1] * ray->to_m;
    *first = foliage_square_at(least_of(ya, yb), f->side_m, f->ny);
    *last = foliage_square_at(most_of(ya, yb), f->side_m, f->ny);
}

/* The first and last squares of row y that a ray passes. False: none. */
static inline bool stretch_columns(int *west, int *east, const Foliage *f, const Stretch *ray, int y)
{
    Stretch row = *ray;
    stretch_cut(&row, 1, y == 0 ? -INFINITY : y * f->side_m, y == f->ny - 1 ? INFINITY : (y + 1) * f->side_m);
    if (!(row.to_m > row.from_m)) return false;
    const double xa = row.o[0] + row.d[0] * row.from_m, xb = row.o[0] + row.d[0] * row.to_m;
    *west = foliage_square_at(least_of(xa, xb), f->side_m, f->nx);
    *east = foliage_square_at(most_of(xa, xb), f->side_m, f->nx);
    return true;
}

/* The part of a ray in one square. False: it is above the crowns there, or not there at all. */
static inline bool stretch_in_square(Stretch *here, const Foliage *f, const Stretch *ray, int x, int y)
{
    *here = *ray;
    /* crowns of the outermost squares may reach beyond them */
    stretch_cut(here, 0, x == 0 ? -INFINITY : x * f->side_m, x == f->nx - 1 ? INFINITY : (x + 1) * f->side_m);
    stretch_cut(here, 1, y == 0 ? -INFINITY : y * f->side_m, y == f->ny - 1 ? INFINITY : (y + 1) * f->side_m);
    if (!(here->to_m > here->from_m)) return false;
    const double top_m = (double)f->top_m[(size_t)y * (size_t)f->nx + (size_t)x];
    return here->o[2] + least_of(here->d[2] * here->from_m, here->d[2] * here->to_m) < top_m;
}

/* A crown as a ray meets it: p is where the ray starts and d its direction, in half axes from the crown's middle.
 * False: the whole line misses it. */
static inline bool line_meets_crown(double *middle_m, double *half_m, const double p[3], const double d[3])
{
    double       at[3];
    const double dd = v3_dot(d, d), nearest = -v3_dot(p, d) / dd;
    v3_add_scaled(at, p, nearest, d);
    const double left = 1 - v3_dot(at, at);
    if (!(left > 0)) return false;
    *middle_m = nearest, *half_m = sqrt(left / dd);
    return true;
}

/* Length of a stretch that is in what the line meets. */
static inline double stretch_within(double middle_m, double half_m, double from_m, double to_m)
{
    return most_of(least_of(middle_m + half_m, to_m) - most_of(middle_m - half_m, from_m), 0);
}

/* The loss of so much foliage of each class, dB. */
static inline double foliage_db_of(double *depth_m, const Foliage *f, const double depth[SURFACE_COUNT])
{
    double db = 0, all_m = 0;
    for (int s = 0; s < SURFACE_COUNT; s++) all_m += depth[s], db += depth[s] * f->db_m[s];
    if (depth_m) *depth_m = all_m;
    return all_m > 0 ? db * clutter_foliage_depth(all_m) / all_m : 0;
}

#endif
