/* sensor/commands/terrain/terrain_info.c: `pitviper terrain info`: levels, sections, classes and sources of a terrain
 * store, and pictures of it from above: shaded relief, and classes with a legend. */
#include "sensor/commands/commands.h"

#include "pitviper_output.h"
#include "sensor/commands/overwrite.h"
#include "sensor/publish/images/image_file.h"
#include "sensor/publish/images/picture_text.h"
#include "sensor/settings/command_line.h"
#include "terrain/import/terrain_import.h"
#include "terrain/store/store.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>

enum { most_px = 2000 }; /* a side, without the legend */

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

/* Gives the cosine of the angle to the light as a grey. */
static uint8_t shade(const float *z_m, int nx, int ny, int x, int y, double apart_m)
{
    static const double light[3] = {-0.5, 0.5, 0.7071067811865476}; /* from the north-west, 45 degrees high */
    const int           west = x > 0 ? x - 1 : x, east = x < nx - 1 ? x + 1 : x;
    const int           south = y > 0 ? y - 1 : y, north = y < ny - 1 ? y + 1 : y;
    const float        *row = z_m + (size_t)y * (size_t)nx;
    const float         rise_x = row[east] - row[west];
    const float  rise_y = z_m[(size_t)north * (size_t)nx + (size_t)x] - z_m[(size_t)south * (size_t)nx + (size_t)x];
    const double zx = (double)rise_x / ((east - west) * apart_m), zy = (double)rise_y / ((north - south) * apart_m);
    const double cosine = (-zx * light[0] - zy * light[1] + light[2]) / sqrt(1 + zx * zx + zy * zy);
    return (uint8_t)(20 + 235 * clamp(cosine, 0, 1) + 0.5);
}

/* Draws level 0 as shaded relief: north up, squares of posts averaged. */
static Status draw_hillshade(const char *path, const TerrainStore *store)
{
    const ElevationLevel *level = &store->elevation.level[0];
    const int             longest = level->nx > level->ny ? level->nx : level->ny;
    const int             square = (longest + most_px - 1) / most_px;
    const int             nx = level->nx / square, ny = level->ny / square;
    const bool            fits = nx > 1 && ny > 1;
    float                *z_m = fits ? malloc((size_t)nx * (size_t)ny * sizeof *z_m) : NULL;
    uint8_t              *grey = fits ? malloc((size_t)nx * (size_t)ny) : NULL;
    Status                status = z_m && grey ? STATUS_OK : fits ? STATUS_NO_MEMORY : STATUS_UNSUPPORTED;
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

static const uint8_t colour_of[SURFACE_COUNT][3] = {[SURFACE_NONE] = {30, 30, 30},
                                                    [SURFACE_GRASS] = {124, 186, 92},
                                                    [SURFACE_DRY_GRASS] = {204, 190, 120},
                                                    [SURFACE_CROP] = {230, 220, 80},
                                                    [SURFACE_BARE_SOIL] = {160, 120, 80},
                                                    [SURFACE_PLOUGHED] = {110, 78, 50},
                                                    [SURFACE_TRACK] = {200, 150, 110},
                                                    [SURFACE_ROCK] = {140, 140, 140},
                                                    [SURFACE_SCRUB] = {150, 160, 60},
                                                    [SURFACE_WATER] = {50, 110, 210},
                                                    [SURFACE_FOREST_BROADLEAF] = {40, 130, 50},
                                                    [SURFACE_FOREST_CONIFER] = {15, 80, 55},
                                                    [SURFACE_BUILT] = {200, 50, 40},
                                                    [SURFACE_ROAD] = {70, 70, 90},
                                                    [SURFACE_SAND] = {245, 230, 175},
                                                    [SURFACE_SNOW] = {245, 250, 255},
                                                    [SURFACE_WETLAND] = {90, 170, 165}};

/* Counts the cells of each class in window 0; octets that are no class count as SURFACE_NONE. */
static void class_cells(uint64_t cells[SURFACE_COUNT], const CoverGrid *grid)
{
    uint64_t     count[256] = {0};
    const size_t all = (size_t)grid->nx * (size_t)grid->ny;
    for (size_t n = 0; n < all; n++) count[grid->surface[n]]++;
    for (int s = 0; s < 256; s++)
        if (s >= SURFACE_COUNT) count[SURFACE_NONE] += count[s];
    for (int s = 0; s < SURFACE_COUNT; s++) cells[s] = count[s];
}

/* Draws each square of cells in its mean colour. */
static void draw_cells(uint8_t *rgb, int width, int height, const CoverGrid *grid, int square)
{
    const int nx = grid->nx / square, ny = grid->ny / square;
    for (int y = 0; y < ny && y < height; y++)
        for (int x = 0; x < nx; x++) {
            unsigned sum[3] = {0};
            for (int v = 0; v < square; v++)
                for (int u = 0; u < square; u++) {
                    const size_t at = (size_t)(y * square + v) * (size_t)grid->nx + (size_t)(x * square + u);
                    const uint8_t class = grid->surface[at] < SURFACE_COUNT ? grid->surface[at] : SURFACE_NONE;
                    for (int c = 0; c < 3; c++) sum[c] += colour_of[class][c];
                }
            uint8_t *to = rgb + 3 * ((size_t)(ny - 1 - y) * (size_t)width + (size_t)x);
            for (int c = 0; c < 3; c++) to[c] = (uint8_t)(sum[c] / (unsigned)(square * square));
        }
}

enum { legend_wide = 340, legend_row = 24 };

/* Draws the legend: the classes that there are, by share. */
static void draw_legend(uint8_t *rgb, int width, int height, int left, const CoverGrid *grid)
{
    uint64_t cells[SURFACE_COUNT], all = 0;
    bool     drawn[SURFACE_COUNT] = {false};
    char     text[64];
    class_cells(cells, grid);
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
        picture_text_write(rgb, width, height, left + 42, row * legend_row + 8, text);
    }
}

/* Draws window 0 of the classes with a legend, squares of cells averaged. */
static Status draw_class_map(const char *path, const TerrainStore *store)
{
    const CoverGrid *grid = &store->surface[0];
    const int        longest = grid->nx > grid->ny ? grid->nx : grid->ny;
    const int        square = (longest + most_px - 1) / most_px;
    const int        nx = square ? grid->nx / square : 0, ny = square ? grid->ny / square : 0;
    const int        least = SURFACE_COUNT * legend_row + 8, width = nx + legend_wide, height = ny > least ? ny : least;
    uint8_t         *rgb = nx && ny ? calloc(3 * (size_t)width, (size_t)height) : NULL;
    Status           status = rgb ? STATUS_OK : nx && ny ? STATUS_NO_MEMORY : STATUS_UNSUPPORTED;
    if (rgb) {
        draw_cells(rgb, width, height, grid, square);
        draw_legend(rgb, width, height, nx, grid);
        status = image_write_png(path, rgb, width, height, 3, 8);
    }
    if (status == STATUS_UNSUPPORTED) log_error("terrain info: the classes are too narrow for a picture");
    free(rgb);
    return status;
}

/* ---- the command line ------------------------------------------------------------------------------- */

static const char help[] =
    "usage: pitviper terrain info STORE [--out DIR [--overwrite]] [--verify]\n"
    "\n"
    "What is in a terrain store (`pitviper terrain import`): levels and their quantisation, octets of each section,\n"
    "shares of the classes, trees and buildings, and whether the files it was made of have changed.\n"
    "\n"
    "  --out DIR       also DIR/hillshade.png and DIR/classes.png: north up, at most 2000 pixels a side\n"
    "  --overwrite     replace them if they exist\n"
    "  --verify        read all data and compare their hash with the one they were written with\n";

typedef struct Wanted {
    const char *store, *out;
    bool        overwrite, verify;
} Wanted;

/* 0: go on, -1: help was printed, 2: usage. */
static int parse(Wanted *w, int argc, char **argv)
{
    enum { OUT = 'o', HELP = 'h', OVERWRITE = 256, VERIFY };
    static const struct option options[] = {{"out", 1, NULL, OUT},
                                            {"overwrite", 0, NULL, OVERWRITE},
                                            {"verify", 0, NULL, VERIFY},
                                            {"help", 0, NULL, HELP},
                                            {NULL, 0, NULL, 0}};
    optind = 0; /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "o:h", options)) != -1;) switch (option) {
        case OUT:
            w->out = optarg;
            break;
        case OVERWRITE:
            w->overwrite = true;
            break;
        case VERIFY:
            w->verify = true;
            break;
        case HELP:
            fputs(help, stdout);
            return -1;
        default:
            return 2;
        }
    if (optind + 1 == argc) {
        w->store = argv[optind];
        return 0;
    }
    return command_line_wrong("terrain info", optind == argc ? "no STORE is named" : "one STORE at a time");
}

/* ---- in words --------------------------------------------------------------------------------------- */

static void print_levels(const TerrainStore *store)
{
    for (int n = 0; n < store->elevation.level_count; n++) {
        const ElevationLevel *l = &store->elevation.level[n];
        const size_t          tiles = (size_t)l->tiles_x * (size_t)l->tiles_y;
        int32_t               shift = 0;
        for (size_t t = 0; t < tiles; t++) shift = l->tile[t].shift > shift ? l->tile[t].shift : shift;
        printf("level %d: %d x %d posts %.6g m apart, %.2f x %.2f km; steps of %.3g mm", n, l->nx, l->ny, l->spacing_m,
               1e-3 * (l->nx - 1) * l->spacing_m, 1e-3 * (l->ny - 1) * l->spacing_m, 1e3 * l->step_m);
        if (shift > 0 && shift < 31) printf(", of up to %.3g mm where it is steep", 1e3 * ldexp(l->step_m, shift));
        printf("; at most %.3g mm off\n", 1e3 * store->worst_m[n]);
    }
}

static void print_sections(const TerrainStore *store)
{
    StorePart part[store_sections_most];
    const int count = store_parts(part, store);
    for (int k = 0; k < count; k++) printf("  %-18s %12llu octets\n", part[k].name, (unsigned long long)part[k].octets);
}

static void print_classes(const TerrainStore *store)
{
    const CoverGrid *grid = &store->surface[0];
    uint64_t         cells[SURFACE_COUNT], all = 0;
    bool             said[SURFACE_COUNT] = {false};
    if (!grid->nx) {
        printf("classes: none; surfaces are by slope and height\n");
        return;
    }
    class_cells(cells, grid);
    for (int s = 0; s < SURFACE_COUNT; s++) all += cells[s];
    printf("classes: %d x %d cells of %.4g m:", grid->nx, grid->ny, grid->cell_m);
    for (int n = 0; n < SURFACE_COUNT; n++) {
        int best = -1;
        for (int s = 0; s < SURFACE_COUNT; s++)
            if (!said[s] && cells[s] > 0 && (best < 0 || cells[s] > cells[best])) best = s;
        if (best < 0) break;
        said[best] = true;
        printf("%s %s %.1f %%", n ? "," : "", best ? surface_name((SurfaceClass)best) : "none",
               100.0 * (double)cells[best] / (double)all);
    }
    putchar('\n');
}

static void print_text(const char *name, const char *text)
{
    if (*text) text_print(stdout, "%s: %s\n", name, text);
}

static void print_sources(const TerrainStore *store, const char *path)
{
    char  which[1024], outside[1024];
    char *texts = strdup(store->sources), *rest = texts, *line;
    while (texts && (line = strsep(&rest, "\n"))) {
        long long octets;
        int       at = 0;
        if (sscanf(line, "%lld %*d %n", &octets, &at) == 1 && at > 0)
            text_print(stdout, "source: %s, %lld octets\n", line + at, octets);
    }
    free(texts);
    const bool foreign = terrain_store_foreign(outside, sizeof outside, path, store->options);
    switch (store_sources(store, which, sizeof which)) {
    case STORE_FRESH:
        printf("sources: as they were\n");
        break;
    case STORE_CHANGED:
        if (foreign)
            text_print(stdout,
                       "sources: %s has CHANGED; the store is used as it is: %s lies outside its own folder "
                       "(`pitviper terrain again`)\n",
                       which, outside);
        else text_print(stdout, "sources: %s has CHANGED; a node makes the store again\n", which);
        break;
    case STORE_SOURCES_MISSING:
        text_print(stdout, "sources: %s is not here; the store is used as it is\n", which);
        break;
    }
}

static void print_info(const TerrainStore *store, const char *path)
{
    const Geodetic *o = &store->frame.origin;
    text_print(stdout, "%s: terrain store of %s, %.1f MB, content %016llx\n", path, store->made,
               1e-6 * (double)store->octets, (unsigned long long)store->content);
    printf("origin: %.6f N, %.6f E, %.2f m above the ellipsoid; the geoid is at %+.2f m\n", o->lat_rad / rad_per_deg,
           o->lon_rad / rad_per_deg, o->h_m, store->geoid_m);
    print_text("CRS", store->crs);
    print_text("heights", store->vertical_datum);
    print_text("provenance", store->provenance);
    print_levels(store);
    print_sections(store);
    print_classes(store);
    if (store->photo.mips)
        printf("photograph: %d x %d pixels of %.4g m\n", store->photo.nx[0], store->photo.ny[0], store->photo.cell_m);
    if (store->canopy_height) printf("canopy height: cells of %.4g m\n", store->canopy_height_grid.cell_m);
    if (store->canopy_cover) printf("canopy cover: cells of %.4g m\n", store->canopy_cover_grid.cell_m);
    printf("crowns: %llu; buildings: %llu\n", (unsigned long long)store->crown_count,
           (unsigned long long)store->building_count);
    print_sources(store, path);
}

/* ---- the pictures' files ---------------------------------------------------------------------------- */

static Status draw(const Wanted *w, const TerrainStore *store)
{
    char hillshade[4096], classes[4096];
    if (snprintf(hillshade, sizeof hillshade, "%s/hillshade.png", w->out) >= (int)sizeof hillshade ||
        snprintf(classes, sizeof classes, "%s/classes.png", w->out) >= (int)sizeof classes)
        return STATUS_BAD_VALUE;
    if (output_folder(w->out) != 0) {
        log_error("terrain info: cannot create %s: %s", w->out, output_reason(errno));
        return STATUS_IO;
    }
    const bool some = store->surface[0].nx > 0;
    Status     status = overwrite_file("terrain info", hillshade, w->overwrite);
    if (status == STATUS_OK && some) status = overwrite_file("terrain info", classes, w->overwrite);
    if (status == STATUS_OK) status = draw_hillshade(hillshade, store);
    if (status == STATUS_OK && some) status = draw_class_map(classes, store);
    if (status == STATUS_OK) log_print("%s%s%s\n", hillshade, some ? ", " : "", some ? classes : "");
    return status;
}

/* ---- the command ------------------------------------------------------------------------------------ */

int terrain_info_command(int argc, char **argv)
{
    Wanted       w = {0};
    TerrainStore store;
    const int    code = parse(&w, argc, argv);
    if (code) return code < 0 ? 0 : code;
    Status status = store_open(&store, w.store);
    if (status != STATUS_OK) return 1;
    print_info(&store, w.store);
    if (w.verify) {
        Pool *pool = NULL;
        status = pool_create(&pool, thread_processors());
        if (status == STATUS_OK && store_verify(&store, pool)) printf("verified: the data are as they were written\n");
        else if (status == STATUS_OK) {
            log_error("terrain info: %s is damaged: its data have another hash than when it was written; make it again "
                      "with `pitviper terrain import`",
                      w.store);
            status = STATUS_BAD_VALUE;
        }
        pool_destroy(pool);
    }
    if (status == STATUS_OK && w.out) status = draw(&w, &store);
    store_close(&store);
    return status == STATUS_OK ? 0 : 1;
}
