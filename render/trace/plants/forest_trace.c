/* render/trace/plants/forest_trace.c: rays against plants: from a plant's box to its prototype's axes, to the quads
 * there.
 *
 * One ray at a time, the three axes of a prototype as lanes: packets through the same trees gain 1.02 to 1.17 x on
 * first hits (etc/reference/speed.md). */
#include "render/trace/plants/forest_private.h"

#include "pitviper_simd.h"

static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

/* Where a plant stands and how it is turned: the same for every ray of a frame. */
typedef struct PlantFrame {
    F64x4        column[3], per; /* from ENU to the prototype's axes, and scales there; the fourth lane is 0 */
    double       foot_enu[3];
    const Plant *plant; /* NULL: not known */
    int          level; /* that is traced unless the ray must meet real plants */
} PlantFrame;

enum { frames_kept = 128 };

/* A ray through a list of plants. */
typedef struct ListRay {
    struct RTCIntersectContext base; /* first: Embree passes it to the callbacks */
    const ForestFrame         *frame;
    bool                       real;
    double                     o_enu[3], d_enu[3];
    double                     limit_m;             /* of what may still be nearer */
    double                     bend_per_m, piece_m; /* of a bent ray; where the piece that Embree has begins */
    bool                       met;
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

/* ---- a plant's frame -------------------------------------------------------------------------- */

static void foot_of(double foot_enu[3], const PlantList *list, const Plant *plant)
{
    for (int c = 0; c < 3; c++) foot_enu[c] = list->origin_enu[c] + (double)plant->p_m[c];
}

/* Axes and scales of a plant as it stands in this frame. */
static void axes_of(double axis[3][3], double scale[2], const ForestFrame *frame, const Plant *plant)
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
    axes_of(axis, scale, ray->frame, plant);
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

static const double past = 1 + 1e-6; /* a float's distance may be that much short */

void plant_intersect(const struct RTCIntersectFunctionNArguments *a)
{
    const PlantList *list = a->geometryUserPtr;
    ListRay         *ray = (ListRay *)a->context;
    struct RTCRayHit inner;
    QuadRay          q;
    QuadPass         pass;
    double           start_m;
    if (!a->valid[0]) return;
    ray->entered++;
    if (!enter_plant(&q, &start_m, ray, list, a->primID)) return;
    rtcInitIntersectContext(&q.base);
    fill_ray(&inner.ray, q.o, q.d, q.limit_m * past);
    inner.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(q.shape->scene, &q.base, &inner);
    const double at_m = start_m + q.nearest_m;
    if (!(q.nearest_m < INFINITY) || !(at_m <= ray->limit_m)) return;
    if (at_m == ray->limit_m && !(ray->met && a->primID < ray->hit.place)) return;
    const Plant     *plant = &list->plant[a->primID];
    const PlantQuad *quad = &q.shape->shape->quad[q.quad];
    ray->limit_m = at_m;
    ray->met = true;
    ray->hit = (ForestHit){
        .plant = list->number ? list->number[a->primID] : a->primID,
        .place = a->primID,
        .quad = q.quad,
        .kind = plant->kind,
        .organ = quad->organ,
        .level = (uint8_t)(q.shape - list->forest->shape[plant->kind]),
        .back = (double)quad->n[0][0] * q.d[0] + (double)quad->n[0][1] * q.d[1] + (double)quad->n[0][2] * q.d[2] > 0};
    pass_of(&pass, &q, quad);
    place_of(ray->hit.uv, &pass, &q);
    ((struct RTCRayHit *)a->rayhit)->ray.tfar = (float)((at_m - ray->piece_m) * past);
}

void plant_occlude(const struct RTCOccludedFunctionNArguments *a)
{
    const PlantList *list = a->geometryUserPtr;
    ListRay         *ray = (ListRay *)a->context;
    struct RTCRay    inner;
    QuadRay          q;
    double           start_m;
    if (!a->valid[0]) return;
    ray->entered++;
    if (!enter_plant(&q, &start_m, ray, list, a->primID)) return;
    rtcInitIntersectContext(&q.base);
    fill_ray(&inner, q.o, q.d, q.limit_m * past);
    rtcOccluded1(q.shape->scene, &q.base, &inner);
    if (!(q.nearest_m < INFINITY)) return;
    ray->met = true;
    ((struct RTCRay *)a->ray)->tfar = -INFINITY;
}

/* ---- rays ------------------------------------------------------------------------------------- */

static void open_rays(ListRay *ray)
{
    ray->entered = 0;
    for (int k = 0; k < frames_kept; k++) ray->kept[k].plant = NULL;
}

/* False: a ray that Embree does not accept (not finite, or from too far), which meets nothing. */
static bool open_ray(ListRay *ray, const ForestFrame *frame, const double *const o_enu[3], const double *const d_enu[3],
                     int i, double limit_m, bool real)
{
    static const double most_m = 1e15;
    rtcInitIntersectContext(&ray->base);
    ray->frame = frame, ray->real = real, ray->limit_m = limit_m, ray->met = false;
    ray->bend_per_m = ray->piece_m = 0;
    for (int c = 0; c < 3; c++) ray->o_enu[c] = o_enu[c][i], ray->d_enu[c] = d_enu[c][i];
    return v3_dot(ray->d_enu, ray->d_enu) < 2 &&
           fabs(ray->o_enu[0]) + fabs(ray->o_enu[1]) + fabs(ray->o_enu[2]) < most_m;
}

static void start_of(double o[3], const ListRay *ray, const PlantList *list)
{
    v3_sub(o, ray->o_enu, list->origin_enu);
}

static void first_hit_straight(ListRay *ray, const PlantList *list)
{
    struct RTCRayHit outer;
    double           o[3];
    start_of(o, ray, list);
    fill_ray(&outer.ray, o, ray->d_enu, ray->limit_m * past);
    outer.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(list->scene, &ray->base, &outer);
}

/* Ranges between which a ray is over a list's plants. */
static bool over_plants(double span_m[2], const ListRay *ray, const struct RTCBounds *b, const double o[3])
{
    static const double farthest_m = 1e7;
    const double low[2] = {(double)b->lower_x, (double)b->lower_y}, high[2] = {(double)b->upper_x, (double)b->upper_y};
    span_m[0] = 0, span_m[1] = smaller(ray->limit_m, farthest_m);
    for (int c = 0; c < 2; c++) {
        const double d = ray->d_enu[c], per = fabs(d) < 1e-30 ? 1e30 : 1 / d;
        const double p = (low[c] - 1 - o[c]) * per, q = (high[c] + 1 - o[c]) * per;
        span_m[0] = larger(span_m[0], smaller(p, q)), span_m[1] = smaller(span_m[1], larger(p, q));
    }
    return span_m[0] < span_m[1];
}

/* In straight pieces, each within less of the ray than plants' boxes have room: a chord of 1.6 km is 13 mm off at most.
 * A piece whose ends are above all plants is above them. */
static void first_hit_bent(ListRay *ray, const PlantList *list, const struct RTCBounds *bounds)
{
    static const double piece_m = 1600, nearest = 1e-4;
    const double        top_m = (double)bounds->upper_z + 1;
    double              o[3], span_m[2];
    start_of(o, ray, list);
    if (!over_plants(span_m, ray, bounds, o)) return;
    const double square = ray->d_enu[0] * ray->d_enu[0] + ray->d_enu[1] * ray->d_enu[1];
    const double step_m = piece_m / larger(sqrt(square), nearest), fall = ray->bend_per_m * square;
    for (double from_m = span_m[0]; from_m < smaller(span_m[1], ray->limit_m); from_m += step_m) {
        struct RTCRayHit outer;
        const double     to_m = smaller(from_m + step_m, span_m[1]);
        const double     start[3] = {o[0] + from_m * ray->d_enu[0], o[1] + from_m * ray->d_enu[1],
                                     o[2] + from_m * (ray->d_enu[2] - fall * from_m)};
        const double     chord[3] = {ray->d_enu[0], ray->d_enu[1], ray->d_enu[2] - fall * (from_m + to_m)};
        if (start[2] > top_m && o[2] + to_m * (ray->d_enu[2] - fall * to_m) > top_m) continue;
        ray->piece_m = from_m;
        fill_ray(&outer.ray, start, chord, (smaller(to_m, ray->limit_m) - from_m) * past);
        outer.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(list->scene, &ray->base, &outer);
    }
}

uint64_t forest_first_hits(double *range_m, ForestHit *hit, const ForestFrame *frame, int count,
                           const double *const o_enu[3], const double *const d_enu[3], const uint8_t *real)
{
    const PlantList *lists[2] = {&frame->forest->standing, low_plants_list(frame)};
    struct RTCBounds bounds[2];
    ListRay          ray;
    for (int k = 0; k < 2; k++)
        if (lists[k] && lists[k]->scene) rtcGetSceneBounds(lists[k]->scene, &bounds[k]);
    open_rays(&ray);
    for (int i = 0; i < count; i++) {
        if (!open_ray(&ray, frame, o_enu, d_enu, i, range_m[i], real && real[i])) continue;
        ray.bend_per_m = frame->bend_per_m;
        for (int k = 0; k < 2; k++) {
            if (!lists[k] || !lists[k]->scene) continue;
            if (frame->bend_per_m > 0) first_hit_bent(&ray, lists[k], &bounds[k]);
            else first_hit_straight(&ray, lists[k]);
        }
        if (!ray.met) continue;
        range_m[i] = ray.limit_m;
        hit[i] = ray.hit;
    }
    return ray.entered;
}

uint64_t forest_any_hits(uint8_t *dark, const ForestFrame *frame, int count, const double *const o_enu[3],
                         const double *const d_enu[3], const double *far_m, const uint8_t *real)
{
    const PlantList *lists[2] = {&frame->forest->standing, low_plants_list(frame)};
    ListRay          ray;
    open_rays(&ray);
    for (int i = 0; i < count; i++) {
        if (dark[i]) continue;
        if (!open_ray(&ray, frame, o_enu, d_enu, i, far_m[i], real && real[i])) continue;
        for (int k = 0; k < 2 && !ray.met; k++) {
            struct RTCRay outer;
            double        o[3];
            if (!lists[k] || !lists[k]->scene) continue;
            start_of(o, &ray, lists[k]);
            fill_ray(&outer, o, ray.d_enu, ray.limit_m * past);
            rtcOccluded1(lists[k]->scene, &ray.base, &outer);
        }
        dark[i] = ray.met;
    }
    return ray.entered;
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
    const PlantShape *shape = frame->forest->shape[hit->kind][hit->level].shape;
    const PlantQuad  *quad = &shape->quad[hit->quad];
    const double      height_m = plant_height_m(plant);
    double            axis[3][3], scale[2], n[3];
    QuadPlane         plane;
    axes_of(axis, scale, frame, plant);
    const double per[2] = {1 / scale[0], 1 / scale[1]};
    plane_of(&plane, quad);
    turn_normal(out->n_geo, axis, per, plane.n);
    const double side = v3_dot(out->n_geo, d_enu) > 0 ? -1 : 1;
    v3_scale(out->n_geo, side, out->n_geo);
    *out = (ForestSurface){.n_geo = {out->n_geo[0], out->n_geo[1], out->n_geo[2]},
                           .open_up = quad->open_up,
                           .open_down = quad->open_down,
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
