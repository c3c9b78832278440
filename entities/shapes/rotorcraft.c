/* entities/shapes/rotorcraft.c: helicopters other than the attack helicopter, and aircraft that are lifted
 * otherwise: utility helicopter, tandem-rotor helicopter, light helicopter, quadcopter, airship.
 *
 * Published (US Army TM 1-1520 series and fact sheets; Jane's All the World's Aircraft; manufacturers; the same in the
 * open encyclopedias): UH-60A 19.76 m over the turning rotors, main rotor 16.36 m, height 5.13; CH-47D 30.1 m over the
 * rotors, each 18.29 m, height 5.7; OH-58D 12.58 m (body 10.48 m), rotor 10.67 m, height 3.93 with its mast sight;
 * quadcopter: DJI Mavic 3 class, 0.348 x 0.283 x 0.108 without propellers, motors 0.38 m apart corner to corner, larger
 * ones are sized by the catalog; airship: Goodyear GZ-20 58.5 x 15.2 x 18.1. Body sections are estimates.
 *
 * At rest a blade lies forward, so the length is that over turning rotors. Rotors turn while the aircraft runs. */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

#include <stdio.h>

/* A tail rotor on the right, turning about y. */
static void tail_rotor(MeshBuilder *b, double x, double y, double h, double radius, int blades)
{
    const int node = mesh_node(b, "tail_rotor", 0, x, y, -h);
    mesh_joint(b, node, 0, 1, 0, 0, 0, 1, -1);
    mesh_node_get(b, node)->spin_rps_moving = 1190 * 2 * pi_rad / 60;
    mesh_part(b, node, "tail_blades", "paint_olive", HEAT_ROTOR);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 1, 0), -0.06, 0.06, 0.08 * radius);
    for (int i = 0; i < blades; i++) {
        /* blades along shape y, laid into the x-z plane */
        const double a = 2 * pi_rad * i / blades + 0.5 * pi_rad, c = cos(a), s = sin(a);
        Place        place = place_at(0, 0, 0);
        const double m[9] = {-s, c, 0, 0, 0, 1, c, s, 0};
        memcpy(place.m, m, sizeof m);
        parts_wing(b, place, 0.06 * radius, -0.06 * radius, 0.06 * radius, 0, 0.05 * radius, -0.05 * radius, radius, 0,
                   0.12);
    }
}

static void legs(MeshBuilder *b, double x, double y, double h, double radius)
{
    mesh_part(b, 0, "gear", "metal_dark", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        parts_bar(b, x - 0.3, side * 0.5 * y, h, x, side * y, radius, 0.07);
        mesh_cylinder(b, place_axis(x, side * y, -radius, 0, side, 0), -0.10, 0.10, radius);
    }
}

static void build_utility(MeshBuilder *b)
{
    const double hub_x = 1.02, nose = 9.20 - 2.2; /* blade's tip forward at 9.2; tail rotor's behind at -10.56 */
    mesh_part(b, 0, "fuselage", "paint_olive", HEAT_HULL);
    const Station body[9] = {
        {-8.30, 0.16, -2.75, -2.10, 1},  {-6.0, 0.34, -2.50, -1.55, 0.9}, {-3.0, 0.60, -2.45, -0.95, 0.8},
        {-1.2, 1.05, -2.45, -0.52, 0.5}, {0.6, 1.18, -2.45, -0.48, 0.4},  {3.4, 1.18, -2.45, -0.48, 0.4},
        {4.8, 1.00, -2.20, -0.52, 0.6},  {6.2, 0.62, -1.58, -0.62, 0.9},  {nose, 0.15, -1.22, -0.85, 1}};
    mesh_loft(b, place_at(0, 0, 0), body, 9);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double screen[4][2] = {{5.85, 1.62}, {4.75, 2.22}, {4.78, 2.27}, {5.9, 1.68}};
    parts_profile(b, 4, screen, -0.70, 0.70);
    for (int side = -1; side <= 1; side += 2) {
        parts_box(b, 3.55, 4.55, side < 0 ? -1.17 : 1.02, side < 0 ? -1.02 : 1.17, 1.35, 2.02);
        parts_box(b, 0.4, 1.9, side < 0 ? -1.20 : 1.15, side < 0 ? -1.15 : 1.20, 1.40, 2.00);
    }
    mesh_part(b, 0, "engines", "paint_olive", HEAT_TURBINE);
    const Station pod[4] = {{-1.9, 0.25, -0.30, 0.25, 1},
                            {-1.0, 0.42, -0.42, 0.36, 0.9},
                            {1.2, 0.42, -0.42, 0.36, 0.9},
                            {1.7, 0.28, -0.26, 0.26, 1}};
    for (int side = -1; side <= 1; side += 2) mesh_loft(b, place_at(0, side * 0.82, -2.72), pod, 4);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_TURBINE);
    for (int side = -1; side <= 1; side += 2)
        mesh_cylinder(b, place_axis(-1.85, side * 0.9, -2.70, -1, 0.4 * side, 0), 0, 0.35, 0.20);
    mesh_part(b, 0, "mast_fairing", "paint_olive", HEAT_PASSIVE);
    const Station dome[4] = {{-0.9, 0.3, -2.75, -2.3, 0.9},
                             {0.2, 0.55, -3.10, -2.3, 0.8},
                             {1.6, 0.55, -3.05, -2.3, 0.8},
                             {2.7, 0.25, -2.60, -2.3, 0.9}};
    mesh_loft(b, place_at(0, 0, 0), dome, 4);
    parts_bar(b, hub_x, 0, 3.0, hub_x, 0, 3.72, 0.18);
    mesh_part(b, 0, "fin", "paint_olive", HEAT_PASSIVE);
    parts_fin(b, 0, -7.30, -8.5, 2.2, -8.6, -9.55, 4.20, 0.16);
    for (int side = -1; side <= 1; side += 2)
        parts_wing(b, parts_side(side), -7.9, -9.1, 0.05, -2.35, -8.0, -8.9, 2.18, -2.35, 0.10);
    legs(b, 2.6, 1.35, 1.0, 0.33);
    parts_bar(b, -6.9, 0, 1.9, -7.3, 0, 0.25, 0.06);
    mesh_cylinder(b, place_axis(-7.3, 0, -0.20, 0, 1, 0), -0.08, 0.08, 0.20);
    parts_rotor(b, "main_rotor", hub_x, 0, 3.75, 16.36 / 2, 0.53, 4, 258);
    tail_rotor(b, -8.885, 0.35, 3.455, 3.35 / 2, 4);
}

static void build_tandem(MeshBuilder *b)
{
    const double fore = 5.93, aft = -5.93, radius = 18.29 / 2;
    mesh_part(b, 0, "fuselage", "paint_olive", HEAT_HULL);
    const Station body[7] = {{-7.3, 0.85, -3.05, -2.10, 0.6}, {-5.6, 1.40, -3.15, -0.95, 0.45},
                             {-3.8, 1.40, -3.12, -0.60, 0.4}, {3.6, 1.40, -3.12, -0.58, 0.4},
                             {5.6, 1.28, -3.05, -0.62, 0.5},  {7.0, 0.92, -2.35, -0.75, 0.8},
                             {7.95, 0.25, -1.70, -1.15, 1}};
    mesh_loft(b, place_at(0, 0, 0), body, 7);
    mesh_part(b, 0, "pylons", "paint_olive", HEAT_PASSIVE);
    static const double aft_pylon[5][2] = {{-3.6, 3.05}, {-4.9, 4.60}, {-5.4, 5.30}, {-7.0, 5.30}, {-7.25, 2.90}};
    static const double fore_pylon[4][2] = {{7.0, 2.9}, {6.5, 3.75}, {5.3, 3.85}, {4.0, 3.05}};
    parts_profile(b, 5, aft_pylon, -0.48, 0.48);
    parts_profile(b, 4, fore_pylon, -0.52, 0.52);
    parts_boxes(b, -3.6, 4.2, 1.35, 1.83, 0.62, 1.55); /* fuel tanks along the flanks */
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double screen[4][2] = {{6.85, 2.25}, {5.95, 2.93}, {6.0, 3.0}, {6.92, 2.32}};
    parts_profile(b, 4, screen, -0.75, 0.75);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 5; i++)
            mesh_cylinder(b, place_axis(-2.8 + 1.5 * i, side * 1.38, -2.15, 0, side, 0), 0, 0.04, 0.22);
    mesh_part(b, 0, "engines", "paint_olive", HEAT_TURBINE);
    const Station pod[3] = {{-0.95, 0.30, -0.32, 0.32, 1}, {-0.2, 0.40, -0.42, 0.42, 1}, {1.1, 0.34, -0.35, 0.35, 1}};
    for (int side = -1; side <= 1; side += 2) mesh_loft(b, place_at(-5.6, side * 0.98, -3.55), pod, 3);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_TURBINE);
    for (int side = -1; side <= 1; side += 2)
        mesh_cylinder(b, place_axis(-6.5, side * 0.98, -3.55, -1, 0, 0), 0, 0.3, 0.24);
    legs(b, 2.2, 1.6, 0.8, 0.30);
    for (int side = -1; side <= 1; side += 2) {
        parts_bar(b, -4.6, side * 1.1, 0.9, -4.9, side * 1.55, 0.3, 0.07);
        mesh_cylinder(b, place_axis(-4.9, side * 1.55, -0.30, 0, side, 0), -0.10, 0.10, 0.30);
    }
    parts_bar(b, fore, 0, 3.8, fore, 0, 4.25, 0.22);
    parts_bar(b, aft, 0, 5.2, aft, 0, 5.48, 0.22);
    parts_rotor(b, "fore_rotor", fore, 0, 4.30, radius, 0.81, 3, 225);
    parts_rotor(b, "aft_rotor", aft, 0, 5.52, radius, 0.81, 3, 225);
    /* they mesh, and turn against each other: the aft one rests a blade's third turned, and goes the other way */
    ModelNode   *n = mesh_node_get(b, 2);
    const double half_turn[9] = {-1, 0, 0, 0, -1, 0, 0, 0, 1};
    memcpy(n->r_parent_from_node, half_turn, sizeof half_turn);
    n->axis[2] = 1;
}

static void build_light_helicopter(MeshBuilder *b)
{
    const double hub_x = 0.955;
    mesh_part(b, 0, "fuselage", "paint_olive", HEAT_HULL);
    const Station body[8] = {{-6.0, 0.09, -1.85, -1.60, 1},   {-3.2, 0.17, -1.90, -1.45, 1},
                             {-1.6, 0.30, -2.05, -1.20, 0.9}, {-0.7, 0.66, -2.30, -0.68, 0.6},
                             {0.9, 0.70, -2.30, -0.52, 0.5},  {2.2, 0.66, -2.05, -0.52, 0.6},
                             {3.3, 0.46, -1.45, -0.62, 0.9},  {3.85, 0.12, -1.10, -0.82, 1}};
    mesh_loft(b, place_at(0, 0, 0), body, 8);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double screen[4][2] = {{3.12, 1.48}, {2.15, 2.05}, {2.18, 2.10}, {3.16, 1.54}};
    parts_profile(b, 4, screen, -0.52, 0.52);
    for (int side = -1; side <= 1; side += 2)
        parts_box(b, 0.4, 2.1, side < 0 ? -0.71 : 0.6, side < 0 ? -0.6 : 0.71, 1.35, 1.95);
    mesh_part(b, 0, "engines", "paint_olive", HEAT_TURBINE);
    const Station cowl[4] = {{-1.8, 0.12, -2.2, -1.95, 1},
                             {-0.9, 0.34, -2.60, -2.1, 0.8},
                             {0.9, 0.36, -2.66, -2.1, 0.8},
                             {1.6, 0.15, -2.35, -2.1, 1}};
    mesh_loft(b, place_at(0, 0, 0), cowl, 4);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_TURBINE);
    mesh_cylinder(b, place_axis(-0.7, 0, -2.55, -0.5, 0, -1), 0, 0.25, 0.11);
    mesh_part(b, 0, "fin", "paint_olive", HEAT_PASSIVE);
    parts_fin(b, 0.0, -5.35, -5.85, 1.2, -5.75, -6.15, 2.75, 0.10);
    for (int side = -1; side <= 1; side += 2)
        parts_wing(b, parts_side(side), -3.9, -4.4, 0.05, -1.70, -3.95, -4.4, 0.98, -1.70, 0.10);
    mesh_part(b, 0, "skids", "metal_dark", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        parts_bar(b, -1.0, side * 0.95, 0.045, 2.4, side * 0.95, 0.045, 0.045);
        parts_bar(b, -0.3, side * 0.4, 0.75, -0.4, side * 0.95, 0.05, 0.035);
        parts_bar(b, 1.6, side * 0.4, 0.65, 1.7, side * 0.95, 0.05, 0.035);
    }
    mesh_part(b, 0, "mast_sight", "paint_olive", HEAT_PASSIVE);
    parts_bar(b, hub_x, 0, 2.6, hub_x, 0, 3.4, 0.07);
    mesh_sphere(b, place_at(hub_x, 0, -3.60), 0.33);
    parts_rotor(b, "main_rotor", hub_x, 0, 2.95, 10.67 / 2, 0.24, 4, 395);
    tail_rotor(b, -5.465, -0.18, 2.05, 1.65 / 2, 2);
}

static void build_quadcopter(MeshBuilder *b)
{
    /* 0.52 m over the propellers each way; the catalog sizes it */
    mesh_part(b, 0, "body", "paint_grey", HEAT_AIRFRAME);
    const Station body[4] = {{-0.16, 0.05, -0.145, -0.075, 0.6},
                             {-0.05, 0.075, -0.165, -0.065, 0.6},
                             {0.08, 0.075, -0.165, -0.065, 0.6},
                             {0.17, 0.045, -0.14, -0.085, 0.8}};
    mesh_loft(b, place_at(0, 0, 0), body, 4);
    static const double reach = 0.17;
    for (int i = 0; i < 4; i++) {
        const double x = i < 2 ? reach : -reach, y = i % 2 ? reach : -reach;
        parts_bar(b, 0.3 * x, 0.3 * y, 0.12, x, y, 0.13, 0.014);
        parts_bar(b, x, y, 0.10, x, y, 0.165, 0.022);
    }
    mesh_part(b, 0, "legs", "metal_dark", HEAT_PASSIVE);
    for (int i = 0; i < 4; i++) {
        const double x = i < 2 ? 0.11 : -0.11, y = i % 2 ? 0.09 : -0.09;
        parts_bar(b, 0.6 * x, 0.6 * y, 0.10, x, y, 0.008, 0.008);
    }
    mesh_part(b, 0, "battery", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, -0.10, 0.03, -0.05, 0.05, 0.16, 0.185);
    mesh_part(b, 0, "camera", "glass_window", HEAT_PASSIVE);
    mesh_sphere(b, place_at(0.13, 0, -0.065), 0.03);
    for (int i = 0; i < 4; i++) {
        char name[16];
        snprintf(name, sizeof name, "rotor_%d", i + 1);
        parts_rotor(b, name, i < 2 ? reach : -reach, i % 2 ? reach : -reach, 0.172, 0.13, 0.022, 2, 5000);
        /* at rest the blades lie across the arms: as long as it is wide */
        const double s = sqrt(0.5), turned[9] = {s, -s, 0, s, s, 0, 0, 0, 1}, back[9] = {s, s, 0, -s, s, 0, 0, 0, 1};
        memcpy(mesh_node_get(b, 1 + i)->r_parent_from_node, i == 0 || i == 3 ? back : turned, sizeof turned);
    }
}

static void build_airship(MeshBuilder *b)
{
    const double r = 14.6 / 2, middle = 3.0 + r, half = 58.5 / 2;
    Station      s[9];
    for (int i = 0; i < 9; i++) { /* an ellipsoid, fuller in front */
        static const double at[9] = {-1, -0.9, -0.7, -0.4, 0, 0.4, 0.7, 0.9, 1};
        static const double share[9] = {0.02, 0.26, 0.57, 0.86, 1, 0.97, 0.79, 0.48, 0.03};
        s[i] = (Station){at[i] * half, share[i] * r, -(middle + share[i] * r), -(middle - share[i] * r), 1};
    }
    mesh_part(b, 0, "envelope", "paint_white_missile", HEAT_AIRFRAME);
    mesh_loft(b, place_at(0, 0, 0), s, 9);
    mesh_part(b, 0, "fins", "paint_grey", HEAT_AIRFRAME);
    for (int i = 0; i < 4; i++) {
        const Place place = place_turned(place_at(0, 0, -middle), (double[3]){1, 0, 0}, 0.5 * pi_rad * i);
        parts_wing(b, place, -17.5, -27.5, 2.2, 0, -21.5, -28.2, 7.6, 0, 0.05);
    }
    mesh_part(b, 0, "gondola", "paint_grey", HEAT_CABIN);
    const Station car[4] = {{-3.5, 0.7, -3.6, -1.2, 0.4},
                            {-2, 0.95, -3.8, -0.6, 0.3},
                            {2, 0.95, -3.8, -0.6, 0.3},
                            {3.6, 0.6, -3.5, -1.1, 0.4}};
    mesh_loft(b, place_at(0, 0, 0), car, 4);
    parts_bar(b, 0, 0, 0.9, 0, 0, 0.3, 0.08);
    mesh_cylinder(b, place_axis(0, 0, -0.3, 0, 1, 0), -0.1, 0.1, 0.3);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    for (int side = -1; side <= 1; side += 2)
        parts_box(b, -1.9, 2.2, side < 0 ? -0.97 : 0.93, side < 0 ? -0.93 : 0.97, 1.9, 2.8);
    mesh_part(b, 0, "engines", "metal_dark", HEAT_TURBINE);
    for (int side = -1; side <= 1; side += 2) {
        mesh_cylinder(b, place_at(-2.0, side * 1.9, -2.0), -0.8, 0.8, 0.35);
        parts_bar(b, -2.0, side * 0.8, 2.0, -2.0, side * 1.7, 2.0, 0.08);
    }
    parts_propeller(b, "propeller_left", -2.85, -1.9, 2.0, 0.9, 2, 1800);
    parts_propeller(b, "propeller_right", -2.85, 1.9, 2.0, 0.9, 2, 1800);
}

Status parametric_rotorcraft(Model *out, const char *name, double sag_m)
{
    static const ShapeKind kinds[] = {
        {"helicopter_utility", build_utility, 0},
        {"helicopter_tandem", build_tandem, 0},
        {"helicopter_light", build_light_helicopter, 0},
        {"quadcopter", build_quadcopter, 0.0005},
        {"airship", build_airship, 0},
    };
    return parts_build(out, kinds, name, "fuselage", sag_m);
}
