/* render/trace/scenery/scenery_tracer_private.h: scenery as it is traced, made by scenery_tracer.c, traced by
 * scenery_trace.c. */
#ifndef RENDER_TRACE_SCENERY_SCENERY_TRACER_PRIVATE_H
#define RENDER_TRACE_SCENERY_SCENERY_TRACER_PRIVATE_H

#include "render/trace/scenery/scenery_heights_private.h"
#include "render/trace/scenery/scenery_tracer.h"
#include "render/trace/visibility/crowd.h"

struct SceneryTracer {
    const Scenery  *scenery;
    Tracer         *tracer;           /* of its models */
    Arena          *arena;            /* of all that follows */
    NodePose      **rest;             /* [models][nodes] */
    PosedEntity    *posed;            /* [objects]; of those that drive model is -1 */
    int            *mover;            /* [objects]: index + 1 of SceneryFrame.moved; 0: it stands as it is */
    int             moved;            /* of Scenery.mover, and behind them objects whose damage changes: */
    int            *harmed;           /* [moved - movers]: objects */
    BroadPhase     *tree;             /* of those that stand */
    SceneryHeights *heights;          /* likewise; NULL: not known */
    int             drawable, moving; /* objects that stand, and that drive, and have something to meet */
    int            *row_first;        /* [models] of row */
    int            *row;              /* [parts][model_damage_states]: rows of materials */
};

struct SceneryFrame {
    const SceneryTracer *of;
    PosedEntity         *moved; /* [SceneryTracer.moved] */
    BroadPhase          *tree;  /* of what drives; NULL: nothing does */
    unsigned             skips_off;
    double               eye_enu[3];
    BroadLift            lift; /* bend_per_m 0: no ray bends */
};

static inline const PosedEntity *frame_posed(const SceneryFrame *f, int object)
{
    const int mover = f->of->mover[object];
    return mover ? &f->moved[mover - 1] : &f->of->posed[object];
}

static inline double frame_lift_m(const SceneryFrame *f, int object)
{
    const double *centre = frame_posed(f, object)->centre_enu;
    const double  x = centre[0] - f->lift.eye_enu[0], y = centre[1] - f->lift.eye_enu[1];
    return f->lift.bend_per_m * (x * x + y * y);
}

#endif
