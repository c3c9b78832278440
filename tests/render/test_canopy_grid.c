/* The canopy's grid and means (render/light/canopy.h) of a few plants whose leaf area, height and openness are known to
 * the last digit: what each cell holds, what a place between cells and at a height gets, and what a hit does. labels:
 * physics */
#include "tests/check.h"

#include "render/light/canopy.h"

#include <stdlib.h>

enum { row_pine_leaf = 1, row_pine_bark, row_birch_leaf, row_birch_bark, rows_count, plants_most = 8 };

static const double origin_m[2] = {-64, 32}; /* of the grid: cells of 8 m from here */

static Plants   *plants;
static Plant     plant[plants_most];
static uint32_t  first[2 * 1 + 1];
static Woods     woods;
static Material  rows[rows_count];
static Materials materials;
static PlantQuad quads[PLANT_KINDS][2];

/* A parallelogram of sides a and b that lean by 30 degrees: of an area a b cos 30. */
static PlantQuad quad(PlantOrgan organ, double area, double up, double down)
{
    const float a = (float)sqrt(area), lean = (float)(sqrt(area) * tan(30 * rad_per_deg));
    return (PlantQuad){.corner = {{0, 0, 1}, {a, 0, 1}, {a + lean, a, 1}, {lean, a, 1}},
                       .organ = (uint8_t)organ,
                       .outline = organ == PLANT_LEAF,
                       .open_up = (float)up,
                       .open_down = (float)down};
}

/* Pines and birches of one leaf and one branch each. */
static int open_woods(void **state)
{
    (void)state;
    plants = calloc(1, sizeof *plants);
    if (!plants) return -1;
    for (int kind = 0; kind < PLANT_KINDS; kind++) {
        const bool pine = kind == PLANT_PINE;
        quads[kind][0] = pine ? quad(PLANT_BARK, 1, 0.4, 0.4) : quad(PLANT_BARK, 2, 0.2, 0.6);
        quads[kind][1] = pine ? quad(PLANT_LEAF, 2, 0.6, 0.2) : quad(PLANT_LEAF, 4, 0.5, 0.3);
        plants->shape[kind][plant_whole] =
            (PlantShape){.quads = 2, .quad = quads[kind], .bark_quads = 1, .leaf_area = 3.6f};
        plants->shape[kind][plant_whole].crown_low = pine ? 0.5f : 0.25f,
        plants->shape[kind][plant_whole].crown_radius = 0.375f;
        for (int o = 0; o < plant_outlines; o++) plants->outline_area[kind][o] = o != 1 ? 9 : pine ? 0.5f : 0.8f;
        materials.plant[kind][PLANT_LEAF] = pine ? row_pine_leaf : row_birch_leaf;
        materials.plant[kind][PLANT_BARK] = pine ? row_pine_bark : row_birch_bark;
    }
    materials.count = rows_count, materials.material = rows;
    for (int c = 0; c < optical_channel_count; c++) {
        const float more = 0.01f * (float)c;
        rows[row_pine_leaf].rho[c] = 0.4f + more, rows[row_pine_leaf].tau[c] = 0.3f, rows[row_pine_bark].rho[c] = 0.2f;
        rows[row_birch_leaf].rho[c] = 0.3f + more, rows[row_birch_leaf].tau[c] = 0.2f,
        rows[row_birch_bark].rho[c] = 0.1f;
    }
    woods = (Woods){.nx = 2, .ny = 1, .first = first, .plant = plant, .origin_enu = {origin_m[0], origin_m[1], 100}};
    return 0;
}

static int close_woods(void **state)
{
    (void)state;
    free(plants);
    return 0;
}

static void stand_at(PlantKind kind, double x_m, double y_m, double height_m, double width)
{
    plant[woods.count++] = (Plant){.p_m = {(float)x_m, (float)y_m, 0},
                                   .kind = (uint8_t)kind,
                                   .height = (uint16_t)lrint(height_m / plant_height_step_m),
                                   .width = (uint8_t)lrint(128 * width)};
}

static Canopy *create(bool leaves)
{
    Canopy *c = NULL;
    assert_int_equal(canopy_create(&c, &woods, plants, &materials, leaves), STATUS_OK);
    return c;
}

/* The middle of a cell. */
static double x_of(double i) { return origin_m[0] + 8 * (i + 0.5); }
static double y_of(double j) { return origin_m[1] + 8 * (j + 0.5); }

static double index_at(const Canopy *c, double i, double j) { return canopy_leaf_area_above(c, x_of(i), y_of(j), 0); }

/* A birch of 16 m, as wide as its prototype: 3.6 x 256 = 921.6 m2 of leaves within 6 m of its trunk, 12 m away, from 4
 * m up. It stands at 26, 36 m, so over x 20 .. 32, y 30 .. 42: a third of it in the cell from 16 m, two thirds in that
 * from 24 m, and of each a sixth, two thirds and a sixth in those from 24, 32 and 40 m. 921.6 / 64 = 14.4: indices of
 * 0.8, 3.2, 0.8 and of 1.6, 6.4, 1.6, in steps of 1/16: 13/16, 51/16, 13/16, 26/16, 102/16 (6.4 is 102.4 / 16), 26/16.
 */
static void crown_on_cells(void **state)
{
    (void)state;
    static const double column[8] = {0, 0, 1, 2, 0, 0, 0, 0}, row[8] = {0, 0, 0, 0.8, 3.2, 0.8, 0, 0};
    woods.count = 0;
    stand_at(PLANT_BIRCH, 26, 36, 16, 1);
    Canopy *c = create(true);
    for (int j = 0; j < 8; j++)
        for (int i = 0; i < 16; i++) {
            CanopyStand  at;
            const double want = i < 8 ? rint(16 * column[i] * row[j]) / 16 : 0;
            canopy_stand(&at, c, x_of(i) - 3.9, y_of(j) + 3.9);
            CHECK_NEAR(at.leaf_area, want, 1e-9);
            CHECK_NEAR(at.open, canopy_gap(0.5 * want), 2e-7);
            if (!(want > 0)) CHECK(at.top_m == 0 && at.base_m == 0 && at.open == 1);
            else CHECK(at.top_m == 16 && at.base_m == 4);
            if (i > 0 && j > 0 && i < 15 && j < 7) CHECK_NEAR(index_at(c, i, j), want, 1e-9);
        }
    /* straight between the middles of cells: a quarter of the way to the one in the west, three quarters to the north's
     */
    CHECK_NEAR(index_at(c, 2.75, 4), 0.25 * 51 / 16 + 0.75 * 102 / 16, 1e-9);
    CHECK_NEAR(index_at(c, 3, 4.75), 0.25 * 102 / 16 + 0.75 * 26 / 16, 1e-9);
    CHECK_NEAR(index_at(c, 3.25, 3.5), 0.75 * 0.5 * (26 + 102) / 16, 1e-9);
    /* from the crown's base at 4 m up to its top at 16 m as much of it as lies above */
    CHECK_NEAR(canopy_leaf_area_above(c, x_of(3), y_of(4), 3), 6.375, 1e-9);
    CHECK_NEAR(canopy_leaf_area_above(c, x_of(3), y_of(4), 4), 6.375, 1e-9);
    CHECK_NEAR(canopy_leaf_area_above(c, x_of(3), y_of(4), 7), 6.375 * 9 / 12, 1e-9);
    CHECK_NEAR(canopy_leaf_area_above(c, x_of(3), y_of(4), 15), 6.375 * 1 / 12, 1e-9);
    CHECK(canopy_leaf_area_above(c, x_of(3), y_of(4), 16) == 0 && canopy_leaf_area_above(c, x_of(3), y_of(4), 20) == 0);
    canopy_destroy(c);
}

/* What is asked beyond the middles of the outermost cells is beyond the grid; what hangs over its edge is lost. */
static void edges_of_the_grid(void **state)
{
    (void)state;
    woods.count = 0;
    /* crowns of a half width of 6 m: two thirds of them along x, five sixths along y, over the grid */
    stand_at(PLANT_BIRCH, 2, 3, 16, 1);
    stand_at(PLANT_BIRCH, 126, 61, 16, 1);
    stand_at(PLANT_BIRCH, 126, 36, 16, 1); /* nor does it come back in the west */
    Canopy     *c = create(true);
    CanopyStand at;
    canopy_stand(&at, c, origin_m[0], origin_m[1]);
    CHECK_NEAR(at.leaf_area, rint(16 * 14.4 * 8 / 12 * 8 / 12) / 16, 1e-9);
    canopy_stand(&at, c, origin_m[0] + 127.99, origin_m[1] + 63.99);
    CHECK_NEAR(at.leaf_area, rint(16 * 14.4 * 8 / 12 * 8 / 12) / 16, 1e-9);
    canopy_stand(&at, c, origin_m[0] + 1, origin_m[1] + 8);
    CHECK_NEAR(at.leaf_area, rint(16 * 14.4 * 8 / 12 * 1 / 12) / 16, 1e-9);
    canopy_stand(&at, c, origin_m[0] + 127, origin_m[1] + 36);
    CHECK(at.leaf_area > 6);
    for (int j = 3; j < 7; j++) {
        canopy_stand(&at, c, origin_m[0] + 1, origin_m[1] + 8 * j);
        CHECK(at.leaf_area == 0);
    }
    static const double beyond[5][2] = {{-0.01, 1}, {1, -0.01}, {128, 1}, {1, 64}, {NAN, 1}};
    for (int k = 0; k < 5; k++) {
        canopy_stand(&at, c, origin_m[0] + beyond[k][0], origin_m[1] + beyond[k][1]);
        CHECK(at.leaf_area == 0 && at.open == 1);
    }
    CHECK(index_at(c, 0, 0) > 6 && index_at(c, -0.01, 0) == 0 && index_at(c, 0, -0.01) == 0);
    CHECK(index_at(c, 14.99, 6.99) > 6 && index_at(c, 15, 6.99) == 0 && index_at(c, 14.99, 7) == 0);
    canopy_destroy(c);
    /* a crown without a radius is all in its trunk's cell; more than 255/16 is taken for that; pines keep their leaves
     * in winter */
    woods.count = 0;
    for (int kind = 0; kind < PLANT_KINDS; kind++) plants->shape[kind][plant_whole].crown_radius = 0;
    stand_at(PLANT_PINE, 60, 20, 10, 1.5); /* 3.6 x 100 x 1.5 / 64 = 8.4375 */
    stand_at(PLANT_BIRCH, 80, 20, 20, 1);  /* 22.5 */
    stand_at(PLANT_BIRCH, 100, 20, 10, 1); /* 5.625, of which the tops are weighted by their leaves: */
    stand_at(PLANT_BIRCH, 100, 20, 6, 1);  /* 2.025; (5.625 x 10 + 2.025 x 6) / 7.65 = 8.94 m, in steps of 0.25 */
    for (int leaves = 0; leaves < 2; leaves++) {
        c = create(leaves);
        canopy_stand(&at, c, origin_m[0] + 60, origin_m[1] + 20);
        CHECK(at.leaf_area == 8.4375 && at.top_m == 10 && at.base_m == 5);
        canopy_stand(&at, c, origin_m[0] + 80, origin_m[1] + 20);
        CHECK(at.leaf_area == (leaves ? 255 / 16.0 : 0));
        canopy_stand(&at, c, origin_m[0] + 100, origin_m[1] + 20);
        CHECK(at.leaf_area == (leaves ? 122 / 16.0 : 0) && at.top_m == (leaves ? 9 : 0) &&
              at.base_m == (leaves ? 2.25 : 0));
        canopy_destroy(c);
    }
    for (int kind = 0; kind < PLANT_KINDS; kind++) plants->shape[kind][plant_whole].crown_radius = 0.375f;
}

/* 2 E3(x): 0.4432088 at 0.5, 0.2193840 at 1, 0.0602669 at 2 (Abramowitz & Stegun, table 5.4: E3 = 0.2216044, 0.1096920,
 * 0.0301334). Leaves of an index L let 2 E3(L / 2) of an even sky through and exp(-L / (2 sin h)) of the sun, whose
 * sine is taken for no less than 0.05. */
static void places_among_leaves(void **state)
{
    (void)state;
    CanopyPlace at;
    CHECK_NEAR(canopy_gap(0.5), 0.4432088, 3e-7);
    CHECK_NEAR(canopy_gap(1), 0.2193840, 3e-7);
    CHECK_NEAR(canopy_gap(2), 0.0602669, 3e-7);
    CHECK(canopy_gap(0) == 1 && canopy_gap(-1) == 1 && canopy_gap(NAN) == 1);
    woods.count = 0;
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        plants->shape[kind][plant_whole].crown_radius = 0, plants->shape[kind][plant_whole].leaf_area = 2.56f;
    stand_at(PLANT_BIRCH, 60, 20, 10, 1); /* 2.56 x 100 / 64 = 4, from 2.5 to 10 m */
    Canopy      *c = create(true);
    const double x = x_of(7), y = y_of(2);
    CHECK(canopy_place(&at, c, x, y, 0, 0.5));
    CHECK_NEAR(at.up, 0.0602669, 4e-7);
    CHECK_NEAR(at.up_from_ground, 0.0602669, 4e-7);
    CHECK(at.down == 1);
    CHECK_NEAR(at.sun_here, exp(-4), 1e-12);
    CHECK_NEAR(at.sun_on_ground, exp(-4), 1e-12);
    /* halfway up the crown; a quarter below its top; above; the sun at 30 and 1.7 degrees */
    CHECK(canopy_place(&at, c, x, y, 6.25, 0.5));
    CHECK_NEAR(at.up, 0.2193840, 4e-7);
    CHECK_NEAR(at.down, 0.2193840, 4e-7);
    CHECK_NEAR(at.sun_here, exp(-2), 1e-12);
    CHECK_NEAR(at.sun_on_ground, exp(-4), 1e-12);
    CHECK(canopy_place(&at, c, x, y, 8.125, 0.03));
    CHECK_NEAR(at.up, 0.4432088, 4e-7);
    CHECK_NEAR(at.down, canopy_gap(1.5), 4e-7);
    CHECK_NEAR(at.up_from_ground, 0.0602669, 4e-7);
    CHECK_NEAR(at.sun_here / exp(-10), 1, 1e-9);
    CHECK_NEAR(at.sun_on_ground / exp(-40), 1, 1e-9);
    CHECK(canopy_place(&at, c, x, y, 12, 0.5) && at.up == 1 && at.sun_here == 1);
    /* between two nodes of its table, a 32nd apart: straight, within (1/32)^2 / 8 of the second derivative */
    CHECK(canopy_place(&at, c, x, y, 6.25 - 7.5 / 4 * 3 / 64, 0.5));
    CHECK_NEAR(at.up, canopy_gap(1 + 3.0 / 128), 6e-5);
    CHECK(!canopy_place(&at, c, x + 50, y, 0, 0.5));
    CHECK(at.up == 1 && at.down == 1 && at.up_from_ground == 1 && at.sun_here == 1 && at.sun_on_ground == 1);
    canopy_destroy(c);
    for (int kind = 0; kind < PLANT_KINDS; kind++)
        plants->shape[kind][plant_whole].crown_radius = 0.375f, plants->shape[kind][plant_whole].leaf_area = 3.6f;
}

/* What light meets: half of a leaf's area within its outline, a quarter of a branch's side, each by the mean of its two
 * opennesses. A pine: 2 x 0.5 x 0.5 x 0.4 = 0.2 of leaf, 1 x 0.25 x 0.4 = 0.1 of bark; a birch 4 x 0.8 x 0.5 x 0.4 =
 * 0.64 and 2 x 0.25 x 0.4 = 0.2. Of three pines and five birches, 3 x 0.3 + 5 x 0.84 = 5.1 in all: open above (3 (0.2 x
 * 0.6 + 0.1 x 0.4) + 5 (0.64 x 0.5 + 0.2 x 0.2)) / 5.1 = 2.28 / 5.1 = 0.447059 below      (3 (0.2 x 0.2 + 0.1 x 0.4) +
 * 5 (0.64 x 0.3 + 0.2 x 0.6)) / 5.1 = 1.8 / 5.1 = 0.352941 w          (3 (0.2 x 0.7 + 0.1 x 0.2) + 5 (0.64 x 0.5 + 0.2
 * x 0.1)) / 5.1 = 2.18 / 5.1 = 0.427451, and of leaves that are brighter by 0.01, 3.8 / 5.1 of that more. In winter the
 * birches' bark is left: 3 x 0.3 + 5 x 0.2 = 1.9. */
static const double mean_up = 2.28 / 5.1, mean_down = 1.8 / 5.1;

static double scattered(int channel) { return (2.18 + 3.8 * 0.01 * channel) / 5.1; }

static void means_of_the_woods(void **state)
{
    (void)state;
    woods.count = 0;
    woods.by_kind[PLANT_PINE] = 3, woods.by_kind[PLANT_BIRCH] = 5;
    for (int leaves = 0; leaves < 2; leaves++) {
        Canopy      *c = create(leaves);
        CanopyPlace  at = {1, 1, 1, 1, 1, .low = 1};
        double       on_ground;
        const double up = leaves ? mean_up : (3 * 0.16 + 5 * 0.2 * 0.2) / 1.9,
                     down = leaves ? mean_down : (3 * 0.08 + 5 * 0.2 * 0.6) / 1.9;
        canopy_place_of_plant(&at, c);
        CHECK_NEAR(at.up, up, 1e-6);
        CHECK_NEAR(at.down, down, 1e-6);
        CHECK_NEAR(at.sun_here, up, 1e-6);
        CHECK(at.up_from_ground == 1 && at.sun_on_ground == 1);
        at = (CanopyPlace){0.05, 0.04, 0.03, 0.02, 0.01, .low = 1};
        canopy_place_of_plant(&at, c);
        CHECK(at.up == 0.05 && at.down == 0.04 && at.sun_here == 0.02);
        /* under an even sky of 100 alone, of which leaves see 0.2: M = w/2 x 20 / (1 - w/2 x 1.8) */
        for (int k = 0; k < optical_channel_count; k++) {
            const double half = 0.5 * (leaves ? scattered(k) : (3 * (0.16 + 0.002 * k) + 5 * 0.2 * 0.1) / 1.9);
            at = (CanopyPlace){0.2, 0, 0.3, 1, 1, .low = 1};
            CHECK_NEAR(canopy_exitance(&on_ground, c, &at, k, 0, 100, 0.5, 0), half * 20 / (1 - 1.8 * half), 1e-5);
            CHECK_NEAR(on_ground, 30 + 0.7 * half * 20 / (1 - 1.8 * half), 1e-5);
        }
        canopy_destroy(c);
    }
    woods.by_kind[PLANT_PINE] = woods.by_kind[PLANT_BIRCH] = 0;
    Canopy     *none = create(true);
    CanopyPlace at = {1, 1, 1, 1, 1, .low = 1};
    canopy_place_of_plant(&at, none);
    CHECK(at.up == 0 && at.down == 0);
    canopy_destroy(none);
    rows[row_pine_leaf].rho[0] = 0.9f, rows[row_pine_leaf].tau[0] = 0.4f; /* more than all is taken for all */
    woods.by_kind[PLANT_PINE] = 1;
    Canopy *white = create(true);
    double  on_ground;
    at = (CanopyPlace){0.2, 0.2, 1, 1, 1, .low = 1};
    CHECK_NEAR(canopy_exitance(&on_ground, white, &at, 0, 0, 100, 0.5, 0),
               0.5 * (0.2 / 0.3 * 1.3 + 0.1 / 0.3 * 0.2) * 20 / (1 - 1.6 * 0.5 * (0.2 / 0.3 * 1.3 + 0.1 / 0.3 * 0.2)),
               1e-3);
    canopy_destroy(white);
    rows[row_pine_leaf].rho[0] = 0.4f, rows[row_pine_leaf].tau[0] = 0.3f;
    woods.by_kind[PLANT_PINE] = 0;
}

/* ---- hits ------------------------------------------------------------------------------------- */

/* M and what falls on the ground, of w, as canopy.h has them, all orders at once. */
static double leaves_on_paper(double *on_ground, const CanopyPlace *p, double w, double sun, double sky, double sine,
                              double rho)
{
    const double u = fmin(p->up, mean_up), d = fmin(p->down, mean_down), hidden = 1 - p->up_from_ground;
    const double through = sun * sine * p->sun_on_ground + sky * p->up_from_ground;
    const double on_leaf = 0.5 * sun * (sine > 0 ? fmin(p->sun_here, mean_up) : 0) + u * sky + d * rho * through;
    const double m = 0.5 * w * on_leaf / (1 - 0.5 * w * (2 - u - d + d * rho * hidden));
    *on_ground = through + hidden * m;
    return m;
}

/* Ground at 100 m, and on and over it: ground, a part 6.25 m up, a leaf there, ground in the open, sky, a leaf in the
 * open. */
/* Mean light on leaves that are seen from below one by one: of those with a share x of all above them, exp(-s x) of the
 * light arrives, and exp(-d (1 - x)) of them are seen. */
static double seen_on_paper(double s, double d)
{
    enum { steps = 20000 };
    double sum = 0, weights = 0;
    for (int k = 0; k < steps; k++) {
        const double x = (k + 0.5) / steps, weight = exp(-d * (1 - x));
        sum += weight * exp(-s * x), weights += weight;
    }
    return sum / weights;
}

static void light_at_hits(void **state)
{
    (void)state;
    static CanopyLight   light;
    static Hits          hits;
    static const uint8_t kind[6] = {hit_ground, hit_part, hit_plant, hit_ground, hit_sky, hit_plant};
    static const double  up[6] = {0, 6.25, 6.25, 0, 0, 3};
    Landscape            landscape = {0};
    const ElevationGrid  grid = {
         .nx = 2, .ny = 2, .x0_m = -500, .y0_m = -500, .spacing_m = 1000, .z0_m = 100, .step_m = 1};
    assert_int_equal(elevation_level_create(&landscape.elevation, 0, &grid), STATUS_OK);
    landscape.elevation.level_count = 1;
    elevation_build_pyramids(&landscape.elevation);
    CHECK_NEAR(elevation_height(&landscape.elevation, 0, 0, NULL), 100, 1e-9);
    for (int k = 0; k < PLANT_KINDS; k++)
        plants->shape[k][plant_whole].crown_radius = 0, plants->shape[k][plant_whole].leaf_area = 2.56f;
    woods.count = 0, woods.by_kind[PLANT_PINE] = 3, woods.by_kind[PLANT_BIRCH] = 5;
    stand_at(PLANT_BIRCH, 60, 20, 10, 1);
    Canopy *c = create(true);
    hits.count = 6;
    for (int i = 0; i < 6; i++) {
        hits.kind[i] = kind[i], hits.range_m[i] = kind[i] == hit_sky ? INFINITY : 50;
        hits.p_enu[0][i] = i == 3 || i == 5 ? x_of(12) : x_of(7), hits.p_enu[1][i] = y_of(2),
        hits.p_enu[2][i] = 100 + up[i];
        hits.open_up[i] = 0.1f, hits.open_down[i] = 0.4f, hits.n_enu[2][i] = 1;
    }
    for (int night = 0; night < 2; night++) {
        const double sine = night ? -0.2 : 0.5, above = night ? 0 : 0.5;
        Daylight     day = {.sun_d_enu = {sqrt(1 - sine * sine), 0, sine}};
        float        ground_rho[optical_channel_count];
        for (int k = 0; k < optical_channel_count; k++)
            day.sun_w_m2[k] = night ? 0 : 400 + k, day.sky_w_m2[k] = night && k == 1 ? 0 : 100 + 3 * k,
            ground_rho[k] = 0.1f * (float)(k + 1);
        light.up[0] = -1, light.leaves_w_m2[2][0] = -1;
        assert_true(canopy_light(&light, c, &landscape, &day, ground_rho, &hits, ~(1u << 2)));
        CHECK(light.leaves_w_m2[2][0] == -1); /* of a channel that is not asked for */
        for (int i = 0; i < 6; i++) {
            /* in the crown's middle an index of 2 above and of 2 below; on the ground all 4; in the open none */
            const bool        among = i == 1 || i == 2, open = i > 2;
            const double      slant = 0.5 / fmax(above, 0.05);
            const CanopyPlace at = {
                open ? 1 : among ? 0.2193840 : 0.0602669, among ? 0.2193840 : 1,      open ? 1 : 0.0602669,
                open ? 1 : exp(-slant * (among ? 2 : 4)), open ? 1 : exp(-slant * 4), .low = 1};
            CHECK_NEAR(light.up[i], kind[i] == hit_plant ? fmin(at.up, 0.1) : at.up, 1e-6);
            CHECK_NEAR(light.down[i], kind[i] == hit_plant ? fmin(at.down, 0.4) : at.down, 1e-6);
            CanopyPlace seen = at; /* leaves that are seen: from the ground and what stands there, those above it */
            if (kind[i] != hit_plant && !open) {
                seen.up = seen_on_paper(-log(at.up), -log(at.up));
                seen.sun_here = seen_on_paper(-log(at.sun_here), -log(at.up));
            }
            for (int k = 0; k < optical_channel_count; k++) {
                double       on_ground;
                const double sun = day.sun_w_m2[k], sky = day.sky_w_m2[k];
                const double m = leaves_on_paper(&on_ground, &seen, scattered(k), sun, sky, above, 0.1 * (k + 1));
                if (k == 2) continue;
                CHECK_NEAR(light.leaves_w_m2[k][i], m, 1e-4);
                CHECK_NEAR(light.ground[k][i], sun * above + sky > 0 ? on_ground / (sun * above + sky) : 1, 1e-5);
            }
        }
    }
    /* a leaf in the open is reason enough; the ground there is not */
    const Daylight day = {.sun_d_enu = {0, 0, 1}};
    const float    dark[optical_channel_count] = {0};
    hits.count = 1;
    hits.p_enu[0][0] = x_of(12);
    CHECK(!canopy_light(&light, c, &landscape, &day, dark, &hits, 1));
    hits.kind[0] = hit_plant;
    CHECK(canopy_light(&light, c, &landscape, &day, dark, &hits, 1));
    hits.range_m[0] = INFINITY;
    CHECK(!canopy_light(&light, c, &landscape, &day, dark, &hits, 1));
    canopy_destroy(c);
    elevation_destroy(&landscape.elevation);
}

/* ---- between runs ----------------------------------------------------------------------------- */

static uint64_t made_after(Cache *cache, bool leaves, const char *name)
{
    Canopy *c = NULL;
    assert_int_equal(canopy_create_kept(&c, &woods, plants, &materials, leaves, &(PlantsKept){cache, name}), STATUS_OK);
    canopy_destroy(c);
    return cache_counters(cache).made;
}

/* Whatever a canopy follows from is in its key: plants and their number, origin, kinds, materials and their rows,
 * winter, prototypes. */
static void keys_tell_canopies_apart(void **state)
{
    (void)state;
    char folder[temp_path_size], command[temp_path_size + 16];
    CHECK(temp_folder(folder));
    Cache *cache = cache_open(folder, 64 << 20);
    CHECK(cache);
    woods.count = 0;
    stand_at(PLANT_BIRCH, 60, 20, 10, 1);
    stand_at(PLANT_PINE, 70, 20, 10, 1);
    uint64_t made = made_after(cache, true, "a");
    CHECK(made == 1 && made_after(cache, true, "a") == 1);
    CHECK(made_after(cache, false, "a") == 2 && made_after(cache, true, "b") == 3);
    woods.count = 1;
    CHECK(made_after(cache, true, "a") == 4);
    woods.count = 2, plant[1].width = 127;
    CHECK(made_after(cache, true, "a") == 5);
    woods.origin_enu[1] += 1;
    CHECK(made_after(cache, true, "a") == 6);
    woods.by_kind[PLANT_BIRCH]++;
    CHECK(made_after(cache, true, "a") == 7);
    woods.nx = 1;
    CHECK(made_after(cache, true, "a") == 8);
    woods.ny = 2;
    CHECK(made_after(cache, true, "a") == 9);
    materials.plant[PLANT_BIRCH][PLANT_LEAF] = row_pine_leaf;
    CHECK(made_after(cache, true, "a") == 10);
    rows[row_birch_bark].rho[3] = 0.5f;
    CHECK(made_after(cache, true, "a") == 11 && made_after(cache, true, "a") == 11);
    cache_close(cache);
    snprintf(command, sizeof command, "rm -r %s", folder);
    CHECK(system(command) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(crown_on_cells),      cmocka_unit_test(edges_of_the_grid),
        cmocka_unit_test(places_among_leaves), cmocka_unit_test(means_of_the_woods),
        cmocka_unit_test(light_at_hits),       cmocka_unit_test(keys_tell_canopies_apart),
    };
    return cmocka_run_group_tests(tests, open_woods, close_woods);
}
