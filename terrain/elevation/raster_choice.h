/* terrain/elevation/raster_choice.h: what a user says of a file where the file does not, after its name.
 *
 *     FILE:2                band 2
 *     FILE@geoid            heights above the geoid;  @ellipsoid
 *     FILE@us-ft            the unit of its numbers: m dm cm km ft us-ft fathom
 *     FILE@down             its numbers grow downwards: depths;  @up
 *     FILE@nodata=-9999     that number is no height;  @nodata=none: every number is one, however far below the others
 *     FILE@srs=EPSG:6529    its coordinate system
 *     FILE@part=elevation   which of the grids in it, as in a NetCDF file of several variables
 *
 * Any of them, in any order, the band first: `dem.tif:1@ellipsoid@ft`. A file that is called so stays as it is. */
#ifndef TERRAIN_ELEVATION_RASTER_CHOICE_H
#define TERRAIN_ELEVATION_RASTER_CHOICE_H

#include "pitviper.h"

typedef enum RasterVertical { RASTER_VERTICAL_BY_CRS, RASTER_VERTICAL_GEOID, RASTER_VERTICAL_ELLIPSOID } RasterVertical;

typedef struct RasterChoice {
    RasterVertical vertical;
    int    band;              /* 0: the caller's choice */
    char   unit[16];          /* empty: as the file says */
    int    sense;             /* 1: upwards, -1: downwards, 0: as the file says */
    bool   has_void, no_void; /* `nodata=N`; `nodata=none` */
    double void_value;        /* where has_void, before scale and offset */
    char   srs[128];          /* empty: as the file says */
    char   part[64];          /* empty: the file itself */
} RasterChoice;

/* Takes the choices off the end of a name. False: *why says what the last of them lacks, in static storage. */
bool raster_choice_take(RasterChoice *out, const char **why, char *path);
/* Whether a text is one choice, without its `@`; it is added to *to. */
bool raster_choice_add(RasterChoice *to, const char *text);
/* Writes `name` and after it what `all` chooses and the name itself does not. False: out is too small. */
bool raster_choice_write(char *out, size_t out_size, const char *name, const RasterChoice *all);
/* Metres of a unit of length by its name, as files and users write it; 0: unknown. An empty name is unknown. */
double raster_unit_m(const char *name);

#endif
