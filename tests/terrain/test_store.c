/* tests/terrain/test_store.c: a terrain store written and read: heights within half a step, seams without a crack, the
 * same octets for any number of threads and rows at a time; nothing touched by opening; damaged and stale files refused
 * with the next step. labels: threads */
#include "tests/terrain/store_lab.h"

#include "terrain/ground/ground_image.h"

#include <fcntl.h>
#include <sys/stat.h>

static char folder[temp_path_size], lab[temp_name_size]; /* the lab's store, shared */

static void name_file(char out[temp_name_size], const char *name)
{
    snprintf(out, temp_name_size, "%s/%s", folder, name);
}

static size_t read_whole(uint8_t **out, const char *path)
{
    struct stat about;
    FILE       *from = fopen(path, "rb");
    CHECK(from && fstat(fileno(from), &about) == 0);
    *out = malloc((size_t)about.st_size);
    CHECK(*out && fread(*out, 1, (size_t)about.st_size, from) == (size_t)about.st_size && fclose(from) == 0);
    return (size_t)about.st_size;
}

static void write_whole(const char *path, const uint8_t *octets, size_t count)
{
    FILE *to = fopen(path, "wb");
    CHECK(to && fwrite(octets, 1, count, to) == count && fclose(to) == 0);
}

static void heights_are_within_half_a_step(void **state)
{
    (void)state;
    TerrainStore    store;
    const StorePlan plan = lab_plan();
    assert_int_equal(store_open(&store, lab), STATUS_OK);
    CHECK(store.elevation.level_count == 2 && store.frame.origin.h_m == 120 && store.geoid_m == -22.5);
    for (int n = 0; n < 2; n++) {
        const ElevationLevel *level = &store.elevation.level[n];
        double                worst_m = 0;
        CHECK(level->nx == plan.level[n].nx && level->ny == plan.level[n].ny);
        CHECK(level->step_m == 0x1p-11 && !level->plain);
        for (int j = 1; j < level->ny - 1; j++)
            for (int i = 1; i < level->nx - 1; i++) {
                const double x_m = level->x0_m + i * level->spacing_m, y_m = level->y0_m + j * level->spacing_m;
                const bool   on_hole = n == 1 && (fabs(x_m) == 384 || fabs(y_m) == 320);
                const double off_m = fabs(elevation_post_m(level, i, j) - (double)lab_height_m(x_m, y_m));
                if (!on_hole) worst_m = fmax(worst_m, off_m);
            }
        CHECK(worst_m <= store.worst_m[n] && store.worst_m[n] <= 0x1p-8 && worst_m > 0);
    }
    store_close(&store);
}

/* Along the outline of level 0 both levels have the same surface to the last bit. */
static void the_seam_has_no_crack(void **state)
{
    (void)state;
    TerrainStore store;
    assert_int_equal(store_open(&store, lab), STATUS_OK);
    const ElevationLevel *in = &store.elevation.level[0], *out = &store.elevation.level[1];
    for (int k = 0; k < 2 * (lab_nx + lab_ny); k++) {
        const int    side = k % 4, m = k / 4 * 2 % (side < 2 ? lab_nx : lab_ny);
        const int    i = side < 2 ? m : side == 2 ? 0 : lab_nx - 1, j = side < 2 ? (side == 0 ? 0 : lab_ny - 1) : m;
        const int    a = (int)((in->x0_m + i - out->x0_m) / 8), b = (int)((in->y0_m + j - out->y0_m) / 8);
        const int    part = side < 2 ? i % 8 : j % 8;
        const double za = elevation_post_m(out, a, b);
        const double zb = part ? elevation_post_m(out, a + (side < 2), b + (side >= 2)) : za;
        CHECK(elevation_post_m(in, i, j) == za + (zb - za) * part / 8);
    }
    store_close(&store);
}

static void rasters_come_back(void **state)
{
    (void)state;
    TerrainStore    store;
    const StorePlan plan = lab_plan();
    assert_int_equal(store_open(&store, lab), STATUS_OK);
    for (int w = 0; w < cover_windows; w++) {
        const CoverGrid *g = &store.surface[w];
        CHECK(g->nx == plan.surface[w].nx && g->ny == plan.surface[w].ny);
        for (int j = 0; j < g->ny; j += 7)
            for (int i = 0; i < g->nx; i += 5)
                CHECK(g->surface[(size_t)j * (size_t)g->nx + (size_t)i] ==
                      lab_surface(g->x0_m + (i + 0.5) * g->cell_m, g->y0_m + (j + 0.5) * g->cell_m));
    }
    CHECK(store.canopy_height[192 * 7 + 3] == 10 && store.canopy_cover[192 * 100 + 20] == 20);
    CHECK(store.crown_count == 3 && store.building_count == 5 && store.crown[2].height_m == 21);
    CHECK(strcmp(store.options, plan.options) == 0 && strcmp(store.crs, plan.crs) == 0 && store_verify(&store, NULL));
    /* the photograph: the same blocks and mips as one made in memory */
    uint8_t *rgba = malloc((size_t)4 * lab_photo_nx * lab_photo_ny);
    CHECK(rgba);
    for (int j = 0; j < lab_photo_ny; j++) lab_albedo_row(rgba + (size_t)j * 4 * lab_photo_nx, j);
    for (int k = 0; k < store.photo.mips; k++) {
        const int  nx = store.photo.nx[k], ny = store.photo.ny[k];
        PhotoBlock row[lab_photo_nx];
        for (int j = 0; j < ny; j += 4) {
            photo_block_row(row, rgba + (size_t)j * 4 * (size_t)nx, nx, ny - j < 4 ? ny - j : 4);
            assert_memory_equal(store.photo.block[k] + (size_t)(j / 4) * photo_blocks_across(nx), row,
                                photo_blocks_across(nx) * sizeof *row);
        }
        for (int j = 0; j < ny; j += 2)
            photo_halve_row(rgba + (size_t)(j / 2) * 4 * (((size_t)nx + 1) / 2), rgba + (size_t)j * 4 * (size_t)nx,
                            j + 1 < ny ? rgba + ((size_t)j + 1) * 4 * (size_t)nx : NULL, nx);
    }
    free(rgba);
    store_close(&store);
}

static void any_threads_and_rows_give_the_same_octets(void **state)
{
    (void)state;
    char            other[temp_name_size];
    TerrainStore    a, b;
    Pool           *pool;
    const StorePlan plan = lab_plan();
    name_file(other, "other.store");
    assert_int_equal(pool_create(&pool, 3), STATUS_OK);
    lab_write(other, &plan, pool, 641);
    assert_int_equal(store_open(&a, lab), STATUS_OK);
    assert_int_equal(store_open(&b, other), STATUS_OK);
    CHECK(a.octets == b.octets && a.content == b.content);
    const size_t from = ((const StoreHeader *)a.header)->header_octets;
    assert_memory_equal(a.map + from, b.map + from, a.octets - from);
    CHECK(store_verify(&b, pool));
    store_close(&a);
    store_close(&b);
    pool_destroy(pool);
    unlink(other);
}

/* Octets of a mapped file that are in this process's memory: /proc/self/smaps. -1: it is not mapped. */
static long resident_kb(const char *path)
{
    char  line[4096];
    bool  here = false;
    long  kb = -1, one;
    FILE *maps = fopen("/proc/self/smaps", "r");
    CHECK(maps);
    while (fgets(line, sizeof line, maps)) {
        if (strchr(line, '-') && strchr(line, ':') && strstr(line, " r")) here = strstr(line, path) != NULL;
        if (here && sscanf(line, "Rss: %ld kB", &one) == 1) kb = (kb < 0 ? 0 : kb) + one;
    }
    fclose(maps);
    return kb;
}

static void opening_touches_no_page_of_data(void **state)
{
    (void)state;
    Landscape    landscape;
    TerrainStore store;
    assert_int_equal(store_open(&store, lab), STATUS_OK);
    CHECK(resident_kb(lab) == 0);
    store_close(&store);
    CHECK(resident_kb(lab) == -1);
    assert_int_equal(store_open_landscape(&landscape, lab, 1), STATUS_OK);
    CHECK(resident_kb(lab) == 0);
    CHECK_NEAR(elevation_height(&landscape.elevation, 10, 20, NULL), (double)lab_height_m(10, 20), 0x1p-9);
    CHECK(resident_kb(lab) > 0 && landscape_has_photo(&landscape));
    CHECK(landscape_surface(&landscape, 20.5, 20.5) == lab_surface(20.5, 20.5));
    float f[albedo_channels];
    landscape_albedo(f, &landscape, SURFACE_GRASS, 10, 20, 2);
    CHECK(f[albedo_red] > 0 && f[albedo_red] != 1);
    landscape_destroy(&landscape);
    CHECK(resident_kb(lab) == -1);
}

/* ---- what is refused ------------------------------------------------------------------------------- */

static void refused(const char *path, Status want, const char *reason)
{
    TerrainStore store;
    assert_int_equal(store_open(&store, path), want);
    if (!strstr(check_said, reason) || !strstr(check_said, "pitviper terrain import")) fail_msg("said: %s", check_said);
    CHECK(!store.map && !store.header);
}

static void damaged_files_are_refused_with_the_next_step(void **state)
{
    (void)state;
    char     bad[temp_name_size];
    uint8_t *octets;
    name_file(bad, "bad.store");
    const size_t count = read_whole(&octets, lab);
    StoreHeader *h = (StoreHeader *)(void *)octets;
    log_set_sink(check_listen, NULL);
    refused(bad, STATUS_IO, "No such file");
    refused(folder, STATUS_IO, "a directory, not a regular file");
    write_whole(bad, octets, count - 4096);
    refused(bad, STATUS_BAD_VALUE, "cut");
    write_whole(bad, octets, 100);
    refused(bad, STATUS_BAD_VALUE, "shorter");
    for (size_t at = 0; at < h->header_octets; at += at < sizeof *h ? 1 : 41) { /* any octet of the header */
        octets[at] ^= 1;
        const char *why;
        CHECK(store_header_check(&why, h, h->header_octets <= count ? 4096 : 0, count) != STATUS_OK && why);
        octets[at] ^= 1;
    }
    h->version++;
    write_whole(bad, octets, count);
    refused(bad, STATUS_UNSUPPORTED, "another version");
    h->version--;
    octets[0] = 'Q';
    write_whole(bad, octets, count);
    refused(bad, STATUS_BAD_VALUE, "not a terrain store");
    CHECK(store_recall(bad) == NULL);
    octets[0] = 'P';
    log_set_sink(NULL, NULL);
    unlink(bad);
    free(octets);
}

/* Cut, of a damaged header, of another version: the options are there until they are damaged themselves. */
static void options_are_recalled_from_what_is_left(void **state)
{
    (void)state;
    char     bad[temp_name_size];
    uint8_t *octets;
    name_file(bad, "bad.store");
    const size_t count = read_whole(&octets, lab);
    StoreHeader *h = (StoreHeader *)(void *)octets;
    const size_t at = (size_t)(store_text(h, STORE_OPTIONS) - (const char *)octets);
    const size_t end = at + strlen((const char *)octets + at);
    TerrainStore store;
    assert_int_equal(store_open(&store, lab), STATUS_OK);
    CHECK(strlen(store.options) > 0);
    memset(octets + sizeof store_magic, 0x5a, sizeof *h - sizeof store_magic);
    for (size_t n = end - 3; n <= end + 1; n++) {
        write_whole(bad, octets, n);
        char *options = store_recall(bad);
        CHECK(n < end ? options == NULL : options && strcmp(options, store.options) == 0);
        free(options);
    }
    for (size_t n = at; n < end; n++) {
        octets[n] ^= 1;
        write_whole(bad, octets, n < at + 40 || n + 1 == end ? end : at);
        char *options = store_recall(bad);
        CHECK(options == NULL);
        free(options);
        octets[n] ^= 1;
    }
    write_whole(bad, octets, count);
    char *whole = store_recall(bad);
    CHECK(whole && strcmp(whole, store.options) == 0);
    free(whole);
    store_close(&store);
    unlink(bad);
    free(octets);
}

/* Well-formed checksums about values that are out of range. */
static void hostile_headers_are_refused(void **state)
{
    (void)state;
    uint8_t     *octets;
    const size_t count = read_whole(&octets, lab);
    StoreHeader *h = (StoreHeader *)(void *)octets;
    const char  *why;
    assert_int_equal(store_header_check(&why, h, h->header_octets, count), STATUS_OK);
#define HOSTILE(change)                                                                                                \
    do {                                                                                                               \
        const StoreHeader was = *h;                                                                                    \
        change;                                                                                                        \
        h->checksum = store_checksum(h);                                                                               \
        if (store_header_check(&why, h, was.header_octets, count) == STATUS_OK) fail_msg("accepted: %s", #change);     \
        *h = was;                                                                                                      \
    } while (0)
    HOSTILE(h->level_count = 5);
    HOSTILE(h->level_count = 0);
    HOSTILE(h->level[0].nx = 1 << 30);
    HOSTILE(h->level[0].nx = -1);
    HOSTILE(h->level[0].pyramid_shift = 31);
    HOSTILE(h->level[1].rise_shift = -1);
    HOSTILE(h->level[1].spacing_m = 7);
    HOSTILE(h->level[0].step_m = NAN);
    HOSTILE(h->level[0].x0_m = 1e300);
    HOSTILE(h->surface[0].nx++);
    HOSTILE(h->surface[1].ny = -5);
    HOSTILE(h->surface[0].cell_m = 0);
    HOSTILE(h->albedo.nx = 1 << 20);
    HOSTILE(h->mean[3][1] = NAN);
    HOSTILE(h->crown_count = (uint64_t)1 << 62);
    HOSTILE(h->section[STORE_POSTS].offset += 4096);
    HOSTILE(h->section[STORE_CROWNS].octets += 16);
    HOSTILE(h->text[0] = 1 << 30);
    HOSTILE(h->text[2]--);
    HOSTILE(h->lat_rad = 3);
    HOSTILE(memset(h->made, 'x', sizeof h->made));
    free(octets);
}

static void changed_and_missing_sources_are_noticed(void **state)
{
    (void)state;
    char         path[temp_name_size], source[2][temp_name_size], which[temp_name_size];
    TerrainStore store;
    name_file(path, "sources.store");
    name_file(source[0], "a b.tif");
    name_file(source[1], "c.tif");
    for (int k = 0; k < 2; k++) write_whole(source[k], (const uint8_t *)"12345", 5);
    StorePlan   plan = lab_plan();
    StoreSource look[2] = {{.path = source[0]}, {.path = source[1]}};
    CHECK(store_source_look(&look[0]) && store_source_look(&look[1]) && look[0].octets == 5);
    plan.source = look;
    plan.source_count = 2;
    lab_write(path, &plan, NULL, 64);
    assert_int_equal(store_open(&store, path), STATUS_OK);
    CHECK(store_sources(&store, which, sizeof which) == STORE_FRESH && which[0] == 0);
    unlink(source[1]);
    CHECK(store_sources(&store, which, sizeof which) == STORE_SOURCES_MISSING && strcmp(which, source[1]) == 0);
    write_whole(source[0], (const uint8_t *)"123456", 6);
    CHECK(store_sources(&store, which, sizeof which) == STORE_CHANGED && strcmp(which, source[0]) == 0);
    store_close(&store);
    unlink(source[0]);
    unlink(path);
}

static void half_a_store_is_never_there(void **state)
{
    (void)state;
    char         path[temp_name_size], part[temp_name_size];
    float        bad[lab_wide_nx] = {NAN};
    StoreWriter *w, *second;
    StorePlan    plan = lab_plan();
    name_file(path, "half.store");
    name_file(part, "half.store.tmp");
    log_set_sink(check_listen, NULL);
    assert_int_equal(store_writer_create(&w, path, &plan, NULL), STATUS_OK);
    CHECK(access(path, F_OK) != 0 && access(part, F_OK) == 0);
    uint8_t     *octets;
    const size_t count = read_whole(&octets, part); /* a writer killed now leaves this, under another name */
    const char  *why;
    CHECK(store_header_check(&why, (const StoreHeader *)(const void *)octets, store_page, count) != STATUS_OK);
    free(octets);
    CHECK(store_writer_create(&second, path, &plan, NULL) != STATUS_OK && !second);
    CHECK(strstr(check_said, "another process"));
    CHECK(store_write_posts(w, 0, 1, bad) != STATUS_OK); /* out of order */
    CHECK(store_write_posts(w, 1, 1, bad) != STATUS_OK && strstr(check_said, "not a number"));
    CHECK(store_writer_finish(w, 0, NULL) != STATUS_OK && strstr(check_said, "not all posts"));
    CHECK(access(path, F_OK) != 0 && access(part, F_OK) != 0);
    plan.level[1].spacing_m = 7;
    CHECK(store_writer_create(&w, path, &plan, NULL) != STATUS_OK && !w);
    plan = lab_plan();
    plan.level[0].nx = 1000000;
    CHECK(store_writer_create(&w, path, &plan, NULL) != STATUS_OK && !w);
    plan = lab_plan();
    CHECK(store_writer_create(&w, "/proc/none.store", &plan, NULL) != STATUS_OK && !w);
    log_set_sink(NULL, NULL);
}

/* 192 M posts, 12 x 16 km at 1 m, with classes and a photograph of every cell, in 8 m out to 50 km: of what the whole
 * file holds, which is all that can be resident. Heights alone were 384 MB, their pyramids 544. */
static void the_whole_of_192_million_posts_is_below_900_mb(void **state)
{
    (void)state;
    StoreHeader h = {.header_octets = store_page, .level_count = 2, .albedo = {12000, 16000, -6000, -8000, 1}};
    h.level[0] = (StoreHeaderLevel){.nx = 12001, .ny = 16001, .spacing_m = 1, .step_m = 0x1p-9};
    h.level[1] = (StoreHeaderLevel){.nx = 6251, .ny = 6251, .spacing_m = 8, .step_m = 0x1p-9};
    h.surface[0] = (StoreGrid){12000, 16000, -6000, -8000, 1};
    h.surface[1] = (StoreGrid){2000, 2000, -8000, -8000, 8};
    CHECK(store_layout(&h));
    double pyramids = 0;
    for (int n = 0; n < 2; n++) pyramids += 1e-6 * (double)h.section[STORE_PYRAMID + n].octets;
    printf("192 M posts: %.0f MB: tiles %.0f, pyramids %.0f, classes %.0f, photograph %.0f; wide levels %.0f\n",
           1e-6 * (double)h.file_octets, 1e-6 * (double)h.section[STORE_POSTS].octets, pyramids,
           1e-6 * (double)h.section[STORE_SURFACE].octets, 1e-6 * (double)h.section[STORE_ALBEDO].octets,
           1e-6 * (double)h.section[STORE_POSTS + 1].octets);
    CHECK(h.file_octets <= 900000000u && pyramids <= 100);
}

static int make_lab(void **state)
{
    (void)state;
    const StorePlan plan = lab_plan();
    if (!temp_folder(folder)) return 1;
    name_file(lab, "lab.store");
    lab_write(lab, &plan, NULL, 50);
    return 0;
}

static int remove_lab(void **state)
{
    (void)state;
    return unlink(lab) != 0 || rmdir(folder) != 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(heights_are_within_half_a_step),
        cmocka_unit_test(the_seam_has_no_crack),
        cmocka_unit_test(rasters_come_back),
        cmocka_unit_test(any_threads_and_rows_give_the_same_octets),
        cmocka_unit_test(opening_touches_no_page_of_data),
        cmocka_unit_test(damaged_files_are_refused_with_the_next_step),
        cmocka_unit_test(options_are_recalled_from_what_is_left),
        cmocka_unit_test(hostile_headers_are_refused),
        cmocka_unit_test(changed_and_missing_sources_are_noticed),
        cmocka_unit_test(half_a_store_is_never_there),
        cmocka_unit_test(the_whole_of_192_million_posts_is_below_900_mb),
    };
    return cmocka_run_group_tests(tests, make_lab, remove_lab);
}
