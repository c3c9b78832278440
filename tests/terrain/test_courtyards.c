/* Courtyards: an outline with slits has the area of the outline less that of its courtyards and slits, is open where
 * they are and built where the rest is, and does not cross itself; what no slit reaches is built over. */
#include "tests/check.h"

#include "terrain/culture/courtyards.h"

static double turn(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double area_of(const double (*p)[2], int n)
{
    double twice = 0;
    for (int k = 0; k < n; k++) twice += p[k][0] * p[(k + 1) % n][1] - p[k][1] * p[(k + 1) % n][0];
    return 0.5 * twice;
}

static bool is_in(const double (*p)[2], int n, double x, double y)
{
    bool in = false;
    for (int k = 0, l = n - 1; k < n; l = k++)
        if ((p[l][1] > y) != (p[k][1] > y) && x < p[l][0] + (y - p[l][1]) * (p[k][0] - p[l][0]) / (p[k][1] - p[l][1]))
            in = !in;
    return in;
}

/* On which side of a line a place is; 0: on it, to the rounding of places some 300 m away from 0. */
static int side(const double a[2], const double b[2], const double c[2])
{
    const double of = turn(a, b, c);
    return (of > 1e-9) - (of < -1e-9);
}

/* All pairs of edges that share no corner. */
static bool crosses(const double (*p)[2], int n)
{
    for (int i = 0; i < n; i++)
        for (int k = i + 2; k < n; k++) {
            if (i == 0 && k == n - 1) continue;
            const double *a = p[i], *b = p[i + 1], *c = p[k], *d = p[(k + 1) % n];
            const int     ab = side(a, b, c) * side(a, b, d), cd = side(c, d, a) * side(c, d, b);
            if ((ab < 0 && cd <= 0) || (ab <= 0 && cd < 0)) return true; /* both 0: halves of one wall */
        }
    return false;
}

enum { grid = 4 };

/* A block of so many by so many courtyards between wings, of sides drawn by seed, turned. Rings go round either way. */
typedef struct Block {
    double p[culture_outline_most][2], ring[grid * grid * 4][2];
    int    first[grid * grid + 1], rings, corners;
    double outer_m2, rings_m2;
} Block;

static void put(double p[2], double x, double y, double turn_rad)
{
    p[0] = 300 + x * cos(turn_rad) - y * sin(turn_rad), p[1] = -200 + x * sin(turn_rad) + y * cos(turn_rad);
}

static void make_block(Block *b, uint64_t seed)
{
    const int nx = 1 + (int)(random_uniform(seed, 1, 0, 0) * grid),
              ny = 1 + (int)(random_uniform(seed, 1, 0, 1) * grid);
    const double turn_rad = 6.3 * random_uniform(seed, 1, 0, 2);
    double       x[2 * grid + 2] = {0}, y[2 * grid + 2] = {0};
    for (uint64_t k = 1; k < 2 * grid + 2; k++) {
        x[k] = x[k - 1] + 4 + 12 * random_uniform(seed, 2, 0, k);
        y[k] = y[k - 1] + 4 + 12 * random_uniform(seed, 3, 0, k);
    }
    const double wide = x[2 * nx + 1], high = y[2 * ny + 1];
    *b = (Block){.corners = 4, .outer_m2 = wide * high};
    for (int k = 0; k < 4; k++) put(b->p[k], k == 1 || k == 2 ? wide : 0, k >= 2 ? high : 0, turn_rad);
    for (int n = 0; n < nx * ny; n++) {
        const int    i = n % nx, j = n / nx;
        const double x0 = x[2 * i + 1], x1 = x[2 * i + 2], y0 = y[2 * j + 1], y1 = y[2 * j + 2];
        for (int k = 0; k < 4; k++) {
            const int at = (seed + (uint64_t)n) & 1 ? k : 3 - k;
            put(b->ring[4 * n + k], at == 1 || at == 2 ? x1 : x0, at >= 2 ? y1 : y0, turn_rad);
        }
        b->first[n] = 4 * n, b->first[n + 1] = 4 * n + 4, b->rings++;
        b->rings_m2 += (x1 - x0) * (y1 - y0);
    }
    if (seed % 3 == 0) /* clockwise */
        for (int c = 0; c < 2; c++) {
            const double swap = b->p[1][c];
            b->p[1][c] = b->p[3][c], b->p[3][c] = swap;
        }
}

static void blocks_of_courtyards(void **state)
{
    static Block b;
    static bool  slit[culture_outline_most];
    (void)state;
    int rings = 0;
    for (uint64_t seed = 0; seed < 1000; seed++) {
        int joined;
        make_block(&b, seed);
        const int n = courtyards_join(b.p, b.corners, (const double(*)[2])b.ring, b.first, b.rings, &joined);
        const double(*p)[2] = (const double(*)[2])b.p;
        assert_int_equal(joined, b.rings);
        assert_int_equal(n, 4 + 8 * b.rings);
        CHECK(!crosses(p, n));
        double slits_m2 = 0;
        assert_int_equal(courtyards_slits(slit, p, n), 2 * b.rings);
        for (int k = 0; k < n; k++) {
            const double length_m = hypot(p[(k + 1) % n][0] - p[k][0], p[(k + 1) % n][1] - p[k][1]);
            if (slit[k]) slits_m2 += 0.5 * length_m * courtyard_slit_m;
            CHECK(!slit[k] || length_m < 16.001); /* no wing is wider */
        }
        CHECK_NEAR(area_of(p, n), b.outer_m2 - b.rings_m2 - slits_m2, 1e-6);
        for (int r = 0; r < b.rings; r++) { /* open in its middle, built in its four walls */
            double middle[2] = {0, 0};
            for (int k = 0; k < 4; k++)
                for (int c = 0; c < 2; c++) middle[c] += 0.25 * b.ring[4 * r + k][c];
            CHECK(!is_in(p, n, middle[0], middle[1]));
            for (int k = 0; k < 4; k++) {
                const double *corner = b.ring[4 * r + k];
                const double  out = 1 + 0.2 / hypot(corner[0] - middle[0], corner[1] - middle[1]);
                CHECK(
                    is_in(p, n, middle[0] + out * (corner[0] - middle[0]), middle[1] + out * (corner[1] - middle[1])));
            }
        }
        rings += joined;
    }
    print_message("1000 blocks with %d courtyards\n", rings);
}

/* A shaft of 2 x 2 m; a ring outside of the building; one across its wall: none is joined, and nothing is lost. */
static void what_is_no_courtyard(void **state)
{
    static double p[culture_outline_most][2];
    const double  square[4][2] = {{0, 0}, {30, 0}, {30, 20}, {0, 20}};
    const double  ring[3][4][2] = {{{4, 4}, {6, 4}, {6, 6}, {4, 6}},
                                   {{40, 4}, {50, 4}, {50, 14}, {40, 14}},
                                   {{25, 5}, {35, 5}, {35, 15}, {25, 15}}};
    const int     first[2] = {0, 4};
    (void)state;
    for (int k = 0; k < 3; k++) {
        Culture        c = {0};
        const Building b = {.eaves_m = 3, .ridge_m = 3, .levels = 1};
        int            joined;
        memcpy(p, square, sizeof square);
        const int n = courtyards_join(p, 4, ring[k], first, 1, &joined);
        if (k == 0) assert_true(joined == 0 && n == 4 && memcmp(p, square, sizeof square) == 0);
        /* whatever comes of rings that are none: a sound outline, or a record that is left out */
        CHECK(n <= 12 && culture_add_building(&c, &b, (const double(*)[2])p, n) == STATUS_OK);
        CHECK(c.buildings + c.left_out == 1);
        culture_free(&c);
    }
    int none;
    CHECK(courtyards_join(p, 2, ring[0], first, 1, &none) == 2 && none == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(blocks_of_courtyards), cmocka_unit_test(what_is_no_courtyard)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
