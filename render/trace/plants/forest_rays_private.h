/* render/trace/plants/forest_rays_private.h: a ray on its way through lists of plants, shared by forest_trace.c
 * (plants), forest_rays.c (lists and pages) and forest_surface.c. */
#ifndef RENDER_TRACE_PLANTS_FOREST_RAYS_PRIVATE_H
#define RENDER_TRACE_PLANTS_FOREST_RAYS_PRIVATE_H

#include "render/trace/plants/forest_private.h"

#include "pitviper_simd.h"

static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

static const double past = 1 + 1e-6; /* a float's distance may be that much short */

/* Where a plant stands and how it is turned: the same for every ray of a frame. */
typedef struct PlantFrame {
    F64x4        column[3], per; /* from ENU to the prototype's axes, and scales there; the fourth lane is 0 */
    double       foot_enu[3];
    const Plant *plant; /* NULL: not known */
    bool         low;   /* in the picture: level 1 is traced unless the ray must meet real plants */
    bool         gone;  /* of a page, and too far from the eye for its number */
} PlantFrame;

enum { frames_kept = 128 };

/* A ray through a list of plants. */
typedef struct ListRay {
    struct RTCIntersectContext base; /* first: Embree passes it to the callbacks */
    const ForestFrame         *frame;
    bool                       real;
    double                     o_enu[3], d_enu[3];
    double                     limit_m;                 /* of what may still be nearer */
    double                     bend_per_m, piece_m;     /* of a bent ray; where the piece that Embree has begins */
    double                     piece_end_m, piece_d[3]; /* where it ends, and its direction */
    bool                       met;
    const PlantList           *met_in;
    uint64_t                   entered; /* plants' boxes */
    ForestHit                  hit;
    PlantFrame                 kept[frames_kept]; /* of plants that earlier rays met */
} ListRay;

/* The ray in the axes of a prototype, about the middle of its box, beginning where it enters that box. */
typedef struct QuadRay {
    struct RTCIntersectContext base;
    const ShapeScene          *shape;
    double                     o[4], d[4]; /* the fourth is 0 */
    double                     limit_m;    /* from there */
    double                     nearest_m;  /* INFINITY: nothing was met */
    uint32_t                   quad;
} QuadRay;

static inline void foot_of(double foot_enu[3], const PlantList *list, const Plant *plant)
{
    for (int c = 0; c < 3; c++) foot_enu[c] = list->origin_enu[c] + (double)plant->p_m[c];
}

/* Axes and scales of a plant as it stands in this frame. */
static inline void axes_of(double axis[3][3], double scale[2], const ForestFrame *frame, const PlantList *list,
                           const Plant *plant)
{
    double sway_rad[2];
    if (!(frame->forest->config.sway > 0)) {
        plant_axes(axis, scale, plant, NULL);
        return;
    }
    double p_m[2] = {(double)plant->p_m[0], (double)plant->p_m[1]}; /* from the woods' origin, in pages too */
    for (int c = 0; c < 2 && list->far; c++) p_m[c] += list->origin_enu[c] - list->forest->woods->origin_enu[c];
    forest_sway(sway_rad, frame, plant, p_m[0], p_m[1]);
    plant_axes(axis, scale, plant, sway_rad);
}

static inline uint32_t number_of(const PlantList *list, uint32_t place)
{
    return list->number ? list->number[place] : list->base + place;
}

/* A vector of ENU in the prototype's axes, scaled so that its height is 1. */
static inline void to_prototype(double out[3], const double axis[3][3], const double per[2], const double v_enu[3])
{
    out[0] = v3_dot(axis[0], v_enu) * per[0];
    out[1] = v3_dot(axis[1], v_enu) * per[0];
    out[2] = v3_dot(axis[2], v_enu) * per[1];
}

typedef struct QuadPlane {
    double a[3], u[3], v[3], n[3]; /* a corner, two sides from it, and their product */
} QuadPlane;

static inline void plane_of(QuadPlane *out, const PlantQuad *quad)
{
    for (int c = 0; c < 3; c++) {
        out->a[c] = (double)quad->corner[0][c];
        out->u[c] = (double)quad->corner[1][c] - out->a[c];
        out->v[c] = (double)quad->corner[3][c] - out->a[c];
    }
    v3_cross(out->n, out->u, out->v);
    if (v3_dot(out->n, out->n) > 0) return;
    for (int c = 0; c < 3; c++)
        out->v[c] = (double)quad->corner[2][c] - out->a[c]; /* a triangle: corners 0 and 3, or 0
                                                             * and 1, are one */
    v3_cross(out->n, out->u, out->v);
}

static inline void fill_ray(struct RTCRay *ray, const double o[3], const double d[3], double far)
{
    *ray = (struct RTCRay){.org_x = (float)o[0],
                           .org_y = (float)o[1],
                           .org_z = (float)o[2],
                           .dir_x = (float)d[0],
                           .dir_y = (float)d[1],
                           .dir_z = (float)d[2],
                           .tfar = (float)far,
                           .mask = ~0u};
}

#endif
