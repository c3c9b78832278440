/* Plants by tables: against the plants themselves, closed forms, and in any order of rays. */
#include "render/trace/plants/forest_private.h"
#include "tests/check.h"
#include "tests/render/hand_plants.h"

static const double storm_mps[2] = {20, 0}, origin[3] = {0, 0, 0};

enum { rays = 4096 };

typedef struct Stage {
    Forest     *forest;
    Arena      *arena;
    ForestFrame frame;
    double      o[3][rays], d[3][rays], range_m[rays], far_m[rays];
    ForestHit   hit[rays];
    uint8_t     dark[rays];
} Stage;

static Stage  by_table, by_plant;
static double sway;   /* of forests opened from now on, in a storm */
static bool   finest; /* and whether they have the finest leaves, everywhere */

static void open_stage(Stage *s, const Woods *woods, bool tables, const double eye_enu[3], double per_rad)
{
    const ForestConfig config = {.leaves = true, .fine = finest, .all_fine = finest, .tables = tables, .sway = sway};
    s->arena = arena_create();
    assert_non_null(s->arena);
    assert_int_equal(forest_create(&s->forest, woods, &hand_plants, &config, "avx2"), STATUS_OK);
    assert_int_equal(forest_frame_open(&s->frame, s->forest, eye_enu, per_rad, 0, 0, storm_mps, NULL, s->arena),
                     STATUS_OK);
}

static void close_stage(Stage *s)
{
    forest_frame_close(&s->frame);
    forest_destroy(s->forest);
    arena_destroy(s->arena);
}

static void first_hits(Stage *s, int from, int count, const uint8_t *real)
{
    const double *const o[3] = {s->o[0] + from, s->o[1] + from, s->o[2] + from};
    const double *const d[3] = {s->d[0] + from, s->d[1] + from, s->d[2] + from};
    for (int i = from; i < from + count; i++) s->range_m[i] = INFINITY;
    forest_first_hits(s->range_m + from, s->hit + from, &s->frame, count, o, d, real);
}

static void any_hits(Stage *s, const ForestLeft *left)
{
    const double *const o[3] = {s->o[0], s->o[1], s->o[2]}, *const d[3] = {s->d[0], s->d[1], s->d[2]};
    for (int i = 0; i < rays; i++) s->far_m[i] = INFINITY, s->dark[i] = 0;
    forest_any_hits(s->dark, &s->frame, rays, o, d, s->far_m, left);
}

/* Rays from an eye to places of a box. */
static void look(Stage *s, const double eye_enu[3], const double low[3], const double high[3])
{
    for (int i = 0; i < rays; i++) {
        double way[3];
        for (int c = 0; c < 3; c++)
            way[c] = low[c] + (high[c] - low[c]) * hand_dice(50 + (uint32_t)c, (uint64_t)i) - eye_enu[c];
        v3_normalize(way, way);
        for (int c = 0; c < 3; c++) s->o[c][i] = eye_enu[c], s->d[c][i] = way[c];
    }
}

/* ---- the tables ------------------------------------------------------------------------------- */

/* The way found is the nearest of all, but for 0.6 degrees of a rough angle on either side; none rises above 15. */
static void nearest_way(void **state)
{
    static Plant plant[1];
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 1, origin, 1);
    plant[0].kind = PLANT_PINE;
    open_stage(&by_table, &woods, true, origin, 1000);
    const PlantTable *table = by_table.forest->table[PLANT_PINE];
    for (uint64_t i = 0; i < 5000; i++) {
        double d[3], nearest = -1;
        hand_plant_direction(d, 60, i);
        const int way = plant_table_way(d);
        if (d[2] > sin(15.4 * rad_per_deg)) CHECK(way < 0);
        if (d[2] > sin(14.6 * rad_per_deg)) continue;
        CHECK(way >= 0 && way < table_ways);
        for (int w = 0; w < table_ways; w++) {
            const double with = v3_dot(d, table->way[w].d);
            nearest = with > nearest ? with : nearest;
        }
        CHECK(acos(fmin(v3_dot(d, table->way[way].d), 1)) < acos(fmin(nearest, 1)) + 1.3 * rad_per_deg);
        CHECK(d[2] < -0.99 || acos(nearest) < 6.8 * rad_per_deg); /* half of 11.25 and of 7.5 degrees */
    }
    CHECK(plant_table_way((const double[3]){0, 0, -1}) >= 0 && plant_table_way((const double[3]){0, 0, 1}) < 0);
    close_stage(&by_table);
}

/* A coarser texel is one of those that it covers, each as likely; asked for again, and of another forest, it is the
 * same. */
static void coarse_texels(void **state)
{
    static Plant plant[1];
    int          chosen[4] = {0}, many = 0;
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 1, origin, 1);
    open_stage(&by_table, &woods, true, origin, 1000), open_stage(&by_plant, &woods, true, origin, 1000);
    PlantTable *a = by_table.forest->table[PLANT_ALDER], *b = by_plant.forest->table[PLANT_ALDER];
    enum { way = 100, side = table_side / 2 };
    for (int place = side * side - 1; place >= 0; place--) {
        const uint32_t texel = plant_table_trace(a, way, 1, place);
        int            same = 0, which = 0;
        CHECK(texel != table_unset);
        for (int k = 0; k < 4; k++) {
            const int      fine = (place / side * 2 + k / 2) * table_side + place % side * 2 + k % 2;
            const uint32_t of = plant_table_trace(b, way, 0, fine);
            if (of == texel) same++, which = k;
        }
        CHECK(same > 0);
        if (same == 1) chosen[which]++, many++;
        CHECK(plant_table_trace(b, way, 1, place) == texel && plant_table_trace(a, way, 1, place) == texel);
    }
    CHECK(many > 200);
    for (int k = 0; k < 4; k++) CHECK_NEAR(chosen[k] / (double)many, 0.25, 4 * sqrt(0.25 * 0.75 / many));
    close_stage(&by_table), close_stage(&by_plant);
}

/* ---- hits ------------------------------------------------------------------------------------- */

/* A level plate, 6 m wide and 6 m high, of plants turned every way, 200 m off and 30 degrees below the eye. A table's
 * hits lie on the plate but for half a step of direction over half the plate (0.35 m across, twice that along a ray
 * that comes in at 30 degrees) and a texel; as many rays meet it, and as far away in the mean. */
static void plates_in(void)
{
    enum { turns = 64 };
    static Plant plant[turns];
    const double eye[3] = {0, 0, 6 + 200 * tan(30 * rad_per_deg)};
    double       apart = 0, apart2 = 0, most = 0;
    int          met[2] = {0}, both = 0;
    hand_grow(true, 0.06);
    for (int kind = 0; kind < PLANT_KINDS; kind++) {
        PlantShape *s = &hand_plants.shape[kind][plant_whole];
        hand_leaf(s->quad, (const double[3]){0, 0, 0.6}, (const double[3]){0, 0, 1}, 0.6, 0);
        s->quads = s->leaves = 1, s->pieces = s->bark_quads = 0;
        for (int c = 0; c < 3; c++) s->low[c] = c < 2 ? -0.3f : 0.59f, s->high[c] = c < 2 ? 0.3f : 0.61f;
    }
    Woods woods = hand_stand(plant, turns, origin, 1);
    for (int k = 0; k < turns; k++)
        plant[k] =
            (Plant){.p_m = {(float)(200 * cos(2 * pi_rad * k / turns)), (float)(200 * sin(2 * pi_rad * k / turns)), 0},
                    .height = 1000,
                    .width = 128,
                    .kind = (uint8_t)(k % PLANT_STANDING),
                    .twist = (uint16_t)(65535 * hand_dice(70, (uint64_t)k))};
    open_stage(&by_table, &woods, true, eye, 100), open_stage(&by_plant, &woods, false, eye, 100);
    by_table.frame.ray_px = 0.01; /* texels of the finest level */
    for (int k = 0; k < turns; k++) {
        const float *p = plant[k].p_m;
        const double low[3] = {(double)p[0] - 5, (double)p[1] - 5, 6},
                     high[3] = {(double)p[0] + 5, (double)p[1] + 5, 6};
        look(&by_table, eye, low, high), look(&by_plant, eye, low, high);
        first_hits(&by_table, 0, rays, NULL), first_hits(&by_plant, 0, rays, NULL);
        for (int i = 0; i < rays; i++) {
            const bool hit[2] = {by_table.range_m[i] < INFINITY, by_plant.range_m[i] < INFINITY};
            met[0] += hit[0], met[1] += hit[1];
            if (hit[0]) CHECK(by_table.hit[i].by_table && by_table.hit[i].plant == (uint32_t)k);
            if (!hit[0] || !hit[1]) continue;
            const double off_m = by_table.range_m[i] - by_plant.range_m[i];
            both++, apart += off_m, apart2 += off_m * off_m, most = fmax(most, fabs(off_m));
        }
    }
    printf("met %d by table, %d; %.3f m farther, rms %.3f m, at most %.2f m\n", met[0], met[1], apart / both,
           sqrt(apart2 / both), most);
    CHECK(met[1] > 50000);
    CHECK_NEAR(met[0] / (double)met[1], 1, 0.02);
    CHECK(fabs(apart / both) < 0.03 && sqrt(apart2 / both) < 0.3 && most < 1);
    close_stage(&by_table), close_stage(&by_plant);
}

static void plates(void **state)
{
    (void)state;
    plates_in();
    sway = 3; /* plants lean by 0.1 rad and more, out of the boxes that they have when they stand still */
    plates_in();
    sway = 0;
}

/* Rays that must meet plants themselves, or that do not leave the eye, or rise too steeply, or meet plants that are
 * high in the picture, have the bits of a forest without tables. */
static void plants_themselves(void **state)
{
    static Plant   plant[60];
    static uint8_t real[rays];
    const double   far_eye[3] = {0, -3000, 40}, below[3] = {10, -60, -60}, elsewhere[3] = {1, -60, 9};
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 60, origin, 30);
    memset(real, 1, sizeof real);
    for (int k = 0; k < 4; k++) {
        /* far away, from where the eye is not, from below, and near */
        const double *eye = k < 2 ? far_eye : k == 2 ? below : elsewhere, *from = k == 1 ? elsewhere : eye;
        open_stage(&by_table, &woods, true, eye, k == 2 ? 10 : k == 3 ? 3000 : 1000);
        open_stage(&by_plant, &woods, false, eye, 1000);
        const double low[3] = {-30, -30, 0}, high[3] = {30, 30, 16};
        look(&by_table, from, low, high), look(&by_plant, from, low, high);
        first_hits(&by_table, 0, rays, k == 0 ? real : NULL), first_hits(&by_plant, 0, rays, NULL);
        int met = 0, tables = 0;
        for (int i = 0; i < rays; i++) {
            const ForestHit *a = &by_table.hit[i], *b = &by_plant.hit[i];
            CHECK(by_table.range_m[i] == by_plant.range_m[i]);
            if (!(by_plant.range_m[i] < INFINITY)) continue;
            met++, tables += a->by_table;
            CHECK(a->plant == b->plant && a->quad == b->quad && a->uv[0] == b->uv[0] && a->back == b->back);
        }
        CHECK(met > 300 && tables == 0);
        close_stage(&by_table), close_stage(&by_plant);
    }
}

/* From far off the same share of rays meets plants, at the same mean range, of the same organs. */
static void as_often(void **state)
{
    static Plant plant[300];
    const double eye[3] = {0, -700, 150}, low[3] = {-60, -60, 0}, high[3] = {60, 60, 14};
    double       mean_m[2] = {0};
    int          met[2] = {0}, leaves[2] = {0};
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 300, origin, 60);
    open_stage(&by_table, &woods, true, eye, 300), open_stage(&by_plant, &woods, false, eye, 300);
    Stage *s[2] = {&by_table, &by_plant};
    for (int k = 0; k < 2; k++) {
        look(s[k], eye, low, high), first_hits(s[k], 0, rays, NULL);
        for (int i = 0; i < rays; i++) {
            if (!(s[k]->range_m[i] < INFINITY)) continue;
            met[k]++, mean_m[k] += s[k]->range_m[i], leaves[k] += s[k]->hit[i].organ == PLANT_LEAF;
        }
        mean_m[k] /= met[k];
    }
    printf("%d met by table, %d; mean %.2f, %.2f m; leaves %d, %d\n", met[0], met[1], mean_m[0], mean_m[1], leaves[0],
           leaves[1]);
    CHECK(met[1] > rays / 4 && met[1] < rays * 9 / 10);
    CHECK(abs(met[0] - met[1]) < 3 * sqrt(rays * 0.25)); /* of as many draws, at most */
    CHECK_NEAR(mean_m[0], mean_m[1], 2);
    CHECK(abs(leaves[0] - leaves[1]) < 3 * sqrt(rays * 0.25));
    close_stage(&by_table), close_stage(&by_plant);
}

/* A place on its quad, of which plant_complete says: within it, and nearest to the hit; what follows from the quad. */
static void completed(void **state)
{
    static Plant plant[60];
    const double eye[3] = {0, -700, 150}, low[3] = {-30, -30, 0}, high[3] = {30, 30, 14};
    int          met = 0;
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 60, origin, 30);
    open_stage(&by_table, &woods, true, eye, 300);
    look(&by_table, eye, low, high), first_hits(&by_table, 0, rays, NULL);
    for (int i = 0; i < rays; i++) {
        if (!(by_table.range_m[i] < INFINITY)) continue;
        const ForestHit *hit = &by_table.hit[i];
        const PlantQuad *q = &hand_plants.shape[hit->kind][plant_whole].quad[hit->quad];
        const Plant     *p = &plant[hit->plant];
        ForestSurface    at;
        const double     o[3] = {eye[0], eye[1], eye[2]};
        const double     d[3] = {by_table.d[0][i], by_table.d[1][i], by_table.d[2][i]};
        double           axis[3][3], scale[2], m[3], on[3];
        met++;
        CHECK(hit->place == hit->plant && hit->kind == p->kind && hit->organ == q->organ && hit->level == plant_whole);
        CHECK(hit->uv[0] >= 0 && hit->uv[0] <= 1 && hit->uv[1] >= 0 && hit->uv[1] <= 1);
        plant_axes(axis, scale, p, NULL);
        double n[3], from[3];
        for (int c = 0; c < 3; c++) {
            m[c] = o[c] + by_table.range_m[i] * d[c] - (double)p->p_m[c];
            n[c] = (double)q->n[0][c];
        }
        /* the place on the quad is not far: half a step of the crown, and a texel of 16 m / 96 at the level in use */
        for (int c = 0; c < 3; c++) {
            const double u = (double)hit->uv[0], v = (double)hit->uv[1];
            on[c] = (1 - u) * (1 - v) * (double)q->corner[0][c] + u * (1 - v) * (double)q->corner[1][c] +
                    u * v * (double)q->corner[2][c] + (1 - u) * v * (double)q->corner[3][c];
        }
        double place[3] = {0}, facing[3] = {0};
        for (int k = 0; k < 3; k++)
            for (int c = 0; c < 3; c++) {
                place[c] += axis[k][c] * scale[k == 2] * on[k];
                facing[c] += axis[k][c] / scale[k == 2] * n[k];
            }
        v3_sub(from, m, place);
        CHECK(v3_length(from) < 3.2);
        CHECK(hit->back == (v3_dot(facing, d) > 0));
        forest_surface(&at, &by_table.frame, hit, o, d, by_table.range_m[i], 0.1f);
        CHECK_NEAR(v3_length(at.n_enu), 1, 1e-6);
        CHECK(v3_dot(at.n_geo, d) <= 0);
    }
    CHECK(met > 500);
    close_stage(&by_table);
}

/* ---- shadows ---------------------------------------------------------------------------------- */

/* Leaves alone, of every direction, throughout the box of a plant 1 m high; at the finest level half of each card is
 * leaf. Returns their area. */
static double grow_leaves(void)
{
    static const double size = 0.03;
    hand_grow(true, size);
    for (int kind = 0; kind < PLANT_KINDS; kind++) {
        PlantShape *s = &hand_plants.shape[kind][finest ? plant_fine : plant_whole];
        for (int k = 0; k < hand_leaves; k++) {
            const uint64_t of = (uint64_t)(kind * hand_leaves + k);
            const double   at[3] = {hand_dice(20, of) - 0.5, hand_dice(21, of) - 0.5, 0.05 + 0.9 * hand_dice(22, of)};
            double         n[3];
            hand_plant_direction(n, 23, of);
            hand_leaf(&s->quad[k], at, n, size, k);
        }
        s->quads = s->leaves = hand_leaves, s->pieces = s->bark_quads = 0;
        for (int c = 0; c < 3; c++) s->low[c] = c < 2 ? -0.55f : 0, s->high[c] = c < 2 ? 0.55f : 1;
    }
    return hand_leaves * size * size * (finest ? (double)hand_plants.pattern[0][0].area : 1);
}

/* Shares of rays that meet nothing: from below to a sun so far from overhead, and from an eye overhead down. */
static void find_gaps(double gap[2], Stage *s, const double eye_enu[3], double half_m, double off_rad)
{
    int open[2] = {0};
    for (int i = 0; i < rays; i++) {
        s->o[0][i] = 0.7 * half_m * (2 * hand_dice(24, (uint64_t)i) - 1);
        s->o[1][i] = 0.7 * half_m * (2 * hand_dice(25, (uint64_t)i) - 1);
        s->o[2][i] = -1, s->d[0][i] = 0.6 * sin(off_rad), s->d[1][i] = 0.8 * sin(off_rad), s->d[2][i] = cos(off_rad);
    }
    any_hits(s, NULL);
    for (int i = 0; i < rays; i++) open[0] += !s->dark[i];
    look(s, eye_enu, (const double[3]){-0.7 * half_m, -0.7 * half_m, -1},
         (const double[3]){0.7 * half_m, 0.7 * half_m, -1});
    first_hits(s, 0, rays, NULL);
    for (int i = 0; i < rays; i++) open[1] += !(s->range_m[i] < INFINITY);
    for (int k = 0; k < 2; k++) gap[k] = open[k] / (double)rays;
}

/* As test_forest's: gaps of trees at random are exp(-density x area x (1 - exp(-G l))) with G = 1/2 for leaves of every
 * direction (Ross, The radiation regime and architecture of plant stands, 1981): of the plants themselves, sprays and
 * cards of leaves, and of tables of both, by texels of the finest and of the coarsest level. A ray off the vertical
 * passes through more of them, by its cosine. */
static void transmittance(void **state)
{
    enum { trees = 900 };
    static const struct {
        bool   fine, tables;
        double ray_px;
    } as[] = {{false, false, 1},  {true, false, 1},    {false, true, 1e-3},
              {true, true, 1e-3}, {false, true, 0.05}, {true, true, 0.05}};
    static Plant plant[trees];
    const double half_m = 60, eye_enu[3] = {0, 0, 5000}, off_rad = 6 * rad_per_deg;
    (void)state;
    for (size_t k = 0; k < sizeof as / sizeof *as; k++) {
        double exponent = 0, gap[2];
        finest = as[k].fine;
        const double leaf = grow_leaves(); /* over (1 x 1) h2 */
        Woods        woods = hand_stand(plant, trees, origin, half_m);
        for (int i = 0; i < trees; i++) {
            const double h = plant_height_m(&plant[i]);
            plant[i].lean[0] = plant[i].lean[1] = 0, plant[i].width = 128;
            exponent += h * h / (4 * half_m * half_m) * (1 - exp(-0.5 * leaf));
        }
        open_stage(&by_table, &woods, as[k].tables, eye_enu, 100);
        by_table.frame.ray_px = as[k].ray_px;
        find_gaps(gap, &by_table, eye_enu, half_m, off_rad);
        printf("gaps to the sun %.4f, from the eye %.4f, closed form %.4f\n", gap[0], gap[1], exp(-exponent));
        CHECK_NEAR(gap[0], exp(-exponent / cos(off_rad)), 0.03);
        CHECK_NEAR(gap[1], exp(-exponent), 0.03);
        close_stage(&by_table);
    }
    finest = false;
}

/* Of the places that an eye sees, as many lie in the sun by tables as by the plants themselves: those of their own
 * plant, whose quads are also what the ray leaves, and of others. */
static void own_shade(void **state)
{
    static Plant    plant[120];
    static uint32_t leaves[rays], quad[rays];
    static uint8_t  real[rays];
    const double    eye[3] = {0, -700, 250}, low[3] = {-40, -40, 2}, high[3] = {40, 40, 14};
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 120, origin, 40);
    memset(real, 1, sizeof real);
    for (int sun = 0; sun < 3; sun++) {
        const double up = (20 + 25 * sun) * rad_per_deg, way[3] = {cos(up) * 0.6, -cos(up) * 0.8, sin(up)};
        int          dark[2] = {0}, met = 0;
        open_stage(&by_table, &woods, true, eye, 300);
        by_table.frame.ray_px = 0.05;
        look(&by_table, eye, low, high), first_hits(&by_table, 0, rays, real);
        for (int i = 0; i < rays; i++) {
            const bool    hit = by_table.range_m[i] < INFINITY;
            ForestSurface at = {0};
            const double  d[3] = {by_table.d[0][i], by_table.d[1][i], by_table.d[2][i]};
            if (hit) forest_surface(&at, &by_table.frame, &by_table.hit[i], eye, d, by_table.range_m[i], 0.1f);
            const double off_m = v3_dot(at.n_geo, way) > 0 ? 1e-3 : -1e-3;
            leaves[i] = hit ? by_table.hit[i].plant : UINT32_MAX, quad[i] = hit ? by_table.hit[i].quad : UINT32_MAX;
            for (int c = 0; c < 3; c++) {
                by_table.o[c][i] = eye[c] + (hit ? by_table.range_m[i] : 1e4) * d[c] + off_m * at.n_geo[c];
                by_table.d[c][i] = way[c];
            }
        }
        for (int k = 0; k < 2; k++) {
            any_hits(&by_table, &(ForestLeft){.real = k ? real : NULL, .plant = leaves, .quad = quad});
            for (int i = 0; i < rays; i++) dark[k] += by_table.dark[i] && leaves[i] != UINT32_MAX;
        }
        for (int i = 0; i < rays; i++) met += leaves[i] != UINT32_MAX;
        printf("sun %.0f: %.3f dark by tables, %.3f\n", up / rad_per_deg, dark[0] / (double)met, dark[1] / (double)met);
        CHECK(met > 1000 && dark[1] > met / 20);
        CHECK_NEAR(dark[0] / (double)met, dark[1] / (double)met, 0.03);
        close_stage(&by_table);
    }
}

/* ---- in any order ----------------------------------------------------------------------------- */

typedef struct Shares {
    Stage *stage;
} Shares;

static void share(void *user, int worker, int task)
{
    (void)worker;
    first_hits(((Shares *)user)->stage, task * 64, 64, NULL);
}

/* One by one and backwards, by threads, and in packets: the same bits, though texels are traced in other orders. */
static void order(void **state)
{
    static Plant plant[300];
    const double eye[3] = {0, -700, 150}, low[3] = {-60, -60, 0}, high[3] = {60, 60, 14};
    Pool        *pool;
    (void)state;
    assert_int_equal(pool_create(&pool, 3), STATUS_OK);
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 300, origin, 60);
    open_stage(&by_table, &woods, true, eye, 300);
    look(&by_table, eye, low, high), first_hits(&by_table, 0, rays, NULL);
    for (int k = 0; k < 3; k++) {
        open_stage(&by_plant, &woods, true, eye, 300);
        by_plant.frame.columns = k == 2 ? 32 : 0;
        look(&by_plant, eye, low, high);
        if (k == 0)
            for (int i = rays - 1; i >= 0; i--) first_hits(&by_plant, i, 1, NULL);
        else if (k == 1) pool_run(pool, rays / 64, share, &(Shares){&by_plant});
        else first_hits(&by_plant, 0, rays, NULL);
        for (int i = 0; i < rays; i++) {
            CHECK(by_plant.range_m[i] == by_table.range_m[i]);
            if (!(by_table.range_m[i] < INFINITY)) continue;
            CHECK(by_plant.hit[i].plant == by_table.hit[i].plant && by_plant.hit[i].quad == by_table.hit[i].quad);
            CHECK(by_plant.hit[i].uv[0] == by_table.hit[i].uv[0]);
        }
        close_stage(&by_plant);
    }
    close_stage(&by_table);
    pool_destroy(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nearest_way),       cmocka_unit_test(coarse_texels), cmocka_unit_test(plates),
        cmocka_unit_test(plants_themselves), cmocka_unit_test(as_often),      cmocka_unit_test(completed),
        cmocka_unit_test(transmittance),     cmocka_unit_test(own_shade),     cmocka_unit_test(order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
