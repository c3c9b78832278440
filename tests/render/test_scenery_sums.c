/* What samples show of clutter: areas, boxes, nearest ranges and hottest places of hits made by hand, whatever the
 * number of workers, in parts that are taken back, beside buildings and below small targets. */
#include "tests/check.h"

#include "render/frame/frame_private.h"

enum { wide = 8, high = 4, workers = 3 };

static Arena        *arena;
static SceneryObject object[5000];
static Scenery       scenery = {.objects = 5000, .object = object};
static Samples       samples;
static float         temp_k[hits_capacity];
static float         covered[wide * high];
static Picture       picture;
static SumRules      rules;

static int setup(void **state)
{
    (void)state;
    arena = arena_create();
    for (int k = 0; k < scenery.objects; k++)
        object[k] = (SceneryObject){.kind = k == 4 ? SCENERY_BUILDINGS : SCENERY_CLUTTER, .class = CLUTTER_CAR};
    samples.temp_k = temp_k;
    return !arena;
}

static int teardown(void **state)
{
    (void)state;
    arena_destroy(arena);
    return 0;
}

static void begin(void)
{
    arena_reset(arena);
    picture = (Picture){.width = wide, .height = high};
    rules = (SumRules){.picture = &picture, .arena = arena, .steps_per_px = 720720};
}

/* A row of the picture from column x on, n samples a side, that meets nothing. */
static void row_of(PixelBlock *block, int n, int x, int y, int pixels)
{
    *block = (PixelBlock){.n = n};
    for (int k = 0; k < pixels; k++) pixels_add(block, x + k, y);
    samples.hits.count = samples.rays.count = pixels * n * n;
    for (int i = 0; i < samples.hits.count; i++) {
        samples.hits.kind[i] = hit_sky, samples.hits.instance[i] = 0, samples.hits.range_m[i] = INFINITY;
        samples.hits.entity[i] = 0, temp_k[i] = NAN;
    }
}

static void meet(int sample, HitKind kind, uint32_t instance, double range_m, float hot_k)
{
    samples.hits.kind[sample] = (uint8_t)kind, samples.hits.instance[sample] = instance;
    samples.hits.range_m[sample] = range_m, temp_k[sample] = hot_k;
}

static void count(ScenerySums *sums, const PixelBlock *block, double share)
{
    scenery_sums_area(sums, &rules, &(SharedBlock){&samples, block, share});
    if (share > 0) scenery_sums_heat(sums, &rules, &samples);
}

static void gather(const ScenerySums *sums, int of)
{
    const ScenerySums *list[workers];
    for (int k = 0; k < of; k++) list[k] = &sums[k];
    assert_int_equal(scenery_sums_gather(&picture, &rules, list, of, &scenery, arena), STATUS_OK);
}

static void areas_boxes_and_temperatures(void **state)
{
    (void)state;
    PixelBlock  block;
    ScenerySums sums[workers] = {0};
    begin();
    /* object 2 on a pixel and a half of row 1, object 0 on a quarter of a pixel; a building, a plant and the ground
     * beside them; what is whole has four samples */
    row_of(&block, 2, 2, 1, 4);
    for (int i = 0; i < 6; i++) meet(i, hit_scenery, 3, 100 - i, 310.f + (float)i);
    meet(6, hit_scenery, 5, 90, 300), meet(7, hit_ground, 0, 120, 290), meet(8, hit_plant, 3, 80, 900);
    meet(9, hit_scenery, 1, 77, 400);
    count(&sums[0], &block, 1);
    /* object 2 again, by another worker, two rows below, hotter and farther */
    row_of(&block, 1, 5, 3, 1);
    meet(0, hit_scenery, 3, 140, 500);
    count(&sums[2], &block, 1);
    gather(sums, workers);
    assert_int_equal(picture.scenery_count, 2);
    const SceneryPixels *a = &picture.scenery[0], *b = &picture.scenery[1];
    CHECK(a->object == 0 && b->object == 2);
    CHECK_NEAR(a->visible, 0.25, 1e-12);
    CHECK_NEAR(b->visible, 2.5, 1e-12);
    CHECK(a->range_m == 77 && b->range_m == 95 && a->hottest_k == 400 && b->hottest_k == 500);
    static const int box_a[4] = {4, 1, 5, 2}, box_b[4] = {2, 1, 6, 4};
    assert_memory_equal(a->box, box_a, sizeof box_a);
    assert_memory_equal(b->box, box_b, sizeof box_b);
}

/* A pixel's one sample is taken back for four: what it showed alone is gone, what they show stays. */
static void what_is_taken_back_is_gone(void **state)
{
    (void)state;
    PixelBlock  block;
    ScenerySums sums[workers] = {0};
    begin();
    row_of(&block, 1, 0, 0, 2);
    meet(0, hit_scenery, 1, 50, 300), meet(1, hit_scenery, 2, 60, 300);
    count(&sums[0], &block, 1);
    row_of(&block, 2, 0, 0, 1);
    meet(1, hit_scenery, 7, 55, 320);
    count(&sums[1], &block, 1);
    row_of(&block, 1, 0, 0, 1);
    meet(0, hit_scenery, 1, 50, 300);
    count(&sums[2], &block, -1);
    gather(sums, workers);
    assert_int_equal(picture.scenery_count, 2);
    CHECK(picture.scenery[0].object == 1 && picture.scenery[1].object == 6);
    CHECK_NEAR(picture.scenery[0].visible, 1, 1e-12);
    CHECK_NEAR(picture.scenery[1].visible, 0.25, 1e-12);
}

static void small_targets_cover_it(void **state)
{
    (void)state;
    PixelBlock  block;
    ScenerySums sums[workers] = {0};
    begin();
    picture.covered = covered;
    memset(covered, 0, sizeof covered);
    covered[3] = 0.25f, covered[4] = 1;
    row_of(&block, 1, 3, 0, 2);
    meet(0, hit_scenery, 1, 50, NAN), meet(1, hit_scenery, 2, 60, 300);
    count(&sums[0], &block, 1);
    gather(sums, 1);
    assert_int_equal(picture.scenery_count, 1);
    CHECK_NEAR(picture.scenery[0].visible, 0.75, 1e-6);
    CHECK(isnan(picture.scenery[0].hottest_k));
}

/* The table grows; who met what decides nothing. */
static void many_by_any_worker(void **state)
{
    (void)state;
    SceneryPixels *first = NULL;
    int            known = 0;
    for (int of = 1; of <= workers; of++) {
        ScenerySums sums[workers] = {0};
        PixelBlock  block;
        if (of == 1) begin();
        else picture = (Picture){.width = wide, .height = high};
        for (int k = 0; k < 20000; k++) {
            row_of(&block, 1, k % wide, k / wide % high, 1);
            meet(0, hit_scenery, 1 + (uint32_t)(k * 7919 % 5000), 10 + k, 280.f + (float)(k % 90));
            count(&sums[k % of], &block, 1);
        }
        gather(sums, of);
        assert_int_equal(picture.scenery_count, 4999); /* without the building */
        if (of == 1) first = picture.scenery, known = picture.scenery_count;
        else assert_memory_equal(picture.scenery, first, (size_t)known * sizeof *first);
        for (int k = 0; k < known; k++) CHECK_NEAR(picture.scenery[k].visible, 4, 1e-9);
    }
    ScenerySums none[workers] = {0};
    picture = (Picture){.width = wide, .height = high};
    gather(none, workers);
    CHECK(picture.scenery_count == 0 && !picture.scenery);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_boxes_and_temperatures),
        cmocka_unit_test(what_is_taken_back_is_gone),
        cmocka_unit_test(small_targets_cover_it),
        cmocka_unit_test(many_by_any_worker),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
