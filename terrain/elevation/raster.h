/* terrain/elevation/raster.h: georeferenced pixels of anything GDAL reads (GeoTIFF, DTED, HGT, VRT ...).
 *
 * GDAL and PROJ work in a process of their own (terrain/elevation/reader), one for each set: it cannot open a
 * connection, start a program, write, or read files elsewhere, and its memory and time are limited (raster_child.h).
 * What a broken file does to it is one logged line here.
 *
 * Sheets of one grid (same CRS, same pixel size, a whole number of pixels apart) are one Raster, as tiles of a survey
 * are. Pixel (i, j) covers [i, i+1) x [j, j+1), row 0 northernmost as a rule; its post, or centre, is at (i + 0.5, j +
 * 0.5), whether the file calls itself pixel-is-point or area: GDAL places the corners accordingly. */
#ifndef TERRAIN_ELEVATION_RASTER_H
#define TERRAIN_ELEVATION_RASTER_H

#include "terrain/earth/geodesy.h"

/* ---- what a user says of a file where the file does not, after its name -------------------------- */

/*     FILE:2                band 2
 *     FILE@geoid            heights above the geoid;  @ellipsoid
 *     FILE@us-ft            the unit of its numbers: m dm cm km ft us-ft fathom
 *     FILE@down             its numbers grow downwards: depths;  @up
 *     FILE@nodata=-9999     that number is no height;  @nodata=none: every number is one, however far below the others
 *     FILE@srs=EPSG:6529    its coordinate system
 *     FILE@part=elevation   which of the grids in it, as in a NetCDF file of several variables
 *
 * Any of them, in any order, the band first: `dem.tif:1@ellipsoid@ft`. A file that is called so stays as it is. */

typedef enum RasterVertical { RASTER_VERTICAL_BY_CRS, RASTER_VERTICAL_GEOID, RASTER_VERTICAL_ELLIPSOID } RasterVertical;

typedef struct RasterChoice {
    RasterVertical vertical;
    int            band;              /* chosen band; 0: none is chosen */
    char           unit[16];          /* chosen unit; empty: the file's */
    int            sense;             /* direction of the numbers; 1: upwards, -1: downwards, 0: as the file says */
    bool           has_void, no_void; /* `nodata=N`; `nodata=none` */
    double         void_value;        /* the number that means void, where has_void, before scale and offset */
    char           srs[128];          /* chosen coordinate system; empty: the file's */
    char           part[64];          /* chosen part of the file; empty: the file itself */
} RasterChoice;

/* Takes the choices off the end of a name. False: *why says what the last of them lacks, in static storage. */
bool raster_choice_take(RasterChoice *out, const char **why, char *path);
/* Whether a text is one choice, without its `@`; it is added to *to. */
bool raster_choice_add(RasterChoice *to, const char *text);
/* Writes `name` and after it what `all` chooses and the name itself does not. False: out is too small. */
bool raster_choice_write(char *out, size_t out_size, const char *name, const RasterChoice *all);
/* Metres of a unit of length by its name, as files and users write it; 0: unknown. An empty name is unknown. */
double raster_unit_m(const char *name);

/* ---- what a file says of one of its bands -------------------------------------------------------- */

/* What a file itself says of the numbers of its band, and of its coordinate system. Texts are empty where it says
 * nothing. */
typedef struct RasterStated {
    char   type[16];              /* GDAL's name: Int16, Float32 ... */
    char   unit[32];              /* unit of the band or, where it has none, of the vertical coordinate system */
    bool   unit_of_crs;           /* the unit is that of the coordinate system */
    char   crs[80], crs_unit[32]; /* name of the coordinate system; unit of its axes where it is projected */
    double crs_unit_m;            /* length of that unit; 0: degrees */
    char   vertical[80];          /* name of the vertical coordinate system */
    bool   down;                  /* its numbers grow downwards */
    bool   coloured;              /* red, green, blue, a palette: a picture */
    bool   grey; /* octets of a single band, without unit, scale, vertical system: a picture, or whole metres */
    bool   has_nodata;
    double nodata;
} RasterStated;

/* ---- rasters ------------------------------------------------------------------------------------- */

typedef struct RasterSheet {
    char              *path;
    int                x0, y0, width, height; /* place in the Raster, px */
    int                band;                  /* the band named in `FILE:BAND`; 0: none is named */
    struct RasterOpen *open; /* handles that the reader keeps between reads; NULL: the file is opened for each read */
} RasterSheet;

typedef struct Raster {
    int          width, height, bands;
    double       posting_m[2]; /* along a row and along a column, at the middle */
    bool         ellipsoidal;  /* the CRS is three-dimensional: heights above the ellipsoid */
    RasterStated stated;       /* what the first sheet states */
    RasterChoice choice;       /* what the list of files chooses for it */
    double       low, high;    /* numbers outside count as void where sheets overlap; infinite unless the owner knows */
    int          order;        /* place of its first sheet in the list of files */
    int          row_block;    /* rows that are read together at the least cost; a power of two */
    double
        metres_per_unit; /* unit of the band's numbers, m; negative: they grow downwards. 1 where the unit is unknown */
    bool         bytes;  /* its samples are octets: of a picture, or a class */
    bool         whole;  /* samples are whole numbers, not floats */
    bool         sparse; /* parts are known to be uniform without being read (raster_uniform) */
    double       data_share; /* share of its pixels that must be read; 1: as far as is known all of them */
    int          sheet_count;
    RasterSheet *sheet;
    /* private: */
    struct RasterChild *child; /* process that reads its set */
    int                 index; /* there */
    struct RasterKept  *kept;
    /* affine transforms between pixels and the coordinate system, used by the reader */
    double crs_from_px[6], px_from_crs[6];
    double whole_turn_px; /* geographic: px of 360 degrees; else 0 */
    void  *crs, *crs_from_earth, *earth_from_crs;
} Raster;

typedef struct RasterSet {
    int     count;
    Raster *raster; /* rasters, that of the finest posting first; those of equal posting as they were given */
    struct RasterChild *child; /* private */
} RasterSet;

/* paths: files and folders, separated by commas; of a folder, all that GDAL reads. After a name stands what the user
 * says of it: raster.h. key: the setting, for messages. An unusable file is one logged line with a remedy, and
 * STATUS_IO or STATUS_BAD_VALUE. A file that names others (VRT) may name those that lie in its own folder, or below
 * one of raster_sources_from. */
Status raster_set_open(RasterSet *out, const char *paths, const char *key);
void   raster_set_close(RasterSet *set); /* accepts zeroes */
/* Both settings are of the whole process and concern sets that are opened later; set them before threads read. Files
 * that other files name may lie below these folders (separated by commas; empty: none). */
void        raster_sources_from(const char *folders);
const char *raster_sources(void); /* the folders as they were set */
/* From here on only files below this folder are opened, after links are followed, even where raster_sources_from allows
 * others. NULL: files anywhere. */
void        raster_stay_within(const char *folder);
const char *raster_within(void); /* that folder; empty: anywhere */

/* In place, count places: longitude and latitude (rad) to column and row, and back. NaN where the projection has
 * none. */
void raster_px_from_earth(const Raster *raster, int count, double *lon_to_x, double *lat_to_y);
void raster_earth_from_px(const Raster *raster, int count, double *x_to_lon, double *y_to_lat);

/* ENU box, x and y, of a rectangle inset_px within the raster's outline (0.5: of its outermost posts), at height 0. */
void raster_enu_box(double low_m[2], double high_m[2], const Raster *raster, const LocalFrame *frame, double inset_px);

/* Pixels x0 .. x0 + width - 1 of rows y0 .. y0 + height - 1. */
typedef struct RasterWindow {
    int x0, y0, width, height;
} RasterWindow;

/* band from 1, its scale and offset applied. out [height][width]; NaN for void, nodata, masked, and between sheets.
 * Where sheets overlap the first that has a value wins. The window may reach beyond the raster. Several threads may
 * read at once; windows whose first rows lie in different blocks of row_block rows do not wait for each other.
 * STATUS_IO, logged, when a file turns out to be damaged. */
Status raster_read(float *out, const Raster *raster, int band, RasterWindow window, const char *key);
/* Whether all of a window is known to have one value (NaN: no data) without being read: between sheets, and where a
 * TIFF has no block. False also where it is not known. */
bool raster_uniform(float *value, const Raster *raster, int band, RasterWindow window, const char *key);
/* Width, px, of the pieces of rows that are best read at once: the whole width, or 32768 px of a raster so wide that
 * its rows would fill the memory. */
int raster_piece(const Raster *raster);
/* From now on rows of a band that are read, whole or in whole pieces (raster_piece), are kept, decoded, in a nameless
 * file of this folder, and read from it when they are asked for again: 4 octets a pixel, at most most_octets. Nothing
 * where the folder cannot have such a file. */
void raster_keep(Raster *raster, int band, const char *folder, double most_octets);
/* The same of a raster of octets: out [height][width][bands], and valid [height][width], 0 or 255. bands: how many,
 * from the first on. */
Status raster_read_bytes(uint8_t *out, uint8_t *valid, const Raster *raster, int first_band, int bands,
                         RasterWindow window, const char *key);

#endif
