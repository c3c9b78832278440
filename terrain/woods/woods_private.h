/* terrain/woods/woods_private.h: what placing plants needs, shared by the files of terrain/woods. */
#ifndef TERRAIN_WOODS_WOODS_PRIVATE_H
#define TERRAIN_WOODS_WOODS_PRIVATE_H

#include "terrain/store/store.h"
#include "terrain/woods/woods.h"

/* Pieces of paths and places of vehicles, listed for each square of woods_square_m that they reach into. */
typedef struct WoodsClearings {
    int        count;
    WoodsPath *path; /* [count] */
    int64_t    i0, j0;
    int        nx, ny;
    uint32_t  *first; /* [nx * ny + 1] */
    uint32_t  *item;
} WoodsClearings;

/* Crowns of a terrain store, or trees of culture, listed by squares. */
typedef struct WoodsCrowns {
    uint32_t *first; /* [nx * ny + 1] by the woods' squares; NULL: there are none */
    uint32_t *item;
    double    low[2], high[2]; /* box about the crowns, in which they were looked for */
} WoodsCrowns;

typedef struct WoodsSource {
    uint64_t         seed;
    const Landscape *landscape;
    const Culture   *culture; /* NULL: nothing is built */
    WoodsTable       table;
    TerrainStore     store;
    bool             has_store, synthetic;
    WoodsClearings   clearings;
    WoodsCrowns      crowns, trees;
    double           origin_enu[3];
    int64_t          i0, j0; /* number of the first square */
    int              nx, ny;
    double           centre_m[2];
} WoodsSource;

/* Well mixed bits of a seed and three numbers, and a number in [0, 1) from them (Stafford's thirteenth variant of the
 * finaliser, "Better bit mixing", 2011). */
static inline uint64_t woods_hash(uint64_t seed, int64_t a, int64_t b, uint64_t c)
{
    uint64_t h = seed + (uint64_t)a * 0x9e3779b97f4a7c15u + (uint64_t)b * 0xd1b54a32d192ed03u + c * 0x8cb92ba72f3d8dd7u;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31);
}
static inline double woods_unit(uint64_t hash) { return (double)(hash >> 11) * 0x1p-53; }

/* Draws lean, twist and width of a plant of a given kind and height; all but p_m is set. */
Plant woods_draw_plant(uint64_t hash, PlantKind kind, double height_m, double width);
/* Whether the ground bears a trunk: it does not on roads, tracks, water, roofs, clearings and what is built. For many
 * places of one square at once; bears[count]: 1 or 0. */
void woods_bears(uint8_t *bears, const WoodsSource *s, int count, const double *x_m, const double *y_m, double room_m,
                 bool low);

Status woods_clearings_create(WoodsClearings *out, const WoodsSource *s, const WoodsConfig *config);
/* Whether something built leaves no room for a plant. */
bool woods_is_built_on(const WoodsSource *s, double x_m, double y_m, bool low);
bool woods_is_cleared(const WoodsClearings *c, double x_m, double y_m, double room_m, bool low);
void woods_clearings_free(WoodsClearings *c);

/* The standing plants of one square; positions are relative to the woods' origin. */
typedef struct SquarePlants {
    Plant *plant;
    int    count, room;
    int    from_crowns, from_canopy, from_classes, from_hedges;
    bool   lost;
} SquarePlants;
void woods_fill_square(SquarePlants *out, const WoodsSource *s, int i, int j);
void woods_add_plant(SquarePlants *out, const WoodsSource *s, Plant plant, double x_m, double y_m);

/* Square (i, j) has woods_side_cells squared candidates. For candidate k: its place, and the hash from which its plant
 * is drawn. */
enum { woods_cell_m = 4, woods_side_cells = 16 };
uint64_t woods_candidate(double *x_m, double *y_m, const WoodsSource *s, int i, int j, int k);
/* Draws a plant of a class, of the kinds that are frequent there; and the density of plants there relative to the
 * class's mean. */
void   woods_draw_of_class(Plant *out, const WoodsSource *s, const WoodsClass *class, double x_m, double y_m,
                           uint64_t hash);
double woods_density(const WoodsSource *s, double x_m, double y_m);
/* The class whose plants stand on a surface. */
SurfaceClass woods_class_at(const WoodsSource *s, uint8_t surface, double x_m, double y_m);
/* The values of the store's canopy layers at a place; returns false when they have none there. */
bool woods_canopy_at(double *cover, double *height_m, const WoodsSource *s, double x_m, double y_m);

/* Empties the squares farthest from the places until at most config->most_trees are left. */
Status woods_keep_nearest(Woods *out, const WoodsSource *s, SquarePlants *square, const WoodsConfig *config);

/* woods.c */
Status woods_source_open(WoodsSource **out, const Landscape *landscape, const WoodsConfig *config, double half_width_m);
void   woods_source_free(WoodsSource *s); /* accepts NULL */
/* A key of everything that the standing plants follow from. */
CacheKey woods_key(const char *what, const WoodsConfig *config);

/* woods_page.c: opens what woods_page needs, or nothing where there are no pages. */
Status woods_pages_open(Woods *out, const WoodsConfig *config);
void   woods_pages_close(Woods *woods);

/* woods_kept.c: whether a plant from a file can stand. */
bool woods_is_plant(const Plant *p);
/* woods_kept.c: their length, and the octets where out is not NULL. */
size_t woods_to_octets(void *out, const Woods *woods);
/* Into woods that are empty but for nx and ny. STATUS_BAD_VALUE: not such octets; woods_destroy follows, as after
 * STATUS_NO_MEMORY. */
Status woods_from_octets(Woods *out, const void *octets, size_t count);

#endif
