/* terrain/ground/landscape.h: the terrain: from files (terrain/from_files/elevation_import.h), or without files a
 * synthetic terrain fitted to the exercise. Surface and albedo of both are queried here.
 *
 * The synthetic terrain:
 *
 * passes through every fix (ground vehicles, ground impacts), stays below every clear line (flight
 * paths, and the sight lines of shots that hit), has relief, fields, tracks and at least five surface
 * classes, and reaches the horizon without edge or hole. A pure function of its inputs. */
#ifndef TERRAIN_GROUND_LANDSCAPE_H
#define TERRAIN_GROUND_LANDSCAPE_H

#include "terrain/invented/invented.h"

/* Surfaces that lie on whatever else there is, such as roads of culture (terrain/culture/culture_ground.h). Thread-safe
 * functions of what is borrowed. */
typedef struct LandscapeOver {
    const void *of;                                                                /* NULL: nothing lies on it */
    int (*surface_at)(const void *of, double x_m, double y_m);                     /* SURFACE_NONE: none there */
    bool (*surface_near)(const void *of, double x_m, double y_m, double within_m); /* whether any is so near */
} LandscapeOver;

typedef struct Landscape {
    LocalFrame      frame;
    Elevation       elevation;
    LandscapeConfig config;
    double          fit_worst_m; /* largest |surface - fix| over the fixes that were kept */
    int fixes_dropped; /* fixes that were dropped: inconsistent with their neighbours, above a clear line, or outside of
                          the terrain */
    LandscapeEvidence fitted_to; /* a copy of the inputs of a synthetic terrain: landscape_parts.h */
    void             *cover;     /* private; holds what surface and texture are computed from */
    LandscapeOver     over;      /* what lies on it; .of NULL: nothing */
} Landscape;

/* The mapped file of a landscape from a terrain store (terrain/store/store.h). */
typedef struct LandscapeMap {
    char    *path; /* absolute path; NULL: the landscape is not from a store */
    void    *map;
    size_t   octets;
    uint64_t content; /* the store's hash */
} LandscapeMap;

LandscapeConfig landscape_default_config(void);
/* 0.2 s with nothing to fit, 0.7 s with 40 000 fixes and 23 000 lines (one core). Level 0 grows beyond half_width_m to
 * hold the fixes as long as it stays below 16 M posts; fixes further out are fitted on coarser levels. Of two fixes
 * that no slope of 35 degrees joins the higher is dropped, unless its support exceeds that of the lower four to one;
 * before that, source entities that are outliers against their neighbours are dropped as a whole
 * (invented_inconsistent). With neither fixes nor low lines the terrain is at ellipsoid height 0. fix, line may be
 * NULL when their count is 0. */
Status landscape_create(Landscape *out, const LandscapeConfig *config, const LocalFrame *frame, const GroundFix *fix,
                        int fix_count, const ClearLine *line, int line_count);
/* The same with a sea: flat at sea_h_m, wherever a place of sea is nearer than a place of dry land, the line between
 * bent by up to a third of the distance; a third of the way from a place to its nearest opposite is always of its own
 * kind. Land comes down to the water within 400 m of the shore, less where a place of dry land is nearer. Fixes on the
 * water are dropped, and lines do not lower it. */
Status landscape_create_from(Landscape *out, const LandscapeConfig *config, const LocalFrame *frame,
                             const LandscapeEvidence *evidence);
/* The same from the cache, or into it. cache may be NULL. */
Status landscape_create_kept(Landscape *out, const LandscapeConfig *config, const LocalFrame *frame,
                             const LandscapeEvidence *evidence, Cache *cache);
void   landscape_destroy(Landscape *landscape);

/* Whether the terrain is synthetic, not from files. */
bool landscape_is_synthetic(const Landscape *landscape);
/* Surface class at a place, anchored to the ground; SURFACE_NONE where there is none, and for NaN. Thread-safe. For
 * many positions at once a tenth of the time each, and the same results. */
SurfaceClass landscape_surface(const Landscape *landscape, double x_m, double y_m);
void landscape_surfaces(uint8_t *surface, const Landscape *landscape, int count, const double *x_m, const double *y_m);
/* The same of side x side places, row by row, of a square as small as a pixel's, for a fraction of the time: where a
 * regular pattern of a quarter of them (half, for sides below 8) is of one class, all are; and over squares of up to
 * 12 x 4 m what the synthetic cover follows over 17 m and more is interpolated, which moves borders by some decimetres
 * (tests/terrain/test_cover.c). All places are looked at where something that lies on the ground is near. */
enum { landscape_square_most = 256 };
void landscape_surfaces_square(uint8_t *surface, const Landscape *landscape, int side, const double *x_m,
                               const double *y_m);
/* The photograph's brightness relative to its mean over the class, for each channel, averaged over the footprint; 1
 * without a photograph. Multiplied by the reflectance of a class's material, its mean over the class is that of the
 * material. The detail (terrain/detail/detail.h) then adds only what is finer than the photograph's pixels. factor:
 * red, green, blue, and all three together. */
bool landscape_has_photo(const Landscape *landscape);
/* Side of the photograph's pixels at each of the places in `lanes`; 0: there is no photograph. */
void landscape_photo_cells(float cell_m[8], const Landscape *landscape, const double x_m[8], const double y_m[8],
                           unsigned lanes);
/* Seed of what is drawn at random on the surface. Returns false, and sets 0, when the landscape has none. */
bool landscape_seed(uint64_t *out, const Landscape *landscape);
enum { albedo_red, albedo_green, albedo_blue, albedo_all, albedo_channels };
void landscape_albedo(float factor[albedo_channels], const Landscape *landscape, SurfaceClass surface, double x_m,
                      double y_m, double footprint_m);

/* ---- what only an invented landscape has ------------------------------------------------------- */

/* The nearest way about a place; false: none within some metres of its edge. Landscapes from files have none: their
 * roads are in their cover, as classes without direction. */
bool landscape_way(WayPlace *out, const Landscape *landscape, double x_m, double y_m);

/* The vertices of a way in order, up to `most` of them; returns their number. Ways are numbered from 0; returns 0 when
 * there is no such way. */
int landscape_way_vertices(double (*out)[2], WayKind *kind, const Landscape *landscape, int way, int most);

/* All plots, which the landscape owns; NULL and 0 where there are none. */
const HousePlot *landscape_plots(const Landscape *landscape, int *count);
/* Centre of village `index`; returns false when there is no such village. */
bool landscape_village(double place_m[2], const Landscape *landscape, int index);

/* How wet (hollows) or, below 0, worn (crests) the ground is: -1 .. 1; 0 where there are no ways. */
double landscape_wetness(const Landscape *landscape, double x_m, double y_m);
/* Whether a way, a pond, a plot or the place of a vehicle reaches into the index cell of a place. */
bool landscape_ways_near(const Landscape *landscape, double x_m, double y_m);

/* Places of hedgerows, which are on borders of fields and beside the tracks between them, never on a road, in water or
 * where a vehicle was reported: those within a rectangle, about spacing_m apart (1 .. 50), in a list that the caller
 * frees. Each belongs to a square of a fixed grid of that spacing: rectangles side by side that are whole squares
 * repeat none and omit none. STATUS_BAD_VALUE: not finite, or more than 2^26 squares. Landscapes from files: none. */
Status landscape_hedges(HedgePlace **out, int *count, const Landscape *landscape, const double south_west_m[2],
                        const double north_east_m[2], double spacing_m);

/* ---- a large invented landscape, quickly: what frames are measured on --------------------------- */

static const double landscape_quick_step_m = 1.0 / 64;

/* One level of posts 1 m apart, east_m x north_m about the frame's origin (200 .. 32000, whole metres): eroded hills of
 * some 250 m from valley to top, at the origin's tangent plane. The surface, from fields to rock, is that of any
 * synthetic terrain. The same posts for any number of threads. times_s: for the posts, and for their pyramid. */
Status landscape_quick(Landscape *out, double times_s[2], const LocalFrame *frame, double east_m, double north_m,
                       Pool *pool);
/* Bytes of the posts, and bytes of the pyramids above them, of heights and of rises. */
void landscape_quick_bytes(size_t *posts, size_t *pyramids, const Elevation *elevation);

#endif
