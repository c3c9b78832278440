/* render/trace/scenery/scenery_tracer.h: rays against scenery (entities/scenery): buildings, works and clutter.
 *
 * Made once, for all frames: an Embree scene a node of each model (render/trace/parts), which its objects share, the
 * pose of every object that stands, and a tree over their boxes (render/trace/visibility/broad_phase.h). A frame poses
 * what drives and what is damaged in the course of the exercise, and nothing else. Hits, ranges and normals are as
 * those of entities' parts: exact, in double, of equal ranges that of the lowest object; the eye's rays that bend find
 * an object raised as a whole, by what the middle of its sphere is. */
#ifndef RENDER_TRACE_SCENERY_SCENERY_TRACER_H
#define RENDER_TRACE_SCENERY_SCENERY_TRACER_H

#include "entities/scenery/scenery.h"
#include "render/materials/materials.h"
#include "render/trace/visibility/visibility.h"

typedef struct SceneryTracer SceneryTracer;

/* scenery must outlive it. isa: as tracer_create. STATUS_BAD_VALUE: an object's model, or a mover's
 * object, is not there; it is logged. */
Status         scenery_tracer_create(SceneryTracer **out, const Scenery *scenery, const char *isa);
void           scenery_tracer_destroy(SceneryTracer *tracer); /* accepts NULL */
const Scenery *scenery_tracer_of(const SceneryTracer *tracer);
size_t         scenery_tracer_bytes(const SceneryTracer *tracer); /* of poses and tree, without models */
/* Finds the row of every part: before any frame, and again when rows have moved. path: of the table, for the log. */
Status scenery_tracer_materials(SceneryTracer *tracer, const Materials *materials, const char *path);

/* A box about an object that stands; false: it drives, or there is nothing to meet. */
bool scenery_tracer_box(const SceneryTracer *tracer, int object, double low[3], double high[3]);
/* Raises heights [ny][nx], at x0_m + i cell_m and y0_m + j cell_m, to the highest of what stands above each. */
void scenery_tracer_tops(float *z_m, const SceneryTracer *tracer, int nx, int ny, double x0_m, double y0_m,
                         double cell_m);

/* ---- a frame ---------------------------------------------------------------------------------- */

typedef struct SceneryFrame SceneryFrame;

typedef struct SceneryFrameOf {
    double   t_s;                    /* exercise time: what drives is where it is then */
    unsigned skips_off;              /* 1 << Skip */
    double   eye_enu[3], bend_per_m; /* as VisibilityConfig */
} SceneryFrameOf;

/* In the arena, which the frame does not outlive. Costs O(movers). */
Status scenery_frame_create(SceneryFrame **out, const SceneryTracer *tracer, const SceneryFrameOf *of, Arena *arena);
/* Joins what rays meet (render/trace/visibility/trace_entry.h): before anything is traced. frame must outlive v; NULL:
 * none. */
Status              scenery_frame_join(Visibility *v, const SceneryFrame *frame);
const SceneryFrame *scenery_frame_in(const Visibility *v); /* that joined; NULL: none */

/* Of all that rays can meet of it, to the bit; 0: NULL. */
uint64_t                  scenery_frame_hash(const SceneryFrame *frame);
const Scenery            *scenery_frame_of(const SceneryFrame *frame);
const struct PosedEntity *scenery_frame_posed(const SceneryFrame *frame, int object); /* model < 0: nothing to meet */
double                    scenery_frame_lift(const SceneryFrame *frame, int object);  /* for bent rays, m */
/* A hit's place and a direction in the body axes of its object. Of hits of kind hit_scenery. */
void scenery_frame_on_body(double p_body[3], double n_body[3], const SceneryFrame *frame, const Hits *hits, int i,
                           const double n_enu[3]);
/* Objects that may touch a box grown by more_m, ascending; conservative. list: room for all. */
int scenery_frame_near(int *list, const SceneryFrame *frame, const double low[3], const double high[3], double more_m);

#endif
