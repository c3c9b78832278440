/* plate_vehicle: a vehicle of 60 thermal nodes over three hours in steps of 30 s, for another solver to judge:
 * tests/system/network_judge.py. CSV on standard output, loads straight between knots:
 *     node,I,CAPACITY_J_K,START_K,END_K    link,A,B,W_K    exchange,A,B,M2
 *     load,KNOT_S,I,HEAT_W,FILM_W_K,FLUID_K,EMITS_M2       heat,IN_J,STORED_J */
#include "tests/scenes/plate_vehicle.h"

enum { nodes = 60, knots = 18, steps = 20, flows = vehicle_flows * nodes };

static const double knot_s = 600;

int main(void)
{
    static PlateVehicle v;
    static NetworkLoad  load[knots + 1][nodes];
    Network            *network;
    double              temp_k[nodes], heat_j = 0;
    plate_vehicle(&v, nodes);
    if (plate_vehicle_create(&network, &v) != STATUS_OK) return 1;
    /* not a whole number of the loads' own periods: knots unlike one another */
    for (int k = 0; k <= knots; k++) plate_vehicle_loads(load[k], &v, 1.07 * k * knot_s);
    memcpy(temp_k, v.start_k, sizeof temp_k);
    const double before_j = heat_network_heat_j(network, temp_k);
    for (int s = 0; s < knots * steps; s++) {
        NetworkLoad   at[2][nodes];
        const double *from = (const double *)load[s / steps], *to = (const double *)load[s / steps + 1];
        for (int end = 0; end < 2; end++)
            for (int i = 0; i < 4 * nodes; i++)
                ((double *)at[end])[i] = from[i] + (s % steps + end) / (double)steps * (to[i] - from[i]);
        if (heat_network_step(temp_k, &heat_j, network, at[0], at[1], knot_s / steps) != STATUS_OK) return 1;
    }
    for (int i = 0; i < nodes; i++)
        printf("node,%d,%.17g,%.17g,%.17g\n", i, v.capacity_j_k[i], v.start_k[i], temp_k[i]);
    for (int k = 0; k < flows; k++) printf("link,%d,%d,%.17g\n", v.link[k].a, v.link[k].b, v.link[k].conductance_w_k);
    for (int k = 0; k < flows; k++)
        printf("exchange,%d,%d,%.17g\n", v.exchange[k].a, v.exchange[k].b, v.exchange[k].area_m2);
    for (int k = 0; k <= knots; k++)
        for (int i = 0; i < nodes; i++) {
            const NetworkLoad *l = &load[k][i];
            printf("load,%.17g,%d,%.17g,%.17g,%.17g,%.17g\n", k * knot_s, i, l->heat_w, l->film_w_k, l->fluid_k,
                   l->emits_m2);
        }
    printf("heat,%.17g,%.17g\n", heat_j, heat_network_heat_j(network, temp_k) - before_j);
    heat_network_destroy(network);
    return 0;
}
