/* render/trace/plants/forest_openness.c: how much even light from above and from below reaches each quad past its own
 * plant, by rays through the prototype. */
#include "render/trace/plants/forest_private.h"

enum {
    quads_a_task = 256,
    leaf_rays = 12 /* a side */,
    bark_rays = 8,
    fine_leaf_rays = 1 /* a side */,
    fine_bark_rays = 2
};

typedef struct Opening {
    const ShapeScene *scene;
    PlantShape       *shape;
    int               rays[PLANT_ORGANS]; /* a side */
    bool              shared;             /* by the quads of a spray or piece of branch */
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
static void count_rays(int all[2], int open[2], const Opening *of, const PlantQuad *q, int number, double side)
{
    static const double off = 1e-4; /* of the plant's height */
    const int           count = of->rays[q->organ];
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
        open[down] += !shape_occluded(of->scene, o, d);
    }
}

static void count_quad(int all[2], int open[2], const Opening *o, int k)
{
    const PlantQuad *q = &o->shape->quad[k];
    count_rays(all, open, o, q, k, 1);
    if (q->organ == PLANT_LEAF) count_rays(all, open, o, q, k, -1);
}

static void set_open(PlantQuad *q, const int all[2], const int open[2])
{
    const float both = (float)(open[0] + open[1]) / (float)(all[0] + all[1]); /* where all go one way */
    q->open_up = all[0] ? (float)open[0] / (float)all[0] : both;
    q->open_down = all[1] ? (float)open[1] / (float)all[1] : both;
}

/* Where quads k and l have one mean: cards of a spray. */
static bool alike(const Opening *o, int k, int l)
{
    const PlantQuad *a = &o->shape->quad[k], *b = &o->shape->quad[l];
    return k == l || (o->shared && a->organ == b->organ && a->piece == b->piece);
}

/* Spans that begin within the task's quads. */
static void open_quads(void *user, int worker, int task)
{
    const Opening *o = user;
    const int      first = task * quads_a_task, end = first + quads_a_task, quads = o->shape->quads;
    (void)worker;
    for (int k = first, next; k < end && k < quads; k = next) {
        int all[2] = {0}, open[2] = {0};
        for (next = k + 1; next < quads && alike(o, k, next);) next++;
        if (k > 0 && alike(o, k - 1, k)) continue; /* another task's */
        for (int l = k; l < next; l++) count_quad(all, open, o, l);
        for (int l = k; l < next; l++) set_open(&o->shape->quad[l], all, open);
    }
}

void forest_openness(Plants *plants, const Forest *forest, Pool *pool)
{
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int level = forest_finest(forest); level < plant_levels; level++) {
            const bool shared = level == plant_fine && kind < plants->patterned;
            Opening    o = {
                   &forest->shape[kind][level], &plants->shape[kind][level], {bark_rays, leaf_rays, bark_rays}, shared};
            if (shared) o.rays[PLANT_BARK] = fine_bark_rays, o.rays[PLANT_LEAF] = fine_leaf_rays;
            const int tasks = (o.shape->quads + quads_a_task - 1) / quads_a_task;
            if (pool) pool_run(pool, tasks, open_quads, &o);
            else
                for (int k = 0; k < tasks; k++) open_quads(&o, 0, k);
        }
}
