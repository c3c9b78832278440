/* render/trace/visibility/visibility_parts.c: the parts of entities among what rays can meet; one entity alone. */
#include "render/trace/visibility/visibility_private.h"

typedef struct PartsFound {
    uint32_t entity[hits_capacity]; /* index + 1; 0: none */
    PartHit  hit[hits_capacity];
} PartsFound;

uint32_t parts_found_entity(const void *found, int ray) { return ((const PartsFound *)found)->entity[ray]; }

/* The entity's sphere as these rays meet it. */
static void meet_sphere(uint8_t *ask, const Visibility *v, const Rays *rays, int index, const double *limit_m)
{
    const double *const o[3] = {rays->o_enu[0], rays->o_enu[1], rays->o_enu[2]};
    const double *const d[3] = {rays->d_enu[0], rays->d_enu[1], rays->d_enu[2]};
    const PosedEntity  *entity = visibility_posed(v, index);
    const double        centre[3] = {entity->centre_enu[0], entity->centre_enu[1],
                                     entity->centre_enu[2] + lift_for(v, rays, index)};
    rays_meet_sphere(ask, rays->count, o, d, limit_m, centre, entity->radius_m);
}

static const PosedEntity *entity_posed(const void *v, int index) { return visibility_posed(v, index); }
static double             entity_lift_m(const void *v, int index) { return visibility_lift(v, index); }

/* The entities as a crowd; bent: for rays that are. */
static Crowd entity_crowd(const Visibility *v, bool bent)
{
    return (Crowd){.tree = v->tree,
                   .posed = entity_posed,
                   .lift_m = bent && v->lift_m ? entity_lift_m : NULL,
                   .self = v,
                   .ask_all = !skips(v->skips_off, SKIP_PART)};
}

static void parts_first(double *range_m, void *found, const TraceBlock *block, const void *self)
{
    const Visibility          *v = block->v;
    const RayEntities          among = *block->among;
    const double *const *const o = block->o_enu, *const *const d = block->d_enu;
    const int   count = block->rays->count;
    PartsFound *of = found;
    double      limit_m[hits_capacity]; /* of what may still be nearer */
    double      nearer_m[hits_capacity];
    int         order[hits_capacity], asked_ray[hits_capacity];
    uint8_t     ask[hits_capacity];
    double      z_m[hits_capacity];
    (void)self;
    memcpy(limit_m, block->limit_m, (size_t)count * sizeof *limit_m);
    memset(of->entity, 0, (size_t)count * sizeof *of->entity);
    const int  asked_count = among.count < 0 ? v->count : among.count;
    const bool crowd = skips(v->skips_off, SKIP_TREE) && (among.count < 0 ? v->drawable : among.count) > crowd_least;
    const uint64_t drawable = (uint64_t)(v->drawable - (among.hidden >= 0 && v->loose[among.hidden]));
    uint64_t       offered = 0, asked = 0;
    if (crowd) {
        CrowdCounts       counts = {0};
        const Crowd       entities = entity_crowd(v, block->rays->bent);
        const EntityHits *known = among.known;
        const CrowdAmong  some = {among.list,
                                  among.count,
                                  among.hidden,
                                 known ? known->entity : -1,
                                 known ? known->range_m : NULL,
                                 known ? known->hit : NULL};
        order_rays(order, count, block->rays->columns);
        crowd_first_hits(limit_m, of->entity, of->hit, &counts, &entities, o, d, count, &some, order);
        asked = counts.asked;
        block->counters->skipped[SKIP_PART] += counts.nodes - counts.asked_nodes;
        block->counters->skipped[SKIP_TREE] +=
            (uint64_t)count * (among.count < 0 ? drawable : (uint64_t)among.count) - asked;
    }
    bool ordered = false;
    for (int k = 0; k < asked_count && !crowd; k++) {
        const int index = among.count < 0 ? k : among.list[k];
        if (index == among.hidden || !v->loose[index]) continue;
        const PosedEntity *entity = visibility_posed(v, index);
        if (entity->model < 0) continue;
        if (among.known && among.known->entity == index) {
            for (int i = 0; i < count; i++) {
                if (!(among.known->range_m[i] < limit_m[i])) continue;
                limit_m[i] = among.known->range_m[i];
                of->hit[i] = among.known->hit[i];
                of->entity[i] = (uint32_t)index + 1;
            }
            continue;
        }
        if (skips(v->skips_off, SKIP_SPHERE)) meet_sphere(ask, v, block->rays, index, limit_m);
        else memset(ask, 1, sizeof ask);
        if (!ordered) order_rays(order, count, block->rays->columns);
        ordered = true;
        const int listed = list_asked(asked_ray, order, ask, count);
        offered += (uint64_t)count;
        if (listed == 0) continue;
        asked += (uint64_t)listed;
        for (int n = 0; n < listed; n++) nearer_m[asked_ray[n]] = INFINITY;
        const double *const from[3] = {o[0], o[1],
                                       lowered(z_m, o[2], lift_for(v, block->rays, index), asked_ray, listed)};
        block->counters->skipped[SKIP_PART] += (uint64_t)listed * (uint64_t)entity->node_count -
                                               parts_first_hits(nearer_m, of->hit, entity, from, d, limit_m, asked_ray,
                                                                listed, !skips(v->skips_off, SKIP_PART));
        for (int n = 0; n < listed; n++) {
            const int i = asked_ray[n];
            if (!(nearer_m[i] < INFINITY)) continue;
            limit_m[i] = nearer_m[i];
            of->entity[i] = (uint32_t)index + 1;
        }
    }
    for (int i = 0; i < count; i++) range_m[i] = of->entity[i] ? limit_m[i] : INFINITY;
    block->counters->rays_parts += asked;
    block->counters->skipped_parts += drawable * (uint64_t)count - asked;
    if (!crowd) block->counters->skipped[SKIP_SPHERE] += offered - asked;
}

/* facet: of the hit completed before, and of this one after. */
static void complete_part_hit(Hits *hits, int i, PosedFacet *facet, const PartsFound *found, const TraceBlock *block)
{
    const Visibility  *v = block->v;
    const PartHit     *hit = &found->hit[i];
    const PosedEntity *posed = visibility_posed(v, (int)found->entity[i] - 1);
    const Model       *model = tracer_model(v->tracer, posed->model);
    const double       lift_m = lift_for(v, block->rays, (int)found->entity[i] - 1);
    const double       o[3] = {block->o_enu[0][i], block->o_enu[1][i], block->o_enu[2][i] - lift_m};
    const double       d[3] = {block->d_enu[0][i], block->d_enu[1][i], block->d_enu[2][i]};
    double             n_geo[3], n_enu[3];
    if (lift_m > 0) hits->p_enu[2][i] = o[2] + hits->range_m[i] * d[2]; /* raised as a whole: the place on its part */
    if (facet->node != &posed->node[hit->node] || facet->triangle != hit->triangle)
        parts_facet(facet, model, posed, hit);
    parts_facet_normals(n_geo, n_enu, model, facet, o, d, hits->range_m[i]);
    visibility_store_normals(hits, i, n_geo, n_enu, d);
    hits->entity[i] = found->entity[i];
    hits->model[i] = (uint16_t)posed->model;
    hits->inside[i] = v3_dot(facet->geo_enu, d) > 0;
    hits->part[i] = (uint16_t)(model->triangle_part[hit->triangle] + 1);
    hits->kind[i] = hit_part;
    hits->facet[i] = hit->triangle;
    if (v->materials)
        hits->material[i] = (uint16_t)material_of_part(v->materials, posed->model, hits->part[i] - 1, posed->damage);
}

static void parts_finish(Hits *hits, const int *list, int count, const void *found, const TraceBlock *block,
                         const void *self)
{
    PosedFacet facet = {.node = NULL}; /* neighbours often meet the same */
    (void)self;
    for (int k = 0; k < count; k++) complete_part_hit(hits, list[k], &facet, found, block);
}

/* ---- shadows ---------------------------------------------------------------------------------- */

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

static void parts_any(const TraceShadow *s, const void *self)
{
    const Visibility *v = s->v;
    double            far_m[hits_capacity];
    int               in_turn[hits_capacity], list[hits_capacity];
    uint8_t           ask[hits_capacity];
    (void)self;
    for (int i = 0; i < s->count; i++) far_m[i] = INFINITY, in_turn[i] = i;
    double         centre[3];
    const double   radius_m = rays_bound_origins(centre, s->count, s->o_enu);
    const uint64_t drawable = (uint64_t)v->drawable;
    uint64_t       offered = 0, asked = 0;
    int            near[crowd_least], nears = v->count;
    const bool     by_tree = skips(v->skips_off, SKIP_TREE);
    if (by_tree) nears = broad_phase_swept(near, crowd_least, v->tree, centre, radius_m, s->way_enu);
    if (nears < 0) {
        CrowdCounts counts = {0};
        const Crowd entities = entity_crowd(v, false);
        crowd_any_hits(s->dark, &counts, &entities, s->count, s->o_enu, s->d_enu);
        offered = asked = counts.asked;
        s->counters->skipped[SKIP_PART] += counts.nodes - counts.asked_nodes;
    }
    for (int k = 0; k < nears; k++) {
        const int index = by_tree ? near[k] : k;
        if (!v->loose[index]) continue;
        const PosedEntity *entity = visibility_posed(v, index);
        if (entity->model < 0) continue;
        offered += (uint64_t)s->count;
        if (skips(v->skips_off, SKIP_SUN_SPHERE)) {
            if (!sphere_may_shadow(entity, centre, radius_m, s->way_enu)) continue;
            rays_meet_sphere(ask, s->count, s->o_enu, s->d_enu, far_m, entity->centre_enu, entity->radius_m);
            for (int i = 0; i < s->count; i++) ask[i] &= !s->dark[i];
        } else {
            memset(ask, 1, sizeof ask);
        }
        const int listed = list_asked(list, in_turn, ask, s->count);
        s->counters->skipped[SKIP_PART] +=
            (uint64_t)listed * (uint64_t)entity->node_count -
            parts_any_hits(s->dark, entity, s->o_enu, s->d_enu, far_m, list, listed, !skips(v->skips_off, SKIP_PART));
        asked += (uint64_t)listed;
    }
    s->counters->rays_sun_parts += asked;
    s->counters->skipped_sun_parts += drawable * (uint64_t)s->count - asked;
    s->counters->skipped[SKIP_SUN_SPHERE] += offered - asked;
    if (by_tree) s->counters->skipped[SKIP_TREE] += drawable * (uint64_t)s->count - offered;
}

const TraceEntry trace_parts = {.turn = 0,
                                .found_octets = sizeof(PartsFound),
                                .first_hits = parts_first,
                                .finish = parts_finish,
                                .any_hits = parts_any};

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
    if (skips(v->skips_off, SKIP_SPHERE)) meet_sphere(meets, v, rays, index, rays->far_m);
    else memset(meets, 1, (size_t)rays->count);
    int order[hits_capacity], list[hits_capacity];
    order_rays(order, rays->count, rays->columns);
    const int listed = list_asked(list, order, meets, rays->count);
    memset(meets, 0, (size_t)rays->count);
    double              z_m[hits_capacity];
    const double *const from[3] = {o[0], o[1], lowered(z_m, o[2], lift_for(v, rays, index), list, listed)};
    counters->skipped[SKIP_SPHERE] += (uint64_t)(rays->count - listed);
    counters->skipped[SKIP_PART] +=
        (uint64_t)listed * (uint64_t)entity->node_count -
        parts_any_hits(meets, entity, from, d, rays->far_m, list, listed, !skips(v->skips_off, SKIP_PART));
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
    if (skips(v->skips_off, SKIP_SPHERE)) meet_sphere(meets, v, rays, index, rays->far_m);
    else memset(meets, 1, sizeof meets);
    order_rays(order, rays->count, rays->columns);
    const int listed = list_asked(list, order, meets, rays->count);
    counters->skipped[SKIP_SPHERE] += (uint64_t)(rays->count - listed);
    double              z_m[hits_capacity];
    const double *const from[3] = {o[0], o[1], lowered(z_m, o[2], lift_for(v, rays, index), list, listed)};
    counters->skipped[SKIP_PART] += (uint64_t)listed * (uint64_t)entity->node_count -
                                    parts_first_hits(out->range_m, out->hit, entity, from, d, rays->far_m, list, listed,
                                                     !skips(v->skips_off, SKIP_PART));
}

/* As rays_meet_sphere: plain arrays, no branches. */
void visibility_lie_beyond(uint8_t *may, const Visibility *v, int index, const Rays *rays, const double *range_m)
{
    const PosedEntity *entity = visibility_posed(v, index);
    const double      *ox = rays->o_enu[0], *oy = rays->o_enu[1], *oz = rays->o_enu[2];
    const double      *dx = rays->d_enu[0], *dy = rays->d_enu[1], *dz = rays->d_enu[2];
    const double       x = entity->centre_enu[0], y = entity->centre_enu[1];
    const double       z = entity->centre_enu[2] + lift_for(v, rays, index);
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
