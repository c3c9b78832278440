/* render/trace/parts/parts_trace.c: ray-triangle intersection. Embree finds candidate triangles, in floats, by boxes
 * round them with ample margin (parts.c); each candidate is tested exactly here, in double, against the triangle
 * itself. So the result depends neither on the instruction set nor on the other rays of a packet.
 *
 * The result: the nearest triangle that the ray passes through; and of all triangles within 0.1 mm of its distance that
 * the ray passes through, or passes within 20 um, the one of the lowest index. Faces of two parts often coincide, such
 * as a tyre's and its disc's, and at an edge two always meet.
 *
 * Four rays at a time in intrinsics, as in ground8.c: the compiler does not vectorise this. */
#include "render/trace/parts/parts_packet_private.h"

static const double same_edge_m = 2e-5, same_range_m = 1e-4;
static const double through_m = -1e-9; /* tolerance of the inside test: a corner leaves room for roundings between
                                        * its triangles */
static const double slack_m = 2e-3;    /* search distance beyond the nearest hit: for ties, and for Embree's floats */

/* ---- candidates and the exact test ------------------------------------------------------------ */

/* Of a triangle, for four lanes. */
typedef struct Verdict {
    double   at_m[4]; /* where near: distance to the plane, clamped between the corners: edge-on it is undefined */
    unsigned near, through; /* 1 << lane % 4: passed by within same_edge_m, ahead; and through */
} __attribute__((aligned(64))) Verdict;

/* Neighbours compute the same number with the opposite sign for their common side, whatever the rounding, so no ray
 * passes between them. a, b, c: corners from the rays' origins. */
static inline void judge(Verdict *v, Vector a, Vector b, Vector c, Vector d, const float height_m[3])
{
    const F64x4 ab = dot(cross(a, b), d), bc = dot(cross(b, c), d), ca = dot(cross(c, a), d);
    const F64x4 whole = ab + bc + ca, share = f64x4_set(1) / whole;
    const F64x4 inside_m =
        f64x4_min(ab * share * f64x4_set((double)height_m[0]),
                  f64x4_min(bc * share * f64x4_set((double)height_m[1]), ca * share * f64x4_set((double)height_m[2])));
    const F64x4 seen = _mm256_cmp_pd(whole, f64x4_set(0), _CMP_NEQ_OQ); /* not edge-on */
    const F64x4 near = f64x4_and(seen, f64x4_at_most(f64x4_set(-same_edge_m), inside_m));
    v->near = v->through = f64x4_bits(near);
    if (v->near == 0) return;
    const Vector n = cross(sub(b, a), sub(c, a));
    const F64x4  at_a = dot(a, d), at_b = dot(b, d), at_c = dot(c, d);
    const F64x4  low = f64x4_min(at_a, f64x4_min(at_b, at_c)), high = f64x4_max(at_a, f64x4_max(at_b, at_c));
    const F64x4  t = dot(n, a) / dot(n, d);
    const F64x4  at_m = f64x4_select(f64x4_at_most(low, t), f64x4_min(t, high), low); /* and when t is not a number */
    const F64x4  ahead = f64x4_at_most(f64x4_set(0), at_m);
    f64x4_store(v->at_m, at_m);
    v->near = f64x4_bits(f64x4_and(near, ahead));
    v->through = v->near & f64x4_bits(f64x4_at_most(f64x4_set(through_m), inside_m));
}

static void judge_patch(Verdict v[patch_most], const Packet *p, const Patch *patch, int four)
{
    const int    l = 4 * four;
    const Vector o = load3(p->o[0] + l, p->o[1] + l, p->o[2] + l), d = load3(p->d[0] + l, p->d[1] + l, p->d[2] + l);
    Vector       to[patch_corners];
    for (int c = 0; c < patch_corners; c++) to[c] = sub(set3(patch->corner[c]), o);
    judge(&v[0], to[0], to[1], to[2], d, patch->height_m[0]);
    if (patch->count < 2) return;
    judge(&v[1], to[patch->second[0]], to[patch->second[1]], to[patch->second[2]], d, patch->height_m[1]);
}

/* The lanes that Embree asks for, 1 << lane, and where each stands among its rays: they may stand in any order. */
static unsigned asked_lanes(uint8_t place[lanes], const int *valid, const uint32_t *id, unsigned n)
{
    unsigned asked = 0;
    for (unsigned first = 0; first < n; first += 8) {
        unsigned some = 0;
        if (n - first >= 8) some = f32x8_bits(_mm256_loadu_ps((const float *)valid + first));
        for (unsigned k = first; k < n && n - first < 8; k++) some |= (unsigned)(valid[k] != 0) << (k - first);
        for (; some; some &= some - 1) {
            const unsigned k = first + (unsigned)__builtin_ctz(some);
            asked |= 1u << id[k];
            place[id[k]] = (uint8_t)k;
        }
    }
    return asked;
}

static void keep_tie(Packet *p, int lane, uint32_t triangle, double at_m)
{
    if (p->ties[lane] == ties_kept) {
        p->crowded[lane] = true;
        return;
    }
    const int k = p->ties[lane]++;
    p->tie[lane][k] = triangle;
    p->tie_m[lane][k] = at_m;
}

static void bring_nearer(Packet *p, int lane, uint32_t triangle, double at_m)
{
    int kept = 0;
    p->nearest_m[lane] = at_m;
    p->nearest[lane] = triangle;
    for (int k = 0; k < p->ties[lane]; k++)
        if (p->tie_m[lane][k] <= at_m + same_range_m) {
            p->tie[lane][kept] = p->tie[lane][k];
            p->tie_m[lane][kept++] = p->tie_m[lane][k];
        }
    p->ties[lane] = kept;
}

static void offer_lowest(Packet *p, int lane, uint32_t triangle, double at_m)
{
    if (!(triangle < p->lowest[lane] && fabs(at_m - p->nearest_m[lane]) <= same_range_m)) return;
    p->lowest[lane] = triangle;
    p->lowest_m[lane] = at_m;
}

/* A triangle that a lane passes near; end_m: Embree's limit. */
static inline void offer(Packet *p, int lane, uint32_t triangle, double at_m, bool through, float *end_m)
{
    if (p->lowest_only) {
        offer_lowest(p, lane, triangle, at_m);
        return;
    }
    if (!(at_m <= p->nearest_m[lane] + same_range_m)) return;
    if (through && at_m < p->nearest_m[lane]) {
        bring_nearer(p, lane, triangle, at_m);
        const float stop_m = (float)(at_m + slack_m);
        if (stop_m < p->end_m[lane]) *end_m = p->end_m[lane] = stop_m;
    }
    keep_tie(p, lane, triangle, at_m);
}

/* A triangle that a lane passes through; end_m: Embree's limit. */
static inline void cover(Packet *p, int lane, double at_m, float *end_m)
{
    if (!(at_m < p->far_m[lane])) return;
    *end_m = -INFINITY;
    p->nearest_m[lane] = 0; /* met */
}

/* The rays that Embree asks for against a patch; its fields of n rays lie one after another (rtcore_ray.h). occludes:
 * whether anything is met is asked, not what. */
static inline void ask_patch(Packet *p, unsigned number, const int *valid, void *rays, unsigned n, bool occludes)
{
    const Patch   *patch = &p->mesh->patch[number];
    float         *end_m = (float *)rays + 8 * n;
    uint8_t        place[lanes];
    const unsigned asked = asked_lanes(place, valid, (const uint32_t *)rays + 10 * n, n);
    for (int four = 0; four < lanes / 4; four++) {
        const unsigned of = asked >> 4 * four & 15;
        Verdict        v[patch_most];
        if (of == 0) continue;
        judge_patch(v, p, patch, four);
        for (unsigned f = 0; f < patch->count; f++)
            for (unsigned left = (occludes ? v[f].through : v[f].near) & of; left; left &= left - 1) {
                const int bit = __builtin_ctz(left), lane = 4 * four + bit;
                float    *end = &end_m[place[lane]];
                if (occludes) cover(p, lane, v[f].at_m[bit], end);
                else offer(p, lane, patch->triangle + f, v[f].at_m[bit], v[f].through >> bit & 1, end);
            }
    }
}

void parts_intersect(const struct RTCIntersectFunctionNArguments *a)
{
    ask_patch((Packet *)a->context, a->primID, a->valid, a->rayhit, a->N, false);
}

void parts_occlude(const struct RTCOccludedFunctionNArguments *a)
{
    ask_patch((Packet *)a->context, a->primID, a->valid, a->ray, a->N, true);
}

/* ---- queries ------------------------------------------------------------------------------------ */

static void packet_narrow(struct RTCRay16 *ray, int valid[lanes], Packet *p)
{
    const double *centre = p->mesh->centre;
    for (int l = p->count; l < lanes; l++) { /* lanes without a ray are tested with the others, and meet nothing */
        for (int c = 0; c < 3; c++) p->o[c][l] = p->o[c][0], p->d[c][l] = p->d[c][0];
        p->length_m[l] = p->far_m[l] = p->nearest_m[l] = -INFINITY;
        p->ties[l] = 0;
    }
    for (int l = 0; l < lanes; l++) {
        ray->org_x[l] = (float)(p->o[0][l] - centre[0]);
        ray->org_y[l] = (float)(p->o[1][l] - centre[1]);
        ray->org_z[l] = (float)(p->o[2][l] - centre[2]);
        ray->dir_x[l] = (float)p->d[0][l], ray->dir_y[l] = (float)p->d[1][l], ray->dir_z[l] = (float)p->d[2][l];
        const double pass_m = p->length_m[l] * 1.001 + slack_m, far_m = p->far_m[l] + slack_m;
        p->end_m[l] = ray->tfar[l] = (float)smaller(pass_m, far_m);
        ray->tnear[l] = ray->time[l] = 0;
        ray->mask[l] = 0xFFFFFFFFu;
        ray->id[l] = (uint32_t)l;
        ray->flags[l] = 0;
        valid[l] = l < p->count ? -1 : 0;
    }
}

static struct RTCRayHit single(const struct RTCRay16 *r, int l)
{
    return (struct RTCRayHit){.ray = {.org_x = r->org_x[l],
                                      .org_y = r->org_y[l],
                                      .org_z = r->org_z[l],
                                      .dir_x = r->dir_x[l],
                                      .dir_y = r->dir_y[l],
                                      .dir_z = r->dir_z[l],
                                      .tfar = r->tfar[l],
                                      .mask = r->mask[l],
                                      .id = r->id[l]},
                              .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}}};
}

/* The lowest of the ties of a lane; its distance. */
static double settle(uint32_t *triangle, Packet *p, const struct RTCRay16 *rays, int l)
{
    const double nearest_m = p->nearest_m[l];
    p->lowest[l] = UINT32_MAX;
    if (p->crowded[l]) {
        struct RTCRayHit ray = single(rays, l);
        ray.ray.tfar = (float)(nearest_m + slack_m);
        p->lowest_only = true;
        rtcIntersect1(p->mesh->scene, &p->base, &ray);
        p->lowest_only = false;
    }
    for (int k = 0; k < p->ties[l]; k++) offer_lowest(p, l, p->tie[l][k], p->tie_m[l][k]);
    /* it is among those stored, unless the second pass found less than the first: then it is the result */
    offer_lowest(p, l, p->nearest[l], nearest_m);
    *triangle = p->lowest[l];
    return p->lowest_m[l];
}

void packet_first_hits(double *range_m, PartHit *hit, Packet *p, Chunk *chunk, int node, bool one_by_one)
{
    struct RTCRayHit16 rays;
    int                valid[lanes] __attribute__((aligned(64)));
    if (p->count == 0) return;
    packet_narrow(&rays.ray, valid, p);
    for (int l = 0; l < lanes; l++) rays.hit.geomID[l] = rays.hit.instID[0][l] = RTC_INVALID_GEOMETRY_ID;
    if (one_by_one) {
        for (int l = 0; l < p->count; l++) {
            struct RTCRayHit one = single(&rays.ray, l);
            rtcIntersect1(p->mesh->scene, &p->base, &one);
        }
    } else {
        rtcIntersect16(valid, p->mesh->scene, &p->base, &rays);
    }
    for (int l = 0; l < p->count; l++) {
        if (!(p->nearest_m[l] < INFINITY)) continue;
        uint32_t     triangle;
        const int    i = p->ray[l];
        const double at_m = settle(&triangle, p, &rays.ray, l);
        const double at_range_m = larger(0, p->start_m[l] + at_m);
        if (!(at_range_m < chunk->best_m[i])) continue;
        chunk->best_m[i] = at_range_m;
        range_m[chunk->ray[i]] = at_range_m;
        hit[chunk->ray[i]] = (PartHit){.node = node, .triangle = triangle};
    }
    p->count = 0;
}

void packet_any_hits(uint8_t *met, Packet *p, const Chunk *chunk, bool alone)
{
    struct RTCRay16 rays;
    int             valid[lanes] __attribute__((aligned(64)));
    if (p->count == 0) return;
    packet_narrow(&rays, valid, p);
    if (alone) {
        for (int l = 0; l < p->count; l++) {
            struct RTCRayHit one = single(&rays, l);
            rtcOccluded1(p->mesh->scene, &p->base, &one.ray);
        }
    } else {
        rtcOccluded16(valid, p->mesh->scene, &p->base, &rays);
    }
    for (int l = 0; l < p->count; l++) met[chunk->ray[p->ray[l]]] |= p->nearest_m[l] < INFINITY;
    p->count = 0;
}
