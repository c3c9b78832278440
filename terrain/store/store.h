/* terrain/store/store.h: the terrain store: a disposable, versioned cache of terrain in one file, which is mapped
 * read-only. The file's layout: terrain/store/store_format_private.h.
 *
 * Writer. Levels coarse before fine, the rows of everything from south to north. The whole file is reserved at the
 * start, written under PATH.tmp, and renamed when it is complete: a full disk is an error before any work, and no half
 * file is ever taken for whole. */
#ifndef TERRAIN_STORE_STORE_H
#define TERRAIN_STORE_STORE_H

#include "terrain/ground/ground_image.h"
#include "terrain/ground/landscape.h"
#include "terrain/bare_earth/take_apart.h"

/* ---- writer --------------------------------------------------------------------------------- */

/* A raster in ENU, row 0 southernmost; nx 0: none. */
typedef struct StoreGrid {
    int    nx, ny;
    double x0_m, y0_m, cell_m; /* south-west corner of the first cell */
} StoreGrid;

typedef struct StoreLevel {
    int    nx, ny;                /* posts; post (i, j) at (x0 + i spacing, y0 + j spacing) */
    double x0_m, y0_m, spacing_m; /* spacings of levels differ by powers of two, and the outline lies on cell edges of
                                     the next level */
    double z0_m,
        step_m;     /* step: a power of two; z0: a multiple of 64, or one for all levels. step 0: both are chosen */
    int seam_shift; /* edge posts are multiples of step << seam_shift; -1: chosen by the spacing */
} StoreLevel;

/* A file that the store was made from. */
typedef struct StoreSource {
    const char *path;
    int64_t     octets, mtime_ns; /* size and time when it was read; store_source_look fills them in */
} StoreSource;

typedef struct StorePlan {
    Geodetic           origin;      /* origin of the local frame */
    int                level_count; /* level 0 finest */
    StoreLevel         level[elevation_max_levels];
    StoreGrid          surface[cover_windows]; /* classes, as CoverGrid: 0 fine, 1 coarse and wide */
    StoreGrid          albedo;                 /* a photograph, linear light encoded as sRGB */
    StoreGrid          canopy_height, canopy_cover;
    double             posting_m; /* posting of the finest source, for reports */
    double             geoid_m;   /* height of the geoid at the origin; 0 where heights were above the ellipsoid */
    uint64_t           seed;      /* seed of surfaces that no file has; they count in the photograph's means */
    int                source_count;
    const StoreSource *source;  /* [source_count] */
    const char        *options; /* arguments of the import, a line each: what rebuilds the store */
    const char        *crs, *vertical_datum, *provenance; /* notes, free text */
} StorePlan;

static const double store_canopy_height_m = 0.5; /* unit of an octet of canopy height */
static const double store_canopy_cover = 0.01;   /* unit of an octet of canopy cover, 0 .. 100 */

typedef struct StoreWriter StoreWriter;

/* Size of the file that a plan makes, without its crowns. What no store can hold is logged, as by store_writer_create.
 * */
Status store_plan_octets(uint64_t *octets, const char *path, const StorePlan *plan);
/* Creates PATH.tmp at its full size. The plan and its texts are copied; pool (NULL: one thread) is used by every call.
 * Failures are logged; on failure *out is NULL. */
Status store_writer_create(StoreWriter **out, const char *path, const StorePlan *plan, Pool *pool);
/* Writes the next `rows` rows of posts of a level, from the south: ENU z, [rows][nx], finite. Any number of rows at a
 * time (whole rows of tiles, 64, are best). Level n + 1 must be complete. The outline of the level is replaced by the
 * surface of the next one; the caller blends the posts near it (levels_join). */
Status store_write_posts(StoreWriter *writer, int level, int rows, const float *z_m);
/* Writes the next rows of a window of classes: SurfaceClass, SURFACE_NONE where no file has a class. */
Status store_write_surface(StoreWriter *writer, int window, int rows, const uint8_t *surface);
/* Writes the next rows of the photograph: [rows][nx][4], sRGB and coverage, 0 or 255. */
Status store_write_albedo(StoreWriter *writer, int rows, const uint8_t *rgba);
Status store_write_canopy_height(StoreWriter *writer, int rows, const uint8_t *height);
Status store_write_canopy_cover(StoreWriter *writer, int rows, const uint8_t *cover);
/* Appends crowns; here x_m and y_m are ENU. */
Status store_write_crowns(StoreWriter *writer, int count, const Crown *crown);

/* How much the quantisation changed the posts. */
typedef struct StoreReport {
    double   step_m[elevation_max_levels], worst_m[elevation_max_levels]; /* |stored - given|, the outlines left out */
    uint64_t octets;
    uint64_t crowns, buildings;
} StoreReport;

/* Ends the writing, when all rows have been written: measures the photograph's means, writes header and checksum, syncs
 * and renames. The writer is freed in any case; on failure PATH.tmp is removed and PATH untouched. report may be NULL.
 * */
Status store_writer_finish(StoreWriter *writer, uint64_t buildings, StoreReport *report);
/* Frees the writer and removes PATH.tmp; accepts NULL. */
void store_writer_abandon(StoreWriter *writer);

/* Sets size and time of modification of source->path. Returns false when the file cannot be examined. */
bool store_source_look(StoreSource *source);

/* ---- reader --------------------------------------------------------------------------------- */

/* A mapped store; what it points to is valid until it is closed. */
typedef struct TerrainStore {
    const uint8_t *map;
    size_t         octets;
    void          *header; /* a copy of the header, which holds the texts below */
    LocalFrame     frame;
    uint64_t       content;  /* hash of everything in it except the places of its sources */
    char           made[32]; /* UTC */
    double         posting_m, geoid_m;
    Elevation      elevation; /* borrowed */
    CoverGrid      surface[cover_windows];
    Photo          photo;
    StoreGrid      canopy_height_grid, canopy_cover_grid;
    const uint8_t *canopy_height, *canopy_cover;  /* NULL: the store has none */
    double         worst_m[elevation_max_levels]; /* largest error of a post's quantisation */
    uint64_t       crown_count, building_count;
    const Crown   *crown;
    const char    *sources, *options, *crs, *vertical_datum,
        *provenance; /* sources: a line `octets mtime_ns path` for each */
} TerrainStore;

/* Opens, maps and checks the header: no page of data is touched. Failures are logged with the next step. A file cut
 * while it is mapped ends the process (SIGBUS): replace a store by renaming, as the writer does. */
Status store_open(TerrainStore *out, const char *path);
void   store_close(TerrainStore *store);
/* As store_open, but nothing is logged; *why says why a file cannot be used. STATUS_BAD_VALUE: it was cut or is
 * damaged; STATUS_UNSUPPORTED: another version wrote it; STATUS_IO: it cannot be read, or is not a regular file. *why
 * stays as it is until the thread's next call. */
Status store_open_why(TerrainStore *out, const char **why, const char *path);
/* The import's options from a file that cannot be used; they have a checksum of their own. malloc'd. NULL: the file is
 * not a store, or its options are lost too. */
char *store_recall(const char *path);

typedef enum StoreSources { STORE_FRESH, STORE_CHANGED, STORE_SOURCES_MISSING } StoreSources;
/* Compares the sources with what the store recorded; CHANGED takes precedence over MISSING. which: the first source
 * that differs; "" for FRESH. */
StoreSources store_sources(const TerrainStore *store, char *which, size_t which_size);

/* The landscape of a store, which keeps the store mapped until landscape_destroy. seed: of the texture, and of surfaces
 * that the store does not have. */
Status store_open_landscape(Landscape *out, const char *path, uint64_t seed);

enum { store_sections_most = 24 };
typedef struct StorePart {
    const char *name;
    uint64_t    octets;
} StorePart;
/* Sections that are not empty, the header first; returns their count. */
int store_parts(StorePart out[store_sections_most], const TerrainStore *store);
/* Whether the data still have the hash that was computed when they were written; reads all of them. */
bool store_verify(const TerrainStore *store, Pool *pool);

#endif
