/* entities/scenery/scenery_ruins.c: destroyed buildings: walls to about a third of their height, ragged, around rubble.
 */
#include "entities/scenery/scenery_buildings_private.h"

#include <stdlib.h>

static const double wall_m = 0.35, step_m = 2.5;

/* The outline with places along its edges, where the top of the wall goes up and down. */
static int ragged_outline(double (*p)[2], double *top_m, const BuildingWork *w, int most)
{
    int n = 0;
    for (int k = 0; k < w->n; k++) {
        const double *a = w->p[k], *b = w->p[(k + 1) % w->n], length_m = hypot(b[0] - a[0], b[1] - a[1]);
        const int     left = w->n - k, room = most - n - left; /* every corner has its own place */
        const int     pieces = (int)clamp(floor(length_m / step_m), 1, 1 + (room > 0 ? room : 0));
        for (int i = 0; i < pieces; i++, n++) {
            const double share = 0.15 + 0.35 * record_random(w->b->id, 128 + (uint32_t)n);
            for (int c = 0; c < 2; c++) p[n][c] = i ? a[c] + (b[c] - a[c]) * i / pieces : a[c];
            top_m[n] = share * (double)w->b->eaves_m;
        }
    }
    return n;
}

static void quad(BuildingWork *w, int slot, const double a[3], const double b[3], const double c[3], const double d[3])
{
    /* two triangles: it need not be flat */
    const double t[2][3][3] = {{{a[0], a[1], a[2]}, {b[0], b[1], b[2]}, {c[0], c[1], c[2]}},
                               {{a[0], a[1], a[2]}, {c[0], c[1], c[2]}, {d[0], d[1], d[2]}}};
    cell_face(w->cell, slot, t[0], 3);
    cell_face(w->cell, slot, t[1], 3);
}

static void floor_at(BuildingWork *w, int slot, const double (*p)[2], int n, double z, bool under)
{
    double(*q)[3] = malloc((size_t)n * sizeof *q);
    if (!q) {
        w->cell->status = STATUS_NO_MEMORY;
        return;
    }
    for (int k = 0; k < n; k++) {
        double *to = q[under ? n - 1 - k : k];
        to[0] = p[k][0], to[1] = p[k][1], to[2] = z;
    }
    cell_face(w->cell, slot, (const double(*)[3])q, n);
    free(q);
}

/* A heap in the inscribed circle of each wide triangle of the inside, a few at most. */
static void heaps_inside(BuildingWork *w, int rubble, double z)
{
    static const double least_m = 0.8, most = 6, along[2] = {1, 0};
    int(*t)[3] = malloc((size_t)w->n * sizeof *t);
    int made = 0;
    if (!t) w->cell->status = STATUS_NO_MEMORY;
    if (t && outline_triangulate(t, &w->cell->status, (const double(*)[2])w->p, w->n))
        for (int k = 0; k < w->n - 2 && made < most; k++) {
            double corner[3][2], around_m = 0, middle[3] = {0, 0, z};
            for (int i = 0; i < 3; i++) memcpy(corner[i], w->p[t[k][i]], sizeof corner[i]);
            for (int i = 0; i < 3; i++) { /* each corner weighs as the side opposite */
                const double *u = corner[(i + 1) % 3], *v = corner[(i + 2) % 3],
                             side_m = hypot(u[0] - v[0], u[1] - v[1]);
                around_m += side_m;
                for (int c = 0; c < 2; c++) middle[c] += side_m * corner[i][c];
            }
            const double radius_m = 2 * culture_area_m2((const double(*)[2])corner, 3) / around_m;
            if (radius_m < least_m) continue;
            for (int c = 0; c < 2; c++) middle[c] /= around_m;
            const double half[2] = {0.95 * (radius_m - wall_m), 0.95 * (radius_m - wall_m)};
            cell_heap(w->cell, rubble, middle, along, half, fmin(0.6 * half[0], 0.4 * (double)w->b->eaves_m),
                      w->b->id + (uint64_t)k);
            made++;
        }
    free(t);
}

void building_ruin(BuildingWork *w)
{
    const int most = w->n > 1024 ? w->n : 1024;
    double(*p)[2] = malloc((size_t)most * sizeof *p), (*in)[2] = malloc((size_t)most * sizeof *in);
    double      *top_m = malloc((size_t)most * sizeof *top_m);
    const int    rubble = cell_part(w->cell, "heap", "rubble", HEAT_PASSIVE);
    const double deck_m = w->base_m + fmin(0.4, 0.1 * (double)w->b->eaves_m), low_m = w->base_m - w->skirt_m;
    if (!p || !in || !top_m) {
        w->cell->status = STATUS_NO_MEMORY;
    } else {
        const int  n = ragged_outline(p, top_m, w, most);
        const bool hollow = n <= 1024 && outline_offset(in, (const double(*)[2])p, n, -wall_m, NULL);
        floor_at(w, w->wall, (const double(*)[2])p, n, low_m, true);
        for (int k = 0; k < n; k++) {
            const int    l = (k + 1) % n;
            const double za = hollow ? w->base_m + top_m[k] : deck_m, zb = hollow ? w->base_m + top_m[l] : deck_m;
            quad(w, w->wall, (double[3]){p[k][0], p[k][1], low_m}, (double[3]){p[l][0], p[l][1], low_m},
                 (double[3]){p[l][0], p[l][1], zb}, (double[3]){p[k][0], p[k][1], za});
            if (!hollow) continue;
            quad(w, w->lid, (double[3]){p[k][0], p[k][1], za}, (double[3]){p[l][0], p[l][1], zb},
                 (double[3]){in[l][0], in[l][1], zb}, (double[3]){in[k][0], in[k][1], za});
            quad(w, w->wall, (double[3]){in[l][0], in[l][1], deck_m}, (double[3]){in[k][0], in[k][1], deck_m},
                 (double[3]){in[k][0], in[k][1], za}, (double[3]){in[l][0], in[l][1], zb});
        }
        floor_at(w, rubble, (const double(*)[2])(hollow ? in : p), n, deck_m, false);
        heaps_inside(w, rubble, deck_m);
    }
    free(p), free(in), free(top_m);
}
