/* terrain/landscape/elevation_import.h: terrain from elevation files, as nested levels in ENU.
 *
 * Every post is curved into ENU: the vertical line of the ENU plane through (x, y) is followed to where the file's
 * own surface, bilinear between its posts and raised by the geoid at that latitude and longitude, crosses it. Beyond
 * the data the surface leads over, within blend_m, to their edge's mean height above the ellipsoid; where a finer
 * grid ends within a coarser one, within eight of the coarser's posts. Inside a grid nothing is blended. */
#ifndef TERRAIN_LANDSCAPE_ELEVATION_IMPORT_H
#define TERRAIN_LANDSCAPE_ELEVATION_IMPORT_H

#include "terrain/landscape/elevation_survey.h"
#include "terrain/landscape/landscape.h"

typedef enum ElevationVertical {
    ELEVATION_BY_FILE,     /* above the ellipsoid where the CRS is three-dimensional, else above the geoid */
    ELEVATION_GEOID,
    ELEVATION_ELLIPSOID
} ElevationVertical;

typedef struct ElevationFiles {
    const char       *paths;      /* files and folders, separated by commas */
    struct RasterSet *opened;     /* the same, opened already: taken over; NULL, or empty: they are opened */
    const char       *geoid_path; /* empty: EGM96 of proj-data */
    ElevationVertical vertical;
    double            spacing_m;  /* of level 0; 0: the posting of the finest data at the origin */
    double            horizon_m;  /* half width of the outermost level */
    double            size_m[2];  /* width of level 0, about the origin, x and y; 0: all data */
    const char       *keep_folder; /* large files are decoded once into a nameless file here; NULL: as often as needed */
    void            (*heard)(void *user, const ElevationSurvey *survey); /* of each grid, before its use; NULL: it is not told */
    void             *heard_user;
} ElevationFiles;

typedef struct ElevationReport {
    int    sheets, grids;         /* files, and groups of them that share a grid */
    double posting_m;             /* of the grid that level 0 shows */
    double spacing_m, width_m[2]; /* of level 0 */
    double reach_m[2];            /* from the origin to the nearest and to the farthest edge of the data */
    double blend_m, beyond_h_m;   /* beyond them */
    bool   ellipsoidal;           /* heights of that grid were taken as above the ellipsoid */
    double geoid_m;               /* N at the origin, where it was added */
    long   voids;                 /* posts of that grid on level 0 filled from their surroundings */
    long   voids_coarser;         /* and from coarser grids, where it was counted (elevation_stream.h) */
    /* |surface - file| over places of that grid on level 0, voids left out: what resampling cost. The
     * largest is that of 100 000 such places and as many posts; others may exceed it a little. */
    int    places;
    double error_rms_m, error_p99_m, error_max_m;
    double correction_m;          /* largest change by the fit to fixes; 0: none */
} ElevationReport;

/* fix: ground places to lead the surface through by a smooth correction (fix_count 0: none). Failures are logged with
 * the file and what to do. Memory: level 0 has at most 36 M posts. */
Status elevation_import(Elevation *out, ElevationReport *report, const ElevationFiles *files, const LocalFrame *frame,
                        const GroundFix *fix, int fix_count);

#endif
