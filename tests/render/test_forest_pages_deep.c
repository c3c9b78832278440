/* The memory of 30 million plants in pages, all of them at once; given back afterwards. labels: deep */
#include "tests/check.h"
#include "tests/render/hand_plants.h"

#include "terrain/ground/landscape.h"

#include <stdlib.h>
#include <string.h>

static Landscape landscape;

static double resident_mb(void)
{
    char   line[256];
    double kb = NAN;
    FILE  *file = fopen("/proc/self/status", "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, "VmRSS:", 6) == 0) kb = atof(line + 6);
    if (file) fclose(file);
    return kb / 1024;
}

typedef struct Making {
    const Forest *forest;
    int64_t       plants;
} Making;

static void make_page(void *user, int worker, int page)
{
    Making          *m = user;
    const WoodsPage *of;
    (void)worker;
    if (forest_page_plants(&of, m->forest, page) == STATUS_OK)
        __atomic_fetch_add(&m->plants, of->count, __ATOMIC_RELAXED);
}

/* Every page of a square of 98 km in use by one frame: what rays all about an eye that is high enough would need. */
static void all_at_once(void **state)
{
    const double      eye_enu[3] = {0, 0, 3000}, calm[2] = {0, 0};
    const WoodsConfig config = {.seed = 5, .half_width_m = 3000, .most_trees = 300000, .far_half_m = 50000};
    Woods             woods;
    Forest           *forest;
    ForestFrame       frame;
    Pool             *pool;
    Making            m = {0};
    (void)state;
    assert_int_equal(pool_create(&pool, 2), STATUS_OK);
    assert_int_equal(woods_create(&woods, &landscape, &config, pool), STATUS_OK);
    const ForestConfig about = {.leaves = true, .far_m = 50000, .far_mb = 100};
    assert_int_equal(forest_create(&forest, &woods, &hand_plants, &about, "avx2"), STATUS_OK);
    assert_int_equal(forest_frame_open(&frame, forest, eye_enu, 1000, 0, 0, calm, pool, NULL), STATUS_OK);
    m.forest = forest;
    pool_run(pool, woods.pages_x * woods.pages_y, make_page, &m);
    const double         all_mb = resident_mb();
    const ForestPagesUse use = forest_pages_use(forest);
    printf("%.2f M plants in %.0f pages: %.0f MB, %.1f octets a plant; resident %.0f MB\n", 1e-6 * (double)m.plants,
           (double)use.made, 1e-6 * (double)use.octets, (double)use.octets / (double)m.plants, all_mb);
    /* 20 octets of Plant, a quarter of what Embree takes for a box of its own (some 100), and 1 kB a page; 30 M of them
     * with 60 MB of prototypes and program are within 2 GB */
    CHECK(m.plants > 20000000);
    CHECK((double)use.octets < 60.0 * (double)m.plants);
    CHECK(all_mb * 30e6 / (double)m.plants < 2e9 / (1024 * 1024));
    forest_frame_close(&frame); /* down to far_mb */
    CHECK(forest_pages_use(forest).octets < 100000000);
    forest_destroy(forest);
    woods_destroy(&woods);
    pool_destroy(pool);
}

int main(void)
{
    LandscapeConfig config = landscape_default_config();
    LocalFrame      frame;
    config.seed = 7;
    hand_grow(false, 0.06);
    if (local_frame_at(&frame, &(Geodetic){50.1 * rad_per_deg, 8.6 * rad_per_deg, 100}) != STATUS_OK) return 1;
    if (landscape_create(&landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK) return 1;
    const struct CMUnitTest tests[] = {cmocka_unit_test(all_at_once)};
    const int               failed = cmocka_run_group_tests(tests, NULL, NULL);
    landscape_destroy(&landscape);
    return failed;
}
