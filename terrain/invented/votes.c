/* terrain/invented/votes.c: which entities the terrain is fitted to: robust consensus, one vote per entity.
 *
 * An entity is checked where it is nearest to others, against the plane with the most inliers among the six nearest of
 * them: nearer ones weigh more, level planes are slightly preferred to sloping ones, none is steeper than 35 degrees.
 * Planes with nearly the support of the best are accepted too. An entity farther from all of them than 1.5 m and 0.15
 * of its distance to the nearest inlier of that plane is an outlier at that place; one that is an outlier at most of
 * its places is rejected, the worst first, and is not used in later checks.
 *
 * So the fit follows a hillside with entities that rise together, a climb that starts among others, and two separate
 * groups at different heights, but not one entity 20 m below its neighbours 40 m away. With a single neighbour there is
 * no majority and no entity is checked. */
#include "terrain/invented/invented_private.h"

#include <stdlib.h>

enum { most_neighbours = 6, most_kept = 64, most_judged = 8, most_a_cell = 128 };
static const double reach_m = 300;      /* farther apart, entities do not constrain each other */
static const double apart_m = 8;        /* least distance between the positions kept of one entity */
static const double alike_m = 40;       /* neighbours nearer than this weigh about the same: the closest may be wrong */
static const double steepest = 0.7;     /* tan 35 degrees */
static const double trust_m = 1.5;      /* tolerance for two senders' terrain, suspension, model origin */
static const double free_slope = 0.15;  /* terrain between entities may deviate from a plane by this slope */
static const double agree_slope = 0.15; /* an inlier may deviate from its plane by this slope */

typedef struct ConsensusPoint {
    double p[3];
    int    voter;
} ConsensusPoint;

/* The positions of all source entities, sorted by entity. */
typedef struct Assembly {
    int             voters, places;
    int            *first; /* [voters + 2] first of each entity in `place`; voter 0 has none */
    ConsensusPoint *place;
    uint8_t        *out; /* [voters + 1] 1: the entity was rejected */
    NearGrid        near;
} Assembly;

/* ---- places ------------------------------------------------------------------------------- */

/* Positions of one source entity's fixes, each farther than step_m from the one before; returns their number. */
static int thin(ConsensusPoint *out, const GroundFix *fix, const int *number, int count, double step_m)
{
    int kept = 0;
    for (int n = 0; n < count; n++) {
        const GroundFix *f = &fix[number[n]];
        if (!v3_is_finite(f->p_enu) || fabs(f->p_enu[0]) > 1e7 || fabs(f->p_enu[1]) > 1e7) continue;
        if (kept && hypot(f->p_enu[0] - out[kept - 1].p[0], f->p_enu[1] - out[kept - 1].p[1]) < step_m) continue;
        if (kept == most_kept) return most_kept + 1;
        memcpy(out[kept].p, f->p_enu, sizeof out[kept].p);
        out[kept++].voter = f->voter;
    }
    return kept;
}

static Status assemble(Assembly *a, const GroundFix *fix, int fix_count)
{
    int *number = calloc((size_t)fix_count + 1, sizeof *number), *start = calloc((size_t)a->voters + 2, sizeof *start);
    a->first = calloc((size_t)a->voters + 2, sizeof *a->first);
    a->place = calloc((size_t)fix_count + most_kept + 1, sizeof *a->place);
    a->out = calloc((size_t)a->voters + 1, 1);
    Status status = number && start && a->first && a->place && a->out ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) { /* sorts fix numbers by source entity, keeping their order */
        for (int n = 0; n < fix_count; n++) start[fix[n].voter + 1]++;
        for (int v = 0; v <= a->voters; v++) start[v + 1] += start[v];
        for (int n = fix_count - 1; n >= 0; n--) number[--start[fix[n].voter + 1]] = n;
        for (int v = 1; v <= a->voters; v++) { /* each start is one place to the right now */
            const int first = start[v + 1], count = (v < a->voters ? start[v + 2] : fix_count) - first;
            a->first[v] = a->places;
            double step_m = apart_m;
            int    kept = thin(a->place + a->places, fix, number + first, count, step_m);
            for (; kept > most_kept; kept = thin(a->place + a->places, fix, number + first, count, step_m)) step_m *= 2;
            a->places += kept;
        }
        a->first[a->voters + 1] = a->places;
        status = near_grid_create(&a->near, reach_m, a->places, &a->place->p[0], &a->place->p[1], sizeof *a->place);
    }
    free(number);
    free(start);
    return status;
}

static void dismiss(Assembly *a)
{
    free(a->first);
    free(a->place);
    free(a->out);
    near_grid_destroy(&a->near);
}

/* ---- neighbours --------------------------------------------------------------------------- */

typedef struct Neighbour {
    double d[3], away_m, weight; /* relative to the query position */
    int    voter;
} Neighbour;

/* The nearest position of each of the nearest source entities not rejected so far, nearest first; returns their number.
 * Dense cells are sampled. */
static int find_neighbours(Neighbour out[most_neighbours], Assembly *a, const ConsensusPoint *from)
{
    int           count = 0;
    const int64_t ci = near_grid_cell(&a->near, from->p[0]), cj = near_grid_cell(&a->near, from->p[1]);
    for (int64_t j = cj - 1; j <= cj + 1; j++)
        for (int64_t i = ci - 1; i <= ci + 1; i++) {
            int first, end;
            near_grid_bucket(&a->near, i, j, &first, &end);
            const int step = 1 + (end - first) / most_a_cell;
            for (int n = first; n < end; n += step) {
                const ConsensusPoint *p = &a->place[a->near.item[n]];
                if (p->voter == from->voter || a->out[p->voter]) continue;
                Neighbour q = {.voter = p->voter};
                v3_sub(q.d, p->p, from->p);
                q.away_m = hypot(q.d[0], q.d[1]);
                if (!(q.away_m < reach_m)) continue;
                /* a nearer position of an entity replaces its farther one */
                int at = 0;
                while (at < count && out[at].voter != q.voter) at++;
                if (at < count && out[at].away_m <= q.away_m) continue;
                if (at == count && count == most_neighbours && out[count - 1].away_m <= q.away_m) continue;
                if (at == count && count < most_neighbours) count++;
                else if (at == count) at--;
                for (; at > 0 && out[at - 1].away_m > q.away_m; at--) out[at] = out[at - 1];
                out[at] = q;
            }
        }
    const double near_m = count ? fmax(out[0].away_m, alike_m) : 1;
    for (int n = 0; n < count; n++) out[n].weight = 1 / (1 + out[n].away_m * out[n].away_m / (near_m * near_m));
    return count;
}

/* ---- planes ------------------------------------------------------------------------------- */

typedef struct Plane {
    double z_m, slope[2]; /* height and slope at the query position */
    double cost;          /* share of the weight that does not support the plane, and a penalty for its slope */
    double support_m;     /* distance of its nearest supporter */
} Plane;

static void weigh(Plane *plane, const Neighbour *q, int count)
{
    static const double per_slope = 0.3;
    double              all = 0, lost = 0;
    plane->support_m = reach_m;
    for (int n = 0; n < count; n++) {
        const double off_m = fabs(plane->z_m + plane->slope[0] * q[n].d[0] + plane->slope[1] * q[n].d[1] - q[n].d[2]);
        const double share = off_m / (trust_m + agree_slope * q[n].away_m);
        all += q[n].weight;
        lost += q[n].weight * fmin(share, 1);
        if (share < 1) plane->support_m = fmin(plane->support_m, q[n].away_m);
    }
    plane->cost = lost / all + per_slope * hypot(plane->slope[0], plane->slope[1]);
}

static bool plane_through(Plane *out, const Neighbour *a, const Neighbour *b, const Neighbour *c)
{
    double       slope[2];
    const double ux = b->d[0] - a->d[0], uy = b->d[1] - a->d[1], uz = b->d[2] - a->d[2];
    if (!c) { /* two positions: sloping along the line through them, level across it */
        const double square = ux * ux + uy * uy;
        if (!(square > 1)) return false;
        slope[0] = uz * ux / square, slope[1] = uz * uy / square;
    } else {
        const double vx = c->d[0] - a->d[0], vy = c->d[1] - a->d[1], vz = c->d[2] - a->d[2], det = ux * vy - uy * vx;
        /* the three are nearly collinear, so errors of a metre would be amplified */
        if (!(fabs(det) > 0.2 * hypot(ux, uy) * hypot(vx, vy)) || !(fabs(det) > 1)) return false;
        slope[0] = (uz * vy - uy * vz) / det, slope[1] = (ux * vz - uz * vx) / det;
    }
    if (!(hypot(slope[0], slope[1]) <= steepest)) return false;
    *out = (Plane){.z_m = a->d[2] - slope[0] * a->d[0] - slope[1] * a->d[1], .slope = {slope[0], slope[1]}};
    return true;
}

enum { most_planes = 41 }; /* planes from six neighbours: level through each, through each pair, through each three */

static int candidates(Plane plane[most_planes], const Neighbour *q, int count)
{
    int planes = 0;
    for (int i = 0; i < count; i++) {
        plane[planes++] = (Plane){.z_m = q[i].d[2]};
        for (int j = i + 1; j < count; j++) {
            planes += plane_through(&plane[planes], &q[i], &q[j], NULL);
            for (int k = j + 1; k < count; k++) planes += plane_through(&plane[planes], &q[i], &q[j], &q[k]);
        }
    }
    for (int n = 0; n < planes; n++) weigh(&plane[n], q, count);
    return planes;
}

/* How far a position deviates from the consensus of its neighbours; above 1 it is an outlier. 0: it has too few
 * neighbours. */
static double contradiction(Assembly *a, const ConsensusPoint *from, double *nearest_m)
{
    static const double benefit = 0.25;
    Neighbour           q[most_neighbours];
    Plane               plane[most_planes];
    double              best = INFINITY, least = INFINITY;
    const int           count = find_neighbours(q, a, from);
    *nearest_m = count ? q[0].away_m : INFINITY;
    if (count < 2) return 0;
    const int planes = candidates(plane, q, count);
    for (int n = 0; n < planes; n++) best = fmin(best, plane[n].cost);
    for (int n = 0; n < planes; n++)
        if (plane[n].cost <= best + benefit)
            least = fmin(least, fabs(plane[n].z_m) / (trust_m + free_slope * plane[n].support_m));
    return least;
}

/* ---- source entities ---------------------------------------------------------------------- */

static int by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

/* The median deviation of an entity's positions, over those positions where it is about as near to others as it ever
 * is. */
static double judge(Assembly *a, int voter)
{
    double    found[most_judged], nearest_m[most_judged], least_m = INFINITY;
    const int first = a->first[voter], count = a->first[voter + 1] - first;
    const int asked = count < most_judged ? count : most_judged;
    for (int n = 0; n < asked; n++) {
        found[n] = contradiction(a, &a->place[first + n * count / asked], &nearest_m[n]);
        least_m = fmin(least_m, nearest_m[n]);
    }
    int kept = 0;
    for (int n = 0; n < asked; n++)
        if (nearest_m[n] <= 1.5 * least_m + apart_m) found[kept++] = found[n];
    if (kept == 0) return 0;
    qsort(found, (size_t)kept, sizeof *found, by_value);
    return found[(kept - 1) / 2];
}

typedef struct Suspect {
    double contradiction;
    int    voter;
} Suspect;

static int worst_first(const void *pa, const void *pb)
{
    const Suspect *a = pa, *b = pb;
    if (a->contradiction != b->contradiction) return a->contradiction > b->contradiction ? -1 : 1;
    return (a->voter > b->voter) - (a->voter < b->voter);
}

/* Number of source entities of the fixes; -1: invalid numbers. */
static int voters_of(const GroundFix *fix, int fix_count)
{
    int voters = 0;
    for (int n = 0; n < fix_count; n++) {
        if (fix[n].voter < 0 || fix[n].voter > fix_count) return -1;
        if (fix[n].voter > voters) voters = fix[n].voter;
    }
    return voters;
}

Status invented_inconsistent(uint8_t *outvoted, const GroundFix *fix, int fix_count)
{
    Assembly a = {.voters = voters_of(fix, fix_count)};
    if (a.voters < 0) return STATUS_BAD_VALUE;
    for (int n = 0; n < fix_count; n++) outvoted[n] = 0;
    if (a.voters < 3) return STATUS_OK; /* with fewer there is no majority */

    Status   status = assemble(&a, fix, fix_count);
    Suspect *suspect = calloc((size_t)a.voters + 1, sizeof *suspect);
    if (!suspect) status = STATUS_NO_MEMORY;
    int suspects = 0;
    for (int v = 1; status == STATUS_OK && v <= a.voters; v++) {
        const double found = judge(&a, v);
        if (found > 1) suspect[suspects++] = (Suspect){found, v};
    }
    if (suspects > 1) qsort(suspect, (size_t)suspects, sizeof *suspect, worst_first);
    for (int n = 0; n < suspects; n++) a.out[suspect[n].voter] = judge(&a, suspect[n].voter) > 1;
    for (int n = 0; status == STATUS_OK && n < fix_count; n++) outvoted[n] = a.out[fix[n].voter];
    free(suspect);
    dismiss(&a);
    return status;
}

Status invented_consensus_height(double *above_m, double *nearest_m, const double (*p_enu)[3], int count,
                                 const GroundFix *fix, int fix_count)
{
    Assembly a = {.voters = voters_of(fix, fix_count)};
    if (a.voters < 0) return STATUS_BAD_VALUE;
    const Status status = assemble(&a, fix, fix_count);
    for (int n = 0; status == STATUS_OK && n < count; n++) {
        Neighbour      q[most_neighbours];
        Plane          plane[most_planes];
        ConsensusPoint from = {.voter = 0};
        memcpy(from.p, p_enu[n], sizeof from.p);
        const int neighbours = find_neighbours(q, &a, &from), planes = candidates(plane, q, neighbours);
        above_m[n] = nearest_m[n] = NAN;
        double best = INFINITY;
        for (int k = 0; k < planes; k++) {
            if (plane[k].cost >= best) continue;
            best = plane[k].cost;
            above_m[n] = -plane[k].z_m;
        }
        if (neighbours) nearest_m[n] = q[0].away_m;
    }
    dismiss(&a);
    return status;
}
