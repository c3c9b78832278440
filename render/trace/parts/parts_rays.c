/* render/trace/parts/parts_rays.c: a block's rays against an entity: which nodes each may meet, and the normals of
 * what it met, of the triangle's plane and of the curved surface that the triangle approximates. */
#include "render/trace/parts/parts_packet_private.h"

/* Clips the interval in .. out to one of a box's three slabs; a ray along it is in or out, by its sign. */
static inline void through_slab(F64x4 *in, F64x4 *out, F64x4 low, F64x4 high, F64x4 d)
{
    const F64x4 along = f64x4_less(f64x4_abs(d), f64x4_set(1e-30));
    const F64x4 per = f64x4_select(along, f64x4_set(1e30), f64x4_set(1) / d);
    const F64x4 a = low * per, b = high * per;
    *in = f64x4_max(*in, f64x4_min(a, b));
    *out = f64x4_min(*out, f64x4_max(a, b));
}

/* ---- a node's rays ---------------------------------------------------------------------------- */

/* Ranges of values that Embree accepts: a ray that misses a node's sphere has not been checked before. */
static inline unsigned in_embree(Vector at, Vector d)
{
    static const double most = 1e18;
    const F64x4         far = f64x4_abs(at.x) + f64x4_abs(at.y) + f64x4_abs(at.z);
    return f64x4_bits(f64x4_and(f64x4_less(far, f64x4_set(most)), f64x4_less(dot(d, d), f64x4_set(2))));
}

/* A ray that misses the sphere starts at its point of closest approach. */
static void to_node(NodeRays *r, const Chunk *chunk, const PosedNode *node, bool ask_all)
{
    const NodeMesh *mesh = node->mesh;
    const Vector    centre = set3(mesh->centre), half = set3(mesh->half);
    const F64x4     zero = f64x4_set(0), radius_m = f64x4_set(mesh->radius_m);
    for (int i = 0; i < chunk->count; i += 4) {
        const Vector from = sub(load3(chunk->o[0] + i, chunk->o[1] + i, chunk->o[2] + i), set3(node->p_enu));
        const Vector o = turned_back(node->r_enu_from_node, from);
        const Vector d = turned_back(node->r_enu_from_node, load3(chunk->d[0] + i, chunk->d[1] + i, chunk->d[2] + i));
        const Vector m = sub(centre, o);
        const F64x4  along = dot(m, d);
        const Vector across = add_scaled(m, -along, d); /* not |m|^2 - along^2, which cancels from afar */
        const F64x4  left = radius_m * radius_m - dot(across, across);
        const F64x4  half_m = f64x4_sqrt(f64x4_max(left, zero));
        const F64x4  start_m = f64x4_max(along - half_m, zero), length_m = along + half_m - start_m;
        const Vector at = add_scaled(o, start_m, d), middle = sub(centre, at);
        F64x4        in = zero, out = f64x4_set(INFINITY);
        through_slab(&in, &out, middle.x - half.x, middle.x + half.x, d.x);
        through_slab(&in, &out, middle.y - half.y, middle.y + half.y, d.y);
        through_slab(&in, &out, middle.z - half.z, middle.z + half.z, d.z);
        f64x4_store(r->o[0] + i, at.x), f64x4_store(r->o[1] + i, at.y), f64x4_store(r->o[2] + i, at.z);
        f64x4_store(r->d[0] + i, d.x), f64x4_store(r->d[1] + i, d.y), f64x4_store(r->d[2] + i, d.z);
        f64x4_store(r->start_m + i, start_m);
        f64x4_store(r->length_m + i, ask_all ? f64x4_max(length_m, radius_m) : length_m);
        const F64x4 meets =
            f64x4_and(f64x4_and(f64x4_less(zero, left), f64x4_less(zero, length_m)),
                      f64x4_and(f64x4_less(start_m + in, f64x4_load(chunk->best_m + i)), f64x4_at_most(in, out)));
        r->meets[i / 4] = ask_all ? in_embree(at, d) : f64x4_bits(meets);
    }
}

/* What a chunk's rays have in common: a common origin, or a common direction. */
typedef struct Bundle {
    double origin[3], radius_m;   /* all begin in this sphere */
    double axis[3], sine, cosine; /* and stay within this angle; cosine 0: nothing in common */
} Bundle;

/* Whether its rays leave one point, or go one way. */
static void alike(bool *one_point, bool *one_way, const Chunk *chunk)
{
    F64x4 point = f64x4_set(0), way = point; /* bits that differ; lanes without a ray repeat the last one */
    for (int c = 0; c < 3; c++) {
        const F64x4 o = f64x4_set(chunk->o[c][0]), d = f64x4_set(chunk->d[c][0]);
        for (int i = 0; i < chunk->count; i += 4) {
            point = f64x4_or(point, f64x4_differ(f64x4_load(chunk->o[c] + i), o));
            way = f64x4_or(way, f64x4_differ(f64x4_load(chunk->d[c] + i), d));
        }
    }
    *one_point = f64x4_bits(point) == 0;
    *one_way = f64x4_bits(way) == 0;
}

static Bundle bundle_of(const Chunk *chunk)
{
    Bundle b = {.cosine = 1};
    bool   one_point, one_way;
    alike(&one_point, &one_way, chunk);
    if (!one_point && !one_way) return (Bundle){.cosine = 0};
    for (int i = 0; i < chunk->count; i++)
        for (int c = 0; c < 3; c++) {
            b.origin[c] += chunk->o[c][i] / chunk->count;
            b.axis[c] += chunk->d[c][i];
        }
    if (!v3_normalize(b.axis, b.axis)) return (Bundle){.cosine = 0};
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
    chunk->ray[to] = chunk->ray[from];
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
        chunk->ray[i] = k;
    }
    chunk->count = count;
    fill_up(chunk);
    if (ask_all || entity->node_count == 1) return; /* the node's box is much the same */
    const Vector low = set3(entity->box_low), high = set3(entity->box_high);
    int          kept = 0;
    for (int i = 0; i < count; i += 4) {
        const Vector at = load3(chunk->o[0] + i, chunk->o[1] + i, chunk->o[2] + i);
        const Vector from = turned_back(entity->r_enu_from_body, sub(at, set3(entity->p_enu)));
        const Vector way = load3(chunk->d[0] + i, chunk->d[1] + i, chunk->d[2] + i);
        const Vector along = turned_back(entity->r_enu_from_body, way);
        F64x4        in = f64x4_set(0), out = f64x4_set(INFINITY);
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
                           const double *const d[3], const double *far_m, const int *list, int count, bool ask_all,
                           bool alone)
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
        bool         one_point = true, one_way = true;
        if (!ask_all && !(bundle.cosine > 0)) alike(&one_point, &one_way, &chunk);
        /* rays with nothing in common take separate ways through a node's tree: one by one they cost less */
        const bool one_by_one = alone || !(one_point || one_way);
        for (int k = 0; k < entity->node_count; k++) {
            const PosedNode *node = &entity->node[k];
            if (entity->node_count > 1 && !bundle_may_meet(&bundle, node)) continue;
            to_node(&rays, &chunk, node, ask_all);
            packet_open(&packet, node->mesh);
            for (int i = 0; i < chunk.count; i++) {
                if (!(rays.meets[i / 4] >> i % 4 & 1)) continue;
                packet_add(&packet, &rays, i, chunk.best_m[i]);
                asked++;
                if (packet.count == lanes) packet_first_hits(range_m, hit, &packet, &chunk, k, one_by_one);
            }
            packet_first_hits(range_m, hit, &packet, &chunk, k, one_by_one);
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

uint64_t parts_any_hits(uint8_t *met, const PosedEntity *entity, const double *const o_enu[3],
                        const double *const d_enu[3], const double *far_m, const int *list, int count, bool ask_all)
{
    return any_hits(met, entity, o_enu, d_enu, far_m, list, count, ask_all, false);
}

double parts_first_hit(PartHit *hit, const PosedEntity *entity, const double o_enu[3], const double d_enu[3],
                       double far_m, bool ask_all)
{
    const double *const o[3] = {&o_enu[0], &o_enu[1], &o_enu[2]}, *const d[3] = {&d_enu[0], &d_enu[1], &d_enu[2]};
    const int list[1] = {0};
    double    range_m = INFINITY;
    first_hits(&range_m, hit, entity, o, d, &far_m, list, 1, ask_all, true);
    return range_m;
}

bool parts_occluded(const PosedEntity *entity, const double o_enu[3], const double d_enu[3], bool ask_all)
{
    const double *const o[3] = {&o_enu[0], &o_enu[1], &o_enu[2]}, *const d[3] = {&d_enu[0], &d_enu[1], &d_enu[2]};
    const double far_m = INFINITY;
    const int    list[1] = {0};
    uint8_t      met = 0;
    any_hits(&met, entity, o, d, &far_m, list, 1, ask_all, true);
    return met != 0;
}

/* ---- normals -------------------------------------------------------------------------------------- */

void parts_facet(PosedFacet *facet, const Model *model, const PosedEntity *entity, const PartHit *hit)
{
    const PosedNode *node = &entity->node[hit->node];
    const uint32_t  *index = model->triangle[hit->triangle];
    const float     *normal[3] = {model->normal[index[0]], model->normal[index[1]], model->normal[index[2]]};
    double           shading[3];
    facet->node = node;
    facet->triangle = hit->triangle;
    v3_scale(facet->corner, 1, model->vertex[index[0]]);
    v3_sub(facet->ab, model->vertex[index[1]], facet->corner);
    v3_sub(facet->ac, model->vertex[index[2]], facet->corner);
    v3_cross(facet->n, facet->ab, facet->ac);
    facet->area2 = v3_dot(facet->n, facet->n);
    m3_mul_v3(facet->geo_enu, node->r_enu_from_node, facet->n);
    if (!v3_normalize(facet->geo_enu, facet->geo_enu)) memset(facet->geo_enu, 0, sizeof facet->geo_enu);
    for (int c = 0; c < 3; c++) shading[c] = normal[0][c];
    m3_mul_v3(facet->even_enu, node->r_enu_from_node, shading);
    facet->even = v3_normalize(facet->even_enu, facet->even_enu);
    for (int c = 0; c < 3; c++) facet->even &= normal[0][c] == normal[1][c] && normal[0][c] == normal[2][c];
}

/* Shading normal at a point of the facet. False: none. */
static bool interpolate(double n_enu[3], const Model *model, const PosedFacet *facet, const double o_enu[3],
                        const double d_enu[3], double range_m)
{
    const PosedNode *node = facet->node;
    const uint32_t  *index = model->triangle[facet->triangle];
    double           at_enu[3], at[3], w[3], cross[3], shading[3] = {0, 0, 0};
    /* barycentric weights of the point on the plane; just outside the triangle they are clamped to it */
    for (int c = 0; c < 3; c++) at_enu[c] = o_enu[c] + range_m * d_enu[c] - node->p_enu[c];
    m3_tmul_v3(at, node->r_enu_from_node, at_enu);
    v3_sub(at, at, facet->corner);
    v3_cross(cross, at, facet->ac);
    w[1] = clamp(v3_dot(cross, facet->n) / facet->area2, 0, 1);
    v3_cross(cross, facet->ab, at);
    w[2] = clamp(v3_dot(cross, facet->n) / facet->area2, 0, 1);
    w[0] = 1 - w[1] - w[2] < 0 ? 0 : 1 - w[1] - w[2];
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) shading[c] += w[k] * model->normal[index[k]][c];
    m3_mul_v3(n_enu, node->r_enu_from_node, shading);
    return v3_normalize(n_enu, n_enu);
}

void parts_facet_normals(double n_geo[3], double n_enu[3], const Model *model, const PosedFacet *facet,
                         const double o_enu[3], const double d_enu[3], double range_m)
{
    const bool some = facet->geo_enu[0] != 0 || facet->geo_enu[1] != 0 || facet->geo_enu[2] != 0;
    v3_scale(n_geo, some ? 1 : -1, some ? facet->geo_enu : d_enu);
    if (facet->even) v3_scale(n_enu, 1, facet->even_enu);
    else if (!interpolate(n_enu, model, facet, o_enu, d_enu, range_m)) v3_scale(n_enu, 1, n_geo);
    if (v3_dot(n_geo, d_enu) > 0) {
        v3_scale(n_geo, -1, n_geo);
        v3_scale(n_enu, -1, n_enu);
    }
}

void parts_normals(double n_geo[3], double n_enu[3], const Model *model, const PosedEntity *entity, const PartHit *hit,
                   const double o_enu[3], const double d_enu[3], double range_m)
{
    PosedFacet facet;
    parts_facet(&facet, model, entity, hit);
    parts_facet_normals(n_geo, n_enu, model, &facet, o_enu, d_enu, range_m);
}
