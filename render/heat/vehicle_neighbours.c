/* render/heat/vehicle_neighbours.c: who is near enough to an entity to matter to its heat. */
#include "render/heat/vehicle_load_private.h"

static const double least_share = 0.005;  /* a quarter of one of the 48 rays of a patch */
static const double seen_radii = 15;      /* beyond the entity's own, at which they fill less */
static const double sun_radius = 0.00465; /* tangent of the sun's half width: what is smaller hides none of it whole */
static const double resting_mps = 1;

/* The most of one sort, in order. */
typedef struct Ranks {
    int       count, most, left_out;
    Neighbour of[near_seen_most];
} Ranks;

static void rank(Ranks *r, int body, double share, double fill)
{
    int at = r->count;
    while (at > 0 && r->of[at - 1].share < share) at--;
    if (r->count == r->most) r->left_out++;
    else r->count++;
    for (int k = r->count - 1; k > at; k--) r->of[k] = r->of[k - 1];
    if (at < r->count) r->of[at] = (Neighbour){body, 0, share, fill};
}

static void merge(Neighbours *out, const Ranks *r, unsigned why)
{
    out->left_out += r->left_out;
    for (int i = 0; i < r->count; i++) {
        int at = 0;
        while (at < out->count && out->of[at].body != r->of[i].body) at++;
        if (at < out->count) {
            out->of[at].why |= why;
            continue;
        }
        while (at > 0 && out->of[at - 1].share < r->of[i].share) at--;
        for (int k = out->count++; k > at; k--) out->of[k] = out->of[k - 1];
        out->of[at] = r->of[i];
        out->of[at].why = why;
    }
}

void vehicle_neighbours_find(Neighbours *out, const NearBody *body, int count, int me, const double sun_d_enu[3],
                             bool resting)
{
    Ranks seen = {.most = near_seen_most}, sun = {.most = near_sun_most}, jet = {.most = near_jet_most};
    _Static_assert(near_sun_most <= near_seen_most && near_jet_most <= near_seen_most, "Ranks has room");
    const NearBody *mine = &body[me];
    *out = (Neighbours){0};
    if (!(mine->radius_m > 0)) return;
    for (int i = 0; i < count; i++) {
        const NearBody *b = &body[i];
        double          to[3], flow[3];
        if (i == me || !(b->radius_m > 0)) continue;
        v3_sub(to, b->p_enu, mine->p_enu);
        v3_sub(flow, b->v_enu_mps, mine->v_enu_mps);
        if (resting && !(v3_dot(flow, flow) < resting_mps * resting_mps)) continue;
        const double both_m = b->radius_m + mine->radius_m, m2 = v3_dot(to, to), along_m = v3_dot(to, sun_d_enu);
        const bool   shades = sun_d_enu[2] > 0 && along_m > -both_m && m2 - along_m * along_m < both_m * both_m;
        const double far_m = mine->radius_m + fmax(seen_radii * b->radius_m, b->jet_m);
        if (!shades && m2 > far_m * far_m) continue; /* most of a large crowd */
        const double away_m = sqrt(m2), gap_m = fmax(away_m - mine->radius_m, b->radius_m);
        const double ratio = b->radius_m / gap_m, share = ratio * ratio;
        const double fill = m2 > 0 ? b->radius_m * b->radius_m / m2 : INFINITY;
        if (share >= least_share) rank(&seen, i, share, fill);
        if (shades && ratio > sun_radius) rank(&sun, i, share, fill);
        if (b->jet_m > 0 && away_m - mine->radius_m < b->jet_m) rank(&jet, i, share, fill);
    }
    merge(out, &seen, NEAR_SEEN);
    merge(out, &sun, NEAR_SUN);
    merge(out, &jet, NEAR_JET);
}
