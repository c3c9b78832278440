/* terrain/import/terrain_import_private.h: a terrain store in the making: shared by the files of this folder.
 *
 * terrain_import.c   the plan, the levels, and the end
 * terrain_cover.c    what covers the ground
 * ground_rows.c      pixels of files in rows of cells
 * surface_strip.c    strips of a surface model taken apart, and buildings counted in them
 * import_buildings.c buildings of all strips as records, on the ground of the store */
#ifndef TERRAIN_IMPORT_TERRAIN_IMPORT_PRIVATE_H
#define TERRAIN_IMPORT_TERRAIN_IMPORT_PRIVATE_H

#include "terrain/bare_earth/take_apart.h"
#include "terrain/culture/culture.h"
#include "terrain/elevation/raster.h"
#include "terrain/import/terrain_import.h"
#include "terrain/surface.h"

/* ---- ground_rows.c: codes of land cover, colours of a photograph, numbers, in rows of square cells of ENU. Each call
 * reads the part of the files that its rows need ---- */

/* Rows of cells; x0_m, y0_m: south-west corner of the first row. */
typedef struct CellRows {
    int    nx, rows;
    double x0_m, y0_m, cell_m;
} CellRows;

/* ENU z of the ground at a place: pixels are looked up where the ground is, not where the plane is. */
typedef double GroundZ(void *user, double x_m, double y_m);

typedef struct GroundView {
    const LocalFrame *frame;
    GroundZ          *z;
    void             *z_user;
    Pool             *pool;
    const char       *key; /* for messages */
} GroundView;

/* Gives each cell without a value (coverage 0, NaN) the value of the first raster of the set that has one. code: one
 * more than the file's; 0: none. The file's code 0 gives way to other files' codes; codes from surface_codes_most on
 * count as none. band 0: the band named for a sheet, else the first. */
Status ground_rows_codes(uint16_t *code, const RasterSet *set, int band, const CellRows *cells, const GroundView *view);
/* [rows][nx][4], sRGB and coverage: bilinear in linear light, or averaged where pixels are finer than cells. */
Status ground_rows_colours(uint8_t *rgba, const RasterSet *set, const CellRows *cells, const GroundView *view);
Status ground_rows_numbers(float *value, const RasterSet *set, int band, const CellRows *cells, const GroundView *view);

/* A strip of a surface model, resampled to posts and taken apart on all threads. */

typedef struct SurfaceSources {
    ElevationStream  *surface;
    ElevationStream  *bare;  /* terrain model on the same levels; NULL: there is none */
    const RasterSet  *photo; /* NULL: none */
    const LocalFrame *frame;
    Pool             *pool;
    bool              buildings; /* whether they are wanted as records, with bare ground below them */
} SurfaceSources;

/* Rows of level 0, [rows][nx], and crowns in ENU, which are allocated. */
typedef struct SurfaceStrip {
    float   *h_m;      /* heights above the ellipsoid of bare ground, and of roofs unless buildings are records */
    uint8_t *kind;     /* CellKind */
    float   *canopy_m; /* height of the surface above bare ground where kind is CELL_TREE; 0 elsewhere */
    int      crowns;
    Crown   *crown;
    Culture  culture;              /* buildings in ENU, their base_m above the ellipsoid */
    long     voids, voids_coarser; /* posts filled from their surroundings, and from a coarser file */
} SurfaceStrip;

/* Makes a strip. Strips may be of any height and come in any order, with the same posts as a result
 * (take_apart_reach_m). */
Status surface_strip_make(SurfaceStrip *out, const SurfaceSources *from, int row0, int rows);
void   surface_strip_free(SurfaceStrip *strip); /* accepts zeroes */

/* ---- the import ---- */

/* A store in the making: its sources, and what is known of it so far. */
typedef struct StoreImport {
    const TerrainOptions *o;
    Pool                 *pool;
    TerrainWatch          watch;
    double                told_s, keep_octets;
    LocalFrame            frame;
    ElevationFiles        files[2];                  /* of the terrain model, of the surface model */
    ElevationStream      *terrain, *surface, *first; /* first: the one of both whose levels are made */
    RasterSet             opened;                    /* files of `first`, until it has taken them over */
    RasterSet             cover, photo, canopy_height, canopy_cover;
    SurfaceTable          table;
    int                   cover_band;
    StorePlan             plan;
    StoreSource          *source;
    char        *list[2]; /* names of the terrain model and of the surface model, with what the options say of them */
    char        *options, notes[2048], datum[256], folder[terrain_path_size];
    StoreWriter *writer;
    StreamLevel  level;
    int          strip_rows;
    long         kinds[3];
    TerrainBuildings buildings;
    Culture          culture; /* of all strips so far, as SurfaceStrip has it */
    long             voids, voids_coarser;
    TerrainReport    r;
} StoreImport;

/* ---- import_buildings.c ---- */

/* Adds all records of buildings. */
Status import_buildings_add(Culture *to, const Culture *from);
/* Writes them as GeoJSON, from south to north, on the floors that the ground of the store gives them, with the eaves
 * and ridges where they were. */
Status import_buildings_write(StoreImport *m, const TerrainStore *store);

/* ---- terrain_cover.c ---- */

/* The finest posting of a set; 0 when it is empty. */
double import_finest_m(const RasterSet *set);
/* Finds the unit of the canopy's heights. */
Status import_canopy_look(StoreImport *m);
/* Import the wide window of classes, then classes, photograph and canopy beside rows of level 0. strip: of a surface
 * model; NULL: there is none. */
Status import_cover_wide(StoreImport *m);
Status import_cover(StoreImport *m, int row0, int rows, const SurfaceStrip *strip);
Status import_albedo(StoreImport *m, int row0, int rows);
Status import_canopy(StoreImport *m, int row0, int rows, const SurfaceStrip *strip);

#endif
