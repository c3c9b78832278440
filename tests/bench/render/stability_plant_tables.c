/* tests/bench/render/stability_plant_tables.c: plants by tables where it is hard: an eye in a crown or above it,
 * needles and hedges that lean, trees far from the origin, a million in one square, the sun at the horizon, rays that
 * are none. The reference is the plants themselves, of which as many rays must meet some; the order of rays must change
 * no bit. */
#include "tests/bench/suites.h"
#include "tests/bench/stress.h"

#include "render/trace/plants/forest.h"

#include <stdlib.h>

enum { block = 256 };

typedef struct TableStress {
    Pool   *pool;
    Arena  *arena;
    Plants *plants;
} TableStress;

/* How plants of a stand are made. */
typedef struct TableStand {
    int    count;
    double side_m, low_m, high_m;
    int    width[2], lean; /* Plant's own numbers; lean: at most */
    double origin_enu[3], eye_enu[3];
    double per_rad;
} TableStand;

/* Trees as they usually are, in 64 m x 64 m about the origin's north-east. */
static TableStand usual_stand(int count, double per_rad, const double eye_enu[3])
{
    TableStand s = {
        .count = count, .side_m = 64, .low_m = 8, .high_m = 25, .width = {96, 192}, .lean = 40, .per_rad = per_rad};
    memcpy(s.eye_enu, eye_enu, sizeof s.eye_enu);
    return s;
}

/* A stand by tables, and itself. It must not move. */
typedef struct Pair {
    Woods       woods;
    Forest     *forest[2];
    ForestFrame frame[2];
} Pair;

static void pair_close(Pair *p)
{
    for (int k = 0; k < 2; k++) forest_frame_close(&p->frame[k]), forest_destroy(p->forest[k]);
    free(p->woods.plant), free(p->woods.first);
    *p = (Pair){0};
}

static bool pair_open(Pair *p, TableStress *s, const TableStand *stand, uint32_t stream)
{
    static const double still[2] = {0, 0};
    Dice                dice = {.stream = stream};
    Woods              *w = &p->woods;
    *p = (Pair){.woods = {.nx = 1, .ny = 1, .count = stand->count, .reach_m = 1e6}};
    memcpy(w->origin_enu, stand->origin_enu, sizeof w->origin_enu);
    w->plant = calloc((size_t)w->count, sizeof *w->plant), w->first = calloc(2, sizeof *w->first);
    bool ok = w->plant && w->first;
    for (int i = 0; ok && i < w->count; i++)
        w->plant[i] =
            (Plant){{(float)stress_uniform(&dice, 0, stand->side_m), (float)stress_uniform(&dice, 0, stand->side_m), 0},
                    (uint16_t)(stress_uniform(&dice, stand->low_m, stand->high_m) / plant_height_step_m),
                    (uint16_t)stress_uniform(&dice, 0, 65536),
                    {(int8_t)stress_uniform(&dice, -stand->lean, stand->lean),
                     (int8_t)stress_uniform(&dice, -stand->lean, stand->lean)},
                    (uint8_t)(i % PLANT_STANDING),
                    (uint8_t)stress_uniform(&dice, stand->width[0], stand->width[1])};
    if (ok) w->first[1] = (uint32_t)w->count;
    for (int k = 0; ok && k < 2; k++) {
        const ForestConfig config = {.leaves = true, .tables = k == 0};
        ok = forest_create(&p->forest[k], w, s->plants, &config, NULL) == STATUS_OK &&
             forest_frame_open(&p->frame[k], p->forest[k], stand->eye_enu, stand->per_rad, 0, 0, still, s->pool,
                               s->arena) == STATUS_OK;
    }
    if (!ok) pair_close(p);
    return ok;
}

typedef struct TableRays {
    int       count;
    double    o[3][block], d[3][block], far_m[block], range_m[2][block];
    ForestHit hit[2][block];
    uint8_t   dark[2][block];
} TableRays;

/* What both say of many rays. */
typedef struct Both {
    double rays, met[2], range_m[2], dark[2], by_table;
    double wrong; /* ranges and normals that are none */
} Both;

static void trace(TableRays *r, Pair *p, int k)
{
    const double *const o[3] = {r->o[0], r->o[1], r->o[2]}, *const d[3] = {r->d[0], r->d[1], r->d[2]};
    for (int i = 0; i < r->count; i++) r->range_m[k][i] = r->far_m[i] = INFINITY, r->dark[k][i] = 0;
    forest_first_hits(r->range_m[k], r->hit[k], &p->frame[k], r->count, o, d, NULL);
    forest_any_hits(r->dark[k], &p->frame[k], r->count, o, d, r->far_m, NULL);
}

static void take(Both *b, TableRays *r, Pair *p)
{
    for (int k = 0; k < 2; k++) trace(r, p, k);
    b->rays += r->count;
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < r->count; i++) {
            b->dark[k] += r->dark[k][i];
            if (isnan(r->range_m[k][i]) || r->range_m[k][i] < 0) b->wrong++;
            if (!(r->range_m[k][i] < INFINITY)) continue;
            const double  o[3] = {r->o[0][i], r->o[1][i], r->o[2][i]}, d[3] = {r->d[0][i], r->d[1][i], r->d[2][i]};
            ForestSurface at;
            forest_surface(&at, &p->frame[k], &r->hit[k][i], o, d, r->range_m[k][i], 0.1f);
            b->wrong += !(fabs(v3_length(at.n_geo) - 1) < 1e-6) || !(fabs(v3_length(at.n_enu) - 1) < 1e-6) ||
                        !(at.height_share >= 0 && at.height_share <= 1);
            b->met[k]++, b->range_m[k] += r->range_m[k][i], b->by_table += r->hit[k][i].by_table;
        }
    r->count = 0;
}

/* Rays from an eye to places of the stand up to so high; all of one block from the same eye. */
static void look(TableRays *r, const TableStand *stand, double high_m, Dice *dice)
{
    while (r->count < block) {
        double d[3];
        for (int c = 0; c < 3; c++)
            d[c] = stand->origin_enu[c] + stress_uniform(dice, 0, c < 2 ? stand->side_m : high_m) - stand->eye_enu[c];
        if (!v3_normalize(d, d)) continue;
        for (int c = 0; c < 3; c++) r->o[c][r->count] = stand->eye_enu[c], r->d[c][r->count] = d[c];
        r->count++;
    }
}

/* Share of rays that meet a plant by tables, less without; in standard errors of two independent draws where that is
 * more: `apart` below 1 is no difference. */
static double apart_of(const Both *b, double limit)
{
    const double share[2] = {b->met[0] / b->rays, b->met[1] / b->rays};
    const double se = sqrt((share[0] * (1 - share[0]) + share[1] * (1 - share[1])) / b->rays);
    return b->wrong > 0 || b->by_table == 0 ? INFINITY : fmax(0, fabs(share[0] - share[1]) - 3 * se) / limit;
}

static double stand_apart(TableStress *s, const TableStand *stand, uint32_t stream, double limit, bool quick)
{
    Pair      pair;
    TableRays rays = {0};
    Both      both = {0};
    Dice      dice = {.stream = stream + 1};
    if (!pair_open(&pair, s, stand, stream)) return INFINITY;
    for (int n = quick ? 2 : 40; n > 0; n--) look(&rays, stand, stand->high_m, &dice), take(&both, &rays, &pair);
    pair_close(&pair);
    return apart_of(&both, limit);
}

/* ---- the cases ----------------------------------------------------------------------------------- */

static const double share_limit = 0.02; /* beyond chance */

/* A picture as coarse as they come, 60 px a radian: trees within some 100 m are met themselves, those beyond
 * in tables. */
static double in_a_crown(void *user, bool quick)
{
    double most = 0;
    for (int k = 0; k < 3; k++) {
        TableStand stand = usual_stand(1500, 60, (const double[3]){150, 150, (const double[]){8, 20, 60}[k]});
        stand.side_m = 300;
        most = fmax(most, stand_apart(user, &stand, 100 + 2 * (uint32_t)k, share_limit, quick));
    }
    return most;
}

/* A hundredth as wide as they are usually, leaning as far as they can. */
static double needles(void *user, bool quick)
{
    TableStand stand = usual_stand(400, 300, (const double[3]){-600, 32, 150});
    stand.low_m = 2;
    stand.lean = 127;
    stand.width[0] = 1, stand.width[1] = 8;
    return stand_apart(user, &stand, 110, share_limit, quick);
}

static double skimmed(void *user, bool quick)
{
    TableStand stand = usual_stand(200, 1000, (const double[3]){-3000, 32, 21});
    stand.low_m = 18;
    stand.high_m = 22;
    return stand_apart(user, &stand, 112, share_limit, quick);
}

static double far_away(void *user, bool quick)
{
    TableStand stand = usual_stand(100, 500, (const double[3]){1.4e5 - 1000, 1.4e5, -2900});
    memcpy(stand.origin_enu, (const double[3]){1.4e5, 1.4e5, -3140}, sizeof stand.origin_enu);
    return stand_apart(user, &stand, 114, share_limit, quick);
}

static double million(void *user, bool quick)
{
    TableStand stand = usual_stand(1000000, 500, (const double[3]){-2000, 32, 800});
    stand.low_m = 2;
    (void)quick; /* each block takes a second in full detail */
    return stand_apart(user, &stand, 116, share_limit, true);
}

/* Suns at the horizon, below it, and overhead: rays to them from among the trees are stopped as often. */
static double low_sun(void *user, bool quick)
{
    static const double up_deg[] = {-1, -0.001, 0, 0.001, 1, 90};
    TableStand          stand = usual_stand(60, 500, (const double[3]){-1000, 32, 300});
    TableStress        *s = user;
    Pair                pair;
    TableRays           rays = {0};
    Dice                dice = {.stream = 119};
    double              most = 0;
    if (!pair_open(&pair, s, &stand, 118)) return INFINITY;
    for (int k = 0; k < (int)(sizeof up_deg / sizeof *up_deg); k++) {
        const double up = up_deg[k] * rad_per_deg, turn = 0.7 + k;
        Both         both = {0};
        for (int n = quick ? 2 : 20; n > 0; n--) {
            for (; rays.count < block; rays.count++) {
                const double d[3] = {cos(up) * cos(turn), cos(up) * sin(turn), sin(up)};
                for (int c = 0; c < 3; c++) {
                    rays.o[c][rays.count] = stress_uniform(&dice, 0, c < 2 ? stand.side_m : 15);
                    rays.d[c][rays.count] = d[c];
                }
            }
            take(&both, &rays, &pair);
        }
        const double share[2] = {both.dark[0] / both.rays, both.dark[1] / both.rays};
        const double se = sqrt(2 * 0.25 / both.rays);
        most = fmax(most, fmax(0, fabs(share[0] - share[1]) - 3 * se) / share_limit);
    }
    pair_close(&pair);
    return most;
}

/* Rays of an eye in blocks of any size: the same bits. */
static double company(void *user, bool quick)
{
    TableStand stand = usual_stand(60, 300, (const double[3]){-500, 32, 100});
    Pair       pair;
    TableRays  rays = {0};
    Dice       dice = {.stream = 121};
    double     wrong = 0, tables = 0;
    if (!pair_open(&pair, user, &stand, 120)) return INFINITY;
    for (int n = 0; n < (quick ? 2 : 30); n++) {
        rays.count = 0;
        look(&rays, &stand, stand.high_m, &dice);
        rays.count = 1 + n * 37 % block;
        trace(&rays, &pair, 0);
        for (int i = 0; i < rays.count; i++) {
            TableRays alone = {.count = 1};
            for (int c = 0; c < 3; c++) alone.o[c][0] = rays.o[c][i], alone.d[c][0] = rays.d[c][i];
            trace(&alone, &pair, 0);
            const bool met = rays.range_m[0][i] < INFINITY;
            tables += met && rays.hit[0][i].by_table;
            wrong +=
                memcmp(&alone.range_m[0][0], &rays.range_m[0][i], sizeof(double)) != 0 ||
                (met && (alone.hit[0][0].plant != rays.hit[0][i].plant || alone.hit[0][0].quad != rays.hit[0][i].quad));
        }
    }
    pair_close(&pair);
    return tables > 0 ? wrong : INFINITY;
}

/* Directions without length, not finite, from the eye and from nowhere. */
static double odd_rays(void *user, bool quick)
{
    static const double odd[] = {0, -0.0, 1, -1, 1e-310, 1e-30, 1e30, 1e300, INFINITY, -INFINITY, NAN};
    enum { odds = sizeof odd / sizeof *odd };
    TableStand stand = usual_stand(60, 100, (const double[3]){32, 32, 200});
    Pair       pair;
    TableRays  rays = {0};
    Both       both = {0};
    Dice       dice = {.stream = 123};
    if (!pair_open(&pair, user, &stand, 122)) return INFINITY;
    for (int n = quick ? 10 : 200; n > 0; n--) {
        look(&rays, &stand, stand.high_m, &dice);
        for (int i = 0; i < block; i++) /* some as they are */
            for (int c = 0; c < 3; c++) {
                if (stress_uniform(&dice, 0, 1) < 0.3) rays.d[c][i] = odd[(int)stress_uniform(&dice, 0, odds)];
                if (stress_uniform(&dice, 0, 1) < 0.1) rays.o[c][i] = odd[(int)stress_uniform(&dice, 0, odds)];
            }
        take(&both, &rays, &pair);
    }
    pair_close(&pair);
    return both.by_table > 0 ? both.wrong : INFINITY;
}

Status bench_stability_plant_tables(Bench *bench)
{
    static const char *const by = "0.02 of all rays beyond chance; the plants themselves";
    const StressCase         cases[] = {
                {"plants by tables: an eye in and over a crown: share met", in_a_crown, 1, "x", by},
                {"plants by tables: needles that lean: share met", needles, 1, "x", by},
                {"plants by tables: skimmed tops: share met", skimmed, 1, "x", by},
                {"plants by tables: trees 200 km away: share met", far_away, 1, "x", by},
                {"plants by tables: a million trees in 64 x 64 m: share met", million, 1, "x", by},
                {"plants by tables: the sun at the horizon and overhead: share in shadow", low_sun, 1, "x", by},
                {"plants by tables: in blocks of 1 to 256", company, 0, "rays", "one by one, to the bit"},
                {"plants by tables: rays without length, not finite", odd_rays, 0, "answers", "no number where there is none"},
    };
    TableStress s = {.arena = arena_create()};
    Status      status = s.arena ? pool_create(&s.pool, bench_threads(bench)) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = plants_create(&s.plants, 1995, s.pool);
    if (status == STATUS_OK) stress_cases(bench, cases, sizeof cases / sizeof *cases, &s);
    if (s.plants) plants_destroy(s.plants);
    pool_destroy(s.pool);
    arena_destroy(s.arena);
    return status;
}
