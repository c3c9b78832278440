/* entities/shapes/artillery.c: tracked and towed artillery, and tracked engines of work: rocket launcher with a
 * traversing box of tubes, howitzer in a large turret at the rear, bulldozer, cargo carrier, towed howitzer, mortar.
 *
 * Published length, width and height (US Army TM and FM figures; Jane's Armour and Artillery; the same in the open
 * encyclopedias): M270 MLRS 6.97 x 2.97 x 2.59 m (travelling); M109A6 9.68 (gun forward) x 3.15 x 3.24; Caterpillar D7G
 * with blade 5.15 x 3.80 x 3.30; M548 5.89 x 2.69 x 2.82 (with bows 2.71 over the cab); M198 in action 11.0 m
 * long, 2.90 high, tracks 2.8 apart; M120 mortar: tube 1.76 m, firing at 45 .. 85 degrees. Tracks, wheels and lines are
 * estimates.
 *
 * Articulated: launcher (4096 azimuth, 4736 elevation), turret (4096 azimuth) and gun (4416 elevation); gun of the
 * towed howitzer and tube of the mortar (4096 azimuth, 4416 elevation). Wheels roll. */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

static int turning(MeshBuilder *b, const char *name, int parent, double x, double h_from_parent, uint32_t dis_class)
{
    const int node = mesh_node(b, name, parent, x, 0, -h_from_parent);
    mesh_joint(b, node, 0, 0, 1, dis_class, 11, 1, -1);
    return node;
}

static int lifting(MeshBuilder *b, const char *name, int parent, double x, double h_from_parent, uint32_t dis_class,
                   double low_deg, double high_deg)
{
    const int node = mesh_node(b, name, parent, x, 0, -h_from_parent);
    mesh_joint(b, node, 0, 1, 0, dis_class, 13, low_deg * rad_per_deg, high_deg * rad_per_deg);
    return node;
}

static void tracks_and_wheels(MeshBuilder *b, const RunningGear *gear)
{
    parts_tracks(b, gear);
    for (int side = -1; side <= 1; side += 2) parts_track_wheels(b, gear, side);
}

static void build_rocket_launcher(MeshBuilder *b)
{
    static const RunningGear gear = {
        .half_gauge_m = 1.21,
        .track_width_m = 0.53,
        .band_m = 0.03,
        .cleat_m = 0.02,
        .cleat_length_m = 0.07,
        .links = 88,
        .road_wheels = 6,
        .first_x_m = 2.05,
        .step_m = 0.84,
        .road_radius_m = 0.305,
        .front_x_m = 2.85,
        .front_z_m = -0.62,
        .front_radius_m = 0.26,
        .rear_x_m = -2.85,
        .rear_z_m = -0.58,
        .rear_radius_m = 0.24,
        .front_drives = true,
    };
    static const double hull[6][2] = {{-3.40, 0.55}, {2.75, 0.45},   {3.45, 0.85},
                                      {3.45, 1.05},  {-3.485, 1.05}, {-3.485, 0.70}};
    mesh_part(b, 0, "hull", "paint_olive", HEAT_HULL);
    parts_profile(b, 6, hull, -0.92, 0.92);
    parts_boxes(b, -3.48, 3.30, 0.90, 1.485, 1.00, 1.12);
    mesh_part(b, 0, "cab", "paint_olive", HEAT_CABIN);
    static const double cab[6][2] = {{1.35, 1.00}, {3.35, 1.00}, {3.485, 1.25},
                                     {3.15, 2.35}, {2.95, 2.50}, {1.35, 2.58}};
    parts_profile(b, 6, cab, -1.40, 1.40);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double pane[4][2] = {{3.36, 1.62}, {3.19, 2.18}, {3.21, 2.19}, {3.38, 1.63}};
    for (int i = -1; i <= 1; i++) parts_profile(b, 4, pane, 0.88 * i - 0.38, 0.88 * i + 0.38);
    for (int side = -1; side <= 1; side += 2)
        parts_box(b, 2.1, 2.9, side < 0 ? -1.41 : 1.39, side < 0 ? -1.39 : 1.41, 1.75, 2.25);
    mesh_part(b, 0, "engine_deck", "paint_olive", HEAT_ENGINE_DECK);
    parts_box(b, 0.70, 1.34, -1.25, 1.25, 1.04, 1.75);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, 0.95, 1.05, 1.7, 0.95, 1.05, 2.15, 0.09);
    mesh_part(b, 0, "lamps", "glass_window", HEAT_PASSIVE);
    parts_boxes(b, 3.42, 3.484, 0.95, 1.20, 1.08, 1.22);
    tracks_and_wheels(b, &gear);
    const int base = turning(b, "launcher_base", 0, -2.0, 1.05, 4096);
    mesh_part(b, base, "turntable", "paint_olive", HEAT_TURRET);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), -0.03, 0.22, 0.95);
    mesh_box(b, place_at(0, 0, 0), -1.2, -0.9, -0.45, 0.8, 0.9, -0.18);
    const int box = lifting(b, "launcher", base, -1.05, 0.50, 4736, 0, 60);
    mesh_part(b, box, "pods", "paint_olive", HEAT_GUN);
    for (int side = -1; side <= 1; side += 2) mesh_box(b, parts_side(side), -0.40, 0.03, -1.03, 3.30, 1.30, 0.02);
    mesh_part(b, box, "tube_caps", "metal_dark", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 6; i++) {
            const double y = side * (0.35 + 0.62 * (i % 2)), z = -0.20 - 0.32 * (i / 2);
            mesh_cylinder(b, place_at(0, y, z), 3.27, 3.32, 0.14);
        }
}

static void build_howitzer(MeshBuilder *b)
{
    static const RunningGear gear = {
        .half_gauge_m = 1.38,
        .track_width_m = 0.38,
        .band_m = 0.03,
        .cleat_m = 0.02,
        .cleat_length_m = 0.07,
        .links = 80,
        .road_wheels = 7,
        .first_x_m = 2.55,
        .step_m = 0.66,
        .road_radius_m = 0.305,
        .front_x_m = 3.20,
        .front_z_m = -0.66,
        .front_radius_m = 0.27,
        .rear_x_m = -2.15,
        .rear_z_m = -0.55,
        .rear_radius_m = 0.24,
        .front_drives = true,
    };
    /* the hull is 6.19 m long, its rear at -2.58; the muzzle makes 9.68 m */
    static const double hull[7][2] = {{-2.50, 0.55}, {2.90, 0.46},  {3.61, 0.95}, {3.55, 1.10},
                                      {2.30, 1.85},  {-2.58, 1.85}, {-2.58, 0.75}};
    mesh_part(b, 0, "hull", "paint_olive", HEAT_HULL);
    parts_profile(b, 7, hull, -1.15, 1.15);
    static const double sponson[5][2] = {{-2.56, 1.02}, {3.30, 1.02}, {3.45, 1.13}, {2.28, 1.82}, {-2.56, 1.82}};
    parts_profile(b, 5, sponson, -1.575, 1.575);
    mesh_part(b, 0, "engine_deck", "paint_olive", HEAT_ENGINE_DECK);
    static const double deck[4][2] = {{2.40, 1.76}, {3.20, 1.27}, {3.22, 1.31}, {2.42, 1.82}};
    parts_profile(b, 4, deck, 0.05, 1.3);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_box(b, 1.75, 2.35, 1.05, 1.5, 1.80, 1.92);
    tracks_and_wheels(b, &gear);
    const int turret = turning(b, "turret", 0, -0.85, 1.85, 4096);
    mesh_part(b, turret, "turret", "paint_olive", HEAT_TURRET);
    static const double side_view[6][2] = {{-1.70, 0.02}, {1.25, 0.02}, {1.55, -0.30},
                                           {1.15, -1.05}, {0.4, -1.13}, {-1.73, -1.10}};
    mesh_prism(b, place_at(0, 0, 0), 6, side_view, -1.42, 1.42);
    mesh_cylinder(b, place_axis(0.1, 0.7, -1.10, 0, 0, -1), 0, 0.18, 0.40);
    mesh_box(b, place_at(0, 0, 0), -0.1, 0.55, -1.39, 0.35, 0.8, -1.27);
    const int gun = lifting(b, "gun", turret, 1.20, 0.48, 4416, -3, 75);
    mesh_part(b, gun, "gun", "paint_olive", HEAT_GUN);
    mesh_cylinder(b, place_at(0, 0, 0), -0.1, 0.75, 0.26);
    mesh_cone(b, place_at(0, 0, 0), 0.7, 0.135, 6.10, 0.105);
    mesh_cylinder(b, place_at(0, 0, 0), 6.00, 9.68 - 2.58 + 0.85 - 1.20, 0.17);
    mesh_box(b, place_at(0, 0, 0), 2.6, -0.16, -0.18, 2.95, 0.16, 0.18);
}

static void build_bulldozer(MeshBuilder *b)
{
    static const RunningGear gear = {
        .half_gauge_m = 0.99,
        .track_width_m = 0.56,
        .band_m = 0.05,
        .cleat_m = 0.05,
        .cleat_length_m = 0.04,
        .links = 44,
        .road_wheels = 6,
        .first_x_m = 1.05,
        .step_m = 0.42,
        .road_radius_m = 0.15,
        .front_x_m = 1.25,
        .front_z_m = -0.50,
        .front_radius_m = 0.38,
        .rear_x_m = -1.35,
        .rear_z_m = -0.50,
        .rear_radius_m = 0.38,
        .front_drives = false,
    };
    mesh_part(b, 0, "body", "paint_sand", HEAT_HULL);
    parts_box(b, -1.90, 1.55, -0.60, 0.60, 0.50, 1.05);
    parts_boxes(b, -1.75, 1.45, 0.68, 1.30, 1.06, 1.14);
    parts_box(b, -2.45, -1.88, -0.35, 0.35, 0.55, 1.25); /* ripper's mount */
    parts_boxes(b, -2.45, -2.30, 0.20, 0.32, 0.15, 1.30);
    mesh_part(b, 0, "cab", "paint_sand", HEAT_CABIN);
    parts_box(b, -1.75, -0.20, -0.80, 0.80, 1.04, 1.85);
    parts_box(b, -1.80, -0.10, -0.90, 0.90, 3.16, 3.30);
    for (int side = -1; side <= 1; side += 2) {
        parts_bar(b, -1.65, side * 0.75, 1.8, -1.65, side * 0.75, 3.2, 0.06);
        parts_bar(b, -0.28, side * 0.75, 1.8, -0.28, side * 0.75, 3.2, 0.06);
    }
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    parts_box(b, -1.66, -0.26, -0.74, 0.74, 1.86, 3.15);
    mesh_part(b, 0, "engine", "paint_sand", HEAT_ENGINE_DECK);
    parts_box(b, -0.12, 1.72, -0.48, 0.48, 1.04, 2.05);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, 0.85, 0.15, 2.0, 0.85, 0.15, 3.0, 0.06);
    mesh_part(b, 0, "blade", "steel_worn", HEAT_PASSIVE);
    static const double blade[6][2] = {{2.52, 0.06}, {2.70, 0.06}, {2.50, 0.45},
                                       {2.50, 0.85}, {2.68, 1.25}, {2.40, 1.10}};
    parts_profile(b, 6, blade, -1.90, 1.90);
    for (int side = -1; side <= 1; side += 2) parts_bar(b, 0.2, side * 1.38, 0.45, 2.48, side * 1.38, 0.30, 0.11);
    tracks_and_wheels(b, &gear);
}

static void build_carrier_cargo(MeshBuilder *b)
{
    static const RunningGear gear = {
        .half_gauge_m = 1.08,
        .track_width_m = 0.38,
        .band_m = 0.03,
        .cleat_m = 0.02,
        .cleat_length_m = 0.07,
        .links = 68,
        .road_wheels = 5,
        .first_x_m = 1.35,
        .step_m = 0.70,
        .road_radius_m = 0.305,
        .front_x_m = 2.20,
        .front_z_m = -0.70,
        .front_radius_m = 0.24,
        .rear_x_m = -2.25,
        .rear_z_m = -0.58,
        .rear_radius_m = 0.20,
        .front_drives = true,
    };
    static const double hull[6][2] = {{-2.80, 0.55}, {2.20, 0.45},  {2.93, 0.95},
                                      {2.93, 1.20},  {-2.94, 1.20}, {-2.94, 0.75}};
    mesh_part(b, 0, "hull", "paint_olive", HEAT_HULL);
    parts_profile(b, 6, hull, -0.87, 0.87);
    parts_boxes(b, -2.94, 2.70, 0.86, 1.34, 1.06, 1.21);
    mesh_part(b, 0, "cab", "paint_olive", HEAT_CABIN);
    static const double cab[5][2] = {{0.85, 1.18}, {2.90, 1.18}, {2.945, 1.60}, {2.35, 2.00}, {0.85, 2.00}};
    parts_profile(b, 5, cab, -1.25, 1.25);
    mesh_part(b, 0, "cab_cover", "canvas", HEAT_CABIN);
    static const double cover[4][2] = {{0.88, 1.99}, {2.20, 1.99}, {1.95, 2.66}, {0.88, 2.71}};
    parts_profile(b, 4, cover, -1.2, 1.2);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double pane[4][2] = {{2.185, 2.08}, {1.99, 2.58}, {2.01, 2.59}, {2.21, 2.09}};
    parts_profile(b, 4, pane, -1.1, 1.1);
    mesh_part(b, 0, "engine_deck", "paint_olive", HEAT_ENGINE_DECK);
    static const double deck[4][2] = {{2.38, 1.97}, {2.88, 1.64}, {2.90, 1.67}, {2.40, 2.01}};
    parts_profile(b, 4, deck, -0.8, 0.8);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, 0.7, 1.1, 1.2, 0.7, 1.1, 2.6, 0.06);
    mesh_part(b, 0, "bed", "paint_olive", HEAT_PASSIVE);
    parts_boxes(b, -2.93, 0.55, 1.22, 1.30, 1.19, 1.95);
    parts_box(b, -2.935, -2.86, -1.24, 1.24, 1.19, 1.95);
    mesh_part(b, 0, "canvas", "canvas", HEAT_PASSIVE);
    const Station tilt[3] = {
        {-2.90, 1.28, -2.82, -1.92, 0.3}, {-1.2, 1.26, -2.79, -1.92, 0.3}, {0.52, 1.28, -2.82, -1.92, 0.3}};
    mesh_loft(b, place_at(0, 0, 0), tilt, 3);
    tracks_and_wheels(b, &gear);
}

static void build_gun(MeshBuilder *b)
{
    /* in action: the trails spread behind, on spades; the muzzle far ahead */
    mesh_part(b, 0, "carriage", "paint_olive", HEAT_PASSIVE);
    parts_box(b, -0.30, 1.10, -0.45, 0.45, 0.55, 0.95);
    parts_bar(b, 0.75, -1.15, 0.55, 0.75, 1.15, 0.55, 0.09);
    mesh_cylinder(b, place_axis(0.75, 0, 0, 0, 0, -1), 0, 0.10, 0.60); /* firing base */
    parts_box(b, 0.60, 0.90, -0.15, 0.15, 0.09, 0.60);
    for (int side = -1; side <= 1; side += 2) {
        static const double end_y = 1.27;
        parts_bar(b, 0.2, side * 0.35, 0.72, -5.20, side * end_y, 0.22, 0.13);
        parts_box(b, -5.50, -5.05, side < 0 ? -end_y - 0.13 : end_y - 0.27, side < 0 ? -end_y + 0.27 : end_y + 0.13, 0,
                  0.50);
    }
    for (int side = -1; side <= 1; side += 2) parts_wheel(b, "wheel", side, 0, 0.75, side * 1.23, 0.55, 0.17);
    const int top = turning(b, "top_carriage", 0, 0.55, 0.95, 4096);
    mesh_part(b, top, "top_carriage", "paint_olive", HEAT_PASSIVE);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), -0.05, 0.18, 0.42);
    static const double cheek[5][2] = {{-0.55, -0.15}, {0.45, -0.15}, {0.20, -0.75}, {-0.10, -0.95}, {-0.45, -0.80}};
    for (int side = -1; side <= 1; side += 2) mesh_prism(b, parts_side(side), 5, cheek, 0.26, 0.36);
    for (int side = -1; side <= 1; side += 2) /* equilibrators, upright */
        mesh_bar(b, (double[3]){0.30, side * 0.44, -0.25}, (double[3]){0.55, side * 0.44, -1.95 + 0.05}, 0.09);
    const int gun = lifting(b, "gun", top, -0.15, 0.78, 4416, -5, 72);
    mesh_part(b, gun, "cradle", "paint_olive", HEAT_PASSIVE);
    mesh_box(b, place_at(0, 0, 0), -0.7, -0.20, 0.02, 2.6, 0.20, 0.24);
    mesh_cylinder(b, place_at(0, 0, -0.32), -0.1, 2.2, 0.11);
    mesh_part(b, gun, "gun", "steel_worn", HEAT_GUN);
    mesh_box(b, place_at(0, 0, 0), -1.25, -0.24, -0.26, -0.65, 0.24, 0.22);
    mesh_cone(b, place_at(0, 0, -0.06), -0.7, 0.16, 4.6, 0.10);
    mesh_cylinder(b, place_at(0, 0, -0.06), 4.55, 11.0 - 5.5 - 0.40, 0.16);
}

static void build_mortar(MeshBuilder *b)
{
    mesh_part(b, 0, "base_plate", "paint_olive", HEAT_PASSIVE);
    mesh_cone(b, place_axis(-0.50, 0, 0, 0, 0, -1), 0, 0.34, 0.10, 0.20);
    mesh_cylinder(b, place_axis(-0.50, 0, -0.09, 0, 0, -1), 0, 0.07, 0.10);
    mesh_part(b, 0, "bipod", "paint_olive", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        parts_bar(b, 0.24, side * 0.05, 1.08, 0.74, side * 0.38, 0.03, 0.025);
        parts_box(b, 0.69, 0.79, side < 0 ? -0.43 : 0.33, side < 0 ? -0.33 : 0.43, 0, 0.04);
    }
    parts_bar(b, 0.60, -0.29, 0.32, 0.60, 0.29, 0.32, 0.018);
    parts_box(b, 0.14, 0.30, -0.10, 0.10, 1.00, 1.16);
    /* its least elevation is what it rests at */
    const int turn = turning(b, "traverse", 0, -0.50, 0.12, 4096);
    const int tube = lifting(b, "tube", turn, 0, 0, 4416, 45, 85);
    mesh_part(b, tube, "tube", "steel_worn", HEAT_GUN);
    mesh_sphere(b, place_at(0.02, 0, 0), 0.07);
    mesh_cylinder(b, place_at(0, 0, 0), 0.03, 0.25, 0.085);
    mesh_tube(b, place_at(0, 0, 0), 0.20, 1.76, 0.074, 0.060);
}

Status parametric_artillery(Model *out, const char *name, double sag_m)
{
    static const ShapeKind kinds[] = {
        {"rocket_launcher", build_rocket_launcher, 0},
        {"howitzer", build_howitzer, 0},
        {"bulldozer", build_bulldozer, 0},
        {"carrier_cargo", build_carrier_cargo, 0},
        {"gun", build_gun, 0},
        {"mortar", build_mortar, 0},
    };
    return parts_build(out, kinds, name, "hull", sag_m);
}
