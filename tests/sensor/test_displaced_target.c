/* What a target that may be elsewhere adds to a frame's error: how far it is displaced on the image, by its position,
 * its attitude, its facets and the ground below it, and how a plane changes when it is. Pixel by pixel:
 * test_pixel_error.c. */
#include "tests/sensor/budget_stage.h"

/* ---- how a plane changes ------------------------------------------------------------------------ */

/* A grey plane: ground of 2, alternately texture more and less; a target of 5 from column x0 and row y0 on. Its mean
 * square over the picture when it is displaced by so many pixels. */
typedef struct Block {
    int    x0, y0, x1, y1;
    double texture;
} Block;

static void paint(const Block *b)
{
    fresh();
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const bool on = x >= b->x0 && x < b->x1 && y >= b->y0 && y < b->y1;
            lab.id[y * width + x] = on;
            lab.plane[0][y * width + x] = (float)(on ? 5 : 2 + ((x + y) % 2 ? b->texture : -b->texture));
        }
    lab.picture.optical[0] = lab.plane[0];
    lab.budget.mean[0] = 2;
    lab.px[0] = (TargetPixels){.visible = (b->x1 - b->x0) * (b->y1 - b->y0), .box = {b->x0, b->y0, b->x1, b->y1}};
}

/* Sum of squares over the picture. */
static double displaced_by(double way_px)
{
    lab.entity[0].drift_m = way_px * range_m / focal_px / sqrt(2.0 / 3); /* two of three directions show */
    const FrameError error = judged(1);
    CHECK_NEAR(lab.target[0].error_px, way_px, 1e-12 * way_px);
    CHECK(error.share[BAND_OPTICAL][ERROR_LEVEL_OF_DETAIL] == 0);
    return error.share[BAND_OPTICAL][ERROR_DEAD_RECKONING] * error.share[BAND_OPTICAL][ERROR_DEAD_RECKONING] * 4 *
           pixels;
}

/* The two figures of an outline by two limits: half of the squared steps over a short way, twice the squares of its
 * difference from the surroundings over a long one. */
static void check_outline(double steps, double apart)
{
    CHECK_NEAR(displaced_by(1e-5) / (0.5e-10 * steps), 1, 1e-4);
    CHECK_NEAR(displaced_by(1e8) / (2 * apart), 1, 1e-4);
}

static void a_block_is_displaced(void **state)
{
    (void)state;
    /* 4 x 3 pixels: 14 neighbours are 3 apart, 12 pixels from the ground */
    const Block even = {10, 8, 14, 11, 0};
    paint(&even);
    check_outline(14 * 9, 12 * 9);
    /* between the limits: an edge displaced in a random direction sweeps 2 / pi of the way, and the swept area is at
     * most all of it: 1 / (1 / swept + 1 / most) */
    CHECK_NEAR(displaced_by(1), 1 / ((2 + 0.5 * pi_rad) / 126 + 1 / 216.0), 1e-9 * 30);
    CHECK_NEAR(displaced_by(3), 1 / ((2 + 1.5 * pi_rad) / (126 * 9) + 1 / 216.0), 1e-9 * 90);
    CHECK(displaced_by(0) == 0);

    /* On textured ground every pair of ground pixels is 1 apart. Of 14 pairs at the edge half are 2.5 apart and half
     * 3.5, of which half a square each is the ground's own: one of its two pixels. */
    const Block textured = {10, 8, 14, 11, 0.5};
    paint(&textured);
    check_outline(7 * (6.25 + 12.25) - 14 * 0.5, 12 * 9);

    /* in the corners of the picture two sides have no neighbours; the ring is 4 + 3 + 1 pixels, of which texture
     * leaves the mean */
    const Block corner[2] = {{0, 0, 4, 3, 0.5}, {width - 4, height - 3, width, height, 0.5}};
    for (int k = 0; k < 2; k++) {
        paint(&corner[k]);
        double steps = 0; /* the textures beside it: 4 below or above, 3 beside */
        for (int i = 0; i < 4; i++) steps += ((corner[k].x0 + i + (k ? corner[k].y0 - 1 : 3)) % 2) ? 6.25 : 12.25;
        for (int i = 0; i < 3; i++) steps += ((corner[k].y0 + i + (k ? corner[k].x0 - 1 : 4)) % 2) ? 6.25 : 12.25;
        check_outline(steps - 7 * 0.5, 12 * 9);
    }

    /* darker than its surroundings: the same squares */
    paint(&even);
    for (int i = 0; i < pixels; i++) lab.plane[0][i] = lab.id[i] ? 2 : 5;
    check_outline(14 * 9, 12 * 9);

    /* nothing around it: its difference from its own mean; 8 of 4, 8 of 6 */
    paint(&even);
    for (int i = 0; i < pixels; i++) lab.id[i] = 1, lab.plane[0][i] = i % 2 ? 4 : 6;
    lab.px[0] = (TargetPixels){.visible = pixels, .box = {0, 0, width, height}};
    check_outline(4 * (double)(height * (width - 1)), pixels); /* columns of one value: no steps down */

    /* ground that differs by more than the target: nothing is left of its steps */
    paint(&even);
    for (int i = 0; i < pixels; i++) lab.plane[0][i] = lab.id[i] ? 2 : i % 2 ? 0 : 4;
    CHECK(displaced_by(1) == 0);

    /* one that is not seen, or whose range is not known, is displaced by nothing */
    paint(&even);
    lab.px[0].visible = 0;
    lab.entity[0].drift_m = 1;
    CHECK(judged(1).share[BAND_OPTICAL][ERROR_DEAD_RECKONING] == 0 && isnan(lab.target[0].error_px));
    static const double unknown_m[3] = {NAN, 0, -1};
    for (int k = 0; k < 3; k++) {
        lab.px[0].visible = 12, lab.target[0].range_m = unknown_m[k];
        CHECK(judged(1).share[BAND_OPTICAL][ERROR_DEAD_RECKONING] == 0 && isnan(lab.target[0].error_px));
    }
    /* nor one beyond those that are asked for */
    lab.target[0].range_m = range_m;
    lab.px[1] = lab.px[0], lab.entity[1].drift_m = 1;
    judged(1);
    CHECK(lab.target[0].error_px > 0 && isnan(lab.target[1].error_px));
}

/* Half a pixel of a small target on textured ground: 1.5 above it. Its steps are those to four neighbours; of these and
 * of itself the ground shows 4 (1 + 0.5^2) squares. */
static void a_small_target_is_displaced(void **state)
{
    (void)state;
    const Block none = {0, 0, 0, 0, 0.5};
    paint(&none);
    const int at = 8 * width + 10;
    lab.picture.covered = lab.covered;
    lab.covered[at] = 0.5f, lab.plane[0][at] = 3.5f;
    lab.px[0] = (TargetPixels){.visible = 0.5, .small = true, .box = {10, 8, 11, 9}};
    /* the neighbours are all 2.5, the corners of the ring 1.5: its mean is 2 */
    check_outline(4 * 1 - 0.5 * 4 * 1.25, 1.5 * 1.5);
    /* one that is not small is where its id is, whatever others cover */
    lab.px[0].small = false;
    CHECK(displaced_by(1) == 0);
    lab.id[at] = 1;
    check_outline(4 * 1 - 0.5 * 4 * 1, 1.5 * 1.5);
    /* and so is a small one, in a pixel that shows it without being covered by any */
    lab.px[0].small = true, lab.covered[at] = 0;
    check_outline(4 * 1 - 0.5 * 4 * 1, 1.5 * 1.5);
}

/* Of a large target every third row is looked at: 102 x 102 pixels with its ring, over 4096. */
static void rows_of_a_large_target_stand_for_others(void **state)
{
    (void)state;
    enum { wide = 120, all = wide * wide };
    static float    grey[all];
    static uint32_t id[all];
    fresh();
    for (int i = 0; i < all; i++) {
        id[i] = i % wide >= 10 && i % wide < 110 && i / wide >= 10 && i / wide < 110;
        grey[i] = id[i] ? 5 : 2;
    }
    lab.picture = (Picture){
        .width = wide, .height = wide, .entity = id, .target = lab.px, .budget = &lab.budget, .optical = {grey}};
    lab.budget.mean[0] = 2;
    lab.px[0] = (TargetPixels){.visible = 1e4, .box = {10, 10, 110, 110}};
    /* Rows 9, 12, .. 108: of the first the 100 pixels below which it begins, of 33 others two edges; each for three. */
    const double scale = (double)all / pixels;
    CHECK_NEAR(displaced_by(1e-5) * scale / (0.5e-10 * 3 * 9 * (100 + 66)), 1, 1e-4);
    CHECK_NEAR(displaced_by(1e8) * scale / (2.0 * 3 * 9 * 3300), 1, 1e-4);
    /* all rows of a small one, wherever it is: 20 x 20 in the far corner, with two sides of 20 */
    for (int i = 0; i < all; i++) {
        id[i] = i % wide >= 100 && i / wide >= 100;
        grey[i] = id[i] ? 5 : 2;
    }
    lab.px[0] = (TargetPixels){.visible = 400, .box = {100, 100, wide, wide}};
    CHECK_NEAR(displaced_by(1e-5) * scale / (0.5e-10 * 9 * 40), 1, 1e-4);
    CHECK_NEAR(displaced_by(1e8) * scale / (2.0 * 9 * 400), 1, 1e-4);
}

/* Position, attitude and facets of a target each displace it on the image; facets are the level of detail's. */
static void ways_on_the_image(void **state)
{
    (void)state;
    const Block  block = {10, 8, 14, 11, 0};
    const double px_m = focal_px / range_m;
    paint(&block);
    lab.entity[0].drift_m = 0.3; /* two of three directions show */
    judged(1);
    CHECK_NEAR(lab.target[0].error_px, 0.3 * sqrt(2 / 3.0) * px_m, 1e-12);
    lab.entity[0].drift_m = 0, lab.entity[0].drift_rad = 0.2; /* about its middle: half the radius in the mean */
    FrameError error = judged(1);
    CHECK_NEAR(lab.target[0].error_px, 0.1 * lab.radius_m * px_m, 1e-12);
    CHECK(error.share[BAND_OPTICAL][ERROR_DEAD_RECKONING] > 0 && error.share[BAND_OPTICAL][ERROR_LEVEL_OF_DETAIL] == 0);
    lab.entity[0].drift_rad = 0, lab.sag_m = 0.6; /* facets: two thirds of the most, in the mean */
    error = judged(1);
    CHECK_NEAR(lab.target[0].error_px, 0.4 * px_m, 1e-12);
    /* 0.8 px: over the picture's pixels and the mean's square */
    const double square = 1 / ((2 + 0.4 * pi_rad) / (126 * 0.64) + 1 / 216.0) / pixels / 4;
    CHECK_NEAR(error.share[BAND_OPTICAL][ERROR_LEVEL_OF_DETAIL], sqrt(square), 1e-12);
    CHECK(error.share[BAND_OPTICAL][ERROR_DEAD_RECKONING] == 0);
    lab.budget.level_of_detail[0] = 0.5; /* beside what the renderer says of it: a quarter of the mean */
    error = judged(1);
    CHECK_NEAR(error.share[BAND_OPTICAL][ERROR_LEVEL_OF_DETAIL], sqrt(square + 0.0625), 1e-12);
    lab.entity[0].drift_m = 0.3, lab.entity[0].drift_rad = 0.2;
    judged(1);
    CHECK_NEAR(lab.target[0].error_px / px_m, sqrt(0.09 * 2 / 3 + 0.01 * lab.radius_m * lab.radius_m + 0.16), 1e-12);
    lab.target[0].range_m *= 4; /* four times as far: a quarter on the image */
    judged(1);
    CHECK_NEAR(lab.target[0].error_px / px_m * 4, sqrt(0.09 * 2 / 3 + 0.01 * lab.radius_m * lab.radius_m + 0.16),
               1e-12);
}

/* ---- the ground under a target ------------------------------------------------------------------ */

enum { posts = 17 };
static const double east_m = 0.4, north_m = 0.9; /* heights of every second post along either axis */

/* How far a post grid whose odd posts are that high is above one of every second post: tents of the two axes, added. */
static double tents(double x, double y)
{
    return east_m * (1 - fabs(remainder(x - 1, 2))) + north_m * (1 - fabs(remainder(y - 1, 2)));
}

static void the_ground_lifts_and_leans_a_target(void **state)
{
    (void)state;
    const Block block = {10, 8, 14, 11, 0};
    paint(&block);
    Elevation   *elevation = &lab.landscape.elevation;
    const double spacing_m = 2 * lab.radius_m, px_m = focal_px / range_m; /* the points are a quarter of a cell off */
    assert_int_equal(elevation_level_create(elevation, 0, &(ElevationGrid){posts, posts, 0, 0, spacing_m, 0, 0.1}),
                     STATUS_OK);
    elevation->level_count = 1;
    for (int j = 0; j < posts; j++)
        for (int i = 0; i < posts; i++) elevation_set_post(&elevation->level[0], i, j, i % 2 * 4 + j % 2 * 9);
    elevation_build_pyramids(elevation);
    lab.world.landscape = &lab.landscape;
    lab.clamped = true;
    /* over post (5, 7): all four points are lower than the crest by a quarter of its slopes, and it stands level; then
     * beside it, where it leans towards east and north */
    static const double at[3][2] = {{5, 7}, {5.125, 7}, {5.125, 6.25}};
    for (int k = 0; k < 3; k++) {
        SnapshotEntity *e = &lab.entity[0];
        const double    x = at[k][0], y = at[k][1], p_enu[3] = {spacing_m * x, spacing_m * y, 0};
        const double    east = tents(x + 0.25, y), west = tents(x - 0.25, y);
        const double    north = tents(x, y + 0.25), south = tents(x, y - 0.25);
        ecef_from_enu(e->p_ecef, &lab.world.frame, p_enu);
        e->type = (DisEntityType){.kind = dis_kind_platform, .domain = dis_domain_land};
        judged(1);
        const double rise_m = (east + west + north + south) / 4, lean_m = hypot(east - west, north - south) / 2;
        CHECK_NEAR(lab.target[0].error_px, hypot(rise_m, lean_m) * px_m, 1e-6);
        if (k == 0) CHECK_NEAR(hypot(rise_m, lean_m), (east_m + north_m) * 0.875, 1e-12);
        if (k == 1) CHECK_NEAR(lean_m, 0.5 * 0.25 * east_m, 1e-12); /* 0.375 and 0.125 from the crest */
        if (k == 2) CHECK_NEAR(lean_m, 0.5 * hypot(0.25 * east_m, 0.5 * north_m), 1e-12);
        lab.sag_m = 1.5; /* with facets, as squares */
        judged(1);
        CHECK_NEAR(lab.target[0].error_px, sqrt(rise_m * rise_m + lean_m * lean_m + 1) * px_m, 1e-6);
        lab.sag_m = 0;
        /* only what stands on the ground, and is of the land */
        lab.clamped = false;
        judged(1);
        CHECK(lab.target[0].error_px == 0);
        lab.clamped = true;
        e->type.domain = dis_domain_air;
        judged(1);
        CHECK(lab.target[0].error_px == 0);
        e->type = (DisEntityType){.kind = dis_kind_munition, .domain = dis_domain_land};
        judged(1);
        CHECK(lab.target[0].error_px == 0);
    }
    /* at the end of the posts nothing is known */
    lab.entity[0].type = (DisEntityType){.kind = dis_kind_platform, .domain = dis_domain_land};
    ecef_from_enu(lab.entity[0].p_ecef, &lab.world.frame, (double[3]){spacing_m * (posts - 1), spacing_m * 7, 0});
    judged(1);
    CHECK(lab.target[0].error_px == 0);
    elevation_destroy(elevation);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_block_is_displaced),
        cmocka_unit_test(a_small_target_is_displaced),
        cmocka_unit_test(rows_of_a_large_target_stand_for_others),
        cmocka_unit_test(ways_on_the_image),
        cmocka_unit_test(the_ground_lifts_and_leans_a_target),
    };
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
