/* render/trace/scenery/scenery_tops.c: scenery seen from above, on a grid. */
#include "render/trace/scenery/scenery_tracer_private.h"

typedef struct Grid {
    float *z_m;
    int    nx, ny;
    double x0_m, y0_m, cell_m;
} Grid;

/* The first cell at or behind a place, and the last at or before it. */
static int first_cell(double x_m, double x0_m, double cell_m, int n)
{
    return (int)clamp(ceil((x_m - x0_m) / cell_m), 0, n);
}
static int last_cell(double x_m, double x0_m, double cell_m, int n)
{
    return (int)clamp(floor((x_m - x0_m) / cell_m), -1, n - 1);
}

/* Not fmin and fmax, which compile to calls. */
static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

/* Cells whose middles may lie below something between two corners, along x and y. */
typedef struct Cells {
    int first[2], last[2];
} Cells;

static bool cells_along(Cells *out, const Grid *g, int c, double low_m, double high_m)
{
    out->first[c] = first_cell(low_m, c ? g->y0_m : g->x0_m, g->cell_m, c ? g->ny : g->nx);
    out->last[c] = last_cell(high_m, c ? g->y0_m : g->x0_m, g->cell_m, c ? g->ny : g->nx);
    return out->first[c] <= out->last[c];
}

/* Triangles that stand upright cover no cell. */
static void raise_triangle(const Grid *g, const Cells *in, const double p[3][3])
{
    const double abx = p[1][0] - p[0][0], aby = p[1][1] - p[0][1], acx = p[2][0] - p[0][0], acy = p[2][1] - p[0][1];
    const double det = abx * acy - aby * acx;
    if (!(fabs(det) > 1e-9)) return;
    for (int j = in->first[1]; j <= in->last[1]; j++)
        for (int i = in->first[0]; i <= in->last[0]; i++) {
            const double x = g->x0_m + i * g->cell_m - p[0][0], y = g->y0_m + j * g->cell_m - p[0][1];
            const double u = (x * acy - y * acx) / det, v = (abx * y - aby * x) / det;
            float       *z = &g->z_m[(size_t)j * (size_t)g->nx + (size_t)i];
            if (!(u >= 0 && v >= 0 && u + v <= 1)) continue;
            const double top_m = p[0][2] + u * (p[1][2] - p[0][2]) + v * (p[2][2] - p[0][2]);
            if (top_m > (double)*z) *z = (float)top_m;
        }
}

/* Most triangles lie between the cells' middles along x or y: one coordinate of their corners at a time. */
static void raise_node(const Grid *g, const PosedNode *node)
{
    const double *r = node->r_enu_from_node;
    double        corner[3][3];
    for (int k = 0; parts_node_triangle(corner, node, k); k++) {
        double p[3][3];
        Cells  in;
        bool   some = true;
        for (int c = 0; c < 3 && some; c++) {
            for (int i = 0; i < 3; i++) p[i][c] = v3_dot(r + 3 * c, corner[i]) + node->p_enu[c];
            if (c < 2)
                some = cells_along(&in, g, c, smaller(p[0][c], smaller(p[1][c], p[2][c])),
                                   larger(p[0][c], larger(p[1][c], p[2][c])));
        }
        if (some) raise_triangle(g, &in, (const double(*)[3])p);
    }
}

void scenery_tracer_tops(float *z_m, const SceneryTracer *t, int nx, int ny, double x0_m, double y0_m, double cell_m)
{
    const Grid grid = {z_m, nx, ny, x0_m, y0_m, cell_m};
    for (int k = 0; k < t->scenery->objects; k++) {
        const PosedEntity *e = &t->posed[k];
        double             low[3], high[3];
        Cells              in;
        if (!parts_posed_box(low, high, e)) continue; /* and far less than its margin is rounded */
        if (!cells_along(&in, &grid, 0, low[0], high[0]) || !cells_along(&in, &grid, 1, low[1], high[1])) continue;
        for (int n = 0; n < e->node_count; n++) raise_node(&grid, &e->node[n]);
    }
}
