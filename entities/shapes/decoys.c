/* entities/shapes/decoys.c: decoys: an inflatable tank, a flare, a corner reflector. */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

/* ---- inflatable tank -------------------------------------------------------------------------- */

/* Inflatable decoy of a main battle tank: the outline of tank.c (hull 6.95 m, 9.53 m with the gun, 3.59 m wide, 2.19 m
 * to the turret roof) blown up out of coated fabric over air beams. Makers publish the full size of what is copied and
 * 30 .. 100 kg (open descriptions of Inflatech's and Rusbal's wares); the bulges are estimates. In the visible a tank;
 * in the infrared one cold skin, without engine, exhaust, warm tracks or gun; to radar, cloth. Nothing moves. */

static const double tank_half_length_m = 6.95 / 2, tank_half_width_m = 3.59 / 2, tank_muzzle_x_m = 9.53 - 6.95 / 2;
static const double tank_roof_m = 2.19;

static void build_hull(MeshBuilder *b)
{
    const Place here = place_at(0, 0, 0);
    mesh_part(b, 0, "hull", "decoy_fabric", HEAT_PASSIVE);
    const Station tub[6] = {{-tank_half_length_m, 1.02, -1.28, -0.62, 0.6},
                            {-3.05, 1.10, -1.42, -0.45, 0.45},
                            {0.0, 1.12, -1.42, -0.42, 0.4},
                            {2.10, 1.12, -1.42, -0.44, 0.4},
                            {3.05, 1.08, -1.20, -0.62, 0.5},
                            {tank_half_length_m, 0.98, -1.04, -0.86, 0.8}};
    mesh_loft(b, here, tub, 6);
    /* fender beams: each a long bolster with quilted bins on top */
    for (int side = -1; side <= 1; side += 2) {
        const Station fender[4] = {{-3.40, 0.36, -1.24, -0.96, 0.8},
                                   {-3.1, 0.40, -1.30, -0.93, 0.7},
                                   {3.0, 0.40, -1.28, -0.93, 0.7},
                                   {3.38, 0.36, -1.14, -0.96, 0.8}};
        mesh_loft(b, place_at(0, side * (tank_half_width_m - 0.40), 0), fender, 4);
        for (int i = 0; i < 4; i++) {
            static const Station bin[3] = {
                {-0.6, 0.25, -1.40, -1.20, 0.8}, {0, 0.30, -1.47, -1.20, 0.6}, {0.6, 0.25, -1.40, -1.20, 0.8}};
            mesh_loft(b, place_at(-2.4 + 1.4 * i, side * 1.40, 0), bin, 3);
        }
    }
    /* quilting of the engine deck */
    for (int i = 0; i < 5; i++)
        mesh_bar(b, (double[3]){-3.1 + 0.3 * i, -0.85, -1.40}, (double[3]){-3.1 + 0.3 * i, 0.85, -1.40}, 0.09);
}

static void build_tracks(MeshBuilder *b)
{
    /* one bolster a side for the whole run, and discs sewn on for wheels */
    mesh_part(b, 0, "tracks", "decoy_fabric_black", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        const Station run[6] = {{-3.30, 0.27, -1.02, -0.66, 0.9}, {-2.75, 0.29, -1.05, -0.18, 0.5},
                                {-2.20, 0.29, -1.05, 0.0, 0.35},  {2.00, 0.29, -1.05, 0.0, 0.35},
                                {2.60, 0.29, -1.05, -0.22, 0.5},  {3.25, 0.27, -1.00, -0.62, 0.9}};
        mesh_loft(b, place_at(0, side * 1.395, 0), run, 6);
    }
    mesh_part(b, 0, "wheels", "decoy_fabric", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 6; i++)
            mesh_sphere(b, place_scaled(place_at(2.03 - 0.854 * i, side * 1.66, -0.43), 0.36, 0.08, 0.36), 1);
}

static void build_turret(MeshBuilder *b)
{
    mesh_part(b, 0, "turret", "decoy_fabric", HEAT_PASSIVE);
    /* a cushion: bulging wall, nearly flat top */
    const double rise = tank_roof_m - 1.38;
    mesh_profile_begin(b, 0, 0);
    mesh_profile_line(b, 0, 1.05);
    mesh_profile_arc(b, 0.5 * rise, 1.00, -2.4);
    mesh_profile_line(b, rise, 0.45);
    mesh_profile_line(b, rise, 0);
    mesh_lathe(b, place_scaled(place_axis(0.18, 0, -1.38, 0, 0, -1), 1, 1, 1.10));
    mesh_sphere(b, place_scaled(place_at(0.08, 0.48, -tank_roof_m), 0.34, 0.34, 0.14), 1);
    mesh_sphere(b, place_scaled(place_at(-1.25, 0, -1.68), 0.32, 0.75, 0.24), 1);
    /* the gun is two air beams, the thicker where the fume extractor would be; it droops by 0.1 m */
    mesh_part(b, 0, "gun", "decoy_fabric", HEAT_PASSIVE);
    const double root[3] = {1.05, 0, -1.74}, middle[3] = {3.6, 0, -1.74}, tip[3] = {tank_muzzle_x_m - 0.125, 0, -1.64};
    parts_limb(b, root, 0.20, middle, 0.16);
    parts_limb(b, middle, 0.165, tip, 0.125);
    mesh_part(b, 0, "lamp", "decoy_fabric_black", HEAT_PASSIVE);
    mesh_sphere(b, place_scaled(place_at(1.18, 0.52, -2.04), 0.14, 0.20, 0.20), 1);
    /* guy ropes to pegs, as an inflatable needs in wind */
    mesh_part(b, 0, "ropes", "cloth_olive", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        for (int end = -1; end <= 1; end += 2)
            mesh_bar(b, (double[3]){end * 2.9, side * 1.60, -1.1}, (double[3]){end * 3.3, side * 1.78, -0.012}, 0.006);
}

Status parametric_decoy(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("decoy", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "hull", -1, 0, 0, 0);
    build_hull(b);
    build_tracks(b);
    build_turret(b);
    return mesh_builder_finish(out, b);
}

/* ---- flare ------------------------------------------------------------------------------------ */

/* Burning grain of a decoy flare for the 36 mm dispenser: 36 mm across, 148 mm long (the cartridge size of the
 * AN/ALE-39's MJU-8 class; Designation-Systems.net, public data sheets of the makers), six grooves along it as such
 * grains have, on an aluminium piston. Magnesium-Teflon-Viton burns for some four seconds; the grain's radiation
 * temperature is set by heat role `flare`.
 *
 * The grain alone is modelled: a real flare's fire ball and smoke radiate from an area some twenty times as large,
 * which is a matter of the air about it, not of a solid. It lies along x; the base is its lowest line. */

static const double grain_radius_m = 0.018, grain_half_length_m = 0.074, piston_m = 0.010;

Status parametric_flare(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("flare", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    const int   body = mesh_node(b, "body", -1, 0, 0, 0);
    const Place axis = place_at(0, 0, -grain_radius_m);
    mesh_part(b, body, "grain", "flare_grain", HEAT_FLARE);
    mesh_cylinder(b, axis, -grain_half_length_m + piston_m, grain_half_length_m, 0.9 * grain_radius_m);
    for (int i = 0; i < 6; i++) { /* lands between the grooves; one lies lowest */
        const Place         land = place_turned(axis, (double[3]){1, 0, 0}, pi_rad / 3 * i);
        static const double outline[4][2] = {{-0.0055, 0.015}, {0.0055, 0.015}, {0.0045, 0.018}, {-0.0045, 0.018}};
        /* shape (x, y, z) = (across, along, out) */
        const double turn[9] = {0, 1, 0, 1, 0, 0, 0, 0, 1};
        Place        along = land;
        m3_mul(along.m, land.m, turn);
        mesh_prism(b, along, 4, outline, -grain_half_length_m + piston_m, grain_half_length_m - 0.002);
    }
    mesh_part(b, body, "piston", "metal_aluminium_bare", HEAT_PASSIVE);
    mesh_cylinder(b, axis, -grain_half_length_m, -grain_half_length_m + piston_m, 0.95 * grain_radius_m);
    return mesh_builder_finish(out, b);
}

/* ---- corner reflector ------------------------------------------------------------------------- */

/* Octahedral radar reflector: three square sheets of metal at right angles, each with its corners on the axes, so that
 * every octant is a trihedral of three triangles with legs of half the height. At the middle of an octant (azimuth 45,
 * 135 ... degrees, 35.3 degrees above or below) its cross section is 4 pi a^4 / (3 lambda^2), a the leg (handbook;
 * physical optics). 0.5 m legs, 1 mm sheet: a light decoy; sizes of the catalog make others. In other bands bare
 * metal. */

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
