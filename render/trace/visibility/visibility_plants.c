/* render/trace/visibility/visibility_plants.c: plants among the first hits of rays, and in the shadows. */
#include "render/trace/visibility/visibility_private.h"

/* ---- rays near entities ----------------------------------------------------------------------- */

typedef struct NearEntities {
    const Visibility *v;
    const BroadRays  *rays;
    const Rays       *of;
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
    const double lift_m = lift_for(n->v, n->of, index);
    const double centre[3] = {entity->centre_enu[0], entity->centre_enu[1], entity->centre_enu[2] + lift_m};
    rays_meet_sphere(meets, n->count, o, d, anywhere_m, centre, entity->radius_m);
    for (int i = 0; i < n->count; i++) n->near[i] |= meets[i];
}

/* 1 for rays that meet the sphere of an entity as it is posed, before or behind whatever else: for them no plant is
 * simplified. The tree's spheres are not those, and it tests a packet of rays together: its answer only leaves out
 * entities that are farther away than any posed sphere reaches. */
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
        NearEntities n = {.v = v, .rays = &packet, .of = rays, .hidden = hidden, .count = some, .near = near + first};
        broad_phase_rays_near(v->tree, &packet, v->wider_m, mark_near, &n);
    }
}

/* ---- hits ------------------------------------------------------------------------------------- */

static void plants_first(double *range_m, void *found, const TraceBlock *block, const void *self)
{
    ForestFrame plants = *(const ForestFrame *)self;
    const bool  simplified = forest_simplifies(plants.forest);
    const int   count = block->rays->count;
    uint8_t     real[hits_capacity];
    plants.columns = block->rays->columns;
    if (block->rays->bent) plants.bend_per_m = block->v->seen.bend_per_m;
    memcpy(range_m, block->limit_m, (size_t)count * sizeof *range_m);
    if (block->v->full_plants) memset(real, 1, (size_t)count);
    else if (simplified) find_near(real, block->v, block->rays, block->among->hidden);
    block->counters->rays_plants +=
        forest_first_hits(range_m, found, &plants, count, block->o_enu, block->d_enu, simplified ? real : NULL);
    for (int i = 0; i < count; i++) range_m[i] = range_m[i] < block->limit_m[i] ? range_m[i] : INFINITY;
}

static void plants_finish(Hits *hits, const int *list, int count, const void *found, const TraceBlock *block,
                          const void *self)
{
    const Materials *materials = block->v->materials;
    const ForestHit *hit[hits_capacity] = {NULL};
    double           o[3][hits_capacity], d[3][hits_capacity], range_m[hits_capacity];
    double           n_geo[3][hits_capacity], n_enu[3][hits_capacity];
    float            albedo[hits_capacity], radius_m[hits_capacity], open_up[hits_capacity], open_down[hits_capacity];
    uint8_t          mark[hits_capacity];
    const ForestRays rays = {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, range_m};
    ForestSurfaces   at = {.n_geo = {n_geo[0], n_geo[1], n_geo[2]},
                           .n_enu = {n_enu[0], n_enu[1], n_enu[2]},
                           .albedo = albedo,
                           .radius_m = radius_m,
                           .open_up = open_up,
                           .open_down = open_down,
                           .mark = mark};
    for (int k = 0; k < count; k++) {
        const int i = list[k];
        hit[k] = (const ForestHit *)found + i;
        range_m[k] = hits->range_m[i];
        for (int c = 0; c < 3; c++) o[c][k] = block->o_enu[c][i], d[c][k] = block->d_enu[c][i];
        o[2][k] -= block->rays->bent ? ray_drop(block->v, block->rays, i, range_m[k]) : 0;
    }
    forest_surfaces(&at, self, hit, count, &rays);
    for (int k = 0; k < count; k++) {
        const int    i = list[k];
        const double d_enu[3] = {d[0][k], d[1][k], d[2][k]};
        const double geo[3] = {n_geo[0][k], n_geo[1][k], n_geo[2][k]}, enu[3] = {n_enu[0][k], n_enu[1][k], n_enu[2][k]};
        block->counters->hits_by_table += hit[k]->by_table;
        visibility_store_normals(hits, i, geo, enu, d_enu);
        hits->kind[i] = hit_plant;
        hits->instance[i] = hit[k]->plant + 1;
        hits->facet[i] = hit[k]->level == 0 ? hit[k]->quad : UINT32_MAX; /* tables are of level 0 */
        hits->albedo[i] = albedo[k];
        hits->radius_m[i] = radius_m[k];
        hits->open_up[i] = open_up[k];
        hits->open_down[i] = open_down[k];
        const int of = !materials ? 0
                       : mark[k]  ? materials->mark[mark[k]]
                                  : materials->plant[hit[k]->kind][hit[k]->organ];
        hits->material[i] = (uint16_t)of;
        hits->inside[i] = hit[k]->organ != PLANT_LEAF && hit[k]->back;
    }
}

/* ---- shadows ---------------------------------------------------------------------------------- */

/* Traced only for rays that nothing has stopped. */
static void plants_any(const TraceShadow *s, const void *self)
{
    const Visibility *v = s->v;
    double            start[3][hits_capacity], far_m[hits_capacity];
    uint8_t           dark[hits_capacity], real[hits_capacity];
    uint32_t          plant[hits_capacity], quad[hits_capacity];
    int               ray[hits_capacity], left = 0;
    for (int i = 0; i < s->count; i++) {
        if (s->dark[i] && skips(v->skips_off, SKIP_SUN_STOPPED)) continue;
        for (int c = 0; c < 3; c++) start[c][left] = s->o_enu[c][i];
        far_m[left] = INFINITY;
        dark[left] = 0;
        const int hit = s->hit_of[i];
        real[left] = v->full_plants || s->hits->entity[hit] != 0; /* on entities falls that of real plants */
        const bool leaves = s->hits->kind[hit] == hit_plant;
        plant[left] = leaves ? s->hits->instance[hit] - 1 : UINT32_MAX;
        quad[left] = leaves ? s->hits->facet[hit] : UINT32_MAX;
        ray[left++] = i;
    }
    if (left == 0) return;
    const double *const o[3] = {start[0], start[1], start[2]};
    s->counters->rays_sun_plants +=
        forest_any_hits(dark, self, left, o, s->d_enu, far_m, &(ForestLeft){real, plant, quad});
    for (int k = 0; k < left; k++) s->dark[ray[k]] |= dark[k];
}

static const TraceEntry trace_plants = {.turn = 2,
                                        .found_octets = hits_capacity * sizeof(ForestHit),
                                        .first_hits = plants_first,
                                        .finish = plants_finish,
                                        .any_hits = plants_any};

/* ---- the list with plants, and without -------------------------------------------------------- */

Status visibility_plants(Visibility *v, const ForestFrame *plants) { return visibility_add(v, &trace_plants, plants); }

static const ListedEntry *find_plants(const Visibility *v)
{
    for (int k = 0; k < v->entries; k++)
        if (v->entry[k].of == &trace_plants) return &v->entry[k];
    return NULL;
}

const Visibility *visibility_without_plants(const Visibility *v, Arena *arena)
{
    if (!find_plants(v)) return v;
    Visibility *bare = arena_alloc(arena, 1, sizeof *bare);
    if (!bare) return NULL;
    *bare = *v;
    bare->entries = 0, bare->found_octets = 0;
    for (int k = 0; k < v->entries; k++)
        if (v->entry[k].of != &trace_plants && visibility_add(bare, v->entry[k].of, v->entry[k].self) != STATUS_OK)
            return NULL;
    return bare;
}

const Visibility *visibility_with_full_plants(const Visibility *v, Arena *arena)
{
    const ListedEntry *plants = find_plants(v);
    if (!plants || !forest_simplifies(((const ForestFrame *)plants->self)->forest)) return v;
    Visibility *full = arena_alloc(arena, 1, sizeof *full);
    if (!full) return NULL;
    *full = *v;
    full->full_plants = true;
    return full;
}
