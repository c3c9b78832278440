/* render/visibility/visibility.c: first hits of rays, and shadows of the sun. */
#include "render/visibility/visibility_private.h"

#include "pitviper_simd.h"

/* Whether each ray comes within an entity's sphere, ahead of it and before limit_m. Plain arrays in, one flag out:
 * no branches. */
void rays_meet_sphere(uint8_t *meets, int count, const double *const o[3], const double *const d[3],
                             const double *limit_m, const double centre[3], double radius_m)
{
    const double *ox = o[0], *oy = o[1], *oz = o[2], *dx = d[0], *dy = d[1], *dz = d[2];
    for (int i = 0; i < count; i++) {
        const double mx = centre[0] - ox[i], my = centre[1] - oy[i], mz = centre[2] - oz[i];
        const double along = mx * dx[i] + my * dy[i] + mz * dz[i];
        const double cx = mx - along * dx[i], cy = my - along * dy[i], cz = mz - along * dz[i];
        const double left = radius_m * radius_m - (cx * cx + cy * cy + cz * cz);
        const double half = sqrt(left > 0 ? left : 0);
        meets[i] = (left > 0) & (along + half > 0) & (along - half < limit_m[i]);
    }
}

/* Rays of a picture's rows in squares of 4 x 4, which are traced as a packet; others as they are. */
static void order_rays(int order[hits_capacity], int count, int columns)
{
    const bool squares = columns > 1 && columns <= count && count % columns == 0;
    const int  width = squares ? columns : count, height = squares ? count / columns : 1;
    int        at = 0;
    for (int y0 = 0; y0 < height; y0 += 4)
        for (int x0 = 0; x0 < width; x0 += 4)
            for (int y = y0; y < y0 + 4 && y < height; y++)
                for (int x = x0; x < x0 + 4 && x < width; x++) order[at++] = y * width + x;
}

/* Indices of the active rays, in that order. */
static int list_asked(int list[hits_capacity], const int order[hits_capacity], const uint8_t *ask, int count)
{
    int listed = 0;
    for (int k = 0; k < count; k++) {
        list[listed] = order[k];
        listed += ask[order[k]] != 0;
    }
    return listed;
}

/* The shading normal follows the curved surface that the facets approximate; where it faces away from the ray it is
 * turned back to edge-on. */
void visibility_store_normals(Hits *hits, int i, const double n_geo[3], const double n_enu[3], const double d_enu[3])
{
    double       n[3] = {n_enu[0], n_enu[1], n_enu[2]};
    const double away = v3_dot(n, d_enu);
    if (away > 0) {
        v3_add_scaled(n, n, -away, d_enu);
        if (!v3_normalize(n, n)) v3_scale(n, 1, n_geo);
    }
    for (int c = 0; c < 3; c++) {
        hits->n_geo[c][i] = (float)n_geo[c];
        hits->n_enu[c][i] = (float)n[c];
    }
}

/* What a ray that meets nothing has, but for places, normals and entities: those are written one by one. */
static void clear_hits(Hits *hits)
{
    const size_t n = (size_t)hits->count;
    memset(hits->kind, hit_sky, n * sizeof *hits->kind);
    memset(hits->material, 0, n * sizeof *hits->material);
    memset(hits->facet, 0, n * sizeof *hits->facet);
    memset(hits->part, 0, n * sizeof *hits->part);
    memset(hits->model, 0, n * sizeof *hits->model);
    memset(hits->inside, 0, n * sizeof *hits->inside);
    memset(hits->surface, 0, n * sizeof *hits->surface);
    memset(hits->plant, 0, n * sizeof *hits->plant);
    memset(hits->radius_m, 0, n * sizeof *hits->radius_m);
    for (int i = 0; i < hits->count; i++) hits->albedo[i] = hits->open_up[i] = hits->open_down[i] = 1;
}

/* Normals of four hits in a row, stored at once. False: some normal faces away from its ray. */
static bool store_four_normals(Hits *hits, int i, double n_geo[3][4], double n_enu[3][4], const double *const d[3])
{
    F64x4 geo[3], enu[3], way[3];
    for (int c = 0; c < 3; c++) geo[c] = f64x4_loadu(n_geo[c]), enu[c] = f64x4_loadu(n_enu[c]), way[c] = f64x4_loadu(d[c] + i);
    const F64x4 none = f64x4_set(0), along = geo[0] * way[0] + geo[1] * way[1] + geo[2] * way[2];
    const F64x4 away = enu[0] * way[0] + enu[1] * way[1] + enu[2] * way[2];
    if (f64x4_bits(f64x4_or(f64x4_less(none, along), f64x4_less(none, away)))) return false;
    for (int c = 0; c < 3; c++) {
        _mm_storeu_ps(hits->n_geo[c] + i, _mm256_cvtpd_ps(geo[c]));
        _mm_storeu_ps(hits->n_enu[c] + i, _mm256_cvtpd_ps(enu[c]));
    }
    return true;
}

/* Normals of the ground at the listed hits; where it was met from below, of its lower side. */
static void complete_ground_hits(Hits *hits, const Visibility *v, const GroundHit *hit, const int *list, int count,
                                 const double *const d[3])
{
    enum { lanes = ground_normals_lanes };
    for (int first = 0; first < count; first += lanes) {
        double    n_geo[3][lanes], n_enu[3][lanes];
        const int some = count - first < lanes ? count - first : lanes;
        ground_normals(n_geo, n_enu, &v->ground, hit, list + first, some, hits->p_enu[0], hits->p_enu[1]);
        const bool row = some == lanes && list[first + lanes - 1] == list[first] + lanes - 1; /* ascending */
        if (row && store_four_normals(hits, list[first], n_geo, n_enu, d)) continue;
        for (int k = 0; k < some; k++) {
            const int    i = list[first + k];
            const double d_enu[3] = {d[0][i], d[1][i], d[2][i]};
            double       geo[3] = {n_geo[0][k], n_geo[1][k], n_geo[2][k]}, enu[3] = {n_enu[0][k], n_enu[1][k], n_enu[2][k]};
            if (v3_dot(geo, d_enu) > 0) { /* stopped inside the solid ground */
                v3_scale(geo, -1, geo);
                v3_scale(enu, -1, enu);
            }
            visibility_store_normals(hits, i, geo, enu, d_enu);
        }
    }
}

static void complete_part_hit(Hits *hits, int i, const Visibility *v, int entity, const PartHit *hit,
                              PosedFacet *facet, const double o[3], const double d[3])
{
    const PosedEntity *posed = visibility_posed(v, entity);
    const Model       *model = tracer_model(v->tracer, posed->model);
    double             n_geo[3], n_enu[3];
    if (facet->node != &posed->node[hit->node] || facet->triangle != hit->triangle) parts_facet(facet, model, posed, hit);
    parts_facet_normals(n_geo, n_enu, model, facet, o, d, hits->range_m[i]);
    visibility_store_normals(hits, i, n_geo, n_enu, d);
    hits->entity[i] = (uint32_t)entity + 1;
    hits->model[i]  = (uint16_t)posed->model;
    hits->inside[i] = v3_dot(facet->geo_enu, d) > 0;
    hits->part[i]   = (uint16_t)(model->triangle_part[hit->triangle] + 1);
    hits->kind[i]   = hit_part;
    hits->facet[i]  = hit->triangle;
    if (v->materials)
        hits->material[i] = (uint16_t)material_of_part(v->materials, posed->model, hits->part[i] - 1, posed->damage);
}

/* Surface class and material of the ground at the hit. */
static void classify_ground(Hits *hits, const Landscape *landscape, const Materials *materials)
{
    double x_m[hits_capacity], y_m[hits_capacity];
    for (int i = 0; i < hits->count; i++) {
        const bool ground = hits->range_m[i] < INFINITY && hits->entity[i] == 0 && hits->plant[i] == 0;
        if (ground) hits->kind[i] = hit_ground;
        x_m[i] = ground ? hits->p_enu[0][i] : NAN;
        y_m[i] = ground ? hits->p_enu[1][i] : NAN;
    }
    landscape_surfaces(hits->surface, landscape, hits->count, x_m, y_m);
    for (int i = 0; i < hits->count && materials; i++)
        if (hits->surface[i]) hits->material[i] = (uint16_t)materials->surface[hits->surface[i]];
}

static void ground_hits(double *range_m, GroundHit *hit, const Visibility *v, int count, const double *const o[3],
                        const double *const d[3], const double *far_m, VisibilityCounters *counters)
{
    if (skips(v->skips_off, SKIP_GROUND_WALK)) {
        ground_first_hits_together(range_m, hit, &v->ground, count, o, d, far_m);
        counters->skipped[SKIP_GROUND_WALK] += (uint64_t)count;
    } else {
        ground_first_hits(range_m, hit, &v->ground, count, o, d, far_m);
    }
}

enum { clear_rays = 128 }; /* that are tested together */

static void grow_box(double box[2][3], const double p[3])
{
    for (int c = 0; c < 3; c++) {
        box[0][c] = p[c] < box[0][c] ? p[c] : box[0][c];
        box[1][c] = p[c] > box[1][c] ? p[c] : box[1][c];
    }
}

/* Whether every ray meets an entity, and all of the ground is below all of them up to there. */
static bool ground_lies_below(const Visibility *v, const uint32_t *entity, int count, const double *const o[3],
                              const double *const d[3], const double *until_m)
{
    for (int i = 0; i < count; i++)
        if (!entity[i]) return false;
    for (int first = 0; first < count; first += clear_rays) {
        const int end = first + clear_rays < count ? first + clear_rays : count;
        double    start[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}, met[2][3];
        memcpy(met, start, sizeof met);
        for (int i = first; i < end; i++) {
            const double p[3] = {o[0][i], o[1][i], o[2][i]}, way[3] = {d[0][i], d[1][i], d[2][i]};
            double       at[3];
            v3_add_scaled(at, p, until_m[i], way);
            grow_box(start, p);
            grow_box(met, at);
        }
        if (!ground_is_clear(&v->ground, met, start)) return false;
    }
    return true;
}

static void first_hit(Hits *hits, const Visibility *v, const Rays *rays, const int *list, int list_count, int hidden,
                      const EntityHits *known, bool ground, VisibilityCounters *counters)
{
    const double *const o[3] = {rays->o_enu[0], rays->o_enu[1], rays->o_enu[2]};
    const double *const d[3] = {rays->d_enu[0], rays->d_enu[1], rays->d_enu[2]};
    const int           count = rays->count;
    GroundHit           ground_hit[hits_capacity];
    PartHit             part_hit[hits_capacity];
    double              limit_m[hits_capacity]; /* of what may still be nearer */
    double              nearer_m[hits_capacity], *until_m = nearer_m;
    int                 order[hits_capacity], asked_ray[hits_capacity];
    uint8_t             ask[hits_capacity];

    hits->count   = count;
    hits->columns = rays->columns;
    memcpy(limit_m, rays->far_m, (size_t)count * sizeof *limit_m);
    memset(hits->entity, 0, (size_t)count * sizeof *hits->entity);
    const int      asked_count = list_count < 0 ? v->count : list_count;
    const bool     crowd = skips(v->skips_off, SKIP_TREE) && (list_count < 0 ? v->drawable : list_count) > crowd_least;
    const uint64_t drawable = (uint64_t)(v->drawable - (hidden >= 0 && v->loose[hidden]));
    uint64_t       offered = 0, asked = 0;
    if (crowd) {
        CrowdCounts counts = {0};
        order_rays(order, count, rays->columns);
        crowd_first_hits(limit_m, hits->entity, part_hit, &counts, v, count, o, d, order, list, list_count, hidden, known);
        asked = counts.asked;
        counters->skipped[SKIP_PART] += counts.nodes - counts.asked_nodes;
        counters->skipped[SKIP_TREE] += (uint64_t)count * (list_count < 0 ? drawable : (uint64_t)list_count) - asked;
    }
    bool ordered = false;
    for (int k = 0; k < asked_count && !crowd; k++) {
        const int index = list_count < 0 ? k : list[k];
        if (index == hidden || !v->loose[index]) continue;
        const PosedEntity *entity = visibility_posed(v, index);
        if (entity->model < 0) continue;
        if (known && known->entity == index) {
            for (int i = 0; i < count; i++) {
                if (!(known->range_m[i] < limit_m[i])) continue;
                limit_m[i]      = known->range_m[i];
                part_hit[i]     = known->hit[i];
                hits->entity[i] = (uint32_t)index + 1;
            }
            continue;
        }
        if (skips(v->skips_off, SKIP_SPHERE)) rays_meet_sphere(ask, count, o, d, limit_m, entity->centre_enu, entity->radius_m);
        else memset(ask, 1, sizeof ask);
        if (!ordered) order_rays(order, count, rays->columns);
        ordered = true;
        const int listed = list_asked(asked_ray, order, ask, count);
        offered += (uint64_t)count;
        if (listed == 0) continue;
        asked += (uint64_t)listed;
        for (int n = 0; n < listed; n++) nearer_m[asked_ray[n]] = INFINITY;
        counters->skipped[SKIP_PART] += (uint64_t)listed * (uint64_t)entity->node_count -
                                        parts_first_hits(nearer_m, part_hit, entity, o, d, limit_m, asked_ray, listed,
                                                         !skips(v->skips_off, SKIP_PART));
        for (int n = 0; n < listed; n++) {
            const int i = asked_ray[n];
            if (!(nearer_m[i] < INFINITY)) continue;
            limit_m[i]      = nearer_m[i];
            hits->entity[i] = (uint32_t)index + 1;
        }
    }
    /* the ground has priority at equal range: it is traced to just beyond the part's hit */
    const bool behind = skips(v->skips_off, SKIP_GROUND_BEHIND);
    for (int i = 0; i < count; i++) {
        until_m[i] = hits->entity[i] ? limit_m[i] * (1 + 1e-12) : limit_m[i];
        counters->skipped[SKIP_GROUND_BEHIND] += behind && hits->entity[i];
    }
    if (!ground) {
        for (int i = 0; i < count; i++) hits->range_m[i] = INFINITY;
    } else if (skips(v->skips_off, SKIP_GROUND_BELOW) && ground_lies_below(v, hits->entity, count, o, d, until_m)) {
        for (int i = 0; i < count; i++) hits->range_m[i] = INFINITY;
        counters->skipped[SKIP_GROUND_BELOW] += (uint64_t)count;
    } else {
        ground_hits(hits->range_m, ground_hit, v, count, o, d, behind ? until_m : rays->far_m, counters);
    }
    for (int i = 0; i < count; i++) {
        if (!hits->entity[i]) continue;
        if (hits->range_m[i] <= limit_m[i]) hits->entity[i] = 0;
        else hits->range_m[i] = limit_m[i];
    }
    if (ground) counters->rays_ground += (uint64_t)count;
    counters->rays_parts += asked;
    counters->skipped_parts += drawable * (uint64_t)count - asked;
    if (!crowd) counters->skipped[SKIP_SPHERE] += offered - asked;

    clear_hits(hits);
    PosedFacet facet = {.node = NULL}; /* neighbours often meet the same */
    int        grounds = 0;
    for (int i = 0; i < count; i++) {
        if (!(hits->range_m[i] < INFINITY)) {
            for (int c = 0; c < 3; c++) hits->p_enu[c][i] = 0, hits->n_geo[c][i] = hits->n_enu[c][i] = 0;
            hits->entity[i] = 0;
            continue;
        }
        for (int c = 0; c < 3; c++) hits->p_enu[c][i] = o[c][i] + hits->range_m[i] * d[c][i];
        if (hits->entity[i]) {
            const double o_enu[3] = {o[0][i], o[1][i], o[2][i]}, d_enu[3] = {d[0][i], d[1][i], d[2][i]};
            complete_part_hit(hits, i, v, (int)hits->entity[i] - 1, &part_hit[i], &facet, o_enu, d_enu);
        } else {
            order[grounds++] = i;
        }
    }
    complete_ground_hits(hits, v, ground_hit, order, grounds, d);
    if (ground && v->plants) plants_first_hits(hits, v, rays, hidden, counters);
    if (v->landscape) classify_ground(hits, v->landscape, v->materials);
}

void visibility_first_hit(Hits *hits, const Visibility *v, const Rays *rays, const int *list, int list_count, int hidden,
                          VisibilityCounters *counters)
{
    first_hit(hits, v, rays, list, list_count, hidden, NULL, true, counters);
}

void visibility_first_hit_knowing(Hits *hits, const Visibility *v, const Rays *rays, const int *list, int list_count,
                                  int hidden, const EntityHits *known, VisibilityCounters *counters)
{
    first_hit(hits, v, rays, list, list_count, hidden, known, true, counters);
}

void visibility_first_part(Hits *hits, const Visibility *v, const Rays *rays, const int *list, int list_count,
                           VisibilityCounters *counters)
{
    first_hit(hits, v, rays, list, list_count, -1, NULL, false, counters);
}

/* ---- shadows ------------------------------------------------------------------------------ */

/* A sphere round the origins of a block's sun rays. */
static double bound_points(double centre[3], int count, const double *const p[3])
{
    double square = 0;
    for (int c = 0; c < 3; c++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < count; i++) {
            low  = p[c][i] < low ? p[c][i] : low;
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
    const double n[3] = {hits->n_geo[0][i], hits->n_geo[1][i], hits->n_geo[2][i]};
    const double cosine = v3_dot(n, d_enu);
    const bool   through = v->materials && v->materials->material[hits->material[i]].tau[optical_channel_nir] > 0;
    if (!(cosine > 0) && !(through && cosine < 0)) return false;
    for (int c = 0; c < 3; c++) start[c] = hits->p_enu[c][i] + (cosine > 0 ? offset_m : -offset_m) * n[c];
    return true;
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
        far_m[count]    = INFINITY;
        dark[count]     = 0;
        in_turn[count]  = count;
        hit_of[count++] = i;
    }
    if (count == 0) return;

    const double *o[3] = {start[0], start[1], start[2]}, *d[3] = {towards[0], towards[1], towards[2]};
    double        centre[3];
    const double  radius_m = bound_points(centre, count, o);
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
        counters->skipped[SKIP_PART] += (uint64_t)listed * (uint64_t)entity->node_count -
                                        parts_any_hits(dark, entity, o, d, far_m, list, listed,
                                                       !skips(v->skips_off, SKIP_PART));
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

/* ---- one entity alone --------------------------------------------------------------------- */

void visibility_entity_only(uint8_t *meets, const Visibility *v, const Rays *rays, int index, VisibilityCounters *counters)
{
    const double *const o[3] = {rays->o_enu[0], rays->o_enu[1], rays->o_enu[2]};
    const double *const d[3] = {rays->d_enu[0], rays->d_enu[1], rays->d_enu[2]};
    const PosedEntity  *entity = visibility_posed(v, index);
    if (entity->model < 0) {
        memset(meets, 0, (size_t)rays->count);
        return;
    }
    if (skips(v->skips_off, SKIP_SPHERE)) rays_meet_sphere(meets, rays->count, o, d, rays->far_m, entity->centre_enu, entity->radius_m);
    else memset(meets, 1, (size_t)rays->count);
    int       order[hits_capacity], list[hits_capacity];
    order_rays(order, rays->count, rays->columns);
    const int listed = list_asked(list, order, meets, rays->count);
    memset(meets, 0, (size_t)rays->count);
    counters->skipped[SKIP_SPHERE] += (uint64_t)(rays->count - listed);
    counters->skipped[SKIP_PART] += (uint64_t)listed * (uint64_t)entity->node_count -
                                    parts_any_hits(meets, entity, o, d, rays->far_m, list, listed,
                                                   !skips(v->skips_off, SKIP_PART));
}

void visibility_entity_hits(EntityHits *out, const Visibility *v, const Rays *rays, int index, VisibilityCounters *counters)
{
    const double *const o[3] = {rays->o_enu[0], rays->o_enu[1], rays->o_enu[2]};
    const double *const d[3] = {rays->d_enu[0], rays->d_enu[1], rays->d_enu[2]};
    const PosedEntity  *entity = visibility_posed(v, index);
    uint8_t             meets[hits_capacity];
    int                 order[hits_capacity], list[hits_capacity];
    out->entity = index;
    for (int i = 0; i < rays->count; i++) out->range_m[i] = INFINITY;
    if (entity->model < 0) return;
    if (skips(v->skips_off, SKIP_SPHERE)) rays_meet_sphere(meets, rays->count, o, d, rays->far_m, entity->centre_enu, entity->radius_m);
    else memset(meets, 1, sizeof meets);
    order_rays(order, rays->count, rays->columns);
    const int listed = list_asked(list, order, meets, rays->count);
    counters->skipped[SKIP_SPHERE] += (uint64_t)(rays->count - listed);
    counters->skipped[SKIP_PART] += (uint64_t)listed * (uint64_t)entity->node_count -
                                    parts_first_hits(out->range_m, out->hit, entity, o, d, rays->far_m, list, listed,
                                                     !skips(v->skips_off, SKIP_PART));
}

/* As rays_meet_sphere: plain arrays, no branches. */
void visibility_lie_beyond(uint8_t *may, const Visibility *v, int index, const Rays *rays, const double *range_m)
{
    const PosedEntity *entity = visibility_posed(v, index);
    const double      *ox = rays->o_enu[0], *oy = rays->o_enu[1], *oz = rays->o_enu[2];
    const double      *dx = rays->d_enu[0], *dy = rays->d_enu[1], *dz = rays->d_enu[2];
    const double       x = entity->centre_enu[0], y = entity->centre_enu[1], z = entity->centre_enu[2];
    const double       radius_m = entity->radius_m;
    const bool         all = !skips(v->skips_off, SKIP_AMODAL);
    if (all || entity->model < 0) {
        memset(may, all, (size_t)rays->count);
        return;
    }
    for (int i = 0; i < rays->count; i++) {
        const double mx = x - ox[i], my = y - oy[i], mz = z - oz[i];
        const double along = mx * dx[i] + my * dy[i] + mz * dz[i], past_m = range_m[i] - along;
        const double cx = mx - along * dx[i], cy = my - along * dy[i], cz = mz - along * dz[i];
        const double left = radius_m * radius_m - (cx * cx + cy * cy + cz * cz);
        may[i] = (past_m < radius_m) & (left > 0) & ((past_m <= 0) | (past_m * past_m < left));
    }
}
