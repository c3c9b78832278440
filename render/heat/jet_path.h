/* render/heat/jet_path.h: where the exhaust of an engine goes, and how warm and fast it is there: a round jet that mixes with
 * the air, bends with its flow and rises.
 *
 * Balances of mass, momentum and heat along the jet's axis, with one value across it (Hoult & Weil 1972, Atmospheric
 * Environment 6, 513): air enters at 0.08 of the difference in speed along the axis (round jets: Fischer et al. 1979, 0.0535 for
 * a Gaussian profile, times the root of two) and 0.6 of the flow across it. Across the axis a Gaussian of the same flux.
 * The former grows to that over the first 13 diameters (Hill 1972, J. Fluid Mech. 51, 773).
 * Error: speed on the axis of a free jet within 10 % of what is measured (Pope 2000), rise of a hot one in a wind
 * within 15 % of Briggs's law (tests/render/test_jet_path.c). Swirl, the wake of the vehicle and rotor wash are not known. */
#ifndef RENDER_HEAT_JET_PATH_H
#define RENDER_HEAT_JET_PATH_H

#include "entities/traces/effect_puffs.h"

enum { jet_points = 64, jet_run = 8, jet_boxes = jet_points / jet_run };

typedef struct JetPoint {
    double p_enu[3];                 /* on the axis */
    double way_enu[3], per_m2;       /* to the next point; 1 over its square */
    double radius_m;                 /* where excess and speed are exp(-2) of those on the axis */
    double excess_k, speed_mps;      /* on the axis; excess: over the air */
} JetPoint;

/* About all of a jet, or a run of it, that is warmer than the air by 1 K or more. */
typedef struct JetBox {
    double low_m[3], high_m[3];
} JetBox;

typedef struct JetPath {
    int      count;
    JetPoint point[jet_points];
    double   widest;                 /* squared radii from the axis, beyond which it is nowhere warmer by 1 K */
    JetBox   box, run[jet_boxes];    /* run[k]: between points jet_run k and jet_run (k + 1) */
} JetPath;

/* From p_enu, leaving in direction d_enu, in air that flows at flow_enu_mps: in axes that move with the outlet. Ends where it
 * is less than 1 K over the air. */
void jet_path(JetPath *out, const ExhaustJet *jet, const double p_enu[3], const double d_enu[3], const double flow_enu_mps[3],
              double air_k);

/* At a place. wall: it is on the ground or a skin, behind which there is a mirrored jet. False: no warmer there. from:
 * the point of the axis two radii upstream, or the outlet: where what flows past comes from (may be NULL). */
bool jet_path_at(double *excess_k, double *speed_mps, double from_enu[3], const JetPath *path, const double p_enu[3], bool wall);

#endif
