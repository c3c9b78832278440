/* render/trace/visibility/visibility_plants.c: plants among the first hits of rays, and in the shadows. */
#include "render/trace/visibility/visibility_private.h"

void visibility_plants(Visibility *v, const ForestFrame *plants) { v->plants = plants; }

const Visibility *visibility_without_plants(const Visibility *v, Arena *arena)
{
    Visibility *bare;
    if (!v->plants) return v;
    bare = arena_alloc(arena, 1, sizeof *bare);
    if (!bare) return NULL;
    *bare = *v;
    bare->plants = NULL;
    return bare;
}

const Visibility *visibility_with_full_plants(const Visibility *v, Arena *arena)
{
    Visibility *full;
    if (!v->plants || !forest_simplifies(v->plants->forest)) return v;
    full = arena_alloc(arena, 1, sizeof *full);
    if (!full) return NULL;
    *full = *v;
    full->full_plants = true;
    return full;
}

/* ---- rays near entities ----------------------------------------------------------------------- */

typedef struct NearEntities {
    const Visibility *v;
    const BroadRays  *rays;
    int               hidden, count;
    uint8_t          *near; /* [count] */
} NearEntities;

static void mark_near(void *user, int index)
{
    static const double anywhere_m[broad_packet] = {INFINITY, INFINITY, INFINITY, INFINITY, INFINITY, INFINITY,
                                                    INFINITY, INFINITY, INFINITY, INFINITY, INFINITY, INFINITY,
                                                    INFINITY, INFINITY, INFINITY, INFINITY};
    const NearEntities *n = user;
    const double *const o[3] = {n->rays->o[0], n->rays->o[1], n->rays->o[2]};
    const double *const d[3] = {n->rays->d[0], n->rays->d[1], n->rays->d[2]};
    uint8_t             meets[broad_packet];
    if (index == n->hidden) return;
    const PosedEntity *entity = visibility_posed(n->v, index);
    if (entity->model < 0) return;
    rays_meet_sphere(meets, n->count, o, d, anywhere_m, entity->centre_enu, entity->radius_m);
    for (int i = 0; i < n->count; i++) n->near[i] |= meets[i];
}

/* 1 for rays that meet the sphere of an entity, before or behind whatever else: for them no plant is simplified. */
static void find_near(uint8_t near[hits_capacity], const Visibility *v, const Rays *rays, int hidden)
{
    memset(near, 0, (size_t)rays->count);
    for (int first = 0; first < rays->count; first += broad_packet) {
        BroadRays packet;
        const int some = rays->count - first < broad_packet ? rays->count - first : broad_packet;
        for (int k = 0; k < broad_packet; k++) {
            const int i = first + (k < some ? k : 0);
            for (int c = 0; c < 3; c++) packet.o[c][k] = rays->o_enu[c][i], packet.d[c][k] = rays->d_enu[c][i];
            packet.limit_m[k] = k < some ? INFINITY : -1;
        }
        NearEntities n = {.v = v, .rays = &packet, .hidden = hidden, .count = some, .near = near + first};
        broad_phase_rays(v->tree, &packet, mark_near, &n);
    }
}

/* ---- hits ------------------------------------------------------------------------------------- */

static void complete_plant_hit(Hits *hits, int i, const Visibility *v, const ForestHit *hit, const Rays *rays)
{
    const double  o[3] = {rays->o_enu[0][i], rays->o_enu[1][i], rays->o_enu[2][i]};
    const double  d[3] = {rays->d_enu[0][i], rays->d_enu[1][i], rays->d_enu[2][i]};
    const double  range_m = hits->range_m[i];
    ForestSurface at;
    forest_surface(&at, v->plants, hit, o, d, range_m, (float)(range_m / v->plants->per_rad));
    for (int c = 0; c < 3; c++) hits->p_enu[c][i] = o[c] + range_m * d[c];
    visibility_store_normals(hits, i, at.n_geo, at.n_enu, d);
    hits->kind[i] = hit_plant;
    hits->plant[i] = hit->plant + 1;
    hits->albedo[i] = at.albedo;
    hits->radius_m[i] = at.radius_m;
    hits->open_up[i] = at.open_up;
    hits->open_down[i] = at.open_down;
    hits->material[i] = v->materials ? (uint16_t)v->materials->plant[hit->kind][hit->organ] : 0;
    hits->entity[i] = hits->facet[i] = 0;
    hits->part[i] = hits->model[i] = 0;
    hits->inside[i] = hit->organ != PLANT_LEAF && hit->back;
}

void plants_first_hits(Hits *hits, const Visibility *v, const Rays *rays, int hidden, VisibilityCounters *counters)
{
    const double *const o[3] = {rays->o_enu[0], rays->o_enu[1], rays->o_enu[2]};
    const double *const d[3] = {rays->d_enu[0], rays->d_enu[1], rays->d_enu[2]};
    const bool          simplified = forest_simplifies(v->plants->forest);
    ForestHit           plant[hits_capacity];
    double              limit_m[hits_capacity], nearer_m[hits_capacity];
    uint8_t             real[hits_capacity];
    for (int i = 0; i < hits->count; i++)
        nearer_m[i] = limit_m[i] = hits->range_m[i] < rays->far_m[i] ? hits->range_m[i] : rays->far_m[i];
    if (v->full_plants) memset(real, 1, (size_t)hits->count);
    else if (simplified) find_near(real, v, rays, hidden);
    counters->rays_plants += forest_first_hits(nearer_m, plant, v->plants, hits->count, o, d, simplified ? real : NULL);
    for (int i = 0; i < hits->count; i++) {
        if (!(nearer_m[i] < limit_m[i])) continue;
        hits->range_m[i] = nearer_m[i];
        complete_plant_hit(hits, i, v, &plant[i], rays);
    }
}
