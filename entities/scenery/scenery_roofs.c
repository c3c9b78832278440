/* entities/scenery/scenery_roofs.c: roofs of buildings and what of their walls is under them: gables, lids, floors.
 *
 * The upper side of a roof passes the line of the walls at the eaves' height exactly and has its highest edge at the
 * ridge's; it is a slab of some thickness, closed in itself, that goes on over the walls by an overhang. Walls end half
 * way up inside the slab, with a lid, so that nothing is open between them. A flat roof lies between parapets. */
#include "entities/scenery/scenery_buildings_private.h"

#include <stdlib.h>

static const double thickness_m = 0.2, thatch_m = 0.35, parapet_m = 0.25, least_parapet_m = 0.1;

typedef double (*Outline)[2];

/* Height of the roof's upper side. */
typedef struct Slope {
    double z0, per_m;         /* at time or distance 0 */
    double way[2], origin[2]; /* of a skillion: up its slope */
} Slope;

static void face_of(BuildingWork *w, int slot, const double (*node)[3], const int *index, int count, double z0,
                    double per_m, bool under)
{
    double own[32][3];
    double(*p)[3] = count > 32 ? malloc((size_t)count * sizeof *p) : own;
    if (!p) {
        w->cell->status = STATUS_NO_MEMORY;
        return;
    }
    for (int k = 0; k < count; k++) {
        const double *q = node[index ? index[k] : k];
        double       *to = p[under ? count - 1 - k : k];
        to[0] = q[0], to[1] = q[1], to[2] = z0 + per_m * q[2];
    }
    cell_face(w->cell, slot, (const double(*)[3])p, count);
    if (p != own) free(p);
}

/* The upright strip between two lines over a and b; outside is to the right of its way. */
static void strip(BuildingWork *w, int slot, const double a[2], const double b[2], const double low[2],
                  const double high[2])
{
    const double p[4][3] = {{a[0], a[1], low[0]}, {b[0], b[1], low[1]}, {b[0], b[1], high[1]}, {a[0], a[1], high[0]}};
    cell_face(w->cell, slot, p, 4);
}

/* ---- slabs ---------------------------------------------------------------------------------------- */

/* Both sides of one triangle of a slab with a ragged hole inside its inscribed circle. top, under: its corners. */
static void holed_triangle(BuildingWork *w, const double (*top)[3], const double (*under)[3], uint32_t stream)
{
    double in[2][6][3]; /* around the hole: towards a corner, towards the side after it, .. */
    double side_m[3], middle[3], around_m = 0;
    for (int i = 0; i < 3; i++) { /* opposite of corner i */
        const double *a = top[(i + 1) % 3], *b = top[(i + 2) % 3];
        side_m[i] = hypot(a[0] - b[0], a[1] - b[1]), around_m += side_m[i];
    }
    const double plan[3][2] = {{top[0][0], top[0][1]}, {top[1][0], top[1][1]}, {top[2][0], top[2][1]}};
    const double radius_m = fmin(2 * culture_area_m2(plan, 3) / around_m, 3);
    for (int c = 0; c < 3; c++)
        middle[c] = (side_m[0] * top[0][c] + side_m[1] * top[1][c] + side_m[2] * top[2][c]) / around_m;
    for (int k = 0; k < 6; k++) {
        const int    i = k / 2, j = (i + 1) % 3;
        const double along = side_m[(i + 2) % 3],
                     foot = 0.5 * (along + side_m[j] - side_m[i]) / along; /* from corner i */
        double towards[3], length_m;
        for (int c = 0; c < 3; c++)
            towards[c] = (k % 2 ? top[i][c] + foot * (top[j][c] - top[i][c]) : top[i][c]) - middle[c];
        length_m = hypot(towards[0], towards[1]);
        const double reach = radius_m * (0.55 + 0.4 * record_random(w->b->id, stream + (uint32_t)k)) / length_m;
        for (int c = 0; c < 3; c++) in[0][k][c] = in[1][k][c] = middle[c] + reach * towards[c];
        in[1][k][2] -= top[0][2] - under[0][2];
    }
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < 3; i++) {
            const double *a = side ? under[i] : top[i], *b = side ? under[(i + 1) % 3] : top[(i + 1) % 3];
            const double *ha = in[side][2 * i], *m = in[side][2 * i + 1], *hb = in[side][(2 * i + 2) % 6];
            const double *corner[3][3] = {{a, b, m}, {a, m, ha}, {b, hb, m}};
            for (int t = 0; t < 3; t++) {
                double p[3][3];
                for (int k = 0; k < 3; k++) memcpy(p[side ? 2 - k : k], corner[t][k], sizeof p[k]);
                cell_face(w->cell, w->roof, (const double(*)[3])p, 3);
            }
        }
    for (int k = 0; k < 6; k++) {
        const int l = (k + 1) % 6;
        strip(w, w->roof, in[0][l], in[0][k], (double[2]){in[1][l][2], in[1][k][2]},
              (double[2]){in[0][l][2], in[0][k][2]});
    }
}

/* One face of a slab with its underside; of a damaged building perhaps with a hole in its largest triangle. */
static void slab_face(BuildingWork *w, const double (*node)[3], const int *index, int count, double z0, double under_z0,
                      double per_m)
{
    static const double least_m2 = 5;
    const uint32_t      stream = 64 + 8 * (uint32_t)w->holes++;
    const bool          holed = w->b->damage == 2 && record_random(w->b->id, stream + 7) < 0.7;
    double(*flat)[2] = holed ? malloc((size_t)count * sizeof *flat) : NULL;
    int(*triangle)[3] = holed ? malloc((size_t)count * sizeof *triangle) : NULL;
    int    largest = -1;
    double most_m2 = least_m2;
    for (int k = 0; k < count && flat && triangle; k++) memcpy(flat[k], node[index ? index[k] : k], sizeof flat[k]);
    if (holed && (!flat || !triangle)) w->cell->status = STATUS_NO_MEMORY;
    if (flat && triangle && outline_triangulate(triangle, &w->cell->status, (const double(*)[2])flat, count))
        for (int t = 0; t < count - 2; t++) {
            double p[3][2];
            for (int k = 0; k < 3; k++) memcpy(p[k], flat[triangle[t][k]], sizeof p[k]);
            const double m2 = culture_area_m2((const double(*)[2])p, 3);
            if (m2 > most_m2) most_m2 = m2, largest = t;
        }
    for (int t = 0; t < count - 2 && largest >= 0; t++) {
        double top[3][3], under[3][3], turned[3][3];
        for (int k = 0; k < 3; k++) {
            const double *q = node[index ? index[triangle[t][k]] : triangle[t][k]];
            top[k][0] = under[k][0] = q[0], top[k][1] = under[k][1] = q[1];
            top[k][2] = z0 + per_m * q[2], under[k][2] = under_z0 + per_m * q[2];
            memcpy(turned[2 - k], under[k], sizeof under[k]);
        }
        if (t == largest) {
            holed_triangle(w, (const double(*)[3])top, (const double(*)[3])under, stream);
            continue;
        }
        cell_face(w->cell, w->roof, (const double(*)[3])top, 3);
        cell_face(w->cell, w->roof, (const double(*)[3])turned, 3);
    }
    free(flat), free(triangle);
    if (largest >= 0) return;
    face_of(w, w->roof, node, index, count, z0, per_m, false);
    face_of(w, w->roof, node, index, count, under_z0, per_m, true);
}

/* ---- flat things over an outline: skillions, flat slabs, lids and floors -------------------------- */

static double height_on(const Slope *s, const double p[2])
{
    const double up_m = s->way[0] * (p[0] - s->origin[0]) + s->way[1] * (p[1] - s->origin[1]);
    return s->z0 + s->per_m * (up_m > 1e-6 || up_m < -1e-6 ? up_m : 0); /* corners along the eaves are at one height */
}

static void sheet(BuildingWork *w, int slot, const double (*p)[2], int n, const Slope *s, double lower_m, bool under)
{
    double(*node)[3] = malloc((size_t)n * sizeof *node);
    if (!node) {
        w->cell->status = STATUS_NO_MEMORY;
        return;
    }
    for (int k = 0; k < n; k++) node[k][0] = p[k][0], node[k][1] = p[k][1], node[k][2] = height_on(s, p[k]) - lower_m;
    face_of(w, slot, (const double(*)[3])node, NULL, n, 0, 1, under);
    free(node);
}

static void slab(BuildingWork *w, const double (*p)[2], const Slope *s, double thick_m)
{
    double(*node)[3] = malloc((size_t)w->n * sizeof *node);
    if (!node) {
        w->cell->status = STATUS_NO_MEMORY;
        return;
    }
    for (int k = 0; k < w->n; k++) node[k][0] = p[k][0], node[k][1] = p[k][1], node[k][2] = height_on(s, p[k]);
    slab_face(w, (const double(*)[3])node, NULL, w->n, 0, -thick_m, 1);
    free(node);
    for (int k = 0; k < w->n; k++) {
        const double *a = p[k], *b = p[(k + 1) % w->n];
        const double  high[2] = {height_on(s, a), height_on(s, b)}, low[2] = {-thick_m + high[0], -thick_m + high[1]};
        strip(w, w->roof, a, b, low, high);
    }
}

/* The outline moved outwards by the overhang: less where a corner is sharp, none where that is not possible. Returns
 * by how much. */
static double overhang(Outline out, const BuildingWork *w)
{
    static const double widest_mitre = 1.5;
    const double        sharp = outline_longest_mitre((const double(*)[2])w->p, w->n);
    const double        wanted_m = scenery_overhang_m * fmin(1, widest_mitre / sharp);
    for (double by_m = wanted_m; w->n <= 1024 && by_m > 0.05; by_m *= 0.5)
        if (outline_offset(out, (const double(*)[2])w->p, w->n, by_m, w->slit)) return by_m;
    memcpy(out, w->p, (size_t)w->n * sizeof *out);
    return 0;
}

/* Ends the upright walls at a height over the base, with a lid. */
static void lid(BuildingWork *w, double top_m)
{
    const Slope flat = {.z0 = w->base_m + top_m};
    w->top_m = top_m;
    sheet(w, w->lid, (const double(*)[2])w->p, w->n, &flat, 0, false);
}

static double roof_thickness_m(const BuildingWork *w, double slope)
{
    const double t = (w->b->roof_fabric == FABRIC_THATCH ? thatch_m : thickness_m) * sqrt(1 + slope * slope);
    return fmin(fmin(t, 0.7), 0.4 * (double)w->b->eaves_m);
}

/* Where chimneys may stand on a roof without a ridge: the middle of the longest inner line from the first corner. */
static void ridge_at(BuildingWork *w, const double a[2], const double b[2], double z)
{
    memcpy(w->ridge[0], a, sizeof w->ridge[0]), memcpy(w->ridge[1], b, sizeof w->ridge[1]);
    w->ridge_top_m = z;
}

/* A place well inside: the middle of the largest triangle. */
static void inner_place(double out[2], const BuildingWork *w)
{
    int(*t)[3] = malloc((size_t)w->n * sizeof *t);
    double best = 0;
    out[0] = w->p[0][0], out[1] = w->p[0][1];
    if (!t) w->cell->status = STATUS_NO_MEMORY;
    if (t && outline_triangulate(t, &w->cell->status, (const double(*)[2])w->p, w->n))
        for (int k = 0; k < w->n - 2; k++) {
            const double corner[3][2] = {{w->p[t[k][0]][0], w->p[t[k][0]][1]},
                                         {w->p[t[k][1]][0], w->p[t[k][1]][1]},
                                         {w->p[t[k][2]][0], w->p[t[k][2]][1]}};
            const double area = culture_area_m2(corner, 3);
            if (area <= best) continue;
            best = area;
            for (int c = 0; c < 2; c++) out[c] = (corner[0][c] + corner[1][c] + corner[2][c]) / 3;
        }
    free(t);
}

/* A ragged dark place on a flat roof: what is seen of a hole in it. */
static void burnt_patch(BuildingWork *w, const double middle[2], double z)
{
    double       p[9][2], nearest_m = 4;
    const double proud_m = 0.04;
    for (int k = 0; k < w->n; k++) {
        const double *a = w->p[k], *b = w->p[(k + 1) % w->n], length = hypot(b[0] - a[0], b[1] - a[1]);
        nearest_m = fmin(nearest_m, ((b[0] - a[0]) * (middle[1] - a[1]) - (b[1] - a[1]) * (middle[0] - a[0])) / length -
                                        parapet_m);
    }
    if (!(nearest_m > 0.3)) return;
    for (int k = 0; k < 9; k++) {
        const double a = 2 * pi_rad * k / 9, r = nearest_m * (0.4 + 0.4 * record_random(w->b->id, 48 + (uint32_t)k));
        p[k][0] = middle[0] + r * cos(a), p[k][1] = middle[1] + r * sin(a);
    }
    cell_prism(w->cell, cell_part(w->cell, "roof", "masonry_sooted", HEAT_PASSIVE), (const double(*)[2])p, 9, z - 0.02,
               z + proud_m);
}

static void flat_roof(BuildingWork *w, Outline spare)
{
    const double z = w->base_m, eaves_m = w->b->eaves_m, ridge_m = w->b->ridge_m;
    const bool   is_flat = w->b->roof == ROOF_FLAT; /* else: a slope was not possible */
    const bool   parapet = is_flat && w->b->use != BUILDING_SHED && w->n <= 1024 &&
                         outline_offset(spare, (const double(*)[2])w->p, w->n, -parapet_m, NULL);
    double inside[2];
    inner_place(inside, w);
    const double top_m = parapet ? ridge_m : eaves_m;
    const double deck_m =
        !parapet || ridge_m - eaves_m >= least_parapet_m ? eaves_m : ridge_m - fmin(0.35, ridge_m / 3);
    ridge_at(w, inside, inside, z + deck_m);
    if (parapet) {
        const Slope deck = {.z0 = z + deck_m};
        w->top_m = top_m;
        sheet(w, w->roof, (const double(*)[2])spare, w->n, &deck, 0, false);
        for (int k = 0; k < w->n; k++) {
            const int    l = (k + 1) % w->n;
            const double coping[4][3] = {{w->p[k][0], w->p[k][1], z + top_m},
                                         {w->p[l][0], w->p[l][1], z + top_m},
                                         {spare[l][0], spare[l][1], z + top_m},
                                         {spare[k][0], spare[k][1], z + top_m}};
            const double inner[4][3] = {{spare[l][0], spare[l][1], z + deck_m},
                                        {spare[k][0], spare[k][1], z + deck_m},
                                        {spare[k][0], spare[k][1], z + top_m},
                                        {spare[l][0], spare[l][1], z + top_m}};
            cell_face(w->cell, w->wall, coping, 4);
            cell_face(w->cell, w->wall, inner, 4);
        }
        if (w->b->damage > 1) burnt_patch(w, inside, z + deck_m);
        return;
    }
    const double thick_m = roof_thickness_m(w, 0);
    const double slab_m = is_flat ? ridge_m : eaves_m;
    const Slope  top = {.z0 = z + slab_m};
    overhang(spare, w);
    ridge_at(w, inside, inside, z + slab_m);
    slab(w, (const double(*)[2])spare, &top, thick_m);
    lid(w, slab_m - 0.5 * thick_m);
}

/* What of a wall is over top_m: from corner k to the next, up to heights za and zb. */
static void wall_top(BuildingWork *w, int k, double za, double zb)
{
    const double *a = w->p[k], *b = w->p[(k + 1) % w->n], low = w->base_m + w->top_m;
    double        p[4][3] = {{a[0], a[1], low}, {b[0], b[1], low}};
    int           n = 2;
    if (zb > low) p[n][0] = b[0], p[n][1] = b[1], p[n++][2] = zb;
    if (za > low) p[n][0] = a[0], p[n][1] = a[1], p[n++][2] = za;
    if (n > 2) cell_face(w->cell, w->wall, (const double(*)[3])p, n);
}

static void skillion_roof(BuildingWork *w, Outline spare)
{
    const double way[2] = {-cos((double)w->b->ridge_rad), -sin((double)w->b->ridge_rad)}; /* up */
    double       low = INFINITY, high = -INFINITY;
    int          lowest = 0;
    for (int k = 0; k < w->n; k++) {
        const double up = way[0] * w->p[k][0] + way[1] * w->p[k][1];
        if (up < low) low = up, lowest = k;
        high = fmax(high, up);
    }
    overhang(spare, w);
    double highest_up = high; /* of the overhang: the highest edge of the roof */
    for (int k = 0; k < w->n; k++) highest_up = fmax(highest_up, way[0] * spare[k][0] + way[1] * spare[k][1]);
    const double eaves_m = w->b->eaves_m, ridge_m = w->b->ridge_m;
    const Slope  s = {w->base_m + eaves_m,
                      (ridge_m - eaves_m) / (highest_up - low),
                      {way[0], way[1]},
                      {w->p[lowest][0], w->p[lowest][1]}};
    const double thick_m = roof_thickness_m(w, s.per_m);
    slab(w, (const double(*)[2])spare, &s, thick_m);
    w->top_m = eaves_m - 0.5 * thick_m;
    const Slope under = {w->base_m + w->top_m, s.per_m, {way[0], way[1]}, {s.origin[0], s.origin[1]}};
    for (int k = 0; k < w->n; k++) {
        const int l = (k + 1) % w->n;
        wall_top(w, k, height_on(&under, w->p[k]), height_on(&under, w->p[l]));
    }
    sheet(w, w->lid, (const double(*)[2])w->p, w->n, &under, 0, false);
    double inside[2];
    inner_place(inside, w);
    ridge_at(w, inside, inside, height_on(&s, inside));
}

/* ---- roofs with a plan ---------------------------------------------------------------------------- */

/* The longest line between two nodes at the top. */
static void find_ridge(BuildingWork *w, const RoofPlan *plan, double z)
{
    double longest = -1;
    for (int f = 0; f < plan->faces; f++)
        for (int k = plan->first[f]; k < plan->first[f + 1]; k++) {
            const int     next = k + 1 < plan->first[f + 1] ? k + 1 : plan->first[f];
            const double *a = plan->node[plan->index[k]], *b = plan->node[plan->index[next]];
            if (a[2] < plan->most_time_m - 1e-3) continue;
            const double *end = b[2] < plan->most_time_m - 1e-3 ? a : b;
            const double  length = hypot(end[0] - a[0], end[1] - a[1]);
            if (length > longest) longest = length, ridge_at(w, a, end, z);
        }
}

/* The slab over a plan: upper side z0 + per_m time, lower side thick_m under it, strips along eaves and verges. */
static void slab_of_plan(BuildingWork *w, const RoofPlan *plan, const bool *gable, double z0, double per_m,
                         double thick_m)
{
    const double under_z0 = z0 - thick_m;
    for (int f = 0; f < plan->faces; f++) {
        const int *index = plan->index + plan->first[f], count = plan->first[f + 1] - plan->first[f];
        const int  edge = plan->edge[f];
        if (edge < 0 || !gable || !gable[edge]) {
            slab_face(w, (const double(*)[3])plan->node, index, count, z0, under_z0, per_m);
            continue;
        }
        for (int k = 0; k < count; k++) {
            /* from right to left over the gable, seen from outside */
            const int a = index[k], b = index[(k + 1) % count];
            if (a == edge && b == (edge + 1) % plan->corners) continue;
            const double ta = per_m * plan->node[a][2], tb = per_m * plan->node[b][2];
            strip(w, w->roof, plan->node[b], plan->node[a], (double[2]){under_z0 + tb, under_z0 + ta},
                  (double[2]){z0 + tb, z0 + ta});
        }
    }
    for (int k = 0; k < plan->corners; k++)
        if (!gable || !gable[k])
            strip(w, w->roof, plan->node[k], plan->node[(k + 1) % plan->corners], (double[2]){under_z0, under_z0},
                  (double[2]){z0, z0});
}

/* Which edges end a ridge: with two right corners, no longer than their neighbours, or those of a short wing, shortest
 * first; of four edges the two across the ridge; and sides of slits. Returns how many. */
static int choose_gables(bool *gable, const BuildingWork *w)
{
    const int n = w->n;
    int       chosen = 0;
    double    longest_m = 0;
    for (int k = 0; k < n; k++)
        longest_m = fmax(longest_m, hypot(w->p[(k + 1) % n][0] - w->p[k][0], w->p[(k + 1) % n][1] - w->p[k][1]));
    for (int k = 0; k < n; k++) gable[k] = w->slit && w->slit[k], chosen += gable[k];
    for (;;) {
        int    best = -1;
        double best_length = INFINITY;
        for (int k = 0; k < n; k++) {
            const double *o = w->p[(k + n - 1) % n], *a = w->p[k], *b = w->p[(k + 1) % n], *c = w->p[(k + 2) % n];
            const double  u[2] = {a[0] - o[0], a[1] - o[1]}, d[2] = {b[0] - a[0], b[1] - a[1]};
            const double  v[2] = {c[0] - b[0], c[1] - b[1]};
            const double  lu = hypot(u[0], u[1]), ld = hypot(d[0], d[1]), lv = hypot(v[0], v[1]);
            const bool right = u[0] * d[1] - u[1] * d[0] > 0.94 * lu * ld && d[0] * v[1] - d[1] * v[0] > 0.94 * ld * lv;
            const double along = fabs(cos((double)w->b->ridge_rad) * d[0] + sin((double)w->b->ridge_rad) * d[1]);
            const bool   ends = n == 4 ? along < 0.7072 * ld
                                       : ld <= 1.001 * fmin(lu, lv) || (ld <= 2 * fmin(lu, lv) && ld <= 0.6 * longest_m);
            if (!right || !ends || gable[k] || gable[(k + n - 1) % n] || gable[(k + 1) % n]) continue;
            if (ld < best_length) best = k, best_length = ld;
        }
        if (best < 0) return chosen;
        gable[best] = true, chosen++;
    }
}

/* What of walls stands over top_m under a plan with gables, and the lid. */
static void gables_and_lid(BuildingWork *w, const RoofPlan *plan, const bool *gable, double per_m)
{
    for (int f = 0; f < plan->faces; f++)
        face_of(w, plan->edge[f] >= 0 && gable[plan->edge[f]] ? w->wall : w->lid, (const double(*)[3])plan->node,
                plan->index + plan->first[f], plan->first[f + 1] - plan->first[f], w->base_m + w->top_m, per_m, false);
}

/* A hipped roof, or one with gables; false: no plan was found. */
static bool plan_roof(BuildingWork *w, Outline spare, const bool *gable)
{
    RoofPlan     plan, under = {0};
    const double out_m = overhang(spare, w), eaves_m = w->b->eaves_m, ridge_m = w->b->ridge_m;
    if (!roof_plan_make(&plan, &w->cell->status, (const double(*)[2])spare, w->n, gable)) return false;
    const double rise_m = plan.most_time_m - out_m;
    const double per_m = rise_m > 0 ? (ridge_m - eaves_m) / rise_m : 0;
    const bool   ok = rise_m > 0.05 && per_m < 20 &&
                    (!gable || roof_plan_make(&under, &w->cell->status, (const double(*)[2])w->p, w->n, gable));
    if (ok) {
        const double thick_m = roof_thickness_m(w, per_m), z0 = w->base_m + eaves_m - per_m * out_m;
        slab_of_plan(w, &plan, gable, z0, per_m, thick_m);
        building_gutters(w, &plan, gable, z0 - 0.5 * thick_m);
        find_ridge(w, &plan, w->base_m + ridge_m);
        w->top_m = eaves_m - 0.5 * thick_m;
        if (gable) gables_and_lid(w, &under, gable, per_m);
        else lid(w, w->top_m);
    }
    roof_plan_free(&plan), roof_plan_free(&under);
    return ok;
}

/* Slopes from all walls to one point, where every wall can see it: the outline about that point, larger by so much that
 * no edge moves out by more than the overhang. */
static bool pyramid_roof(BuildingWork *w)
{
    const int n = w->n;
    double    apex[2] = {0, 0}, area = culture_area_m2((const double(*)[2])w->p, n), nearest = INFINITY, farthest = 0;
    for (int k = 0; k < n; k++) { /* centroid */
        const double *o = w->p[0], *a = w->p[k], *b = w->p[(k + 1) % n];
        const double  twice = (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
        for (int c = 0; c < 2; c++) apex[c] += twice * (o[c] + a[c] + b[c]) / (6 * area);
    }
    for (int k = 0; k < n; k++) {
        const double *a = w->p[k], *b = w->p[(k + 1) % n], length = hypot(b[0] - a[0], b[1] - a[1]);
        const double  away = ((b[0] - a[0]) * (apex[1] - a[1]) - (b[1] - a[1]) * (apex[0] - a[0])) / length;
        nearest = fmin(nearest, away), farthest = fmax(farthest, hypot(a[0] - apex[0], a[1] - apex[1]));
    }
    if (!(nearest > 0.3) || n > 64) return false;
    const double rise_m = (double)w->b->ridge_m - (double)w->b->eaves_m;
    const double grow = 1 + 1.4 * scenery_overhang_m / farthest; /* a corner moves by 1.4 overhangs at most */
    const double thick_m = roof_thickness_m(w, rise_m / nearest);
    const double z1 = w->base_m + (double)w->b->ridge_m, z0 = z1 - rise_m * grow;
    double       low[64][3];
    for (int k = 0; k < n; k++) {
        for (int c = 0; c < 2; c++) low[k][c] = apex[c] + grow * (w->p[k][c] - apex[c]);
        low[k][2] = z0;
    }
    for (int k = 0; k < n; k++) {
        const double *a = low[k], *b = low[(k + 1) % n];
        const double  top[3][3] = {{a[0], a[1], z0}, {b[0], b[1], z0}, {apex[0], apex[1], z1}};
        slab_face(w, top, NULL, 3, 0, -thick_m, 1);
        strip(w, w->roof, a, b, (double[2]){-thick_m + z0, -thick_m + z0}, (double[2]){z0, z0});
    }
    lid(w, (double)w->b->eaves_m - 0.5 * thick_m);
    ridge_at(w, apex, apex, z1);
    return true;
}

void building_roof(BuildingWork *w)
{
    double(*spare)[2] = malloc((size_t)w->n * sizeof *spare);
    bool *gable = malloc((size_t)w->n * sizeof *gable);
    if (!spare || !gable) {
        w->cell->status = STATUS_NO_MEMORY;
    } else {
        const bool sloped = w->b->ridge_m - w->b->eaves_m > 0.05F;
        bool       done = false;
        if (sloped && w->b->roof == ROOF_SKILLION) skillion_roof(w, spare), done = true;
        if (!done && sloped && w->b->roof == ROOF_PYRAMIDAL && !w->slit) done = pyramid_roof(w);
        if (!done && sloped && w->b->roof == ROOF_GABLED && w->n <= roof_plan_corners && choose_gables(gable, w) > 0)
            done = plan_roof(w, spare, gable);
        if (!done && sloped && w->b->roof != ROOF_FLAT && w->n <= roof_plan_corners)
            done = plan_roof(w, spare, w->slit); /* slopes end upright at slits */
        if (!done) flat_roof(w, spare);
        const Slope floor = {.z0 = w->base_m - w->skirt_m};
        sheet(w, w->wall, (const double(*)[2])w->p, w->n, &floor, 0, true);
    }
    free(spare), free(gable);
}
