/* entities/shapes/parametric.h: built-in models from public dimensions, as functions of the chord error.
 *
 * Each file parametric_<name>.c gives its dimensions with their source. */
#ifndef ENTITIES_SHAPES_PARAMETRIC_H
#define ENTITIES_SHAPES_PARAMETRIC_H

#include "entities/models/model.h"

/* sag_m: 1e-5 .. 0.1 (else STATUS_BAD_VALUE). STATUS_UNSUPPORTED for a name that is not one of these:
 *
 *   triangles at 0.005 m   tank 15 k, truck 16 k, helicopter 14 k, missile 550, carrier 11 k, launcher 14 k, aircraft
 *                          12 k, ship 63 k, person 5 k, building 2 k, decoy 27 k, flare 136, unknown (a box with a
 *                          label's worth of detail) 48, marker (for tests of the picture) 24; the families
 *                          (airplanes, wheeled vehicles, artillery, rotorcraft, vessels, munitions, structures)
 *                          40 .. 20 k
 *   at 1e-5 m              tank 0.7 M, truck 3 M, helicopter 4 M, aircraft 3 M, ship 7 M, decoy 11 M, person 1.6 M, in
 *                          one to twenty seconds */
Status parametric_build(Model *out, const char *name, double sag_m);
/* The same of another size, NULL: its own. Facets keep to sag_m at that size. STATUS_BAD_VALUE, logged: a figure
 * outside 0.02 .. 50 times the shape's own. */
Status      parametric_build_size(Model *out, const char *name, const ModelSize *size, double sag_m);
bool        parametric_known(const char *name);
int         parametric_count(void); /* of built-in shapes */
const char *parametric_name(int index);

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
Status parametric_corner_reflector(Model *out, double sag_m);
/* Several to a file, by name. */
Status parametric_airplane(Model *out, const char *name, double sag_m);
Status parametric_wheeled(Model *out, const char *name, double sag_m);
Status parametric_artillery(Model *out, const char *name, double sag_m);
Status parametric_rotorcraft(Model *out, const char *name, double sag_m);
Status parametric_vessel(Model *out, const char *name, double sag_m);
Status parametric_munition(Model *out, const char *name, double sag_m);
Status parametric_structure(Model *out, const char *name, double sag_m);
Status parametric_civil(Model *out, const char *name, double sag_m);
Status parametric_countryside(Model *out, const char *name, double sag_m);
Status parametric_rock(Model *out, const char *name, double sag_m);
Status parametric_cover(Model *out, const char *name, double sag_m); /* cover.c */

#endif
