/* entities/parametric/decoy.c: inflatable decoy of a main battle tank: the outline of parametric_tank.c (hull 6.95
 * m, 9.53 m with the gun, 3.59 m wide, 2.19 m to the turret roof) blown up out of coated fabric over air beams.
 * Makers publish the full size of what is copied and 30 .. 100 kg (open descriptions of Inflatech's and Rusbal's
 * wares); the bulges are estimates. In the visible a tank; in the infrared one cold skin, without engine, exhaust,
 * warm tracks or gun; to radar, cloth. Nothing moves. */
#include "entities/parametric/parametric.h"
#include "entities/parametric/parts.h"

static const double half_length_m = 6.95 / 2, half_width_m = 3.59 / 2, muzzle_x_m = 9.53 - 6.95 / 2;
static const double roof_m = 2.19;

static void build_hull(MeshBuilder *b)
{
    const Place here = place_at(0, 0, 0);
    mesh_part(b, 0, "hull", "decoy_fabric", HEAT_PASSIVE);
    const Station tub[6] = {
        {-half_length_m, 1.02, -1.28, -0.62, 0.6}, {-3.05, 1.10, -1.42, -0.45, 0.45}, {0.0, 1.12, -1.42, -0.42, 0.4},
        {2.10, 1.12, -1.42, -0.44, 0.4},           {3.05, 1.08, -1.20, -0.62, 0.5},
        {half_length_m, 0.98, -1.04, -0.86, 0.8}};
    mesh_loft(b, here, tub, 6);
    /* fender beams: each a long bolster with quilted bins on top */
    for (int side = -1; side <= 1; side += 2) {
        const Station fender[4] = {{-3.40, 0.36, -1.24, -0.96, 0.8}, {-3.1, 0.40, -1.30, -0.93, 0.7},
                                   {3.0, 0.40, -1.28, -0.93, 0.7},   {3.38, 0.36, -1.14, -0.96, 0.8}};
        mesh_loft(b, place_at(0, side * (half_width_m - 0.40), 0), fender, 4);
        for (int i = 0; i < 4; i++) {
            static const Station bin[3] = {{-0.6, 0.25, -1.40, -1.20, 0.8}, {0, 0.30, -1.47, -1.20, 0.6},
                                           {0.6, 0.25, -1.40, -1.20, 0.8}};
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
    const double rise = roof_m - 1.38;
    mesh_profile_begin(b, 0, 0);
    mesh_profile_line(b, 0, 1.05);
    mesh_profile_arc(b, 0.5 * rise, 1.00, -2.4);
    mesh_profile_line(b, rise, 0.45);
    mesh_profile_line(b, rise, 0);
    mesh_lathe(b, place_scaled(place_axis(0.18, 0, -1.38, 0, 0, -1), 1, 1, 1.10));
    mesh_sphere(b, place_scaled(place_at(0.08, 0.48, -roof_m), 0.34, 0.34, 0.14), 1);
    mesh_sphere(b, place_scaled(place_at(-1.25, 0, -1.68), 0.32, 0.75, 0.24), 1);
    /* the gun is two air beams, the thicker where the fume extractor would be; it droops by 0.1 m */
    mesh_part(b, 0, "gun", "decoy_fabric", HEAT_PASSIVE);
    const double root[3] = {1.05, 0, -1.74}, middle[3] = {3.6, 0, -1.74}, tip[3] = {muzzle_x_m - 0.125, 0, -1.64};
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
