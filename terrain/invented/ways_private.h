/* terrain/invented/ways_private.h: what ways are made of, and the spatial index of them.
 *
 * ways.c          the index, the nearest way, the class of a place
 * ways_streams.c  streams, ponds and gullies; how wet and how worn the ground is
 * ways_roads.c    roads between villages
 * ways_tracks.c   tracks into fields and woods
 * ways_villages.c villages, lanes, plots
 *
 * None of it follows from where vehicles were or will be, but for two exceptions that no track shows: a house is not
 * built, and a pond not filled, where one was reported. */
#ifndef TERRAIN_INVENTED_WAYS_PRIVATE_H
#define TERRAIN_INVENTED_WAYS_PRIVATE_H

#include "terrain/invented/invented_eight.h"
#include "terrain/invented/invented_private.h"

enum { pond_radii = 32, ways_most_villages = 64 };

/* Positions are relative to the south-west corner of the ways' square. */
typedef struct WaySegment {
    float    x_m, y_m, dx, dy; /* start, and unit vector along it */
    float    length_m, along_m;
    float    half_m, widens; /* half the width at its start, and its growth a metre */
    uint16_t way;
    uint8_t  kind;
} WaySegment;

typedef struct Pond {
    float x_m, y_m, most_m;
    float radius_m[pond_radii];
} Pond;

typedef enum WayItem { WAY_ITEM_SEGMENT, WAY_ITEM_POND, WAY_ITEM_PLOT, WAY_ITEMS } WayItem;

struct Ways {
    double      x0_m, y0_m, side_m[2];
    double      index_m; /* side of an index cell */
    int         nx, ny;
    int32_t    *start; /* [nx ny + 1] first item of each cell in `item` */
    uint32_t   *item;  /* items, as WayItem << 28 | number */
    int         segments, ponds, plots, ways, villages;
    int         segments_room, ponds_room, plots_room;
    WaySegment *segment;
    Pond       *pond;
    HousePlot  *plot;
    NearGrid    stream_near; /* grid of the starts of streams' segments, used while roads are laid */
    double      village[ways_most_villages][2];
    /* A coarse grid of how wet (hollows, valleys) or worn (crests) the ground is, -127 .. 127; an entry has the four
     * corners of a cell. */
    double    coarse_m;
    int       cx, cy; /* posts */
    uint32_t *wet;    /* [cy][cx] corners SW, SE, NW, NE, from the lowest octet on */
    /* while ways are laid */
    float   *height;       /* [cy][cx] above the ellipsoid's curve */
    float   *flow;         /* [cy][cx] how many cells drain through this one */
    int32_t *road_vertex;  /* [cy][cx] a road's segment in this cell; -1: none */
    double (*reported)[2]; /* [reports] where vehicles were reported, one place in each square of 3 m */
    int      reports, reported_room;
    NearGrid reported_near;
};

Status ways_lay_streams(Ways *ways, const WaysGround *ground);
/* Lays villages, roads, lanes, plots and tracks; call it after the streams. */
Status ways_lay_roads(Ways *ways, const WaysGround *ground);
Status ways_lay_tracks(Ways *ways, const WaysGround *ground);

/* Villages lie on gentle dry land, one in most squares of this side. They are chosen before there are
 * roads; their lanes and plots are laid once roads join them. */
static const double ways_village_grid_m = 2600;
Status              ways_choose_villages(Ways *ways, const WaysGround *ground);
Status              ways_lay_villages(Ways *ways, const WaysGround *ground);

/* A line; its positions are relative to the square's corner. */
typedef struct WayLine {
    double (*p)[2];
    int count, room;
} WayLine;

Status ways_line_add(WayLine *line, double x, double y);
/* Draws a cubic B-spline about control points, through the first and the last, with a vertex every few metres. */
Status ways_draw_spline(WayLine *out, const WayLine *control);
/* Appends a way along a line. */
Status ways_lay_line(Ways *ways, WayKind kind, WayLine *line, double half_m);

/* Appends a way along points relative to the square's corner, with half widths at its ends. */
Status ways_append(Ways *ways, WayKind kind, const double (*p)[2], int count, double half_m, double half_end_m);
Status ways_reserve(void **rows, int *room, int count, size_t size);
/* Height above the curve of the Earth at a place relative to the square's corner; NaN beyond the terrain. */
double ways_height(const Ways *ways, const WaysGround *ground, double x_m, double y_m);
/* Whether a vehicle was reported within near_m (at most 96) of a place relative to the square's corner. */
bool ways_vehicle_near(const Ways *ways, double x_m, double y_m, double near_m);

/* The index cells that eight places are in; -1 where no way touches the cell. */
I32x8 ways_cells(const Ways *ways, const double x_m[8], const double y_m[8]);
/* The class at a place in a cell that ways touch. wander, -1 .. 1: moves borders; patch, -1 .. 1: selects what grows
 * beside ways. */
SurfaceClass ways_surface(const Ways *ways, int32_t cell, double x_m, double y_m, SurfaceClass field, float wander,
                          float patch);
/* Whether nothing of the ways changes the class of any place so near a place; false: not proven. */
bool ways_clear(const Ways *ways, const double place_m[2], double radius_m);
/* How wet eight places are, -1 .. 1. */
F32x8 ways_wet(const Ways *ways, const double x_m[8], const double y_m[8]);

#endif
