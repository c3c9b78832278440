/* terrain/elevation/reader/reader_private.h: the process that reads rasters with GDAL for the program
 * (raster_child.h): its parts. GDAL's messages are captured, not printed: one log line has them, with a remedy, and
 * goes to the program. */
#ifndef TERRAIN_ELEVATION_READER_READER_PRIVATE_H
#define TERRAIN_ELEVATION_READER_READER_PRIVATE_H

#include "pitviper_library.h"
#include "terrain/elevation/raster.h"
#include "terrain/elevation/raster_child.h"

#include <gdal.h>
#include <ogr_srs_api.h>
#include <pthread.h>

/* ---- gdal_library.c ---- */

/* Registers GDAL's drivers and loads the tables that GDAL looks for once. Call it before the process is confined. */
Status reader_prepare(void);
void   reader_quiet(void); /* GDAL's messages are kept for reader_reason */
void   reader_loud(void);
/* GDAL's reason for the last failure, or a default text. */
const char *reader_reason(const char *else_text);

/* ---- reader_sheet.c: what a file is ---- */

/* The properties that decide whether sheets share a grid. */
typedef struct SheetOpened {
    double               transform[6];
    int                  width, height, bands;
    bool                 ellipsoidal, bytes, whole;
    double               metres_per_unit;
    int                  row_block;
    RasterStated         stated;
    RasterChoice         choice;
    OGRSpatialReferenceH crs;
} SheetOpened;

/* Sets path to the grid that is asked for among the grids of a file. Returns false, logged, when the file has no such
 * grid, or when none is asked for. */
bool reader_choose_part(char path[wire_path_size], GDALDatasetH file, const char *asked, const char *key);
/* Failures are logged. The caller destroys out->crs. */
Status reader_describe(SheetOpened *out, GDALDatasetH file, const RasterChoice *choice, const char *path,
                       const char *key);

/* ---- reader_set.c: sets of files; as raster.h has it ---- */

Status reader_set_open(RasterSet *out, const char *paths, const char *key);
/* The next of a list of names with commas between; false: the end, or (*long_name) one that is too long. */
bool reader_next_name(char out[wire_path_size], const char **at, bool *long_name);

/* ---- reader_pixels.c: as raster.h has it; windows that fit into a channel ---- */

/* Handles of one file, so that threads read at once and GDAL's cache of blocks lasts from one read to the next. */
enum { handles = 8, most_open_sheets = 48 };
typedef struct RasterOpen {
    pthread_mutex_t lock[handles];
    GDALDatasetH    file[handles];
} RasterOpen;

void   reader_px_from_earth(const Raster *raster, int count, double *lon_to_x, double *lat_to_y);
void   reader_earth_from_px(const Raster *raster, int count, double *x_to_lon, double *y_to_lat);
Status reader_read(float *out, const Raster *raster, int band, RasterWindow window, const char *key);
Status reader_read_bytes(uint8_t *out, uint8_t *valid, const Raster *raster, int first_band, int bands,
                         RasterWindow window, const char *key);

/* As raster_uniform; nothing is read. */
bool reader_uniform(float *value, const Raster *raster, int band, RasterWindow window, const char *key);
/* How many pixels of a file lie in blocks that the file has. */
double reader_data_px(GDALDatasetH file);

/* ---- reader_vector.c: files with vectors; one set in a process, asked by one thread at a time ---- */

/* paths: as raster_set_open has them; of the choices after a name `@srs=` alone is heeded. Failures are logged. */
Status reader_vectors_open(WireVectors *out, const char *paths, const char *key);
/* Fills data (wire_data_octets) with the next parts of features that reach into a box; count 0: a WireEnd. */
Status reader_features(uint8_t *data, int32_t *count, const WireBox *box, const char *key);

/* ---- reader_foreign.c ---- */

/* What is to be done with terrain of a kind that is not read (OpenFlight, 3D Tiles, CDB); NULL: it is none of these. */
const char *reader_foreign(const char *path);

/* ---- reader_source.c: which files GDAL may be given: it opens by name ---- */

/* Sets what reader_file_allowed accepts. within: the only folder whose files are read; from: folders below which files
 * may lie that other files name, separated by commas. Empty: none. */
void reader_source_begin(const char *within, const char *from);
/* Folders and files that the named ones need, to be opened at all: allocated, NULL at the end; NULL: no memory. */
char **reader_source_folders(const char *paths);
/* Whether a name may be opened: it, and the files that GDAL would look for beside it, are regular files (GDAL waits for
 * a FIFO), or it is one of GDAL's own names (a subdataset, a file in an archive). If not, that is logged as key's. */
bool reader_file_allowed(const char *path, const char *key);
/* The same of a file that is named in `owner`, a file named by the user. */
bool reader_part_allowed(const char *path, const char *owner, const char *key);
/* Whether the names in a file must be checked by name, because nothing else would stop or locate them. */
extern bool reader_by_name;

/* ---- reader_main.c ---- */

/* Gives a sign of life, and says that this file is worked at now. */
void reader_works_at(const char *path);

#endif
