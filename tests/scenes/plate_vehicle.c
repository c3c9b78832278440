/* tests/scenes/plate_vehicle.c: the nodes of the vehicle, and what it stands in. */
#include "tests/scenes/plate_vehicle.h"

static double dice(uint32_t stream, int i) { return random_uniform(1943, stream, 0, (uint64_t)i); }

void plate_vehicle(PlateVehicle *out, int nodes)
{
    out->nodes = nodes;
    for (int i = 0; i < nodes; i++) {
        out->capacity_j_k[i] = i == 0 ? INFINITY : 2e3 * pow(1e3, dice(0, i));
        out->start_k[i] = 285 + 20 * dice(1, i);
    }
    for (int k = 0; k < vehicle_flows * nodes; k++) {
        const int a = k % nodes; /* to one of the next few: a vehicle's parts are not all in one another's sight */
        out->link[k] = (NetworkLink){a, (a + 1 + (int)(6 * dice(2, k))) % nodes, 0.05 * pow(400, dice(3, k))};
        out->exchange[k] = (NetworkExchange){a, (a + 1 + (int)(8 * dice(4, k))) % nodes, 0.01 + 0.5 * dice(5, k)};
    }
}

Status plate_vehicle_create(Network **out, const PlateVehicle *vehicle)
{
    const int flows = vehicle_flows * vehicle->nodes;
    return heat_network_create(
        out, &(NetworkShape){vehicle->nodes, flows, flows, vehicle->capacity_j_k, vehicle->link, vehicle->exchange});
}

void plate_vehicle_loads(NetworkLoad *out, const PlateVehicle *vehicle, double t_s)
{
    const double hour_s = 3600, turns = 2 * pi_rad * t_s;
    const double hot = 1 / (1 + exp(-20 * sin(turns / hour_s - 0.5))); /* the engine: on and off within minutes */
    for (int i = 0; i < vehicle->nodes; i++) {
        const double sun_w = 300 * dice(6, i) * (1 + 0.7 * sin(turns / 600 + i));
        const double engine_w = i % 16 == 3 ? 2000 * hot : 0;
        out[i] = (NetworkLoad){sun_w + engine_w, (2 + 10 * dice(7, i)) * (1 + 0.4 * sin(turns / 300 + 2 * i)),
                               290 + 5 * sin(turns / (24 * hour_s)), 0.5 * dice(8, i)};
    }
}
