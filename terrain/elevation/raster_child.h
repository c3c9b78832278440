/* terrain/elevation/raster_child.h: the processes that read the program's rasters (terrain/elevation/reader), and what
 * both say to each other.
 *
 * The program starts one process, `pitviper-rasters`, which loads GDAL and opens no file of the user's; it is asked,
 * over its first descriptor after the usual three, for a process for each set (WireOrder), and forks it. A channel is
 * a pair of connected sockets and a piece of shared memory. The program writes a request there and sends an octet; the
 * reader writes the reply, what it would log, and data, and sends one back. A channel carries one request at a time;
 * there are several so that threads read at once. The reader believes the program. The program copies each reply
 * before it looks at it, and believes nothing: the reader has parsed other people's files. */
#ifndef TERRAIN_ELEVATION_RASTER_CHILD_H
#define TERRAIN_ELEVATION_RASTER_CHILD_H

#include "pitviper.h"

enum {
    wire_channels = 8,
    wire_orders = 3,                      /* descriptor on which orders arrive */
    wire_descriptors = wire_channels + 1, /* descriptors sent with WIRE_START: the sockets, then the memory */
    wire_most_rasters = 4096,
    wire_most_sheets = 65536, /* most sheets of all rasters */
    wire_path_size = 4096,
    wire_key_size = 128,
    wire_log_octets = 16384,
    wire_data_octets = 4 << 20,
};

typedef enum WireOrderKind {
    WIRE_START, /* starts a process for a set; answer: its process id, or minus the error */
    WIRE_END,   /* ends a process; answer: its status as waitpid gives it */
} WireOrderKind;

typedef struct WireOrder {
    int32_t kind, process;
} WireOrder;

typedef enum WireAsk {
    WIRE_OPEN, /* data: texts, each with its 0: current folder, paths, folder, folders (raster_set.c). count: number of
                  rasters */
    WIRE_RASTER,        /* data: WireRaster of `raster` */
    WIRE_SHEETS,        /* data: sheets of `raster` from number `first` on, as many as fit; count: how many */
    WIRE_PX_FROM_EARTH, /* data: x[count], y[count], which the answer replaces */
    WIRE_EARTH_FROM_PX,
    WIRE_READ,       /* data: float [height][width], unless the window is uniform, in which case `value` is all of it */
    WIRE_READ_BYTES, /* data: uint8_t [height][width][count], then valid [height][width] */
    WIRE_UNIFORM,    /* whether a window of any size is known to be uniform without being read */
    WIRE_VECTORS,    /* in place of WIRE_OPEN: texts as there, of files with vectors; the answer's data: WireVectors */
    WIRE_FEATURES,   /* data: WireBox; the answer's: the next `count` parts of features that reach into it, each a
                        WireFeature; of the files of WIRE_VECTORS in their order. count 0: the end, and WireEnd */
} WireAsk;

typedef struct WireRequest {
    uint32_t ask;
    int32_t  raster, first, count; /* first, count: numbers of bands, sheets or places */
    int32_t  x0, y0, width, height;
    double   low, high; /* pixels outside of this range are voids */
    char     key[wire_key_size];
} WireRequest;

typedef struct WireReply {
    int32_t status; /* Status */
    int32_t count;
    int32_t uniform;
    float   value;
} WireReply;

/* Of a Raster, what it means (raster.h), what its file says of its numbers, and what the user
 * does (raster.h). */
typedef struct WireRaster {
    double  posting_m[2], metres_per_unit, data_share, crs_unit_m, nodata, void_value;
    int32_t width, height, bands, vertical, order, row_block, sheet_count, band, sense;
    uint8_t ellipsoidal, bytes, whole, sparse, unit_of_crs, down, coloured, grey, has_nodata, has_void, no_void;
    char    type[16], unit[32], crs[80], crs_unit[32], vertical_name[80], chosen_unit[16];
} WireRaster;

/* Followed by the path with its 0, to a whole number of 8 octets. */
typedef struct WireSheet {
    int32_t x0, y0, width, height, band, path_octets;
} WireSheet;

/* Longitudes and latitudes, degrees: west, south, east, north. */
typedef struct WireBox {
    double deg[4];
} WireBox;

typedef struct WireVectors {
    WireBox box; /* about all layers; NaN: there is none */
    int32_t files, layers;
} WireVectors;

typedef enum WireShape { WIRE_POINT, WIRE_LINE, WIRE_POLYGON, WIRE_SHAPES } WireShape;

enum { wire_most_rings = 256, wire_most_corners = 65536, wire_most_tags = 96, wire_most_texts = 65536 };

/* A point, a line or a polygon, whole or as a part of a feature of several; behind it corners x { longitude, latitude }
 * (double, rad), those of its inner rings one after the other, their numbers of corners (int32_t, to a whole number of
 * 8 octets), then tags x { name, value }, each text with its 0, to a whole number of 8 octets. A longer line is sent as
 * several that share their ends. */
typedef struct WireFeature {
    uint32_t octets;              /* all of it */
    int32_t  shape;               /* WireShape */
    int32_t  corners;             /* of a polygon's outer ring, not closed; 0: it has more than wire_most_corners */
    int32_t  holes;               /* its inner rings */
    int32_t  tags, texts;         /* texts: octets of the names and values */
    int32_t  file, part;          /* number of the file; of the part in its feature */
    int64_t  number;              /* number of the feature among all that were looked at, from 0 */
    int32_t  rings, ring_corners; /* inner rings that are sent, and all their corners, not closed */
} WireFeature;

typedef struct WireEnd {
    int64_t features;  /* all that were looked at */
    int64_t outside;   /* features outside the box, and without a place, where a file knows how many it has */
    int64_t shapeless; /* features without a geometry, or with one that is no point, line or polygon */
} WireEnd;

typedef struct WireChannel {
    WireRequest request;
    WireReply   reply;
    uint64_t    alive;              /* increases while a request is worked at, at each file */
    char        at[wire_path_size]; /* the file that the reader works at */
    char log[wire_log_octets]; /* log lines, each a LogLevel as a digit, its text, and a 0; an empty line is the last */
    _Alignas(64) uint8_t data[wire_data_octets];
} WireChannel;
_Static_assert(sizeof(WireFeature) % 8 == 0, "corners behind it are aligned");

/* ---- the process that reads a set: started, asked, and given up when it ends or does not answer ---- */

enum { raster_most_memory_mb = 4000 }; /* most memory of the reader besides its libraries */

typedef struct RasterChild RasterChild;

/* Some 50 ms. STATUS_IO, logged. */
Status raster_child_start(RasterChild **out, const char *key);
void   raster_child_stop(RasterChild *child); /* accepts NULL; no request may be under way */

/* Returns a channel that no thread uses; waits for one. */
WireChannel *raster_child_take(RasterChild *child);
void         raster_child_give(RasterChild *child, WireChannel *channel);
/* The channel's request, answered: what the reader had to say is logged, and the reply copied. STATUS_IO: the reader
 * has ended or did nothing for too long, which is logged once and ends it for good, or a stop was asked for
 * (work_stop_when). Status of the reply itself: reply->status, one of Status. */
Status raster_child_ask(RasterChild *child, WireChannel *channel, WireReply *reply);
/* Call when a reply cannot be what a reader sends: logs that once, and ends the reader. Returns STATUS_BAD_VALUE. */
Status raster_child_distrust(RasterChild *child, WireChannel *channel);

/* For tests. Sets the seconds without a sign of life after which a reader is given up (0: the default, 120), and the
 * program to be started in place of pitviper-rasters (NULL: that one); no set may be open. */
void raster_child_patience(double s);
void raster_child_program(const char *path);

#endif
