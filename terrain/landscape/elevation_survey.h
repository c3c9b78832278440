/* terrain/landscape/elevation_survey.h: what files of heights hold, looked at before they are used: range, voids that no
 * tag declares, unit, datum; and whether they can be heights at all.
 *
 * A void is known by being alone: up to eight numbers that lie below all others by more than ground can fall between
 * two posts. Files of up to 16 M posts are looked at whole; of larger ones 64 windows of 512 x 512 posts, the corners
 * among them, where such numbers must lie beside others, or be one of the usual ones (-9999, -999). */
#ifndef TERRAIN_LANDSCAPE_ELEVATION_SURVEY_H
#define TERRAIN_LANDSCAPE_ELEVATION_SURVEY_H

#include "terrain/elevation/raster.h"

enum { survey_most_voids = 8 };

typedef struct ElevationSurvey {
    const Raster *raster;            /* its sheets, size, posting, unit and coordinate system */
    bool     whole;                  /* every post was looked at; else a part, and counts are of that part */
    double   posts;                  /* looked at */
    double   voids;                  /* of them declared: nodata, masked, between sheets, or named by the user */
    double   outside;                /* of them no height on Earth, -12 500 .. 9500 m */
    double   low_m, high_m;          /* range of the others, suspected voids left out; NaN: none */
    int      suspects;               /* numbers taken for voids that no tag declares */
    double   suspect[survey_most_voids], suspect_posts; /* as the file has them, lowest height first */
    double   gap_m;                  /* from the highest suspect to the lowest height */
    bool     ellipsoidal;            /* heights are taken as above the ellipsoid; set by the caller */
} ElevationSurvey;

/* Looks at a raster and sets its low and high, so that suspected voids are read as voids. STATUS_BAD_VALUE, logged with the
 * option that says what is meant: a picture; an unknown unit; none beside a coordinate system in feet; numbers that are
 * no heights on Earth. Suspected voids are a warning. pool NULL: one thread. */
Status elevation_survey(ElevationSurvey *out, Raster *raster, const char *key, Pool *pool);

/* Where unit and datum come from, in words: "metre", "as the file says". In static storage or the survey's. */
void elevation_survey_words(const char **unit, const char **unit_from, const char **datum, const char **datum_from,
                            const ElevationSurvey *survey);

extern const double elevation_lowest_m, elevation_highest_m; /* below the deepest trench, above Everest */

#endif
