/* Records of culture: which outlines are taken and how they are mended, against whole-number geometry; look-ups against
 * every record, one after the other; limits of the index and of the work that a tangled outline makes. labels: small */
#include "tests/check.h"

#include "terrain/culture/culture.h"

#include <malloc.h>

static uint32_t turn;

static double unit(void) { return random_uniform(31, 7, 0, turn++); }
static int    below(int n) { return (int)(unit() * n); }

static const Building plain = {.eaves_m = 5, .ridge_m = 8, .use = BUILDING_HOUSE, .levels = 2};

static int take_outline(Culture *c, const double (*p)[2], int corners)
{
    const int before = c->buildings;
    assert_int_equal(culture_add_building(c, &plain, p, corners), STATUS_OK);
    return c->buildings - before;
}

/* ---- outlines ---------------------------------------------------------------------------------------- */

static void outlines_are_mended(void **state)
{
    (void)state;
    Culture c = {0};
    /* clockwise, closed, with a corner twice, one on an edge, and a spike */
    static const double p[][2] = {{0, 0}, {0, 4}, {0, 4}, {0, 10}, {20, 10}, {30, 10}, {20, 10}, {20, 0}, {0, 0}};
    CHECK(take_outline(&c, p, 9) == 1);
    const Building *b = &c.building[0];
    CHECK(b->corners == 4 && c.corners == 4);
    double area_m2 = 0;
    for (int k = 0; k < 4; k++) {
        const double *q = c.corner_m[b->first_corner + k], *r = c.corner_m[b->first_corner + (k + 1) % 4];
        area_m2 += 0.5 * (q[0] * r[1] - r[0] * q[1]);
    }
    CHECK_NEAR(area_m2, 200, 1e-12); /* positive: counter-clockwise */
    culture_free(&c);
}

static void what_cannot_be_is_left_out(void **state)
{
    (void)state;
    Culture             c = {0};
    static const double bow[][2] = {{0, 0}, {10, 10}, {10, 0}, {0, 10}}, small[][2] = {{0, 0}, {1, 0}, {0, 1.9}};
    static const double touch[][2] = {{0, 0}, {10, 0}, {10, 10}, {5, 0}, {0, 10}};
    double              square[][2] = {{0, 0}, {9, 0}, {9, 9}, {0, 9}};
    CHECK(take_outline(&c, bow, 4) == 0 && take_outline(&c, small, 3) == 0 && take_outline(&c, touch, 5) == 0);
    CHECK(take_outline(&c, (const double(*)[2])square, 2) == 0 &&
          take_outline(&c, (const double(*)[2])square, 5000) == 0);
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1e300, 1.1e6};
    for (int k = 0; k < 5; k++) {
        square[2][1] = bad[k];
        CHECK(take_outline(&c, (const double(*)[2])square, 4) == 0);
    }
    square[2][1] = 9;
    static const float heights[][2] = {{0, 5}, {-1, 5}, {5, 4}, {5, 9999}, {NAN, 5}, {5, NAN}, {5, INFINITY}};
    for (int k = 0; k < 7; k++) {
        Building b = plain;
        b.eaves_m = heights[k][0], b.ridge_m = heights[k][1];
        CHECK(culture_add_building(&c, &b, (const double(*)[2])square, 4) == STATUS_OK && c.buildings == 0);
    }
    CHECK(c.left_out == 17 && c.corners == 0);
    CHECK(take_outline(&c, (const double(*)[2])square, 4) == 1 && c.left_out == 17);

    static const double ends[][2] = {{0, 0}, {5, 5}};
    CultureLine         line = {.width_m = 3};
    CHECK(culture_add_line(&c, &line, ends, 2) == STATUS_OK && culture_add_line(&c, &line, ends, 1) == STATUS_OK);
    line.width_m = 1001;
    CHECK(culture_add_line(&c, &line, ends, 2) == STATUS_OK);
    CulturePoint point = {.size_m = {1, 1, 1}};
    CHECK(culture_add_point(&c, &point) == STATUS_OK);
    point.size_m[2] = 0;
    CHECK(culture_add_point(&c, &point) == STATUS_OK);
    CultureTree tree = {.height_m = 3};
    CHECK(culture_add_tree(&c, &tree) == STATUS_OK);
    tree.x_m = (double)NAN;
    CHECK(culture_add_tree(&c, &tree) == STATUS_OK);
    CHECK(c.lines == 1 && c.points == 1 && c.trees == 1 && c.left_out == 21);
    culture_free(&c);
}

/* ---- outlines that cross themselves ------------------------------------------------------------------ */

static int side_of(const int a[2], const int b[2], const int c[2])
{
    const long t = (long)(b[0] - a[0]) * (c[1] - a[1]) - (long)(b[1] - a[1]) * (c[0] - a[0]);
    return t > 0 ? 1 : t < 0 ? -1 : 0;
}

static bool on_piece(const int a[2], const int b[2], const int c[2])
{
    return side_of(a, b, c) == 0 && (c[0] - a[0]) * (c[0] - b[0]) + (c[1] - a[1]) * (c[1] - b[1]) <= 0;
}

/* Of whole numbers, by all pairs: exact. -1: corners repeat or lie straight, which are mended before. */
static int crosses(int (*p)[2], int n)
{
    int meets = 0;
    for (int i = 0; i < n; i++)
        if (side_of(p[i], p[(i + 1) % n], p[(i + 2) % n]) == 0) return -1;
    for (int i = 0; i < n; i++)
        for (int k = i + 2; k < n; k++) {
            const int *a = p[i], *b = p[(i + 1) % n], *c = p[k], *d = p[(k + 1) % n];
            if (i == 0 && k == n - 1) continue;
            meets |= side_of(a, b, c) * side_of(a, b, d) < 0 && side_of(c, d, a) * side_of(c, d, b) < 0;
            meets |= on_piece(a, b, c) || on_piece(a, b, d) || on_piece(c, d, a) || on_piece(c, d, b);
        }
    return meets;
}

static void crossings_are_those_of_whole_numbers(void **state)
{
    (void)state;
    enum { rounds = 60000 };
    int seen[2] = {0};
    for (int round = 0; round < rounds; round++) {
        const int n = 3 + below(7), wide = 4 + below(12);
        int       whole[16][2];
        double    p[16][2];
        /* half of them star-shaped about a middle, which seldom cross */
        for (int k = 0; k < n; k++) {
            const double a = 2 * pi_rad * (k + 0.6 * unit()) / n, r = wide * (1 + 2 * unit());
            whole[k][0] = round % 2 ? below(wide) : (int)lrint(r * cos(a));
            whole[k][1] = round % 2 ? below(wide) : (int)lrint(r * sin(a));
            for (int c = 0; c < 2; c++) p[k][c] = 3.0 * whole[k][c];
        }
        const int want = crosses(whole, n);
        if (want < 0) continue;
        Culture   c = {0};
        const int got = take_outline(&c, (const double(*)[2])p, n);
        long      twice = 0;
        for (int k = 0; k < n; k++) {
            const int *a = whole[k], *b = whole[(k + 1) % n];
            twice += (long)a[0] * b[1] - (long)b[0] * a[1];
        }
        culture_free(&c);
        if (twice == 0) continue;
        if (got != !want) fail_msg("round %d, %d corners: taken %d, crosses %d", round, n, got, want);
        seen[want]++;
    }
    CHECK(seen[0] > 8000 && seen[1] > 8000);
}

/* A comb of n corners whose teeth all lie beside each other: every edge spans every other along its longer side. Sound,
 * and as much work as an outline of so many corners can be. */
static void make_comb(double (*p)[2], int n)
{
    for (int k = 0; k < n - 2; k++) {
        p[k][0] = (k + 1) / 2 % 2 ? 1000 : 1 + 0.001 * k;
        p[k][1] = 0.1 * k;
    }
    p[n - 2][0] = 0, p[n - 2][1] = 0.1 * (n - 3);
    p[n - 1][0] = 0, p[n - 1][1] = -1;
}

static void a_tangle_is_work_of_a_limit(void **state)
{
    (void)state;
    static double p[culture_outline_most][2];
    Culture       c = {0};
    make_comb(p, 500);
    CHECK(take_outline(&c, (const double(*)[2])p, 500) == 1);
    make_comb(p, culture_outline_most); /* 8 million pairs, of which a million are looked at */
    CHECK(take_outline(&c, (const double(*)[2])p, culture_outline_most) == 0 && c.left_out == 1);
    /* as many corners where outlines are not tangled */
    for (int k = 0; k < culture_outline_most; k++) {
        const double a = 2 * pi_rad * k / culture_outline_most, r = 400 + 5 * sin(37 * a);
        p[k][0] = r * cos(a), p[k][1] = r * sin(a);
    }
    CHECK(take_outline(&c, (const double(*)[2])p, culture_outline_most) == 1);
    culture_free(&c);
}

/* ---- look-ups ---------------------------------------------------------------------------------------- */

static double piece_m(const double p[2], const double a[2], const double b[2])
{
    const double d[2] = {b[0] - a[0], b[1] - a[1]}, square = d[0] * d[0] + d[1] * d[1];
    double       t = square > 0 ? ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / square : 0;
    t = fmin(fmax(t, 0), 1);
    return sqrt(pow(p[0] - a[0] - t * d[0], 2) + pow(p[1] - a[1] - t * d[1], 2));
}

/* Distance to an outline, 0 within it: by the sum of the angles under which its edges are seen. */
static double outline_m(const Culture *c, const Building *b, const double p[2])
{
    double angle = 0, least = INFINITY;
    for (int k = 0; k < b->corners; k++) {
        const double *q = c->corner_m[b->first_corner + k], *r = c->corner_m[b->first_corner + (k + 1) % b->corners];
        const double  u[2] = {q[0] - p[0], q[1] - p[1]}, v[2] = {r[0] - p[0], r[1] - p[1]};
        angle += atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]);
        least = fmin(least, piece_m(p, q, r));
    }
    return fabs(angle) > pi_rad ? 0 : least;
}

static double line_m(const Culture *c, const CultureLine *l, const double p[2])
{
    double least = INFINITY;
    for (int k = 0; k + 1 < l->corners; k++)
        least = fmin(least, piece_m(p, c->corner_m[l->first_corner + k], c->corner_m[l->first_corner + k + 1]));
    return least - 0.5 * (double)l->width_m;
}

static void scatter(Culture *c, double wide_m)
{
    for (int n = 0; n < 150; n++) {
        const double x = wide_m * (unit() - 0.5), y = wide_m * (unit() - 0.5), a = 6 * unit(), l = 5 + 40 * unit();
        const double w = 4 + 10 * unit(),
                     p[6][2] = {{x, y},
                                {x + l * cos(a), y + l * sin(a)},
                                {x + l * cos(a) - w * sin(a), y + l * sin(a) + w * cos(a)},
                                {x + 0.5 * l * cos(a) - w * sin(a), y + 0.5 * l * sin(a) + w * cos(a)},
                                {x + 0.5 * l * cos(a) - 3 * w * sin(a), y + 0.5 * l * sin(a) + 3 * w * cos(a)},
                                {x - 3 * w * sin(a), y + 3 * w * cos(a)}};
        CHECK(take_outline(c, p, 6) == 1);
    }
    for (int n = 0; n < 60; n++) {
        double p[8][2];
        for (int k = 0; k < 8; k++) p[k][0] = wide_m * 1.2 * (unit() - 0.5), p[k][1] = wide_m * 1.2 * (unit() - 0.5);
        const CultureLine l = {.width_m = (float)(n % 5 ? 8 * unit() : 90 * unit()),
                               .kind = (uint8_t)(n % CULTURE_LINE_KINDS),
                               .surface = (uint8_t)(n % 3 ? 14 + n % 2 : 0)};
        assert_int_equal(culture_add_line(c, &l, (const double(*)[2])p, 2 + below(7)), STATUS_OK);
    }
    for (int n = 0; n < 80; n++) {
        const CulturePoint q = {.x_m = wide_m * (unit() - 0.5),
                                .y_m = wide_m * (unit() - 0.5),
                                .size_m = {(float)(1 + 20 * unit()), (float)(1 + 20 * unit()), 5}};
        assert_int_equal(culture_add_point(c, &q), STATUS_OK);
    }
}

static void lookups_are_those_of_every_record(void **state)
{
    (void)state;
    static const double widths_m[] = {300, 4000, 90000};
    for (int w = 0; w < 3; w++) {
        Culture c = {0};
        int     in = 0, near = 0, laid = 0;
        scatter(&c, widths_m[w]);
        CHECK(culture_building_at(&c, 0, 0, 0) == -1 && !culture_is_near(&c, 0, 0, 1e9)); /* no index yet */
        assert_int_equal(culture_index(&c), STATUS_OK);
        for (int n = 0; n < 6000; n++) {
            /* some anywhere, also outside of all, some at a record */
            const double *at = c.corner_m[below(c.corners)];
            const double  more_m = n % 3 ? 30 * unit() : 0, s = n % 2 ? 1.4 * widths_m[w] : 60;
            const double  p[2] = {(n % 2 ? 0 : at[0]) + s * (unit() - 0.5), (n % 2 ? 0 : at[1]) + s * (unit() - 0.5)};
            int           building = -1, surface = 0, kind_line = -1, any = 0, over = 0;
            const int     kind = n % CULTURE_LINE_KINDS;
            for (int k = c.buildings - 1; k >= 0; k--)
                if (outline_m(&c, &c.building[k], p) <= more_m) building = k, any = 1;
            for (int k = 0; k < c.lines; k++) {
                const double m = line_m(&c, &c.line[k], p);
                if (m <= 0 && c.line[k].surface) surface = c.line[k].surface;
                over |= m <= more_m && c.line[k].surface;
                any |= m <= more_m;
                if (m <= more_m && c.line[k].kind == kind && kind_line < 0) kind_line = k;
            }
            for (int k = 0; k < c.points; k++) {
                const CulturePoint *q = &c.point[k];
                any |= hypot(q->x_m - p[0], q->y_m - p[1]) <=
                       more_m + 0.5 * hypot((double)q->size_m[0], (double)q->size_m[1]);
            }
            CHECK(culture_building_at(&c, p[0], p[1], more_m) == building);
            CHECK(culture_is_near(&c, p[0], p[1], more_m) == any);
            CHECK(culture_surface_at(&c, p[0], p[1]) == surface);
            CHECK(culture_surface_near(&c, p[0], p[1], more_m) == over);
            CHECK(culture_line_near(&c, (CultureLineKind)kind, p[0], p[1], more_m) == kind_line);
            in += building >= 0, near += any, laid += surface > 0;
        }
        CHECK(in > 300 && near > 600 && laid > 100);
        CHECK(culture_building_at(&c, NAN, 0, 0) == -1 && !culture_is_near(&c, 0, INFINITY, 5));
        CHECK(culture_building_at(&c, 0, 0, NAN) == -1 && !culture_is_near(&c, 0, 0, -1));
        culture_free(&c);
    }
}

/* ---- limits ------------------------------------------------------------------------------------------ */

static void memory_of_the_index_is_bounded(void **state)
{
    (void)state;
    enum { lines = 3000 };
    Culture c = {0};
    for (int n = 0; n < lines;
         n++) { /* from end to end of all that may be, as wide as may be: 60 million cells of 32 m */
        const double      p[2][2] = {{-1e6, 2e6 * unit() - 1e6}, {1e6, 2e6 * unit() - 1e6}};
        const CultureLine l = {.width_m = 1000, .surface = 14};
        assert_int_equal(culture_add_line(&c, &l, p, 2), STATUS_OK);
    }
    const struct mallinfo2 before = mallinfo2();
    assert_int_equal(culture_index(&c), STATUS_OK);
    const struct mallinfo2 after = mallinfo2();
    const double           octets = (double)(after.uordblks + after.hblkhd) - (double)(before.uordblks + before.hblkhd);
    CHECK(octets <= 100e6 + 96.0 * 2 * lines); /* a sanitizer's allocator says 0 */
    for (int n = 0; n < 200; n++) {
        const double p[2] = {2e6 * unit() - 1e6, 2e6 * unit() - 1e6};
        bool         any = false;
        for (int k = 0; k < lines && !any; k++) any = line_m(&c, &c.line[k], p) <= 0;
        CHECK(culture_surface_at(&c, p[0], p[1]) == (any ? 14 : 0));
    }
    culture_free(&c);
    assert_int_equal(culture_index(&c), STATUS_OK); /* of nothing */
    CHECK(c.index == NULL);
}

static void a_key_follows_from_every_record(void **state)
{
    (void)state;
    static const double p[4][2] = {{0, 0}, {9, 0}, {9, 9}, {0, 9}};
    char                name[6][sha256_text_size];
    for (int k = 0; k < 6; k++) {
        Culture  c = {0};
        Building b = plain;
        if (k == 1) b.ridge_m = 9;
        assert_int_equal(culture_add_building(&c, &b, p, 4), STATUS_OK);
        const CultureLine  line = {.width_m = k == 2 ? 4 : 3};
        const CulturePoint point = {.size_m = {1, 1, k == 3 ? 2 : 1}};
        const CultureTree  tree = {.x_m = 5, .mark = (uint8_t)(k == 4)};
        assert_int_equal(culture_add_line(&c, &line, p, 2), STATUS_OK);
        assert_int_equal(culture_add_point(&c, &point), STATUS_OK);
        assert_int_equal(culture_add_tree(&c, &tree), STATUS_OK);
        CacheKey key = cache_key("test");
        void    *octets;
        size_t   count;
        if (k < 5) culture_key_add(&key, &c);
        CHECK(!cache_fetch(&octets, &count, NULL, &key));
        memcpy(name[k], key.name, sizeof key.name);
        for (int n = 0; n < k; n++) CHECK(strcmp(name[n], name[k]) != 0);
        culture_free(&c);
    }
    CacheKey key = cache_key("test");
    void    *octets;
    size_t   count;
    culture_key_add(&key, NULL);
    CHECK(!cache_fetch(&octets, &count, NULL, &key) && strcmp(key.name, name[5]) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outlines_are_mended),
        cmocka_unit_test(what_cannot_be_is_left_out),
        cmocka_unit_test(crossings_are_those_of_whole_numbers),
        cmocka_unit_test(a_tangle_is_work_of_a_limit),
        cmocka_unit_test(lookups_are_those_of_every_record),
        cmocka_unit_test(memory_of_the_index_is_bounded),
        cmocka_unit_test(a_key_follows_from_every_record),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
