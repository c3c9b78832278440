/* entities/shapes/tank.c: main battle tank of the T-72 class. Figures as published for the T-72A and its relatives
 * (Jane's Armour and Artillery; Zaloga, "T-72 Main Battle Tank 1974-93"; the same in the open encyclopedias): hull 6.95
 * m long, 9.53 m with the gun forward, 3.59 m wide over the skirts, 2.19 m to the turret roof, ground clearance 0.47 m,
 * six 0.75 m road wheels a side, track 0.58 m wide on 2.79 m between centres, 4.27 m on the ground, glacis 68 degrees
 * from the vertical, 125 mm gun of 6.0 m, elevation -6 .. +14 degrees, 12.7 mm machine gun on the commander's cupola
 * (right), engine exhaust on the left fender, infrared searchlight on the right of the gun. Rear sprocket, front idler.
 * Everything that those figures leave open is an estimate. */
#include "entities/shapes/mesh_builder.h"
#include "entities/shapes/parametric.h"

#include <stdio.h>

static const double track_half_gauge_m = 1.395, track_width_m = 0.58;
static const double band_m = 0.035, cleat_m = 0.02; /* thickness of the track under the wheel */
static const double tread_m = 0.001;                /* the corner of a cleat reaches this much deeper on a bend */
static const double road_wheel_radius_m = 0.375;
static const double idler_x_m = 2.93, idler_z_m = -0.78, idler_radius_m = 0.27;
static const double sprocket_x_m = -2.95, sprocket_z_m = -0.80, sprocket_radius_m = 0.31;
static const double first_wheel_x_m = 2.03, wheel_step_m = 0.854; /* 5 steps: 4.27 m on the ground */
static const double deck_z_m = -1.40;
static const double turret_x_m = 0.20;
static const double trunnion_x_m = 1.02, trunnion_z_m = -0.32; /* in the turret */
static const double muzzle_x_m = 9.53 - 6.95 / 2;              /* of the body */

static Place mirrored(Place place, int side) { return side < 0 ? place_mirror_y(place) : place; }

static void build_hull(MeshBuilder *b)
{
    /* between the tracks: belly, lower nose plate, glacis, deck, rear plate */
    static const double tub[8][2] = {{-3.20, -0.47}, {2.45, -0.47},  {3.475, -0.98},  {3.40, -1.02},
                                     {2.36, -1.40},  {-3.40, -1.40}, {-3.475, -1.28}, {-3.475, -0.85}};
    const Place         here = place_at(0, 0, 0);
    mesh_part(b, 0, "hull", "paint_olive", HEAT_HULL);
    mesh_prism(b, here, 8, tub, -1.08, 1.08);
    /* splash board on the glacis, an open V that sheds water to both sides */
    for (int side = -1; side <= 1; side += 2) {
        static const double board[4][2] = {{0, 0}, {0.03, 0}, {0.03, -0.10}, {0, -0.10}};
        static const double swept[4][2] = {{-0.38, -0.14}, {-0.35, -0.14}, {-0.35, -0.24}, {-0.38, -0.24}};
        mesh_slab(b, mirrored(place_at(2.93, 0, -1.165), side), 4, board, 0.0, swept, 0.95);
    }
    /* driver's hatch and periscope, on the centre line */
    mesh_cylinder(b, place_axis(2.05, 0, -1.38, 0, 0, -1), 0, 0.07, 0.32);
    mesh_box(b, here, 2.36, -0.14, -1.48, 2.46, 0.14, -1.36);
    /* tow hooks, front and rear */
    for (int side = -1; side <= 1; side += 2) {
        mesh_box(b, mirrored(here, side), 3.30, 0.72, -0.95, 3.475, 0.82, -0.83);
        mesh_box(b, mirrored(here, side), -3.475, 0.72, -0.80, -3.30, 0.82, -0.68);
    }
    /* unditching beam brackets and the plate of the rear number lamp: the rear is not the front */
    mesh_box(b, here, -3.475, -0.25, -1.25, -3.45, 0.25, -1.05);

    mesh_part(b, 0, "fenders", "paint_olive", HEAT_PASSIVE);
    static const double fender[6][2] = {{-3.43, -0.98}, {-3.40, -0.98}, {-3.25, -1.195},
                                        {3.10, -1.195}, {3.40, -1.00},  {3.43, -1.02}};
    static const double fender_top[4][2] = {{3.12, -1.225}, {-3.27, -1.225}, {-3.43, -0.98}, {3.43, -1.02}};
    double              outline[8][2];
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 2; k++) outline[i][k] = fender[i][k];
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++) outline[6 + i][k] = fender_top[i][k];
    for (int side = -1; side <= 1; side += 2) {
        const Place place = mirrored(here, side);
        mesh_prism(b, place, 8, (const double(*)[2])outline, 1.07, 1.76);
        /* stowage bins and fuel cells along the fender; on the left they stop before the exhaust */
        mesh_box(b, place, 0.85, 1.12, -1.42, 2.30, 1.70, -1.21);
        mesh_box(b, place, -0.65, 1.12, -1.44, 0.75, 1.72, -1.21);
        if (side > 0) {
            mesh_box(b, place, -2.15, 1.12, -1.44, -0.75, 1.72, -1.21);
            mesh_box(b, place, -3.10, 1.12, -1.40, -2.25, 1.66, -1.21);
        } else {
            mesh_box(b, place, -1.30, 1.12, -1.44, -0.75, 1.72, -1.21);
            mesh_box(b, place, -3.10, 1.12, -1.38, -2.55, 1.60, -1.21);
        }
    }
    mesh_part(b, 0, "skirts", "rubber_black", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        /* five sheets a side, 0.03 m apart, flared at the front */
        for (int i = 0; i < 5; i++) {
            const double x1 = 2.95 - 1.22 * i, x0 = x1 - 1.19;
            const double sheet[4][2] = {{x0, -1.215}, {x1, -1.215}, {x1 - (i == 0 ? 0.25 : 0), -0.66}, {x0, -0.66}};
            mesh_prism(b, mirrored(here, side), 4, sheet, 1.765, 1.795);
        }
    }
    mesh_part(b, 0, "lamps", "glass_window", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        mesh_cylinder(b, place_axis(2.98, 0.78 * side, -1.27, 1, 0, 0), 0, 0.10, 0.09);

    /* roof of the engine bay: a raised frame with slats across */
    mesh_part(b, 0, "engine_deck", "paint_olive", HEAT_ENGINE_DECK);
    mesh_box(b, here, -3.30, -0.98, -1.44, -1.55, 0.98, -1.39);
    for (int i = 0; i < 11; i++) {
        const double x = -3.22 + 0.10 * i;
        const double slat[4][2] = {{x, -1.43}, {x + 0.03, -1.43}, {x + 0.07, -1.49}, {x + 0.04, -1.49}};
        mesh_prism(b, here, 4, slat, -0.88, 0.88);
    }
    mesh_cylinder(b, place_axis(-1.82, 0.45, -1.43, 0, 0, -1), 0, 0.05, 0.20); /* filler caps */
    mesh_cylinder(b, place_axis(-1.82, -0.45, -1.43, 0, 0, -1), 0, 0.05, 0.14);

    /* outlet on the left fender, ahead of the last wheel: a box with louvres that blow outwards and back */
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    mesh_box(b, here, -2.45, -1.72, -1.50, -1.40, -1.05, -1.22);
    for (int i = 0; i < 4; i++) {
        const double z = -1.46 + 0.06 * i;
        mesh_box(b, here, -2.40, -1.785, z, -1.45, -1.70, z + 0.025);
    }
}

/* The same place turned about its own x axis: spokes, teeth. */
static Place about_axle(Place place, double angle_rad)
{
    const double axle[3] = {place.m[0], place.m[3], place.m[6]};
    return place_turned(place, axle, angle_rad);
}

/* A wheel's disc, with ribs so that its turning shows. Axes: x outwards (to the tank's side). */
static void build_disc(MeshBuilder *b, Place place, double radius, int ribs)
{
    mesh_profile_begin(b, -0.19, 0);
    mesh_profile_line(b, -0.19, radius);
    mesh_profile_line(b, 0.17, radius);
    mesh_profile_line(b, 0.17, 0.86 * radius);
    mesh_profile_line(b, 0.06, 0.70 * radius);
    mesh_profile_line(b, 0.09, 0.42 * radius);
    mesh_profile_line(b, 0.19, 0.34 * radius);
    mesh_profile_line(b, 0.20, 0);
    mesh_lathe(b, place);
    for (int i = 0; i < ribs; i++) {
        const Place rib = about_axle(place, 2 * pi_rad * i / ribs);
        mesh_box(b, rib, 0.04, -0.022, 0.36 * radius, 0.135, 0.022, 0.84 * radius);
    }
}

static int add_wheel_node(MeshBuilder *b, const char *kind, int side, int number, double x, double z, double radius)
{
    char name[24];
    if (number > 0) snprintf(name, sizeof name, "%s_%s_%d", kind, side < 0 ? "left" : "right", number);
    else snprintf(name, sizeof name, "%s_%s", kind, side < 0 ? "left" : "right");
    const int node = mesh_node(b, name, 0, x, side * track_half_gauge_m, z);
    /* about -y, so that travelling forward takes the top of the wheel forward */
    mesh_joint(b, node, 0, -1, 0, 0, 0, 1, -1);
    mesh_node_get(b, node)->roll_radius_m = radius;
    return node;
}

static void build_running_gear(MeshBuilder *b, int side)
{
    const double wheel_z = -(road_wheel_radius_m + band_m + cleat_m + tread_m);
    const Place  outwards = place_axis(0, 0, 0, 0, side, 0);
    for (int i = 0; i < 6; i++) {
        const int node =
            add_wheel_node(b, "wheel", side, i + 1, first_wheel_x_m - i * wheel_step_m, wheel_z, road_wheel_radius_m);
        mesh_part(b, node, "wheel_disc", "paint_olive", HEAT_WHEEL);
        build_disc(b, outwards, 0.315, 6);
        mesh_part(b, node, "wheel_tyre", "rubber_black", HEAT_WHEEL);
        for (int half = 0; half < 2; half++) /* two rims with the guide horns' gap between them */
            mesh_tube(b, outwards, half ? 0.04 : -0.19, half ? 0.18 : -0.05, road_wheel_radius_m, 0.30);
    }
    int node = add_wheel_node(b, "idler", side, 0, idler_x_m, idler_z_m, idler_radius_m);
    mesh_part(b, node, "idler", "paint_olive", HEAT_WHEEL);
    build_disc(b, outwards, idler_radius_m, 5);
    node = add_wheel_node(b, "sprocket", side, 0, sprocket_x_m, sprocket_z_m, sprocket_radius_m);
    mesh_part(b, node, "sprocket", "steel_worn", HEAT_WHEEL);
    build_disc(b, outwards, sprocket_radius_m - 0.03, 7);
    for (int i = 0; i < 14; i++) {
        const Place tooth = about_axle(outwards, 2 * pi_rad * i / 14);
        mesh_box(b, tooth, 0.10, -0.03, sprocket_radius_m - 0.06, 0.14, 0.03, sprocket_radius_m);
        mesh_box(b, tooth, -0.16, -0.03, sprocket_radius_m - 0.06, -0.12, 0.03, sprocket_radius_m);
    }
}

static void build_tracks(MeshBuilder *b)
{
    const double    wheel_z = -(road_wheel_radius_m + band_m + cleat_m + tread_m);
    const BeltWheel wheel[4] = {
        {first_wheel_x_m, wheel_z, road_wheel_radius_m},
        {idler_x_m, idler_z_m, idler_radius_m},
        {sprocket_x_m, sprocket_z_m, sprocket_radius_m},
        {first_wheel_x_m - 5 * wheel_step_m, wheel_z, road_wheel_radius_m},
    };
    for (int side = -1; side <= 1; side += 2) {
        /* 96 links of 137 mm, as the real track */
        mesh_part(b, 0, side < 0 ? "track_left" : "track_right", "steel_worn", HEAT_TRACK);
        const Belt band = {
            band_m, track_half_gauge_m - 0.5 * track_width_m, track_half_gauge_m + 0.5 * track_width_m, 96, cleat_m,
            0.055};
        mesh_belt(b, mirrored(place_at(0, 0, 0), side), wheel, 4, &band);
    }
}

static void build_turret(MeshBuilder *b, int turret)
{
    /* low casting: ring skirt, bulge, rounded shoulder, nearly flat roof 0.78 m over the deck */
    static const double roof_m = 0.79;
    const Place         here = place_at(0, 0, 0);
    mesh_part(b, turret, "turret", "paint_olive", HEAT_TURRET);
    mesh_profile_begin(b, 0.0, 0);
    mesh_profile_line(b, 0.0, 1.08);
    mesh_profile_line(b, 0.06, 1.22);
    /* bulge of radius 0.28 from the undercut to the slope, then the shoulder of radius 0.9 */
    mesh_profile_arc(b, 0.20, 1.02, -1.75);
    mesh_profile_line(b, 0.63, 0.86);
    mesh_profile_arc(b, 0.53, 0.68, -0.80);
    mesh_profile_line(b, roof_m, 0.30);
    mesh_profile_line(b, roof_m, 0);
    /* 2.9 m long with the stretch forward, 2.5 m wide */
    mesh_lathe(b, place_scaled(place_axis(-0.02, 0, 0, 0, 0, -1), 1, 1, 1.14));
    /* thick cheeks either side of the gun */
    for (int side = -1; side <= 1; side += 2) {
        static const double inner[4][2] = {{0.55, -0.03}, {1.38, -0.08}, {1.26, -0.50}, {0.45, -0.72}};
        static const double outer[4][2] = {{0.40, -0.03}, {0.78, -0.08}, {0.70, -0.44}, {0.32, -0.66}};
        mesh_slab(b, mirrored(here, side), 4, inner, 0.24, outer, 1.00);
    }
    mesh_cylinder(b, place_axis(-0.10, -0.50, -0.72, 0, 0, -1), 0, 0.10, 0.33); /* gunner's hatch, left */
    mesh_box(b, here, 0.28, -0.78, -0.88, 0.58, -0.48, -0.62);                  /* gunner's sight, left */
    mesh_box(b, here, -1.62, 0.15, -0.50, -1.18, 0.95, -0.12);                  /* stowage bin, rear right */
    mesh_box(b, here, -1.58, -0.75, -0.48, -1.15, 0.10, -0.14);
    mesh_cylinder(b, place_axis(-1.45, -1.05, -0.38, 0.35, -0.25, 0), -0.2, 0.95, 0.10); /* snorkel, rear left */
    mesh_cylinder(b, place_axis(-0.85, -0.75, -0.55, 0, -0.05, -1), 0, 0.22, 0.035);     /* aerial base */

    /* smoke dischargers: seven on the left, five on the right, fanned forward */
    mesh_part(b, turret, "smoke_dischargers", "metal_dark", HEAT_PASSIVE);
    for (int i = 0; i < 12; i++) {
        const int    side = i < 7 ? -1 : 1, k = i < 7 ? i : i - 7;
        const double bearing = side * (0.55 + 0.13 * k);
        const double x = 1.12 * cos(bearing) + 0.10, y = 1.06 * sin(bearing);
        mesh_cylinder(b, place_axis(x, y, -0.40, cos(bearing), sin(bearing), -0.55), 0, 0.26, 0.042);
    }
    /* infrared searchlight on the right of the gun */
    mesh_part(b, turret, "searchlight", "metal_dark", HEAT_PASSIVE);
    mesh_cylinder(b, place_axis(1.16, 0.52, -0.66, 1, 0, 0), -0.20, 0.10, 0.21);
    mesh_box(b, here, 0.95, 0.46, -0.55, 1.15, 0.58, -0.28);
    mesh_part(b, turret, "searchlight_glass", "glass_window", HEAT_PASSIVE);
    mesh_cylinder(b, place_axis(1.16, 0.52, -0.66, 1, 0, 0), 0.09, 0.12, 0.18);
}

static void build_gun(MeshBuilder *b, int gun)
{
    const double length = muzzle_x_m - turret_x_m - trunnion_x_m;
    const Place  here = place_at(0, 0, 0);
    mesh_part(b, gun, "mantlet", "paint_olive", HEAT_TURRET);
    mesh_profile_begin(b, -0.35, 0);
    mesh_profile_line(b, -0.35, 0.26);
    mesh_profile_line(b, 0.25, 0.26);
    mesh_profile_line(b, 0.62, 0.13);
    mesh_profile_line(b, 0.62, 0);
    mesh_lathe(b, here);
    /* sleeve in steps, fume extractor past the middle, bore 125 mm open at the muzzle for half a metre */
    mesh_part(b, gun, "barrel", "paint_olive", HEAT_GUN);
    mesh_profile_begin(b, 0.30, 0);
    mesh_profile_line(b, 0.30, 0.115);
    mesh_profile_line(b, 2.35, 0.110);
    mesh_profile_line(b, 2.42, 0.145);
    mesh_profile_line(b, 3.15, 0.145);
    mesh_profile_line(b, 3.22, 0.102);
    mesh_profile_line(b, length - 0.12, 0.092);
    mesh_profile_line(b, length - 0.12, 0.10);
    mesh_profile_line(b, length, 0.10);
    mesh_profile_line(b, length, 0.0625);
    mesh_profile_line(b, length - 0.5, 0.0625);
    mesh_profile_line(b, length - 0.5, 0);
    mesh_lathe(b, here);
}

static void build_cupola(MeshBuilder *b, int cupola)
{
    const Place here = place_at(0, 0, 0);
    mesh_part(b, cupola, "cupola", "paint_olive", HEAT_TURRET);
    mesh_cone(b, place_axis(0, 0, 0, 0, 0, -1), 0, 0.37, 0.12, 0.33);
    mesh_cylinder(b, place_axis(-0.05, 0, -0.11, 0, 0, -1), 0, 0.05, 0.25);
    mesh_box(b, here, 0.18, -0.10, -0.22, 0.30, 0.10, -0.08);
    mesh_bar(b, (double[3]){0.02, 0.24, -0.08}, (double[3]){0.02, 0.24, -0.30}, 0.03);
}

static void build_machine_gun(MeshBuilder *b, int machine_gun)
{
    const Place here = place_at(0, 0, 0);
    mesh_part(b, machine_gun, "machine_gun", "metal_dark", HEAT_GUN);
    mesh_box(b, here, -0.45, -0.05, -0.07, 0.25, 0.05, 0.07);
    mesh_box(b, here, -0.05, 0.05, -0.10, 0.22, 0.22, 0.12); /* ammunition box, on its right */
    mesh_tube(b, place_at(0, 0, 0), 0.20, 1.10, 0.022, 0.0064);
}

Status parametric_tank(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("tank", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "hull", -1, 0, 0, 0);
    build_hull(b);
    build_tracks(b);
    for (int side = -1; side <= 1; side += 2) build_running_gear(b, side);

    const int turret = mesh_node(b, "turret", 0, turret_x_m, 0, deck_z_m);
    mesh_joint(b, turret, 0, 0, 1, 4096, 11, 1, -1);
    build_turret(b, turret);
    const int gun = mesh_node(b, "gun", turret, trunnion_x_m, 0, trunnion_z_m);
    mesh_joint(b, gun, 0, 1, 0, 4416, 13, -6 * rad_per_deg, 14 * rad_per_deg);
    build_gun(b, gun);
    const int cupola = mesh_node(b, "cupola", turret, -0.12, 0.48, -0.74);
    mesh_joint(b, cupola, 0, 0, 1, 5696, 11, 1, -1);
    build_cupola(b, cupola);
    const int machine_gun = mesh_node(b, "machine_gun", cupola, 0.02, 0.24, -0.36);
    mesh_joint(b, machine_gun, 0, 1, 0, 6016, 13, -5 * rad_per_deg, 75 * rad_per_deg);
    build_machine_gun(b, machine_gun);
    return mesh_builder_finish(out, b);
}
