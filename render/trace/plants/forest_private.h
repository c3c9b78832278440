/* render/trace/plants/forest_private.h: the scenes of a forest, shared by the files forest*.c and low_plants.c. */
#ifndef RENDER_TRACE_PLANTS_FOREST_PRIVATE_H
#define RENDER_TRACE_PLANTS_FOREST_PRIVATE_H

#include <embree3/rtcore.h>

#include "render/trace/plants/forest.h"

enum { shape_azimuths = 64 };

/* A prototype, ready to be traced: its quads about their middle, and Embree's tree over them. */
typedef struct ShapeScene {
    RTCScene           scene;
    const PlantShape  *shape;
    const LeafOutline *outline;            /* [plant_outlines] */
    double             centre[4], half[4]; /* box, of a plant 1 m high; the fourth are 0 */
    double             radius;             /* of a ball about its axis at half its height, which holds all quads */
    const double (*azimuth)[2];            /* unit vectors of azimuths, [shape_azimuths + 1] of the forest */
    double reach[shape_azimuths + 1];      /* how far it reaches towards azimuths from x to y, from its axis; the last
                                            * is the first */
} ShapeScene;

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
} PlantList;

typedef struct LowSquares  LowSquares;  /* low_plants.c */
typedef struct ForestPages ForestPages; /* forest_pages.c */

struct Forest {
    RTCDevice     device;
    int           error; /* the first that Embree reported */
    const Woods  *woods;
    const Plants *plants;
    ForestConfig  config;
    ShapeScene    shape[PLANT_KINDS][plant_levels];
    double        azimuth[shape_azimuths + 1][2];
    bool          borrows; /* their scenes */
    PlantList     standing;
    LowSquares   *squares;
    ForestPages  *pages;       /* NULL: none */
    RTCDevice     page_device; /* of pages: builds in the thread that asks */
};

/* forest.c: latches the first error of a device of the forest, and says what it was. */
void   forest_latch_error(void *forest, enum RTCError code, const char *text);
Status forest_status(const struct Forest *forest);
/* A tree of boxes over a list. STATUS_NO_MEMORY. */
Status plant_list_commit(PlantList *list, const struct Forest *forest, bool quick);
void   plant_list_close(PlantList *list);

/* How far a plant leans beyond its own lean, rad east and north. */
void forest_sway(double sway_rad[2], const ForestFrame *frame, const Plant *plant, double x_m, double y_m);
/* Whether a plant is so low in the picture that it is traced at level 1. */
bool forest_is_low_in_picture(const ForestFrame *frame, const Plant *plant, const double foot_enu[3]);

/* Embree's callbacks of a list: user pointer is the PlantList. */
void plant_box(const struct RTCBoundsFunctionArguments *a);
void plant_intersect(const struct RTCIntersectFunctionNArguments *a);
void plant_occlude(const struct RTCOccludedFunctionNArguments *a);
/* And of the quads of a prototype: user pointer is the ShapeScene. */
void quad_intersect(const struct RTCFilterFunctionNArguments *a);
void quad_occlude(const struct RTCFilterFunctionNArguments *a);
/* Whether a ray of a prototype's own axes meets it. */
bool shape_occluded(const ShapeScene *shape, const double o[3], const double d[3]);

/* low_plants.c */
LowSquares      *low_squares_create(void); /* NULL: no memory */
void             low_squares_destroy(LowSquares *squares);
Status           low_plants_open(ForestFrame *frame, double reach_m, Pool *pool, Arena *arena);
void             low_plants_close(ForestFrame *frame);
const PlantList *low_plants_list(const ForestFrame *frame);

/* forest_pages.c: the pages in reach of a frame, as one scene of their boxes about origin_enu. */
typedef struct PagesInReach {
    Forest              *forest;
    uint64_t             serial; /* of the frame */
    double               origin_enu[3];
    int                  count;
    int                 *page;  /* [count] */
    RTCScene             scene; /* NULL: none is in reach */
    struct PagesInReach *next;
} PagesInReach;

/* Nothing where the woods have no pages, or config.far_m is 0. */
Status forest_pages_create(Forest *forest, const char *isa);
void   forest_pages_destroy(Forest *forest);
Status far_pages_open(ForestFrame *frame, Pool *pool);
void   far_pages_close(ForestFrame *frame);
/* The plants of a page in reach, made if need be; NULL: there is no memory for them. */
const PlantList *far_page_need(const PagesInReach *in_reach, int page);
/* The box of page k of those in reach, ENU. */
void far_page_box(double low_enu[3], double high_enu[3], const PagesInReach *in_reach, int k);
/* How far from the eye, in far_m, a plant of this number stands at most. */
double far_page_reach(uint32_t number);
/* The list that a hit's plant is in. */
const PlantList *forest_list_of(const ForestFrame *frame, const ForestHit *hit);
/* forest_trace.c: Embree's callbacks of the scene of pages: user pointer is the PagesInReach. */
void page_intersect(const struct RTCIntersectFunctionNArguments *a);
void page_occlude(const struct RTCOccludedFunctionNArguments *a);

static const double most_sway_rad = 0.2; /* of any plant in any wind: room in its box */

#endif
