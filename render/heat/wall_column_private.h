/* render/heat/wall_column_private.h: a wall or roof of one construction under the weather: its balance outside, what is
 * behind it, its steps.
 *
 *     outer face   a light + e longwave - e s T^4 - h (T - Ta)
 *     light        direct cos + F_sky diffuse + F_ground rho_ground global
 *     longwave     F_sky (b L + (1 - b) s Ta^4) + F_ground s Tground^4
 *     inner face   inside_w_m2k (T - Troom)
 *
 * F_sky = (1 + n_up) / 2, F_ground = 1 - F_sky. The low sky is as warm as the air: b = sqrt F_sky (Walton 1983). Film:
 * natural flow over a plate of any tilt with that of the wind over glass (MoWiTT, the mean of its windward and leeward
 * sides: Yazdanian & Klems, ASHRAE Transactions 100, 1994), the latter's share times the construction's roughness
 * (DOE-2; all as in EnergyPlus Engineering Reference, "Outside Surface Heat Balance"), in the wind at eaves of 3 m over
 * country with hedges (0.1 m; Wieringa 1993). A face of which both sides are outside has both sides' balances; nothing
 * evaporates, and dew and rain are not known.
 *
 * Error: tests/render/test_wall_column.c, against closed forms and an independent solver. */
#ifndef RENDER_HEAT_WALL_COLUMN_PRIVATE_H
#define RENDER_HEAT_WALL_COLUMN_PRIVATE_H

#include "render/heat/construction.h"
#include "render/heat/ground_column_private.h"

/* A construction of one material. */
typedef struct WallKind {
    Construction of;
    Column       column; /* to the room through inside_w_m2k */
    double       absorptance, emissivity;
} WallKind;
Status wall_kind(WallKind *out, const Construction *of, const Material *material);

/* What is about a wall at one time. */
typedef struct WallPlace {
    const GroundWeather *weather;
    double               ground_k, ground_rho;
} WallPlace;

/* Which way it faces, and the share of the direct sun that arrives. */
typedef struct WallFace {
    double n_enu[3], sun;
} WallFace;

typedef struct WallFlux {
    int    sides; /* 2: both are outside */
    double air_k, absorbed_w_m2, emissivity, forced_w_m2k, rough, up;
} WallFlux;

void wall_flux(WallFlux *out, const WallKind *kind, const WallPlace *place, const WallFace *face);
/* ColumnFlux of a WallFlux. */
double wall_flux_w_m2(double *falls_w_m2k, double temp_k, const void *law);
/* Film of a side whose normal has this height, W/(m2 K). */
double wall_film_w_m2k(const WallFlux *law, double temp_k, double up);

/* ---- what is behind ---------------------------------------------------------------------------- */

/* Of a construction. hour: mean solar time, 0 .. 24; day_k: a day's mean of the air; room_k: of an unheated room. */
double wall_behind_k(const Construction *of, double hour, double day_k, double air_k, double room_k);
/* An unheated room after dt_s with this mean of its inner faces. */
double wall_room_step(const Construction *of, double room_k, double faces_k, double air_k, double dt_s);
/* A day's mean of the air after dt_s: of the days past with weights that fall by e a day. */
double wall_day_step(double day_k, double air_k, double dt_s);

/* From before to after. factors: of column_factors for dt_s, or NULL. */
void wall_step(ColumnState *state, const WallKind *kind, const ColumnFactors *factors, const WallPlace *before,
               const WallPlace *after, const WallFace *face, double behind_k, double tolerance_k, double dt_s);
/* Temperatures through it in a steady state between its outer face and what is behind. */
void wall_start(ColumnState *out, const WallKind *kind, double outer_k, double behind_k);
/* Conductance from the outer face to what is behind, W/(m2 K); 0: there is nothing. */
double wall_conductance_w_m2k(const WallKind *kind);

#endif
