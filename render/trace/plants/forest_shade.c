/* render/trace/plants/forest_shade.c: the shadows of prototypes on level ground, by slanted rays through them. */
#include "render/trace/plants/forest_private.h"

enum { shade_rays = 1024 };

/* Numbers that fill the unit cube evenly: multiples of powers of 1 / 1.2207 (Roberts' sequence in three dimensions). */
static void place_in_cube(double u[3], int k)
{
    static const double step[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    for (int c = 0; c < 3; c++) u[c] = fmod(0.5 + (k + 1) * step[c], 1);
}

/* Height at which a ray first meets the prototype; not below `none` where it meets nothing. */
static double meets_at(const ShapeScene *scene, const double from[3], const double d[3], double none)
{
    uint32_t quad;
    double   at, o[3];
    v3_sub(o, from, scene->centre);
    return shape_first(&quad, &at, scene, o, d) ? from[2] + at * d[2] : none;
}

/* Places spread over the level square in which the shadow falls, each with one ray down the way of the light and one up
 * it. What is met first from above lies higher than all else that hides the place, and so for any height says whether
 * the plant's part above that hides it; likewise from below. */
static void cast_shadow(PlantShade *out, const ShapeScene *scene, int way)
{
    const PlantShape *shape = scene->shape;
    const double      up = plant_shade_up[way], slant = sqrt(1 - up * up) / up;
    const double      x = fmax(-(double)shape->low[0], (double)shape->high[0]),
                 y = fmax(-(double)shape->low[1], (double)shape->high[1]), reach = sqrt(x * x + y * y);
    const double low = (double)shape->low[2] - 0.01, high = (double)shape->high[2] + 0.01;
    const double length = 2 * reach + slant * (high - low), per_ray = length * 2 * reach / shade_rays;
    int          above[plant_shade_heights] = {0}, below[plant_shade_heights] = {0};
    for (int k = 0; k < shade_rays; k++) {
        double u[3], from[2][3];
        place_in_cube(u, k);
        const double turn = 2 * pi_rad * u[2], c = cos(turn), s = sin(turn);
        const double along = reach - length * u[0], across = reach * (2 * u[1] - 1); /* where the ray is lowest */
        const double d[3] = {up * slant * c, up * slant * s, up}, down[3] = {-d[0], -d[1], -d[2]};
        for (int side = 0; side < 2; side++) {
            const double far = along + side * slant * (high - low);
            from[side][0] = far * c - across * s, from[side][1] = far * s + across * c;
            from[side][2] = side ? high : low;
        }
        const double lowest = meets_at(scene, from[0], d, INFINITY),
                     highest = meets_at(scene, from[1], down, -INFINITY);
        for (int h = 0; h < plant_shade_heights; h++) {
            const double at = (double)h / (plant_shade_heights - 1);
            above[h] += highest > at, below[h] += lowest < at;
        }
    }
    for (int h = 0; h < plant_shade_heights; h++)
        out->above[way][h] = (float)(per_ray * above[h]), out->below[way][h] = (float)(per_ray * below[h]);
}

typedef struct Casting {
    Plants       *plants;
    const Forest *forest;
} Casting;

static void cast_task(void *user, int worker, int task)
{
    const Casting    *c = user;
    const int         kind = task / plant_shade_ways;
    const ShapeScene *scene = &c->forest->shape[kind][forest_finest(c->forest)];
    (void)worker;
    if (scene->scene) cast_shadow(&c->plants->shade[kind], scene, task % plant_shade_ways);
}

void forest_shade(Plants *plants, const Forest *forest, Pool *pool)
{
    const int tasks = PLANT_STANDING * plant_shade_ways;
    Casting   casting = {plants, forest};
    if (pool) pool_run(pool, tasks, cast_task, &casting);
    else
        for (int k = 0; k < tasks; k++) cast_task(&casting, 0, k);
}
