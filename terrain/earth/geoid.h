/* terrain/earth/geoid.h: height of mean sea level above the ellipsoid, from a grid in PROJ's .gtx form.
 *
 * EGM96 by 15 minutes is Debian's proj-data. Cubic between the posts: within 10 mm of NGA's own interpolation and
 * 15 mm of the harmonic series at NGA's six places (tests/terrain/test_geoid.c). It changes by 0.6 m over 16 km:
 * evaluate it at each position, never once for all. */
#ifndef TERRAIN_EARTH_GEOID_H
#define TERRAIN_EARTH_GEOID_H

#include "pitviper.h"

typedef struct Geoid {
    int    rows, columns; /* from the south, from the west */
    double south_deg, west_deg, step_lat_deg, step_lon_deg;
    bool   wraps, south_pole, north_pole; /* whole circles of latitude; rows that stand on a pole */
    float *n_m; /* [rows + 4][columns + 4]: two more posts each side, over the seam and the poles */
} Geoid;

/* path NULL or empty: egm96_15.gtx in $PROJ_DATA, $PROJ_LIB, then where Debian puts it. A grid that is missing or
 * malformed is an error with what to do next, never a height of zero. */
Status geoid_open(Geoid *out, const char *path);
void   geoid_close(Geoid *geoid); /* accepts zeroes */

/* Above the ellipsoid, m. Any longitude; NaN beyond a pole, off a regional grid, or next to its gaps. Thread-safe,
 * some 20 M look-ups a second. */
double geoid_height_m(const Geoid *geoid, double lat_rad, double lon_rad);

#endif
