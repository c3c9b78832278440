/* render/heat/column_private.h: heat conduction into layers, in one dimension, under a surface that exchanges heat as
 * it likes.
 *
 *     rho c dT/dt = d/dz (k dT/dz),  0 <= z <= depth;  -k dT/dz = flux(T, t) at z = 0;  no flux, or one through a
 *     conductance to a given temperature, at the bottom
 *
 * Nodes at the faces of elements that grow with depth (linear, with lumped capacity; second order in their size),
 * TR-BDF2 in time (Bank et al. 1985; L-stable, second order). Only the surface is nonlinear: elimination from the
 * bottom up leaves one equation of the surface's temperature, which is solved to 1e-10 K, so that each step keeps the
 * energy to rounding. A step whose own error estimate at the surface is beyond the tolerance is taken in halves, and
 * those in turn, as after a jump of the flux.
 *
 * Error: tests/render/test_column.c (analytic cases, within 0.01 K); rows of `bench precision`. */
#ifndef RENDER_HEAT_COLUMN_PRIVATE_H
#define RENDER_HEAT_COLUMN_PRIVATE_H

#include "pitviper.h"

enum { column_most_nodes = 96, column_most_layers = 6 };

typedef struct ColumnLayer {
    double thickness_m, conductivity_w_mk, capacity_j_m3k;
} ColumnLayer;

typedef struct Column {
    int    nodes;
    double capacity_j_m2k[column_most_nodes];    /* of each node */
    double conductance_w_m2k[column_most_nodes]; /* [i]: between nodes i and i + 1; the last: to deep_k, 0: none */
    double depth_m[column_most_nodes];
} Column;

/* What steps of one length share: the elimination, from the bottom up. */
typedef struct ColumnFactors {
    double                      dt_s; /* of a step; 0: none yet */
    const struct ColumnFactors *half; /* of steps half as long, which outlive it; NULL: found where they are taken */
    double share[column_most_nodes], over[column_most_nodes], steep0; /* g / pivot of the node below; 1 / pivot */
} ColumnFactors;

/* Elements of at most first_m at the surface and at each layer's upper face, growing by `growth` (1: even).
 * STATUS_BAD_VALUE: no layer, a thickness, conductivity or capacity that is not positive, or more nodes than
 * column_most_nodes. */
Status column_create(Column *out, const ColumnLayer *layer, int layers, double first_m, double growth);

/* Heat into the surface at its temperature, W/m2, and how fast it falls with it (a guess of the slope, W/(m2 K), > 0
 * where it is not zero: speed alone depends on it). Must not rise with temperature. */
typedef double ColumnFlux(double *falls_w_m2k, double temp_k, const void *law);

/* The law at share 0 .. 1 of the step. */
typedef void ColumnLaw(void *law, double share, const void *user);

typedef struct ColumnBoundary {
    ColumnFlux *flux;
    ColumnLaw  *at; /* fills law, law_size octets */
    const void *user;
    double      deep_k;
    double      tolerance_k; /* of a step, at the surface; 0: never in halves */
} ColumnBoundary;

typedef struct ColumnState {
    double temp_k[column_most_nodes];
    double heat_j_m2; /* that the surface, and the bottom, have let in so far */
    int    halved;    /* steps taken in halves so far */
} ColumnState;

void column_start(ColumnState *out, const Column *column, double temp_k);
/* One step of dt_s > 0. factors: of column_factors for it, or NULL: found here. */
void column_step(ColumnState *state, const Column *column, const ColumnFactors *factors, const ColumnBoundary *boundary,
                 double dt_s);
void column_factors(ColumnFactors *out, const Column *column, double dt_s);
double column_heat_j_m2(const ColumnState *state, const Column *column); /* stored, over 0 K */
double column_temp_k(const ColumnState *state, const Column *column, double depth_m);

enum { column_law_octets = 256 };

#endif
