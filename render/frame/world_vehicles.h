/* render/frame/world_vehicles.h: temperatures of the entities of one exercise in a world: render/heat/vehicle_heat.h with the
 * weather's course, and the heat of the world's ground. */
#ifndef RENDER_FRAME_WORLD_VEHICLES_H
#define RENDER_FRAME_WORLD_VEHICLES_H

#include "render/frame/world.h"
#include "render/heat/vehicle_heat.h"

typedef struct WorldVehicles WorldVehicles;

/* Of a node: VehicleHeatConfig.window_us. At ten frames a second or more no frame pays for more. */
static const double vehicle_window_us = 3300;

typedef struct WorldVehiclesConfig {
    double step_s;            /* of entities whose drives do not change */
    double window_us;         /* VehicleHeatConfig */
    int    past_parts;        /* VehicleHeatConfig; 0: 1 */
    const GivenHeat *given;   /* VehicleHeatWorld; so is: */
    const KeptHeat  *kept;
} WorldVehiclesConfig;

/* The world must be warm, and outlive it. */
Status world_vehicles_create(WorldVehicles **out, const World *world, const WorldVehiclesConfig *config);
void   world_vehicles_destroy(WorldVehicles *vehicles); /* accepts NULL */
/* Of VehicleHeat: ticks in order of time; the frame's snapshot after those up to its time. */
Status world_vehicles_tick(WorldVehicles *vehicles, const Snapshot *snapshot);
Status world_vehicles_show(const WorldVehicles *vehicles, Snapshot *snapshot, Arena *arena);
const VehicleHeat *world_vehicles_heat(const WorldVehicles *vehicles);

/* Temperatures of a snapshot that has no past: as entities begin. What benches and pictures of models need. */
Status world_warm_snapshot(Snapshot *snapshot, const World *world, Arena *arena);

#endif
