/* tests/terrain/store_lab.h: a small store written from a made-up landscape. */
#ifndef TESTS_TERRAIN_STORE_LAB_H
#define TESTS_TERRAIN_STORE_LAB_H

#include "tests/check.h"

#include "terrain/store/store_format_private.h"

/* Two levels: 769 x 641 posts of 1 m in 161 x 129 of 8 m; classes of 1 m and 8 m, a photograph of 1 m with a rim that
 * is not covered, canopy rasters of 4 m. */
enum { lab_nx = 769, lab_ny = 641, lab_wide_nx = 161, lab_wide_ny = 129, lab_photo_nx = 500, lab_photo_ny = 333 };

static inline float lab_height_m(double x_m, double y_m)
{
    return (float)(30 * sin(x_m / 90) * cos(y_m / 70) + 0.2 * x_m + (x_m > 100 && y_m > 50 ? 60 : 0));
}

static inline uint8_t lab_surface(double x_m, double y_m)
{
    const int field = (int)floor(x_m / 37) + (int)floor(y_m / 53) + 100;
    return x_m < -200 ? SURFACE_NONE : (uint8_t)(1 + field % (SURFACE_COUNT - 1));
}

static inline StorePlan lab_plan(void)
{
    return (StorePlan){
        .origin = {0.77, -2.148, 120},
        .level_count = 2,
        .level = {{.nx = lab_nx, .ny = lab_ny, .x0_m = -384, .y0_m = -320, .spacing_m = 1, .seam_shift = -1},
                  {.nx = lab_wide_nx, .ny = lab_wide_ny, .x0_m = -640, .y0_m = -512, .spacing_m = 8, .seam_shift = -1}},
        .surface = {{768, 640, -384, -320, 1}, {160, 128, -640, -512, 8}},
        .albedo = {lab_photo_nx, lab_photo_ny, -250, -160, 1},
        .canopy_height = {192, 160, -384, -320, 4},
        .canopy_cover = {192, 160, -384, -320, 4},
        .posting_m = 1,
        .geoid_m = -22.5,
        .seed = 1,
        .options = "--elevation\na.tif",
        .crs = "EPSG:26910",
        .vertical_datum = "NAVD88",
        .provenance = "made up"};
}

static inline void lab_posts(StoreWriter *w, const StorePlan *plan, int index, int at_a_time)
{
    const StoreLevel *l = &plan->level[index];
    float            *z_m = malloc((size_t)l->nx * (size_t)l->ny * sizeof *z_m);
    CHECK(z_m);
    for (int j = 0; j < l->ny; j++)
        for (int i = 0; i < l->nx; i++)
            z_m[(size_t)j * (size_t)l->nx + (size_t)i] =
                lab_height_m(l->x0_m + i * l->spacing_m, l->y0_m + j * l->spacing_m);
    for (int j = 0; j < l->ny; j += at_a_time)
        assert_int_equal(
            store_write_posts(w, index, l->ny - j < at_a_time ? l->ny - j : at_a_time, z_m + (size_t)j * (size_t)l->nx),
            STATUS_OK);
    free(z_m);
}

static inline void lab_surfaces(StoreWriter *w, const StorePlan *plan, int window)
{
    const StoreGrid *g = &plan->surface[window];
    uint8_t          row[1024];
    for (int j = 0; j < g->ny; j++) {
        for (int i = 0; i < g->nx; i++)
            row[i] = lab_surface(g->x0_m + (i + 0.5) * g->cell_m, g->y0_m + (j + 0.5) * g->cell_m);
        assert_int_equal(store_write_surface(w, window, 1, row), STATUS_OK);
    }
}

static inline void lab_albedo_row(uint8_t *rgba, int j)
{
    for (int i = 0; i < lab_photo_nx; i++) {
        rgba[4 * i] = (uint8_t)(90 + 60 * sin(i / 31.0));
        rgba[4 * i + 1] = (uint8_t)(100 + 50 * cos(j / 17.0));
        rgba[4 * i + 2] = (uint8_t)(70 + (i * 7 + j * 3) % 20);
        rgba[4 * i + 3] = i + j > 60 ? 255 : 0;
    }
}

/* All of it, posts at_a_time rows at once. */
static inline void lab_write(const char *path, const StorePlan *plan, Pool *pool, int at_a_time)
{
    static const Crown crown[3] = {{1, 2, 9, 3}, {4, 5, 8, 2}, {-30, 6, 21, 4}};
    StoreWriter       *w;
    uint8_t            rgba[4 * lab_photo_nx], canopy[192];
    assert_int_equal(store_writer_create(&w, path, plan, pool), STATUS_OK);
    for (int n = plan->level_count - 1; n >= 0; n--) lab_posts(w, plan, n, at_a_time);
    for (int n = 0; n < cover_windows; n++) lab_surfaces(w, plan, n);
    for (int j = 0; j < plan->albedo.ny; j++) {
        lab_albedo_row(rgba, j);
        assert_int_equal(store_write_albedo(w, 1, rgba), STATUS_OK);
    }
    for (int j = 0; j < plan->canopy_height.ny; j++) {
        for (int i = 0; i < 192; i++) canopy[i] = (uint8_t)((i + j) % 100);
        assert_int_equal(store_write_canopy_height(w, 1, canopy), STATUS_OK);
        assert_int_equal(store_write_canopy_cover(w, 1, canopy), STATUS_OK);
    }
    assert_int_equal(store_write_crowns(w, 2, crown), STATUS_OK);
    assert_int_equal(store_write_crowns(w, 1, crown + 2), STATUS_OK);
    StoreReport report;
    assert_int_equal(store_writer_finish(w, 5, &report), STATUS_OK);
    CHECK(report.crowns == 3 && report.buildings == 5 && report.worst_m[0] <= 0x1p-9);
}

#endif
