/* The prototypes: numbers of the founding paper, flat quads, simple outlines, areas by other formulae, the silhouettes
 * of the second level of detail. */
#include "tests/check.h"

#include "render/trace/plants/plants.h"

static Plants *plants;

static int grow(void **state)
{
    (void)state;
    return plants_create(&plants, 1995, NULL) != STATUS_OK;
}

static int fell(void **state)
{
    (void)state;
    plants_destroy(plants);
    return 0;
}

static void point(double p[3], const PlantQuad *q, int corner)
{
    for (int x = 0; x < 3; x++) p[x] = (double)q->corner[corner][x];
}

/* Muuss & Lorenzo (1995), figure 3: 1695 .. 3634 branch pieces, 852 .. 1749 leaves. */
static void numbers_of_the_paper(void **state)
{
    (void)state;
    for (int kind = 0; kind < PLANT_TREES; kind++) {
        const PlantShape *s = &plants->shape[kind][plant_whole], *less = &plants->shape[kind][plant_simple];
        CHECK(s->pieces >= 1695 && s->pieces <= 3634);
        CHECK(s->leaves >= 852 && s->leaves <= 1749);
        assert_int_equal(s->bark_quads, 6 * s->pieces);
        CHECK(less->quads * 6 < s->quads && less->quads > 500);
    }
}

static void one_metre_high(void **state)
{
    (void)state;
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int level = 0; level < plant_levels; level++) {
            const PlantShape *s = &plants->shape[kind][level];
            double            high = 0;
            for (int k = 0; k < s->quads; k++)
                for (int c = 0; c < 4; c++)
                    for (int x = 0; x < 3; x++) {
                        const double at = (double)s->quad[k].corner[c][x];
                        if (x == 2) high = fmax(high, at);
                        CHECK(at >= (double)s->low[x] - 1e-5 && at <= (double)s->high[x] + 1e-5);
                    }
            CHECK_NEAR(high, 1, 1e-5);
            CHECK(s->low[2] > -0.4f && (kind >= PLANT_TREES || s->low[2] > -0.05f));
            for (int k = 0; k < s->quads; k++) CHECK((s->quad[k].organ == PLANT_LEAF) == (k >= s->bark_quads));
        }
}

/* The fourth corner lies on the plane of the others; and the card's normal is that plane's. */
static void flat_quads(void **state)
{
    (void)state;
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int level = 0; level < plant_levels; level++)
            for (int k = 0; k < plants->shape[kind][level].quads; k++) {
                const PlantQuad *q = &plants->shape[kind][level].quad[k];
                double           p[4][3], u[3], v[3], w[3], n[3];
                for (int c = 0; c < 4; c++) point(p[c], q, c);
                v3_sub(u, p[1], p[0]), v3_sub(v, p[2], p[0]), v3_sub(w, p[3], p[0]);
                v3_cross(n, u, v);
                CHECK(v3_normalize(n, n));
                CHECK(fabs(v3_dot(n, w)) < 1e-4 * (v3_length(u) + v3_length(v)) + 1e-6);
                const double shown[3] = {(double)q->n[0][0], (double)q->n[0][1], (double)q->n[0][2]};
                CHECK_NEAR(v3_length(shown), 1, 1e-5);
                if (q->organ != PLANT_BARK) CHECK(fabs(v3_dot(shown, n)) > 0.999);
                else CHECK(v3_dot(shown, n) > 0.49); /* outwards; of three sides, 60 degrees off */
                if (level == plant_fine && kind < plants->patterned) continue; /* found by rays */
                CHECK(q->open_up >= 0 && q->open_up <= 1 && q->open_down >= 0 && q->open_down <= 1);
            }
}

static bool crosses(const float a[2], const float b[2], const float c[2], const float d[2])
{
    const double ux = (double)b[0] - (double)a[0], uy = (double)b[1] - (double)a[1];
    const double vx = (double)d[0] - (double)c[0], vy = (double)d[1] - (double)c[1];
    const double wx = (double)c[0] - (double)a[0], wy = (double)c[1] - (double)a[1], det = ux * vy - uy * vx;
    if (fabs(det) < 1e-12) return false;
    const double s = (wx * vy - wy * vx) / det, t = (wx * uy - wy * ux) / det;
    return s > 1e-6 && s < 1 - 1e-6 && t > 1e-6 && t < 1 - 1e-6;
}

/* Counter-clockwise, without crossings; eight of a species, all different; areas by counting. */
static void outlines(void **state)
{
    (void)state;
    for (int kind = 0; kind < PLANT_ROCK; kind++)
        for (int k = 0; k < plant_outlines; k++) {
            const LeafOutline *o = &plants->outline[kind][k];
            int                within = 0;
            CHECK(o->corners >= 3 && o->corners <= plant_outline_corners_most);
            for (int a = 0; a < o->corners; a++)
                for (int b = a + 1; b < o->corners; b++)
                    CHECK(!crosses(o->uv[a], o->uv[(a + 1) % o->corners], o->uv[b], o->uv[(b + 1) % o->corners]));
            for (int n = 0; n < 200 * 200; n++)
                within += plants_within_outline(o, ((float)(n % 200) + 0.5f) / 200, ((float)(n / 200) + 0.5f) / 200);
            CHECK(plants->outline_area[kind][k] > 0.05f);
            CHECK_NEAR(within / 40000.0, (double)plants->outline_area[kind][k], 0.01);
            for (int l = 0; l < k; l++) CHECK(memcmp(o->uv, plants->outline[kind][l].uv, sizeof o->uv) != 0);
        }
}

/* Two to five layers of leaves over the ground under nine tenths of them. */
static void leaf_area(void **state)
{
    (void)state;
    for (int kind = 0; kind < PLANT_TREES; kind++) {
        const PlantShape *s = &plants->shape[kind][plant_whole];
        double            sum = 0;
        int               beyond = 0;
        for (int k = s->bark_quads; k < s->quads; k++) {
            const PlantQuad *q = &s->quad[k];
            double           p[4][3], a[3], b[3], n[3];
            for (int c = 0; c < 4; c++) point(p[c], q, c);
            v3_sub(a, p[2], p[0]), v3_sub(b, p[3], p[1]); /* half the product of the diagonals */
            v3_cross(n, a, b);
            sum += 0.5 * v3_length(n) * (double)plants->outline_area[kind][q->outline];
            beyond += hypot(0.5 * (p[0][0] + p[2][0]), 0.5 * (p[0][1] + p[2][1])) > (double)s->crown_radius;
        }
        CHECK_NEAR((double)s->leaf_area, sum, 1e-4 * sum);
        CHECK_NEAR(beyond / (double)s->leaves, 0.1, 0.005);
        const double layers = sum / (pi_rad * (double)s->crown_radius * (double)s->crown_radius);
        CHECK(layers > 2 && layers < 7);
        /* what terrain/woods knows of the crowns */
        CHECK_NEAR(plant_crown_share((PlantKind)kind), (double)s->crown_radius, 0.1 * (double)s->crown_radius);
        CHECK_NEAR((double)plants->shape[kind][plant_simple].leaf_area, sum, 0.12 * sum);
    }
}

/* ---- silhouettes ------------------------------------------------------------------------------ */

enum { side = 160 };

/* Pixels of a picture of 1.2 m that a shape covers, seen along d. */
static int silhouette(const PlantShape *s, const LeafOutline *outline, const double d[3], bool leaves)
{
    static uint8_t covered[side][side];
    double         u[3], v[3];
    int            count = 0;
    memset(covered, 0, sizeof covered);
    v3_cross(u, fabs(d[2]) < 0.9 ? (const double[3]){0, 0, 1} : (const double[3]){1, 0, 0}, d);
    v3_normalize(u, u);
    v3_cross(v, d, u);
    for (int k = 0; k < (leaves ? s->quads : s->bark_quads); k++) {
        const PlantQuad *q = &s->quad[k];
        double           x[4], y[4], low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
        for (int c = 0; c < 4; c++) {
            double p[3];
            point(p, q, c);
            p[2] -= 0.5;
            x[c] = (v3_dot(p, u) / 1.2 + 0.5) * side, y[c] = (v3_dot(p, v) / 1.2 + 0.5) * side;
            low[0] = fmin(low[0], x[c]), low[1] = fmin(low[1], y[c]), high[0] = fmax(high[0], x[c]),
            high[1] = fmax(high[1], y[c]);
        }
        for (int j = (int)fmax(low[1] - 0.5, 0); j < fmin(high[1] + 0.5, side); j++)
            for (int i = (int)fmax(low[0] - 0.5, 0); i < fmin(high[0] + 0.5, side); i++) {
                const double px = i + 0.5, py = j + 0.5;
                bool         in = false;
                if (q->organ == PLANT_LEAF) { /* a parallelogram */
                    const double ax = x[1] - x[0], ay = y[1] - y[0], bx = x[3] - x[0], by = y[3] - y[0],
                                 det = ax * by - ay * bx;
                    if (fabs(det) < 1e-12) continue;
                    const double s1 = ((px - x[0]) * by - (py - y[0]) * bx) / det,
                                 t1 = (ax * (py - y[0]) - ay * (px - x[0])) / det;
                    in = plants_within_outline(&outline[q->outline], (float)s1, (float)t1);
                } else {
                    for (int c = 0, e = 3; c < 4; e = c++)
                        if ((y[c] > py) != (y[e] > py) && px < (x[e] - x[c]) * (py - y[c]) / (y[e] - y[c]) + x[c])
                            in = !in;
                }
                covered[j][i] |= in;
            }
    }
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) count += covered[j][i];
    return count;
}

/* Mean over eight directions, each kind: with leaves and bare within 15 %. */
static void second_level(void **state)
{
    (void)state;
    for (int kind = 0; kind < PLANT_TREES; kind++)
        for (int leaves = 0; leaves < 2; leaves++) {
            int full = 0, less = 0;
            for (int k = 0; k < 8; k++) {
                const double turn = 2 * pi_rad * k / 8, up = -0.15 - 0.3 * (k % 3);
                const double d[3] = {cos(turn) * cos(up), sin(turn) * cos(up), sin(up)};
                full += silhouette(&plants->shape[kind][plant_whole], plants->outline[kind], d, leaves);
                less += silhouette(&plants->shape[kind][plant_simple], plants->outline[kind], d, leaves);
            }
            if (fabs((double)(less - full)) > 0.15 * full)
                fail_msg("%s: %d for %d", plant_name((PlantKind)kind), less, full);
        }
}

/* ---- patterns --------------------------------------------------------------------------------- */

static void patterns(void **state)
{
    (void)state;
    for (int kind = 0; kind <= PLANT_HEDGE; kind++) {
        double sum = 0, leaf = 0, square = 0, far = 0;
        enum { places = 20000 };
        for (int n = 0; n < places; n++) {
            const float p_m[3] = {(float)random_uniform(1, 1, 0, (uint64_t)n),
                                  (float)random_uniform(1, 2, 0, (uint64_t)n),
                                  (float)(20 * random_uniform(1, 3, 0, (uint64_t)n))};
            float       albedo, slope[2];
            plants_bark(&albedo, slope, (PlantKind)kind, (uint32_t)n % 97, p_m, 0);
            sum += (double)albedo;
            plants_bark(&albedo, slope, (PlantKind)kind, 5, p_m, 10);
            far = fmax(far, fabs((double)albedo - 1) + fabs((double)slope[0]) + fabs((double)slope[1]));
            const double l = (double)plants_leaf_albedo((PlantKind)kind, 7, (uint32_t)n);
            leaf += l, square += (l - 1) * (l - 1);
        }
        CHECK_NEAR(sum / places, 1, 0.02);
        CHECK_NEAR(leaf / places, 1, 0.005);
        CHECK_NEAR(sqrt(square / places), 0.1, 0.005);
        assert_true(far == 0); /* nothing is left in a footprint of 10 m */
    }
}

static void threads(void **state)
{
    Pool   *pool;
    Plants *again;
    (void)state;
    assert_int_equal(pool_create(&pool, 3), STATUS_OK);
    assert_int_equal(plants_create(&again, 1995, pool), STATUS_OK);
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        for (int level = 0; level < plant_levels; level++) {
            const PlantShape *a = &plants->shape[kind][level], *b = &again->shape[kind][level];
            assert_int_equal(a->quads, b->quads);
            for (int k = 0; k < a->quads; k++) {
                assert_memory_equal(a->quad[k].corner, b->quad[k].corner, sizeof a->quad[k].corner);
                assert_true(a->quad[k].open_up == b->quad[k].open_up && a->quad[k].open_down == b->quad[k].open_down);
            }
        }
    assert_memory_equal(plants->pattern, again->pattern, PLANT_STANDING * sizeof *plants->pattern);
    plants_destroy(again);
    pool_destroy(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_the_paper),
        cmocka_unit_test(one_metre_high),
        cmocka_unit_test(flat_quads),
        cmocka_unit_test(outlines),
        cmocka_unit_test(leaf_area),
        cmocka_unit_test(second_level),
        cmocka_unit_test(patterns),
        cmocka_unit_test(threads),
    };
    return cmocka_run_group_tests(tests, grow, fell);
}
