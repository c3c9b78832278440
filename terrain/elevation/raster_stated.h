/* terrain/elevation/raster_stated.h: what a file says of one of its bands. */
#ifndef TERRAIN_ELEVATION_RASTER_STATED_H
#define TERRAIN_ELEVATION_RASTER_STATED_H

#include "pitviper.h"

/* What a file itself says of the numbers of its band, and of its coordinate system. Texts are empty where it says nothing. */
typedef struct RasterStated {
    char   type[16];             /* GDAL's name: Int16, Float32 ... */
    char   unit[32];             /* of the band; else of the vertical coordinate system */
    bool   unit_of_crs;          /* the latter */
    char   crs[80], crs_unit[32];/* name; unit of its axes where it is projected */
    double crs_unit_m;           /* 0: degrees */
    char   vertical[80];         /* name of the vertical coordinate system */
    bool   down;                 /* its numbers grow downwards */
    bool   coloured;             /* red, green, blue, a palette: a picture */
    bool   grey;                 /* octets of a single band, without unit, scale, vertical system: a picture, or whole metres */
    bool   has_nodata;
    double nodata;
} RasterStated;

#endif
