/* entities/shapes/truck.c: 6 x 6 cargo truck of the Ural-4320 class. Published: 7.366 m long, 2.500 m wide, 2.870 m
 * high over the canvas, wheel base 3.525 + 1.400 m, track 2.000 m, tyres 14.00-20 (1.26 m across, 0.37 m wide), ground
 * clearance 0.40 m (manufacturer's data as repeated in the open encyclopedias; Jane's Military Vehicles and Logistics).
 * Engine under a bonnet ahead of the cab. The upright exhaust stack on the right behind the cab and the fuel tank on
 * the left are this model's own choice, and distinguish its sides. The rest is estimate. */
#include "entities/shapes/mesh_builder.h"
#include "entities/shapes/parametric.h"

#include <stdio.h>

static const double half_length_m = 3.683, half_width_m = 1.25, roof_z_m = -2.87;
static const double wheel_radius_m = 0.63, half_track_m = 1.0, half_tyre_m = 0.185;
static const double axle_x_m[3] = {2.60, -0.925, -2.325};
static const double bed_front_m = 0.10, bed_rear_m = -3.60, bed_floor_z_m = -1.40;

static Place mirrored(int side)
{
    const Place here = place_at(0, 0, 0);
    return side < 0 ? place_mirror_y(here) : here;
}

static void build_chassis(MeshBuilder *b)
{
    const Place here = place_at(0, 0, 0);
    mesh_part(b, 0, "frame", "paint_olive", HEAT_HULL);
    for (int side = -1; side <= 1; side += 2) {
        mesh_box(b, mirrored(side), -3.55, 0.36, -1.08, 3.50, 0.45, -0.86);
        /* leaf springs */
        mesh_box(b, mirrored(side), 2.05, 0.50, -0.78, 3.15, 0.60, -0.70);
        mesh_box(b, mirrored(side), -2.35, 0.50, -0.84, -0.90, 0.62, -0.74);
    }
    for (int i = 0; i < 3; i++) {
        mesh_bar(b, (double[3]){axle_x_m[i], -0.82, -wheel_radius_m}, (double[3]){axle_x_m[i], 0.82, -wheel_radius_m},
                 0.075);
        mesh_sphere(b, place_at(axle_x_m[i], 0, -wheel_radius_m), 0.22);
    }
    mesh_bar(b, (double[3]){axle_x_m[2], 0, -0.66}, (double[3]){1.2, 0, -0.85}, 0.05); /* propeller shaft */
    /* bumpers front and rear, tow hooks */
    mesh_box(b, here, 3.56, -1.20, -0.98, half_length_m, 1.20, -0.74);
    for (int side = -1; side <= 1; side += 2) {
        mesh_box(b, mirrored(side), 3.45, 0.36, -1.02, 3.60, 0.45, -0.80);
        mesh_box(b, mirrored(side), -half_length_m, 0.45, -0.98, -3.50, 1.05, -0.84);
    }
    mesh_box(b, here, -half_length_m, -0.08, -1.02, -3.50, 0.08, -0.88);
    mesh_part(b, 0, "fuel_tank", "paint_olive", HEAT_PASSIVE);
    {
        static const Station tank[2] = {{-0.22, 0.26, -0.30, 0.30, 0.35}, {0.85, 0.26, -0.30, 0.30, 0.35}};
        mesh_loft(b, place_at(0, -0.95, -0.86), tank, 2);
        mesh_cylinder(b, place_axis(0.65, -1.0, -1.14, 0, -0.3, -1), 0, 0.12, 0.05);
    }
    mesh_part(b, 0, "air_tanks", "metal_dark", HEAT_PASSIVE);
    mesh_cylinder(b, place_axis(0.0, 0.80, -0.72, 1, 0, 0), -0.20, 0.50, 0.13);
    mesh_cylinder(b, place_axis(0.0, 1.05, -0.80, 1, 0, 0), -0.20, 0.50, 0.11);
}

static void build_cab(MeshBuilder *b)
{
    const Place here = place_at(0, 0, 0);
    /* seen from the side: floor, scuttle, raked windscreen, roof, back wall */
    static const double cab[6][2] = {{0.42, -1.02}, {1.95, -1.02}, {1.95, -1.80},
                                     {1.62, -2.52}, {1.45, -2.60}, {0.42, -2.58}};
    mesh_part(b, 0, "cab", "paint_olive", HEAT_CABIN);
    mesh_prism(b, here, 6, cab, -1.10, 1.10);
    for (int side = -1; side <= 1; side += 2) {
        const Place place = mirrored(side);
        mesh_box(b, place, 0.95, 1.09, -0.86, 1.62, 1.20, -0.80);  /* step */
        mesh_box(b, place, 0.80, 1.09, -1.55, 0.95, 1.125, -1.52); /* door handle */
        /* mirror on its arm */
        mesh_bar(b, (double[3]){1.80, side * 1.08, -2.02}, (double[3]){1.95, side * 1.20, -2.02}, 0.012);
        mesh_box(b, place, 1.93, 1.14, -2.20, 1.96, 1.245, -1.90);
    }
    /* front wings over the wheels: one bent sheet a side, with the lamp's housing */
    mesh_part(b, 0, "wings", "paint_olive", HEAT_PASSIVE);
    static const double wing[10][2] = {{1.70, -0.95}, {1.95, -1.36}, {2.25, -1.44}, {3.05, -1.44}, {3.42, -1.34},
                                       {3.50, -1.05}, {3.44, -1.05}, {3.30, -1.28}, {3.02, -1.39}, {2.0, -1.32}};
    for (int side = -1; side <= 1; side += 2) {
        mesh_prism(b, mirrored(side), 10, wing, 0.62, 1.21);
        mesh_box(b, mirrored(side), 3.30, 0.74, -1.36, 3.50, 1.10, -1.06);
    }
    mesh_part(b, 0, "lamps", "glass_window", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        mesh_cylinder(b, place_axis(3.49, 0.92 * side, -1.20, 1, 0, 0), 0, 0.04, 0.105);

    /* glass stands 8 mm proud of the cab */
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    for (int side = -1; side <= 1; side += 2) {
        /* half a windscreen each, in the plane of the rake: from (1.95, -1.80) to (1.62, -2.52) */
        static const double pane[4][2] = {{1.926, -1.87}, {1.936, -1.866}, {1.650, -2.478}, {1.640, -2.482}};
        mesh_prism(b, mirrored(side), 4, pane, 0.03, 0.98);
        static const double door[4][2] = {{0.66, -1.82}, {1.72, -1.82}, {1.50, -2.44}, {0.66, -2.44}};
        mesh_prism(b, mirrored(side), 4, door, 1.095, 1.108);
        mesh_box(b, mirrored(side), 0.412, 0.15, -2.40, 0.43, 0.80, -1.95);
    }
    /* bonnet, narrower than the cab, its top falling forward */
    mesh_part(b, 0, "bonnet", "paint_olive", HEAT_ENGINE_DECK);
    static const Station bonnet[3] = {
        {1.93, 0.72, -1.86, -0.98, 0.22}, {2.60, 0.69, -1.83, -0.98, 0.24}, {3.44, 0.64, -1.72, -0.98, 0.28}};
    mesh_loft(b, here, bonnet, 3);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 5; i++) {
            const double x = 2.25 + 0.16 * i; /* side louvres */
            mesh_box(b, mirrored(side), x, 0.60, -1.62, x + 0.05, 0.715, -1.50);
        }
    mesh_part(b, 0, "grille", "metal_dark", HEAT_ENGINE_DECK);
    for (int i = 0; i < 7; i++) {
        const double z = -1.58 + 0.08 * i;
        mesh_box(b, here, 3.42, -0.52, z, 3.47, 0.52, z + 0.03);
    }
}

static void build_exhaust(MeshBuilder *b)
{
    /* upright stack with a silencer on the right, behind the cab, cut off above the roof */
    mesh_part(b, 0, "exhaust_stack", "metal_dark", HEAT_EXHAUST);
    mesh_bar(b, (double[3]){0.62, 0.70, -0.80}, (double[3]){0.26, 1.04, -1.06}, 0.05);
    mesh_cylinder(b, place_axis(0.26, 1.04, -1.02, 0, 0, -1), 0, 0.95, 0.10);
    mesh_tube(b, place_axis(0.26, 1.04, -1.95, 0, 0, -1), 0, 0.85, 0.05, 0.042);
}

static void build_bed(MeshBuilder *b)
{
    const Place here = place_at(0, 0, 0);
    mesh_part(b, 0, "bed", "paint_olive", HEAT_PASSIVE);
    mesh_box(b, here, bed_rear_m, -half_width_m, bed_floor_z_m, bed_front_m, half_width_m, bed_floor_z_m + 0.10);
    for (int i = 0; i < 6; i++) { /* cross members on the frame */
        const double x = bed_rear_m + 0.15 + 0.64 * i;
        mesh_box(b, here, x, -1.15, bed_floor_z_m + 0.09, x + 0.10, 0.80, -1.07);
    }
    for (int side = -1; side <= 1; side += 2) {
        mesh_box(b, mirrored(side), bed_rear_m, 1.20, -1.92, bed_front_m, half_width_m, bed_floor_z_m + 0.01);
        for (int i = 0; i < 7; i++) { /* stakes */
            const double x = bed_rear_m + 0.02 + 0.595 * i;
            mesh_box(b, mirrored(side), x, half_width_m - 0.03, -1.90, x + 0.07, half_width_m, bed_floor_z_m);
        }
        /* mudguards' flaps ahead of and behind the bogie */
        mesh_box(b, mirrored(side), -3.08, 0.80, bed_floor_z_m + 0.05, -3.05, 1.20, -0.70);
    }
    mesh_box(b, here, bed_front_m - 0.05, -half_width_m, -1.92, bed_front_m, half_width_m, bed_floor_z_m + 0.01);
    mesh_box(b, here, bed_rear_m, -half_width_m, -1.92, bed_rear_m + 0.05, half_width_m, bed_floor_z_m + 0.01);
    mesh_part(b, 0, "rear_lamps", "glass_window", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        mesh_box(b, mirrored(side), bed_rear_m - 0.03, 0.98, -1.20, bed_rear_m + 0.01, 1.16, -1.08);

    /* canvas on five bows: it hangs 4 cm between them */
    mesh_part(b, 0, "canvas", "canvas", HEAT_PASSIVE);
    Station cover[9];
    for (int i = 0; i < 9; i++) {
        const double x = bed_rear_m + 0.01 + (bed_front_m - bed_rear_m - 0.02) * i / 8;
        const bool   bow = i % 2 == 0;
        cover[i] = (Station){x, bow ? 1.235 : 1.215, bow ? roof_z_m : roof_z_m + 0.04, -1.86, 0.30};
    }
    mesh_loft(b, here, cover, 9);
}

static void build_wheel(MeshBuilder *b, int axle, int side)
{
    char name[24];
    snprintf(name, sizeof name, "wheel_%s_%d", side < 0 ? "left" : "right", axle + 1);
    const int node = mesh_node(b, name, 0, axle_x_m[axle], side * half_track_m, -wheel_radius_m);
    mesh_joint(b, node, 0, -1, 0, 0, 0, 1, -1); /* travelling forward takes the top forward */
    mesh_node_get(b, node)->roll_radius_m = wheel_radius_m;

    const Place  outwards = place_axis(0, 0, 0, 0, side, 0);
    const double shoulder = 0.07, bead = 0.29, w = half_tyre_m, r = wheel_radius_m;
    mesh_part(b, node, "tyre", "rubber_black", HEAT_WHEEL);
    mesh_profile_begin(b, -0.85 * w, bead);
    mesh_profile_line(b, -w, r - shoulder - 0.10);
    mesh_profile_line(b, -w, r - shoulder);
    mesh_profile_arc(b, -w + shoulder, r - shoulder, -0.5 * pi_rad);
    mesh_profile_line(b, w - shoulder, r);
    mesh_profile_arc(b, w - shoulder, r - shoulder, -0.5 * pi_rad);
    mesh_profile_line(b, w, r - shoulder - 0.10);
    mesh_profile_line(b, 0.85 * w, bead);
    mesh_profile_line(b, -0.85 * w, bead);
    mesh_lathe(b, outwards);
    /* cross-country lugs on the shoulders, within the tyre's radius */
    const double axle_line[3] = {0, side, 0};
    for (int i = 0; i < 20; i++) {
        const Place  lug = place_turned(outwards, axle_line, 2 * pi_rad * i / 20);
        const double outer = sqrt((r - 0.002) * (r - 0.002) - 0.035 * 0.035);
        mesh_box(b, lug, w - 0.06, -0.035, r - 0.12, w + 0.004, 0.035, outer - 0.005);
        mesh_box(b, lug, -w - 0.004, -0.035, r - 0.12, -w + 0.06, 0.035, outer - 0.005);
    }
    mesh_part(b, node, "rim", "paint_olive", HEAT_WHEEL);
    mesh_profile_begin(b, -0.12, 0);
    mesh_profile_line(b, -0.12, bead + 0.005);
    mesh_profile_line(b, 0.80 * w, bead + 0.005);
    mesh_profile_line(b, 0.80 * w, bead - 0.03);
    mesh_profile_line(b, 0.02, 0.22);
    mesh_profile_line(b, 0.06, 0.12);
    mesh_profile_line(b, 0.17, 0.10);
    mesh_profile_line(b, 0.17, 0);
    mesh_lathe(b, outwards);
    for (int i = 0; i < 8; i++) {
        const Place bolt = place_turned(outwards, axle_line, 2 * pi_rad * i / 8);
        mesh_box(b, bolt, 0.0, -0.018, 0.155, 0.065, 0.018, 0.190);
    }
}

Status parametric_truck(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("truck", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "chassis", -1, 0, 0, 0);
    build_chassis(b);
    build_cab(b);
    build_exhaust(b);
    build_bed(b);
    /* spare wheel upright between cab and bed, left of the middle */
    mesh_part(b, 0, "spare_wheel", "rubber_black", HEAT_PASSIVE);
    mesh_cylinder(b, place_axis(0.10, -0.35, -1.75, 1, 0, 0), 0.03, 0.30, 0.58);
    for (int axle = 0; axle < 3; axle++)
        for (int side = -1; side <= 1; side += 2) build_wheel(b, axle, side);
    return mesh_builder_finish(out, b);
}
