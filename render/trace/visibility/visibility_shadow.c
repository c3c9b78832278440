/* render/trace/visibility/visibility_shadow.c: which hits lie in the shadow of entities, of the ground and of plants.
 */
#include "render/trace/visibility/visibility_private.h"

#include "pitviper_simd.h"

/* A sphere round the origins of a block's sun rays. */
static double bound_points(double centre[3], int count, const double *const p[3])
{
    double square = 0;
    for (int c = 0; c < 3; c++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < count; i++) {
            low = p[c][i] < low ? p[c][i] : low;
            high = p[c][i] > high ? p[c][i] : high;
        }
        centre[c] = 0.5 * (low + high);
        square += 0.25 * (high - low) * (high - low);
    }
    return sqrt(square) * (1 + 1e-9) + 1e-6;
}

/* Whether a ray along d from within a sphere can meet another. */
static bool sphere_may_shadow(const PosedEntity *entity, const double centre[3], double radius_m, const double d[3])
{
    double       m[3], across[3];
    const double reach_m = radius_m + entity->radius_m;
    v3_sub(m, entity->centre_enu, centre);
    const double along = v3_dot(m, d);
    v3_add_scaled(across, m, -along, d);
    return along > -reach_m && v3_dot(across, across) < reach_m * reach_m;
}

/* ask: the sun rays from neighbouring hits that the ground might block. */
static void leave_out_clear(uint8_t *ask, const Visibility *v, int count, const double *const o[3], const uint8_t *dark,
                            const double d_enu[3])
{
    for (int first = 0; first < count; first += clear_rays) {
        const int end = first + clear_rays < count ? first + clear_rays : count;
        double    box[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
        bool      any = false;
        for (int i = first; i < end; i++) {
            const double p[3] = {o[0][i], o[1][i], o[2][i]};
            if (dark[i]) continue;
            grow_box(box, p);
            any = true;
        }
        memset(ask + first, any && !ground_is_clear_towards(&v->ground, box, d_enu), (size_t)(end - first));
    }
}

/* Where a ray from a hit towards d_enu starts; false: the surface faces away. */
static bool leave_hit(double start[3], const Visibility *v, const Hits *hits, int i, const double d_enu[3])
{
    static const double offset_m = 1e-3; /* no self-hits at any range tried, and hidden in any pixel */
    const double        n[3] = {hits->n_geo[0][i], hits->n_geo[1][i], hits->n_geo[2][i]};
    const double        cosine = v3_dot(n, d_enu);
    const bool through = v->materials && v->materials->material[hits->material[i]].tau[optical_channel_nir] > 0;
    if (!(cosine > 0) && !(through && cosine < 0)) return false;
    for (int c = 0; c < 3; c++) start[c] = hits->p_enu[c][i] + (cosine > 0 ? offset_m : -offset_m) * n[c];
    return true;
}

/* shadow becomes 1 where a plant is met. hit_of[count]: indices of the rays among the hits. */
static void plants_shadow(uint8_t *shadow, const Visibility *v, const Hits *hits, const int *hit_of, int count,
                          const double *const o[3], const double *const d[3], VisibilityCounters *counters)
{
    double  far_m[hits_capacity];
    uint8_t dark[hits_capacity], real[hits_capacity];
    if (count <= 0) return;
    for (int k = 0; k < count; k++) {
        far_m[k] = INFINITY;
        dark[k] = 0;
        real[k] = v->full_plants || hits->entity[hit_of[k]] != 0; /* what falls on entities is that of real plants */
    }
    counters->rays_sun_plants += forest_any_hits(dark, v->plants, count, o, d, far_m, real);
    for (int k = 0; k < count; k++) shadow[hit_of[k]] |= dark[k];
}

/* Plants, for the rays that neither parts nor ground stop. */
static void shadows_of_plants(uint8_t *shadow, const Visibility *v, const Hits *hits, const int *order,
                              const double d_enu[3], VisibilityCounters *counters)
{
    double start[3][hits_capacity], towards[3][hits_capacity];
    int    hit_of[hits_capacity], count = 0;
    for (int k = 0; k < hits->count; k++) {
        const int i = order[k];
        double    p_enu[3];
        if (!(hits->range_m[i] < INFINITY) || (shadow[i] && skips(v->skips_off, SKIP_SUN_STOPPED))) continue;
        if (!leave_hit(p_enu, v, hits, i, d_enu)) continue;
        for (int c = 0; c < 3; c++) start[c][count] = p_enu[c], towards[c][count] = d_enu[c];
        hit_of[count++] = i;
    }
    const double *const o[3] = {start[0], start[1], start[2]}, *const d[3] = {towards[0], towards[1], towards[2]};
    plants_shadow(shadow, v, hits, hit_of, count, o, d, counters);
}

void visibility_shadow(uint8_t *shadow, const Visibility *v, const Hits *hits, const double d_enu[3],
                       VisibilityCounters *counters)
{
    double  start[3][hits_capacity], towards[3][hits_capacity], far_m[hits_capacity], range_m[hits_capacity];
    int     hit_of[hits_capacity], order[hits_capacity], in_turn[hits_capacity], list[hits_capacity], count = 0;
    uint8_t dark[hits_capacity], ask[hits_capacity];

    /* the lit candidates, compacted: neither sky nor facing away */
    order_rays(order, hits->count, hits->columns);
    for (int k = 0; k < hits->count; k++) {
        const int i = order[k];
        shadow[i] = 0;
        if (!(hits->range_m[i] < INFINITY)) continue;
        double p_enu[3];
        if (!leave_hit(p_enu, v, hits, i, d_enu)) {
            shadow[i] = 1;
            continue;
        }
        for (int c = 0; c < 3; c++) start[c][count] = p_enu[c], towards[c][count] = d_enu[c];
        far_m[count] = INFINITY;
        dark[count] = 0;
        in_turn[count] = count;
        hit_of[count++] = i;
    }
    if (count == 0) return;

    const double  *o[3] = {start[0], start[1], start[2]}, *d[3] = {towards[0], towards[1], towards[2]};
    double         centre[3];
    const double   radius_m = bound_points(centre, count, o);
    const uint64_t drawable = (uint64_t)v->drawable;
    uint64_t       offered = 0, asked = 0;
    int            near[crowd_least], nears = v->count;
    const bool     by_tree = skips(v->skips_off, SKIP_TREE);
    if (by_tree) nears = broad_phase_swept(near, crowd_least, v->tree, centre, radius_m, d_enu);
    if (nears < 0) {
        CrowdCounts counts = {0};
        crowd_any_hits(dark, &counts, v, count, o, d);
        offered = asked = counts.asked;
        counters->skipped[SKIP_PART] += counts.nodes - counts.asked_nodes;
    }
    for (int k = 0; k < nears; k++) {
        const int index = by_tree ? near[k] : k;
        if (!v->loose[index]) continue;
        const PosedEntity *entity = visibility_posed(v, index);
        if (entity->model < 0) continue;
        offered += (uint64_t)count;
        if (skips(v->skips_off, SKIP_SUN_SPHERE)) {
            if (!sphere_may_shadow(entity, centre, radius_m, d_enu)) continue;
            rays_meet_sphere(ask, count, o, d, far_m, entity->centre_enu, entity->radius_m);
            for (int i = 0; i < count; i++) ask[i] &= !dark[i];
        } else {
            memset(ask, 1, sizeof ask);
        }
        const int listed = list_asked(list, in_turn, ask, count);
        counters->skipped[SKIP_PART] +=
            (uint64_t)listed * (uint64_t)entity->node_count -
            parts_any_hits(dark, entity, o, d, far_m, list, listed, !skips(v->skips_off, SKIP_PART));
        asked += (uint64_t)listed;
    }
    counters->rays_sun_parts += asked;
    counters->skipped_sun_parts += drawable * (uint64_t)count - asked;
    counters->skipped[SKIP_SUN_SPHERE] += offered - asked;
    if (by_tree) counters->skipped[SKIP_TREE] += drawable * (uint64_t)count - offered;

    /* the ground is traced only for rays that no part blocks */
    int left = 0, lit = 0;
    if (skips(v->skips_off, SKIP_SUN_CLEAR)) leave_out_clear(ask, v, count, o, dark, d_enu);
    else memset(ask, 1, (size_t)count);
    for (int i = 0; i < count; i++) {
        shadow[hit_of[i]] = dark[i];
        const bool stopped = dark[i] && skips(v->skips_off, SKIP_SUN_STOPPED);
        counters->skipped[SKIP_SUN_STOPPED] += stopped;
        counters->skipped[SKIP_SUN_CLEAR] += !stopped && !ask[i];
        lit += !stopped;
        if (stopped || !ask[i]) continue;
        for (int c = 0; c < 3; c++) start[c][left] = start[c][i];
        hit_of[left++] = hit_of[i];
    }
    ground_hits(range_m, NULL, v, left, o, d, far_m, counters);
    for (int i = 0; i < left; i++) shadow[hit_of[i]] |= range_m[i] < INFINITY;
    counters->rays_sun_ground += (uint64_t)lit;
    if (v->plants) shadows_of_plants(shadow, v, hits, order, d_enu, counters);
}
