/* render/trace/visibility/visibility.h: first hits of rays, and shadows of the sun. The only interface to the tracing
 * of ground, parts, plants and what joins them (trace_entry.h).
 *
 * The ground is a height field, traced in double, scalar and eight wide with the same bits. Each moving part is
 * traced in its own node's frame: the ray is transformed there in double, advanced to the node's bounding sphere,
 * converted to float once and passed to Embree, which only finds candidate triangles; the hit, range and normal are
 * computed in double. Equal distances go to the lower id (ground before entity 1 before entity 2), and of one
 * entity's triangles, within 0.1 mm, to the lowest. */
#ifndef RENDER_TRACE_VISIBILITY_VISIBILITY_H
#define RENDER_TRACE_VISIBILITY_VISIBILITY_H

#include "pitviper.h"
#include "entities/table/snapshot.h"
#include "render/trace/plants/forest.h"
#include "render/materials/materials.h"
#include "render/trace/parts/parts.h"
#include "render/scene/hits.h"
#include "render/scene/view.h"
#include "terrain/elevation/elevation.h"
#include "terrain/ground/surface_cells.h"
#include "terrain/earth/geodesy.h"

/* ---- skips ----------------------------------------------------------------------------------- */

/* Skips: computations left out because they cannot change a bit of the result; each is named
 * and counted.
 *
 * Each may be disabled separately (RenderRequest.skips_off); the planes stay the same to the bit
 * (tests/sensor/test_skips.c, over random scenes), and `pitviper bench skip` reports what each saves. */
typedef enum Skip {
    SKIP_BLOCK,         /* view-frustum cull: entities whose sphere a block of pixels cannot see */
    SKIP_SPHERE,        /* an entity, for rays that miss its sphere or met something before it */
    SKIP_PART,          /* a part, for rays that miss the entity's box or the part's sphere */
    SKIP_GROUND_BEHIND, /* ground beyond the part that a ray met */
    SKIP_GROUND_BELOW,  /* ground that is below all of a block's rays up to the parts they met */
    SKIP_GROUND_WALK,   /* steps of the ground's pyramid that neighbouring rays share */
    SKIP_SUN_SPHERE,    /* an entity, for sun rays that miss its sphere or are stopped already */
    SKIP_SUN_STOPPED,   /* ground and plants, for sun rays that are stopped already */
    SKIP_SUN_CLEAR,     /* ground, for sun rays from where nothing towards the sun is high enough */
    SKIP_AMODAL,        /* the amodal test of an entity, for rays on which none of it is behind the hit */
    SKIP_CELL,          /* rays over a small target's box that miss it, and meeting it a second time */
    SKIP_RETRACE,       /* a pixel's first ray, when more are traced: its planes still hold its hit */
    SKIP_SMOKE,         /* smoke and dust that a block of pixels cannot see */
    SKIP_LIGHT,   /* light of sample points that a neighbouring hit has computed already in this frame, or none needs */
    SKIP_TREE,    /* entities that the tree of their spheres leaves out: blocks, rays, sun rays, places near */
    SKIP_KEPT,    /* paths from sample points whose meetings an earlier frame left (render/light/sky_visibility.h) */
    SKIP_SCENERY, /* scenery that the trees of its boxes leave out: blocks, rays, sun rays */
    SKIP_COUNT
} Skip;

enum { skips_all_off = (1 << SKIP_COUNT) - 1 };

const char *visibility_skip_name(Skip skip); /* as in run.json: "block", "sphere" ... */
const char *visibility_skip_what(Skip skip); /* one line of description, with the unit of its count */

static inline bool skips(unsigned off, Skip skip) { return !(off >> skip & 1); }

/* ---- hits and shadows ------------------------------------------------------------------------ */

/* One frame's world: a tree over the spheres of all entities (render/trace/visibility/broad_phase.h), and the
 * nodes of those that are needed. Posing costs transforms only; nothing is committed or kept between frames, so any
 * number of them may be alive and traced at once. */
typedef struct Visibility Visibility;

typedef struct VisibilityCounters {
    uint64_t rays_ground, rays_parts, rays_sun_ground, rays_sun_parts; /* tests of each tracer */
    uint64_t rays_plants, rays_sun_plants;                             /* that entered some plant's box */
    uint64_t rays_scenery, rays_sun_scenery;                           /* ray-object pairs that were tested */
    uint64_t hits_by_table;     /* first hits of plants by their tables (render/trace/plants/forest_table.c) */
    uint64_t rays_sun_for_heat; /* rays to the sun that gave leaves their temperature, and light as well */
    uint64_t skipped_parts, skipped_sun_parts; /* ray x entity pairs proven empty */
    uint64_t skipped[SKIP_COUNT];              /* in the units of visibility_skip_what */
} VisibilityCounters;

/* ground may be NULL (none). The arena owns what the frame needs, and is used while the frame is traced: by no other
 * thread then. frame and snapshot must outlive it. skips_off: 1 << Skip. */
Status visibility_create(Visibility **out, Tracer *tracer, const Landscape *ground, const LocalFrame *frame,
                         const Snapshot *snapshot, unsigned skips_off, Arena *arena);

/* The same for an eye in air. Its rays (Rays.bent) sink below their straight lines (terrain/earth/refraction.h), and so
 * do functions below that take a view; range_m is along the straight line, places of hits are where things are. An
 * entity is raised as a whole, by what its origin is. All other rays are straight. */
typedef struct VisibilityConfig {
    Tracer           *tracer;
    const Landscape  *ground;
    const LocalFrame *frame;
    const Snapshot   *snapshot;
    unsigned          skips_off;
    double            eye_enu[3], bend_per_m; /* 0: straight */
    SurfaceCells     *cells;                  /* of the ground; may be NULL */
} VisibilityConfig;

Status visibility_create_seen(Visibility **out, const VisibilityConfig *config, Arena *arena);

/* Its bend_per_m; how far things at a place are raised for the eye, m; and entity `index`. */
double visibility_bend(const Visibility *v);
double visibility_lift_at(const Visibility *v, const double p_enu[3]);
double visibility_lift(const Visibility *v, int index);

/* Whether a place lies outside of the terrain, where the round Earth goes on: its hits have a surface there, which the
 * landscape does not know. */
bool visibility_is_beyond(const Visibility *v, double x_m, double y_m);

/* Entities of the snapshot, and their poses, each computed on first use (by any thread); its model is -1 where it
 * cannot be drawn (render/trace/parts/parts.h). */
struct PosedEntity;
int                       visibility_count(const Visibility *v);
const struct PosedEntity *visibility_posed(const Visibility *v, int index);

/* Where there are many entities: rays are tested with the boxes of those that are posed by now, and no longer with
 * their spheres. No bit depends on it. One thread, before the rays. */
void visibility_tighten(const Visibility *v);

/* The table that Hits.material indexes: set before anything is traced. Without: all 0. It must outlive the frame. */
void visibility_materials(Visibility *v, const Materials *materials);

/* The plants join the list of what rays meet (render/trace/visibility/trace_entry.h; so do others), before anything is
 * traced. It must outlive the frame. STATUS_NO_MEMORY: the list is full. */
Status visibility_plants(Visibility *v, const ForestFrame *plants);
/* The same frame without them, in the arena; v itself where there are none. NULL: no memory. */
const Visibility *visibility_without_plants(const Visibility *v, Arena *arena);
/* The same frame with every plant at its full detail; v itself where no plant is simplified. NULL: no memory. */
const Visibility *visibility_with_full_plants(const Visibility *v, Arena *arena);

/* A hit's place on its part, and a direction, in the axes of the part's node: moves with the part. Of hits of kind
 * hit_part. */
void visibility_on_part(double p_node[3], double n_node[3], const Visibility *v, const Hits *hits, int i,
                        const double n_enu[3]);

/* STATUS_NO_MEMORY: some entity could not be posed, and the frame is incomplete. To be called once tracing is done. */
Status visibility_status(const Visibility *v);

/* Entities that may touch a box grown by more_m, ascending; conservative: each must still be tested. list: capacity
 * = snapshot count. */
int visibility_near(int *list, const Visibility *v, const double low[3], const double high[3], double more_m);

/* View-frustum cull: the entities that a pixel block may see, those whose bounding sphere meets the block's pyramid
 * (all of them without SKIP_BLOCK). box_px: x0, y0, x1, y1. list: capacity = snapshot count; returns the count,
 * ascending. hidden: never listed (-1). */
int visibility_block_entities(int *list, const Visibility *v, const View *view, const double box_px[4], int hidden,
                              VisibilityCounters *counters);

/* What rays meet of one entity with nothing else in the world; INFINITY: nothing. */
typedef struct EntityHits {
    int     entity; /* snapshot index */
    double  range_m[hits_capacity];
    PartHit hit[hits_capacity];
} EntityHits;
void visibility_entity_hits(EntityHits *out, const Visibility *v, const Rays *rays, int index,
                            VisibilityCounters *counters);

/* The entities that a block's rays may meet, as snapshot indices. */
typedef struct RayEntities {
    const int        *list;   /* [count], ascending */
    int               count;  /* -1: no list: every entity, culled per ray */
    int               hidden; /* never met; -1: none */
    const EntityHits *known;  /* of these rays: that entity is not traced again; NULL: none */
} RayEntities;

static inline RayEntities visibility_all_but(int hidden) { return (RayEntities){NULL, -1, hidden, NULL}; }
static inline RayEntities visibility_listed(const int *list, int count, int hidden)
{
    return (RayEntities){list, count, hidden, NULL};
}

/* First hits of a block against the ground, the plants and these entities. Thread-safe; counters are the caller's
 * own. */
void visibility_first_hit(Hits *hits, const Visibility *v, const Rays *rays, RayEntities among,
                          VisibilityCounters *counters);
/* Their ranges alone, and the entity that is met, snapshot index + 1; 0: none. range_m INFINITY: nothing. */
void visibility_first_range(double *range_m, uint32_t *entity, const Visibility *v, const Rays *rays, RayEntities among,
                            VisibilityCounters *counters);
/* First hits as if there were neither ground nor plants. */
void visibility_first_part(Hits *hits, const Visibility *v, const Rays *rays, RayEntities among,
                           VisibilityCounters *counters);

/* 1 where any entity (also the hidden host), the ground or a plant is between the hit and the direction d_enu, else 0;
 * 0 for sky hits. Origins are offset along the geometric normal by 1 mm; surfaces that face away give 1, but those that
 * let light through (Material.tau) are lit from either side: their origins are on the side that d_enu leads to. */
void visibility_shadow(uint8_t *shadow, const Visibility *v, const Hits *hits, const double d_enu[3],
                       VisibilityCounters *counters);

/* Whether each ray would meet entity `index` with nothing else in the world (amodal truth). */
void visibility_entity_only(uint8_t *meets, const Visibility *v, const Rays *rays, int index,
                            VisibilityCounters *counters);

/* Whether any part of entity `index` may lie farther along each ray than its first hit, at range_m, of a search that
 * included it; otherwise the ray misses it. All 1 without SKIP_AMODAL. */
void visibility_lie_beyond(uint8_t *may, const Visibility *v, int index, const Rays *rays, const double *range_m);

/* Bounding box of an entity on the image (of its vertices; through a lens, which bows them, of its edges), clipped to
 * nothing: x0, y0, x1, y1 in px. False when any of its box is behind the eye. */
bool visibility_project_box(double box_px[4], const Visibility *v, const View *view, int index);

#endif
