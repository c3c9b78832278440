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

/* Shares that are free of those that go up, and down. */
static void shares_of(float open_share[2], const int all[2], const int open[2])
{
    const float both = (float)(open[0] + open[1]) / (float)(all[0] + all[1]); /* where all go one way */
    for (int k = 0; k < 2; k++) open_share[k] = all[k] ? (float)open[k] / (float)all[k] : both;
}

static void open_quads(void *user, int worker, int task)
{
    const Opening *o = user;
    const int      first = task * quads_a_task, end = first + quads_a_task;
    (void)worker;
    for (int k = first; k < end && k < o->shape->quads; k++) {
        PlantQuad *q = &o->shape->quad[k];
        int        all[2] = {0}, open[2] = {0};
        float      share[2];
        count_quad(all, open, o, k);
        shares_of(share, all, open);
        q->open_up = share[0], q->open_down = share[1];
    }
}

/* Of all quads of a shape, whose scene is built for that alone where rays do not need it otherwise. */
static Status open_shape(PlantShape *shape, const ShapeScene *traced, const Forest *forest, Pool *pool)
{
    ShapeScene   own = *traced;
    const Status status = own.scene ? STATUS_OK : shape_scene_build(&own, forest);
    if (status == STATUS_OK) {
        Opening   o = {&own, shape, {bark_rays, leaf_rays, bark_rays}};
        const int tasks = (shape->quads + quads_a_task - 1) / quads_a_task;
        if (pool) pool_run(pool, tasks, open_quads, &o);
        else
            for (int k = 0; k < tasks; k++) open_quads(&o, 0, k);
    }
    if (own.scene && !traced->scene) rtcReleaseScene(own.scene);
    return status;
}

Status forest_openness(Plants *plants, const Forest *forest, Pool *pool)
{
    Status status = STATUS_OK;
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int level = kind < plants->patterned ? plant_whole : forest_finest(forest);
             level < plant_levels && status == STATUS_OK; level++)
            status = open_shape(&plants->shape[kind][level], &forest->shape[kind][level], forest, pool);
    return status;
}

/* ---- patterned shapes: when a quad is first asked for ------------------------------------------- */

void plant_openness(float open_share[2], const ShapeScene *scene, uint32_t quad)
{
    PlantShape *shape = (PlantShape *)(uintptr_t)scene->shape;
    if (plant_open_get(open_share, &shape->quad[quad])) return;
    if (!shape_kept_is_taken(scene->kept, kept_light)) {
        shape_kept_take(scene->kept, kept_light);
        if (plant_open_get(open_share, &shape->quad[quad])) return;
    }
    const Opening o = {scene, shape, {fine_bark_rays, fine_leaf_rays, fine_bark_rays}};
    int           first = (int)quad, end = (int)quad + 1, all[2] = {0}, open[2] = {0};
    while (first > 0 && plant_quads_alike(shape, first - 1, first)) first--;
    while (end < shape->quads && plant_quads_alike(shape, end - 1, end)) end++;
    for (int k = first; k < end; k++) count_quad(all, open, &o, k);
    shares_of(open_share, all, open);
    for (int k = first; k < end; k++) plant_open_set(&shape->quad[k], open_share);
    shape_kept_count(scene->kept, kept_light, 1);
}
