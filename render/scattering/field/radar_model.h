/* render/scattering/field/radar_model.h: a target by its name: a built-in model, a model's file, or a
 * shape. */
#ifndef RENDER_SCATTERING_FIELD_RADAR_MODEL_H
#define RENDER_SCATTERING_FIELD_RADAR_MODEL_H

#include "render/scattering/field/radar_target_private.h"

/* Stays where it was opened: the target points to the model. */
typedef struct RadarModel {
    Model        model;
    RadarTarget *target;
} RadarModel;

/* Curved surfaces of built-in models and shapes are within sag_m of their facets; a file is as fine as it is.
 * materials: of radar_materials_load, must outlive it. Logs. */
Status radar_model_open(RadarModel *out, const char *name, const RadarMaterials *materials, double sag_m);
void   radar_model_close(RadarModel *m); /* accepts zeroes */

/* ---- shapes ------------------------------------------------------------------------------------- */

/* Shapes whose radar cross section is known on paper, as models with exact normals.
 *
 * Written as `sphere:R`, `plate:AxB`, `disc:R`, `cylinder:RxL`, `dihedral:AxB`, `trihedral:A`, `corner:A`, in m:
 *   sphere     about the origin
 *   plate      A along y, B along z, normal x; disc: normal x. Of no thickness
 *   cylinder   its axis z, about the origin; its ends are a part of their own
 *   dihedral   two plates, A wide and B along z, that meet at right angles in the z axis; opens towards x
 *   trihedral  three right-angled triangles of legs A from the origin along x, y and -z, which is up; corner: three
 *              squares; both open towards (1, 1, -1)
 * All metal, one part but for the cylinder. Curved ones lie within sag_m of their facets, corners of facets on the
 * surface. */

/* STATUS_BAD_VALUE, logged: there is no such shape, its dimensions are outside 1 mm .. 100 m, or it needs more than 4 M
 * facets. */
Status radar_shape_build(Model *out, const char *name, double sag_m);

#endif
