/* render/trace/plants/forest_private.h: the scenes of a forest, shared by the files forest*.c and low_plants.c. */
#ifndef RENDER_TRACE_PLANTS_FOREST_PRIVATE_H
#define RENDER_TRACE_PLANTS_FOREST_PRIVATE_H

#include <embree3/rtcore.h>

#include "render/trace/plants/forest.h"

#include "pitviper_simd.h"

#include <pthread.h>

enum { shape_azimuths = 64 };

/* A prototype, ready to be traced: its quads about their middle, and Embree's tree over them. */
typedef struct ShapeScene {
    RTCScene           scene; /* NULL: not built */
    const PlantShape  *shape;
    int                quads;              /* of it that are traced */
    const LeafOutline *outline;            /* [plant_outlines] */
    const LeafPattern *pattern;            /* [plant_outlines]; NULL: leaves have outlines */
    double             centre[4], half[4]; /* box, of a plant 1 m high; the fourth are 0 */
    const double (*azimuth)[2];            /* unit vectors of azimuths, [shape_azimuths + 1] of the forest */
    double            most;                /* a coordinate of its box has, either way; of a hull alone, as the next */
    double            radius;              /* of a ball about its axis at half its height, which holds the box */
    struct ShapeKept *kept;                /* where light of a patterned shape is kept; NULL: nowhere */
    double reach[shape_azimuths + 1];      /* how far it reaches towards azimuths from x to y, from its axis; the last
                                            * is the first */
} ShapeScene;

/* ---- what rays meet of a prototype, by table (forest_table.c) ----------------------------------- */

enum {
    table_azimuths = 32,
    table_elevations = 15,
    table_ways = table_azimuths * table_elevations,
    table_side = 192, /* texels of the finest level; each further has half of them */
    table_levels = 4,
    /* a texel: what was met. Of a hit: 2 + quad in the lower bits, depth in the upper, signed, in radius /
     * table_depth_steps behind the middle of the prototype's box. */
    table_unset = 0, /* not traced yet */
    table_nothing = 1,
    table_quad_bits = 18,
    table_quad_mask = (1 << table_quad_bits) - 1,
    table_depth_steps = 8000
};

/* A direction of the table in the prototype's axes, and the square across it, about the middle of the box: a point p
 * from there is in it where u . p and v . p are within -1 and 1. */
typedef struct TableWay {
    double d[3], u[3], v[3]; /* unit; over half the square's widths */
} TableWay;

typedef struct PlantTable {
    const ShapeScene *shape;
    double            radius;              /* of a sphere about the box, of a plant 1 m high */
    double            step;                /* width of a texel of the finest level, likewise */
    TableWay          way[table_ways];     /* elevations from 15 degrees upwards to straight down */
    uint32_t         *level[table_levels]; /* [table_ways][side][side] */
    struct ShapeKept *kept;                /* NULL: texels are not kept between runs */
} PlantTable;

/* Its memory, 94 MB, is the machine's only where it is asked for. STATUS_NO_MEMORY; STATUS_UNSUPPORTED: the prototype
 * has too many quads. */
Status plant_table_create(PlantTable **out, const ShapeScene *shape);
void   plant_table_destroy(PlantTable *table); /* accepts NULL */

/* The way nearest to a direction of any length in the prototype's axes, within 0.3 degrees; -1: it rises by more than
 * 15 degrees, which no table holds. */
int plant_table_way(const double d[3]);
/* The texels of a way and level, in rows by v. */
static inline const uint32_t *plant_table_texels(const PlantTable *table, int way, int level)
{
    const size_t side = table_side >> level;
    return table->level[level] + (size_t)way * side * side;
}
/* Traces a texel that is table_unset there, and keeps it. Thread-safe. */
uint32_t plant_table_trace(PlantTable *table, int way, int level, int place);

/* ---- what rays have found of prototypes, between runs (forest_kept.c) ---------------------------- */

typedef struct ForestKept ForestKept;

/* Parts of what rays find of a prototype, each an entry of the cache: texels of the table's ways of one elevation, and
 * the light that reaches its quads. */
enum { kept_light = table_elevations, kept_parts };

typedef struct KeptPart {
    int      taken;        /* atomic: the entry has been looked for */
    uint32_t fresh, known; /* atomic: values found since it was written, about; values that it has */
} KeptPart;

/* Those of the finest level of a kind. */
typedef struct ShapeKept {
    const ForestKept *all;
    pthread_mutex_t   lock; /* of taking and writing */
    int               kind;
    PlantTable       *table; /* NULL: none */
    const ShapeScene *shape;
    KeptPart          part[kept_parts];
} ShapeKept;

/* Values of an entry, all at once: those that are not known are table_unset, or -1. */
typedef struct KeptTexels {
    uint32_t *texel; /* [ways][table_side][table_side] of the finest level; NULL: what is read is only checked */
    int       ways, quads;
    uint32_t  known; /* counts those that are passed */
} KeptTexels;
typedef struct KeptLight {
    float (*share)[2]; /* PlantQuad.open_up and open_down, [groups] */
    int groups;        /* of quads side by side that are alike (plant_quads_alike) */
} KeptLight;
/* For each way, a bit for each line of texels that has any known; for each of these a bit for each texel that is known,
 * then one for each that is a hit; the hits' texels. user: KeptTexels, of zeros while they are read. */
KeptValues kept_texels_values;
/* user: KeptLight. */
KeptValues kept_light_values;

/* Takes what the entry of a part has, once: before a value is found that is not there. Other threads wait for it. */
void               shape_kept_take(ShapeKept *kept, int part);
static inline bool shape_kept_is_taken(const ShapeKept *kept, int part)
{
    return !kept || __atomic_load_n(&kept->part[part].taken, __ATOMIC_ACQUIRE);
}
/* Values that were found. */
static inline void shape_kept_count(ShapeKept *kept, int part, uint32_t found)
{
    if (kept) __atomic_fetch_add(&kept->part[part].fresh, found, __ATOMIC_RELAXED);
}
/* After a frame: writes at most one part, where many values are new. */
void forest_kept_after_frame(const struct Forest *forest);
void forest_kept_destroy(struct Forest *forest);

/* Plants that one tree of boxes holds. */
typedef struct PlantList {
    const struct Forest *forest;
    const ForestFrame   *frame; /* of the low plants; NULL: of the ray's own */
    const Plant         *plant;
    const uint32_t      *number; /* ForestHit.plant of each; NULL: its place and `base` */
    uint32_t             base;
    int                  count;
    int                  per_box; /* so many neighbours in the list share a box of Embree's tree */
    bool                 far;     /* of a page: they end by forest_far_share */
    double               origin_enu[3];
    RTCScene             scene; /* NULL: none */
    int8_t (*bounds)[6];        /* [count] box of each about its foot, without sway: lowest and highest, in units of
                                 * the plant's (forest_boxes.c); NULL: not kept */
} PlantList;

typedef struct LowSquares  LowSquares;  /* low_plants.c */
typedef struct ForestPages ForestPages; /* forest_pages.c */

struct Forest {
    RTCDevice     device;
    bool          packets; /* Embree has them, of eight rays: from AVX on */
    int           error;   /* the first that Embree reported */
    const Woods  *woods;
    const Plants *plants;
    ForestConfig  config;
    ShapeScene    shape[PLANT_KINDS][plant_levels];
    ShapeScene    hull[PLANT_KINDS]; /* box and reach that hold all its levels; nothing else. azimuth NULL: no quads */
    double        azimuth[shape_azimuths + 1][2];
    PlantTable   *table[PLANT_STANDING]; /* of the finest shapes; NULL: none */
    bool          borrows;               /* their scenes and tables */
    ForestKept   *kept;                  /* what is kept of them between runs; NULL: nothing */
    PlantList     standing;
    LowSquares   *squares;
    ForestPages  *pages;       /* NULL: none */
    RTCDevice     page_device; /* of pages: builds in the thread that asks */
};

/* A number in 0 .. 1 of a plant, by where it stands and how high it is: neighbours change their level at different
 * heights in the picture. */
static inline double plant_rank(const Plant *plant)
{
    uint64_t h;
    memcpy(&h, plant->p_m, sizeof h);
    h ^= ((uint64_t)plant->twist << 32 | (plant->height & plant_most_height)) * 0x9e3779b97f4a7c15u;
    h = (h ^ h >> 32) * 0xd6e8feb86659fd93u;
    h = (h ^ h >> 32) * 0xd6e8feb86659fd93u;
    return (double)(h >> 11) * 0x1p-53;
}

static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

static const double past = 1 + 1e-6; /* a float's distance may be that much short */

/* ForestHit.plant of a plant of a list. */
static inline uint32_t plant_number(const PlantList *list, uint32_t place)
{
    return list->number ? list->number[place] : list->base + place;
}

/* forest.c: latches the first error of a device of the forest, and says what it was. */
void   forest_latch_error(void *forest, enum RTCError code, const char *text);
Status forest_status(const struct Forest *forest);
/* Builds the scene of a shape. */
Status shape_scene_build(ShapeScene *shape, const struct Forest *forest);
/* Embree's callbacks of a scene of boxes. */
typedef struct BoxCalls {
    RTCBoundsFunction     bounds;
    RTCIntersectFunctionN intersect;
    RTCOccludedFunctionN  occlude;
} BoxCalls;
/* A scene of so many boxes of the user's, not yet committed. NULL: no memory. */
RTCScene forest_boxes(RTCDevice device, int boxes, const BoxCalls *calls, void *user);
/* A tree of boxes over a list. STATUS_NO_MEMORY. */
Status plant_list_commit(PlantList *list, const struct Forest *forest, bool quick);
void   plant_list_close(PlantList *list);

/* How far a plant leans beyond its own lean, rad east and north. */
void forest_sway(double sway_rad[2], const ForestFrame *frame, const Plant *plant, double x_m, double y_m);
/* The level at which a plant is traced, by its height in the picture; where it has a table, that of the table: the
 * finest, as for rays that must meet real plants. */
int               forest_level(const ForestFrame *frame, const Plant *plant, const double foot_enu[3]);
static inline int forest_finest(const struct Forest *forest) { return forest->config.fine ? plant_fine : plant_whole; }

/* Embree's callbacks of a list: user pointer is the PlantList. */
void plant_box(const struct RTCBoundsFunctionArguments *a);
void plant_intersect(const struct RTCIntersectFunctionNArguments *a);
void plant_occlude(const struct RTCOccludedFunctionNArguments *a);
/* And of the quads of a prototype: user pointer is the ShapeScene. */
void quad_intersect(const struct RTCFilterFunctionNArguments *a);
void quad_occlude(const struct RTCFilterFunctionNArguments *a);

/* ---- rays against plants themselves (forest_trace.c) ------------------------------------------- */

/* Where a plant stands and how it is turned: the same for every ray of a frame. */
typedef struct PlantFrame {
    F64x4        column[3], per; /* from ENU to the prototype's axes, and scales there; the fourth lane is 0 */
    double       foot_enu[3];
    const Plant *plant; /* NULL: not known */
    int          level; /* that is traced unless the ray must meet real plants */
} PlantFrame;

enum { frames_kept = 128 };

/* A ray through lists of plants. */
typedef struct ListRay {
    const ForestFrame *frame;
    PlantFrame        *kept; /* [frames_kept] of plants that earlier rays met */
    bool               real;
    double             o_enu[3], d_enu[3];
    double             limit_m;             /* of what may still be nearer */
    double             bend_per_m, piece_m; /* of a bent ray; where the piece that Embree has begins */
    bool               met;
    ForestHit          hit;
} ListRay;

static inline void foot_of(double foot_enu[3], const PlantList *list, const Plant *plant)
{
    for (int c = 0; c < 3; c++) foot_enu[c] = list->origin_enu[c] + (double)plant->p_m[c];
}

/* A vector of ENU in the prototype's axes, scaled so that its height is 1. */
static inline void to_prototype(double out[3], const double axis[3][3], const double per[2], const double v_enu[3])
{
    out[0] = v3_dot(axis[0], v_enu) * per[0];
    out[1] = v3_dot(axis[1], v_enu) * per[0];
    out[2] = v3_dot(axis[2], v_enu) * per[1];
}

typedef struct QuadPlane {
    double a[3], u[3], v[3], n[3]; /* a corner, two sides from it, and their product */
} QuadPlane;

static inline void plane_of(QuadPlane *out, const PlantQuad *quad)
{
    for (int c = 0; c < 3; c++) {
        out->a[c] = (double)quad->corner[0][c];
        out->u[c] = (double)quad->corner[1][c] - out->a[c];
        out->v[c] = (double)quad->corner[3][c] - out->a[c];
    }
    v3_cross(out->n, out->u, out->v);
    if (v3_dot(out->n, out->n) > 0) return;
    for (int c = 0; c < 3; c++)
        out->v[c] = (double)quad->corner[2][c] - out->a[c]; /* a triangle: corners 0 and 3, or 0 and 1, are one */
    v3_cross(out->n, out->u, out->v);
}

/* The ray's first hit of a plant, where it is nearer than limit_m, or as near and of a lower number: true. */
bool plant_first(ListRay *ray, const PlantList *list, uint32_t place);
/* Whether the plant stops the ray before limit_m. */
bool plant_stops(ListRay *ray, const PlantList *list, uint32_t place);
/* Fills in what of a hit follows from its plant, quad and range. */
void plant_complete(ListRay *ray, const PlantList *list);
/* Axes and scales of a plant as it stands in a frame. */
void plant_axes_in(double axis[3][3], double scale[2], const ForestFrame *frame, const PlantList *list,
                   const Plant *plant);
/* Whether a ray of a prototype's own axes meets it. */
bool shape_occluded(const ShapeScene *shape, const double o[3], const double d[3]);
/* Its first quad, and how far; o: about the middle of the prototype's box. False: none. */
bool shape_first(uint32_t *quad, double *at_m, const ShapeScene *shape, const double o[3], const double d[3]);

/* PlantQuad.open_up and open_down of a patterned shape: found when first asked for, and kept. A pure function of the
 * prototype. Thread-safe. */
void plant_openness(float open_share[2], const ShapeScene *shape, uint32_t quad);

/* Whether quads have one mean light: cards of a spray, and sides of a piece of branch, which lie side by side. */
static inline bool plant_quads_alike(const PlantShape *shape, int k, int l)
{
    const PlantQuad *a = &shape->quad[k], *b = &shape->quad[l];
    return a->organ == b->organ && a->piece == b->piece;
}
/* Its light, which threads may find at the same time: each stores the same. False: not known yet. */
static inline bool plant_open_get(float open_share[2], const PlantQuad *quad)
{
    __atomic_load(&quad->open_up, &open_share[0], __ATOMIC_RELAXED);
    __atomic_load(&quad->open_down, &open_share[1], __ATOMIC_RELAXED);
    return open_share[0] >= 0 && open_share[1] >= 0;
}
static inline void plant_open_set(PlantQuad *quad, float open_share[2])
{
    __atomic_store(&quad->open_up, &open_share[0], __ATOMIC_RELAXED);
    __atomic_store(&quad->open_down, &open_share[1], __ATOMIC_RELAXED);
}

/* The box that a plant is within, with room for its sway, about its foot: as the list keeps it, else a wider one. */
void plant_bounds(double low_m[3], double high_m[3], const PlantList *list, const Plant *plant);
/* Angle of a vector from x towards y, within 0.005 rad; 0, 0: 0. */
double plant_rough_angle(double x, double y);

/* ---- eight rays against a plant's table (forest_cards.c) ---------------------------------------- */

enum { card_lanes = 8 };

/* Rays that leave the frame's eye, or that go one way. */
typedef struct CardRays {
    const ForestFrame *frame;
    const double      *way_enu; /* NULL: they leave the eye */
    double             bend_per_m;
    float              d[3][card_lanes], o[3][card_lanes]; /* o: about the list's origin */
    int32_t own_plant[card_lanes], own_quad[card_lanes];   /* numbers of the plant and the quad that a ray leaves; -1 */
} CardRays;

/* A plant by its table: what is met on the way from the eye to its middle, or against the way of the rays. Metres of
 * ENU to units of the table; the box outside which nothing counts. */
typedef struct Card {
    bool        real; /* it is met itself */
    PlantTable *table;
    int         way, level;
    float       n[3], u[3], v[3]; /* depth in metres along the table's direction over the ray's; columns and rows */
    float       at[3];            /* those of the eye, or of the plant's foot */
    float       from[3];          /* from the plant's foot to the eye; or from the list's origin to the foot */
    float       low[3], high[3];
    float       unit, step_m; /* of depth; width of a texel of the finest level */
} Card;

/* Where rays go through a card's table, and what their ranges follow from. */
typedef struct CardAim {
    F32x8 in, per, depth, o[3];
    I32x8 place;
} CardAim;
/* Lanes that go through the table, whose texels are fetched from now on. */
unsigned card_aim(CardAim *out, const Card *card, const CardRays *rays, unsigned lanes);

void card_make(Card *card, const CardRays *rays, const PlantList *list, const Plant *plant);
/* Those of the lanes that meet the plant; their ranges and quads. plant: its number. */
unsigned card_meets(float range_m[card_lanes], uint32_t quad[card_lanes], const Card *card, const CardRays *rays,
                    uint32_t plant, const CardAim *aim);
/* Those of the lanes whose rays come within reach_m of a place about the list's origin; within 0.02 m, 50 km away. */
unsigned card_near(const CardRays *rays, const float at_m[3], double reach_m, unsigned lanes);

/* low_plants.c */
LowSquares      *low_squares_create(void); /* NULL: no memory */
void             low_squares_destroy(LowSquares *squares);
Status           low_plants_open(ForestFrame *frame, double reach_m, Pool *pool, Arena *arena);
void             low_plants_close(ForestFrame *frame);
const PlantList *low_plants_list(const ForestFrame *frame);

/* ---- pages (forest_pages.c) --------------------------------------------------------------------- */

/* A page, and the box of ENU that its plants are in. */
typedef struct PageInReach {
    int    page;
    double low_enu[3], high_enu[3];
} PageInReach;

/* The pages in reach of a frame, as one scene of their boxes about origin_enu. */
typedef struct PagesInReach {
    Forest              *forest;
    uint64_t             serial; /* of the frame */
    double               origin_enu[3];
    int                  count;
    PageInReach         *page;  /* [count] */
    RTCScene             scene; /* NULL: none is in reach */
    struct PagesInReach *next;
} PagesInReach;

static const double page_piece_m = 16000; /* pieces of bent rays through that scene: 4 m off at most, of 5 m of room */

/* Nothing where the woods have no pages, or config.far_m is 0. */
Status forest_pages_create(Forest *forest, const char *isa);
void   forest_pages_destroy(Forest *forest);
Status far_pages_open(ForestFrame *frame, Pool *pool);
void   far_pages_close(ForestFrame *frame);
/* The plants of a page in reach, made if need be; NULL: there is no memory for them. */
const PlantList *far_page_need(const PagesInReach *in_reach, int page);
/* Whether a plant of a page is too far from the frame's eye for its number. */
bool far_page_lacks(const ForestFrame *frame, const PlantList *list, uint32_t place);
/* The list that a hit's plant is in. */
const PlantList *forest_list_of(const ForestFrame *frame, const ForestHit *hit);
/* forest_packets.c: Embree's callbacks of the scene of pages: user pointer is the PagesInReach. */
void page_intersect(const struct RTCIntersectFunctionNArguments *a);
void page_occlude(const struct RTCOccludedFunctionNArguments *a);

static const double most_sway_rad = 0.2; /* of any plant in any wind: room in its box */
/* That room. */
static inline double plant_swing_m(const PlantList *list, const Plant *plant)
{
    return list->forest->config.sway > 0 ? most_sway_rad * 1.1 * plant_height_m(plant) : 0;
}

#endif
