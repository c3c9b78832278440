/* terrain/landscape/elevation_stream.h: terrain from elevation files, level 0 a strip of rows at a time: the same posts as
 * elevation_import gives, for levels larger than memory.
 *
 * Between opening and elevation_stream_begin it is known how much there is to do. The levels around level 0 are whole in memory. Strips may overlap and come in any order; a strip reads its part of the
 * files, and takes 5 octets a pixel of it and 4 a post. */
#ifndef TERRAIN_LANDSCAPE_ELEVATION_STREAM_H
#define TERRAIN_LANDSCAPE_ELEVATION_STREAM_H

#include "terrain/elevation/raster.h"
#include "terrain/landscape/elevation_import.h"

typedef struct ElevationStream ElevationStream;

/* One level: post (i, j) is at ((i0 + i) spacing_m, (j0 + j) spacing_m) of ENU. */
typedef struct StreamLevel {
    double       spacing_m;
    int          i0, j0, nx, ny;
    const float *z_m; /* ENU z [ny][nx]; NULL: level 0 */
} StreamLevel;

/* Which files there are, and the levels that show them; the heights of none. like: another stream whose levels this one takes over, for a second set of files over the same ground; NULL: none. The
 * texts of files and the pool must outlive the stream. Failures are logged. */
Status elevation_stream_open(ElevationStream **out, const ElevationFiles *files, const LocalFrame *frame,
                             const ElevationStream *like, Pool *pool);
/* Heights of the levels around level 0, which all that follows needs: reads the files once. keep_octets: of decoded rows
 * that may lie in files->keep_folder meanwhile. */
Status elevation_stream_begin(ElevationStream *stream, double keep_octets);
/* Pixels that this reads, at most. */
double elevation_stream_reads_px(const ElevationStream *stream);
void   elevation_stream_close(ElevationStream *stream); /* accepts NULL */
const RasterSet *elevation_stream_files(const ElevationStream *stream);
int    elevation_stream_levels(const ElevationStream *stream);
void   elevation_stream_level(StreamLevel *out, const ElevationStream *stream, int level);
/* Heights above the ellipsoid of rows of level 0, h_m [rows][nx]. from_file, may be NULL, [rows][nx]: 1 where the post
 * is of the files, 2 in a void of theirs filled from its surroundings, 3 from a coarser file, 0 beyond them. counted: the voids and samples of these rows are added to the
 * report: true once for each row, from the south. */
Status elevation_stream_heights(ElevationStream *stream, int row0, int rows, float *h_m, uint8_t *from_file, bool counted);
/* In place: to ENU z, blended into level 1 near the outline. */
Status elevation_stream_bend(const ElevationStream *stream, int row0, int rows, float *h_m);
/* Surface of the levels from 1 on; 0 beyond them. */
double elevation_stream_around(const ElevationStream *stream, double x_m, double y_m);
/* What is known of the files so far; with the stored surface (NULL: not yet) also the error. */
Status elevation_stream_report(ElevationReport *out, const ElevationStream *stream, const Elevation *stored);

/* Middle of the finest of the files, without a stream; opened: the files, for ElevationFiles. */
Status elevation_middle(Geodetic *out, RasterSet *opened, const char *paths);

#endif
