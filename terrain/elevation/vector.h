/* terrain/elevation/vector.h: points, lines and polygons with attributes, of GeoJSON, Shapefile, GeoPackage and
 * FlatGeobuf files, as the confined process reads them that reads rasters (raster.h). */
#ifndef TERRAIN_ELEVATION_VECTOR_H
#define TERRAIN_ELEVATION_VECTOR_H

#include "pitviper.h"

typedef enum VectorShape { VECTOR_POINT, VECTOR_LINE, VECTOR_POLYGON } VectorShape;

enum { vector_most_tags = 96, vector_most_corners = 65536, vector_most_rings = 256 };

/* A feature, or one part of a feature of several. */
typedef struct VectorPart {
    VectorShape shape;
    int         corners;                 /* of a polygon's outer ring, not closed; 0: more than vector_most_corners */
    const double (*lon_lat_rad)[2];      /* [corners]; NaN where there is no such place on the Earth */
    int            holes;                /* inner rings of a polygon */
    int            rings;                /* of them handed out: those that fit, at most vector_most_rings */
    const int32_t *ring;                 /* [rings]: corners of each, >= 3 */
    const double (*ring_lon_lat_rad)[2]; /* one after the other; at most vector_most_corners */
    int         file, part;              /* number of the file in the list; of the part in its feature */
    int64_t     number;                  /* of the feature among all, from 0 */
    int         tags;
    const char *name[vector_most_tags], *value[vector_most_tags];
} VectorPart;

/* How many features: all that were looked at; outside the box (those that a file's index left out); without a point,
 * line or polygon. */
typedef struct VectorEnd {
    int64_t features, outside, shapeless;
} VectorEnd;

typedef struct Vectors {
    double              box_deg[4]; /* about all of them: west, south, east, north; NaN: none */
    int                 files, layers;
    struct RasterChild *child; /* private */
} Vectors;

/* files: separated by commas, each with `@srs=EPSG:nnnn` behind it where it does not say its coordinate system. An
 * unusable file is one logged line of `key` with a remedy, and STATUS_IO or STATUS_BAD_VALUE. Nothing but local files,
 * and archives by /vsizip/FILE.zip/NAME, is opened. */
Status vectors_open(Vectors *out, const char *files, const char *key);
void   vectors_close(Vectors *vectors); /* accepts zeroes */

/* Hands every part that reaches into a box (degrees; NaN: all) to take, in the files' order, until it fails; once. Its
 * arrays last until take returns. More than vector_most_parts: STATUS_BAD_VALUE, logged. */
enum { vector_most_parts = 1 << 25 };
typedef Status VectorTake(void *user, const VectorPart *part);
Status         vectors_each(VectorEnd *end, Vectors *vectors, const double box_deg[4], VectorTake *take, void *user,
                            const char *key);

/* Reads the part at *at of a reply, and moves *at behind it. False: no reader sends such octets. data: aligned as a
 * double; it lasts as long as the part. */
bool vector_part_read(VectorPart *out, size_t *at, const uint8_t *data, size_t octets);

#endif
