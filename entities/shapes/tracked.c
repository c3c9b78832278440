/* entities/shapes/tracked.c: tracked vehicles with a load: an infantry carrier and an air-defence launcher. */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

/* ---- infantry carrier ------------------------------------------------------------------------ */

/* Tracked infantry carrier of the AIFV / YPR-765 class, the M113's relative with a gun turret. Published (Jane's Armour
 * and Artillery, FMC AIFV; the same in the open encyclopedias): 5.258 m long, 2.819 m wide, hull top at 2.007 m, turret
 * roof at 2.619 m, 2.794 m over all, ground clearance 0.432 m, track 0.381 m wide on 2.159 m between centres, 2.667 m
 * on the ground, five road wheels of 0.61 m a side, drive in front; 25 mm gun, traverse 360 degrees, elevation -10 ..
 * +50 degrees; driver front left, engine and exhaust front right, turret right of the middle behind the engine,
 * commander's cupola behind the driver, ramp hinged at the foot of the rear. The rest is estimate.
 *
 * Articulated: turret (4096 azimuth), gun (4416 elevation), cupola (5696 azimuth), its machine gun (6016 elevation),
 * ramp (3232 hatch, position 0 shut .. 1 down on the ground). */

static const double half_length_m = 5.258 / 2, carrier_half_width_m = 2.819 / 2, top_m = 2.007, clearance_m = 0.432;
static const double turret_x_m = -0.20, turret_y_m = 0.34, roof_m = 2.619, sight_m = 2.794;
static const double ramp_x_m = -2.47, ramp_z_m = -0.62;
static const double ramp_down_rad = 2.02; /* its outer face then rests on the ground */

static const RunningGear carrier_gear = {
    .half_gauge_m = 2.159 / 2,
    .track_width_m = 0.381,
    .band_m = 0.03,
    .cleat_m = 0.02,
    .cleat_length_m = 0.07,
    .links = 64,
    .road_wheels = 5,
    .first_x_m = 1.28,
    .step_m = 2.667 / 4,
    .road_radius_m = 0.305,
    .front_x_m = 2.05,
    .front_z_m = -0.70,
    .front_radius_m = 0.24,
    .rear_x_m = -2.02,
    .rear_z_m = -0.58,
    .rear_radius_m = 0.20,
    .front_drives = true,
};

static void build_carrier_hull(MeshBuilder *b)
{
    const Place here = place_at(0, 0, 0);
    /* between the tracks, with a nose that turns up; the rear is open for the ramp */
    const double tub[6][2] = {{-2.40, -clearance_m}, {1.95, -clearance_m}, {2.52, -0.80},
                              {2.60, -1.10},         {2.60, -1.20},        {-2.43, -1.20}};
    mesh_part(b, 0, "hull", "paint_olive", HEAT_HULL);
    mesh_prism(b, here, 6, tub, -0.87, 0.87);
    /* over the tracks: straight sides, then leaning in; glacis in front, a little rake behind */
    const Rectangle belt = {-2.46, half_length_m, -1.37, 1.37};
    parts_block(b, belt, 1.04, belt, 1.22);
    parts_block(b, belt, 1.22, (Rectangle){-2.40, 1.85, -1.18, 1.18}, top_m);
    /* steel plates bolted a hand off the sides */
    for (int side = -1; side <= 1; side += 2) {
        mesh_box(b, parts_side(side), -2.30, 1.36, -1.34, 2.35, carrier_half_width_m, -1.06);
        for (int i = 0; i < 3; i++) /* firing ports under their periscopes */
            if (side > 0 || i < 2)
                mesh_cylinder(b, place_axis(-1.9 + 0.75 * i, side * 1.26, -1.62, 0, side, -0.24), 0, 0.07, 0.11);
    }
    /* trim vane on the glacis, towing eyes, step */
    const double vane[4][2] = {{2.595, -1.20}, {1.98, -1.87}, {2.00, -1.93}, {half_length_m, -1.24}};
    mesh_prism(b, here, 4, vane, -1.02, 1.02);
    for (int side = -1; side <= 1; side += 2) {
        mesh_box(b, parts_side(side), 2.50, 0.55, -0.98, 2.629, 0.63, -0.86);
        mesh_box(b, parts_side(side), -half_length_m, 0.80, -0.62, -2.35, 0.88, -0.50);
    }
    /* rear fuel cells either side of the ramp: they make the length */
    for (int side = -1; side <= 1; side += 2)
        mesh_box(b, parts_side(side), -half_length_m, 0.82, -1.90, -2.38, 1.30, -0.95);

    mesh_part(b, 0, "roof_fittings", "paint_olive", HEAT_HULL);
    /* driver's hatch with four periscopes, front left */
    mesh_cylinder(b, place_axis(1.25, -0.62, -top_m + 0.01, 0, 0, -1), 0, 0.08, 0.33);
    for (int i = 0; i < 4; i++) {
        const double a = -0.9 + 0.6 * i;
        const Place  turn = place_turned(place_at(1.25, -0.62, 0), (double[3]){0, 0, 1}, a);
        mesh_box(b, turn, 0.34, -0.09, -top_m - 0.10, 0.44, 0.09, -top_m + 0.01);
    }
    mesh_box(b, here, -2.25, -0.60, -top_m - 0.05, -1.05, 0.60, -top_m + 0.01); /* troop hatch */
    mesh_bar(b, (double[3]){-2.25, 0.62, -top_m - 0.03}, (double[3]){-1.05, 0.62, -top_m - 0.03}, 0.03);
    /* aerial base, rear left */
    mesh_cylinder(b, place_axis(-0.9, -0.98, -top_m + 0.02, 0, 0, -1), 0, 0.20, 0.05);

    mesh_part(b, 0, "engine_deck", "paint_olive", HEAT_ENGINE_DECK);
    mesh_box(b, here, 0.75, -0.10, -top_m - 0.035, 1.80, 1.02, -top_m + 0.01);
    for (int i = 0; i < 9; i++) {
        const double x = 0.82 + 0.105 * i;
        const double slat[4][2] = {
            {x, -top_m - 0.03}, {x + 0.03, -top_m - 0.03}, {x + 0.07, -top_m - 0.075}, {x + 0.04, -top_m - 0.075}};
        mesh_prism(b, here, 4, slat, -0.05, 0.68);
    }
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    mesh_box(b, here, 0.95, 0.74, -top_m - 0.13, 1.55, 1.00, -top_m);
    for (int i = 0; i < 4; i++)
        mesh_box(b, here, 0.98, 0.98, -top_m - 0.12 + 0.03 * i, 1.52, 1.035, -top_m - 0.105 + 0.03 * i);
    mesh_part(b, 0, "lamps", "glass_window", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        mesh_cylinder(b, place_axis(2.36, 1.08 * side, -1.60, 1, 0, 0), -0.05, 0.10, 0.085);
        mesh_box(b, parts_side(side), -half_length_m - 0.0, 1.02, -1.85, -half_length_m + 0.02, 1.20, -1.75);
    }
    /* what an open ramp shows: a dark, crewed bay, here as a plate behind it */
    mesh_part(b, 0, "troop_bay", "metal_dark", HEAT_CABIN);
    mesh_box(b, here, -2.475, -0.70, -1.80, -2.38, 0.70, -0.68);
    mesh_part(b, 0, "mudguards", "rubber_black", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) mesh_box(b, parts_side(side), 2.34, 0.90, -1.10, 2.40, 1.27, -0.72);
}

static void build_ramp(MeshBuilder *b, int ramp)
{
    /* stands up from its hinge; the door in it shows as a frame */
    mesh_part(b, ramp, "ramp", "paint_olive", HEAT_CABIN);
    mesh_box(b, place_at(0, 0, 0), -0.06, -0.79, -1.28, 0.02, 0.79, 0);
    mesh_box(b, place_at(0, 0, 0), -0.085, -0.62, -1.18, -0.05, 0.12, -0.14);
    mesh_bar(b, (double[3]){0, -0.80, 0}, (double[3]){0, 0.80, 0}, 0.045);
    mesh_bar(b, (double[3]){-0.10, -0.02, -0.72}, (double[3]){-0.10, -0.02, -0.55}, 0.015);
}

static void build_turret(MeshBuilder *b, int turret)
{
    const double rise = roof_m - top_m;
    mesh_part(b, turret, "turret", "paint_olive", HEAT_TURRET);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), -0.02, 0.06, 0.62);
    /* welded box, sloped all round */
    parts_block(b, (Rectangle){-0.66, 0.78, -0.64, 0.64}, 0.05, (Rectangle){-0.66, 0.72, -0.62, 0.62}, 0.22);
    parts_block(b, (Rectangle){-0.66, 0.72, -0.62, 0.62}, 0.22, (Rectangle){-0.48, 0.30, -0.42, 0.42}, rise);
    mesh_cylinder(b, place_axis(-0.14, 0.02, -rise + 0.01, 0, 0, -1), 0, 0.05, 0.30); /* hatch */
    mesh_box(b, place_at(0, 0, 0), -0.98, -0.50, -0.42, -0.60, 0.50, -0.10);          /* bustle rack */
    mesh_part(b, turret, "sight", "metal_dark", HEAT_TURRET);
    mesh_box(b, place_at(0, 0, 0), 0.12, -0.40, -(sight_m - top_m), 0.34, -0.14, -rise + 0.05);
    mesh_part(b, turret, "sight_glass", "glass_window", HEAT_PASSIVE);
    mesh_box(b, place_at(0, 0, 0), 0.335, -0.36, -(sight_m - top_m) + 0.03, 0.35, -0.18, -rise - 0.03);
    mesh_part(b, turret, "smoke_dischargers", "metal_dark", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 3; i++)
            mesh_cylinder(b, place_axis(0.52, side * (0.52 + 0.09 * i), -0.30, 1, side * (0.25 + 0.15 * i), -0.5), 0,
                          0.24, 0.04);
}

static void build_gun(MeshBuilder *b, int gun)
{
    mesh_part(b, gun, "mantlet", "paint_olive", HEAT_TURRET);
    mesh_box(b, place_at(0, 0, 0), -0.10, -0.20, -0.14, 0.22, 0.24, 0.14);
    mesh_part(b, gun, "barrel", "metal_dark", HEAT_GUN);
    mesh_profile_begin(b, 0.15, 0);
    mesh_profile_line(b, 0.15, 0.055);
    mesh_profile_line(b, 0.70, 0.045);
    mesh_profile_line(b, 0.75, 0.030);
    mesh_profile_line(b, 2.00, 0.024);
    mesh_profile_line(b, 2.00, 0.040);
    mesh_profile_line(b, 2.15, 0.040);
    mesh_profile_line(b, 2.15, 0.0125);
    mesh_profile_line(b, 1.80, 0.0125);
    mesh_profile_line(b, 1.80, 0);
    mesh_lathe(b, place_at(0, 0, 0));
    mesh_cylinder(b, place_at(0, 0.16, 0.02), 0.10, 0.75, 0.018); /* coaxial machine gun */
}

Status parametric_carrier(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("carrier", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "hull", -1, 0, 0, 0);
    build_carrier_hull(b);
    parts_tracks(b, &carrier_gear);
    for (int side = -1; side <= 1; side += 2) parts_track_wheels(b, &carrier_gear, side);

    const int ramp = mesh_node(b, "ramp", 0, ramp_x_m, 0, ramp_z_m);
    mesh_joint(b, ramp, 0, 1, 0, 3232, 1, 0, ramp_down_rad); /* right-handed: its top falls back */
    mesh_node_get(b, ramp)->dis_scale = ramp_down_rad;
    build_ramp(b, ramp);

    const int turret = mesh_node(b, "turret", 0, turret_x_m, turret_y_m, -top_m);
    mesh_joint(b, turret, 0, 0, 1, 4096, 11, 1, -1);
    build_turret(b, turret);
    const int gun = mesh_node(b, "gun", turret, 0.62, 0, -0.27);
    mesh_joint(b, gun, 0, 1, 0, 4416, 13, -10 * rad_per_deg, 50 * rad_per_deg);
    build_gun(b, gun);

    const int cupola = mesh_node(b, "cupola", 0, 0.35, -0.72, -top_m);
    mesh_joint(b, cupola, 0, 0, 1, 5696, 11, 1, -1);
    mesh_part(b, cupola, "cupola", "paint_olive", HEAT_TURRET);
    mesh_cone(b, place_axis(0, 0, 0, 0, 0, -1), -0.01, 0.36, 0.14, 0.32);
    mesh_cylinder(b, place_axis(-0.04, 0, -0.13, 0, 0, -1), 0, 0.05, 0.26);
    mesh_box(b, place_at(0, 0, 0), 0.20, -0.10, -0.24, 0.30, 0.10, -0.10);
    mesh_bar(b, (double[3]){0.10, 0.22, -0.12}, (double[3]){0.10, 0.22, -0.30}, 0.025);
    const int machine_gun = mesh_node(b, "machine_gun", cupola, 0.10, 0.22, -0.34);
    mesh_joint(b, machine_gun, 0, 1, 0, 6016, 13, -10 * rad_per_deg, 60 * rad_per_deg);
    mesh_part(b, machine_gun, "machine_gun", "metal_dark", HEAT_GUN);
    mesh_box(b, place_at(0, 0, 0), -0.30, -0.04, -0.05, 0.20, 0.04, 0.06);
    mesh_box(b, place_at(0, 0, 0), -0.08, -0.18, -0.05, 0.12, -0.04, 0.10);
    mesh_tube(b, place_at(0, 0, 0), 0.18, 0.85, 0.015, 0.004);
    return mesh_builder_finish(out, b);
}

/* ---- air-defence launcher -------------------------------------------------------------------- */

/* Tracked air-defence launcher of the 2P25 class (2K12 Kub, SA-6): three missiles on one turntable. Published (Jane's
 * Land-Based Air Defence; Zaloga; the same in the open encyclopedias): 7.389 m long over the missiles, 3.18 m wide,
 * 3.45 m high, six road wheels a side, drive behind, 0.40 m clearance; missile 3M9: 5.80 m long, 0.335 m across, wings
 * of 1.245 m span. Launcher elevation to 80 degrees is estimate, as are hull lines, wheel base and turntable.
 *
 * The missiles point ahead, level, as before a launch. Articulated: turntable (4096 azimuth), rails with their missiles
 * (4736 primary launcher, elevation). */

static const double launcher_half_width_m = 3.18 / 2, height_m = 3.45, overall_m = 7.389, deck_m = 1.55;
static const double rear_x_m = -3.45;                          /* hull 6.79 m: its nose is at 3.34 m */
static const double turntable_x_m = -0.55, table_top_m = 2.02; /* above the ground */
static const double hinge_x_m = -0.95, hinge_m = 2.42;         /* of the rails: x from the turntable, height */
static const double spacing_m = 0.93, middle_lift_m = 0.07, missile_m = 5.80, body_radius_m = 0.1675;
static const double half_span_m = 1.245 / 2;

static const RunningGear launcher_gear = {
    .half_gauge_m = 1.31,
    .track_width_m = 0.36,
    .band_m = 0.03,
    .cleat_m = 0.02,
    .cleat_length_m = 0.06,
    .links = 93,
    .road_wheels = 6,
    .first_x_m = 2.08,
    .step_m = 0.78,
    .road_radius_m = 0.335,
    .front_x_m = 2.85,
    .front_z_m = -0.66,
    .front_radius_m = 0.27,
    .rear_x_m = -2.80,
    .rear_z_m = -0.72,
    .rear_radius_m = 0.30,
    .front_drives = false,
};

static void build_launcher_hull(MeshBuilder *b)
{
    const Place         here = place_at(0, 0, 0);
    static const double tub[7][2] = {{-3.20, -0.40}, {2.55, -0.40},  {3.34, -0.98}, {3.34, -1.12},
                                     {2.70, -1.16},  {-3.45, -1.16}, {-3.45, -0.75}};
    mesh_part(b, 0, "hull", "paint_olive", HEAT_HULL);
    mesh_prism(b, here, 7, tub, -1.10, 1.10);
    /* over the tracks: shelf, then the low box of the fighting compartment with a raked cab front */
    parts_block(b, (Rectangle){rear_x_m, 3.10, -1.53, 1.53}, 1.13, (Rectangle){rear_x_m, 2.95, -1.53, 1.53}, 1.24);
    parts_block(b, (Rectangle){rear_x_m, 2.75, -1.45, 1.45}, 1.24, (Rectangle){rear_x_m + 0.08, 2.05, -1.38, 1.38},
                deck_m);
    for (int side = -1; side <= 1; side += 2) {
        mesh_box(b, parts_side(side), -3.20, 1.52, -1.22, 2.80, launcher_half_width_m, -1.10); /* fender's rim */
        mesh_box(b, parts_side(side), -1.9, 1.40, -1.46, -0.9, 1.56, -1.23);                   /* bins */
        mesh_box(b, parts_side(side), 0.2, 1.40, -1.46, 1.3, 1.56, -1.23);
        mesh_box(b, parts_side(side), 3.20, 0.66, -1.02, 3.36, 0.76, -0.88); /* tow hooks */
        for (int i = 0; i < 3; i++)                                          /* return rollers, fixed */
            mesh_cylinder(b, place_axis(1.5 - 1.6 * i, side * 1.31, -0.93, 0, side, 0), -0.10, 0.10, 0.075);
    }
    mesh_part(b, 0, "cab", "paint_olive", HEAT_CABIN);
    for (int side = -1; side <= 1; side += 2) {
        mesh_cylinder(b, place_axis(1.70, 0.62 * side, -deck_m + 0.02, 0, 0, -1), 0, 0.07, 0.31);
        mesh_box(b, parts_side(side), 2.00, 0.48, -deck_m - 0.09, 2.10, 0.76, -deck_m + 0.02);
    }
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    for (int side = -1; side <= 1; side += 2) { /* on the rake from (2.75, 1.24) to (2.05, 1.55) */
        static const double pane[4][2] = {{2.53, -1.345}, {2.24, -1.473}, {2.25, -1.495}, {2.54, -1.367}};
        mesh_prism(b, parts_side(side), 4, pane, 0.34, 0.92);
    }
    mesh_part(b, 0, "lamps", "glass_window", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        mesh_cylinder(b, place_axis(2.85, 1.22 * side, -1.34, 1, 0, 0), -0.12, 0.05, 0.10);

    mesh_part(b, 0, "engine_deck", "paint_olive", HEAT_ENGINE_DECK);
    mesh_box(b, here, -3.30, -1.20, -deck_m - 0.05, -2.05, 1.20, -deck_m + 0.02);
    for (int i = 0; i < 10; i++) {
        const double x = -3.22 + 0.11 * i;
        const double slat[4][2] = {
            {x, -deck_m - 0.04}, {x + 0.03, -deck_m - 0.04}, {x + 0.07, -deck_m - 0.10}, {x + 0.04, -deck_m - 0.10}};
        mesh_prism(b, here, 4, slat, -1.05, 1.05);
    }
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    mesh_box(b, here, -3.10, 1.30, -deck_m - 0.02, -2.35, 1.55, -1.23);
    for (int i = 0; i < 4; i++) mesh_box(b, here, -3.05, 1.54, -1.50 + 0.06 * i, -2.40, 1.585, -1.475 + 0.06 * i);
}

static void build_turntable(MeshBuilder *b, int table)
{
    mesh_part(b, table, "turntable", "paint_olive", HEAT_TURRET);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), -0.02, 0.16, 1.05);
    mesh_cylinder(b, place_axis(0, 0, -0.15, 0, 0, -1), 0, table_top_m - deck_m - 0.15, 0.88);
    /* cheeks that carry the hinge, and the housing of the drive between them */
    static const double cheek[4][2] = {{-1.20, -0.30}, {0.05, -0.30}, {-0.75, -0.95}, {-1.15, -0.95}};
    for (int side = -1; side <= 1; side += 2) {
        mesh_prism(b, parts_side(side), 4, cheek, 0.36, 0.46);
        mesh_prism(b, parts_side(side), 4, cheek, 1.28, 1.36);
        mesh_box(b, parts_side(side), -1.15, 0.80, -0.45, 0.10, 1.36, -0.28);
    }
    mesh_box(b, place_at(0, 0, 0), -0.60, -0.34, -0.60, 0.55, 0.34, -0.42);
}

/* One missile, its tail at the place's origin, pointing along x; wings as an X. */
static void build_missile_body(MeshBuilder *b, double x, double y, double z)
{
    const double r = body_radius_m;
    mesh_profile_begin(b, 0, 0);
    mesh_profile_line(b, 0, 0.85 * r);
    mesh_profile_line(b, 0.25, r);
    mesh_profile_line(b, 4.75, r);
    mesh_profile_line(b, 4.75, 0);
    mesh_lathe(b, place_at(x, y, z));
    for (int i = 0; i < 4; i++) {
        const Place fin = place_turned(place_at(x, y, z), (double[3]){1, 0, 0}, pi_rad / 4 + 0.5 * pi_rad * i);
        parts_wing(b, fin, 3.15, 2.35, 0.9 * r, 0, 2.75, 2.40, half_span_m, 0, 0.03);
        parts_wing(b, fin, 0.95, 0.08, 0.9 * r, 0, 0.55, 0.12, 0.52, 0, 0.03);
    }
    /* four ramjet intakes between the wings: long pipes */
    for (int i = 0; i < 4; i++) {
        const double a = 0.5 * pi_rad * i;
        mesh_cone(b, place_at(x, y + 0.185 * cos(a), z + 0.185 * sin(a)), 0.35, 0.062, 3.35, 0.055);
    }
}

static void build_rails(MeshBuilder *b, int rails, double tail_x)
{
    mesh_part(b, rails, "rails", "paint_olive", HEAT_PASSIVE);
    mesh_bar(b, (double[3]){0, -1.40, 0}, (double[3]){0, 1.40, 0}, 0.09);
    mesh_box(b, place_at(0, 0, 0), 1.55, -1.15, -0.06, 1.75, 1.15, 0.06);
    for (int i = -1; i <= 1; i++) {
        const double y = spacing_m * i, lift = i == 0 ? middle_lift_m : 0;
        mesh_box(b, place_at(0, y, -lift), -0.30, -0.10, -0.12, 3.10, 0.10, 0.08);
        for (int k = 0; k < 2; k++) /* shoes that hold the missile */
            mesh_box(b, place_at(0.15 + 2.3 * k, y, -lift), 0, -0.05, -0.26, 0.18, 0.05, -0.10);
    }
    /* the upper wing tips of the middle one make the height: the span, and half the tip's 3 % of 0.35 m */
    const double axis_m = height_m - hinge_m - middle_lift_m - (half_span_m + 0.5 * 0.03 * 0.35) * sqrt(0.5);
    mesh_part(b, rails, "missiles", "paint_grey", HEAT_PASSIVE);
    for (int i = -1; i <= 1; i++) build_missile_body(b, tail_x, spacing_m * i, -axis_m - (i == 0 ? middle_lift_m : 0));
    mesh_part(b, rails, "radomes", "radome_glass_fibre", HEAT_PASSIVE);
    for (int i = -1; i <= 1; i++) {
        /* tangent ogive 1.05 m long: radius (l^2 + r^2) / 2 r */
        const double l = missile_m - 4.75, r = body_radius_m, bend = (l * l + r * r) / (2 * r);
        mesh_profile_begin(b, 4.75, 0);
        mesh_profile_line(b, 4.75, r);
        mesh_profile_arc(b, 4.75, r - bend, -asin(l / bend));
        mesh_lathe(b, place_at(tail_x, spacing_m * i, -axis_m - (i == 0 ? middle_lift_m : 0)));
    }
}

Status parametric_launcher(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("launcher", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "hull", -1, 0, 0, 0);
    build_launcher_hull(b);
    parts_tracks(b, &launcher_gear);
    for (int side = -1; side <= 1; side += 2) parts_track_wheels(b, &launcher_gear, side);
    const int table = mesh_node(b, "turntable", 0, turntable_x_m, 0, -deck_m);
    mesh_joint(b, table, 0, 0, 1, 4096, 11, 1, -1);
    build_turntable(b, table);
    const int rails = mesh_node(b, "rails", table, hinge_x_m, 0, -(hinge_m - deck_m));
    mesh_joint(b, rails, 0, 1, 0, 4736, 13, 0, 80 * rad_per_deg);
    /* the noses make the length over all */
    const double nose_x = rear_x_m + overall_m;
    build_rails(b, rails, nose_x - missile_m - turntable_x_m - hinge_x_m);
    return mesh_builder_finish(out, b);
}
