/* render/trace/plants/forest_trace.c: rays against plants: from a plant's box to its prototype's axes, to the quads
 * there.
 *
 * One ray at a time, the three axes of a prototype as lanes: packets through the same trees gain 1.02 to 1.17 x on
 * first hits (etc/reference/speed.md). */
#include "render/trace/plants/forest_private.h"

/* The ray in the axes of a prototype, about the middle of its box, beginning where it enters that box. */
typedef struct QuadRay {
    struct RTCIntersectContext base;
    const ShapeScene          *shape;
    double                     o[4], d[4]; /* the fourth is 0 */
    double                     limit_m;    /* from there */
    double                     nearest_m;  /* INFINITY: nothing was met */
    uint32_t                   quad;
} QuadRay;

/* ---- a plant's frame -------------------------------------------------------------------------- */

static void foot_of(double foot_enu[3], const PlantList *list, const Plant *plant)
{
    for (int c = 0; c < 3; c++) foot_enu[c] = list->origin_enu[c] + (double)plant->p_m[c];
}

void plant_axes_in(double axis[3][3], double scale[2], const ForestFrame *frame, const Plant *plant)
{
    double sway_rad[2];
    if (!(frame->forest->config.sway > 0)) {
        plant_axes(axis, scale, plant, NULL);
        return;
    }
    forest_sway(sway_rad, frame, plant, (double)plant->p_m[0], (double)plant->p_m[1]);
    plant_axes(axis, scale, plant, sway_rad);
}

static const PlantFrame *frame_of(ListRay *ray, const PlantList *list, const Plant *plant)
{
    PlantFrame *f = &ray->kept[(uintptr_t)plant / sizeof *plant % frames_kept];
    double      axis[3][3], scale[2];
    if (f->plant == plant) return f;
    f->plant = plant;
    foot_of(f->foot_enu, list, plant);
    plant_axes_in(axis, scale, ray->frame, plant);
    for (int c = 0; c < 3; c++) f->column[c] = (F64x4){axis[0][c], axis[1][c], axis[2][c], 0};
    f->per = (F64x4){1 / scale[0], 1 / scale[0], 1 / scale[1], 0};
    f->level = forest_level(ray->frame, plant, f->foot_enu);
    return f;
}

/* A vector of ENU in the prototype's axes, scaled so that its height is 1. */
static void to_prototype(double out[3], const double axis[3][3], const double per[2], const double v_enu[3])
{
    out[0] = v3_dot(axis[0], v_enu) * per[0];
    out[1] = v3_dot(axis[1], v_enu) * per[0];
    out[2] = v3_dot(axis[2], v_enu) * per[1];
}

/* Does what to_prototype does, to the same bits. */
static inline F64x4 turned(const PlantFrame *stands, double x, double y, double z)
{
    return (stands->column[0] * f64x4_set(x) + stands->column[1] * f64x4_set(y) + stands->column[2] * f64x4_set(z)) *
           stands->per;
}

/* The ray in the prototype's axes; false: it misses the box, or is stopped before. start_m: of the new origin. */
static bool enter_plant(QuadRay *q, double *start_m, ListRay *ray, const PlantList *list, uint32_t place)
{
    const Plant      *plant = &list->plant[place];
    const PlantFrame *stands = frame_of(ray, list, plant);
    const ShapeScene *shape =
        &list->forest->shape[plant->kind][ray->real ? forest_finest(list->forest) : stands->level];
    double low[4] __attribute__((aligned(32))), high[4] __attribute__((aligned(32)));
    q->shape = shape;
    if (!shape->scene) return false;
    const double east_m = ray->o_enu[0] - stands->foot_enu[0], north_m = ray->o_enu[1] - stands->foot_enu[1];
    /* a bent ray is as far below its straight line all over the plant */
    const double drop_m = ray->bend_per_m * (east_m * east_m + north_m * north_m);
    const F64x4  o = turned(stands, east_m, north_m, ray->o_enu[2] - stands->foot_enu[2] - drop_m);
    const F64x4  d = turned(stands, ray->d_enu[0], ray->d_enu[1], ray->d_enu[2]);
    const F64x4  centre = f64x4_loadu(shape->centre), half = f64x4_loadu(shape->half), to = centre - o;
    /* along a slab a and b are infinite: of different signs within it, of one sign beside it */
    const F64x4 inverse = f64x4_set(1) / d, a = (to - half) * inverse, b = (to + half) * inverse;
    f64x4_store(low, f64x4_min(a, b)), f64x4_store(high, f64x4_max(a, b));
    const double in = larger(larger(low[0], low[1]), larger(low[2], 0));
    const double out = smaller(smaller(high[0], high[1]), smaller(high[2], ray->limit_m));
    if (!(in <= out && in < INFINITY)) return false;
    f64x4_storeu(q->o, o - centre + f64x4_set(in) * d);
    f64x4_storeu(q->d, d);
    *start_m = in;
    q->limit_m = ray->limit_m - in;
    q->nearest_m = INFINITY;
    return true;
}

/* ---- quads ------------------------------------------------------------------------------------ */

typedef struct QuadPlane {
    double a[3], u[3], v[3], n[3]; /* a corner, two sides from it, and their product */
} QuadPlane;

static void plane_of(QuadPlane *out, const PlantQuad *quad)
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

/* A ray and the plane of a quad. */
typedef struct QuadPass {
    QuadPlane plane;
    double    to_a[3], at_m; /* from the ray's origin to the quad's corner, and along the ray to the plane */
} QuadPass;

static void pass_of(QuadPass *out, const QuadRay *q, const PlantQuad *quad)
{
    plane_of(&out->plane, quad);
    for (int c = 0; c < 3; c++) out->to_a[c] = out->plane.a[c] - q->shape->centre[c] - q->o[c];
    out->at_m = v3_dot(out->plane.n, out->to_a) / v3_dot(out->plane.n, q->d);
}

static void place_of(float uv[2], const QuadPass *pass, const QuadRay *q)
{
    const QuadPlane *plane = &pass->plane;
    const double     square = v3_dot(plane->n, plane->n);
    double           p[3], side[3];
    for (int c = 0; c < 3; c++) p[c] = pass->at_m * q->d[c] - pass->to_a[c];
    v3_cross(side, p, plane->v);
    uv[0] = (float)(v3_dot(side, plane->n) / square);
    v3_cross(side, plane->u, p);
    uv[1] = (float)(v3_dot(side, plane->n) / square);
}

/* Distance of the ray's hit on the quad's plane, in double; of leaves, false beside the outline. Which quads a ray
 * passes through is Embree's word. */
static bool test_quad(double *at_m, const QuadRay *q, uint32_t index)
{
    const PlantQuad *quad = &q->shape->shape->quad[index];
    QuadPass         pass;
    float            uv[2];
    pass_of(&pass, q, quad);
    if (!(fabs(pass.at_m) < INFINITY) || !(pass.at_m >= 0)) return false;
    *at_m = pass.at_m;
    if (quad->organ != PLANT_LEAF) return true;
    place_of(uv, &pass, q);
    if (q->shape->pattern) return plants_leaflet(&q->shape->pattern[quad->outline], uv[0], uv[1]) > 0;
    return plants_within_outline(&q->shape->outline[quad->outline], uv[0], uv[1]);
}

void quad_intersect(const struct RTCFilterFunctionNArguments *a)
{
    QuadRay       *q = (QuadRay *)a->context;
    const uint32_t index = ((const struct RTCHit *)a->hit)->primID;
    double         at_m;
    if (!test_quad(&at_m, q, index)) {
        a->valid[0] = 0;
        return;
    }
    if (at_m < q->nearest_m || (at_m == q->nearest_m && index < q->quad)) {
        q->nearest_m = at_m;
        q->quad = index;
    }
}

void quad_occlude(const struct RTCFilterFunctionNArguments *a)
{
    QuadRay       *q = (QuadRay *)a->context;
    const uint32_t index = ((const struct RTCHit *)a->hit)->primID;
    double         at_m;
    if (test_quad(&at_m, q, index) && at_m < q->limit_m) q->nearest_m = at_m;
    else a->valid[0] = 0;
}

static void fill_ray(struct RTCRay *ray, const double o[3], const double d[3], double far)
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

bool shape_first(uint32_t *quad, double *at_m, const ShapeScene *shape, const double o[3], const double d[3])
{
    struct RTCRayHit inner;
    QuadRay          q = {.shape = shape, .limit_m = INFINITY, .nearest_m = INFINITY};
    if (!shape->scene) return false;
    memcpy(q.o, o, 3 * sizeof *o), memcpy(q.d, d, 3 * sizeof *d);
    rtcInitIntersectContext(&q.base);
    fill_ray(&inner.ray, q.o, q.d, INFINITY);
    inner.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(shape->scene, &q.base, &inner);
    *quad = q.quad, *at_m = q.nearest_m;
    return q.nearest_m < INFINITY;
}

bool shape_occluded(const ShapeScene *shape, const double o[3], const double d[3])
{
    struct RTCRay inner;
    QuadRay       q = {.shape = shape, .limit_m = INFINITY, .nearest_m = INFINITY};
    if (!shape->scene) return false;
    for (int c = 0; c < 3; c++) q.o[c] = o[c] - shape->centre[c], q.d[c] = d[c];
    rtcInitIntersectContext(&q.base);
    fill_ray(&inner, q.o, q.d, INFINITY);
    rtcOccluded1(shape->scene, &q.base, &inner);
    return q.nearest_m < INFINITY;
}

/* ---- plants ----------------------------------------------------------------------------------- */

bool plant_first(ListRay *ray, const PlantList *list, uint32_t place)
{
    struct RTCRayHit inner;
    QuadRay          q;
    QuadPass         pass;
    double           start_m;
    if (!enter_plant(&q, &start_m, ray, list, place)) return false;
    rtcInitIntersectContext(&q.base);
    fill_ray(&inner.ray, q.o, q.d, q.limit_m * past);
    inner.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(q.shape->scene, &q.base, &inner);
    const double at_m = start_m + q.nearest_m;
    if (!(q.nearest_m < INFINITY) || !(at_m <= ray->limit_m)) return false;
    if (at_m == ray->limit_m && !(ray->met && place < ray->hit.place)) return false;
    const Plant     *plant = &list->plant[place];
    const PlantQuad *quad = &q.shape->shape->quad[q.quad];
    ray->limit_m = at_m;
    ray->met = true;
    ray->hit = (ForestHit){
        .plant = list->number ? list->number[place] : place,
        .place = place,
        .quad = q.quad,
        .kind = plant->kind,
        .organ = quad->organ,
        .level = (uint8_t)(q.shape - list->forest->shape[plant->kind]),
        .back = (double)quad->n[0][0] * q.d[0] + (double)quad->n[0][1] * q.d[1] + (double)quad->n[0][2] * q.d[2] > 0};
    pass_of(&pass, &q, quad);
    place_of(ray->hit.uv, &pass, &q);
    return true;
}

bool plant_stops(ListRay *ray, const PlantList *list, uint32_t place)
{
    struct RTCRay inner;
    QuadRay       q;
    double        start_m;
    if (!enter_plant(&q, &start_m, ray, list, place)) return false;
    rtcInitIntersectContext(&q.base);
    fill_ray(&inner, q.o, q.d, q.limit_m * past);
    rtcOccluded1(q.shape->scene, &q.base, &inner);
    ray->met |= q.nearest_m < INFINITY;
    return q.nearest_m < INFINITY;
}

/* The place on the quad is the point's, brought there across the quad: a table's range is not the quad's own. */
void plant_complete(ListRay *ray, const PlantList *list)
{
    ForestHit        *hit = &ray->hit;
    const Plant      *plant = &list->plant[hit->place];
    const PlantFrame *stands = frame_of(ray, list, plant);
    const int         level = forest_finest(list->forest);
    const PlantQuad  *quad = &list->forest->shape[plant->kind][level].shape->quad[hit->quad];
    double            p[4] __attribute__((aligned(32))), d[4] __attribute__((aligned(32))), side[3];
    QuadPlane         plane;
    const double      m[3] = {ray->o_enu[0] - stands->foot_enu[0] + ray->limit_m * ray->d_enu[0],
                              ray->o_enu[1] - stands->foot_enu[1] + ray->limit_m * ray->d_enu[1],
                              ray->o_enu[2] - stands->foot_enu[2] + ray->limit_m * ray->d_enu[2]};
    const double      east_m = ray->o_enu[0] - stands->foot_enu[0], north_m = ray->o_enu[1] - stands->foot_enu[1];
    f64x4_store(p, turned(stands, m[0], m[1], m[2] - ray->bend_per_m * (east_m * east_m + north_m * north_m)));
    f64x4_store(d, turned(stands, ray->d_enu[0], ray->d_enu[1], ray->d_enu[2]));
    plane_of(&plane, quad);
    const double square = v3_dot(plane.n, plane.n);
    v3_sub(p, p, plane.a);
    v3_cross(side, p, plane.v);
    hit->uv[0] = (float)clamp(v3_dot(side, plane.n) / square, 0, 1);
    v3_cross(side, plane.u, p);
    hit->uv[1] = (float)clamp(v3_dot(side, plane.n) / square, 0, 1);
    hit->plant = list->number ? list->number[hit->place] : hit->place;
    hit->kind = plant->kind, hit->organ = quad->organ, hit->level = (uint8_t)level;
    hit->back = (double)quad->n[0][0] * d[0] + (double)quad->n[0][1] * d[1] + (double)quad->n[0][2] * d[2] > 0;
}

/* ---- surfaces --------------------------------------------------------------------------------- */

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
    const PlantList  *list = hit->plant & forest_low_bit ? low_plants_list(frame) : &frame->forest->standing;
    const Plant      *plant = &list->plant[hit->place];
    const ShapeScene *shape = &frame->forest->shape[hit->kind][hit->level];
    const PlantQuad  *quad = &shape->shape->quad[hit->quad];
    const double      height_m = plant_height_m(plant);
    float             open_share[2] = {quad->open_up, quad->open_down};
    double            axis[3][3], scale[2], n[3];
    QuadPlane         plane;
    if (shape->pattern) plant_openness(open_share, shape, hit->quad);
    plant_axes_in(axis, scale, frame, plant);
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
