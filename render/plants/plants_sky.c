/* render/plants/plants_sky.c: how much light from all around reaches each quad past its own plant.
 *
 * The leaves are taken for a cloud: leaf area density in a grid of cells over the plant's box, gaps along a way
 * exp(-G x leaf area), G = 1/2 for leaves of all directions (Ross 1981), and averaged over 26 directions by the cosine
 * to the quad's front, of leaves over both sides. Branches count with the same formula: their area is a quarter of their
 * surface for a random direction. */
#include "render/plants/plants_private.h"

#include <stdlib.h>

enum { cells = 12 };

typedef struct Cloud {
    double low[3], size[3];
    float  density[cells][cells][cells]; /* one-sided area over volume, 1/m */
} Cloud;

static int cell_of(const Cloud *cloud, int axis, double x)
{
    return (int)clamp((x - cloud->low[axis]) / cloud->size[axis], 0, cells - 1);
}

static void middle_of(double p[3], const PlantQuad *q)
{
    for (int x = 0; x < 3; x++)
        p[x] = 0.25 * ((double)q->corner[0][x] + (double)q->corner[1][x] + (double)q->corner[2][x] + (double)q->corner[3][x]);
}

static void add_quad(Cloud *cloud, const PlantQuad *q)
{
    double u[3], v[3], n[3], p[3];
    for (int x = 0; x < 3; x++) {
        u[x] = (double)(q->corner[2][x] - q->corner[0][x]), v[x] = (double)(q->corner[3][x] - q->corner[1][x]);
    }
    v3_cross(n, u, v);
    middle_of(p, q);
    /* half the diagonals' product is the quad's area; half of a leaf's card is leaf, and of a branch's surface a quarter
     * is seen, twice what G makes of it */
    const double area = 0.5 * v3_length(n) * 0.5;
    cloud->density[cell_of(cloud, 0, p[0])][cell_of(cloud, 1, p[1])][cell_of(cloud, 2, p[2])] +=
        (float)(area / (cloud->size[0] * cloud->size[1] * cloud->size[2]));
}

static double gap(const Cloud *cloud, const double from[3], const double d[3])
{
    const double step = fmin(cloud->size[0], fmin(cloud->size[1], cloud->size[2]));
    double       area = 0;
    for (int k = 0; k < 3 * cells; k++) {
        double p[3];
        v3_add_scaled(p, from, (k + 0.5) * step, d);
        for (int x = 0; x < 3; x++)
            if (p[x] < cloud->low[x] || p[x] > cloud->low[x] + cells * cloud->size[x]) return exp(-0.5 * area);
        area += step * (double)cloud->density[cell_of(cloud, 0, p[0])][cell_of(cloud, 1, p[1])][cell_of(cloud, 2, p[2])];
    }
    return exp(-0.5 * area);
}

void plant_sky(PlantShape *shape)
{
    Cloud *cloud = calloc(1, sizeof *cloud);
    if (!cloud) return; /* the quads keep what a quad in the open sees */
    for (int x = 0; x < 3; x++) {
        cloud->low[x]  = (double)shape->low[x] - 1e-6;
        cloud->size[x] = ((double)shape->high[x] - (double)shape->low[x] + 2e-6) / cells;
    }
    for (int q = 0; q < shape->quads; q++) add_quad(cloud, &shape->quad[q]);
    for (int k = 0; k < shape->quads; k++) {
        PlantQuad *q = &shape->quad[k];
        double     from[3], sum = 0, all = 0;
        middle_of(from, q);
        for (int c = 0; c < 27; c++) {
            double d[3] = {c % 3 - 1, c / 3 % 3 - 1, c / 9 - 1};
            if (!v3_normalize(d, d)) continue;
            double cosine = (double)q->n[0][0] * d[0] + (double)q->n[0][1] * d[1] + (double)q->n[0][2] * d[2];
            if (q->organ == PLANT_LEAF) cosine = fabs(cosine);
            if (!(cosine > 0)) continue;
            all += cosine;
            sum += cosine * gap(cloud, from, d);
        }
        q->sky = (float)(all > 0 ? sum / all : 1);
    }
    free(cloud);
}
