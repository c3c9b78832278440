/* render/trace/visibility/crowd.h: packets of rays through a tree of posed things (entities, scenery), nearest first.
 * The result is that of testing one after the other: the nearest hit, of equals that of the lowest index. */
#ifndef RENDER_TRACE_VISIBILITY_CROWD_H
#define RENDER_TRACE_VISIBILITY_CROWD_H

#include "render/trace/visibility/broad_phase.h"
#include "render/scene/hits.h"
#include "render/trace/parts/parts.h"

/* The things of a tree. Functions are thread-safe. */
typedef struct Crowd {
    const BroadPhase *tree;
    const BroadLift  *lift; /* by which the tree's boxes are raised; NULL: not at all */
    const PosedEntity *(*posed)(const void *self, int item); /* model < 0: there is nothing to meet */
    double (*lift_m)(const void *self, int item); /* how far an item is raised for these rays; NULL: not at all */
    const void *self;
    bool        ask_all; /* as of parts_first_hits */
} Crowd;

/* Those of them that rays may meet. */
typedef struct CrowdAmong {
    const int     *list;          /* [count], ascending */
    int            count;         /* -1: no list: all */
    int            hidden;        /* never met; -1: none */
    int            known;         /* an item whose hits are given, for every ray of a block; -1: none */
    const double  *known_range_m; /* INFINITY: not met */
    const PartHit *known_hit;
} CrowdAmong;

typedef struct CrowdCounts {
    uint64_t asked, asked_nodes, nodes; /* ray-item pairs, ray-node pairs; of the pairs' items all nodes */
} CrowdCounts;

/* First hits: limit_m, item (index + 1; 0: none) and hit of each ray of the order (order_rays) [count], in and out:
 * what was met before at limit_m has priority at equal range if its index is lower. among: NULL: all. */
void crowd_first_hits(double *limit_m, uint32_t *item, PartHit *hit, CrowdCounts *counts, const Crowd *crowd,
                      const double *const o[3], const double *const d[3], int count, const CrowdAmong *among,
                      const int *order);
/* dark becomes 1 where anything is met. */
void crowd_any_hits(uint8_t *dark, CrowdCounts *counts, const Crowd *crowd, int count, const double *const o[3],
                    const double *const d[3]);

/* Whether each ray comes within a sphere, ahead of it and before limit_m. */
void rays_meet_sphere(uint8_t *meets, int count, const double *const o[3], const double *const d[3],
                      const double *limit_m, const double centre[3], double radius_m);

/* A sphere round the origins of rays: its radius, m. */
double rays_bound_origins(double centre[3], int count, const double *const o[3]);

/* The next number after one that is finite and not below 0. */
static inline double next_up(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits++;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Heights of the origins of listed rays over those of a thing that is raised; z_m: memory. */
static inline const double *lowered(double *z_m, const double *oz_m, double lift_m, const int *list, int count)
{
    if (!(lift_m > 0)) return oz_m;
    for (int n = 0; n < count; n++) z_m[list[n]] = oz_m[list[n]] - lift_m;
    return z_m;
}

/* Rays of a picture's rows in squares of 4 x 4, which are traced as a packet; others as they are. */
static inline void order_rays(int order[hits_capacity], int count, int columns)
{
    const bool squares = columns > 1 && columns <= count && count % columns == 0;
    const int  width = squares ? columns : count, height = squares ? count / columns : 1;
    int        at = 0;
    for (int y0 = 0; y0 < height; y0 += 4)
        for (int x0 = 0; x0 < width; x0 += 4)
            for (int y = y0; y < y0 + 4 && y < height; y++)
                for (int x = x0; x < x0 + 4 && x < width; x++) order[at++] = y * width + x;
}

/* Indices of the active rays, in that order. */
static inline int list_asked(int list[hits_capacity], const int order[hits_capacity], const uint8_t *ask, int count)
{
    int listed = 0;
    for (int k = 0; k < count; k++) {
        list[listed] = order[k];
        listed += ask[order[k]] != 0;
    }
    return listed;
}

#endif
