/* Pages of plants: with the list they are all the plants of the area, each once; numbers; the cache; hostile values.
 * labels: physics */
#include "tests/check.h"

#include "terrain/ground/landscape.h"
#include "terrain/woods/woods.h"

#include <dirent.h>
#include <stdlib.h>

static Landscape  landscape;
static LocalFrame frame;

static int open_ground(void **state)
{
    LandscapeConfig config = landscape_default_config();
    (void)state;
    config.seed = 7;
    if (local_frame_at(&frame, &(Geodetic){50.1 * rad_per_deg, 8.6 * rad_per_deg, 100}) != STATUS_OK) return 1;
    return landscape_create(&landscape, &config, &frame, NULL, 0, NULL, 0) != STATUS_OK;
}

static int close_ground(void **state)
{
    (void)state;
    landscape_destroy(&landscape);
    return 0;
}

static const WoodsPath track = {{-900, -500}, {800, 900}, 6, 6};
enum { few = 300 };

/* A list of few plants about a place, and pages of the square of 2 * 1500 m; or all plants of that square as a list. */
static WoodsConfig about(bool paged)
{
    return (WoodsConfig){.seed = 11,
                         .centre_m = {100, -50},
                         .half_width_m = paged ? 700 : 1500,
                         .most_trees = paged ? few : woods_most_trees,
                         .far_half_m = paged ? 1500 : 0,
                         .path_count = 1,
                         .path = &track};
}

typedef struct Placed {
    double p_enu[3];
    Plant  plant;
} Placed;

static int compare(const void *a, const void *b)
{
    const Placed *p = a, *q = b;
    if (p->plant.twist != q->plant.twist) return p->plant.twist < q->plant.twist ? -1 : 1;
    return (p->plant.height > q->plant.height) - (p->plant.height < q->plant.height);
}

static int add(Placed *out, int count, const Plant *plant, int plants, const double origin_enu[3])
{
    for (int k = 0; k < plants; k++) {
        for (int c = 0; c < 3; c++) out[count].p_enu[c] = origin_enu[c] + (double)plant[k].p_m[c];
        out[count++].plant = plant[k];
    }
    return count;
}

static int pages_of(const Woods *w) { return w->pages_x * w->pages_y; }

/* What the list has and what pages have are together what a list of all has, which other tests hold to the table and
 * the ground: by kind, size, turn and place, within the rounding of floats 3 km from an origin (0.12 mm a step). */
static void every_plant_once(void **state)
{
    const WoodsConfig all_of = about(false), some_of = about(true);
    Woods             all, some;
    (void)state;
    assert_int_equal(woods_create(&all, &landscape, &all_of, NULL), STATUS_OK);
    assert_int_equal(woods_create(&some, &landscape, &some_of, NULL), STATUS_OK);
    assert_true(some.count <= few && all.count > 10 * few && pages_of(&some) >= 9 && pages_of(&all) == 0);
    Placed *want = calloc((size_t)all.count, sizeof *want), *got = calloc((size_t)all.count, sizeof *got);
    assert_true(want && got);
    int count = add(got, 0, some.plant, some.count, some.origin_enu);
    for (int k = 0; k < pages_of(&some); k++) {
        WoodsPage page;
        double    low_m, high_m;
        assert_int_equal(woods_page(&page, &some, k), STATUS_OK);
        assert_true(count + page.count <= all.count);
        assert_true(woods_page_span(&low_m, &high_m, &some, k));
        for (int n = 0; n < page.count; n++) {
            const double z_m = page.origin_enu[2] + (double)page.plant[n].p_m[2];
            CHECK(z_m >= low_m && z_m + plant_height_m(&page.plant[n]) <= high_m);
            assert_int_equal(woods_page_at(&some, page.origin_enu[0] + (double)page.plant[n].p_m[0],
                                           page.origin_enu[1] + (double)page.plant[n].p_m[1]),
                             k);
        }
        count = add(got, count, page.plant, page.count, page.origin_enu);
        woods_page_free(&page);
    }
    assert_int_equal(count, all.count);
    add(want, 0, all.plant, all.count, all.origin_enu);
    qsort(want, (size_t)count, sizeof *want, compare), qsort(got, (size_t)count, sizeof *got, compare);
    for (int k = 0; k < count; k++) {
        const Plant *p = &want[k].plant, *q = &got[k].plant;
        assert_true(p->twist == q->twist && p->height == q->height);
        if (k > 0 && compare(&want[k - 1], &want[k]) == 0)
            continue; /* of two of one turn and height either may be first */
        if (k + 1 < count && compare(&want[k], &want[k + 1]) == 0) continue;
        assert_true(p->kind == q->kind && p->width == q->width && p->lean[0] == q->lean[0]);
        for (int c = 0; c < 3; c++) CHECK_NEAR(got[k].p_enu[c], want[k].p_enu[c], 3e-4);
    }
    free(want), free(got);
    woods_destroy(&all), woods_destroy(&some);
}

/* Numbers of pages follow those of the list and stay below those of low plants, for the largest square. */
static void numbers(void **state)
{
    Woods       w;
    WoodsConfig config = about(true);
    (void)state;
    config.far_half_m = 50000;
    assert_int_equal(woods_create(&w, &landscape, &config, NULL), STATUS_OK);
    const int last = pages_of(&w) - 1;
    CHECK(w.pages_x >= 97 && w.pages_x <= woods_most_pages_side && w.pages_y <= woods_most_pages_side);
    CHECK(woods_page_number(0) >= (uint32_t)woods_most_trees);
    CHECK(woods_page_of(woods_most_trees - 1) < 0);
    CHECK((uint64_t)woods_page_number(last) + woods_page_most <= (uint64_t)1 << 31);
    for (int k = 0; k <= last; k += 97)
        CHECK(woods_page_of(woods_page_number(k)) == k &&
              woods_page_of(woods_page_number(k) + woods_page_most - 1) == k);
    assert_int_equal(woods_page_at(&w, 1e9, 0), -1);
    assert_int_equal(woods_page_at(&w, NAN, 0), -1);
    woods_destroy(&w);
}

static void bad_values(void **state)
{
    static const double bad[] = {-1, 50001, NAN, INFINITY};
    Woods               w;
    (void)state;
    log_set_level((LogLevel)(LOG_ERROR + 1));
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        WoodsConfig config = about(true);
        config.far_half_m = bad[k];
        assert_int_equal(woods_create(&w, &landscape, &config, NULL), STATUS_BAD_VALUE);
    }
    log_set_level(LOG_WARN);
    WoodsConfig none = about(true);
    none.most_trees = 0; /* nothing is to stand */
    assert_int_equal(woods_create(&w, &landscape, &none, NULL), STATUS_OK);
    assert_int_equal(pages_of(&w), 0);
    woods_destroy(&w);
}

/* Flips a bit in the middle of every entry, of which there must be some. */
static void spoil(const char *folder)
{
    DIR           *dir = opendir(folder);
    struct dirent *entry;
    int            spoilt = 0;
    assert_non_null(dir);
    while ((entry = readdir(dir))) {
        char path[600];
        if (!strstr(entry->d_name, ".kept")) continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        FILE *file = fopen(path, "r+b");
        assert_non_null(file);
        fseek(file, 0, SEEK_END);
        const long at = ftell(file) / 2;
        fseek(file, at, SEEK_SET);
        const int octet = fgetc(file);
        fseek(file, at, SEEK_SET);
        fputc(octet ^ 4, file);
        fclose(file);
        spoilt++;
    }
    closedir(dir);
    assert_true(spoilt > 0);
}

static void remove_folder(const char *folder)
{
    DIR           *dir = opendir(folder);
    struct dirent *entry;
    while (dir && (entry = readdir(dir))) {
        char path[600];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        remove(path);
    }
    if (dir) closedir(dir);
    remove(folder);
}

/* A page placed, kept, taken from the cache, and placed again where its entry is spoilt: the same octets. */
static void kept(void **state)
{
    char        folder[64];
    Woods       w;
    WoodsPage   page[4];
    WoodsConfig config = about(true);
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/test_woods_page_%ld", (long)getpid());
    log_set_level((LogLevel)(LOG_ERROR + 1));
    Cache *cache = cache_open(folder, (size_t)1 << 30);
    assert_non_null(cache);
    for (int k = 0; k < 4; k++) { /* without a cache; first; from it; spoilt */
        config.cache = k > 0 ? cache : NULL, config.follows = k > 0 ? "a test" : NULL;
        assert_int_equal(woods_create(&w, &landscape, &config, NULL), STATUS_OK);
        const int middle = pages_of(&w) / 2;
        if (k == 3) spoil(folder);
        assert_int_equal(woods_page(&page[k], &w, middle), STATUS_OK);
        assert_true(page[k].count > 100);
        assert_int_equal(page[k].count, page[0].count);
        assert_memory_equal(page[k].plant, page[0].plant, (size_t)page[0].count * sizeof(Plant));
        const CacheCounters c = cache_counters(cache);
        if (k == 2) CHECK(c.fetched == 2 && c.damaged == 0); /* the list, and the page */
        if (k == 3) CHECK(c.damaged == 1);
        woods_destroy(&w);
    }
    config.seed++; /* other plants: another entry */
    assert_int_equal(woods_create(&w, &landscape, &config, NULL), STATUS_OK);
    WoodsPage other;
    assert_int_equal(woods_page(&other, &w, pages_of(&w) / 2), STATUS_OK);
    CHECK(other.count != page[0].count || memcmp(other.plant, page[0].plant, (size_t)other.count * sizeof(Plant)) != 0);
    woods_page_free(&other);
    woods_destroy(&w);
    for (int k = 0; k < 4; k++) woods_page_free(&page[k]);
    cache_close(cache);
    log_set_level(LOG_WARN);
    remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_plant_once),
        cmocka_unit_test(numbers),
        cmocka_unit_test(bad_values),
        cmocka_unit_test(kept),
    };
    return cmocka_run_group_tests(tests, open_ground, close_ground);
}
