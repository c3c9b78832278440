/* render/heat/stand_heat_private.h: the shade that a standing entity's box left in the ground: of the sun along its
 * path, and of the sky. */
#ifndef RENDER_HEAT_STAND_HEAT_PRIVATE_H
#define RENDER_HEAT_STAND_HEAT_PRIVATE_H

#include "render/heat/heat.h"

/* A box of its own axes about a place; times are Unix time. */
typedef struct StandBox {
    double p_enu[3], axis[3][3], low_m[3], high_m[3], from_s, to_s;
} StandBox;

/* Kelvins that it took from ground of a kind at a place by unix_s: a sum over the sun's path while it stood, each part
 * of it by what is left of it now, and of the sky that it hid, times the scales of heat_scales. lit: share of the past
 * sun that relief and plants left.
 *
 * Edges are as soft as they were made: by the sun's disc, by its motion within a part, and by conduction sideways, of a
 * pulse of heat a Gaussian of variance 2 diffusivity age (Carslaw & Jaeger 1959, 10.3). Against finite volumes in two
 * dimensions: tests/render/test_mark_heat.c, tests/system/test_stand_judge.sh. */
double stand_taken_k(const StandBox *box, const HeatNow *now, double unix_s, int kind, const double p_enu[3],
                     const double n_enu[3], double lit, double sun_scale, double sky_scale);

/* Share of an even sky that the box hides from level ground there, by contour integrals over its faces (Lambert 1760);
 * soft_m: how far it is smeared about the box's own outline, below which there is none of it. */
double stand_hidden_share(const StandBox *box, const double p_enu[3], double soft_m);

#endif
