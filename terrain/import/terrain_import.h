/* terrain/import/terrain_import.h: a terrain store from any set of files that GDAL reads.
 *
 * Level 0 is made in strips of rows: memory grows with a strip (some 200 MB for 12 000 posts a row, twice that where a
 * surface model is taken apart), never with the whole. The same store for any number of threads. */
#ifndef TERRAIN_IMPORT_TERRAIN_IMPORT_H
#define TERRAIN_IMPORT_TERRAIN_IMPORT_H

#include "terrain/import/options.h"
#include "terrain/store/store.h"

/* Called some times a second at most, by the thread of the import; once, before the work, with a line that says how much there is
 * to do, and a share of -1. False: stop, and leave nothing behind. */
typedef bool TerrainProgress(void *user, const char *stage, double share);

typedef struct TerrainWatch {
    TerrainProgress *progress;                                   /* NULL: never stopped */
    void (*heard)(void *user, const ElevationSurvey *survey);    /* of each grid of heights, before it is used; NULL: it is not told */
    void *user;
} TerrainWatch;

typedef struct TerrainReport {
    ElevationReport elevation;
    StoreReport     store;
    bool            apart, beside;      /* a surface model was taken apart; with a terrain model beside it */
    int             nx, ny;             /* posts of level 0 */
    CoverReport     cover;              /* posting_m 0: none */
    double          photo_posting_m;    /* 0: none */
    double          canopy_scale_m;     /* of a canopy height file's numbers; 0: none */
    double          kind_share[3];      /* of the posts: bare, building, tree */
    double          seconds[4];         /* levels around, posts, cover and photograph, writing */
    bool            stopped;            /* by the progress function */
} TerrainReport;

/* pool NULL: one thread. watch may be NULL. Failures are logged with the file and the next step; PATH is replaced
 * only by a whole store. */
Status terrain_import(TerrainReport *out, const TerrainOptions *options, const char *path, Pool *pool,
                      const TerrainWatch *watch);
/* Makes a store again with the options that it has, on all processors. options: as TerrainStore or store_recall has
 * them. A store may come from a stranger: only what lies in its own folder is read, also of what those files name;
 * anywhere: whatever it names. A requested stop ends it, and leaves the store as it was. */
Status terrain_store_rebuild(const char *path, const char *options, bool anywhere);
/* Whether its options name a source outside its own folder; outside: the first. */
bool   terrain_store_foreign(char *outside, size_t outside_size, const char *path, const char *options);

#endif
