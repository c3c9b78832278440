/* entities/parametric/missile.c: wire-guided anti-tank missile of the TOW class. Published for the BGM-71A: 1.17 m
 * long, 152 mm in diameter, 0.46 m across the open wings; four wings at mid body and four control fins at the tail,
 * both as an X in flight; the flight motor blows through two ports at the sides of the body between the wings, the
 * launch motor through the tail, where the beacon and the wire bobbins are too (US Army FM 3-22.34; Designation-
 * Systems.net, M71). Sections along the body are estimates.
 *
 * The base is the lowest wing tip: the axis is at 0.1626 m, and nothing has z > 0. */
#include "entities/parametric/mesh_builder.h"
#include "entities/parametric/parametric.h"

static const double half_length_m = 0.585, body_radius_m = 0.076, half_span_m = 0.23;

/* A thin fin in the plane of the body axis, turned about it: 0: to the right; positive: right goes down. */
static void build_fin(MeshBuilder *b, double axis_z, double turn_rad, const double root[4][2], const double tip[4][2],
                      double from_m, double to_m)
{
    Place place = place_at(0, 0, axis_z);
    place = place_turned(place, (double[3]){1, 0, 0}, turn_rad);
    mesh_slab(b, place, 4, root, from_m, tip, to_m);
}

Status parametric_missile(Model *out, double sag_m)
{
    static const double wing_root[4][2] = {{0.16, 0.000}, {0.02, 0.004}, {-0.11, 0.000}, {0.02, -0.004}};
    static const double wing_tip[4][2]  = {{-0.02, 0.000}, {-0.07, 0.002}, {-0.11, 0.000}, {-0.07, -0.002}};
    static const double fin_root[4][2]  = {{-0.42, 0.000}, {-0.48, 0.004}, {-0.54, 0.000}, {-0.48, -0.004}};
    static const double fin_tip[4][2]   = {{-0.48, 0.000}, {-0.51, 0.002}, {-0.54, 0.000}, {-0.51, -0.002}};
    MeshBuilder *b = mesh_builder_create("missile", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    /* wing tips are 4 mm lozenges whose corners lie on the chord: the tip's chord is the lowest line */
    const double axis_z = -half_span_m * sqrt(0.5) - 0.002;
    const Place  axis = place_at(0, 0, axis_z);
    const double r = body_radius_m;
    const int    body = mesh_node(b, "body", -1, 0, 0, 0);

    /* warhead: a spherical cap on a cone that widens to the body */
    mesh_part(b, body, "nose", "paint_olive", HEAT_NOSE);
    {
        /* cap of radius 0.045 tangent to a cone of half angle 0.20 rad */
        static const double cap_m = 0.045, slope_rad = 0.20;
        const double cap_x = half_length_m - cap_m;
        const double join_x = cap_x + cap_m * sin(slope_rad), join_r = cap_m * cos(slope_rad);
        const double base_x = join_x - (r - join_r) / tan(slope_rad);
        mesh_profile_begin(b, 0.25, 0);
        mesh_profile_line(b, 0.25, r);
        mesh_profile_line(b, base_x, r);
        mesh_profile_line(b, join_x, join_r);
        mesh_profile_arc(b, cap_x, 0, -(0.5 * pi_rad - slope_rad));
        mesh_lathe(b, axis);
    }
    mesh_part(b, body, "body", "paint_olive", HEAT_HULL);
    mesh_cylinder(b, axis, -0.585 + 0.03, -0.12, r);
    mesh_cylinder(b, axis, 0.16, 0.25, r);
    mesh_part(b, body, "motor", "paint_grey", HEAT_MOTOR);
    mesh_cylinder(b, axis, -0.12, 0.16, r);

    /* the two ports, left and right, canted back */
    mesh_part(b, body, "exhaust_ports", "motor_nozzle", HEAT_MOTOR);
    for (int side = -1; side <= 1; side += 2)
        mesh_tube(b, place_axis(0.06, 0.055 * side, axis_z, -0.5, side, 0), 0, 0.034, 0.024, 0.016);
    mesh_part(b, body, "wings", "paint_grey", HEAT_PASSIVE);
    for (int i = 0; i < 4; i++)
        build_fin(b, axis_z, (0.25 + 0.5 * i) * pi_rad, wing_root, wing_tip, 0.070, half_span_m);
    mesh_part(b, body, "fins", "paint_grey", HEAT_PASSIVE);
    for (int i = 0; i < 4; i++)
        build_fin(b, axis_z, (0.25 + 0.5 * i) * pi_rad, fin_root, fin_tip, 0.070, 0.17);

    mesh_part(b, body, "tail", "metal_dark", HEAT_MOTOR);
    mesh_profile_begin(b, -half_length_m + 0.04, 0);
    mesh_profile_line(b, -half_length_m + 0.004, 0.028);
    mesh_profile_line(b, -half_length_m + 0.004, 0.9 * r);
    mesh_profile_line(b, -half_length_m + 0.031, r);
    mesh_profile_line(b, -half_length_m + 0.031, 0);
    mesh_lathe(b, axis);
    /* the beacon that the launcher tracks, above the nozzle */
    mesh_part(b, body, "beacon", "glass_window", HEAT_MOTOR);
    mesh_cylinder(b, place_axis(-half_length_m, 0, axis_z - 0.048, 1, 0, 0), 0, 0.02, 0.014);
    return mesh_builder_finish(out, b);
}
