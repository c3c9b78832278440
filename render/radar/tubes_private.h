/* render/radar/tubes_private.h: between tubes.c, the grid and the list, and tubes_trace.c, a tile of tubes. */
#ifndef RENDER_RADAR_TUBES_PRIVATE_H
#define RENDER_RADAR_TUBES_PRIVATE_H

#include "render/radar/tubes.h"
#include "render/radar/warp.h"

enum { tile_side = 16, tile_rays = tile_side * tile_side };

/* Points of a plane through the target's middle, across the line from the transmitter. */
typedef struct TubeGrid {
    bool      plane;                 /* a plane wave; else from antenna */
    double    antenna[3], distance_m;
    double    centre[3], axis[3], side[2][3];
    double    spacing_m, first_m[2]; /* first_m: of the first ray */
    double    back_m;                /* rays begin so far before the plane */
    int       count[2], tiles[2];
} TubeGrid;

typedef struct TubeHit {
    double   path_m;
    float    slope_m[2], amplitude[8], first[3], last[3];
    uint8_t  bounce;
    uint16_t part;
} TubeHit;

/* Hits of one tile, in its worker's list. */
typedef struct TubePiece {
    int    worker;
    bool   failed; /* out of memory */
    size_t first, count;
} TubePiece;

typedef struct TubeTile TubeTile;

typedef struct TubeWorker {
    TubeTile *tile; /* scratch */
    TubeHit  *hit;
    size_t    count, capacity;
} TubeWorker;

typedef struct TubeWork {
    const RadarTarget *target;
    ScatterAntenna     tx, rx;
    TubeConfig         config;
    TubeGrid           grid;
    double             k;
    bool               monostatic;
    double             widest_m; /* a footprint's sides: wider ones are no tube any more */
    RadarSurface      *surface; /* [part_count] */
    Warp              *warp;    /* [part_count] */
    TubeWorker        *worker;
    TubePiece         *piece;   /* of this round's tiles */
    long long          first_tile;
} TubeWork;

size_t tube_tile_octets(void);
void   tube_tile(TubeWork *work, int worker, long long tile, TubePiece *piece);

#endif
