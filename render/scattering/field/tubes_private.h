/* render/scattering/field/tubes_private.h: between tubes.c, the grid and the list, tubes_split.c, a tile of the
 * grid, and tubes_trace.c, the way of some tubes. */
#ifndef RENDER_SCATTERING_FIELD_TUBES_PRIVATE_H
#define RENDER_SCATTERING_FIELD_TUBES_PRIVATE_H

#include "render/scattering/field/tubes.h"

enum {
    tile_side = 24,
    tile_rays = (tile_side + 2) * (tile_side + 2), /* traced together: a tile and the cells about it */
    trail_most = 8                                 /* mirrors by which tubes are compared */
};

/* Points of a plane through the target's middle, across the line from the transmitter. */
typedef struct TubeGrid {
    bool   plane; /* a plane wave; else from antenna */
    double antenna[3], distance_m;
    double centre[3], axis[3], side[2][3];
    double spacing_m, first_m[2]; /* first_m: of the first ray */
    double back_m;                /* rays begin so far before the plane */
    int    count[2], tiles[2];
} TubeGrid;

typedef struct TubeHit {
    double   path_m;
    float    slope_m[2], amplitude[8], first[3], last[3];
    uint8_t  bounce;
    uint16_t part;
    int      cell; /* of its tile and level */
} TubeHit;

/* What a tube met at a mirror, as far as neighbours are compared by it. */
typedef struct TubeMark {
    double   path_m; /* two-way */
    float    slope_m[2];
    uint16_t part;
    bool     seen;  /* by the receiver; else path and slopes are not set */
    bool     whole; /* the first, on a face that is not summed by tubes */
} TubeMark;

/* A cell of the grid or, at level n, one of the 4^n parts of a cell. */
typedef struct TubeCell {
    int      x, y;     /* within its tile, in cells of its level; -1 and tile_side at level 0: about it */
    int      from, to; /* mirrors that count here: from <= mirror < to; the rest is its parent's, its children's */
    int      marks;
    TubeMark mark[trail_most];
} TubeCell;

/* Hits of one tile, in its worker's list. */
typedef struct TubePiece {
    int       worker;
    bool      failed; /* out of memory */
    size_t    first, count;
    long long rays;
} TubePiece;

typedef struct TubeTile TubeTile;

typedef struct TubeWorker {
    TubeTile *tile; /* scratch */
    TubeHit  *hit;
    size_t    count, capacity;
    TubeCell *cell[2]; /* of a level and of the next */
    int       cells[2], cell_capacity[2];
    int32_t  *at; /* cells of the level by place, -1: none */
} TubeWorker;

typedef struct TubeWork {
    const RadarTarget *target;
    const uint8_t     *whole; /* [triangle_count], or NULL: TubeRest */
    ScatterAntenna     tx, rx;
    TubeConfig         config;
    TubeGrid           grid;
    double             k;
    bool               monostatic;
    int                levels;   /* at most, of divided cells */
    double             widest_m; /* a footprint's sides: wider ones are no tube any more */
    RadarSurface      *surface;  /* [part_count] */
    Warp              *warp;     /* [part_count] */
    TubeWorker        *worker;
    TubePiece         *piece; /* of this round's tiles */
    long long          first_tile;
} TubeWork;

size_t tube_tile_octets(void);
/* Follows tubes of a tile, at most tile_rays, and appends their hits to the worker's list; first: number of the first
 * cell, for the hits. level: 0: cells of the grid. False: out of memory. */
bool tube_follow(TubeWork *work, int worker, long long tile, int level, TubeCell *cell, int count, int first);
/* A tile of the grid, its cells divided as config says. */
void   tube_tile(TubeWork *work, int worker, long long tile, TubePiece *piece);
int    tube_levels(double spacing_m, double radius_m, const TubeConfig *config);
size_t tube_place_count(int levels); /* of TubeWorker.at */

#endif
