/* terrain/culture/culture_invented_private.h: what the files that invent culture share.
 *
 * culture_invented.c           the order of steps; records that are in the square
 * culture_invented_ground.c    where something may stand: evidence, ways, water, slope, what stands already
 * culture_invented_houses.c    houses on the plots of villages
 * culture_invented_plots.c     what else is on a plot: garages, sheds, fences
 * culture_invented_streets.c   churches, lamps, signs, power lines
 * culture_invented_sites.c     places beside ways, and what stands on them
 * culture_invented_farms.c     farms
 * culture_invented_works.c     industry and masts */
#ifndef TERRAIN_CULTURE_CULTURE_INVENTED_PRIVATE_H
#define TERRAIN_CULTURE_CULTURE_INVENTED_PRIVATE_H

#include "terrain/culture/culture_invented.h"

/* A rectangle on the ground. */
typedef struct Rectangle {
    double x_m, y_m;  /* its middle */
    double along[2];  /* unit vector of its length */
    double half_m[2]; /* half its sides: along, and to the left of that */
} Rectangle;

/* What stands already, as rectangles in the cells of a grid. */
typedef enum TakenKind {
    TAKEN_BUILDING = 1,
    TAKEN_THING = 2,
    TAKEN_LINE = 4,
    TAKEN_WIRES = 8, /* between poles, above the ground */
    TAKEN_SITE = 16, /* all of a farm, works or churchyard */
    TAKEN_PLOT = 32,
    TAKEN_DRIVE = 64, /* kept open from a way to a house or yard */
    TAKEN_ALL = 127
} TakenKind;

typedef struct Taken {
    Rectangle at;
    int32_t   owner; /* things of one owner may touch, where asked; -1: it has none */
    uint8_t   kind;  /* TakenKind */
} Taken;

typedef struct TakenEntry {
    int32_t taken, next;
} TakenEntry;

/* Squares over the finest level of the ground. */
typedef struct GroundGrid {
    double cell_m;
    int    nx, ny;
} GroundGrid;

enum {
    invent_most_villages = 64,
    invent_most_poles = 512, /* of one line */
    /* numbers of owners: first those of plots */
    invent_owner_church = 1 << 24,
    invent_owner_farm = 2 << 24,
    invent_owner_works = 3 << 24,
    invent_owner_mast = 4 << 24,
};
static const double invent_shortest_span_m = 40, invent_longest_span_m = 60;

/* Vertices of roads, lanes and tracks, by cells of invent_site_cell_m over the finest level. */
static const double invent_site_cell_m = 1000;
typedef struct WayCells {
    int  nx, ny;
    int *first; /* [nx * ny + 1] of vertex */
    int *vertex;
} WayCells;

typedef struct Inventor {
    Culture          culture;
    const Landscape *landscape;
    uint64_t         seed;
    double           low_m[2], high_m[2];   /* the square */
    double           x0_m, y0_m, side_m[2]; /* the finest level */
    Status           status;                /* the first failure; all later steps do nothing */
    /* evidence */
    GroundGrid driven_grid, line_grid;
    uint8_t   *driven;    /* [ny][nx] 1: a vehicle was reported in this square, or passed it */
    float     *ceiling_m; /* [ny][nx] lowest clear line over this square; INFINITY: none */
    /* what stands */
    GroundGrid  taken_grid;
    int32_t    *taken_first; /* [ny][nx] of entry; -1: none */
    Taken      *taken;
    TakenEntry *entry;
    int         takens, takens_room, entries, entries_room;
    /* ways: vertices of all, way by way */
    int      way_count, vertices, *way_first;
    uint8_t *way_kind;
    double (*vertex)[2];
    WayCells way_cells;
    uint8_t *built; /* [plots] 1: its house stands */
    /* villages */
    int villages, houses[invent_most_villages]; /* houses: built about each */
    double (*village)[2];
} Inventor;

static inline uint64_t invent_hash(const Inventor *v, uint64_t stream, double x_m, double y_m)
{
    return invented_hash(invented_hash(v->seed, (int64_t)stream, 0), llrint(x_m * 64), llrint(y_m * 64));
}
/* Number k in [0, 1) of a hash. */
static inline double invent_unit(uint64_t hash, int k) { return invented_unit(invented_hash(hash, k, 1)); }

/* ---- rectangles ---------------------------------------------------------------------------------- */

/* The place at (along, left) from a rectangle's middle. */
static inline void rectangle_at(double p_m[2], const Rectangle *r, double along_m, double left_m)
{
    p_m[0] = r->x_m + along_m * r->along[0] - left_m * r->along[1];
    p_m[1] = r->y_m + along_m * r->along[1] + left_m * r->along[0];
}
/* A rectangle of the same direction, or across it, whose middle is at (along, left). */
Rectangle rectangle_within(const Rectangle *r, double along_m, double left_m, double half_along_m, double half_left_m);
Rectangle rectangle_grown(const Rectangle *r, double by_m);
void      rectangle_corners(double corner_m[4][2], const Rectangle *r); /* counter-clockwise */
bool      rectangles_meet(const Rectangle *a, const Rectangle *b);      /* touching is not meeting */

/* ---- culture_invented_ground.c -------------------------------------------------------------------- */

Status invent_ground_open(Inventor *v);
void   invent_ground_close(Inventor *v);

/* Whether nothing was reported within culture_vehicle_m of a rectangle, and every clear line passes above top_m over
 * its highest ground. */
bool invent_is_clear(const Inventor *v, const Rectangle *r, double top_m);
/* Whether a rectangle grown by room_m has neither way nor water in it, and is on the finest level. */
bool invent_is_dry(const Inventor *v, const Rectangle *r, double room_m);
/* Slope of the plane through the corners of a rectangle; INFINITY where there is no ground. */
double invent_slope(const Inventor *v, const Rectangle *r);
/* Whether anything of `kinds` (a sum of TakenKind), of another owner, meets a rectangle. owner -1: of any. */
bool invent_is_taken(const Inventor *v, const Rectangle *r, int kinds, int owner);
void invent_take(Inventor *v, const Rectangle *r, TakenKind kind, int owner);
/* Lowest and highest ground along the outline of a rectangle; exact for triangles of the finest level. */
void   invent_ground_span(double *low_m, double *high_m, const Inventor *v, const Rectangle *r);
double invent_height(const Inventor *v, double x_m, double y_m);

/* ---- culture_invented.c ---------------------------------------------------------------------------- */

/* Adds a building whose eaves and ridge are set over its highest ground: both are raised by how much its ground rises.
 * It is taken, for the owner. */
void invent_building(Inventor *v, const Rectangle *r, const Building *building, int owner);
/* Adds a point with its foot at the lowest ground under it. */
void invent_point(Inventor *v, CulturePointKind kind, const Rectangle *r, double high_m, int owner);
void invent_line(Inventor *v, const CultureLine *line, const double (*corner_m)[2], int corners);

/* The nearest village, -1 without any, and how far its centre is. */
int invent_village_near(double *away_m, const Inventor *v, double x_m, double y_m);

/* ---- culture_invented_plots.c ----------------------------------------------------------------------- */

/* A border of straight sides, each in runs between gates and whatever is in its way. */
typedef struct Enclosure {
    CultureLine line;
    int         corners, gates, owner;
    double      corner_m[5][2], gate_m[3][2], gate_half_m[3];
} Enclosure;
void        invent_enclosure(Inventor *v, const Enclosure *e);
void        invent_enclose(Enclosure *e, const Rectangle *r); /* its corners are all four of a rectangle */
CultureLine invent_border(CultureLineKind kind, double height_m);
/* Whether something top_m high may stand there: room_m from all that stands, on the owner's own plot or site. */
bool invent_fits(const Inventor *v, const Rectangle *r, double room_m, double top_m, int owner);

/* ---- culture_invented_streets.c ---------------------------------------------------------------------- */

double invent_way_length(const Inventor *v, int way);
/* A place along a way, left_m to the left of its middle; its direction is the way's. False: beyond its ends. */
bool invent_way_place(Rectangle *out, const Inventor *v, int way, double along_m, double left_m);
/* Whether a plot is within near_m, each way. */
bool invent_is_built_up(const Inventor *v, double x_m, double y_m, double near_m);

/* ---- culture_invented_sites.c ------------------------------------------------------------------------ */

Status invent_sites_open(Inventor *v);
void   invent_sites_close(Inventor *v);
/* A place on a way in the inner part of a cell, with the way's direction: on the landscape's ways, or on a track
 * between fields. False: this hash has none. */
bool invent_beside_way(Rectangle *out, const Inventor *v, int cell, uint64_t hash, bool on_roads);
/* A site beside a way, its near side front_m from the way's middle; its own left is away from the way. */
Rectangle invent_site_beside(const Rectangle *way, bool left, double front_m, const double half_m[2]);
/* A site with the ground between it and its way. */
Rectangle invent_site_and_front(const Rectangle *site, double front_m);
/* How many ways cross a circle, by the cover. */
int invent_ways_about(const Inventor *v, double x_m, double y_m, double radius_m);
/* Share of a rectangle that is scrub, rock or track. */
double invent_wild_share(const Inventor *v, const Rectangle *r);
/* Add something at (along, left) of a site, if it fits. */
bool invent_site_building(Inventor *v, const Rectangle *site, const double at_m[2], const double half_m[2],
                          const Building *building, int owner);
bool invent_site_point(Inventor *v, const Rectangle *site, CulturePointKind kind, const double at_m[2],
                       const double size_m[3], int owner);
/* Adds a strip of ground between two places of a site. */
void invent_ground_strip(Inventor *v, const Rectangle *site, CultureLineKind kind, SurfaceClass surface,
                         const double from_m[2], const double to_m[2], double width_m);

/* ---- steps ----------------------------------------------------------------------------------------- */

/* A building of one level, its ridge along the rectangle or across it, with a roof of that pitch. */
Building invent_roofed(const Rectangle *r, RoofShape roof, double eaves_m, double pitch_rad, bool along);
/* A house in the style of a village (-1: of none). */
Building invent_house(const Inventor *v, const Rectangle *r, int village, uint64_t hash);
/* A plot's border. */
Rectangle invent_plot_rectangle(const HousePlot *plot);

void invent_houses(Inventor *v);
void invent_plots(Inventor *v);
void invent_churches(Inventor *v);
void invent_streets(Inventor *v);
void invent_works(Inventor *v);
void invent_farms(Inventor *v);
void invent_masts(Inventor *v);

#endif
