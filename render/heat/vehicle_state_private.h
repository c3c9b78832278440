/* render/heat/vehicle_state_private.h: the thermal state of one entity: temperatures at its own last time and at its
 * next one, what its patches see, and what it did.
 *
 * Temperatures in between are on straight lines. Within a tick others read those that it had when the tick began,
 * whether or not its own work of that tick is done: so the order of work decides nothing. */
#ifndef RENDER_HEAT_VEHICLE_STATE_PRIVATE_H
#define RENDER_HEAT_VEHICLE_STATE_PRIVATE_H

#include "render/heat/given_heat.h"
#include "render/heat/vehicle_load_private.h"
#include "render/heat/view_memory.h"

/* A neighbour as it was posed when its entity last looked: in that one's axes. */
typedef struct NearKey {
    DisEntityId id;
    unsigned    why;
    double      p_body[3], r_body[9];
} NearKey;

/* The neighbours of an entity. */
typedef struct VehicleNear {
    int         count, seen, next_seen; /* of key; of id; of next_id */
    int         looked;                 /* patches of next; all: view is of the keys' poses */
    NearKey     key[near_most];
    DisEntityId id[near_seen_most], next_id[near_seen_most]; /* others of view, of next */
    double      fill;        /* of next: the sum of their (radius / distance)^2, what rays cost */
    NearView   *view, *next; /* [patches] */
} VehicleNear;

typedef struct VehicleState {
    DisEntityId  id;
    double       since_s;
    int          model;
    double       t_s, next_s, span_s;
    EntityDrives drives;
    double       up_body[3], ahead_enu[3];
    double       heat_in_j;
    double      *temp_k;         /* [nodes] at t_s; zeroes: its past has not begun */
    float       *now_k, *next_k; /* [patches] at t_s, next_s */
    double      *joint;          /* [model nodes]: as view saw them */
    double       view_up_body[3];
    PatchView   *view; /* [patches] */
    double       view_above_m;
    int          looked, lived;         /* patches whose view is of that pose; steps of its past that are done */
    bool         shown, changed;        /* its past is over; its drives are others than those of t_s */
    double       seen_s, waits_s;       /* first seen; since when work waits, INFINITY: none does */
    NetworkLoad *load;                  /* [nodes] at t_s */
    int         *given;                 /* [patches] of GivenHeat, -1: none */
    int          index;                 /* in the snapshot of the tick */
    float       *sent_w_m2;             /* [patches]: sunlight that they reflect, at t_s */
    float       *was_k, *was_sent_w_m2; /* [patches]: as shown at was_s, before its work of that tick */
    double       was_s;
    bool         was_shown;
    VehicleNear *near;      /* NULL: it has no neighbours */
    double       checked_s; /* when they were looked for */
} VehicleState;

VehicleState *vehicle_state_create(const VehicleShape *shape, const Model *model);
void          vehicle_state_destroy(VehicleState *state); /* accepts NULL */
size_t        vehicle_state_bytes(const VehicleState *state, const VehicleShape *shape, const Model *model);
/* Of state[count], by id: the index, or -1. */
int  vehicle_state_find(VehicleState *const *state, int count, DisEntityId id);
void vehicle_state_given(VehicleState *state, const GivenHeat *given, const Patches *patches, const Model *model);

/* Temperature of a patch at t_s, of its own past or given. */
double vehicle_state_k(const VehicleState *state, const GivenHeat *given, int patch, double t_s);
/* Of its own past, as it was when the tick of t_s began; false: it was not shown. sent_w_m2: of sunlight. */
bool vehicle_state_then(double *temp_k, double *sent_w_m2, const VehicleState *state, int patch, double t_s);
/* Before its first work of a tick. */
void vehicle_state_remember(VehicleState *state, int patches, double t_s);

/* It has come to t_s, by this moment. */
void vehicle_state_stay(VehicleState *state, const VehicleMoment *moment, double t_s);
/* Whether what heats it has changed so that its step must end. */
bool vehicle_state_changed(const VehicleState *state, const SnapshotEntity *now, const double r_enu_from_body[9]);
/* Whether its views are of this pose; and that they are to be. */
bool vehicle_state_sees(const VehicleState *state, const VehicleMoment *moment);
void vehicle_state_look(VehicleState *state, const VehicleMoment *moment);

/* ---- neighbours ------------------------------------------------------------------------------ */

/* What entities do to each other's heat: they stand in each other's sun, take each
 * other's sky and ground, and their exhaust blows on each other.
 *
 * Who is a neighbour: vehicle_neighbours_find; once a second it is looked for anew, and a step of the entity ends when
 * one came, went, moved by 0.3 m (and by a twentieth of its distance, where it is seen alone) or turned by 10 degrees
 * against it. Seen is a patch of the neighbour, black in the longwave as an entity's own are, as warm as its network
 * had it when the tick began, with the sunlight that it reflected at its own last time; one that is not shown yet,
 * and any neighbour in the past before an entity's first report, is as warm as the air and as bright as the ground.
 * Munitions and expendables have no neighbours and are none.
 *
 * Error: a ray is 1/96 of a share. */

/* All that have a state, at a tick. */
typedef struct NearScene {
    const Snapshot      *snapshot;
    const Tracer        *tracer;
    const VehicleShape  *shape; /* [models] */
    const LocalFrame    *frame;
    VehicleState *const *state; /* [count], by id */
    NearBody            *body;  /* [count]: vehicle_near_bodies fills them */
    int                  count;
} NearScene;

void vehicle_near_bodies(NearScene *scene);

/* Looks for the neighbours of state[me]. changed: of others than before, or of others in their places. left_out: beyond
 * the numbers of vehicle_load_private.h. STATUS_NO_MEMORY. */
Status vehicle_near_check(bool *changed, int *left_out, const NearScene *scene, int me, const double sun_d_enu[3]);

/* Whether it has neighbours whom it has not looked at. */
static inline bool vehicle_near_waits(const VehicleState *s, const VehicleShape *shape)
{
    return s->near && s->near->looked < shape->patches->count;
}

/* Those it looks at, as they are posed now, in the arena; pose[k] NULL: gone. */
Status vehicle_near_pose(const PatchPose *pose[near_seen_most], const NearScene *scene, const VehicleState *state,
                         const VehicleMoment *moment, Arena *arena);
/* The next patch. seen: what is known of these poses. */
void vehicle_near_look(VehicleState *state, const VehicleMoment *moment, const PatchPose *const *pose,
                       const KnownViews *seen);

/* What its neighbours do to it, into a moment whose place is known. past: before its first report; lately: and
 * engines run as now. Returns how many it posed, and how many jets it followed, in the arena. */
typedef struct NearWork {
    int poses, jets;
} NearWork;
Status vehicle_near_moment(NearWork *work, VehicleMoment *moment, const NearScene *scene, int me, double t_s, bool past,
                           bool lately, Arena *arena);

#endif
