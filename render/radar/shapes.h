/* render/radar/shapes.h: shapes whose radar cross section is known on paper, as models with exact normals.
 *
 * Written as `sphere:R`, `plate:AxB`, `disc:R`, `cylinder:RxL`, `dihedral:AxB`, `trihedral:A`, `corner:A`, in m:
 *   sphere     about the origin
 *   plate      A along y, B along z, normal x; disc: normal x. Of no thickness
 *   cylinder   its axis z, about the origin; its ends are a part of their own
 *   dihedral   two plates, A wide and B along z, that meet at right angles in the z axis; opens towards x
 *   trihedral  three right-angled triangles of legs A from the origin along x, y and -z, which is up; corner: three
 *              squares;
 *              both open towards (1, 1, -1)
 * All metal, one part but for the cylinder. Curved ones lie within sag_m of their facets, corners of facets on the
 * surface. */
#ifndef RENDER_RADAR_SHAPES_H
#define RENDER_RADAR_SHAPES_H

#include "entities/models/model.h"

/* Whether a name means a shape: it has a colon. */
bool   shape_is_named(const char *name);
/* STATUS_BAD_VALUE, logged: no such shape, dimensions outside 1 mm .. 100 m, or more than 4 M facets. */
Status shape_build(Model *out, const char *name, double sag_m);

#endif
