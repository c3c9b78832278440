/* render/trace/plants/forest_surface.c: what shading needs of a hit on a plant. */
#include "render/trace/plants/forest_private.h"

/* A normal of the prototype, in ENU. */
static void turn_normal(double out[3], const double axis[3][3], const double per[2], const double n[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = axis[0][c] * per[0] * n[0] + axis[1][c] * per[0] * n[1] + axis[2][c] * per[1] * n[2];
    if (!v3_normalize(out, out)) out[0] = out[1] = 0, out[2] = 1;
}

/* The corners' normals, mixed, and bent by relief: slopes about and along the branch, whose sides are u and v. */
static void bark_normal(double n[3], const PlantQuad *quad, const QuadPlane *plane, const float uv[2],
                        const float slope[2])
{
    const double u = clamp((double)uv[0], 0, 1), v = clamp((double)uv[1], 0, 1);
    const double share[4] = {(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v};
    double       along[3] = {0}, about[3] = {0};
    for (int c = 0; c < 3; c++) {
        n[c] = 0;
        for (int k = 0; k < 4; k++) n[c] += share[k] * (double)quad->n[k][c];
    }
    if (slope[0] == 0 && slope[1] == 0) return;
    v3_normalize(n, n);
    if (v3_normalize(along, plane->v)) v3_add_scaled(n, n, -(double)slope[0], along);
    if (v3_normalize(about, plane->u)) v3_add_scaled(n, n, -(double)slope[1], about);
}

/* Reflectance and normal of a place on a leaf; side: of the ray. */
static void leaf_surface(ForestSurface *out, const ForestFrame *frame, const ForestHit *hit, const double axis[3][3],
                         const double per[2], const QuadPlane *plane, double side)
{
    const ShapeScene *shape = &frame->forest->shape[hit->kind][hit->level];
    const PlantQuad  *quad = &shape->shape->quad[hit->quad];
    memcpy(out->n_enu, out->n_geo, sizeof out->n_enu);
    if (!shape->pattern) {
        out->albedo = plants_leaf_albedo((PlantKind)hit->kind, hit->plant, quad->piece);
        return;
    }
    const LeafPlace at =
        plants_leaf_place(frame->forest->plants, (PlantKind)hit->kind, hit->plant, quad, hit->quad, hit->uv);
    double n[3], u[3], v[3];
    out->albedo = at.albedo;
    if (!v3_normalize(n, plane->n) || !v3_normalize(u, plane->u) || !v3_normalize(v, plane->v)) return;
    v3_add_scaled(n, n, (double)at.slope[0], u);
    v3_add_scaled(n, n, (double)at.slope[1], v);
    turn_normal(out->n_enu, axis, per, n);
    v3_scale(out->n_enu, side, out->n_enu);
}

void forest_surface(ForestSurface *out, const ForestFrame *frame, const ForestHit *hit, const double o_enu[3],
                    const double d_enu[3], double range_m, float footprint_m)
{
    const PlantList  *list = forest_list_of(frame, hit);
    const Plant      *plant = &list->plant[hit->place];
    const ShapeScene *shape = &frame->forest->shape[hit->kind][hit->level];
    const PlantQuad  *quad = &shape->shape->quad[hit->quad];
    const double      height_m = plant_height_m(plant);
    float             open_share[2] = {quad->open_up, quad->open_down};
    double            axis[3][3], scale[2], n[3];
    QuadPlane         plane;
    if (shape->pattern) plant_openness(open_share, shape, hit->quad);
    plant_axes_in(axis, scale, frame, list, plant);
    const double per[2] = {1 / scale[0], 1 / scale[1]};
    plane_of(&plane, quad);
    turn_normal(out->n_geo, axis, per, plane.n);
    const double side = v3_dot(out->n_geo, d_enu) > 0 ? -1 : 1;
    v3_scale(out->n_geo, side, out->n_geo);
    *out = (ForestSurface){.n_geo = {out->n_geo[0], out->n_geo[1], out->n_geo[2]},
                           .open_up = open_share[0],
                           .open_down = open_share[1],
                           .radius_m = (float)(quad->radius * height_m),
                           .height_m = (float)height_m};
    double foot_enu[3], from[3], p[3];
    foot_of(foot_enu, list, plant);
    v3_sub(from, o_enu, foot_enu);
    v3_add_scaled(from, from, range_m, d_enu);
    to_prototype(p, axis, per, from);
    out->height_share = (float)clamp(p[2], 0, 1);
    if (quad->organ == PLANT_LEAF) {
        leaf_surface(out, frame, hit, axis, per, &plane, side);
        return;
    }
    const float p_m[3] = {(float)(p[0] * height_m), (float)(p[1] * height_m), (float)(p[2] * height_m)};
    float       slope[2] = {0, 0};
    plants_bark(&out->albedo, slope, (PlantKind)hit->kind, hit->plant, p_m, footprint_m);
    bark_normal(n, quad, &plane, hit->uv, slope);
    turn_normal(out->n_enu, axis, per, n);
    if (v3_dot(out->n_enu, out->n_geo) < 0) v3_scale(out->n_enu, -1, out->n_enu);
}
