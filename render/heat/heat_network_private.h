/* render/heat/heat_network_private.h: temperatures of a network of thermal nodes: parts of a vehicle, each of one
 * temperature, that conduct and radiate to one another and meet air, sun and an engine's heat.
 *
 *     C_i dT_i/dt = sum of G (T_j - T_i) + sum of sigma A (T_j^4 - T_i^4)           links; exchanges
 *                 + heat_i + film_i (fluid_i - T_i) - sigma emits_i T_i^4           loads
 *
 * SUNDIALS (ARKODE: implicit Runge-Kutta with error control; KLU: sparse factors) solves the whole as one system.
 * Error of a call: below 0.01 K, whatever its length, with jumps of the loads too (tests/render/test_network.c;
 * another solver: tests/system/test_network_judge.sh; rows of `bench precision` and `bench stability`). Cost: about
 * 55 us a step of 100 nodes, 300 links and 300 exchanges to neighbours, while loads and temperatures change smoothly
 * over it (`bench speed`); three times that where each may exchange with any other. */
#ifndef RENDER_HEAT_HEAT_NETWORK_PRIVATE_H
#define RENDER_HEAT_HEAT_NETWORK_PRIVATE_H

#include "pitviper.h"

/* Conduction. */
typedef struct NetworkLink {
    int    a, b;
    double conductance_w_k;
} NetworkLink;

/* Radiation: sigma area (Ta^4 - Tb^4) from a to b; area: emissivities and view factors are in it. */
typedef struct NetworkExchange {
    int    a, b;
    double area_m2;
} NetworkExchange;

typedef struct NetworkShape {
    int                    nodes, links, exchanges;
    const double          *capacity_j_k; /* [nodes], > 0; INFINITY: held at its temperature */
    const NetworkLink     *link;         /* [links]; two of one pair of nodes add up */
    const NetworkExchange *exchange;     /* [exchanges] */
} NetworkShape;

/* What a node meets from outside; a held node takes no notice. */
typedef struct NetworkLoad {
    double heat_w;            /* into it: sun, longwave, friction */
    double film_w_k, fluid_k; /* film_w_k (fluid_k - T) */
    double emits_m2;          /* it loses sigma emits_m2 T^4 */
} NetworkLoad;

/* The shape, copied, and the solver's memory: one thread at a time. */
typedef struct Network Network;

/* STATUS_BAD_VALUE: no node, a capacity that is not positive, a conductance or area that is negative or not finite, a
 * node that does not exist or is linked to itself; STATUS_NO_MEMORY. */
Status heat_network_create(Network **out, const NetworkShape *shape);
void   heat_network_destroy(Network *network); /* accepts NULL */
int    heat_network_nodes(const Network *network);
/* New areas, [exchanges], finite and >= 0; nothing else changes. */
void heat_network_exchange(Network *network, const double *area_m2);
/* New conductances, [links], likewise. */
void heat_network_conductances(Network *network, const double *w_k);

/* temp_k[nodes], > 0, over dt_s > 0. load[nodes]: at its start; load_end: at its end, each number straight between
 * (NULL: as load). heat_in_j (may be NULL): the heat that came from outside, held nodes included, is added to it; it is
 * what the nodes that are not held gained, to 1e-6 of what they exchanged.
 *
 * The result is a function of temp_k, loads, areas and dt_s, to the bit, never of earlier steps. STATUS_BAD_VALUE: a
 * value that is not finite, a temperature or a step that is not positive, a negative film or emitting area, or loads
 * that take a node to 0 K; STATUS_UNSUPPORTED: more than network_most_steps internal steps, or no solution found;
 * STATUS_NO_MEMORY. On failure temp_k and heat_in_j are untouched. */
Status heat_network_step(double *temp_k, double *heat_in_j, Network *network, const NetworkLoad *load,
                         const NetworkLoad *load_end, double dt_s);
enum { network_most_steps = 20000 };

/* The same in one step of the method, whatever its error: L-stable, so that what settles faster than dt_s has settled.
 * For a past that is assumed; on failure temp_k is untouched. */
Status heat_network_leap(double *temp_k, Network *network, const NetworkLoad *load, double dt_s);

double heat_network_heat_j(const Network *network,
                           const double  *temp_k); /* stored above 0 K in nodes that are not held */

#endif
