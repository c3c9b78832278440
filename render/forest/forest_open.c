/* render/forest/forest_open.c: how much even light from above and from below reaches each quad past its own plant. */
#include "render/forest/forest_private.h"

enum { quads_a_task = 256, leaf_rays = 12 /* a side */, bark_rays = 8 };

typedef struct Opening {
    const ShapeScene *scene;
    PlantShape       *shape;
} Opening;

/* Direction k of count about n, as dense as the cosine to it; turned: about n, in turns. */
static void towards(double d[3], const double n[3], int k, int count, double turned)
{
    const double radius = sqrt((k + 0.5) / count), turn = 2 * pi_rad * (0.6180339887498949 * k + turned);
    double       u[3], v[3];
    v3_cross(u, n, fabs(n[2]) < 0.9 ? (const double[3]){0, 0, 1} : (const double[3]){1, 0, 0});
    v3_normalize(u, u);
    v3_cross(v, n, u);
    for (int c = 0; c < 3; c++)
        d[c] = radius * (cos(turn) * u[c] + sin(turn) * v[c]) + sqrt(1 - radius * radius) * n[c];
}

/* Rays from the middle of a quad, from one side of it: how many go up and down, and how many of these are free. */
static void count_rays(int all[2], int open[2], const ShapeScene *scene, const PlantQuad *q, int number, double side)
{
    static const double off = 1e-4; /* of the plant's height */
    const int           count = q->organ == PLANT_LEAF ? leaf_rays : bark_rays;
    double              n[3], o[3];
    for (int c = 0; c < 3; c++) {
        n[c] = side * (double)q->n[0][c];
        o[c] = off * n[c];
        for (int k = 0; k < 4; k++) o[c] += 0.25 * (double)q->corner[k][c];
    }
    for (int k = 0; k < count; k++) {
        double d[3];
        towards(d, n, k, count, random_uniform(1995, (uint32_t)(side > 0), 0, (uint64_t)number));
        const int down = d[2] < 0;
        all[down]++;
        open[down] += !shape_occluded(scene, o, d);
    }
}

static void open_quads(void *user, int worker, int task)
{
    const Opening *o = user;
    const int      first = task * quads_a_task, end = first + quads_a_task;
    (void)worker;
    for (int k = first; k < end && k < o->shape->quads; k++) {
        PlantQuad *q = &o->shape->quad[k];
        int        all[2] = {0}, open[2] = {0};
        count_rays(all, open, o->scene, q, k, 1);
        if (q->organ == PLANT_LEAF) count_rays(all, open, o->scene, q, k, -1);
        const float both = (float)(open[0] + open[1]) / (float)(all[0] + all[1]); /* where all go one way */
        q->open_up   = all[0] ? (float)open[0] / (float)all[0] : both;
        q->open_down = all[1] ? (float)open[1] / (float)all[1] : both;
    }
}

void forest_openness(Plants *plants, const Forest *forest, Pool *pool)
{
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int level = 0; level < plant_levels; level++) {
            Opening   o = {&forest->shape[kind][level], &plants->shape[kind][level]};
            const int tasks = (o.shape->quads + quads_a_task - 1) / quads_a_task;
            if (pool) pool_run(pool, tasks, open_quads, &o);
            else for (int k = 0; k < tasks; k++) open_quads(&o, 0, k);
        }
}
