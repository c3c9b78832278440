/* tests/sensor/test_store_frames.c: frames over a terrain store: the planes of the same landscape in memory; no crash
 * over data that are noise. labels: slow */
#include "tests/sensor/store_frames.h"

#include "terrain/from_files/elevation_import.h"
#include "terrain/ground/landscape_parts.h"
#include "terrain/store/store_format_private.h"

#include <fcntl.h>
#include <sys/stat.h>

static char folder[temp_path_size];

static void name_file(char out[temp_name_size], const char *name)
{
    snprintf(out, temp_name_size, "%s/%s", folder, name);
}

/* ---- the same landscape --------------------------------------------------------------------------- */

static void write_sheet(char path[temp_name_size], const char *name, bool classes)
{
    enum { cells = 96 };
    static const int code[] = {10, 30, 40, 60, 80};
    name_file(path, name);
    FILE *file = fopen(path, "w");
    CHECK(file);
    fprintf(file, "ncols %d\nnrows %d\nxllcorner 494020\nyllcorner 4877520\ncellsize 10\n", cells, cells);
    for (int j = 0; j < cells; j++)
        for (int i = 0; i < cells; i++)
            if (classes) fprintf(file, "%d\n", code[(i / 7 + j / 5) % 5]);
            else fprintf(file, "%.2f\n", 100 + 12 * sin(i / 9.0) * cos(j / 6.0) + 0.05 * i);
    CHECK(fclose(file) == 0);
    char prj[temp_name_size];
    snprintf(prj, sizeof prj, "%.*sprj", (int)strlen(path) - 3, path);
    file = fopen(prj, "w");
    CHECK(file &&
          fputs("Projection    UTM\nZone          10\nDatum         WGS84\nSpheroid      WGS84\n"
                "Units         METERS\nParameters\n",
                file) >= 0 &&
          fclose(file) == 0);
}

/* The same posts, steps and classes as a store. */
static void store_of(const char *path, const Landscape *landscape)
{
    LandscapeParts p;
    landscape_parts(&p, landscape);
    StorePlan    plan = {.origin = p.frame.origin, .level_count = p.elevation.level_count, .geoid_m = p.geoid_m};
    StoreWriter *w;
    for (int n = 0; n < plan.level_count; n++) {
        const ElevationLevel *l = &p.elevation.level[n];
        plan.level[n] = (StoreLevel){l->nx, l->ny, l->x0_m, l->y0_m, l->spacing_m, l->z0_m, l->step_m, 0};
    }
    for (int k = 0; k < cover_windows; k++) {
        const CoverGrid *g = &p.cover[k];
        plan.surface[k] = (StoreGrid){g->nx, g->ny, g->x0_m, g->y0_m, g->cell_m};
    }
    assert_int_equal(store_writer_create(&w, path, &plan, NULL), STATUS_OK);
    for (int n = plan.level_count - 1; n >= 0; n--) {
        const ElevationLevel *l = &p.elevation.level[n];
        float                *row = malloc((size_t)l->nx * sizeof *row);
        for (int j = 0; row && j < l->ny; j++) {
            for (int i = 0; i < l->nx; i++) row[i] = (float)elevation_post_m(l, i, j);
            assert_int_equal(store_write_posts(w, n, 1, row), STATUS_OK);
        }
        free(row);
    }
    for (int k = 0; k < cover_windows; k++)
        assert_int_equal(store_write_surface(w, k, p.cover[k].ny, p.cover[k].surface), STATUS_OK);
    assert_int_equal(store_writer_finish(w, 0, NULL), STATUS_OK);
}

static void check_same_posts(const Elevation *a, const Elevation *b)
{
    CHECK(a->level_count == b->level_count);
    for (int n = 0; n < a->level_count; n++)
        for (int j = 0; j < a->level[n].ny; j++)
            for (int i = 0; i < a->level[n].nx; i++)
                CHECK(elevation_post_m(&a->level[n], i, j) == elevation_post_m(&b->level[n], i, j));
}

/* Over noise in place of tiles, posts, pyramids and classes nothing crashes or hangs. */
static void render_noise(const char *path)
{
    struct stat about;
    FrameHashes any;
    Landscape   landscape;
    const int   file = open(path, O_RDWR);
    CHECK(file >= 0 && fstat(file, &about) == 0);
    StoreHeader header;
    CHECK(pread(file, &header, sizeof header, 0) == sizeof header);
    for (off_t at = (off_t)header.header_octets; at < about.st_size; at += 4096) {
        uint32_t page[1024];
        for (uint32_t k = 0; k < 1024; k += 4)
            random_u32x4(page + k, (const uint32_t[4]){k, (uint32_t)at, 3, 4}, (const uint32_t[2]){5, 6});
        CHECK(pwrite(file, page, sizeof page, at) == sizeof page);
    }
    close(file);
    assert_int_equal(store_open_landscape(&landscape, path, 1), STATUS_OK);
    render_all(&any, &landscape);
    landscape_destroy(&landscape);
}

static void a_store_has_the_planes_of_its_landscape(void **state)
{
    (void)state;
    char            elevation[temp_name_size], cover[temp_name_size], path[temp_name_size];
    const Geodetic  place = {44.0551450382678 * rad_per_deg, -123.06866432757 * rad_per_deg, 0};
    LocalFrame      frame;
    Landscape       direct, stored;
    LandscapeReport report;
    FrameHashes     a, b;
    assert_int_equal(local_frame_at(&frame, &place), STATUS_OK);
    write_sheet(elevation, "ground.asc", false);
    write_sheet(cover, "cover.asc", true);
    const LandscapeFiles files = {.elevation = {.paths = elevation, .geoid_path = "", .horizon_m = 2000},
                                  .cover = cover,
                                  .cover_table = "worldcover",
                                  .photo = "",
                                  .seed = 1};
    assert_int_equal(landscape_import(&direct, &report, &files, &frame, NULL, 0), STATUS_OK);
    name_file(path, "same.store");
    store_of(path, &direct);
    assert_int_equal(store_open_landscape(&stored, path, 1), STATUS_OK);
    check_same_posts(&direct.elevation, &stored.elevation);
    CHECK(render_all(&a, &direct) && render_all(&b, &stored));
    for (int n = 0; n < frames; n++) assert_string_equal(a.sha256[n], b.sha256[n]);
    CHECK(strcmp(a.sha256[0], a.sha256[1]) != 0);
    landscape_destroy(&direct);
    landscape_destroy(&stored);
    render_noise(path);
}

static int make_folder(void **state)
{
    (void)state;
    return temp_folder(folder) ? 0 : 1;
}

static int remove_folder(void **state)
{
    static const char *const name[] = {"ground.asc", "ground.prj", "cover.asc", "cover.prj", "same.store"};
    char                     path[temp_name_size];
    (void)state;
    for (size_t k = 0; k < sizeof name / sizeof *name; k++) {
        name_file(path, name[k]);
        unlink(path);
    }
    return rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_store_has_the_planes_of_its_landscape),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
