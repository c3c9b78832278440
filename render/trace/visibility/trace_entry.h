/* render/trace/visibility/trace_entry.h: what rays can meet: ground, parts, plants, and whatever joins them.
 *
 * The entries of a frame stand in one list. Each is asked for a whole block of rays; of equal ranges the earlier in
 * the list has the hit. Which is asked first is another matter: the turn, so that one that is met cheaply spares the
 * others their search. No bit of the result depends on the turns. */
#ifndef RENDER_TRACE_VISIBILITY_TRACE_ENTRY_H
#define RENDER_TRACE_VISIBILITY_TRACE_ENTRY_H

#include "render/scene/hits.h"

/* render/trace/visibility/visibility.h */
typedef struct Visibility         Visibility;
typedef struct VisibilityCounters VisibilityCounters;
typedef struct RayEntities        RayEntities;

enum {
    trace_entries = 8,                      /* at most, in a frame */
    trace_found_octets = 96 * hits_capacity /* of all entries of a frame together */
};

/* Rays of a block, and what is known of them when an entry is asked. */
typedef struct TraceBlock {
    const Visibility    *v;
    const Rays          *rays;
    const double *const *o_enu, *const *d_enu; /* [3][rays->count], those of rays */
    const RayEntities  *among;
    double              limit_m[hits_capacity]; /* nothing from here on can be a first hit of this entry */
    uint8_t             met[hits_capacity];     /* some entry was met by now: 1 + its place in the list; else 0 */
    VisibilityCounters *counters;
} TraceBlock;

/* Rays that leave hits in one direction without limit. */
typedef struct TraceShadow {
    const Visibility    *v;
    const Hits          *hits;
    const int           *hit_of; /* [count]: whence each ray comes */
    int                  count;
    const double *const *o_enu, *const *d_enu; /* [3][count]; d_enu the same for all: */
    const double       *way_enu;
    uint8_t            *dark; /* [count], in and out: 1: stopped */
    VisibilityCounters *counters;
} TraceShadow;

/* self: as given to visibility_add. found: [found_octets] of memory, aligned for anything, from first_hits to finish
 * of the same block. All functions are thread-safe. */
typedef struct TraceEntry {
    int    turn; /* the lower are asked first; of equal ones, the earlier in the list */
    size_t found_octets;
    /* Writes every range_m: of the first hit nearer than limit_m, m, or INFINITY. Of a ray that met something, one
     * beyond limit_m is not taken; of one that met nothing, limit_m is its far_m, and nothing beyond is written. */
    void (*first_hits)(double *range_m, void *found, const TraceBlock *block, const void *self);
    /* Of hits that are this entry's, those listed (ascending): kind, instance, material, normals
     * (visibility_store_normals) and what its kind has of its own. range_m and p_enu are there; all else is 0, albedo,
     * open_up and open_down are 1. */
    void (*finish)(Hits *hits, const int *list, int count, const void *found, const TraceBlock *block,
                   const void *self);
    /* dark becomes 1 where something is met. What is dark already may be left out. */
    void (*any_hits)(const TraceShadow *shadow, const void *self);
} TraceEntry;

/* Puts an entry at the end of the list: before anything is traced. self must outlive the frame.
 * STATUS_NO_MEMORY: more entries, or more found_octets, than there is room for. */
Status visibility_add(Visibility *v, const TraceEntry *entry, const void *self);

/* self of an entry of the list; NULL: it is not in it. */
const void *visibility_self(const Visibility *v, const TraceEntry *entry);

/* Unit normals of a hit, on the ray's side; the shading normal is turned back to edge-on where it faces away. */
void visibility_store_normals(Hits *hits, int i, const double n_geo[3], const double n_enu[3], const double d_enu[3]);

#endif
