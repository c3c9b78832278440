/* render/trace/plants/forest_trace.c: rays against plants: from a plant's box to its prototype's axes, to the quads
 * there.
 *
 * One ray at a time, the three axes of a prototype as lanes: packets through the same trees gain 1.02 to 1.17 x on
 * first hits (etc/reference/speed.md). */
#include "render/trace/plants/forest_rays_private.h"

/* ---- a plant's frame -------------------------------------------------------------------------- */

static bool is_gone(const ForestFrame *frame, const double foot_enu[3], uint32_t number)
{
    const double x = foot_enu[0] - frame->eye_enu[0], y = foot_enu[1] - frame->eye_enu[1];
    const double reach_m = frame->forest->config.far_m * far_page_reach(number);
    return x * x + y * y > reach_m * reach_m;
}

static const PlantFrame *frame_of(ListRay *ray, const PlantList *list, const Plant *plant)
{
    PlantFrame *f = &ray->kept[(uintptr_t)plant / sizeof *plant % frames_kept];
    double      axis[3][3], scale[2];
    if (f->plant == plant) return f;
    f->plant = plant;
    foot_of(f->foot_enu, list, plant);
    axes_of(axis, scale, ray->frame, list, plant);
    for (int c = 0; c < 3; c++) f->column[c] = (F64x4){axis[0][c], axis[1][c], axis[2][c], 0};
    f->per = (F64x4){1 / scale[0], 1 / scale[0], 1 / scale[1], 0};
    f->low = forest_is_low_in_picture(ray->frame, plant, f->foot_enu);
    f->gone = list->far && is_gone(ray->frame, f->foot_enu, number_of(list, (uint32_t)(plant - list->plant)));
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
    const ShapeScene *shape = &list->forest->shape[plant->kind][stands->low && !ray->real];
    double            low[4] __attribute__((aligned(32))), high[4] __attribute__((aligned(32)));
    q->shape = shape;
    if (!shape->scene || stands->gone) return false;
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

/* Whether a ray passes a plant of a shared box by more than the plant is wide and high. */
static bool passes(const ListRay *ray, const PlantList *list, const Plant *plant)
{
    static const double leans = 0.25; /* of the height: half of it by 15 degrees and most_sway_rad */
    const ShapeScene   *shape = list->forest->shape[plant->kind];
    const double        high_m = plant_height_m(plant);
    double              to[3], square = 0, along = 0, d2 = 0;
    for (int c = 0; c < 3; c++)
        to[c] = list->origin_enu[c] + (double)plant->p_m[c] + (c == 2 ? 0.5 * high_m : 0) - ray->o_enu[c];
    to[2] += ray->bend_per_m * (to[0] * to[0] + to[1] * to[1]);
    for (int c = 0; c < 3; c++)
        square += to[c] * to[c], along += to[c] * ray->d_enu[c], d2 += ray->d_enu[c] * ray->d_enu[c];
    const double wide = plant->width > 128 ? plant->width / 128.0 : 1;
    const double reach_m = (larger(shape[0].radius, shape[1].radius) * wide + leans) * high_m;
    return square * d2 - along * along > reach_m * reach_m * d2;
}

/* Traces one plant; true: it is met nearer than anything so far. */
static bool meet_plant(ListRay *ray, const PlantList *list, uint32_t place)
{
    struct RTCRayHit inner;
    QuadRay          q;
    QuadPass         pass;
    double           start_m;
    ray->entered++;
    if (!enter_plant(&q, &start_m, ray, list, place)) return false;
    rtcInitIntersectContext(&q.base);
    fill_ray(&inner.ray, q.o, q.d, q.limit_m * past);
    inner.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(q.shape->scene, &q.base, &inner);
    const double at_m = start_m + q.nearest_m;
    if (!(q.nearest_m < INFINITY) || !(at_m <= ray->limit_m)) return false;
    if (at_m == ray->limit_m &&
        !(ray->met && (list == ray->met_in ? place < ray->hit.place : number_of(list, place) < ray->hit.plant)))
        return false;
    const Plant     *plant = &list->plant[place];
    const PlantQuad *quad = &q.shape->shape->quad[q.quad];
    ray->limit_m = at_m;
    ray->met = true, ray->met_in = list;
    ray->hit = (ForestHit){
        .plant = number_of(list, place),
        .place = place,
        .quad = q.quad,
        .kind = plant->kind,
        .organ = quad->organ,
        .level = q.shape == &list->forest->shape[plant->kind][1],
        .back = (double)quad->n[0][0] * q.d[0] + (double)quad->n[0][1] * q.d[1] + (double)quad->n[0][2] * q.d[2] > 0};
    pass_of(&pass, &q, quad);
    place_of(ray->hit.uv, &pass, &q);
    return true;
}

void plant_intersect(const struct RTCIntersectFunctionNArguments *a)
{
    const PlantList *list = a->geometryUserPtr;
    ListRay         *ray = (ListRay *)a->context;
    const uint32_t   first = a->primID * (uint32_t)list->per_box;
    bool             nearer = false;
    if (!a->valid[0]) return;
    for (uint32_t k = first; k < first + (uint32_t)list->per_box && k < (uint32_t)list->count; k++)
        if (list->per_box == 1 || !passes(ray, list, &list->plant[k])) nearer |= meet_plant(ray, list, k);
    if (nearer) ((struct RTCRayHit *)a->rayhit)->ray.tfar = (float)((ray->limit_m - ray->piece_m) * past);
}

static bool is_stopped(ListRay *ray, const PlantList *list, uint32_t place)
{
    struct RTCRay inner;
    QuadRay       q;
    double        start_m;
    ray->entered++;
    if (!enter_plant(&q, &start_m, ray, list, place)) return false;
    rtcInitIntersectContext(&q.base);
    fill_ray(&inner, q.o, q.d, q.limit_m * past);
    rtcOccluded1(q.shape->scene, &q.base, &inner);
    return q.nearest_m < INFINITY;
}

void plant_occlude(const struct RTCOccludedFunctionNArguments *a)
{
    const PlantList *list = a->geometryUserPtr;
    ListRay         *ray = (ListRay *)a->context;
    const uint32_t   first = a->primID * (uint32_t)list->per_box;
    if (!a->valid[0]) return;
    for (uint32_t k = first; k < first + (uint32_t)list->per_box && k < (uint32_t)list->count && !ray->met; k++)
        if (list->per_box == 1 || !passes(ray, list, &list->plant[k])) ray->met = is_stopped(ray, list, k);
    if (ray->met) ((struct RTCRay *)a->ray)->tfar = -INFINITY;
}
