/* sensor/commands/terrain_info.c: `pitviper terrain info`: levels, sections, classes, sources and pictures of a terrain
 * store. */
#include "sensor/commands/terrain_info.h"
#include "pitviper_output.h"

#include "sensor/commands/terrain_pictures.h"
#include "sensor/node/overwrite.h"
#include "sensor/settings/next_option.h"
#include "terrain/import/terrain_import.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>

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
    static const struct option options[] = {{"out", 1, NULL, OUT}, {"overwrite", 0, NULL, OVERWRITE},
                                            {"verify", 0, NULL, VERIFY}, {"help", 0, NULL, HELP}, {NULL, 0, NULL, 0}};
    optind = 0; /* restart getopt */
    for (int option; (option = next_option(argc, argv, "o:h", options)) != -1;)
        switch (option) {
        case OUT: w->out = optarg; break;
        case OVERWRITE: w->overwrite = true; break;
        case VERIFY: w->verify = true; break;
        case HELP: fputs(help, stdout); return -1;
        default: return 2;
        }
    if (optind + 1 == argc) {
        w->store = argv[optind];
        return 0;
    }
    return wrong_line("terrain info", optind == argc ? "no STORE is named" : "one STORE at a time");
}

/* ---- words -------------------------------------------------------------------------------------------- */

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
    terrain_class_cells(cells, grid);
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
    char which[1024], outside[1024];
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
    case STORE_FRESH: printf("sources: as they were\n"); break;
    case STORE_CHANGED:
        if (foreign)
            text_print(stdout, "sources: %s has CHANGED; the store is used as it is: %s lies outside its own folder "
                       "(`pitviper terrain again`)\n", which, outside);
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

/* ---- pictures ------------------------------------------------------------------------------------------ */

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
    if (status == STATUS_OK) status = terrain_picture_hillshade(hillshade, store);
    if (status == STATUS_OK && some) status = terrain_picture_classes(classes, store);
    if (status == STATUS_OK) log_print("%s%s%s\n", hillshade, some ? ", " : "", some ? classes : "");
    return status;
}

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
                      "with `pitviper terrain import`", w.store);
            status = STATUS_BAD_VALUE;
        }
        pool_destroy(pool);
    }
    if (status == STATUS_OK && w.out) status = draw(&w, &store);
    store_close(&store);
    return status == STATUS_OK ? 0 : 1;
}
