/* terrain/from_files/culture_import.h: buildings, walls, roads, poles and trees of files, as records of culture.
 *
 * Files with vectors (terrain/elevation/vector.h) in any coordinate system, with OpenStreetMap's tags or heights of
 * their own (etc/culture_tags.csv says what each attribute means), and tables of trees. etc/reference/terrain.md,
 * "Buildings and roads", states what stands for what they do not say. */
#ifndef TERRAIN_FROM_FILES_CULTURE_IMPORT_H
#define TERRAIN_FROM_FILES_CULTURE_IMPORT_H

#include "terrain/culture/culture.h"
#include "terrain/earth/geodesy.h"

/* ENU z of the ground at a place; NaN: there is none. */
typedef double CultureGround(void *user, double x_m, double y_m);

typedef struct CultureFiles {
    const char       *buildings, *trees; /* files with vectors, separated by commas; a table of trees. NULL, "": none */
    const LocalFrame *frame;
    CultureGround    *ground; /* NULL: ENU z of 0 everywhere */
    void             *user;
    double            half_m; /* half the side of the square about the frame's origin whose culture is wanted */
    bool              passes; /* no record of files with vectors is kept: they are read to see whether they can be */
} CultureFiles;

/* Why a feature, or a part of one, is no record. */
typedef enum CultureLeft {
    CULTURE_LEFT_OUTSIDE, /* of the square, or of the ground */
    CULTURE_LEFT_LARGE,   /* an outline of more than 1 km2, or of more than 4096 corners */
    CULTURE_LEFT_CROSSED, /* an outline that crosses itself, is smaller than 1 m2, or is not on the Earth */
    CULTURE_LEFT_OTHER,   /* land use, areas of water, parts of buildings: no record is of it */
    CULTURE_LEFT_HIDDEN,  /* in a tunnel or underground */
    CULTURE_LEFT_TWICE, /* there already: of two files, or named twice; poles and masts that a power line has itself */
    CULTURE_LEFTS
} CultureLeft;

/* Where a building's height is from. */
typedef enum HeightFrom { HEIGHT_FROM_FILE, HEIGHT_FROM_LEVELS, HEIGHT_FROM_USE, HEIGHTS_FROM } HeightFrom;

typedef struct CultureReport {
    int64_t features; /* read */
    int     left[CULTURE_LEFTS];
    int     courtyards, built_over;    /* inner rings: open to the sky; too small or entangled, and built over */
    int     mended;                    /* numbers that could not be true and were left aside: a height of 9999 m */
    int     unread;                    /* numbers that are none: `tall` */
    int     height_from[HEIGHTS_FROM]; /* buildings whose height the files state, by levels, by use and size */
    double  low_m, high_m;             /* ridges of buildings; low_m > high_m: none */
    int     trees_marked;
} CultureReport;

/* Fills *out, which is empty, and indexes it (culture_index). What is left out or mended is one logged line.
 * STATUS_IO, STATUS_BAD_VALUE: a file cannot be used, logged; then *out is empty. */
Status culture_open(Culture *out, CultureReport *report, const CultureFiles *from);
/* ENU z of the floor of a building: the lowest ground along its outline, looked at every 10 m, at most 64 times an
 * edge; NaN where there is none at one of these places. */
double culture_floor_m(const CultureFiles *from, const double (*corner_m)[2], int corners);
/* "3 outside the terrain, 1 larger than 1 km2 ..."; empty: nothing was left out. */
void culture_report_left(char *out, size_t out_size, const CultureReport *report);
/* Whether files and a table can be read, to their ends, however many records they hold; what is wrong is logged. Either
 * may be empty. */
bool culture_files_good(const char *buildings, const char *trees);
/* The middle of the files' box; false, logged: they cannot be read, or hold nothing. */
bool culture_middle(Geodetic *out, const char *files);

/* ---- names, for lists and files --------------------------------------------------------------------- */

const char *culture_use_name(int use);
const char *culture_roof_name(int roof);
const char *culture_fabric_name(int fabric);
const char *culture_line_name(int kind);
const char *culture_point_name(int kind);

/* Every record as GeoJSON in longitudes and latitudes, with its fields as properties. from: of its frame and ground
 * alone: read with these, records are where they were. */
Status culture_write_geojson(const char *path, const Culture *culture, const CultureFiles *from);

#endif
