/* terrain/from_files/elevation_import.h: real ground from files: heights looked at, made into levels (all at once, or
 * the finest a strip at a time), and with land cover and a photograph into a landscape. */
#ifndef TERRAIN_FROM_FILES_ELEVATION_IMPORT_H
#define TERRAIN_FROM_FILES_ELEVATION_IMPORT_H

#include "terrain/elevation/raster.h"
#include "terrain/ground/ground_image.h"
#include "terrain/ground/landscape.h"

/* ---- what files of heights hold, looked at before they are used ---------------------------------- */

/* Range, voids that no tag declares, unit, datum; and whether they can be heights at all.
 *
 * A void is known by being alone: up to eight numbers that lie below all others by more than ground can fall between
 * two posts. Files of up to 16 M posts are looked at whole; of larger ones 64 windows of 512 x 512 posts, the corners
 * among them, where such numbers must lie beside others, or be one of the usual ones (-9999, -999). */
enum { survey_most_voids = 8 };

typedef struct ElevationSurvey {
    const Raster *raster;        /* the raster, with its sheets, size, posting, unit and coordinate system */
    bool          whole;         /* whether every post was looked at; if not, counts are of the part that was */
    double        posts;         /* posts that were looked at */
    double        voids;         /* declared voids: nodata, masked, between sheets, or named by the user */
    double        outside;       /* posts that cannot be heights on Earth, which lie in -12 500 .. 9500 m */
    double        low_m, high_m; /* range of the remaining posts without suspected voids; NaN: there are none */
    int           suspects;      /* different numbers that are taken for voids although no tag declares them */
    double suspect[survey_most_voids], suspect_posts; /* these numbers as the file has them, in ascending order */
    double gap_m;                                     /* difference between the highest suspect and the lowest height */
    bool   ellipsoidal;                               /* heights are taken as above the ellipsoid; set by the caller */
} ElevationSurvey;

/* Looks at a raster and sets its low and high, so that suspected voids are read as voids. STATUS_BAD_VALUE, logged
 * with the option that says what is meant: a picture; an unknown unit; none beside a coordinate system in feet;
 * numbers that are no heights on Earth. Suspected voids are a warning. pool NULL: one thread. */
Status elevation_survey(ElevationSurvey *out, Raster *raster, const char *key, Pool *pool);

/* Where unit and datum come from, in words: "metre", "as the file says". In static storage or the survey's. */
void elevation_survey_words(const char **unit, const char **unit_from, const char **datum, const char **datum_from,
                            const ElevationSurvey *survey);

extern const double elevation_lowest_m,
    elevation_highest_m; /* a height below the deepest trench, and one above Everest */

/* ---- elevation as nested levels in ENU ----------------------------------------------------------- */

/* Every post is curved into ENU: the vertical line of the ENU plane through (x, y) is followed to where the file's
 * own surface, bilinear between its posts and raised by the geoid at that latitude and longitude, crosses it. Beyond
 * the data the surface leads over, within blend_m, to their edge's mean height above the ellipsoid; where a finer
 * grid ends within a coarser one, within eight of the coarser's posts. Inside a grid nothing is blended. */

typedef enum ElevationVertical {
    ELEVATION_BY_FILE, /* above the ellipsoid where the CRS is three-dimensional, otherwise above the geoid */
    ELEVATION_GEOID,
    ELEVATION_ELLIPSOID
} ElevationVertical;

typedef struct ElevationFiles {
    const char *paths; /* files and folders, separated by commas */
    struct RasterSet
               *opened; /* the same files, opened already, which are taken over; NULL, or empty: they are opened here */
    const char *geoid_path; /* file of the geoid; empty: EGM96 of proj-data */
    ElevationVertical vertical;
    double            spacing_m;   /* spacing of level 0; 0: the posting of the finest data at the origin */
    double            horizon_m;   /* half width of the outermost level */
    double            size_m[2];   /* width of level 0 in x and y, centred on the origin; 0: all data */
    const char       *keep_folder; /* folder for a nameless file into which large files are decoded once; NULL: they are
                                      decoded as often as needed */
    void (*heard)(void *user, const ElevationSurvey *survey); /* is called for each grid before its use; may be NULL */
    void *heard_user;
} ElevationFiles;

typedef struct ElevationReport {
    int    sheets, grids;         /* files, and groups of them that share a grid */
    double posting_m;             /* posting of the grid that level 0 shows */
    double spacing_m, width_m[2]; /* spacing and width of level 0 */
    double reach_m[2];            /* from the origin to the nearest and to the farthest edge of the data */
    double blend_m, beyond_h_m;   /* width of the blending beyond the data, and height beyond that */
    bool   ellipsoidal;           /* heights of level 0's grid were taken as above the ellipsoid */
    double geoid_m;               /* height of the geoid at the origin, where it was added; 0 elsewhere */
    long   voids;                 /* posts of level 0 that are voids of its grid, filled from their surroundings */
    long   voids_coarser;         /* posts filled from coarser grids, where they were counted (elevation_import.h) */
    /* |surface - file| over places of that grid on level 0, voids left out: what resampling cost. The
     * largest is that of 100 000 such places and as many posts; others may exceed it a little. */
    int    places;
    double error_rms_m, error_p99_m, error_max_m;
    double correction_m; /* largest change made by the fit to fixes; 0: no fit */
} ElevationReport;

/* fix: ground places to lead the surface through by a smooth correction (fix_count 0: none). Failures are logged with
 * the file and what to do. Memory: level 0 has at most 36 M posts. */
Status elevation_import(Elevation *out, ElevationReport *report, const ElevationFiles *files, const LocalFrame *frame,
                        const GroundFix *fix, int fix_count);

/* ---- the same posts, level 0 a strip of rows at a time, for levels larger than memory ------------ */

/* Makes level 0 in strips. How much there is to do is known between elevation_stream_open and elevation_stream_begin.
 * The levels around level 0 are whole in memory. Strips may overlap and come in any order; each reads its part of the
 * files, and takes 5 octets for each pixel and 4 for each post. */
typedef struct ElevationStream ElevationStream;

/* One level: post (i, j) is at ((i0 + i) spacing_m, (j0 + j) spacing_m) of ENU. */
typedef struct StreamLevel {
    double       spacing_m;
    int          i0, j0, nx, ny;
    const float *z_m; /* ENU z [ny][nx]; NULL: level 0 */
} StreamLevel;

/* Which files there are, and the levels that show them; the heights of none. like: another stream whose levels this
 * one takes over, for a second set of files over the same ground; NULL: none. The texts of files and the pool must
 * outlive the stream. Failures are logged. */
Status elevation_stream_open(ElevationStream **out, const ElevationFiles *files, const LocalFrame *frame,
                             const ElevationStream *like, Pool *pool);
/* Computes the heights of the levels around level 0, which all later calls need; the files are read once. keep_octets:
 * most octets of decoded rows in files->keep_folder. */
Status elevation_stream_begin(ElevationStream *stream, double keep_octets);
/* Most pixels that elevation_stream_begin reads. */
double           elevation_stream_reads_px(const ElevationStream *stream);
void             elevation_stream_close(ElevationStream *stream); /* accepts NULL */
const RasterSet *elevation_stream_files(const ElevationStream *stream);
int              elevation_stream_levels(const ElevationStream *stream);
void             elevation_stream_level(StreamLevel *out, const ElevationStream *stream, int level);
/* Heights above the ellipsoid of rows of level 0, h_m [rows][nx]. from_file, may be NULL, [rows][nx]: 1 where the post
 * is of the files, 2 in a void of theirs filled from its surroundings, 3 from a coarser file, 0 beyond them. counted:
 * the voids and samples of these rows are added to the report: true once for each row, from the south. */
Status elevation_stream_heights(ElevationStream *stream, int row0, int rows, float *h_m, uint8_t *from_file,
                                bool counted);
/* The same, and what the nearest pixel of the files has, cell_m [rows][nx]: a surface model's walls are not smeared in
 * it, and single returns from the ground among crowns are not lost. */
Status elevation_stream_cells(ElevationStream *stream, int row0, int rows, float *h_m, float *cell_m,
                              uint8_t *from_file);
/* Converts rows to ENU z in place, and blends them into level 1 near the outline. */
Status elevation_stream_bend(const ElevationStream *stream, int row0, int rows, float *h_m);
/* Height of the surface of the levels from 1 on; 0 beyond them. */
double elevation_stream_around(const ElevationStream *stream, double x_m, double y_m);
/* What is known of the files so far; with the stored surface (NULL: not yet) also the error. */
Status elevation_stream_report(ElevationReport *out, const ElevationStream *stream, const Elevation *stored);

/* The middle of the finest of the files, found without a stream. opened: gets the opened files, for ElevationFiles. */
Status elevation_middle(Geodetic *out, RasterSet *opened, const char *paths);

/* ---- a landscape --------------------------------------------------------------------------------- */

typedef struct LandscapeFiles {
    ElevationFiles elevation;
    const char    *cover, *cover_table, *photo; /* empty: none */
    int            cover_band;                  /* 0: the band is chosen */
    uint64_t       seed;                        /* seed of the texture, and of surfaces that the files do not have */
} LandscapeFiles;

typedef struct LandscapeReport {
    ElevationReport elevation;
    CoverReport     cover; /* set where cover is named */
    double          photo_posting_m;
} LandscapeReport;

/* fix: as elevation_import. Failures are logged with file and next step. */
Status landscape_import(Landscape *out, LandscapeReport *report, const LandscapeFiles *files, const LocalFrame *frame,
                        const GroundFix *fix, int fix_count);

#endif
