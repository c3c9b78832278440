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

/* How a plant stands: its axes, what turns to them is over these scales, and each axis over its own. */
typedef struct Stand {
    const Plant *plant; /* NULL: none */
    double       axis[3][3], per[2], scaled[3][3];
} Stand;

static void stand_up(Stand *out, const ForestFrame *frame, const PlantList *list, const Plant *plant)
{
    double scale[2];
    out->plant = plant;
    plant_axes_in(out->axis, scale, frame, list, plant);
    out->per[0] = 1 / scale[0], out->per[1] = 1 / scale[1];
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) out->scaled[k][c] = out->axis[k][c] * out->per[k == 2];
}

/* A ray: of what is met at range_m. */
typedef struct SurfaceRay {
    double o_enu[3], d_enu[3], range_m;
} SurfaceRay;

/* What is painted on the wood at a height: of the trunk alone, not of branches beside it. */
static PlantMark mark_at(const Plant *plant, float height_m, float radius_m)
{
    static const double trunk = 0.6; /* of woods_trunk_m: a trunk tapers, and no branch near the ground is as thick */
    const PlantMark     mark = plant_mark(plant);
    if (mark == PLANT_UNMARKED || !((double)height_m >= plant_mark_low_m && (double)height_m <= plant_mark_high_m))
        return PLANT_UNMARKED;
    return (double)radius_m >= trunk * woods_trunk_m(plant) ? mark : PLANT_UNMARKED;
}

static const float paint_shows = 0.4f; /* how much of the bark's pattern a coat of paint leaves; estimate */

static void surface_of(ForestSurface *out, const ForestFrame *frame, const ForestHit *hit, const Stand *stand,
                       const SurfaceRay *ray, float footprint_m)
{
    const PlantList  *list = forest_list_of(frame, hit);
    const Plant      *plant = stand->plant;
    const ShapeScene *shape = &frame->forest->shape[hit->kind][hit->level];
    const PlantQuad  *quad = &shape->shape->quad[hit->quad];
    const double      height_m = plant_height_m(plant);
    float             open_share[2] = {quad->open_up, quad->open_down};
    double            n[3];
    QuadPlane         plane;
    if (shape->pattern) plant_openness(open_share, shape, hit->quad);
    plane_of(&plane, quad);
    turn_normal(out->n_geo, stand->axis, stand->per, plane.n);
    const double side = v3_dot(out->n_geo, ray->d_enu) > 0 ? -1 : 1;
    v3_scale(out->n_geo, side, out->n_geo);
    *out = (ForestSurface){.n_geo = {out->n_geo[0], out->n_geo[1], out->n_geo[2]},
                           .open_up = open_share[0],
                           .open_down = open_share[1],
                           .radius_m = (float)(quad->radius * height_m),
                           .height_m = (float)height_m};
    double foot_enu[3], from[3], p[3];
    foot_of(foot_enu, list, plant);
    v3_sub(from, ray->o_enu, foot_enu);
    v3_add_scaled(from, from, ray->range_m, ray->d_enu);
    to_prototype(p, stand->axis, stand->per, from);
    out->height_share = (float)clamp(p[2], 0, 1);
    if (quad->organ == PLANT_LEAF) {
        leaf_surface(out, frame, hit, stand->axis, stand->per, &plane, side);
        return;
    }
    const float p_m[3] = {(float)(p[0] * height_m), (float)(p[1] * height_m), (float)(p[2] * height_m)};
    float       slope[2] = {0, 0};
    plants_bark(&out->albedo, slope, (PlantKind)hit->kind, hit->plant, p_m, footprint_m);
    bark_normal(n, quad, &plane, hit->uv, slope);
    out->mark = (uint8_t)mark_at(plant, p_m[2], out->radius_m);
    if (out->mark) out->albedo = 1 + paint_shows * (out->albedo - 1);
    turn_normal(out->n_enu, stand->axis, stand->per, n);
    if (v3_dot(out->n_enu, out->n_geo) < 0) v3_scale(out->n_enu, -1, out->n_enu);
}

void forest_surface(ForestSurface *out, const ForestFrame *frame, const ForestHit *hit, const double o_enu[3],
                    const double d_enu[3], double range_m, float footprint_m)
{
    const PlantList *list = forest_list_of(frame, hit);
    const SurfaceRay ray = {{o_enu[0], o_enu[1], o_enu[2]}, {d_enu[0], d_enu[1], d_enu[2]}, range_m};
    Stand            stand;
    stand_up(&stand, frame, list, &list->plant[hit->place]);
    surface_of(out, frame, hit, &stand, &ray, footprint_m);
}

/* ---- many hits ---------------------------------------------------------------------------------- */

enum { leaves_together = 64, stands_kept = 64 };

/* Hits on cards with patterns, in arrays: the sides of their cards, the axes of their plants, rays, slopes; normals. */
typedef struct Leaves {
    int    count, hit[leaves_together]; /* hit: its place among all */
    double u[3][leaves_together], v[3][leaves_together], scaled[3][3][leaves_together], d[3][leaves_together];
    double slope[2][leaves_together];
    double n_geo[3][leaves_together], n_enu[3][leaves_together];
    double sound[leaves_together]; /* 0: some vector has no length that is a number above 0 */
} Leaves;

/* Lengths of the vectors of a hit that were made unit: the least, and their sum. */
typedef struct Lengths {
    double least, sum;
} Lengths;

static inline void unit(double v[3], Lengths *of)
{
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]), per = 1 / length;
    of->least = length < of->least ? length : of->least;
    of->sum += length;
    for (int c = 0; c < 3; c++) v[c] = per * v[c];
}

/* A vector in the prototype's axes turned to ENU, its length 1. */
static inline void turned_unit(double out[3], Lengths *of, const double n[3], double scaled[3][3])
{
    for (int c = 0; c < 3; c++) out[c] = scaled[0][c] * n[0] + scaled[1][c] * n[1] + scaled[2][c] * n[2];
    unit(out, of);
}

/* Normals of the cards, and with the slopes of their leaves: plain arrays, no branches. */
static void find_normals(Leaves *l)
{
    for (int k = 0; k < l->count; k++) {
        double  geo[3], enu[3], scaled[3][3];
        Lengths lengths = {INFINITY, 0};
        double  u[3] = {l->u[0][k], l->u[1][k], l->u[2][k]}, v[3] = {l->v[0][k], l->v[1][k], l->v[2][k]};
        double  n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++) scaled[r][c] = l->scaled[r][c][k];
        turned_unit(geo, &lengths, n, scaled);
        const double towards = geo[0] * l->d[0][k] + geo[1] * l->d[1][k] + geo[2] * l->d[2][k];
        const double side = towards > 0 ? -1 : 1;
        unit(n, &lengths), unit(u, &lengths), unit(v, &lengths);
        for (int c = 0; c < 3; c++) {
            n[c] = n[c] + l->slope[0][k] * u[c];
            n[c] = n[c] + l->slope[1][k] * v[c];
        }
        turned_unit(enu, &lengths, n, scaled);
        for (int c = 0; c < 3; c++) l->n_geo[c][k] = side * geo[c], l->n_enu[c][k] = side * enu[c];
        l->sound[k] = (lengths.least > 0) & (lengths.sum < INFINITY);
    }
}

static void add_leaf(Leaves *l, ForestSurfaces *out, int at, const ForestFrame *frame, const ForestHit *hit,
                     const Stand *stand, const ForestRays *rays)
{
    const ShapeScene *shape = &frame->forest->shape[hit->kind][hit->level];
    const PlantQuad  *quad = &shape->shape->quad[hit->quad];
    const LeafPlace   leaf =
        plants_leaf_place(frame->forest->plants, (PlantKind)hit->kind, hit->plant, quad, hit->quad, hit->uv);
    const int k = l->count++;
    float     open_share[2];
    plant_openness(open_share, shape, hit->quad);
    out->albedo[at] = leaf.albedo;
    out->radius_m[at] = (float)(quad->radius * plant_height_m(stand->plant));
    out->mark[at] = PLANT_UNMARKED;
    out->open_up[at] = open_share[0], out->open_down[at] = open_share[1];
    l->hit[k] = at;
    l->slope[0][k] = (double)leaf.slope[0], l->slope[1][k] = (double)leaf.slope[1];
    for (int c = 0; c < 3; c++) {
        l->u[c][k] = (double)quad->corner[1][c] - (double)quad->corner[0][c];
        l->v[c][k] = (double)quad->corner[3][c] - (double)quad->corner[0][c];
        l->d[c][k] = rays->d_enu[c][at];
        for (int r = 0; r < 3; r++) l->scaled[r][c][k] = stand->scaled[r][c];
    }
}

static void put_one(ForestSurfaces *out, int at, const ForestFrame *frame, const ForestHit *hit, const Stand *stand,
                    const ForestRays *rays)
{
    const SurfaceRay ray = {{rays->o_enu[0][at], rays->o_enu[1][at], rays->o_enu[2][at]},
                            {rays->d_enu[0][at], rays->d_enu[1][at], rays->d_enu[2][at]},
                            rays->range_m[at]};
    ForestSurface    one;
    surface_of(&one, frame, hit, stand, &ray, (float)(rays->range_m[at] / frame->per_rad));
    for (int c = 0; c < 3; c++) out->n_geo[c][at] = one.n_geo[c], out->n_enu[c][at] = one.n_enu[c];
    out->albedo[at] = one.albedo, out->radius_m[at] = one.radius_m, out->mark[at] = one.mark;
    out->open_up[at] = one.open_up, out->open_down[at] = one.open_down;
}

static void put_leaves(ForestSurfaces *out, Leaves *l, const ForestFrame *frame, const ForestHit *const *hit,
                       const ForestRays *rays)
{
    find_normals(l);
    for (int k = 0; k < l->count; k++) {
        const int at = l->hit[k];
        for (int c = 0; c < 3; c++) out->n_geo[c][at] = l->n_geo[c][k], out->n_enu[c][at] = l->n_enu[c][k];
        if (l->sound[k] > 0) continue;
        const PlantList *list = forest_list_of(frame, hit[at]);
        Stand            stand;
        stand_up(&stand, frame, list, &list->plant[hit[at]->place]);
        put_one(out, at, frame, hit[at], &stand, rays);
    }
    l->count = 0;
}

/* What a hit needs lies far from what the one before it needs: its card is asked for first, then, once that is there,
 * the cell of its pattern. */
enum { ahead_card = 12, ahead_cell = 6 };

static void ask_for_card(const ForestFrame *frame, const ForestHit *hit)
{
    const char *quad = (const char *)&frame->forest->shape[hit->kind][hit->level].shape->quad[hit->quad];
    __builtin_prefetch(quad), __builtin_prefetch(quad + sizeof(PlantQuad) - 1);
}

static void ask_for_cell(const ForestFrame *frame, const ForestHit *hit)
{
    const ShapeScene *shape = &frame->forest->shape[hit->kind][hit->level];
    const float       u = hit->uv[0], v = hit->uv[1];
    if (hit->organ != PLANT_LEAF || !shape->pattern || !(u >= 0 && u < 1 && v >= 0 && v < 1)) return;
    const LeafPattern *pattern = &shape->pattern[shape->shape->quad[hit->quad].outline];
    __builtin_prefetch(&pattern->leaflet[(int)(v * plant_pattern_side)][(int)(u * plant_pattern_side)]);
}

void forest_surfaces(ForestSurfaces *out, const ForestFrame *frame, const ForestHit *const *hit, int count,
                     const ForestRays *rays)
{
    Stand  kept[stands_kept]; /* of plants that earlier hits met */
    Leaves leaves;
    leaves.count = 0;
    for (int k = 0; k < stands_kept; k++) kept[k].plant = NULL;
    for (int k = 0; k < count; k++) {
        if (k + ahead_card < count) ask_for_card(frame, hit[k + ahead_card]);
        if (k + ahead_cell < count) ask_for_cell(frame, hit[k + ahead_cell]);
        const PlantList *list = forest_list_of(frame, hit[k]);
        const Plant     *plant = &list->plant[hit[k]->place];
        Stand           *stand = &kept[(uintptr_t)plant / sizeof *plant % stands_kept];
        if (stand->plant != plant) stand_up(stand, frame, list, plant);
        if (hit[k]->organ != PLANT_LEAF || !frame->forest->shape[hit[k]->kind][hit[k]->level].pattern) {
            put_one(out, k, frame, hit[k], stand, rays);
            continue;
        }
        add_leaf(&leaves, out, k, frame, hit[k], stand, rays);
        if (leaves.count == leaves_together) put_leaves(out, &leaves, frame, hit, rays);
    }
    put_leaves(out, &leaves, frame, hit, rays);
}
