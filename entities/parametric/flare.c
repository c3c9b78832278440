/* entities/parametric/flare.c: burning grain of a decoy flare for the 36 mm dispenser: 36 mm across, 148 mm long
 * (the cartridge size of the AN/ALE-39's MJU-8 class; Designation-Systems.net, public data sheets of the makers),
 * six grooves along it as such grains have, on an aluminium piston. Magnesium-Teflon-Viton burns for some four
 * seconds; the grain's radiation temperature is set by heat role `flare`.
 *
 * The grain alone is modelled: a real flare's fire ball and smoke radiate from an area some twenty times as large,
 * which is a matter of the air about it, not of a solid. It lies along x; the base is its lowest line. */
#include "entities/parametric/parametric.h"
#include "entities/parametric/parts.h"

static const double radius_m = 0.018, half_length_m = 0.074, piston_m = 0.010;

Status parametric_flare(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("flare", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    const int   body = mesh_node(b, "body", -1, 0, 0, 0);
    const Place axis = place_at(0, 0, -radius_m);
    mesh_part(b, body, "grain", "flare_grain", HEAT_FLARE);
    mesh_cylinder(b, axis, -half_length_m + piston_m, half_length_m, 0.9 * radius_m);
    for (int i = 0; i < 6; i++) { /* lands between the grooves; one lies lowest */
        const Place land = place_turned(axis, (double[3]){1, 0, 0}, pi_rad / 3 * i);
        static const double outline[4][2] = {{-0.0055, 0.015}, {0.0055, 0.015}, {0.0045, 0.018}, {-0.0045, 0.018}};
        /* shape (x, y, z) = (across, along, out) */
        const double turn[9] = {0, 1, 0, 1, 0, 0, 0, 0, 1};
        Place along = land;
        m3_mul(along.m, land.m, turn);
        mesh_prism(b, along, 4, outline, -half_length_m + piston_m, half_length_m - 0.002);
    }
    mesh_part(b, body, "piston", "metal_aluminium_bare", HEAT_PASSIVE);
    mesh_cylinder(b, axis, -half_length_m, -half_length_m + piston_m, 0.95 * radius_m);
    return mesh_builder_finish(out, b);
}
