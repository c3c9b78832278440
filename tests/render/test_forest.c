/* Rays against plants: by a tracer that tries every quad of every plant in double; closed forms of a canopy; the
 * invariants of order, threads and place. */
#include "tests/check.h"
#include "tests/render/hand_plants.h"

#include "render/trace/plants/forest_private.h"

static const double calm[2] = {0, 0};

static Forest     *forest;
static Arena      *arena;
static ForestFrame frame;

static void open_forest(const Woods *woods, const ForestConfig *config, const double eye_enu[3], double per_rad)
{
    arena = arena_create();
    assert_non_null(arena);
    assert_int_equal(forest_create(&forest, woods, &hand_plants, config, "avx2"), STATUS_OK);
    assert_int_equal(forest_frame_open(&frame, forest, eye_enu, per_rad, 0, 0, calm, NULL, arena), STATUS_OK);
}

static void close_forest(void)
{
    forest_frame_close(&frame);
    forest_destroy(forest);
    arena_destroy(arena);
}

/* ---- by force --------------------------------------------------------------------------------- */

static bool within(const LeafOutline *o, double u, double v)
{
    bool in = false;
    for (int k = 0, l = o->corners - 1; k < o->corners; l = k++) {
        const double ku = o->uv[k][0], kv = o->uv[k][1], lu = o->uv[l][0], lv = o->uv[l][1];
        if ((kv > v) != (lv > v) && u < (lu - ku) * (v - kv) / (lv - kv) + ku) in = !in;
    }
    return in;
}

/* Range of a ray on the triangle a, b, c (Moller and Trumbore, 1997), and its coordinates; INFINITY: it misses. */
static double triangle(double uv[2], const double o[3], const double d[3], const double a[3], const double b[3],
                       const double c[3])
{
    double e1[3], e2[3], p[3], s[3], q[3];
    v3_sub(e1, b, a), v3_sub(e2, c, a);
    v3_cross(p, d, e2);
    const double det = v3_dot(e1, p);
    if (det == 0) return INFINITY;
    v3_sub(s, o, a);
    uv[0] = v3_dot(s, p) / det;
    v3_cross(q, s, e1);
    uv[1] = v3_dot(d, q) / det;
    const double t = v3_dot(e2, q) / det;
    return uv[0] >= 0 && uv[1] >= 0 && uv[0] + uv[1] <= 1 && t > 0 ? t : INFINITY;
}

/* Nearest quad of all plants, all in ENU and double. bare, level: as the forest's. */
static double by_force(uint32_t *plant, uint32_t *quad, const Woods *woods, const double o[3], const double d[3],
                       int level, bool leaves, double most_m)
{
    double best = most_m;
    for (int i = 0; i < woods->count; i++) {
        const Plant      *p = &woods->plant[i];
        const PlantShape *s = &hand_plants.shape[p->kind][level];
        double            m[9];
        plant_transform(m, p, NULL);
        for (int k = 0; k < s->quads; k++) {
            const PlantQuad *q = &s->quad[k];
            double           corner[4][3], uv[2];
            if (!leaves && q->organ == PLANT_LEAF && plant_is_deciduous((PlantKind)p->kind)) continue;
            for (int c = 0; c < 4; c++) {
                m3_mul_v3(corner[c], m, (const double[3]){q->corner[c][0], q->corner[c][1], q->corner[c][2]});
                for (int x = 0; x < 3; x++) corner[c][x] += (double)p->p_m[x] + woods->origin_enu[x];
            }
            double t = triangle(uv, o, d, corner[0], corner[1], corner[3]);
            if (!(t < INFINITY)) {
                t = triangle(uv, o, d, corner[2], corner[3], corner[1]);
                uv[0] = 1 - uv[0], uv[1] = 1 - uv[1];
            }
            if (!(t < best)) continue;
            if (q->organ == PLANT_LEAF && level == plant_fine) {
                const int cell[2] = {(int)(uv[0] * plant_pattern_side), (int)(uv[1] * plant_pattern_side)};
                if (!hand_plants.pattern[p->kind][q->outline].leaflet[cell[1]][cell[0]]) continue;
            } else if (q->organ == PLANT_LEAF && !within(&hand_plants.outline[p->kind][q->outline], uv[0], uv[1]))
                continue;
            best = t, *plant = (uint32_t)i, *quad = (uint32_t)k;
        }
    }
    return best;
}

enum { rays = 600 };

/* Rays between points of two spheres about a stand: they cross it from everywhere. */
static void aim(double o[3][rays], double d[3][rays], const double centre[3], double radius_m)
{
    for (int i = 0; i < rays; i++) {
        double a[3], b[3], way[3];
        hand_plant_direction(a, 30, (uint64_t)i), hand_plant_direction(b, 31, (uint64_t)i);
        for (int c = 0; c < 3; c++) way[c] = 0.4 * b[c] * radius_m - a[c] * radius_m + (c == 2 ? 6 : 0);
        v3_normalize(way, way);
        for (int c = 0; c < 3; c++) o[c][i] = centre[c] + radius_m * a[c], d[c][i] = way[c];
    }
}

static void compare(const Woods *woods, const double centre[3], double radius_m, int level, bool leaves,
                    const uint8_t *real)
{
    static double       o[3][rays], d[3][rays], range_m[rays], far_m[rays];
    static ForestHit    hit[rays];
    static uint8_t      dark[rays];
    const double *const from[3] = {o[0], o[1], o[2]}, *const way[3] = {d[0], d[1], d[2]};
    int met = 0, apart = 0, leaf = 0;
    aim(o, d, centre, radius_m);
    for (int i = 0; i < rays; i++) range_m[i] = far_m[i] = i % 5 ? INFINITY : radius_m, dark[i] = 0;
    forest_first_hits(range_m, hit, &frame, rays, from, way, real);
    forest_any_hits(dark, &frame, rays, from, way, far_m, &(ForestLeft){.real = real});
    for (int i = 0; i < rays; i++) {
        uint32_t     plant = 0, quad = 0;
        const double want_m = by_force(&plant, &quad, woods, (const double[3]){o[0][i], o[1][i], o[2][i]},
                                       (const double[3]){d[0][i], d[1][i], d[2][i]}, level, leaves, far_m[i]);
        assert_int_equal(dark[i], range_m[i] < far_m[i]);
        met += want_m < far_m[i];
        if (fabs(want_m - range_m[i]) < 1e-6 * radius_m || (want_m == far_m[i] && range_m[i] == far_m[i])) {
            if (!(want_m < far_m[i])) continue;
            assert_int_equal(hit[i].plant, plant);
            leaf += hit[i].organ == PLANT_LEAF;
            assert_int_equal(hit[i].level, level);
            continue;
        }
        apart++; /* within a float of an edge */
    }
    if (!(met > rays / 20 && met < rays)) fail_msg("%d of %d rays met something", met, rays);
    CHECK(apart <= 1);
    if (leaves) CHECK(leaf > met / 5);
}

static void a_tree(void **state)
{
    static Plant plant[1];
    const double origin[3] = {0, 0, 0};
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 1, origin, 0.5);
    open_forest(&woods, &(ForestConfig){.leaves = true}, origin, 1000);
    compare(&woods, (const double[3]){0, 0, 4}, 7, plant_whole, true, NULL);
    close_forest();
}

static void a_stand(void **state)
{
    static Plant plant[60];
    const double origin[3] = {0, 0, 0};
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 60, origin, 30);
    open_forest(&woods, &(ForestConfig){.leaves = true}, origin, 1000);
    compare(&woods, origin, 50, plant_whole, true, NULL);
    close_forest();
}

/* A bent ray meets a plant as the straight one that starts lower by bend d^2, d from the eye to its foot. Trees
 * stand 1.5 to 6 km away, over several pieces of a ray, so thin that few rays meet two. */
static void bent_rays(void **state)
{
    static Plant        plant[60];
    static const double origin[3] = {0, 0, 0}, bend_per_m = 2e-8;
    static double       o[3][rays], d[3][rays], range_m[rays];
    static ForestHit    hit[rays];
    const double *const from[3] = {o[0], o[1], o[2]}, *const way[3] = {d[0], d[1], d[2]};
    int met = 0;
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 60, origin, 30);
    for (int k = 0; k < woods.count; k++)
        plant[k].p_m[0] = (float)(1500 + 75 * k), plant[k].p_m[1] = (float)(40 * k - 1200), plant[k].p_m[2] = 0;
    open_forest(&woods, &(ForestConfig){.leaves = true}, origin, 1000);
    frame.bend_per_m = bend_per_m;
    for (int i = 0; i < rays; i++) { /* ten at each, up its middle */
        const Plant *p = &plant[i / 10];
        const double x = (double)p->p_m[0], y = (double)p->p_m[1], fall_m = bend_per_m * (x * x + y * y);
        double       to[3] = {x, y, (i % 10 + 0.5) / 10 * plant_height_m(p) + fall_m - 2};
        v3_normalize(to, to);
        for (int c = 0; c < 3; c++) o[c][i] = c == 2 ? 2 : 0, d[c][i] = to[c];
        range_m[i] = i % 3 ? INFINITY : 1e5;
    }
    forest_first_hits(range_m, hit, &frame, rays, from, way, NULL);
    for (int i = 0; i < rays; i++) {
        const Woods  one = {.plant = &plant[i / 10], .count = 1};
        const double x = (double)one.plant->p_m[0], y = (double)one.plant->p_m[1];
        uint32_t     of, quad = 0;
        const double want_m = by_force(&of, &quad, &one, (const double[3]){0, 0, 2 - bend_per_m * (x * x + y * y)},
                                       (const double[3]){d[0][i], d[1][i], d[2][i]}, plant_whole, true, INFINITY);
        if (!(want_m < INFINITY) || range_m[i] < want_m - 60) continue; /* missed, or another stands before it */
        met++;
        CHECK_NEAR(range_m[i], want_m, 1e-5 * want_m);
        assert_int_equal(hit[i].plant, i / 10);
    }
    CHECK(met > rays / 4);
    close_forest();
}

static void bare_trees(void **state)
{
    static Plant plant[40];
    const double origin[3] = {0, 0, 0};
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 40, origin, 20);
    open_forest(&woods, &(ForestConfig){.leaves = false}, origin, 1000);
    compare(&woods, origin, 40, plant_whole, false, NULL);
    close_forest();
}

/* Rays along the sides of a plant's box, and across it along one of them, within the box and beside it. */
static void along_the_box(void **state)
{
    enum { side = 24, ways = 5 };
    static const double way[ways][3] = {{0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {0.6, 0.8, 0}, {0, 0.6, -0.8}};
    static Plant        plant[1];
    const double        origin[3] = {0, 0, 0}, middle[3] = {0, 0, 5};
    int                 met = 0, missed = 0;
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 1, origin, 0.5);
    plant[0] = (Plant){.height = 1000, .width = 128, .kind = plant[0].kind};
    open_forest(&woods, &(ForestConfig){.leaves = true}, origin, 1000);
    for (int w = 0; w < ways; w++)
        for (int k = 0; k < side * side; k++) {
            double       u[3], v[3], o[3], range_m = INFINITY;
            uint32_t     at, quad;
            ForestHit    hit = {0};
            uint8_t      dark = 0;
            const double far_m = INFINITY;
            v3_cross(u, way[w], fabs(way[w][2]) > 0.9 ? (const double[3]){1, 0, 0} : (const double[3]){0, 0, 1});
            v3_normalize(u, u), v3_cross(v, u, way[w]);
            v3_add_scaled(o, middle, -20, way[w]);
            v3_add_scaled(o, o, 9.0 * (k % side + 0.37) / side - 4.5, u),
                v3_add_scaled(o, o, 9.0 * (k / side + 0.41) / side - 4.5, v);
            const double *const from[3] = {&o[0], &o[1], &o[2]}, *const d[3] = {&way[w][0], &way[w][1], &way[w][2]};
            forest_first_hits(&range_m, &hit, &frame, 1, from, d, NULL);
            forest_any_hits(&dark, &frame, 1, from, d, &far_m, NULL);
            const double want_m = by_force(&at, &quad, &woods, o, way[w], plant_whole, true, INFINITY);
            assert_true(want_m < INFINITY ? fabs(range_m - want_m) < 1e-5 && hit.quad == quad : range_m == INFINITY);
            assert_int_equal(dark, want_m < INFINITY);
            met += want_m < INFINITY, missed += !(want_m < INFINITY);
        }
    if (!(met > 200 && missed > 200)) fail_msg("%d met, %d missed", met, missed);
    close_forest();
}

/* Far plants are traced at the simple level, near ones at the fine one, those between at the whole one; by rays that
 * must meet real ones at the finest. */
static void levels(void **state)
{
    static Plant   plant[40];
    static uint8_t real[rays];
    const double   origin[3] = {0, 0, 0}, far_eye[3] = {0, -90000, 0}, near_eye[3] = {0, -100, 0};
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 40, origin, 20);
    memset(real, 1, sizeof real);
    open_forest(&woods, &(ForestConfig){.leaves = true, .level1_px = 12}, far_eye, 1000);
    assert_true(forest_simplifies(forest));
    compare(&woods, origin, 40, plant_simple, true, NULL);
    compare(&woods, origin, 40, plant_whole, true, real);
    close_forest();
    open_forest(&woods, &(ForestConfig){.leaves = true, .fine = true}, near_eye, 1000);
    assert_true(forest_simplifies(forest));
    compare(&woods, origin, 40, plant_fine, true, NULL);
    close_forest();
    open_forest(&woods, &(ForestConfig){.leaves = true, .fine = true}, far_eye, 1000);
    compare(&woods, origin, 40, plant_whole, true, NULL);
    compare(&woods, origin, 40, plant_fine, true, real);
    close_forest();
    open_forest(&woods, &(ForestConfig){.leaves = true, .fine = true, .all_fine = true}, far_eye, 1000);
    assert_false(forest_simplifies(forest));
    compare(&woods, origin, 40, plant_fine, true, NULL);
    close_forest();
}

/* Plants of one height change to the fine level at heights in the picture that are even over 24 .. 40 px: at 28, 32 and
 * 36 px a quarter, half and three quarters of them have, within four standard deviations of a share of 1000. */
static void own_thresholds(void **state)
{
    enum { plants = 1000 };
    static Plant plant[plants];
    const double origin[3] = {0, 0, 0}, at_px[5] = {23.9, 28, 32, 36, 40.1}, want[5] = {0, 0.25, 0.5, 0.75, 1};
    (void)state;
    hand_grow(false, 0.06);
    Woods woods = hand_stand(plant, plants, origin, 1);
    for (int k = 0; k < 5; k++) {
        const double eye[3] = {0, -10000, 0}, per_rad = at_px[k] * 10000 / 10;
        int          fine = 0;
        for (int i = 0; i < plants; i++) plant[i].height = 1000;
        open_forest(&woods, &(ForestConfig){.leaves = true, .fine = true}, eye, per_rad);
        for (int i = 0; i < plants; i++) fine += forest_level(&frame, &plant[i], origin) == plant_fine;
        close_forest();
        CHECK(fabs(fine / (double)plants - want[k]) <= 4 * sqrt(want[k] * (1 - want[k]) / plants));
    }
}

/* The same trees at the origin and 200 km away: what is left is the rounding of the double origin of the rays. */
static void far_away(void **state)
{
    static Plant        plant[60];
    static double       o[3][rays], d[3][rays], here_m[rays], there_m[rays];
    static ForestHit    here[rays], there[rays];
    const double *const from[3] = {o[0], o[1], o[2]}, *const way[3] = {d[0], d[1], d[2]};
    const double origin[3] = {0, 0, 0}, far[3] = {200000, -150000, 1234.5};
    int          met = 0, other = 0;
    (void)state;
    hand_grow(false, 0.06);
    Woods woods = hand_stand(plant, 60, origin, 30);
    aim(o, d, origin, 50);
    for (int i = 0; i < rays; i++) here_m[i] = there_m[i] = INFINITY;
    open_forest(&woods, &(ForestConfig){.leaves = true}, origin, 1000);
    forest_first_hits(here_m, here, &frame, rays, from, way, NULL);
    close_forest();
    memcpy(woods.origin_enu, far, sizeof far);
    for (int i = 0; i < rays; i++)
        for (int c = 0; c < 3; c++) o[c][i] += far[c];
    open_forest(&woods, &(ForestConfig){.leaves = true}, far, 1000);
    forest_first_hits(there_m, there, &frame, rays, from, way, NULL);
    close_forest();
    for (int i = 0; i < rays; i++) {
        const bool same = here_m[i] == INFINITY
                              ? there_m[i] == INFINITY
                              : fabs(here_m[i] - there_m[i]) < 1e-6 && here[i].plant == there[i].plant;
        met += here_m[i] < INFINITY;
        other += !same;
    }
    CHECK(met > rays / 10);
    CHECK(other <= 1);
}

/* A ray's answer does not depend on the rays about it. */
static void order(void **state)
{
    static Plant        plant[60];
    static double       o[3][rays], d[3][rays], range_m[rays];
    static ForestHit    hit[rays];
    const double *const from[3] = {o[0], o[1], o[2]}, *const way[3] = {d[0], d[1], d[2]};
    const double origin[3] = {0, 0, 0};
    (void)state;
    hand_grow(false, 0.06);
    const Woods woods = hand_stand(plant, 60, origin, 30);
    open_forest(&woods, &(ForestConfig){.leaves = true}, origin, 1000);
    aim(o, d, origin, 50);
    for (int i = 0; i < rays; i++) range_m[i] = INFINITY;
    forest_first_hits(range_m, hit, &frame, rays, from, way, NULL);
    for (int i = rays - 1; i >= 0; i--) {
        double              alone_m = INFINITY;
        ForestHit           alone = {0};
        const double *const o1[3] = {o[0] + i, o[1] + i, o[2] + i}, *const d1[3] = {d[0] + i, d[1] + i, d[2] + i};
        forest_first_hits(&alone_m, &alone, &frame, 1, o1, d1, NULL);
        assert_true(alone_m == range_m[i]);
        if (alone_m < INFINITY) assert_true(alone.plant == hit[i].plant && alone.quad == hit[i].quad);
    }
    close_forest();
}

/* Gaps of a layer of leaves of every direction, in no order: exp(-G L) with G = 1/2 for a spherical distribution of
 * leaf normals (Ross, The radiation regime and architecture of plant stands, 1981). L: leaf area seen along the ray. */
static void transmittance_at(int level)
{
    enum { trees = 900 };
    static Plant        plant[trees];
    static uint8_t      dark[4096];
    static double       o[3][4096], d[3][4096], far_m[4096];
    const double *const from[3] = {o[0], o[1], o[2]}, *const way[3] = {d[0], d[1], d[2]};
    const double origin[3] = {0, 0, 0}, half_m = 60;
    const double share = level == plant_fine ? 0.5 : 1; /* of a card that is leaf */
    int          open = 0, count = 0;
    hand_grow(true, 0.03);
    for (int kind = 0; kind < PLANT_KINDS; kind++) { /* leaves alone, throughout the box of a plant */
        PlantShape *s = &hand_plants.shape[kind][level];
        for (int k = 0; k < hand_leaves; k++) {
            const uint64_t of = (uint64_t)(kind * hand_leaves + k);
            const double   at[3] = {hand_dice(20, of) - 0.5, hand_dice(21, of) - 0.5, 0.05 + 0.9 * hand_dice(22, of)};
            double         n[3];
            hand_plant_direction(n, 23, of);
            hand_leaf(&s->quad[k], at, n, 0.03, k);
        }
        s->quads = s->leaves = hand_leaves, s->pieces = s->bark_quads = 0;
        for (int c = 0; c < 3; c++) s->low[c] = c < 2 ? -0.55f : 0, s->high[c] = c < 2 ? 0.55f : 1;
    }
    Woods woods = hand_stand(plant, trees, origin, half_m);
    for (int i = 0; i < trees; i++) plant[i].lean[0] = plant[i].lean[1] = 0, plant[i].width = 128;
    open_forest(&woods, &(ForestConfig){.leaves = true, .fine = level == plant_fine}, origin, 1000);
    for (int i = 0; i < 4096; i++) {
        o[0][i] = 0.7 * half_m * (2 * hand_dice(24, (uint64_t)i) - 1),
        o[1][i] = 0.7 * half_m * (2 * hand_dice(25, (uint64_t)i) - 1);
        o[2][i] = 60, d[0][i] = d[1][i] = 0, d[2][i] = -1, far_m[i] = INFINITY, dark[i] = 0;
    }
    forest_any_hits(dark, &frame, 4096, from, way, far_m, NULL);
    for (int i = 0; i < 4096; i++) open += !dark[i], count++;
    close_forest();
    /* a tree's leaves are a clump: of trees at random, each opaque share a tree_gap over its own square, the gap is
     * exp(-density x area x (1 - exp(-G l))), l the leaf area over that square */
    double exponent = 0;
    for (int i = 0; i < trees; i++) {
        const double h = plant_height_m(&plant[i]), leaf = share * hand_leaves * 0.03 * 0.03; /* over (1 x 1) h2 */
        exponent += h * h / (4 * half_m * half_m) * (1 - exp(-0.5 * leaf));
    }
    const double want = exp(-exponent), got = open / (double)count;
    CHECK(fabs(got - want) < 4 * sqrt(want * (1 - want) / count) + 0.01 * want);
}

static void transmittance(void **state)
{
    (void)state;
    transmittance_at(plant_whole);
    transmittance_at(plant_fine);
}

/* Openness of quads against many rays by force; the mean closely, each as far as its few rays allow. */
static void openness(void **state)
{
    enum { tried = 40, directions = 300 };
    static Plant plant[1];
    const double origin[3] = {0, 0, 0};
    double       mean[2] = {0}, square = 0;
    (void)state;
    hand_grow(false, 0.12);
    Woods woods = hand_stand(plant, 1, origin, 0.5);
    plant[0] = (Plant){.height = 100, .width = 128, .kind = plant[0].kind};
    open_forest(&woods, &(ForestConfig){.leaves = true}, origin, 1000);
    assert_int_equal(forest_openness(&hand_plants, forest, NULL), STATUS_OK);
    PlantShape *s = &hand_plants.shape[plant[0].kind][plant_whole];
    for (int t = 0; t < tried; t++) {
        const PlantQuad *q = &s->quad[s->quads - 1 - 3 * t]; /* leaves */
        double           all[2] = {0}, open[2] = {0}, n[3], middle[3];
        for (int c = 0; c < 3; c++) {
            n[c] = (double)q->n[0][c];
            middle[c] = 0.25 * ((double)q->corner[0][c] + (double)q->corner[1][c] + (double)q->corner[2][c] +
                                (double)q->corner[3][c]);
        }
        for (int k = 0; k < directions; k++) {
            uint32_t unused;
            double   d[3], o[3];
            hand_plant_direction(d, 40, (uint64_t)(t * directions + k));
            const double cosine = v3_dot(n, d), weight = fabs(cosine);
            v3_add_scaled(o, middle, cosine > 0 ? 1e-4 : -1e-4, n);
            const bool free = by_force(&unused, &unused, &woods, o, d, plant_whole, true, INFINITY) == INFINITY;
            all[d[2] < 0] += weight, open[d[2] < 0] += free ? weight : 0;
        }
        const double off[2] = {(double)q->open_up - open[0] / all[0], (double)q->open_down - open[1] / all[1]};
        for (int h = 0; h < 2; h++) mean[h] += off[h] / tried, square += off[h] * off[h] / (2 * tried);
    }
    CHECK(fabs(mean[0]) < 0.03 && fabs(mean[1]) < 0.03 && sqrt(square) < 0.15);
    close_forest();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tree),     cmocka_unit_test(a_stand),        cmocka_unit_test(bent_rays),
        cmocka_unit_test(bare_trees), cmocka_unit_test(levels),         cmocka_unit_test(along_the_box),
        cmocka_unit_test(far_away),   cmocka_unit_test(order),          cmocka_unit_test(transmittance),
        cmocka_unit_test(openness),   cmocka_unit_test(own_thresholds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
