/* terrain/landscape/landscape.h: the terrain: from files (terrain/landscape/landscape_import.h), or without files a
 * synthetic terrain fitted to the exercise. Surface and albedo of both are queried here.
 *
 * The synthetic terrain:
 *
 * passes through every fix (ground vehicles, ground impacts), stays below every clear line (flight
 * paths, and the sight lines of shots that hit), has relief, fields, tracks and at least five surface
 * classes, and reaches the horizon without edge or hole. A pure function of its inputs. */
#ifndef TERRAIN_LANDSCAPE_LANDSCAPE_H
#define TERRAIN_LANDSCAPE_LANDSCAPE_H

#include "terrain/elevation/elevation.h"
#include "terrain/earth/local_frame.h"
#include "terrain/surface.h"

/* A known point of the ground. The fixes of one source entity (voter) have one vote in the consensus together; a fix of
 * voter 0 has a vote of its own, and is only checked by its slopes to others. */
typedef struct GroundFix {
    double p_enu[3];
    int    voter; /* >= 0 */
} GroundFix;

/* A place of which only this is known: sea, or dry land. */
typedef struct CoastPlace {
    double x_m, y_m;
    bool   sea;
} CoastPlace;

/* A straight line that the ground must leave clear, from a to b, by 2 m where possible and 0.15 m at least. An end
 * within 8 m of a fix counts as at the fix: within landscape_taper_m of such an end (14 m at 4 m posts; in proportion
 * on the coarser levels) the line sets no limit, so a shot may end on the ground it hits. Elsewhere lines take
 * precedence: a fix above one is dropped. Give the places of gun, seeker and burst, not the point between a vehicle's
 * tracks: a line from base to base along flat ground drops every fix beside it. */
typedef struct ClearLine {
    double a_enu[3], b_enu[3];
} ClearLine;

typedef struct LandscapeConfig {
    uint64_t seed;
    double   relief_m;       /* rms height of the hills far from any fix, 0 .. 200 */
    double   spacing_m;      /* of level 0, 1 .. 30 */
    double   half_width_m;   /* of level 0 */
    double   horizon_m;      /* half width of the outermost level */
} LandscapeConfig;

/* All evidence of an exercise on its ground. Without a sea fix there is no sea. */
typedef struct LandscapeEvidence {
    int               fix_count, line_count, place_count;
    const GroundFix  *fix;
    const ClearLine  *line;
    const CoastPlace *place;
    double            sea_h_m; /* of the water's surface, above the ellipsoid */
} LandscapeEvidence;

typedef struct Landscape {
    LocalFrame      frame;
    Elevation       elevation;
    LandscapeConfig config;
    double          fit_worst_m;  /* largest |surface - fix| over the fixes that were kept */
    int             fixes_dropped;/* inconsistent with their neighbours, above a clear line, or outside of the
                                   * terrain */
    LandscapeEvidence fitted_to;  /* a copy of the inputs of a synthetic terrain: landscape_parts.h */
    void           *cover;        /* private; surface and texture need it */
} Landscape;

/* The mapped file of a landscape from a terrain store (terrain/store/store.h). */
typedef struct LandscapeMap {
    char    *path;    /* absolute; NULL: of no store */
    void    *map;
    size_t   octets;
    uint64_t content; /* hash of the store */
} LandscapeMap;

LandscapeConfig landscape_default_config(void);
/* 0.2 s with nothing to fit, 0.7 s with 40 000 fixes and 23 000 lines (one core). Level 0 grows beyond half_width_m
 * to hold the fixes as long as it stays below 16 M posts; fixes further out are fitted on coarser levels. Of two fixes
 * that no slope of 35 degrees joins the higher is dropped, unless its support exceeds that of the lower four to one;
 * before that, source entities that are outliers against their neighbours are dropped as a whole (ground_inconsistent).
 * With neither fixes nor low lines the terrain is at ellipsoid height 0. fix, line may be NULL when their count is
 * 0. */
Status landscape_create(Landscape *out, const LandscapeConfig *config, const LocalFrame *frame,
                        const GroundFix *fix, int fix_count, const ClearLine *line, int line_count);
/* The same with a sea: flat at sea_h_m, wherever a place of sea is nearer than a place of dry land, the line between
 * bent by up to a third of the distance; a third of the way from a place to its nearest opposite is always of its own
 * kind. Land comes down to the water within 400 m of the shore, less where a place of dry land is nearer. Fixes on the
 * water are dropped, and lines do not lower it. */
Status landscape_create_from(Landscape *out, const LandscapeConfig *config, const LocalFrame *frame,
                             const LandscapeEvidence *evidence);
/* Which fixes are of a source entity rejected by the consensus: [fix_count] bytes, 1: rejected. Source entities are
 * numbered from 1, up to the number of fixes. See votes.c. */
Status ground_inconsistent(uint8_t *outvoted, const GroundFix *fix, int fix_count);
/* Height of positions above the ground of the source entities near them (the plane of best consensus), and the distance
 * of the nearest of them, m; NaN: none within 300 m. */
Status ground_consensus_height(double *above_m, double *nearest_m, const double (*p_enu)[3], int count, const GroundFix *fix,
                       int fix_count);
void   landscape_destroy(Landscape *landscape);

/* Radius about an end at a fix within which a line sets no limit. */
double landscape_taper_m(const LandscapeConfig *config);

/* Whether it is the synthetic terrain, not one from files. */
bool         landscape_is_synthetic(const Landscape *landscape);
/* Surface class at a place, anchored to the ground; SURFACE_NONE where there is none, and for NaN. Thread-safe. For
 * many positions at once a tenth of the time each, and the same results. */
SurfaceClass landscape_surface(const Landscape *landscape, double x_m, double y_m);
void landscape_surfaces(uint8_t *surface, const Landscape *landscape, int count, const double *x_m, const double *y_m);
/* The same of side x side places, row by row, of a square as small as a pixel's, for a fraction of the time: where a regular
 * pattern of a quarter of them (half, for sides below 8) is of one class, all are; and over squares of up to 12 x 4 m what
 * the synthetic cover follows over 17 m and more is interpolated, which moves borders by some decimetres
 * (tests/terrain/test_cover.c). */
enum { landscape_square_most = 256 };
void landscape_surfaces_square(uint8_t *surface, const Landscape *landscape, int side, const double *x_m, const double *y_m);
/* Where there is a photograph: its brightness relative to its own mean over that class, a channel, averaged over the
 * footprint; multiplied by a material's reflectance the mean over the class is that of the material. 1 without. The
 * detail (terrain/landscape/detail.h) then adds only what is finer than the photograph's pixels. factor: red, green,
 * blue, and all three together. */
bool   landscape_has_photo(const Landscape *landscape);
enum { albedo_red, albedo_green, albedo_blue, albedo_all, albedo_channels };
void   landscape_albedo(float factor[albedo_channels], const Landscape *landscape, SurfaceClass surface, double x_m,
                        double y_m, double footprint_m);

#endif
