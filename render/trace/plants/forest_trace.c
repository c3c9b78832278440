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

void plant_axes_in(double axis[3][3], double scale[2], const ForestFrame *frame, const PlantList *list,
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

static const PlantFrame *frame_of(ListRay *ray, const PlantList *list, const Plant *plant)
{
    PlantFrame *f = &ray->kept[(uintptr_t)plant / sizeof *plant % frames_kept];
    double      axis[3][3], scale[2];
    if (f->plant == plant) return f;
    f->plant = plant;
    foot_of(f->foot_enu, list, plant);
    plant_axes_in(axis, scale, ray->frame, list, plant);
    for (int c = 0; c < 3; c++) f->column[c] = (F64x4){axis[0][c], axis[1][c], axis[2][c], 0};
    f->per = (F64x4){1 / scale[0], 1 / scale[0], 1 / scale[1], 0};
    f->level = forest_level(ray->frame, plant, f->foot_enu);
    return f;
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
    if (at_m == ray->limit_m && !(ray->met && plant_number(list, place) < ray->hit.plant)) return false;
    const Plant     *plant = &list->plant[place];
    const PlantQuad *quad = &q.shape->shape->quad[q.quad];
    ray->limit_m = at_m;
    ray->met = true;
    ray->hit = (ForestHit){
        .plant = plant_number(list, place),
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
    hit->plant = plant_number(list, hit->place);
    hit->kind = plant->kind, hit->organ = quad->organ, hit->level = (uint8_t)level;
    hit->back = (double)quad->n[0][0] * d[0] + (double)quad->n[0][1] * d[1] + (double)quad->n[0][2] * d[2] > 0;
}
