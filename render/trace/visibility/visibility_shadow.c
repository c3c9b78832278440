/* render/trace/visibility/visibility_shadow.c: which hits lie in the shadow of what stands in the list. */
#include "render/trace/visibility/visibility_private.h"

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

void visibility_shadow(uint8_t *shadow, const Visibility *v, const Hits *hits, const double d_enu[3],
                       VisibilityCounters *counters)
{
    double  start[3][hits_capacity], towards[3][hits_capacity];
    int     hit_of[hits_capacity], order[hits_capacity], count = 0;
    uint8_t dark[hits_capacity];

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
        dark[count] = 0;
        hit_of[count++] = i;
    }
    if (count == 0) return;

    const double *const o[3] = {start[0], start[1], start[2]}, *const d[3] = {towards[0], towards[1], towards[2]};
    const TraceShadow rays = {.v = v,
                              .hits = hits,
                              .hit_of = hit_of,
                              .count = count,
                              .o_enu = o,
                              .d_enu = d,
                              .way_enu = d_enu,
                              .dark = dark,
                              .counters = counters};
    for (int k = 0; k < v->entries; k++) {
        const ListedEntry *entry = &v->entry[v->in_turn[k]];
        entry->of->any_hits(&rays, entry->self);
    }
    for (int k = 0; k < count; k++) shadow[hit_of[k]] = dark[k];
}
