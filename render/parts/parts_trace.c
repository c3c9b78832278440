/* render/parts/parts_trace.c: ray-triangle intersection. Embree finds candidate triangles, in floats, by boxes round
 * them with ample margin (parts.c); each candidate is tested exactly here, in double, against the triangle itself. So
 * the result depends neither on the instruction set nor on the other rays of a packet.
 *
 * The result: the nearest triangle that the ray passes through; and of all triangles within 0.1 mm of its distance that
 * the ray passes through, or passes within 20 um, the one of the lowest index. Faces of two parts often coincide, such
 * as a tyre's and its disc's, and at an edge two always meet.
 *
 * Four rays at a time in intrinsics, as in ground8.c: the compiler does not vectorise this. */
#include "render/parts/parts_private.h"

#include "pitviper_simd.h"

enum { lanes = 16, ties_kept = 8, chunk_rays = 128 };

static const double same_edge_m = 2e-5, same_range_m = 1e-4;
static const double through_m = -1e-9; /* tolerance of the inside test: a corner leaves room for roundings between
                                        * its triangles */
static const double slack_m = 2e-3;    /* search distance beyond the nearest hit: for ties, and for Embree's floats */

static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

typedef struct Vector {
    F64x4 x, y, z;
} Vector;

static inline Vector load3(const double *x, const double *y, const double *z)
{
    return (Vector){f64x4_load(x), f64x4_load(y), f64x4_load(z)};
}
static inline Vector set3(const double p[3]) { return (Vector){f64x4_set(p[0]), f64x4_set(p[1]), f64x4_set(p[2])}; }
static inline Vector sub(Vector a, Vector b) { return (Vector){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline Vector add_scaled(Vector a, F64x4 s, Vector b)
{
    return (Vector){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static inline F64x4 dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline Vector cross(Vector a, Vector b)
{
    return (Vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/* transpose(m) a */
static inline Vector turned_back(const double m[9], Vector a)
{
    return (Vector){f64x4_set(m[0]) * a.x + f64x4_set(m[3]) * a.y + f64x4_set(m[6]) * a.z,
                    f64x4_set(m[1]) * a.x + f64x4_set(m[4]) * a.y + f64x4_set(m[7]) * a.z,
                    f64x4_set(m[2]) * a.x + f64x4_set(m[5]) * a.y + f64x4_set(m[8]) * a.z};
}

/* Clips the interval in .. out to one of a box's three slabs; a ray along it is in or out, by its sign. */
static inline void through_slab(F64x4 *in, F64x4 *out, F64x4 low, F64x4 high, F64x4 d)
{
    const F64x4 along = f64x4_less(f64x4_abs(d), f64x4_set(1e-30));
    const F64x4 per = f64x4_select(along, f64x4_set(1e30), f64x4_set(1) / d);
    const F64x4 a = low * per, b = high * per;
    *in  = f64x4_max(*in, f64x4_min(a, b));
    *out = f64x4_min(*out, f64x4_max(a, b));
}

/* ---- a node's rays ---------------------------------------------------------------------------- */

/* Rays close together, from a block's; filled up to a multiple of four. */
typedef struct Chunk {
    double o[3][chunk_rays], d[3][chunk_rays];
    double best_m[chunk_rays];  /* search limit */
    int    ray[chunk_rays];     /* of the block */
    int    count;
} __attribute__((aligned(64))) Chunk;

/* In a node's axes, each from where it enters the node's sphere. */
typedef struct NodeRays {
    double   o[3][chunk_rays], d[3][chunk_rays];
    double   start_m[chunk_rays], length_m[chunk_rays]; /* of o along the ray as given; through the sphere */
    unsigned meets[chunk_rays / 4]; /* 1 << lane in four: hits the node's sphere and box, ahead and before best_m */
} __attribute__((aligned(64))) NodeRays;

/* Ranges of values that Embree accepts: a ray that misses a node's sphere has not been checked before. */
static inline unsigned in_embree(Vector at, Vector d)
{
    static const double most = 1e18;
    const F64x4 far = f64x4_abs(at.x) + f64x4_abs(at.y) + f64x4_abs(at.z);
    return f64x4_bits(f64x4_and(f64x4_less(far, f64x4_set(most)), f64x4_less(dot(d, d), f64x4_set(2))));
}

/* A ray that misses the sphere starts at its point of closest approach. */
static void to_node(NodeRays *r, const Chunk *chunk, const PosedNode *node, bool ask_all)
{
    const NodeMesh *mesh = node->mesh;
    const Vector    centre = set3(mesh->centre), half = set3(mesh->half);
    const F64x4      zero = f64x4_set(0), radius_m = f64x4_set(mesh->radius_m);
    for (int i = 0; i < chunk->count; i += 4) {
        const Vector from = sub(load3(chunk->o[0] + i, chunk->o[1] + i, chunk->o[2] + i), set3(node->p_enu));
        const Vector o = turned_back(node->r_enu_from_node, from);
        const Vector d = turned_back(node->r_enu_from_node, load3(chunk->d[0] + i, chunk->d[1] + i, chunk->d[2] + i));
        const Vector m = sub(centre, o);
        const F64x4   along = dot(m, d);
        const Vector across = add_scaled(m, -along, d); /* not |m|^2 - along^2, which cancels from afar */
        const F64x4   left = radius_m * radius_m - dot(across, across);
        const F64x4   half_m = f64x4_sqrt(f64x4_max(left, zero));
        const F64x4   start_m = f64x4_max(along - half_m, zero), length_m = along + half_m - start_m;
        const Vector at = add_scaled(o, start_m, d), middle = sub(centre, at);
        F64x4         in = zero, out = f64x4_set(INFINITY);
        through_slab(&in, &out, middle.x - half.x, middle.x + half.x, d.x);
        through_slab(&in, &out, middle.y - half.y, middle.y + half.y, d.y);
        through_slab(&in, &out, middle.z - half.z, middle.z + half.z, d.z);
        f64x4_store(r->o[0] + i, at.x), f64x4_store(r->o[1] + i, at.y), f64x4_store(r->o[2] + i, at.z);
        f64x4_store(r->d[0] + i, d.x), f64x4_store(r->d[1] + i, d.y), f64x4_store(r->d[2] + i, d.z);
        f64x4_store(r->start_m + i, start_m);
        f64x4_store(r->length_m + i, ask_all ? f64x4_max(length_m, radius_m) : length_m);
        const F64x4 meets = f64x4_and(f64x4_and(f64x4_less(zero, left), f64x4_less(zero, length_m)),
                                f64x4_and(f64x4_less(start_m, f64x4_load(chunk->best_m + i)), f64x4_at_most(in, out)));
        r->meets[i / 4] = ask_all ? in_embree(at, d) : f64x4_bits(meets);
    }
}

/* What a chunk's rays have in common: a common origin, or a common direction. */
typedef struct Bundle {
    double origin[3], radius_m; /* all begin in this sphere */
    double axis[3], sine, cosine; /* and stay within this angle; cosine 0: nothing in common */
} Bundle;

static Bundle bundle_of(const Chunk *chunk)
{
    Bundle b = {.cosine = 1};
    bool   one_point = true, one_way = true;
    for (int i = 1; i < chunk->count; i++)
        for (int c = 0; c < 3; c++) {
            one_point &= chunk->o[c][i] == chunk->o[c][0];
            one_way &= chunk->d[c][i] == chunk->d[c][0];
        }
    for (int i = 0; i < chunk->count; i++)
        for (int c = 0; c < 3; c++) {
            b.origin[c] += chunk->o[c][i] / chunk->count;
            b.axis[c] += chunk->d[c][i];
        }
    if ((!one_point && !one_way) || !v3_normalize(b.axis, b.axis)) return (Bundle){.cosine = 0};
    double farthest = 0;
    for (int i = 0; i < chunk->count; i++) {
        double from[3], square = 0, cosine = 0;
        for (int c = 0; c < 3; c++) {
            from[c] = chunk->o[c][i] - b.origin[c];
            square += from[c] * from[c];
            cosine += chunk->d[c][i] * b.axis[c];
        }
        farthest = larger(farthest, square);
        b.cosine = smaller(b.cosine, cosine);
    }
    b.radius_m = sqrt(farthest);
    b.cosine -= 1e-12; /* a rounding of 1 - cosine is 1e-6 rad */
    b.sine = sqrt(1 - b.cosine * b.cosine);
    if (one_way) b.sine = 0, b.cosine = 1;
    return b;
}

/* The sphere's centre may be no farther from the cone's side than this: across * cosine - along * sine <= reach_m. */
static inline bool bundle_may_meet(const Bundle *b, const PosedNode *node)
{
    if (!(b->cosine > 0)) return true;
    const double x = node->centre_enu[0] - b->origin[0], y = node->centre_enu[1] - b->origin[1];
    const double z = node->centre_enu[2] - b->origin[2];
    const double along = x * b->axis[0] + y * b->axis[1] + z * b->axis[2];
    const double ax = x - along * b->axis[0], ay = y - along * b->axis[1], az = z - along * b->axis[2];
    const double reach_m = (node->mesh->radius_m + b->radius_m) * (1 + 1e-9) + 1e-6 + 1e-9 * fabs(along);
    const double most = reach_m + along * b->sine;
    return most >= 0 && (ax * ax + ay * ay + az * az) * (b->cosine * b->cosine) <= most * most;
}

/* ---- candidates and the exact test ------------------------------------------------------------ */

/* Rays of a node side by side, and their results. */
typedef struct Packet {
    struct RTCIntersectContext base; /* first: Embree passes it to the callback */
    const NodeMesh *mesh;
    bool     lowest_only;         /* second pass, collects into `lowest`: nearest_m is known */
    int      count;
    double   o[3][lanes] __attribute__((aligned(64))), d[3][lanes];
    double   start_m[lanes], length_m[lanes];
    double   far_m[lanes];        /* search limit */
    double   nearest_m[lanes];    /* of those passed through */
    float    end_m[lanes];        /* Embree's limit */
    int      ties[lanes];
    bool     crowded[lanes];      /* more than were stored */
    uint32_t tie[lanes][ties_kept]; /* of the node, at nearest_m and somewhat beyond */
    double   tie_m[lanes][ties_kept];
    uint32_t lowest[lanes];
    double   lowest_m[lanes];
    uint32_t nearest[lanes];      /* the triangle at nearest_m; of equals any */
    int      ray[lanes];          /* of the chunk */
} __attribute__((aligned(64))) Packet;

/* For four lanes at a time, as requested. */
typedef struct Verdict {
    double   at_m[lanes];   /* where near: distance to the plane, clamped between the corners: edge-on it is
                             * undefined */
    unsigned judged;        /* 1 << lane / 4 */
    unsigned near[lanes / 4], through[lanes / 4]; /* 1 << lane % 4: passed by within same_edge_m, ahead; and through */
} __attribute__((aligned(64))) Verdict;

/* Neighbours compute the same number with the opposite sign for their common side, whatever the rounding, so no ray
 * passes between them. */
static void judge(Verdict *v, const Packet *p, const Facet *facet, int four)
{
    const int    l = 4 * four;
    const Vector o = load3(p->o[0] + l, p->o[1] + l, p->o[2] + l), d = load3(p->d[0] + l, p->d[1] + l, p->d[2] + l);
    const Vector a = sub(set3(facet->corner[0]), o), b = sub(set3(facet->corner[1]), o), c = sub(set3(facet->corner[2]), o);
    const F64x4   ab = dot(cross(a, b), d), bc = dot(cross(b, c), d), ca = dot(cross(c, a), d);
    const F64x4   whole = ab + bc + ca, share = f64x4_set(1) / whole;
    const F64x4   inside_m = f64x4_min(ab * share * f64x4_set((double)facet->height_m[0]),
                                     f64x4_min(bc * share * f64x4_set((double)facet->height_m[1]),
                                              ca * share * f64x4_set((double)facet->height_m[2])));
    const F64x4   seen = _mm256_cmp_pd(whole, f64x4_set(0), _CMP_NEQ_OQ); /* not edge-on */
    const F64x4   near = f64x4_and(seen, f64x4_at_most(f64x4_set(-same_edge_m), inside_m));
    v->judged |= 1u << four;
    v->near[four] = f64x4_bits(near);
    if (v->near[four] == 0) return;
    const Vector n = cross(sub(b, a), sub(c, a));
    const F64x4   at_a = dot(a, d), at_b = dot(b, d), at_c = dot(c, d);
    const F64x4   low = f64x4_min(at_a, f64x4_min(at_b, at_c)), high = f64x4_max(at_a, f64x4_max(at_b, at_c));
    const F64x4   t = dot(n, a) / dot(n, d);
    const F64x4   at_m = f64x4_select(f64x4_at_most(low, t), f64x4_min(t, high), low); /* and when t is not a number */
    const F64x4   ahead = f64x4_at_most(f64x4_set(0), at_m);
    f64x4_store(v->at_m + l, at_m);
    v->near[four]    = f64x4_bits(f64x4_and(near, ahead));
    v->through[four] = v->near[four] & f64x4_bits(f64x4_at_most(f64x4_set(through_m), inside_m));
}

static void keep_tie(Packet *p, int lane, uint32_t triangle, double at_m)
{
    if (p->ties[lane] == ties_kept) {
        p->crowded[lane] = true;
        return;
    }
    const int k = p->ties[lane]++;
    p->tie[lane][k]   = triangle;
    p->tie_m[lane][k] = at_m;
}

static void bring_nearer(Packet *p, int lane, uint32_t triangle, double at_m)
{
    int kept = 0;
    p->nearest_m[lane] = at_m;
    p->nearest[lane]   = triangle;
    for (int k = 0; k < p->ties[lane]; k++)
        if (p->tie_m[lane][k] <= at_m + same_range_m) {
            p->tie[lane][kept]     = p->tie[lane][k];
            p->tie_m[lane][kept++] = p->tie_m[lane][k];
        }
    p->ties[lane] = kept;
}

static void offer_lowest(Packet *p, int lane, uint32_t triangle, double at_m)
{
    if (!(triangle < p->lowest[lane] && fabs(at_m - p->nearest_m[lane]) <= same_range_m)) return;
    p->lowest[lane]   = triangle;
    p->lowest_m[lane] = at_m;
}

/* Fields of N rays lie one after another (rtcore_ray.h), and they may stand in any order. */
void parts_intersect(const struct RTCIntersectFunctionNArguments *a)
{
    Packet         *p = (Packet *)a->context;
    const unsigned  n = a->N;
    float          *end_m = (float *)a->rayhit + 8 * n;
    const uint32_t *id = (const uint32_t *)a->rayhit + 10 * n;
    Verdict         v;
    v.judged = 0;
    for (unsigned k = 0; k < n; k++) {
        if (!a->valid[k]) continue;
        const int lane = (int)id[k], four = lane / 4, bit = lane % 4;
        if (!(v.judged >> four & 1)) judge(&v, p, &p->mesh->facet[a->primID], four);
        if (!(v.near[four] >> bit & 1)) continue;
        const double at_m = v.at_m[lane];
        if (p->lowest_only) {
            offer_lowest(p, lane, a->primID, at_m);
            continue;
        }
        if (!(at_m <= p->nearest_m[lane] + same_range_m)) continue;
        if (v.through[four] >> bit & 1 && at_m < p->nearest_m[lane]) {
            bring_nearer(p, lane, a->primID, at_m);
            const float stop_m = (float)(at_m + slack_m);
            if (stop_m < p->end_m[lane]) end_m[k] = p->end_m[lane] = stop_m;
        }
        keep_tie(p, lane, a->primID, at_m);
    }
}

void parts_occlude(const struct RTCOccludedFunctionNArguments *a)
{
    Packet         *p = (Packet *)a->context;
    const unsigned  n = a->N;
    float          *end_m = (float *)a->ray + 8 * n;
    const uint32_t *id = (const uint32_t *)a->ray + 10 * n;
    Verdict         v;
    v.judged = 0;
    for (unsigned k = 0; k < n; k++) {
        if (!a->valid[k]) continue;
        const int lane = (int)id[k], four = lane / 4;
        if (!(v.judged >> four & 1)) judge(&v, p, &p->mesh->facet[a->primID], four);
        if (!(v.near[four] & v.through[four] & 1u << lane % 4 && v.at_m[lane] < p->far_m[lane])) continue;
        end_m[k]            = -INFINITY;
        p->nearest_m[lane] = 0; /* met */
    }
}

/* ---- queries ------------------------------------------------------------------------------------ */

static void packet_open(Packet *p, const NodeMesh *mesh)
{
    rtcInitIntersectContext(&p->base); /* never COHERENT: rtcOccluded16 of 3.13 may then not return under AVX-512 */
    p->mesh        = mesh;
    p->lowest_only = false;
    p->count       = 0;
}

static inline void packet_add(Packet *p, const NodeRays *r, int i, double best_m)
{
    const int l = p->count++;
    for (int c = 0; c < 3; c++) {
        p->o[c][l] = r->o[c][i];
        p->d[c][l] = r->d[c][i];
    }
    p->start_m[l]   = r->start_m[i];
    p->length_m[l]  = r->length_m[i];
    p->far_m[l]     = best_m - r->start_m[i];
    p->nearest_m[l] = INFINITY;
    p->ties[l]      = 0;
    p->crowded[l]   = false;
    p->ray[l]       = i;
}

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
        p->end_m[l]   = ray->tfar[l] = (float)smaller(pass_m, far_m);
        ray->tnear[l] = ray->time[l] = 0;
        ray->mask[l]  = 0xFFFFFFFFu;
        ray->id[l]    = (uint32_t)l;
        ray->flags[l] = 0;
        valid[l]      = l < p->count ? -1 : 0;
    }
}

static struct RTCRayHit single(const struct RTCRay16 *r, int l)
{
    return (struct RTCRayHit){.ray = {.org_x = r->org_x[l], .org_y = r->org_y[l], .org_z = r->org_z[l],
                                      .dir_x = r->dir_x[l], .dir_y = r->dir_y[l], .dir_z = r->dir_z[l],
                                      .tfar = r->tfar[l], .mask = r->mask[l], .id = r->id[l]},
                              .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}}};
}

/* The lowest of the ties of a lane; its distance. */
static double settle(uint32_t *triangle, Packet *p, const struct RTCRay16 *rays, int l)
{
    const double nearest_m = p->nearest_m[l];
    p->lowest[l] = UINT32_MAX;
    if (p->crowded[l]) {
        struct RTCRayHit ray = single(rays, l);
        ray.ray.tfar   = (float)(nearest_m + slack_m);
        p->lowest_only = true;
        rtcIntersect1(p->mesh->scene, &p->base, &ray);
        p->lowest_only = false;
    }
    for (int k = 0; k < p->ties[l]; k++) offer_lowest(p, l, p->tie[l][k], p->tie_m[l][k]);
    /* it is among those stored, unless the second pass found less than the first: then it is the result */
    offer_lowest(p, l, p->nearest[l], nearest_m);
    *triangle = p->mesh->triangle[p->lowest[l]];
    return p->lowest_m[l];
}

static void packet_first_hits(double *range_m, PartHit *hit, Packet *p, Chunk *chunk, int node, bool alone)
{
    struct RTCRayHit16 rays;
    int                valid[lanes] __attribute__((aligned(64)));
    if (p->count == 0) return;
    packet_narrow(&rays.ray, valid, p);
    for (int l = 0; l < lanes; l++) rays.hit.geomID[l] = rays.hit.instID[0][l] = RTC_INVALID_GEOMETRY_ID;
    if (alone) {
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
        chunk->best_m[i]       = at_range_m;
        range_m[chunk->ray[i]] = at_range_m;
        hit[chunk->ray[i]]     = (PartHit){.node = node, .triangle = triangle};
    }
    p->count = 0;
}

static void packet_any_hits(uint8_t *met, Packet *p, const Chunk *chunk, bool alone)
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

/* ---- a block's rays ------------------------------------------------------------------------------ */

/* Lanes without a ray repeat the last one. */
static void fill_up(Chunk *chunk)
{
    for (int i = chunk->count; i % 4; i++) {
        for (int c = 0; c < 3; c++) {
            chunk->o[c][i] = chunk->o[c][chunk->count - 1];
            chunk->d[c][i] = chunk->d[c][chunk->count - 1];
        }
        chunk->best_m[i] = 0;
    }
}

/* Ray `from` of a chunk becomes its ray `to`, not behind it. */
static void keep_ray(Chunk *chunk, int to, int from)
{
    for (int c = 0; c < 3; c++) {
        chunk->o[c][to] = chunk->o[c][from];
        chunk->d[c][to] = chunk->d[c][from];
    }
    chunk->best_m[to] = chunk->best_m[from];
    chunk->ray[to]    = chunk->ray[from];
}

/* The rays of the list that may meet the entity's box ahead: one test that saves most rays a test of every node. */
static void take_chunk(Chunk *chunk, const PosedEntity *entity, const double *const o[3], const double *const d[3],
                       const double *far_m, const int *list, int count, bool ask_all)
{
    for (int i = 0; i < count; i++) {
        const int k = list[i];
        for (int c = 0; c < 3; c++) {
            chunk->o[c][i] = o[c][k];
            chunk->d[c][i] = d[c][k];
        }
        chunk->best_m[i] = far_m[k];
        chunk->ray[i]    = k;
    }
    chunk->count = count;
    fill_up(chunk);
    if (ask_all) return;
    const Vector low = set3(entity->box_low), high = set3(entity->box_high);
    int          kept = 0;
    for (int i = 0; i < count; i += 4) {
        const Vector at = load3(chunk->o[0] + i, chunk->o[1] + i, chunk->o[2] + i);
        const Vector from = turned_back(entity->r_enu_from_body, sub(at, set3(entity->p_enu)));
        const Vector way = load3(chunk->d[0] + i, chunk->d[1] + i, chunk->d[2] + i);
        const Vector along = turned_back(entity->r_enu_from_body, way);
        F64x4         in = f64x4_set(0), out = f64x4_set(INFINITY);
        through_slab(&in, &out, low.x - from.x, high.x - from.x, along.x);
        through_slab(&in, &out, low.y - from.y, high.y - from.y, along.y);
        through_slab(&in, &out, low.z - from.z, high.z - from.z, along.z);
        const unsigned meets =
            f64x4_bits(f64x4_and(f64x4_at_most(in, out), f64x4_less(in, f64x4_load(chunk->best_m + i))));
        for (int j = i; j < i + 4 && j < count && meets; j++) {
            if (!(meets >> (j - i) & 1)) continue;
            keep_ray(chunk, kept++, j);
        }
    }
    chunk->count = kept;
    if (kept > 0) fill_up(chunk);
}

static uint64_t first_hits(double *range_m, PartHit *hit, const PosedEntity *entity, const double *const o[3],
                       const double *const d[3], const double *far_m, const int *list, int count, bool ask_all, bool alone)
{
    Chunk    chunk;
    NodeRays rays;
    Packet   packet;
    uint64_t asked = 0;
    for (int first = 0; first < count; first += chunk_rays) {
        take_chunk(&chunk, entity, o, d, far_m, list + first, count - first < chunk_rays ? count - first : chunk_rays,
                   ask_all);
        if (chunk.count == 0) continue;
        const Bundle bundle = ask_all || entity->node_count == 1 ? (Bundle){.cosine = 0} : bundle_of(&chunk);
        for (int k = 0; k < entity->node_count; k++) {
            const PosedNode *node = &entity->node[k];
            if (!bundle_may_meet(&bundle, node)) continue;
            to_node(&rays, &chunk, node, ask_all);
            packet_open(&packet, node->mesh);
            for (int i = 0; i < chunk.count; i++) {
                if (!(rays.meets[i / 4] >> i % 4 & 1)) continue;
                packet_add(&packet, &rays, i, chunk.best_m[i]);
                asked++;
                if (packet.count == lanes) packet_first_hits(range_m, hit, &packet, &chunk, k, alone);
            }
            packet_first_hits(range_m, hit, &packet, &chunk, k, alone);
        }
    }
    return asked;
}

/* Leaves out the rays that have met something. */
static void drop_met(Chunk *chunk, const uint8_t *met)
{
    int kept = 0;
    for (int i = 0; i < chunk->count; i++) {
        if (met[chunk->ray[i]]) continue;
        keep_ray(chunk, kept++, i);
    }
    chunk->count = kept;
    if (kept > 0) fill_up(chunk);
}

/* The largest node is the first: most rays that meet anything meet that, and are asked no more. */
static uint64_t any_hits(uint8_t *met, const PosedEntity *entity, const double *const o[3], const double *const d[3],
                     const double *far_m, const int *list, int count, bool ask_all, bool alone)
{
    Chunk     chunk;
    NodeRays  rays;
    Packet    packet;
    uint64_t  asked = 0;
    const int largest = parts_largest_node(entity);
    for (int first = 0; first < count; first += chunk_rays) {
        take_chunk(&chunk, entity, o, d, far_m, list + first, count - first < chunk_rays ? count - first : chunk_rays,
                   ask_all);
        if (!ask_all) drop_met(&chunk, met);
        if (chunk.count == 0) continue;
        const Bundle bundle = ask_all || entity->node_count == 1 ? (Bundle){.cosine = 0} : bundle_of(&chunk);
        for (int n = 0; n < entity->node_count && chunk.count > 0; n++) {
            const PosedNode *node = &entity->node[n == 0 ? largest : n <= largest ? n - 1 : n];
            const uint64_t   before = asked;
            if (!bundle_may_meet(&bundle, node)) continue;
            to_node(&rays, &chunk, node, ask_all);
            packet_open(&packet, node->mesh);
            for (int i = 0; i < chunk.count; i++) {
                if (!(rays.meets[i / 4] >> i % 4 & 1)) continue;
                packet_add(&packet, &rays, i, chunk.best_m[i]);
                asked++;
                if (packet.count == lanes) packet_any_hits(met, &packet, &chunk, alone);
            }
            packet_any_hits(met, &packet, &chunk, alone);
            if (!ask_all && asked > before) drop_met(&chunk, met);
        }
    }
    return asked;
}

uint64_t parts_first_hits(double *range_m, PartHit *hit, const PosedEntity *entity, const double *const o_enu[3],
                      const double *const d_enu[3], const double *far_m, const int *list, int count, bool ask_all)
{
    return first_hits(range_m, hit, entity, o_enu, d_enu, far_m, list, count, ask_all, false);
}

uint64_t parts_any_hits(uint8_t *met, const PosedEntity *entity, const double *const o_enu[3], const double *const d_enu[3],
                    const double *far_m, const int *list, int count, bool ask_all)
{
    return any_hits(met, entity, o_enu, d_enu, far_m, list, count, ask_all, false);
}

double parts_first_hit(PartHit *hit, const PosedEntity *entity, const double o_enu[3], const double d_enu[3],
                       double far_m, bool ask_all)
{
    const double *const o[3] = {&o_enu[0], &o_enu[1], &o_enu[2]}, *const d[3] = {&d_enu[0], &d_enu[1], &d_enu[2]};
    const int           list[1] = {0};
    double              range_m = INFINITY;
    first_hits(&range_m, hit, entity, o, d, &far_m, list, 1, ask_all, true);
    return range_m;
}

bool parts_occluded(const PosedEntity *entity, const double o_enu[3], const double d_enu[3], bool ask_all)
{
    const double *const o[3] = {&o_enu[0], &o_enu[1], &o_enu[2]}, *const d[3] = {&d_enu[0], &d_enu[1], &d_enu[2]};
    const double        far_m = INFINITY;
    const int           list[1] = {0};
    uint8_t             met = 0;
    any_hits(&met, entity, o, d, &far_m, list, 1, ask_all, true);
    return met != 0;
}
