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

/* Before the process is confined: drivers registered, what GDAL looks up once looked up. */
Status reader_prepare(void);
void   reader_quiet(void); /* GDAL's messages are kept for reader_reason */
void   reader_loud(void);
/* GDAL's reason for the last failure, or a default text. */
const char *reader_reason(const char *else_text);

/* ---- reader_sheet.c: what a file is ---- */

/* What decides whether sheets share a grid. */
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

/* The grid that is asked for of those in a file, in path; false, logged: there is none, or none was asked for. */
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

/* Without reading. */
bool reader_uniform(float *value, const Raster *raster, int band, RasterWindow window, const char *key);
/* Pixels of a file whose blocks are there. */
double reader_data_px(GDALDatasetH file);

/* ---- reader_source.c: which files GDAL may be given: it opens by name ---- */

/* within: nothing else; from: folders below which files may lie that others name, separated by commas. Empty: none. */
void reader_source_begin(const char *within, const char *from);
/* Folders and files that the named ones need, to be opened at all: allocated, NULL at the end; NULL: no memory. */
char **reader_source_folders(const char *paths);
/* Names of files beside and within which it would look are good when they are regular files (GDAL waits for a FIFO),
 * or when it is no file's name (a subdataset, a file in an archive), which is GDAL's own. Else it is logged as key's.
 */
bool reader_file_allowed(const char *path, const char *key);
/* The same of a file that `owner`, which the user named, leads to. */
bool reader_part_allowed(const char *path, const char *owner, const char *key);
/* Whether what any part names itself must be looked at by name: nothing else would stop it, or say where it lies. */
extern bool reader_by_name;

/* ---- reader_main.c ---- */

/* A sign of life: this file is worked at now. */
void reader_works_at(const char *path);

#endif
