/* render/trace/visibility/visibility_private.h: one frame's world, shared by the files visibility*.c. */
#ifndef RENDER_TRACE_VISIBILITY_VISIBILITY_PRIVATE_H
#define RENDER_TRACE_VISIBILITY_VISIBILITY_PRIVATE_H

#include <pthread.h>
#include <stdatomic.h>

#include "render/trace/ground/ground.h"
#include "render/trace/parts/parts.h"
#include "render/trace/visibility/broad_phase_private.h"
#include "render/trace/visibility/trace_entry.h"
#include "render/trace/visibility/visibility.h"

/* Up to so many entities are tested one after the other, all rays of a block together; more are traversed by the
 * tree, in packets. Both give the same bits. */
enum { crowd_least = 40 };

/* What posing needs beside the snapshot: for one thread at a time. */
typedef struct Poser {
    pthread_mutex_t lock;
    Arena          *arena;
    NodePose       *node;        /* [most nodes of a model] */
    double         *joint_value; /* likewise */
    atomic_bool     lost;        /* no memory for some entity: the frame is incomplete */
} Poser;

/* An entry of the list; found: where its memory begins. */
typedef struct ListedEntry {
    const TraceEntry *of;
    const void       *self;
    size_t            found;
} ListedEntry;

struct Visibility {
    ListedEntry                   entry[trace_entries];
    int                           entries, in_turn[trace_entries];
    size_t                        found_octets;
    Tracer                       *tracer;
    const Landscape              *landscape;
    const Materials              *materials; /* NULL: hits have no material */
    const LocalFrame             *frame;
    const Snapshot               *snapshot;
    Ground                        ground, seen; /* seen: of bent rays */
    double                        eye_enu[3];
    const struct RoundEarth      *round;       /* NULL: the eye does not look beyond the terrain */
    const double                 *lift_m;      /* [count]: of entities for bent rays; NULL: 0 */
    bool                          full_plants; /* none is simplified */
    unsigned                      skips_off;
    int                           count, drawable;
    bool                         *loose; /* [count]: may be drawn, as far as is known without its nodes */
    _Atomic(const PosedEntity *) *posed; /* [count], as in the snapshot; NULL: not posed yet */
    Poser                        *poser;
    BroadPhase                   *tree; /* of those that may be drawn */
    double wider_m;                     /* distance by which the sphere of a posed entity may exceed that in the tree */
};

/* How far a bent ray has sunk at a range, m. */
static inline double ray_drop(const Visibility *v, const Rays *rays, int i, double range_m)
{
    const double x = range_m * rays->d_enu[0][i], y = range_m * rays->d_enu[1][i];
    return v->seen.bend_per_m * (x * x + y * y);
}

/* How far an entity is raised for these rays, m. */
static inline double lift_for(const Visibility *v, const Rays *rays, int index)
{
    return rays->bent && v->lift_m ? v->lift_m[index] : 0;
}

/* Heights of the origins of listed rays over those of an entity that is raised; z_m: memory. */
static inline const double *lowered(double *z_m, const double *oz_m, double lift_m, const int *list, int count)
{
    if (!(lift_m > 0)) return oz_m;
    for (int n = 0; n < count; n++) z_m[list[n]] = oz_m[list[n]] - lift_m;
    return z_m;
}

/* Whether each ray comes within an entity's sphere, ahead of it and before limit_m. */
void rays_meet_sphere(uint8_t *meets, int count, const double *const o[3], const double *const d[3],
                      const double *limit_m, const double centre[3], double radius_m);

extern const TraceEntry trace_ground, trace_parts; /* self: NULL */
/* The entity that a ray met, snapshot index + 1, of what trace_parts found. */
uint32_t parts_found_entity(const void *found, int ray);

/* visibility_beyond.c: the Earth beyond the terrain's outline, where the eye may look there. */
typedef struct RoundEarth RoundEarth;
extern const TraceEntry   trace_beyond; /* self: RoundEarth */
Status                    visibility_round_earth(Visibility *v, Arena *arena);

/* visibility_crowd.c. First hits by the tree; limit_m, entity (index + 1) and hit are as if all of block->among had
 * been tested one after the other. order: as of order_rays. */
typedef struct CrowdCounts {
    uint64_t asked, asked_nodes, nodes; /* ray-entity pairs, ray-node pairs; of the pairs' entities all nodes */
} CrowdCounts;
void crowd_first_hits(double *limit_m, uint32_t *entity, PartHit *hit, CrowdCounts *counts, const TraceBlock *block,
                      const int *order);
/* dark becomes 1 where anything is met. */
void crowd_any_hits(uint8_t *dark, CrowdCounts *counts, const Visibility *v, int count, const double *const o[3],
                    const double *const d[3]);

/* ---- rays of a block -------------------------------------------------------------------------- */

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
