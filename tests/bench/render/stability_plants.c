/* tests/bench/render/stability_plants.c: rays against plants: leaves seen edge-on, rays that skim a stand, plants far
 * from the origin and from the eye, a million in one square. The reference is every quad in long double. */
#include "tests/bench/suites.h"
#include "tests/scenes/plants_reference.h"
#include "tests/bench/stress.h"

#include <stdlib.h>

enum { block = 256 };

/* Figures of one run of a case, for its several rows. */
typedef struct PlantFigures {
    bool        done;
    PlantErrors errors;
    double      apart;  /* rays of which forest_any_hits says otherwise */
    double      octets; /* a plant */
} PlantFigures;

typedef enum PlantCase { EDGE_ON, SKIMMING, FAR, CROWDED, PLANT_CASES } PlantCase;

typedef struct PlantStress {
    Bench       *bench;
    Pool        *pool;
    Arena       *arena;
    Plants      *plants;
    PlantSpheres spheres;
    PlantFigures of[PLANT_CASES];
} PlantStress;

typedef struct Stand {
    Woods       woods;
    Forest     *forest;
    ForestFrame frame;
} Stand;

static void stand_close(Stand *stand)
{
    forest_frame_close(&stand->frame);
    forest_destroy(stand->forest);
    free(stand->woods.plant);
    free(stand->woods.first);
    *stand = (Stand){0};
}

/* So many plants in a row of squares to the east of the origin, feet at 0. The stand must not move: the forest keeps
 * the address of its plants. */
static bool stand_open(Stand *out, PlantStress *s, int squares, int a_square, double low_m, double high_m,
                       const double origin_enu[3], uint32_t stream)
{
    static const double still[2] = {0, 0};
    const ForestConfig  config = {.leaves = true};
    Dice                dice = {.stream = stream};
    Woods              *w = &out->woods;
    *out = (Stand){.woods = {.nx = squares, .ny = 1, .count = squares * a_square, .reach_m = 1e6}};
    memcpy(w->origin_enu, origin_enu, sizeof w->origin_enu);
    w->plant = calloc((size_t)w->count, sizeof *w->plant);
    w->first = calloc((size_t)squares + 1, sizeof *w->first);
    bool ok = w->plant && w->first;
    for (int i = 0; ok && i < w->count; i++) {
        const double x_m = woods_square_m * (i / a_square) + stress_uniform(&dice, 0, woods_square_m);
        w->plant[i] = (Plant){{(float)x_m, (float)stress_uniform(&dice, 0, woods_square_m), 0},
                              (uint16_t)(stress_uniform(&dice, low_m, high_m) / plant_height_step_m),
                              (uint16_t)stress_uniform(&dice, 0, 65536),
                              {(int8_t)stress_uniform(&dice, -127, 127), (int8_t)stress_uniform(&dice, -127, 127)},
                              (uint8_t)(i % PLANT_TREES),
                              (uint8_t)stress_uniform(&dice, 96, 192)};
        w->by_kind[w->plant[i].kind]++;
    }
    for (int k = 0; ok && k <= squares; k++) w->first[k] = (uint32_t)(k * a_square);
    ok = ok && forest_create(&out->forest, w, s->plants, &config, NULL) == STATUS_OK &&
         forest_frame_open(&out->frame, out->forest, origin_enu, 1000, 0, 0, still, s->pool, s->arena) == STATUS_OK;
    if (!ok) stand_close(out);
    return ok;
}

/* ---- rays ---------------------------------------------------------------------------------------- */

typedef struct PlantRays {
    int       count;
    double    o[3][block], d[3][block], range_m[block];
    ForestHit hit[block];
    uint8_t   dark[block];
} PlantRays;

static void get_ray(double o[3], double d[3], const PlantRays *r, int k)
{
    for (int c = 0; c < 3; c++) o[c] = r->o[c][k], d[c] = r->d[c][k];
}

static bool same_quad(const ForestHit *a, const ForestHit *b) { return a->plant == b->plant && a->quad == b->quad; }

static void add_ray(PlantRays *r, const double o[3], const double d[3])
{
    for (int c = 0; c < 3; c++) r->o[c][r->count] = o[c], r->d[c][r->count] = d[c];
    r->count++;
}

static void trace(PlantRays *r, const Stand *stand)
{
    const double *const o[3] = {r->o[0], r->o[1], r->o[2]}, *const d[3] = {r->d[0], r->d[1], r->d[2]};
    double far_m[block];
    for (int k = 0; k < r->count; k++) r->range_m[k] = far_m[k] = INFINITY, r->dark[k] = 0;
    forest_first_hits(r->range_m, r->hit, &stand->frame, r->count, o, d, NULL);
    forest_any_hits(r->dark, &stand->frame, r->count, o, d, far_m, NULL);
}

static void judge(PlantFigures *f, PlantRays *r, const PlantStress *s, const Stand *stand)
{
    trace(r, stand);
    for (int k = 0; k < r->count; k++) {
        double o[3], d[3];
        get_ray(o, d, r, k);
        plants_judge(&f->errors, &stand->woods, s->plants, &s->spheres, o, d, r->range_m[k], &r->hit[k]);
        f->apart += (r->range_m[k] < INFINITY) != r->dark[k];
    }
    r->count = 0;
}

/* Finds a place on a leaf of a plant, ENU, and its card's normal. */
static bool leaf_place(double p[3], double n[3], const Stand *stand, const Plants *plants, int i, Dice *dice)
{
    const Plant      *plant = &stand->woods.plant[i];
    const PlantShape *shape = &plants->shape[plant->kind][plant_whole];
    double            m[9], at[3], e[2][3], side[2][3], uv[2];
    if (shape->quads <= shape->bark_quads) return false;
    const PlantQuad *quad =
        &shape->quad[shape->bark_quads + (int)stress_uniform(dice, 0, shape->quads - shape->bark_quads)];
    do uv[0] = stress_uniform(dice, 0, 1), uv[1] = stress_uniform(dice, 0, 1);
    while (!plants_within_outline(&plants->outline[plant->kind][quad->outline], (float)uv[0], (float)uv[1]));
    plant_transform(m, plant, NULL);
    for (int c = 0; c < 3; c++) {
        e[0][c] = (double)quad->corner[1][c] - (double)quad->corner[0][c];
        e[1][c] = (double)quad->corner[3][c] - (double)quad->corner[0][c];
        at[c] = (double)quad->corner[0][c] + uv[0] * e[0][c] + uv[1] * e[1][c];
    }
    m3_mul_v3(p, m, at);
    for (int k = 0; k < 2; k++) m3_mul_v3(side[k], m, e[k]);
    for (int c = 0; c < 3; c++) p[c] += stand->woods.origin_enu[c] + (double)plant->p_m[c];
    v3_cross(n, side[0], side[1]);
    return v3_normalize(n, n);
}

/* ---- the cases ----------------------------------------------------------------------------------- */

/* Looks from 5 cm to 200 m away, 1e-4 rad from the plane of a card. */
static bool edge_on(PlantFigures *f, PlantStress *s, bool quick)
{
    static const double origin[3] = {100, -50, 300}, off_rad = 1e-4;
    Stand               stand;
    PlantRays           rays = {0};
    Dice                dice = {.stream = 71};
    if (!stand_open(&stand, s, 1, PLANT_TREES, 8, 25, origin, 70)) return false;
    for (int k = quick ? block : 24 * block; k > 0; k--) {
        double p[3], n[3], d[3], o[3], way[3];
        if (!leaf_place(p, n, &stand, s->plants, k % PLANT_TREES, &dice)) continue;
        stress_direction(way, &dice);
        v3_add_scaled(d, way, -v3_dot(way, n), n);
        if (!v3_normalize(d, d)) continue;
        v3_add_scaled(d, d, k % 2 ? off_rad : -off_rad, n);
        v3_normalize(d, d);
        v3_add_scaled(o, p, -stress_log_uniform(&dice, 0.05, 200), d);
        add_ray(&rays, o, d);
        if (rays.count == block) judge(f, &rays, s, &stand);
    }
    judge(f, &rays, s, &stand);
    stand_close(&stand);
    return true;
}

/* Over 512 m of trees of 18 .. 22 m, 0.01 degrees downwards. */
static bool skimming(PlantFigures *f, PlantStress *s, bool quick)
{
    static const double origin[3] = {-2000, 500, 120}, down = -0.01 * rad_per_deg;
    Stand               stand;
    PlantRays           rays = {0};
    Dice                dice = {.stream = 72};
    if (!stand_open(&stand, s, 8, 40, 18, 22, origin, 73)) return false;
    for (int k = quick ? block / 2 : 8 * block; k > 0; k--) {
        const double turn = stress_uniform(&dice, -0.05, 0.05);
        const double o[3] = {origin[0] - stress_log_uniform(&dice, 1, 5000), origin[1] + stress_uniform(&dice, 10, 54),
                             origin[2] + stress_uniform(&dice, 17.5, 22.5)};
        const double d[3] = {cos(down) * cos(turn), cos(down) * sin(turn), sin(down)};
        add_ray(&rays, o, d);
        if (rays.count == block) judge(f, &rays, s, &stand);
    }
    judge(f, &rays, s, &stand);
    stand_close(&stand);
    return true;
}

/* Rays to leaves of trees 200 km from the origin, from 0.1 m to 200 km. apart: rays that meet another quad than the
 * same rays where the trees stand at the origin. */
static bool far_away(PlantFigures *f, PlantStress *s, bool quick)
{
    static const double origin[2][3] = {{0, 0, 0}, {2e5 / 1.4142135623730951, 2e5 / 1.4142135623730951, -3140}};
    Stand               stand[2];
    PlantRays           rays[2] = {{0}, {0}};
    Dice                dice = {.stream = 74};
    if (!stand_open(&stand[0], s, 1, PLANT_TREES, 8, 25, origin[0], 75)) return false;
    if (!stand_open(&stand[1], s, 1, PLANT_TREES, 8, 25, origin[1], 75)) {
        stand_close(&stand[0]);
        return false;
    }
    for (int k = quick ? block : 16 * block; k > 0; k--) {
        double p[3], n[3], d[3], o[3], far[3];
        if (!leaf_place(p, n, &stand[0], s->plants, k % PLANT_TREES, &dice)) continue;
        do stress_direction(d, &dice);
        while (fabs(v3_dot(d, n)) < 0.1);
        v3_add_scaled(o, p, -stress_log_uniform(&dice, 0.1, 2e5), d);
        v3_add(far, o, origin[1]);
        for (int c = 0; c < 3; c++) o[c] = far[c] - origin[1][c]; /* the same place to the last digit of the far one */
        add_ray(&rays[0], o, d);
        add_ray(&rays[1], far, d);
        if (rays[0].count < block) continue;
        judge(f, &rays[1], s, &stand[1]);
        rays[1].count = block;
        trace(&rays[0], &stand[0]);
        for (int i = 0; i < block; i++) {
            const bool met = rays[0].range_m[i] < INFINITY;
            f->apart += met != (rays[1].range_m[i] < INFINITY) || (met && !same_quad(&rays[0].hit[i], &rays[1].hit[i]));
        }
        rays[0].count = rays[1].count = 0;
    }
    stand_close(&stand[0]);
    stand_close(&stand[1]);
    return true;
}

/* Looks at a million trees, 2 to 25 m high, in 64 x 64 m, from above and from the side. */
static bool crowded(PlantFigures *f, PlantStress *s, bool quick)
{
    static const double origin[3] = {0, 0, 40}, one_mb = 1e6;
    enum { count = 1000000 };
    Stand     stand, single;
    PlantRays rays = {0};
    Dice      dice = {.stream = 76};
    if (!stand_open(&single, s, 1, 1, 2, 25, origin, 77)) return false; /* the prototypes' own scenes */
    const double before_mb = bench_memory_mb("VmRSS:");
    const bool   made = stand_open(&stand, s, 1, count, 2, 25, origin, 77);
    if (made) f->octets = fmax(0, (bench_memory_mb("VmRSS:") - before_mb) * one_mb / count);
    for (int k = quick ? 4 : 48; made && k > 0; k--) {
        double o[3], d[3], to[3];
        for (int c = 0; c < 2; c++) to[c] = origin[c] + stress_uniform(&dice, 5, 59);
        to[2] = origin[2] + stress_uniform(&dice, 10, 30);
        stress_direction(d, &dice);
        d[2] = k % 4 ? -fabs(d[2]) : 0.2 * d[2];
        v3_normalize(d, d);
        v3_add_scaled(o, to, -stress_log_uniform(&dice, 100, 5000), d);
        add_ray(&rays, o, d);
    }
    if (made) {
        judge(f, &rays, s, &stand);
        stand_close(&stand);
    }
    stand_close(&single);
    return made;
}

static const PlantFigures *figures(void *user, bool quick, PlantCase of)
{
    static bool (*const run[PLANT_CASES])(PlantFigures *, PlantStress *, bool) = {edge_on, skimming, far_away, crowded};
    PlantStress  *s = user;
    PlantFigures *f = &s->of[of];
    if (f->done) return f;
    const bool ok = run[of](f, s, quick);
    f->done = true;
    if (!ok || f->errors.hits == 0) f->errors.past_m = f->errors.off_m = f->apart = f->octets = INFINITY;
    return f;
}

static double edge_past(void *user, bool quick) { return figures(user, quick, EDGE_ON)->errors.past_m; }
static double edge_off(void *user, bool quick) { return figures(user, quick, EDGE_ON)->errors.off_m; }
static double skim_past(void *user, bool quick) { return figures(user, quick, SKIMMING)->errors.past_m; }
static double skim_off(void *user, bool quick) { return figures(user, quick, SKIMMING)->errors.off_m; }
static double far_past(void *user, bool quick) { return figures(user, quick, FAR)->errors.past_m; }
static double far_off(void *user, bool quick) { return figures(user, quick, FAR)->errors.off_m; }
static double far_apart(void *user, bool quick) { return figures(user, quick, FAR)->apart; }
static double crowd_past(void *user, bool quick) { return figures(user, quick, CROWDED)->errors.past_m; }
static double crowd_off(void *user, bool quick) { return figures(user, quick, CROWDED)->errors.off_m; }
static double crowd_octets(void *user, bool quick) { return figures(user, quick, CROWDED)->octets; }

static double any_apart(void *user, bool quick)
{
    return figures(user, quick, EDGE_ON)->apart + figures(user, quick, SKIMMING)->apart +
           figures(user, quick, CROWDED)->apart;
}

/* Traces blocks of any size, which must give the same bits; and rays of no direction, not finite, or from 1e300 m,
 * which must meet nothing and give no NaN. */
static double company(void *user, bool quick)
{
    static const double origin[3] = {0, 0, 0};
    PlantStress        *s = user;
    Stand               stand;
    PlantRays           rays = {0};
    Dice                dice = {.stream = 78};
    double              wrong = 0;
    if (!stand_open(&stand, s, 1, 30, 8, 25, origin, 79)) return INFINITY;
    for (int n = 0; n < (quick ? 4 : 100); n++) {
        rays.count = 0;
        while (rays.count < 1 + (n * 37) % block) {
            double o[3], d[3], to[3];
            for (int c = 0; c < 3; c++) to[c] = stress_uniform(&dice, 0, c < 2 ? 64 : 25);
            stress_direction(d, &dice);
            v3_add_scaled(o, to, -stress_log_uniform(&dice, 0.1, 1e4), d);
            add_ray(&rays, o, d);
        }
        trace(&rays, &stand);
        for (int k = 0; k < rays.count; k++) {
            double    o[3], d[3];
            PlantRays alone = {0};
            get_ray(o, d, &rays, k);
            add_ray(&alone, o, d);
            trace(&alone, &stand);
            wrong += memcmp(&alone.range_m[0], &rays.range_m[k], sizeof(double)) != 0 ||
                     alone.dark[0] != rays.dark[k] ||
                     (rays.range_m[k] < INFINITY && !same_quad(&alone.hit[0], &rays.hit[k]));
        }
    }
    stand_close(&stand);
    return wrong;
}

static double odd_rays(void *user, bool quick)
{
    static const double origin[3] = {0, 0, 0};
    static const double odd[] = {0, -0.0, 1, -1, 1e-310, 1e-30, 1e30, 1e300, INFINITY, -INFINITY, NAN};
    enum { odds = sizeof odd / sizeof *odd };
    PlantStress *s = user;
    Stand        stand;
    PlantRays    rays = {0};
    Dice         dice = {.stream = 80};
    double       wrong = 0;
    if (!stand_open(&stand, s, 1, 30, 8, 25, origin, 81)) return INFINITY;
    for (int n = quick ? 10 : 200; n > 0; n--) {
        rays.count = 0;
        while (rays.count < block) {
            double o[3], d[3];
            for (int c = 0; c < 3; c++) {
                o[c] = stress_uniform(&dice, 0, 64);
                d[c] = stress_uniform(&dice, -1, 1);
                if (stress_uniform(&dice, 0, 1) < 0.5) o[c] = odd[(int)stress_uniform(&dice, 0, odds)];
                if (stress_uniform(&dice, 0, 1) < 0.5) d[c] = odd[(int)stress_uniform(&dice, 0, odds)];
            }
            /* the direction is too long or too short to be normalised */
            if (!v3_normalize(d, d) && v3_is_finite(d) && v3_dot(d, d) > 0) continue;
            add_ray(&rays, o, d);
        }
        trace(&rays, &stand);
        for (int k = 0; k < block; k++) {
            double o[3], d[3];
            get_ray(o, d, &rays, k);
            const bool real = v3_is_finite(o) && v3_is_finite(d) && v3_length(d) > 0;
            wrong += isnan(rays.range_m[k]) || rays.range_m[k] < 0 || (!real && rays.range_m[k] < INFINITY);
            if (!(rays.range_m[k] < INFINITY)) continue;
            ForestSurface at;
            forest_surface(&at, &stand.frame, &rays.hit[k], o, d, rays.range_m[k], 0.1f);
            wrong += !(fabs(v3_length(at.n_geo) - 1) < 1e-6) || !(fabs(v3_length(at.n_enu) - 1) < 1e-6);
        }
    }
    stand_close(&stand);
    return wrong;
}

Status bench_stability_plants(Bench *bench)
{
    static const char *const by = "every quad in long double";
    const StressCase         cases[] = {
                {"plants: leaves edge-on, 1e-4 rad: past an outline", edge_past, 2e-5, "m", by},
                {"plants: leaves edge-on: off the leaf", edge_off, 2e-6, "m", by},
                {"plants: skimmed tops, 0.01 degrees, 512 m: past an outline", skim_past, 2e-5, "m", by},
                {"plants: skimmed tops: off the surface", skim_off, 2e-6, "m", by},
                {"plants: trees 200 km away, eye 0.1 m .. 200 km off: past an outline", far_past, 2e-5, "m", by},
                {"plants: trees 200 km away: off the surface", far_off, 2e-6, "m", by},
                {"plants: trees at the origin and 200 km away: other hits", far_apart, 0, "rays", "those at the origin"},
                {"plants: a million trees in 64 x 64 m: past an outline", crowd_past, 2e-5, "m", by},
                {"plants: a million trees: off the surface", crowd_off, 2e-6, "m", by},
                {"plants: a million trees: memory of one", crowd_octets, 140, "octets", "resident, less that of one tree"},
                {"plants: any hit and first hit", any_apart, 0, "rays", "each other"},
                {"plants: in blocks of 1 to 256", company, 0, "rays", "one by one, to the bit"},
                {"plants: rays without length, not finite", odd_rays, 0, "answers", "no number where there is none"},
    };
    PlantStress s = {.bench = bench, .arena = arena_create()};
    Status      status = s.arena ? pool_create(&s.pool, bench_threads(bench)) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = plants_create(&s.plants, 1995, s.pool);
    if (status == STATUS_OK) status = plant_spheres_create(&s.spheres, s.plants);
    if (status == STATUS_OK) stress_cases(bench, cases, sizeof cases / sizeof *cases, &s);
    plant_spheres_destroy(&s.spheres);
    if (s.plants) plants_destroy(s.plants);
    pool_destroy(s.pool);
    arena_destroy(s.arena);
    return status;
}
