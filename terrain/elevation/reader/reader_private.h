/* terrain/elevation/reader/reader_private.h: the process that reads rasters with GDAL for the program (raster_wire.h): its
 * parts. GDAL's messages are captured, not printed: one log line has them, with a remedy, and goes to the program. */
#ifndef TERRAIN_ELEVATION_READER_READER_PRIVATE_H
#define TERRAIN_ELEVATION_READER_READER_PRIVATE_H

#include "terrain/elevation/raster.h"
#include "terrain/elevation/raster_wire.h"

/* ---- reader_set.c: sets of files, and what they are; as raster.h has it ---- */

/* Before the process is confined: drivers registered, what GDAL looks up once looked up. */
Status reader_prepare(void);
Status reader_set_open(RasterSet *out, const char *paths, const char *key);
void   reader_set_close(RasterSet *set);
void   reader_quiet(void); /* GDAL's messages are kept for reader_reason */
void   reader_loud(void);
/* GDAL's reason for the last failure, or a default text. */
const char *reader_reason(const char *else_text);
/* The next of a list of names with commas between; false: the end, or (*long_name) one that is too long. */
bool   reader_next_name(char out[wire_path_size], const char **at, bool *long_name);

/* ---- reader_stated.c ---- */

/* file: GDAL's dataset; crs: its coordinate system, or what the user named in its place, whole, with its vertical part. */
void   reader_state(RasterStated *out, void *file, int band, void *crs);

/* ---- reader_pixels.c: as raster.h has it; windows that fit into a channel ---- */

void   reader_px_from_earth(const Raster *raster, int count, double *lon_to_x, double *lat_to_y);
void   reader_earth_from_px(const Raster *raster, int count, double *x_to_lon, double *y_to_lat);
Status reader_read(float *out, const Raster *raster, int band, int x0, int y0, int width, int height, const char *key);
Status reader_read_bytes(uint8_t *out, uint8_t *valid, const Raster *raster, int first_band, int bands, int x0, int y0,
                         int width, int height, const char *key);

/* ---- reader_sparse.c: what need not be read ---- */

bool   reader_uniform(float *value, const Raster *raster, int band, int x0, int y0, int width, int height, const char *key);

/* ---- reader_source.c: which files GDAL may be given: it opens by name ---- */

/* within: nothing else; from: folders below which files may lie that others name, separated by commas. Empty: none. */
void   reader_source_begin(const char *within, const char *from);
/* Folders and files that the named ones need, to be opened at all: allocated, NULL at the end; NULL: no memory. */
char **reader_source_folders(const char *paths);
/* Names of files beside and within which it would look are good when they are regular files (GDAL waits for a FIFO), or when
 * it is no file's name (a subdataset, a file in an archive), which is GDAL's own. Else it is logged as key's. */
bool   reader_file_allowed(const char *path, const char *key);
/* The same of a file that `owner`, which the user named, leads to. */
bool   reader_part_allowed(const char *path, const char *owner, const char *key);
/* Whether what any part names itself must be looked at by name: nothing else would stop it, or say where it lies. */
extern bool reader_by_name;

/* ---- reader_main.c ---- */

/* A sign of life: this file is worked at now. */
void   reader_works_at(const char *path);

#endif
