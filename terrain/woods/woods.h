/* terrain/woods/woods.h: where plants stand: a pure function of the landscape, of the layers of a terrain store
 * (canopy height, canopy cover, crowns), of the tracks to be left clear, and of the seed.
 *
 * Trees, bushes and hedges are listed once; grass, reeds, crops and stones, which only matter near the eye, are handed
 * out square by square. None of them stand on roads, tracks, water or roofs, nor in or beside what is built, and no
 * stem in a WoodsPath. */
#ifndef TERRAIN_WOODS_WOODS_H
#define TERRAIN_WOODS_WOODS_H

#include "pitviper_cache.h"
#include "terrain/culture/culture.h"
#include "terrain/ground/landscape.h"
#include "terrain/surface.h"
#include "terrain/woods/plant.h"

/* A straight piece of a path along which invented woods are cleared. */
typedef struct WoodsPath {
    double a_m[2], b_m[2]; /* ends, in the landscape's ENU */
    double half_m;         /* half the width that is cleared of standing plants */
    double low_half_m;     /* half the width that is cleared of low plants; 0: they stay, as below a flight */
} WoodsPath;

/* What a vehicle that stands among plants needs clear: its footprint and half a metre about it. p_m: its origin; nose:
 * the direction of its front, level; front_m, back_m: of its box, from the origin, back_m below 0. A capsule, whose
 * ends hold the corners of what is up to 8 m wide and reach width_m / 4 + 0.5 beyond bow and stern. */
WoodsPath woods_footprint(const double p_m[2], const double nose[2], double front_m, double back_m, double width_m);
/* Distance of a place from a path's middle line. */
double woods_path_away_m(const WoodsPath *path, double x_m, double y_m);

/* A place about which trees are to stand. */
typedef struct WoodsPlace {
    double p_m[2]; /* ENU */
} WoodsPlace;

typedef struct WoodsConfig {
    uint64_t seed;
    double   centre_m[2];  /* ENU */
    double   half_width_m; /* half width of the square about the centre in which plants stand; 50 .. 50000 */
    int      most_trees; /* 0 .. woods_most_trees: the farthest from all places are left out, whole squares at a time */
    int      place_count;
    const WoodsPlace *place; /* none in the square: its centre */
    const char *store; /* path of the terrain store of the landscape, for its canopy layers and crowns; NULL: none */
    int         path_count;
    const WoodsPath *path;       /* paths that are cleared of plants */
    double           far_half_m; /* half width of the square about the centre of which woods_page tells more plants;
                                  * not above half_width_m: none; at most 50000 */
    /* what is built, indexed, and borrowed as long as the woods are: no standing plant within woods_built_m of it, no
     * low one in buildings or on yards, and its trees stand where they are; NULL: nothing */
    const Culture *culture;
    Cache         *cache;   /* where the standing plants and pages are kept; NULL: nowhere */
    const char    *follows; /* what the landscape and the tables follow from, as a text; NULL: not known: not kept */
} WoodsConfig;

enum { woods_most_trees = 4000000 };
static const double woods_built_m = 1.5;

/* Squares of standing plants, for look-ups by place: the plants of square (i, j), whose south-west corner is at origin
 * + woods_square_m (i, j), are plant[first[j * nx + i]] .. plant[first[j * nx + i + 1] - 1]. */
static const double woods_square_m = 64;

typedef struct Woods {
    double           origin_enu[3]; /* origin of plant positions and, in x and y, of the squares */
    int              nx, ny;        /* squares */
    uint32_t        *first;         /* [nx * ny + 1] */
    int              count;
    Plant           *plant; /* [count] square by square, and in a fixed order within a square */
    int              by_kind[PLANT_KINDS];
    int              marked;   /* trees with a painted mark, of WoodsConfig.culture */
    int              left_out; /* trees left out beyond most_trees */
    uint8_t         *bare;     /* [nx * ny] 1: the square's trees were left out; NULL: no square's were */
    double           reach_m;  /* distance from the places, else from centre_m, within which no tree was left out */
    int              from_crowns, from_canopy, from_classes, from_hedges; /* how many plants came from each source */
    const Landscape *landscape;                                           /* borrowed */
    void            *low;                                                 /* private: what woods_low_plants needs */
    int              pages_x, pages_y;                                    /* pages of woods_page; 0: there are none */
    double           pages_enu[2];                                        /* south-west corner of the first one */
    void            *far;                                                 /* private: what woods_page needs */
} Woods;

/* pool may be NULL. STATUS_BAD_VALUE: a value outside its range, logged. */
Status woods_create(Woods *out, const Landscape *landscape, const WoodsConfig *config, Pool *pool);
void   woods_destroy(Woods *woods);

/* Lists the low plants of the square of woods_low_m whose south-west corner is at origin + woods_low_m (i, j): at most
 * `most`, into plant. Positions are relative to that corner and to Woods.origin_enu[2]. Returns their number.
 * Thread-safe. */
static const double woods_low_m = 8;
enum { woods_low_most = 4096 };
int woods_low_plants(Plant plant[woods_low_most], const Woods *woods, int64_t i, int64_t j);

/* ---- pages: plants that are not in Woods.plant ----------------------------------------------------
 *
 * Squares of woods_page_m, page j * pages_x + i with its south-west corner at pages_enu + woods_page_m (i, j), which
 * list the plants of all squares that Woods.plant leaves out: those that are bare, and those beyond its nx and ny. A
 * page is a pure function of what the woods are, and is placed, or read from the cache, when it is asked for. Plant k
 * of page p has the number woods_page_number(p) + k, which no other plant of the woods has. */

enum { woods_page_squares = 16 /* a side */, woods_page_most = 1 << 17, woods_most_pages_side = 99 };
static const double woods_page_m = 1024, woods_page_tall_m = 45;

typedef struct WoodsPage {
    double origin_enu[3]; /* of plant positions: the page's south-west corner, at about the height of its ground */
    int    count;
    Plant *plant; /* [count]; neighbours in the list are near each other on the ground */
} WoodsPage;

/* Thread-safe. Plants whose tops are above high_m (of woods_page_span) are left out. */
Status woods_page(WoodsPage *out, const Woods *woods, int page);
void   woods_page_free(WoodsPage *page);
/* Heights between which the page's plants are, ENU. False: it has no ground. */
bool woods_page_span(double *low_m, double *high_m, const Woods *woods, int page);
/* The page that a place is on; -1: none. */
int                    woods_page_at(const Woods *woods, double x_m, double y_m);
static inline uint32_t woods_page_number(int page)
{
    _Static_assert(woods_most_trees <= 32 * woods_page_most, "the numbers of Woods.plant come first");
    return ((uint32_t)page + 32) * (uint32_t)woods_page_most;
}
/* The page of a number; negative: it is not of a page. */
static inline int woods_page_of(uint32_t number) { return (int)(number / (uint32_t)woods_page_most) - 32; }

/* Whether it is in a square whose trees stand. */
bool woods_is_planted(const Woods *woods, double x_m, double y_m);
/* Woods of which nothing stands: of squares that were left out, and beyond them all. stand[count]: the class of forest
 * whose canopy covers the ground there, SURFACE_NONE: none; cover[count]: the share of it by a store's canopy layer,
 * -1: that of the class; density[count]: plants there over the class's mean. surface: of the places. */
void woods_not_standing(uint8_t *stand, float *cover, float *density, const Woods *woods, int count,
                        const uint8_t *surface, const double *x_m, const double *y_m);
/* Makes plants of one class on level ground of height 0, squares x squares about the origin, evenly dense and with all
 * kinds of the class. density: relative to the class's mean. */
Status woods_of_class(Woods *out, SurfaceClass surface, double density, uint64_t seed, int squares);

/* The standing plants whose trunk or stem (woods_trunk_m of radius) a circle touches: at most `most` of their indices;
 * returns how many there are. */
int woods_near(int *index, int most, const Woods *woods, double x_m, double y_m, double radius_m);
/* Radius of a plant's trunk at breast height, m; 0 for kinds without one. */
double woods_trunk_m(const Plant *plant);

/* ---- what grows on each surface class (etc/woods.csv) -------------------------------------------- */

typedef struct WoodsClass {
    double    per_m2; /* woody plants per square metre */
    double    low_m, high_m;
    double    share[PLANT_STANDING]; /* their sum is 1, or 0 where per_m2 is 0 */
    PlantKind floor;                 /* PLANT_KINDS: there is none */
    double    floor_per_m2, floor_low_m, floor_high_m;
} WoodsClass;

typedef struct WoodsTable {
    WoodsClass of[SURFACE_COUNT];
} WoodsTable;

/* STATUS_BAD_VALUE: logged, with file, line and value. */
Status woods_table_read(WoodsTable *out, const char *path);

#endif
