/* sensor/commands/terrain_pictures.c: shaded relief and classes of a terrain store. */
#include "sensor/commands/terrain_pictures.h"

#include "sensor/publish/letters.h"
#include "sensor/publish/image_file.h"

#include <stdlib.h>

/* ---- shaded relief ----------------------------------------------------------------------------------- */

/* Mean heights of squares of `square` x `square` posts, [ny][nx], row 0 southernmost. */
static void mean_heights(float *out, int nx, int ny, const ElevationLevel *level, int square)
{
    for (int y = 0; y < ny; y++)
        for (int x = 0; x < nx; x++) {
            double sum = 0;
            for (int v = 0; v < square; v++)
                for (int u = 0; u < square; u++) sum += elevation_post(level, x * square + u, y * square + v);
            out[(size_t)y * (size_t)nx + (size_t)x] =
                (float)(level->z0_m + level->step_m * sum / ((double)square * square));
        }
}

/* Cosine of the angle to the light, as a grey. */
static uint8_t shade(const float *z_m, int nx, int ny, int x, int y, double apart_m)
{
    static const double light[3] = {-0.5, 0.5, 0.7071067811865476}; /* from the north-west, 45 degrees high */
    const int    west = x > 0 ? x - 1 : x, east = x < nx - 1 ? x + 1 : x;
    const int    south = y > 0 ? y - 1 : y, north = y < ny - 1 ? y + 1 : y;
    const float *row = z_m + (size_t)y * (size_t)nx;
    const float  rise_x = row[east] - row[west];
    const float  rise_y = z_m[(size_t)north * (size_t)nx + (size_t)x] - z_m[(size_t)south * (size_t)nx + (size_t)x];
    const double zx = (double)rise_x / ((east - west) * apart_m), zy = (double)rise_y / ((north - south) * apart_m);
    const double cosine = (-zx * light[0] - zy * light[1] + light[2]) / sqrt(1 + zx * zx + zy * zy);
    return (uint8_t)(20 + 235 * clamp(cosine, 0, 1) + 0.5);
}

Status terrain_picture_hillshade(const char *path, const TerrainStore *store)
{
    const ElevationLevel *level = &store->elevation.level[0];
    const int longest = level->nx > level->ny ? level->nx : level->ny;
    const int square = (longest + terrain_picture_most_px - 1) / terrain_picture_most_px;
    const int  nx = level->nx / square, ny = level->ny / square;
    const bool fits = nx > 1 && ny > 1;
    float   *z_m = fits ? malloc((size_t)nx * (size_t)ny * sizeof *z_m) : NULL;
    uint8_t *grey = fits ? malloc((size_t)nx * (size_t)ny) : NULL;
    Status   status = z_m && grey ? STATUS_OK : fits ? STATUS_NO_MEMORY : STATUS_UNSUPPORTED;
    if (status == STATUS_OK) {
        mean_heights(z_m, nx, ny, level, square);
        for (int y = 0; y < ny; y++)
            for (int x = 0; x < nx; x++)
                grey[(size_t)(ny - 1 - y) * (size_t)nx + (size_t)x] =
                    shade(z_m, nx, ny, x, y, square * level->spacing_m);
        status = image_write_png(path, grey, nx, ny, 1, 8);
    }
    if (status == STATUS_UNSUPPORTED) log_error("terrain info: level 0 is too narrow for a picture");
    free(z_m);
    free(grey);
    return status;
}

/* ---- classes ------------------------------------------------------------------------------------------ */

static const uint8_t colour_of[SURFACE_COUNT][3] = {
    [SURFACE_NONE] = {30, 30, 30}, [SURFACE_GRASS] = {124, 186, 92}, [SURFACE_DRY_GRASS] = {204, 190, 120},
    [SURFACE_CROP] = {230, 220, 80}, [SURFACE_BARE_SOIL] = {160, 120, 80}, [SURFACE_PLOUGHED] = {110, 78, 50},
    [SURFACE_TRACK] = {200, 150, 110}, [SURFACE_ROCK] = {140, 140, 140}, [SURFACE_SCRUB] = {150, 160, 60},
    [SURFACE_WATER] = {50, 110, 210}, [SURFACE_FOREST_BROADLEAF] = {40, 130, 50},
    [SURFACE_FOREST_CONIFER] = {15, 80, 55}, [SURFACE_BUILT] = {200, 50, 40}, [SURFACE_ROAD] = {70, 70, 90},
    [SURFACE_SAND] = {245, 230, 175}, [SURFACE_SNOW] = {245, 250, 255}, [SURFACE_WETLAND] = {90, 170, 165}};

void terrain_class_cells(uint64_t cells[SURFACE_COUNT], const CoverGrid *grid)
{
    uint64_t     count[256] = {0};
    const size_t all = (size_t)grid->nx * (size_t)grid->ny;
    for (size_t n = 0; n < all; n++) count[grid->surface[n]]++;
    for (int s = 0; s < 256; s++)
        if (s >= SURFACE_COUNT) count[SURFACE_NONE] += count[s];
    for (int s = 0; s < SURFACE_COUNT; s++) cells[s] = count[s];
}

/* Mean colour of each square of cells. */
static void draw_classes(uint8_t *rgb, int width, int height, const CoverGrid *grid, int square)
{
    const int nx = grid->nx / square, ny = grid->ny / square;
    for (int y = 0; y < ny && y < height; y++)
        for (int x = 0; x < nx; x++) {
            unsigned sum[3] = {0};
            for (int v = 0; v < square; v++)
                for (int u = 0; u < square; u++) {
                    const size_t  at = (size_t)(y * square + v) * (size_t)grid->nx + (size_t)(x * square + u);
                    const uint8_t class = grid->surface[at] < SURFACE_COUNT ? grid->surface[at] : SURFACE_NONE;
                    for (int c = 0; c < 3; c++) sum[c] += colour_of[class][c];
                }
            uint8_t *to = rgb + 3 * ((size_t)(ny - 1 - y) * (size_t)width + (size_t)x);
            for (int c = 0; c < 3; c++) to[c] = (uint8_t)(sum[c] / (unsigned)(square * square));
        }
}

enum { legend_wide = 340, legend_row = 24 };

/* The classes that there are, by share. */
static void draw_legend(uint8_t *rgb, int width, int height, int left, const CoverGrid *grid)
{
    uint64_t cells[SURFACE_COUNT], all = 0;
    bool     drawn[SURFACE_COUNT] = {false};
    char     text[64];
    terrain_class_cells(cells, grid);
    for (int s = 0; s < SURFACE_COUNT; s++) all += cells[s];
    for (int row = 0; row < SURFACE_COUNT; row++) {
        int best = -1;
        for (int s = 0; s < SURFACE_COUNT; s++)
            if (!drawn[s] && cells[s] > 0 && (best < 0 || cells[s] > cells[best])) best = s;
        if (best < 0) return;
        drawn[best] = true;
        for (int y = row * legend_row + 6; y < (row + 1) * legend_row + 2 && y < height; y++)
            for (int x = left + 8; x < left + 32; x++)
                memcpy(rgb + 3 * ((size_t)y * (size_t)width + (size_t)x), colour_of[best], 3);
        snprintf(text, sizeof text, "%s %.1f%%", best ? surface_name((SurfaceClass)best) : "no class",
                 100.0 * (double)cells[best] / (double)all);
        letters_write(rgb, width, height, left + 42, row * legend_row + 8, text);
    }
}

Status terrain_picture_classes(const char *path, const TerrainStore *store)
{
    const CoverGrid *grid = &store->surface[0];
    const int longest = grid->nx > grid->ny ? grid->nx : grid->ny;
    const int square = (longest + terrain_picture_most_px - 1) / terrain_picture_most_px;
    const int nx = square ? grid->nx / square : 0, ny = square ? grid->ny / square : 0;
    const int least = SURFACE_COUNT * legend_row + 8, width = nx + legend_wide, height = ny > least ? ny : least;
    uint8_t  *rgb = nx && ny ? calloc(3 * (size_t)width, (size_t)height) : NULL;
    Status    status = rgb ? STATUS_OK : nx && ny ? STATUS_NO_MEMORY : STATUS_UNSUPPORTED;
    if (rgb) {
        draw_classes(rgb, width, height, grid, square);
        draw_legend(rgb, width, height, nx, grid);
        status = image_write_png(path, rgb, width, height, 3, 8);
    }
    if (status == STATUS_UNSUPPORTED) log_error("terrain info: the classes are too narrow for a picture");
    free(rgb);
    return status;
}
