/* terrain/import/terrain_import.h: a terrain store from any set of files that GDAL reads.
 *
 * Level 0 is made in strips of rows: memory grows with a strip (some 200 MB for 12 000 posts a row, twice that where a
 * surface model is taken apart, and two thirds more with its buildings as records), never with the whole. The same
 * store for any number of threads. */
#ifndef TERRAIN_IMPORT_TERRAIN_IMPORT_H
#define TERRAIN_IMPORT_TERRAIN_IMPORT_H

#include "terrain/from_files/elevation_import.h"
#include "terrain/store/store.h"

/* ---- what it is made from and how: from a command line, or from the header of an existing store ---- */

enum { terrain_paths_size = 16384, terrain_path_size = 4096 };

typedef struct TerrainOptions {
    /* lists of files and folders, separated by commas; empty: none */
    char elevation[terrain_paths_size], surface[terrain_paths_size], cover[terrain_paths_size],
        photo[terrain_paths_size], canopy_height[terrain_path_size], canopy_cover[terrain_path_size];
    char buildings[terrain_path_size]; /* GeoJSON that the buildings of surface models are written to; empty: they are
                                          roofs of the ground */
    char cover_table[terrain_path_size], geoid[terrain_path_size]; /* cover_table: empty: chosen; geoid: empty: EGM96 */
    char unit[16], srs[128],
        nodata[32]; /* what elevation and surface files are taken to have where nothing stands after their name */
    char sources_from[terrain_path_size]; /* folders of files that other files name (raster_sources_from) */
    ElevationVertical vertical;
    double            spacing_m;     /* 0: the posting of the finest data */
    double            origin_deg[2]; /* latitude, longitude; NaN: middle of the finest data */
    double            size_km[2];    /* 0: as large as the data */
    double            horizon_km;
    double            most_gb; /* most gigabytes that may be written; decoding may take 64 times as much */
} TerrainOptions;

void terrain_options_default(TerrainOptions *out);
/* One option by its name: elevation (added to those before), surface, cover, cover-table, photo, canopy-height,
 * canopy-cover, buildings, geoid, sources-from, vertical, unit, srs, nodata, spacing, origin, size, horizon, most-gb.
 * False: *why says what is accepted, in static storage, and nothing has changed. */
bool terrain_options_set(TerrainOptions *o, const char **why, const char *name, const char *value);
/* The names in a list of elevation or surface files, each followed by what the options choose for it (raster.h).
 * Returns false when that is too long. */
bool terrain_options_sources(char *out, size_t out_size, const TerrainOptions *o, const char *list);
/* What is missing or contradictory in the options, in static storage; NULL: nothing. */
const char *terrain_options_fault(const TerrainOptions *o);
/* The options as text: a line `name value` each, with absolute paths; those with their default value are left out.
 * Returns false when that is too long. */
bool terrain_options_text(char *out, size_t out_size, const TerrainOptions *o);
/* Reads the text of a store's header. Returns false with *why, and *line counted from 1. */
bool terrain_options_parse(TerrainOptions *out, const char **why, int *line, const char *text);

/* ---- the import ---------------------------------------------------------------------------------- */

/* Is called a few times a second at most, by the import's thread; and once before the work, with a line that says how
 * much there is to do, and a share of -1. Returns false to stop the import, which then leaves nothing behind. */
typedef bool TerrainProgress(void *user, const char *stage, double share);

typedef struct TerrainWatch {
    TerrainProgress *progress; /* NULL: the import is never stopped */
    void (*heard)(void                  *user,
                  const ElevationSurvey *survey); /* called for each grid of heights before it is used; may be NULL */
    void *user;
} TerrainWatch;

typedef struct TerrainReport {
    ElevationReport elevation;
    StoreReport     store;
    bool            apart, beside;   /* whether a surface model was taken apart, and with a terrain model beside it */
    int             nx, ny;          /* posts of level 0 */
    CoverReport     cover;           /* posting_m 0: there is no cover */
    double          photo_posting_m; /* 0: there is no photograph */
    double          canopy_scale_m;  /* unit of the numbers in a canopy height file; 0: there is none */
    int             records;         /* buildings that TerrainOptions.buildings has */
    int             records_left;    /* patches of roof that made no outline */
    double          kind_share[3];   /* shares of the posts: bare, building, tree */
    double          seconds[4]; /* time of each stage: levels around level 0, posts, cover and photograph, writing */
    bool            stopped;    /* whether the progress function stopped it */
} TerrainReport;

/* pool NULL: one thread. watch may be NULL. Failures are logged with the file and the next step; PATH is replaced
 * only by a whole store. */
Status terrain_import(TerrainReport *out, const TerrainOptions *options, const char *path, Pool *pool,
                      const TerrainWatch *watch);
/* Makes a store again with the options that it has, on all processors. options: as TerrainStore or store_recall has
 * them. A store may come from a stranger: only what lies in its own folder is read, also of what those files name, and
 * its file of buildings replaces only one that an import wrote there; anywhere: whatever it names. A requested stop
 * ends it, and leaves the store as it was. */
Status terrain_store_rebuild(const char *path, const char *options, bool anywhere);
/* Whether a store's options name a source outside of its own folder. outside: the first such source. */
bool terrain_store_foreign(char *outside, size_t outside_size, const char *path, const char *options);

/* ---- buildings ----------------------------------------------------------------------------------- */

/* Counts buildings row by row, as connected parts of cells, whether they have courtyards or not. */
typedef struct TerrainBuildings {
    long count;            /* buildings in all rows so far */
    int  labels;           /* labels used in the last row */
    int *label;            /* [nx] labels of the last row; 0: no building */
    int *parent, *compact; /* [2 nx + 2] */
} TerrainBuildings;

/* Counts the next row, of CellKind. Cells that touch only at a corner are not connected. out must be zeroed at first.
 * */
Status terrain_buildings_count(TerrainBuildings *out, int nx, const uint8_t *kind);
void   terrain_buildings_free(TerrainBuildings *count); /* accepts zeroes */

#endif
