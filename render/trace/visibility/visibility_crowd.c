/* render/trace/visibility/visibility_crowd.c: packets of rays through the tree of entities, nearest first. The result
 * is that of testing one entity after the other: the nearest hit, of equals that of the lowest index. */
#include "render/trace/visibility/visibility_private.h"

typedef struct Walk {
    const Visibility *v;
    const Rays       *of; /* first hits: the block's */
    BroadRays         rays;
    const double     *o[3], *d[3]; /* rays.o and rays.d */
    int               count;       /* of rays */
    CrowdCounts      *counts;
    /* first hits */
    RayEntities among;
    const int  *index; /* [count]: of the block's rays, as those that among.known is of */
    uint32_t    entity[broad_packet];
    PartHit     hit[broad_packet];
    /* any hits */
    uint8_t dark[broad_packet];
} Walk;

static bool is_listed(const int *list, int count, int item)
{
    int low = 0;
    if (count < 0) return true;
    while (low < count) {
        const int middle = low + (count - low) / 2;
        if (list[middle] == item) return true;
        if (list[middle] < item) low = middle + 1;
        else count = middle;
    }
    return false;
}

/* Rays first .. of the order; returns their number. */
static void take_rays(Walk *w, const double *const o[3], const double *const d[3], const int *order, int count)
{
    w->count = count;
    for (int k = 0; k < broad_packet; k++) {
        const int i = k < count ? order ? order[k] : k : -1;
        for (int c = 0; c < 3; c++) {
            w->rays.o[c][k] = i < 0 ? 0 : o[c][i];
            w->rays.d[c][k] = i < 0 ? 1 : d[c][i];
        }
        w->rays.limit_m[k] = -1;
    }
    for (int c = 0; c < 3; c++) w->o[c] = w->rays.o[c], w->d[c] = w->rays.d[c];
}

/* Indices of the active rays, in order. */
static int list_rays(int list[broad_packet], const uint8_t *ask, int count)
{
    int listed = 0;
    for (int k = 0; k < count; k++)
        if (ask[k]) list[listed++] = k;
    return listed;
}

/* The next number after one that is finite and not below 0. */
static double next_up(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits++;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static void visit_first(void *user, int item)
{
    Walk   *w = user;
    double  until_m[broad_packet], nearer_m[broad_packet];
    uint8_t ask[broad_packet];
    int     list[broad_packet];
    if (item == w->among.hidden || !is_listed(w->among.list, w->among.count, item)) return;
    const PosedEntity *entity = visibility_posed(w->v, item);
    if (entity->model < 0) return;
    /* at equal range the lower index has priority */
    for (int k = 0; k < w->count; k++) {
        until_m[k] = w->rays.limit_m[k];
        if (w->entity[k] > (uint32_t)item + 1) until_m[k] = next_up(until_m[k]);
    }
    const EntityHits *known = w->among.known;
    if (known && known->entity == item) {
        for (int k = 0; k < w->count; k++) {
            const double range_m = known->range_m[w->index[k]];
            if (!(range_m < until_m[k])) continue;
            w->rays.limit_m[k] = range_m;
            w->hit[k] = known->hit[w->index[k]];
            w->entity[k] = (uint32_t)item + 1;
        }
        return;
    }
    const double lift_m = lift_for(w->v, w->of, item);
    const double centre[3] = {entity->centre_enu[0], entity->centre_enu[1], entity->centre_enu[2] + lift_m};
    rays_meet_sphere(ask, w->count, w->o, w->d, until_m, centre, entity->radius_m);
    const int listed = list_rays(list, ask, w->count);
    if (listed == 0) return;
    for (int n = 0; n < listed; n++) nearer_m[list[n]] = INFINITY;
    w->counts->asked += (uint64_t)listed;
    w->counts->nodes += (uint64_t)listed * (uint64_t)entity->node_count;
    double              z_m[broad_packet];
    const double *const from[3] = {w->o[0], w->o[1], lowered(z_m, w->o[2], lift_m, list, listed)};
    w->counts->asked_nodes += parts_first_hits(nearer_m, w->hit, entity, from, w->d, until_m, list, listed,
                                               !skips(w->v->skips_off, SKIP_PART));
    for (int n = 0; n < listed; n++) {
        const int k = list[n];
        if (!(nearer_m[k] < INFINITY)) continue;
        w->rays.limit_m[k] = nearer_m[k];
        w->entity[k] = (uint32_t)item + 1;
    }
}

void crowd_first_hits(double *limit_m, uint32_t *entity, PartHit *hit, CrowdCounts *counts, const TraceBlock *block,
                      const int *order)
{
    const int count = block->rays->count;
    Walk      walk = {.v = block->v, .of = block->rays, .counts = counts, .among = *block->among};
    for (int first = 0; first < count; first += broad_packet) {
        take_rays(&walk, block->o_enu, block->d_enu, order + first,
                  count - first < broad_packet ? count - first : broad_packet);
        walk.index = order + first;
        for (int k = 0; k < walk.count; k++) {
            const int i = order[first + k];
            walk.rays.limit_m[k] = limit_m[i];
            walk.entity[k] = 0;
        }
        broad_phase_rays(block->v->tree, &walk.rays, visit_first, &walk);
        for (int k = 0; k < walk.count; k++) {
            const int i = order[first + k];
            if (!walk.entity[k]) continue;
            limit_m[i] = walk.rays.limit_m[k];
            entity[i] = walk.entity[k];
            hit[i] = walk.hit[k];
        }
    }
}

static void visit_any(void *user, int item)
{
    static const double far_m[broad_packet] = {INFINITY, INFINITY, INFINITY, INFINITY, INFINITY, INFINITY,
                                               INFINITY, INFINITY, INFINITY, INFINITY, INFINITY, INFINITY,
                                               INFINITY, INFINITY, INFINITY, INFINITY};
    Walk               *w = user;
    uint8_t             ask[broad_packet];
    int                 list[broad_packet];
    const PosedEntity  *entity = visibility_posed(w->v, item);
    if (entity->model < 0) return;
    rays_meet_sphere(ask, w->count, w->o, w->d, far_m, entity->centre_enu, entity->radius_m);
    for (int k = 0; k < w->count; k++) ask[k] &= !w->dark[k];
    const int listed = list_rays(list, ask, w->count);
    if (listed == 0) return;
    w->counts->asked += (uint64_t)listed;
    w->counts->nodes += (uint64_t)listed * (uint64_t)entity->node_count;
    w->counts->asked_nodes +=
        parts_any_hits(w->dark, entity, w->o, w->d, far_m, list, listed, !skips(w->v->skips_off, SKIP_PART));
    for (int n = 0; n < listed; n++)
        if (w->dark[list[n]]) w->rays.limit_m[list[n]] = -1;
}

void crowd_any_hits(uint8_t *dark, CrowdCounts *counts, const Visibility *v, int count, const double *const o[3],
                    const double *const d[3])
{
    Walk walk = {.v = v, .counts = counts};
    for (int first = 0; first < count; first += broad_packet) {
        const double *const from[3] = {o[0] + first, o[1] + first, o[2] + first}, *const way[3] = {d[0] + first,
                                                                                                   d[1] + first,
                                                                                                   d[2] + first};
        take_rays(&walk, from, way, NULL, count - first < broad_packet ? count - first : broad_packet);
        for (int k = 0; k < walk.count; k++) {
            walk.dark[k] = dark[first + k];
            walk.rays.limit_m[k] = walk.dark[k] ? -1 : INFINITY;
        }
        broad_phase_rays(v->tree, &walk.rays, visit_any, &walk);
        memcpy(dark + first, walk.dark, (size_t)walk.count);
    }
}
