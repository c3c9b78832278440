/* tests/scenes/plate_vehicle.h: a made-up vehicle as a network of thermal nodes, for figures of its solver:
 * plates of 2 kJ/K to 2 MJ/K that conduct to and radiate to neighbours, in air, sun and the engine's heat. Node 0 is
 * held. */
#ifndef TESTS_SCENES_PLATE_VEHICLE_H
#define TESTS_SCENES_PLATE_VEHICLE_H

#include "render/heat/heat_network_private.h"

enum { vehicle_most_nodes = 100, vehicle_flows = 3 }; /* links, and exchanges, a node */

typedef struct PlateVehicle {
    int             nodes;
    double          capacity_j_k[vehicle_most_nodes], start_k[vehicle_most_nodes];
    NetworkLink     link[vehicle_flows * vehicle_most_nodes];
    NetworkExchange exchange[vehicle_flows * vehicle_most_nodes];
} PlateVehicle;

/* nodes: 10 .. vehicle_most_nodes. */
void   plate_vehicle(PlateVehicle *out, int nodes);
Status plate_vehicle_create(Network **out, const PlateVehicle *vehicle);
/* At t_s: clouds of ten minutes, wind of five, an engine at 300 s on for half an hour of each hour. */
void plate_vehicle_loads(NetworkLoad *out, const PlateVehicle *vehicle, double t_s);

#endif
