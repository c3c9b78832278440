/* render/trace/visibility/visibility.c: first hits of rays, and shadows of the sun. */

#include "render/trace/visibility/visibility_private.h"
#include "pitviper_simd.h"
#include "render/trace/visibility/visibility.h"

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
    for (int c = 0; c < 3; c++)
        geo[c] = f64x4_loadu(n_geo[c]), enu[c] = f64x4_loadu(n_enu[c]), way[c] = f64x4_loadu(d[c] + i);
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
            double geo[3] = {n_geo[0][k], n_geo[1][k], n_geo[2][k]}, enu[3] = {n_enu[0][k], n_enu[1][k], n_enu[2][k]};
            if (v3_dot(geo, d_enu) > 0) { /* stopped inside the solid ground */
                v3_scale(geo, -1, geo);
                v3_scale(enu, -1, enu);
            }
            visibility_store_normals(hits, i, geo, enu, d_enu);
        }
    }
}

static void complete_part_hit(Hits *hits, int i, const Visibility *v, int entity, const PartHit *hit, PosedFacet *facet,
                              const double o[3], const double d[3])
{
    const PosedEntity *posed = visibility_posed(v, entity);
    const Model       *model = tracer_model(v->tracer, posed->model);
    double             n_geo[3], n_enu[3];
    if (facet->node != &posed->node[hit->node] || facet->triangle != hit->triangle)
        parts_facet(facet, model, posed, hit);
    parts_facet_normals(n_geo, n_enu, model, facet, o, d, hits->range_m[i]);
    visibility_store_normals(hits, i, n_geo, n_enu, d);
    hits->entity[i] = (uint32_t)entity + 1;
    hits->model[i] = (uint16_t)posed->model;
    hits->inside[i] = v3_dot(facet->geo_enu, d) > 0;
    hits->part[i] = (uint16_t)(model->triangle_part[hit->triangle] + 1);
    hits->kind[i] = hit_part;
    hits->facet[i] = hit->triangle;
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

    hits->count = count;
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
        crowd_first_hits(limit_m, hits->entity, part_hit, &counts, v, count, o, d, order, list, list_count, hidden,
                         known);
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
                limit_m[i] = known->range_m[i];
                part_hit[i] = known->hit[i];
                hits->entity[i] = (uint32_t)index + 1;
            }
            continue;
        }
        if (skips(v->skips_off, SKIP_SPHERE))
            rays_meet_sphere(ask, count, o, d, limit_m, entity->centre_enu, entity->radius_m);
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
            limit_m[i] = nearer_m[i];
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

void visibility_first_hit(Hits *hits, const Visibility *v, const Rays *rays, const int *list, int list_count,
                          int hidden, VisibilityCounters *counters)
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

/* ---- one entity alone --------------------------------------------------------------------- */

void visibility_entity_only(uint8_t *meets, const Visibility *v, const Rays *rays, int index,
                            VisibilityCounters *counters)
{
    const double *const o[3] = {rays->o_enu[0], rays->o_enu[1], rays->o_enu[2]};
    const double *const d[3] = {rays->d_enu[0], rays->d_enu[1], rays->d_enu[2]};
    const PosedEntity  *entity = visibility_posed(v, index);
    if (entity->model < 0) {
        memset(meets, 0, (size_t)rays->count);
        return;
    }
    if (skips(v->skips_off, SKIP_SPHERE))
        rays_meet_sphere(meets, rays->count, o, d, rays->far_m, entity->centre_enu, entity->radius_m);
    else memset(meets, 1, (size_t)rays->count);
    int order[hits_capacity], list[hits_capacity];
    order_rays(order, rays->count, rays->columns);
    const int listed = list_asked(list, order, meets, rays->count);
    memset(meets, 0, (size_t)rays->count);
    counters->skipped[SKIP_SPHERE] += (uint64_t)(rays->count - listed);
    counters->skipped[SKIP_PART] +=
        (uint64_t)listed * (uint64_t)entity->node_count -
        parts_any_hits(meets, entity, o, d, rays->far_m, list, listed, !skips(v->skips_off, SKIP_PART));
}

void visibility_entity_hits(EntityHits *out, const Visibility *v, const Rays *rays, int index,
                            VisibilityCounters *counters)
{
    const double *const o[3] = {rays->o_enu[0], rays->o_enu[1], rays->o_enu[2]};
    const double *const d[3] = {rays->d_enu[0], rays->d_enu[1], rays->d_enu[2]};
    const PosedEntity  *entity = visibility_posed(v, index);
    uint8_t             meets[hits_capacity];
    int                 order[hits_capacity], list[hits_capacity];
    out->entity = index;
    for (int i = 0; i < rays->count; i++) out->range_m[i] = INFINITY;
    if (entity->model < 0) return;
    if (skips(v->skips_off, SKIP_SPHERE))
        rays_meet_sphere(meets, rays->count, o, d, rays->far_m, entity->centre_enu, entity->radius_m);
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

/* ---- the names of the skips ------------------------------------------------------------------ */

static const struct {
    const char *name, *what;
} rows[SKIP_COUNT] = {
    [SKIP_BLOCK] = {"block", "entities outside a block of pixels: block-entity pairs"},
    [SKIP_SPHERE] = {"sphere", "entities missed or hidden, by their sphere: ray-entity pairs"},
    [SKIP_PART] = {"part", "parts missed, by box and sphere: ray-part pairs"},
    [SKIP_GROUND_BEHIND] = {"ground_behind", "ground behind the part that was met: rays"},
    [SKIP_GROUND_BELOW] = {"ground_below", "ground below a block of rays that all met parts: rays"},
    [SKIP_GROUND_WALK] = {"ground_walk", "ground walked together with neighbours: rays"},
    [SKIP_SUN_SPHERE] = {"sun_sphere", "entities that sun rays miss: ray-entity pairs"},
    [SKIP_SUN_STOPPED] = {"sun_stopped", "ground and plants behind what stops the sun: rays"},
    [SKIP_SUN_CLEAR] = {"sun_clear", "ground too low to stop the sun: rays"},
    [SKIP_AMODAL] = {"amodal", "entities with nothing behind what was met: ray-entity pairs"},
    [SKIP_CELL] = {"cell", "samples beside a small target: rays"},
    [SKIP_RETRACE] = {"retrace", "first rays of refined pixels, known from their planes: rays"},
    [SKIP_SMOKE] = {"smoke", "smoke and dust outside a block of pixels: block-volume pairs"},
    [SKIP_LIGHT] = {"light", "light of places near vehicles, asked for once a frame: hits that may share it"},
    [SKIP_TREE] = {"tree", "entities left out by the tree of their spheres: block-entity, ray-entity pairs"},
    [SKIP_KEPT] = {"kept", "what paths from sample points meet, kept from earlier frames: points"},
};

const char *visibility_skip_name(Skip skip) { return rows[skip].name; }
const char *visibility_skip_what(Skip skip) { return rows[skip].what; }
