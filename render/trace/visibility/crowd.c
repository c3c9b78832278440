/* render/trace/visibility/crowd.c: packets of rays through a tree of posed things. */
#include "render/trace/visibility/crowd.h"

/* ---- rays and spheres -------------------------------------------------------------------------- */

/* Whether each ray comes within a sphere, ahead of it and before limit_m. Plain arrays in, one flag out:
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

/* A sphere round the origins of rays. */
double rays_bound_origins(double centre[3], int count, const double *const p[3])
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

/* ---- packets ------------------------------------------------------------------------------------ */

typedef struct Walk {
    const Crowd  *crowd;
    BroadRays     rays;
    const double *o[3], *d[3]; /* rays.o and rays.d */
    int           count;       /* of rays */
    CrowdCounts  *counts;
    /* first hits */
    const CrowdAmong *among; /* NULL: all */
    const int        *index; /* [count]: of the block's rays, as those that among->known_range_m is of */
    uint32_t          item[broad_packet];
    PartHit           hit[broad_packet];
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

static void visit_first(void *user, int item)
{
    Walk   *w = user;
    double  until_m[broad_packet], nearer_m[broad_packet];
    uint8_t ask[broad_packet];
    int     list[broad_packet];
    if (w->among && (item == w->among->hidden || !is_listed(w->among->list, w->among->count, item))) return;
    const PosedEntity *entity = w->crowd->posed(w->crowd->self, item);
    if (entity->model < 0) return;
    /* at equal range the lower index has priority */
    for (int k = 0; k < w->count; k++) {
        until_m[k] = w->rays.limit_m[k];
        if (w->item[k] > (uint32_t)item + 1) until_m[k] = next_up(until_m[k]);
    }
    if (w->among && w->among->known == item) {
        for (int k = 0; k < w->count; k++) {
            const double range_m = w->among->known_range_m[w->index[k]];
            if (!(range_m < until_m[k])) continue;
            w->rays.limit_m[k] = range_m;
            w->hit[k] = w->among->known_hit[w->index[k]];
            w->item[k] = (uint32_t)item + 1;
        }
        return;
    }
    const double lift_m = w->crowd->lift_m ? w->crowd->lift_m(w->crowd->self, item) : 0;
    const double centre[3] = {entity->centre_enu[0], entity->centre_enu[1], entity->centre_enu[2] + lift_m};
    rays_meet_sphere(ask, w->count, w->o, w->d, until_m, centre, entity->radius_m);
    const int listed = list_rays(list, ask, w->count);
    if (listed == 0) return;
    for (int n = 0; n < listed; n++) nearer_m[list[n]] = INFINITY;
    w->counts->asked += (uint64_t)listed;
    w->counts->nodes += (uint64_t)listed * (uint64_t)entity->node_count;
    double              z_m[broad_packet];
    const double *const from[3] = {w->o[0], w->o[1], lowered(z_m, w->o[2], lift_m, list, listed)};
    w->counts->asked_nodes +=
        parts_first_hits(nearer_m, w->hit, entity, from, w->d, until_m, list, listed, w->crowd->ask_all);
    for (int n = 0; n < listed; n++) {
        const int k = list[n];
        if (!(nearer_m[k] < INFINITY)) continue;
        w->rays.limit_m[k] = nearer_m[k];
        w->item[k] = (uint32_t)item + 1;
    }
}

void crowd_first_hits(double *limit_m, uint32_t *item, PartHit *hit, CrowdCounts *counts, const Crowd *crowd,
                      const double *const o[3], const double *const d[3], int count, const CrowdAmong *among,
                      const int *order)
{
    Walk walk = {.crowd = crowd, .counts = counts, .among = among};
    for (int first = 0; first < count; first += broad_packet) {
        take_rays(&walk, o, d, order + first, count - first < broad_packet ? count - first : broad_packet);
        walk.index = order + first;
        for (int k = 0; k < walk.count; k++) {
            const int i = order[first + k];
            walk.rays.limit_m[k] = limit_m[i];
            walk.item[k] = item[i];
            if (item[i]) walk.hit[k] = hit[i];
        }
        broad_phase_rays_raised(crowd->tree, crowd->lift, &walk.rays, visit_first, &walk);
        for (int k = 0; k < walk.count; k++) {
            const int i = order[first + k];
            if (!walk.item[k]) continue;
            limit_m[i] = walk.rays.limit_m[k];
            item[i] = walk.item[k];
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
    const PosedEntity  *entity = w->crowd->posed(w->crowd->self, item);
    if (entity->model < 0) return;
    rays_meet_sphere(ask, w->count, w->o, w->d, far_m, entity->centre_enu, entity->radius_m);
    for (int k = 0; k < w->count; k++) ask[k] &= !w->dark[k];
    const int listed = list_rays(list, ask, w->count);
    if (listed == 0) return;
    w->counts->asked += (uint64_t)listed;
    w->counts->nodes += (uint64_t)listed * (uint64_t)entity->node_count;
    w->counts->asked_nodes += parts_any_hits(w->dark, entity, w->o, w->d, far_m, list, listed, w->crowd->ask_all);
    for (int n = 0; n < listed; n++)
        if (w->dark[list[n]]) w->rays.limit_m[list[n]] = -1;
}

void crowd_any_hits(uint8_t *dark, CrowdCounts *counts, const Crowd *crowd, int count, const double *const o[3],
                    const double *const d[3])
{
    Walk walk = {.crowd = crowd, .counts = counts};
    for (int first = 0; first < count; first += broad_packet) {
        const double *const from[3] = {o[0] + first, o[1] + first, o[2] + first}, *const way[3] = {d[0] + first,
                                                                                                   d[1] + first,
                                                                                                   d[2] + first};
        take_rays(&walk, from, way, NULL, count - first < broad_packet ? count - first : broad_packet);
        for (int k = 0; k < walk.count; k++) {
            walk.dark[k] = dark[first + k];
            walk.rays.limit_m[k] = walk.dark[k] ? -1 : INFINITY;
        }
        broad_phase_rays(crowd->tree, &walk.rays, visit_any, &walk);
        memcpy(dark + first, walk.dark, (size_t)walk.count);
    }
}
