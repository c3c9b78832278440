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
    const LeafPattern *pattern;            /* [plant_outlines]; NULL: leaves have outlines */
    double             centre[4], half[4]; /* box, of a plant 1 m high; the fourth are 0 */
    const double (*azimuth)[2];            /* unit vectors of azimuths, [shape_azimuths + 1] of the forest */
    double reach[shape_azimuths + 1];      /* how far it reaches towards azimuths from x to y, from its axis; the last
                                            * is the first */
} ShapeScene;

/* Plants that one tree of boxes holds. */
typedef struct PlantList {
    const struct Forest *forest;
    const ForestFrame   *frame; /* of the low plants; NULL: of the ray's own */
    const Plant         *plant;
    const uint32_t      *number; /* ForestHit.plant of each; NULL: its place */
    int                  count;
    double               origin_enu[3];
    RTCScene             scene; /* NULL: none */
} PlantList;

typedef struct LowSquares LowSquares; /* low_plants.c */

struct Forest {
    RTCDevice     device;
    int           error; /* the first that Embree reported */
    const Woods  *woods;
    const Plants *plants;
    ForestConfig  config;
    ShapeScene    shape[PLANT_KINDS][plant_levels];
    ShapeScene    hull[PLANT_KINDS]; /* box and reach that hold all its levels; nothing else. azimuth NULL: no quads */
    double        azimuth[shape_azimuths + 1][2];
    bool          borrows; /* their scenes */
    PlantList     standing;
    LowSquares   *squares;
};

/* A tree of boxes over a list. STATUS_NO_MEMORY. */
Status plant_list_commit(PlantList *list, const struct Forest *forest, bool quick);
void   plant_list_close(PlantList *list);

/* How far a plant leans beyond its own lean, rad east and north. */
void forest_sway(double sway_rad[2], const ForestFrame *frame, const Plant *plant, double x_m, double y_m);
/* The level at which a plant is traced, by its height in the picture; for rays that must meet real plants: the finest.
 */
int               forest_level(const ForestFrame *frame, const Plant *plant, const double foot_enu[3]);
static inline int forest_finest(const struct Forest *forest) { return forest->config.fine ? plant_fine : plant_whole; }

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

static const double most_sway_rad = 0.2; /* of any plant in any wind: room in its box */

#endif
