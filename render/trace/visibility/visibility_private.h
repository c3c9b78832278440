/* render/trace/visibility/visibility_private.h: one frame's world, shared by the files visibility*.c. */
#ifndef RENDER_TRACE_VISIBILITY_VISIBILITY_PRIVATE_H
#define RENDER_TRACE_VISIBILITY_VISIBILITY_PRIVATE_H

#include <pthread.h>
#include <stdatomic.h>

#include "render/trace/ground/ground.h"
#include "render/trace/parts/parts.h"
#include "render/trace/visibility/crowd.h"
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
    SurfaceCells                 *cells;
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

extern const TraceEntry trace_ground, trace_parts; /* self: NULL */
/* The entity that a ray met, snapshot index + 1, of what trace_parts found. */
uint32_t parts_found_entity(const void *found, int ray);

/* visibility_beyond.c: the Earth beyond the terrain's outline, where the eye may look there. */
typedef struct RoundEarth RoundEarth;
extern const TraceEntry   trace_beyond; /* self: RoundEarth */
Status                    visibility_round_earth(Visibility *v, Arena *arena);

#endif
