/* entities/parametric/corner_reflector.c: octahedral radar reflector: three square sheets of metal at right angles, each
 * with its corners on the axes, so that every octant is a trihedral of three triangles with legs of half the height. At
 * the middle of an octant (azimuth 45, 135 ... degrees, 35.3 degrees above or below) its cross section is
 * 4 pi a^4 / (3 lambda^2), a the leg (handbook; physical optics). 0.5 m legs, 1 mm sheet: a light decoy; sizes of the
 * catalog make others. In other bands bare metal. */
#include "entities/parametric/parametric.h"
#include "entities/parametric/mesh_builder.h"

static const double leg_m = 0.5, half_sheet_m = 0.0005;

Status parametric_corner_reflector(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("corner_reflector", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    const int    body = mesh_node(b, "body", -1, 0, 0, 0);
    const Place  middle = place_at(0, 0, -leg_m);
    const double square[4][2] = {{-leg_m, 0}, {0, -leg_m}, {leg_m, 0}, {0, leg_m}};
    mesh_part(b, body, "sheets", "metal_aluminium_bare", HEAT_PASSIVE);
    mesh_prism(b, middle, 4, square, -half_sheet_m, half_sheet_m);
    mesh_prism(b, place_turned(middle, (double[3]){0, 0, 1}, 0.5 * pi_rad), 4, square, -half_sheet_m, half_sheet_m);
    mesh_prism(b, place_turned(middle, (double[3]){1, 0, 0}, 0.5 * pi_rad), 4, square, -half_sheet_m, half_sheet_m);
    return mesh_builder_finish(out, b);
}
