/* entities/parametric.h: built-in models from public dimensions, as functions of the permitted sag.
 *
 * Each file parametric_<name>.c gives its dimensions with their source. */
#ifndef ENTITIES_PARAMETRIC_H
#define ENTITIES_PARAMETRIC_H

#include "entities/model.h"

/* sag_m: 1e-5 .. 0.1 (else STATUS_BAD_VALUE). Triangles at 0.005 m: tank 15 k, truck 16 k, helicopter 14 k; at
 * 1e-5 m: tank 0.7 M, truck 3 M, helicopter 4 M, in a second or two. Names: tank, truck, helicopter,
 * missile, unknown (a box with a label's worth of detail). STATUS_UNSUPPORTED for any other. */
Status parametric_build(Model *out, const char *name, double sag_m);

/* One builder a file; sag_m as above, already checked. */
Status parametric_tank(Model *out, double sag_m);
Status parametric_truck(Model *out, double sag_m);
Status parametric_helicopter(Model *out, double sag_m);
Status parametric_missile(Model *out, double sag_m);
Status parametric_carrier(Model *out, double sag_m);
Status parametric_launcher(Model *out, double sag_m);
Status parametric_aircraft(Model *out, double sag_m);
Status parametric_ship(Model *out, double sag_m);
Status parametric_person(Model *out, double sag_m);
Status parametric_building(Model *out, double sag_m);
Status parametric_decoy(Model *out, double sag_m);
Status parametric_flare(Model *out, double sag_m);

#endif
