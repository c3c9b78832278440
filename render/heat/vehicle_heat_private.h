/* render/heat/vehicle_heat_private.h: the heat of all entities, and the account of the work on it, shared by
 * vehicle_heat.c (who is there, and what is shown) and vehicle_work.c (the work on one of them). */
#ifndef RENDER_HEAT_VEHICLE_HEAT_PRIVATE_H
#define RENDER_HEAT_VEHICLE_HEAT_PRIVATE_H

#include "render/heat/vehicle_heat.h"
#include "render/heat/vehicle_state_private.h"

/* An account of work in pieces: no more than a limit in any 0.1 s of exercise time, in
 * units that are the same on every machine.
 *
 * Ticks are of 10 ms. Before the second one nothing is limited. In an empty window there is room for any piece. */
enum { window_ticks = 10 };

typedef struct WorkWindow {
    double tick, spent_us[window_ticks]; /* the last; work of those up to it, in turn */
    bool   started, metered;             /* metered: after the first tick */
} WorkWindow;

/* At a time not before the last. */
void work_window_open(WorkWindow *window, double t_s);

struct VehicleHeat {
    VehicleHeatConfig   config;
    VehicleHeatWorld    world;
    VehicleShape       *shape; /* [models] */
    bool               *shaped;
    double             *met_s; /* [models]: when it was first met, while its patches are cut; NAN: not */
    int                 models, count, room, waiting;
    VehicleState      **state, **was; /* [count], by id; of the tick before */
    VehicleState      **due;          /* [room]: those whose work waits, of a tick */
    NearBody           *body;         /* [room] */
    NearScene           near;         /* of a tick */
    bool                bodied;       /* its bodies are filled in */
    WorkWindow          window;
    Arena              *arena; /* of one entity's step */
    VehicleHeatCounters counters;
};

/* As much as there is room for of what waits: a step, views, the past. */
Status vehicle_work_on(VehicleHeat *h, VehicleState *s);

#endif
