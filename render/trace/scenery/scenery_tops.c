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

/* Triangles that stand upright cover no cell. */
static void raise_triangle(const Grid *g, const double p[3][3])
{
    const double abx = p[1][0] - p[0][0], aby = p[1][1] - p[0][1], acx = p[2][0] - p[0][0], acy = p[2][1] - p[0][1];
    const double det = abx * acy - aby * acx;
    double       low[2], high[2];
    if (!(fabs(det) > 1e-9)) return;
    for (int c = 0; c < 2; c++) {
        low[c] = fmin(p[0][c], fmin(p[1][c], p[2][c]));
        high[c] = fmax(p[0][c], fmax(p[1][c], p[2][c]));
    }
    const int left = first_cell(low[0], g->x0_m, g->cell_m, g->nx),
              right = last_cell(high[0], g->x0_m, g->cell_m, g->nx);
    const int below = first_cell(low[1], g->y0_m, g->cell_m, g->ny),
              above = last_cell(high[1], g->y0_m, g->cell_m, g->ny);
    for (int j = below; j <= above; j++)
        for (int i = left; i <= right; i++) {
            const double x = g->x0_m + i * g->cell_m - p[0][0], y = g->y0_m + j * g->cell_m - p[0][1];
            const double u = (x * acy - y * acx) / det, v = (abx * y - aby * x) / det;
            float       *z = &g->z_m[(size_t)j * (size_t)g->nx + (size_t)i];
            if (!(u >= 0 && v >= 0 && u + v <= 1)) continue;
            const double top_m = p[0][2] + u * (p[1][2] - p[0][2]) + v * (p[2][2] - p[0][2]);
            if (top_m > (double)*z) *z = (float)top_m;
        }
}

void scenery_tracer_tops(float *z_m, const SceneryTracer *t, int nx, int ny, double x0_m, double y0_m, double cell_m)
{
    const Grid grid = {z_m, nx, ny, x0_m, y0_m, cell_m};
    for (int k = 0; k < t->scenery->objects; k++) {
        const PosedEntity *e = &t->posed[k];
        for (int n = 0; e->model >= 0 && n < e->node_count; n++) {
            const double(*corner)[3];
            for (int i = 0; (corner = parts_node_triangle(&e->node[n], i)); i++) {
                double p[3][3];
                for (int c = 0; c < 3; c++) {
                    m3_mul_v3(p[c], e->node[n].r_enu_from_node, corner[c]);
                    v3_add(p[c], p[c], e->node[n].p_enu);
                }
                raise_triangle(&grid, (const double(*)[3])p);
            }
        }
    }
}
