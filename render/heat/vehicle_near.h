/* render/heat/vehicle_near.h: what entities do to each other's heat: they stand in each other's sun, take each
 * other's sky and ground, and their exhaust blows on each other.
 *
 * Who is a neighbour: neighbours.h; once a second it is looked for anew, and a step of the entity ends when one
 * came, went, moved by 0.3 m (and by a twentieth of its distance, where it is seen alone) or turned by 10 degrees
 * against it. Seen is a patch of the neighbour, black in the longwave as an entity's own are, as warm as its network
 * had it when the tick began, with the sunlight that it reflected at its own last time; one that is not shown yet,
 * and any neighbour in the past before an entity's first report, is as warm as the air and as bright as the ground.
 * Munitions and expendables have no neighbours and are none.
 *
 * Error: a ray is 1/96 of a share. */
#ifndef RENDER_HEAT_VEHICLE_NEAR_H
#define RENDER_HEAT_VEHICLE_NEAR_H

#include "render/heat/vehicle_state.h"

/* All that have a state, at a tick. */
typedef struct NearScene {
    const Snapshot      *snapshot;
    const Tracer        *tracer;
    const VehicleShape  *shape;  /* [models] */
    const LocalFrame    *frame;
    VehicleState *const *state;  /* [count], by id */
    NearBody            *body;   /* [count]: near_scene_bodies fills them */
    int                  count;
} NearScene;

void near_scene_bodies(NearScene *scene);

/* Looks for the neighbours of state[me]. changed: of others than before, or of others in their places. left_out: beyond
 * neighbours.h's numbers. STATUS_NO_MEMORY. */
Status vehicle_near_check(bool *changed, int *left_out, const NearScene *scene, int me, const double sun_d_enu[3]);

/* Whether it has neighbours whom it has not looked at. */
static inline bool vehicle_near_waits(const VehicleState *s, const VehicleShape *shape)
{
    return s->near && s->near->looked < shape->patches->count;
}

/* Those it looks at, as they are posed now, in the arena; pose[k] NULL: gone. */
Status vehicle_near_pose(const PatchPose *pose[near_seen_most], const NearScene *scene, const VehicleState *state,
                         const VehicleMoment *moment, Arena *arena);
/* The next patch. */
void   vehicle_near_look(VehicleState *state, const VehicleMoment *moment, const PatchPose *const *pose);

/* What its neighbours do to it, into a moment whose place is known. past: before its first report; lately: and
 * engines run as now. Returns how many it posed, and how many jets it followed, in the arena. */
typedef struct NearWork {
    int poses, jets;
} NearWork;
Status vehicle_near_moment(NearWork *work, VehicleMoment *moment, const NearScene *scene, int me, double t_s, bool past,
                           bool lately, Arena *arena);

#endif
