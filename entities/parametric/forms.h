/* entities/parametric/forms.h: shapes shared by the simpler built-in models. For parametric_*.c alone.
 *
 * Heights are up and positive here, metres above the model's base; x is forward, y right. */
#ifndef ENTITIES_PARAMETRIC_FORMS_H
#define ENTITIES_PARAMETRIC_FORMS_H

#include "entities/parametric/parts.h"

void form_box(MeshBuilder *b, double x0, double x1, double y0, double y1, double low_m, double high_m);
/* The same on both sides: y0 < y1 of the right one. */
void form_boxes(MeshBuilder *b, double x0, double x1, double y0, double y1, double low_m, double high_m);
/* A side view (x, height), extruded across from y0 to y1. */
void form_profile(MeshBuilder *b, int count, const double (*outline)[2], double y0, double y1);
void form_bar(MeshBuilder *b, double x0, double y0, double h0, double x1, double y1, double h1, double radius);
/* A fin that stands: quarter outline in x at two heights, thick_m across at the foot. */
void form_fin(MeshBuilder *b, double y, double lead0, double trail0, double low_m, double lead1, double trail1,
              double high_m, double thickness);

/* A rolling node `wheel_<side>_<number>` with parts tyre and rim, standing on the ground: its axle is at its radius. */
void form_wheel(MeshBuilder *b, const char *kind, int side, int number, double x, double y, double radius,
                double half_width);
/* A spinning node of `blades` blades about the x axis (a propeller) or the z axis (a rotor), hub at x, y, height. */
void form_propeller(MeshBuilder *b, const char *name, double x, double y, double h, double radius, int blades,
                    double rpm);
void form_rotor(MeshBuilder *b, const char *name, double x, double y, double h, double radius, double chord, int blades,
                double rpm);

#endif
