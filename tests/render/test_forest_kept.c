/* What rays find of prototypes, between runs: the same values from the cache, half of them from there, and found anew;
 * what is wrong is refused. */
#include "render/trace/plants/forest_private.h"
#include "tests/check.h"
#include "tests/render/hand_plants.h"

enum { way_texels = table_side * table_side, row = 3, first_way = row * table_azimuths };

static const double origin[3] = {0, 0, 0};
static char         folder[temp_path_size];
static Cache       *cache;
static Woods        woods;

static int open_folder(void **state)
{
    static Plant plant[1];
    (void)state;
    hand_grow(false, 0.06);
    woods = hand_stand(plant, 1, origin, 1);
    return temp_folder(folder) && (cache = cache_open(folder, 64 << 20)) ? 0 : -1;
}

static int close_folder(void **state)
{
    char command[temp_path_size + 16];
    (void)state;
    cache_close(cache);
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command);
}

/* Of the finest prototypes, whose light is not known; it keeps nothing without a name. */
static Forest *open_forest(const char *name)
{
    const ForestConfig config = {.leaves = true, .fine = true, .tables = true};
    Forest            *forest;
    for (int kind = 0; kind < PLANT_STANDING; kind++)
        for (int q = 0; q < hand_plants.shape[kind][plant_fine].quads; q++) {
            PlantQuad *quad = &hand_plants.shape[kind][plant_fine].quad[q];
            quad->open_up = quad->open_down = -1;
        }
    assert_int_equal(forest_create(&forest, &woods, &hand_plants, &config, "avx2"), STATUS_OK);
    forest_keep(forest, &(PlantsKept){*name ? cache : NULL, name});
    return forest;
}

static void trace_way(Forest *forest, PlantKind kind, int way)
{
    for (int place = 0; place < way_texels; place++) plant_table_trace(forest->table[kind], way, 0, place);
}

/* Texels that a table has of a way, without asking for any. */
static int known(const Forest *forest, PlantKind kind, int way)
{
    const uint32_t *texel = plant_table_texels(forest->table[kind], way, 0);
    int             count = 0;
    for (int place = 0; place < way_texels; place++) count += texel[place] != table_unset;
    return count;
}

static bool same_way(const Forest *a, const Forest *b, PlantKind kind, int way)
{
    return memcmp(plant_table_texels(a->table[kind], way, 0), plant_table_texels(b->table[kind], way, 0),
                  way_texels * sizeof(uint32_t)) == 0;
}

static uint64_t made(void) { return cache_counters(cache).made; }
static uint64_t fetched(void) { return cache_counters(cache).fetched; }

/* ---- octets --------------------------------------------------------------------------------------- */

/* The octets of one way with a hit and a place of nothing, worked out by hand from what forest_private.h says of them:
 * lines; of line 1 the texels that are known, 3 and 64; those that are hits, 3; its texel. */
static void octets_of_texels(void **state)
{
    enum { quads = 5, octets = 3 * 24 + 4 };
    static uint32_t from[way_texels], to[way_texels];
    const uint32_t  hit = (uint32_t)-7 << table_quad_bits | (2 + 4);
    const uint64_t  word[9] = {2, 0, 0, 8, 1, 0, 8, 0, 0};
    size_t          count = 0;
    (void)state;
    from[table_side + 3] = hit, from[table_side + 64] = table_nothing;
    char *got = kept_write(&count, kept_texels_values, &(KeptTexels){from, 1, quads, 0});
    CHECK(got && count == octets);
    CHECK(memcmp(got, word, sizeof word) == 0 && memcmp(got + sizeof word, &hit, sizeof hit) == 0);
    CHECK(kept_read(kept_texels_values, &(KeptTexels){to, 1, quads, 0}, got, count));
    CHECK(memcmp(from, to, sizeof from) == 0);
    free(got);
}

static bool reads(const uint64_t word[9], uint32_t hit, size_t count)
{
    static uint32_t to[way_texels];
    char            octets[9 * 8 + 8] = {0};
    memset(to, 0, sizeof to);
    memcpy(octets, word, 9 * sizeof *word), memcpy(octets + 72, &hit, sizeof hit);
    return kept_read(kept_texels_values, &(KeptTexels){to, 1, 5, 0}, octets, count);
}

static void wrong_texels(void **state)
{
    enum { whole = 76 };
    const uint64_t word[9] = {2, 0, 0, 8, 1, 0, 8, 0, 0};
    const uint32_t depth = (uint32_t)table_depth_steps << table_quad_bits, first = 2, last = 6;
    (void)state;
    CHECK(reads(word, depth | first, whole) &&
          reads(word, (uint32_t)-table_depth_steps << table_quad_bits | last, whole));
    for (size_t count = 0; count < whole; count++) CHECK(!reads(word, depth | first, count));
    CHECK(!reads(word, depth | first, whole + 1));
    CHECK(!reads(word, depth | (last + 1), whole) && !reads(word, depth | table_quad_mask, whole)); /* no such quad */
    CHECK(!reads(word, depth | 1, whole) && !reads(word, 0, whole));                                /* no hit */
    CHECK(!reads(word, ((uint32_t)table_depth_steps + 1) << table_quad_bits | first, whole)); /* outside the sphere */
    CHECK(!reads(word, (uint32_t)(-table_depth_steps - 1) << table_quad_bits | first, whole));
    CHECK(!reads((const uint64_t[9]){2, 0, 0, 1, 0, 0, 8, 0, 0}, depth | first, whole)); /* a hit that is not known */
    CHECK(!reads((const uint64_t[9]){2, 0, 0, 1, 0, 0, 0, 8, 0}, depth | first, whole));
    CHECK(!reads((const uint64_t[9]){2, 0, 0, 1, 0, 0, 0, 0, 8}, depth | first, whole));
    CHECK(!reads((const uint64_t[9]){2}, 0, 72)); /* a line of nothing known */
    CHECK(reads((const uint64_t[9]){0}, 0, 24));
}

static void wrong_light(void **state)
{
    float share[3][2] = {{0, 1}, {-1, -1}, {0.5f, 0}}, to[3][2];
    (void)state;
    CHECK(kept_read(kept_light_values, &(KeptLight){to, 3}, share, sizeof share) &&
          memcmp(share, to, sizeof share) == 0);
    CHECK(!kept_read(kept_light_values, &(KeptLight){to, 3}, share, sizeof share - 4));
    CHECK(!kept_read(kept_light_values, &(KeptLight){to, 2}, share, sizeof share));
    static const float wrong[] = {1.001f, -0.001f, NAN, INFINITY, -1};
    for (int k = 0; k < 5; k++) {
        share[2][k % 2] = wrong[k];
        CHECK(!kept_read(kept_light_values, &(KeptLight){to, 3}, share, sizeof share));
        share[2][0] = 0.5f, share[2][1] = 0;
    }
}

/* ---- between runs --------------------------------------------------------------------------------- */

/* An entry of a part, written when the forest goes; fetched when one of its values is first asked for; the values are
 * those that a forest without a cache finds. */
static void a_second_run(void **state)
{
    const uint64_t before = made(), from = fetched();
    (void)state;
    Forest *none = open_forest(""), *one = open_forest("second");
    trace_way(none, PLANT_ALDER, first_way + 5), trace_way(one, PLANT_ALDER, first_way + 5);
    forest_destroy(one);
    CHECK(made() == before + 1 && fetched() == from);

    Forest *two = open_forest("second"), *other = open_forest("another");
    CHECK(fetched() == from && known(two, PLANT_ALDER, first_way + 5) == 0);
    plant_table_trace(two->table[PLANT_ALDER], first_way + 6, 2, 11); /* another way of the row, a coarse texel */
    CHECK(fetched() == from + 1 && known(two, PLANT_ALDER, first_way + 5) == way_texels);
    CHECK(known(two, PLANT_ALDER, first_way + 6) == 1);
    CHECK(same_way(two, none, PLANT_ALDER, first_way + 5));
    plant_table_trace(two->table[PLANT_ALDER], first_way + 5 + table_azimuths, 0, 0); /* no other row, */
    plant_table_trace(two->table[PLANT_BIRCH], first_way + 5, 0, 0);                  /* nor another kind, */
    plant_table_trace(other->table[PLANT_ALDER], first_way + 5, 0, 0);                /* nor other prototypes */
    CHECK(fetched() == from + 1 && known(other, PLANT_ALDER, first_way + 5) == 1);
    CHECK(known(two, PLANT_BIRCH, first_way + 5) == 1);
    forest_destroy(other);
    forest_destroy(two); /* a few new texels are not worth an entry */
    CHECK(made() == before + 1);
    forest_destroy(none);
}

/* Coarse texels follow from those that are kept: the same as without a cache. */
static void coarse_texels(void **state)
{
    (void)state;
    Forest *one = open_forest("coarse");
    trace_way(one, PLANT_PINE, first_way);
    forest_destroy(one);
    Forest *none = open_forest(""), *two = open_forest("coarse");
    for (int level = table_levels - 1; level >= 0; level--)
        for (int place = 0; place < way_texels >> 2 * level; place++)
            CHECK(plant_table_trace(none->table[PLANT_PINE], first_way, level, place) ==
                  plant_table_trace(two->table[PLANT_PINE], first_way, level, place));
    forest_destroy(two), forest_destroy(none);
}

/* Two programs that find different values at the same time lose none, in whatever order they end. */
static void two_at_once(void **state)
{
    (void)state;
    Forest *none = open_forest(""), *a = open_forest("at once"), *b = open_forest("at once");
    trace_way(none, PLANT_PINE, first_way), trace_way(none, PLANT_PINE, first_way + 1);
    trace_way(a, PLANT_PINE, first_way), trace_way(b, PLANT_PINE, first_way + 1);
    forest_destroy(b), forest_destroy(a);
    Forest *c = open_forest("at once");
    plant_table_trace(c->table[PLANT_PINE], first_way + 7, 0, 0);
    CHECK(same_way(c, none, PLANT_PINE, first_way) && same_way(c, none, PLANT_PINE, first_way + 1));
    forest_destroy(c), forest_destroy(none);
}

/* Written when enough is new: a thirty-second part, and at least 1024 texels; after a frame when it has doubled. */
static void written_when_new(void **state)
{
    const uint64_t before = made();
    (void)state;
    for (int few = 1; few >= 0; few--) {
        Forest *f = open_forest("new");
        for (int place = 0; place < 1024 - few; place++) plant_table_trace(f->table[PLANT_PINE], first_way, 0, place);
        forest_destroy(f);
        CHECK(made() == before + (few ? 0 : 1));
    }
    Forest *f = open_forest("new");
    trace_way(f, PLANT_PINE, first_way);
    forest_kept_after_frame(f); /* 36864 - 1024, of 65536 */
    CHECK(made() == before + 1);
    trace_way(f, PLANT_PINE, first_way + 1);
    forest_kept_after_frame(f);
    CHECK(made() == before + 2);
    forest_kept_after_frame(f), forest_keep_found(f);
    CHECK(made() == before + 2);
    for (int place = 0; place < 2200; place++) plant_table_trace(f->table[PLANT_PINE], first_way + 5, 0, place);
    forest_keep_found(f); /* 2200 of 75928 are less than a thirty-second part */
    CHECK(made() == before + 2);
    for (int place = 2200; place < 2500; place++) plant_table_trace(f->table[PLANT_PINE], first_way + 5, 0, place);
    forest_keep_found(f);
    CHECK(made() == before + 3);
    forest_destroy(f);
    CHECK(made() == before + 3);
}

/* The light of all quads of a kind. */
static void light_up(float share[hand_quads][2], const Forest *forest, PlantKind kind)
{
    for (int q = 0; q < hand_quads; q++) plant_openness(share[q], &forest->shape[kind][plant_fine], (uint32_t)q);
}

static void light_of_quads(void **state)
{
    static float     share[2][hand_quads][2];
    const uint64_t   before = made(), from = fetched();
    const PlantQuad *quad = hand_plants.shape[PLANT_PINE][plant_fine].quad;
    (void)state;
    Forest *none = open_forest("");
    light_up(share[0], none, PLANT_PINE);
    forest_destroy(none);
    Forest *one = open_forest("light");
    light_up(share[1], one, PLANT_PINE);
    CHECK(memcmp(share[0], share[1], sizeof share[0]) == 0);
    forest_destroy(one);
    CHECK(made() == before + 1);
    Forest *two = open_forest("light");
    CHECK(quad[0].open_up == -1);
    plant_openness(share[1][0], &two->shape[PLANT_PINE][plant_fine], 0);
    CHECK(fetched() == from + 1);
    for (int q = 0; q < hand_quads; q++) /* without asking */
        CHECK(quad[q].open_up == share[0][q][0] && quad[q].open_down == share[0][q][1]);
    forest_destroy(two);
    CHECK(made() == before + 1);
}

/* ---- files --------------------------------------------------------------------------------------- */

/* Changes the last octets of the one entry that was written last, and its sum with them. Its layout: pitviper_cache.h.
 */
static void spoil(const char *path)
{
    static char octets[1 << 20];
    enum { sum = 64 };
    char  digits[sha256_text_size];
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    const size_t count = fread(octets, 1, sizeof octets, file);
    fclose(file);
    CHECK(count > 1000 && count < sizeof octets);
    const uint32_t hit = 2 + hand_quads; /* the quad behind the last one */
    memcpy(octets + count - sum - sizeof hit, &hit, sizeof hit);
    assert_int_equal(sha256_bytes(digits, octets, count - sum), STATUS_OK);
    memcpy(octets + count - sum, digits, sum);
    file = fopen(path, "wb");
    assert_non_null(file);
    CHECK(fwrite(octets, 1, count, file) == count && fclose(file) == 0);
}

/* An entry that is well-formed but for one texel, of a quad that is not there, gives no texel, and is replaced. */
static void wrong_entry(void **state)
{
    char   own[temp_path_size], command[2 * temp_path_size], path[temp_path_size];
    Cache *shared = cache;
    (void)state;
    CHECK(temp_folder(own) && (cache = cache_open(own, 64 << 20)));
    Forest *none = open_forest(""), *one = open_forest("wrong");
    trace_way(none, PLANT_PINE, first_way + 9), trace_way(one, PLANT_PINE, first_way + 9);
    forest_destroy(one);
    snprintf(command, sizeof command, "ls %s/*.kept", own);
    FILE *list = popen(command, "r");
    CHECK(list && fgets(path, sizeof path, list) && pclose(list) == 0);
    path[strcspn(path, "\n")] = 0;
    spoil(path);
    Forest *two = open_forest("wrong");
    plant_table_trace(two->table[PLANT_PINE], first_way + 9, 0, 0);
    CHECK(known(two, PLANT_PINE, first_way + 9) == 1);
    trace_way(two, PLANT_PINE, first_way + 9);
    CHECK(same_way(two, none, PLANT_PINE, first_way + 9));
    forest_destroy(two);
    Forest *three = open_forest("wrong");
    plant_table_trace(three->table[PLANT_PINE], first_way, 0, 0);
    CHECK(same_way(three, none, PLANT_PINE, first_way + 9));
    forest_destroy(three), forest_destroy(none);
    cache_close(cache);
    cache = shared;
    snprintf(command, sizeof command, "rm -r %s", own);
    CHECK(system(command) == 0);
}

/* ---- threads ------------------------------------------------------------------------------------- */

static void trace_some(void *user, int worker, int task)
{
    Forest *forest = user;
    (void)worker;
    for (int place = task * 64; place < (task + 1) * 64; place++)
        for (int k = 0; k < 4; k++)
            plant_table_trace(forest->table[PLANT_PINE], (row + k) * table_azimuths, k % 2, place / (k % 2 ? 4 : 1));
}

/* Threads that ask while an entry is taken, half of whose values are there, and one of whose is not. */
static void by_threads(void **state)
{
    Pool *pool;
    (void)state;
    assert_int_equal(pool_create(&pool, 3), STATUS_OK);
    Forest *none = open_forest(""), *half = open_forest("threads");
    for (int place = 0; place < way_texels; place += 2)
        for (int k = 0; k < 2; k++) plant_table_trace(half->table[PLANT_PINE], (row + k) * table_azimuths, 0, place);
    forest_destroy(half);
    Forest *all = open_forest("threads");
    pool_run(pool, way_texels / 64, trace_some, all);
    for (int task = 0; task < way_texels / 64; task++) trace_some(none, 0, task);
    for (int k = 0; k < 4; k++) CHECK(known(all, PLANT_PINE, (row + k) * table_azimuths) >= way_texels / 4);
    for (int k = 0; k < 4; k += 2) CHECK(same_way(all, none, PLANT_PINE, (row + k) * table_azimuths));
    forest_destroy(all), forest_destroy(none);
    pool_destroy(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(octets_of_texels), cmocka_unit_test(wrong_texels),   cmocka_unit_test(wrong_light),
        cmocka_unit_test(a_second_run),     cmocka_unit_test(coarse_texels),  cmocka_unit_test(two_at_once),
        cmocka_unit_test(written_when_new), cmocka_unit_test(light_of_quads), cmocka_unit_test(wrong_entry),
        cmocka_unit_test(by_threads),
    };
    return cmocka_run_group_tests(tests, open_folder, close_folder);
}
