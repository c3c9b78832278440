/* entities/shapes/wheeled.c: wheeled vehicles of simple lines: car, jeep, bus, motorcycle, eight-wheeled armoured
 * carrier, heavy truck, tractor with its semi-trailer, cargo trailer, shelter on a truck, rocket launcher on a truck,
 * robot.
 *
 * Published length, width and height (manufacturers' data; US Army TM 9-2320-280, TM 9-2320-279, FM 3-21 figures;
 * Jane's Military Vehicles and Logistics, Armour and Artillery; the same in the open encyclopedias): car: Toyota
 * Corolla (E170) 4.64 x 1.78 x 1.46 m; jeep: HMMWV M998 4.57 x 2.16 x 1.83; bus: Mercedes Citaro 11.95 x 2.55 x 3.12;
 * motorcycle: Kawasaki KLR 650 2.20 x 0.94 x 1.35 (its US Army M1030 form); carrier_wheeled: BTR-80 7.65 x 2.90 x 2.46;
 * truck_heavy: HEMTT M977 10.17 x 2.44 x 2.57 (cab); semi_trailer: 16.5 x 2.55 x 4.00 (the largest that Directive
 * 96/53/EC allows); trailer: M1082 class 5.4 x 2.43 x 2.3; shelter: M35 with S-280 class shelter 6.7 x 2.4 x 3.3;
 * rocket_truck: BM-21 on Ural-375 7.35 x 2.40 x 3.09; robot: TALON class 0.86 x 0.57 x 0.43 (stowed). Everything that
 * those figures leave open is an estimate.
 *
 * Articulated: wheels roll; carrier_wheeled turret (4096 azimuth) and gun (4416 elevation); rocket_truck table (4096
 * azimuth) and tubes (4736 elevation). */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

static void lamps(MeshBuilder *b, double x, double y0, double y1, double low_m, double high_m)
{
    mesh_part(b, 0, "lamps", "glass_window", HEAT_PASSIVE);
    parts_boxes(b, x - 0.04, x, y0, y1, low_m, high_m);
}

static void axles(MeshBuilder *b, int count, const double *x, double y, double radius, double half_width)
{
    for (int i = 0; i < count; i++)
        for (int side = -1; side <= 1; side += 2)
            parts_wheel(b, "wheel", side, i + 1, x[i], side * y, radius, half_width);
}

/* ---- light ------------------------------------------------------------------------------------------- */

static void build_car(MeshBuilder *b)
{
    static const double low[12][2] = {{-2.32, 0.35}, {-2.28, 0.24}, {2.20, 0.20}, {2.32, 0.30},
                                      {2.32, 0.60},  {2.22, 0.72},  {1.15, 0.93}, {-1.62, 0.97},
                                      {-2.20, 0.98}, {-2.29, 0.90}, {-2.32, 0.6}, {-2.33, 0.5}};
    /* glasshouse: narrower on top */
    static const double waist[4][2] = {{1.20, -0.92}, {0.35, -1.44}, {-1.05, -1.44}, {-1.75, -0.95}};
    mesh_part(b, 0, "body", "paint_white_missile", HEAT_PASSIVE);
    parts_profile(b, 12, low, -0.87, 0.87);
    for (int side = -1; side <= 1; side += 2) { /* arches stand a little proud; the mirrors make no width */
        parts_box(b, 0.98, 1.72, side < 0 ? -0.888 : 0.80, side < 0 ? -0.80 : 0.888, 0.62, 0.72);
        parts_box(b, -1.70, -0.96, side < 0 ? -0.888 : 0.80, side < 0 ? -0.80 : 0.888, 0.62, 0.72);
    }
    parts_block(b, (Rectangle){-1.06, 0.36, -0.60, 0.60}, 1.425, (Rectangle){-0.98, 0.28, -0.56, 0.56}, 1.46);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    mesh_slab(b, parts_side(1), 4, waist, -0.001,
              (double[4][2]){{1.05, -0.93}, {0.30, -1.43}, {-1.00, -1.43}, {-1.62, -0.95}}, 0.70);
    mesh_slab(b, parts_side(-1), 4, waist, -0.001,
              (double[4][2]){{1.05, -0.93}, {0.30, -1.43}, {-1.00, -1.43}, {-1.62, -0.95}}, 0.70);
    mesh_part(b, 0, "bonnet", "paint_white_missile", HEAT_ENGINE_DECK);
    static const double bonnet[4][2] = {{1.22, 0.90}, {2.16, 0.71}, {2.17, 0.735}, {1.23, 0.945}};
    parts_profile(b, 4, bonnet, -0.72, 0.72);
    mesh_part(b, 0, "grille", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, 2.28, 2.325, -0.55, 0.55, 0.33, 0.52);
    lamps(b, 2.325, 0.58, 0.82, 0.55, 0.66);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, -2.31, 0.5, 0.19, -1.6, 0.5, 0.19, 0.03); /* below the floor */
    axles(b, 2, (const double[]){1.35, -1.35}, 0.785, 0.315, 0.10);
}

static void build_jeep(MeshBuilder *b)
{
    /* a wide, flat bonnet, an upright screen, a square hard top that slants at the rear */
    static const double hull[8][2] = {{-2.27, 0.62}, {-1.9, 0.46}, {1.75, 0.46}, {2.25, 0.62},
                                      {2.25, 0.98},  {2.15, 1.06}, {0.70, 1.16}, {-2.27, 1.16}};
    mesh_part(b, 0, "body", "paint_olive", HEAT_PASSIVE);
    parts_profile(b, 8, hull, -0.80, 0.80);
    parts_boxes(b, 0.78, 2.18, 0.79, 1.07, 0.86, 1.06); /* wings over the wheels */
    parts_boxes(b, -2.26, -0.88, 0.79, 1.08, 0.90, 1.16);
    parts_boxes(b, -0.90, 0.78, 0.79, 1.00, 0.50, 0.95);
    parts_box(b, 2.24, 2.285, -0.95, 0.95, 0.52, 0.70);
    parts_box(b, -2.285, -2.26, -0.90, 0.90, 0.52, 0.66);
    mesh_part(b, 0, "cabin", "paint_olive", HEAT_CABIN);
    static const double top[5][2] = {{0.62, 1.15}, {0.42, 1.78}, {-1.05, 1.83}, {-1.98, 1.22}, {-1.98, 1.15}};
    parts_profile(b, 5, top, -0.92, 0.92);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double screen[4][2] = {{0.60, 1.25}, {0.46, 1.70}, {0.49, 1.71}, {0.63, 1.26}};
    for (int side = -1; side <= 1; side += 2) {
        parts_profile(b, 4, screen, side < 0 ? -0.86 : 0.06, side < 0 ? -0.06 : 0.86);
        for (int door = 0; door < 2; door++)
            parts_box(b, -0.98 + 0.70 * door, -0.40 + 0.70 * door, side < 0 ? -0.935 : 0.915, side < 0 ? -0.915 : 0.935,
                      1.26, 1.66);
    }
    mesh_part(b, 0, "bonnet", "paint_olive", HEAT_ENGINE_DECK);
    static const double bonnet[4][2] = {{0.72, 1.10}, {2.12, 1.02}, {2.12, 1.07}, {0.72, 1.19}};
    parts_profile(b, 4, bonnet, -0.74, 0.74);
    mesh_part(b, 0, "grille", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, 2.23, 2.265, -0.55, 0.55, 0.74, 0.96);
    lamps(b, 2.275, 0.60, 0.78, 0.78, 0.94);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, -1.95, 0.85, 0.42, -1.2, 0.75, 0.42, 0.045);
    axles(b, 2, (const double[]){1.65, -1.65}, 0.91, 0.47, 0.155);
}

static void build_motorcycle(MeshBuilder *b)
{
    mesh_part(b, 0, "frame", "paint_olive", HEAT_PASSIVE);
    static const double tank[6][2] = {{0.30, 0.70},  {0.34, 0.86},  {0.20, 1.00},
                                      {-0.10, 0.98}, {-0.28, 0.86}, {-0.26, 0.72}};
    static const double seat[5][2] = {{-0.18, 0.78}, {-0.18, 0.90}, {-0.55, 0.86}, {-0.98, 0.92}, {-0.98, 0.84}};
    parts_profile(b, 6, tank, -0.17, 0.17);
    mesh_part(b, 0, "seat", "rubber_black", HEAT_PASSIVE);
    parts_profile(b, 5, seat, -0.13, 0.13);
    mesh_part(b, 0, "fork", "metal_dark", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        parts_bar(b, 0.755, side * 0.11, 0.36, 0.38, side * 0.10, 1.06, 0.028);
        parts_bar(b, -0.755, side * 0.10, 0.345, -0.15, side * 0.10, 0.42, 0.03);
        parts_bar(b, 0.36, side * 0.08, 1.08, 0.20, side * 0.455, 1.13, 0.017);
        parts_bar(b, 0.24, side * 0.33, 1.12, 0.26, side * 0.40, 1.30, 0.010);
        parts_box(b, 0.24, 0.28, side < 0 ? -0.45 : 0.33, side < 0 ? -0.33 : 0.45, 1.25, 1.35);
    }
    static const double guard[4][2] = {{0.45, 0.80}, {0.90, 0.72}, {0.91, 0.75}, {0.46, 0.84}};
    parts_profile(b, 4, guard, -0.07, 0.07);
    mesh_part(b, 0, "lamp", "glass_window", HEAT_PASSIVE);
    parts_box(b, 0.42, 0.54, -0.11, 0.11, 0.90, 1.08);
    mesh_part(b, 0, "engine", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, -0.20, 0.22, -0.16, 0.16, 0.28, 0.70);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, 0.2, 0.12, 0.50, 0.1, 0.18, 0.35, 0.025);
    parts_bar(b, 0.1, 0.18, 0.35, -0.3, 0.20, 0.50, 0.025);
    parts_bar(b, -0.3, 0.20, 0.50, -0.85, 0.20, 0.72, 0.055);
    parts_wheel(b, "wheel", 0, 1, 0.755, 0, 0.345, 0.05);
    parts_wheel(b, "wheel", 0, 2, -0.765, 0, 0.335, 0.065);
}

static void build_robot(MeshBuilder *b)
{
    mesh_part(b, 0, "chassis", "paint_sand", HEAT_HULL);
    parts_box(b, -0.36, 0.36, -0.17, 0.17, 0.06, 0.20);
    parts_box(b, -0.30, 0.05, -0.12, 0.12, 0.20, 0.26);
    mesh_part(b, 0, "arm", "metal_dark", HEAT_PASSIVE);
    parts_bar(b, -0.25, 0, 0.25, 0.20, 0, 0.33, 0.03);
    parts_bar(b, 0.20, 0, 0.33, 0.40, 0, 0.24, 0.025);
    parts_bar(b, -0.2, 0.08, 0.24, -0.2, 0.08, 0.36, 0.012);
    parts_box(b, -0.24, -0.15, 0.03, 0.13, 0.36, 0.43);
    mesh_part(b, 0, "tracks", "rubber_black", HEAT_TRACK);
    const BeltWheel ends[2] = {{0.285, -0.145, 0.115}, {-0.285, -0.145, 0.115}};
    for (int side = -1; side <= 1; side += 2)
        mesh_belt(b, parts_side(side), ends, 2, &(Belt){0.02, 0.175, 0.285, 24, 0.01, 0.02});
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 2; i++) {
            const int node =
                parts_wheel_node(b, 0, "wheel", side, i + 1, i ? -0.285 : 0.285, side * 0.23, -0.145, 0.115);
            mesh_part(b, node, "wheel", "metal_dark", HEAT_WHEEL);
            parts_disc(b, place_axis(0, 0, 0, 0, side, 0), 0.11, 0.04, 5);
        }
}

/* ---- large ------------------------------------------------------------------------------------------- */

static void build_bus(MeshBuilder *b)
{
    static const double side_view[8][2] = {{-5.97, 0.40}, {-5.90, 0.32}, {5.85, 0.30}, {5.97, 0.45},
                                           {5.975, 1.2},  {5.80, 2.95},  {5.60, 3.00}, {-5.975, 3.00}};
    mesh_part(b, 0, "body", "paint_white_missile", HEAT_CABIN);
    parts_profile(b, 8, side_view, -1.265, 1.265);
    mesh_part(b, 0, "roof_units", "paint_grey", HEAT_PASSIVE);
    parts_box(b, -4.9, -2.6, -0.8, 0.8, 2.99, 3.12);
    parts_box(b, 1.2, 3.2, -0.8, 0.8, 2.99, 3.10);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 7; i++) {
            const double x = -5.6 + 1.58 * i;
            parts_box(b, x, x + 1.45, side < 0 ? -1.275 : 1.255, side < 0 ? -1.255 : 1.275,
                      side > 0 && (i == 3 || i == 6) ? 0.45 : 1.25, 2.55);
        }
    static const double screen[4][2] = {{5.955, 1.25}, {5.83, 2.55}, {5.84, 2.56}, {5.975, 1.26}};
    parts_profile(b, 4, screen, -1.15, 1.15);
    parts_box(b, -5.974, -5.96, -1.05, 1.05, 1.5, 2.6);
    mesh_part(b, 0, "engine_cover", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, -5.975, -5.94, -1.0, 1.0, 0.5, 1.3);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, -5.95, -0.9, 0.24, -5.4, -0.9, 0.24, 0.06); /* below the floor */
    lamps(b, 5.975, 0.80, 1.15, 0.60, 0.80);
    axles(b, 2, (const double[]){3.25, -2.65}, 1.14, 0.48, 0.135);
}

static void build_carrier_wheeled(MeshBuilder *b)
{
    static const double hull[8][2] = {{-3.70, 1.15}, {-3.30, 0.62}, {2.60, 0.52}, {3.40, 0.95},
                                      {3.825, 1.32}, {2.70, 1.80},  {1.9, 1.98},  {-3.10, 1.98}};
    mesh_part(b, 0, "hull", "paint_olive", HEAT_HULL);
    /* boat-shaped: upright below the sponson, leaning in above it */
    static const double belt[6][2] = {{-3.825, 1.30}, {-3.40, 0.95}, {2.70, 0.98},
                                      {3.40, 1.06},   {3.60, 1.30},  {-3.7, 1.42}};
    parts_profile(b, 8, hull, -0.95, 0.95);
    parts_profile(b, 6, belt, -1.449, 1.449);
    parts_block(b, (Rectangle){-3.75, 3.30, -1.44, 1.44}, 1.35, (Rectangle){-3.2, 1.95, -1.02, 1.02}, 1.99);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double pane[4][2] = {{2.98, 1.56}, {2.62, 1.74}, {2.63, 1.77}, {2.99, 1.59}};
    for (int side = -1; side <= 1; side += 2)
        parts_profile(b, 4, pane, side < 0 ? -0.75 : 0.15, side < 0 ? -0.15 : 0.75);
    mesh_part(b, 0, "engine_deck", "paint_olive", HEAT_ENGINE_DECK);
    parts_box(b, -3.0, -1.5, -0.85, 0.85, 1.97, 2.06);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_boxes(b, -3.5, -2.6, 1.10, 1.30, 1.55, 1.78);
    lamps(b, 3.45, 0.95, 1.25, 1.30, 1.45);
    const int turret = mesh_node(b, "turret", 0, 0.85, 0, -1.98);
    mesh_joint(b, turret, 0, 0, 1, 4096, 11, 1, -1);
    mesh_part(b, turret, "turret", "paint_olive", HEAT_TURRET);
    mesh_cone(b, place_axis(0, 0, 0, 0, 0, -1), -0.02, 0.72, 0.46, 0.42);
    mesh_box(b, place_at(0, 0, 0), -0.15, -0.35, -0.48, 0.10, -0.20, -0.40);
    const int gun = mesh_node(b, "gun", turret, 0.50, 0, -0.22);
    mesh_joint(b, gun, 0, 1, 0, 4416, 13, -4 * rad_per_deg, 60 * rad_per_deg);
    mesh_part(b, gun, "gun", "steel_worn", HEAT_GUN);
    mesh_cylinder(b, place_at(0, 0, 0), -0.05, 0.55, 0.06);
    mesh_cylinder(b, place_at(0, 0, 0), 0.50, 1.55, 0.03);
    axles(b, 4, (const double[]){2.50, 1.15, -0.70, -2.20}, 1.205, 0.555, 0.17);
}

/* Cab over engine, long flat bed, four axles. */
static void build_truck_heavy(MeshBuilder *b)
{
    mesh_part(b, 0, "frame", "paint_olive", HEAT_PASSIVE);
    parts_box(b, -5.0, 4.9, -0.45, 0.45, 0.78, 1.08);
    parts_box(b, 4.85, 5.085, -1.20, 1.20, 0.70, 1.05);
    mesh_part(b, 0, "bed", "paint_olive", HEAT_PASSIVE);
    parts_box(b, -5.085, 0.9, -1.22, 1.22, 1.18, 1.42);
    parts_boxes(b, -5.08, 0.88, 1.17, 1.219, 1.40, 2.05);
    parts_box(b, -5.084, -5.02, -1.17, 1.17, 1.40, 2.05);
    parts_box(b, 0.82, 0.89, -1.17, 1.17, 1.40, 2.10);
    mesh_part(b, 0, "cab", "paint_olive", HEAT_CABIN);
    static const double cab[6][2] = {{2.75, 1.00}, {4.95, 0.95}, {5.05, 1.55},
                                     {4.72, 2.50}, {4.55, 2.57}, {2.75, 2.55}};
    parts_profile(b, 6, cab, -1.21, 1.21);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double screen[4][2] = {{5.03, 1.65}, {4.76, 2.42}, {4.78, 2.43}, {5.05, 1.66}};
    for (int side = -1; side <= 1; side += 2) {
        parts_profile(b, 4, screen, side < 0 ? -1.12 : 0.05, side < 0 ? -0.05 : 1.12);
        parts_box(b, 3.6, 4.55, side < 0 ? -1.219 : 1.20, side < 0 ? -1.20 : 1.219, 1.70, 2.40);
    }
    mesh_part(b, 0, "engine", "paint_olive", HEAT_ENGINE_DECK);
    parts_box(b, 1.10, 2.76, -0.95, 0.95, 1.0, 2.15);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, 1.35, 1.08, 1.2, 1.35, 1.08, 2.56, 0.085);
    lamps(b, 5.08, 0.75, 1.10, 1.08, 1.25);
    axles(b, 4, (const double[]){4.05, 2.52, -2.30, -3.83}, 1.00, 0.66, 0.20);
}

static void build_semi_trailer(MeshBuilder *b)
{
    mesh_part(b, 0, "frame", "metal_dark", HEAT_PASSIVE);
    parts_box(b, -8.0, 8.0, -0.45, 0.45, 0.75, 1.05);
    parts_box(b, 8.0, 8.25, -1.22, 1.22, 0.35, 0.85);
    mesh_part(b, 0, "box", "paint_white_missile", HEAT_PASSIVE);
    parts_box(b, -8.25, 5.30, -1.275, 1.275, 1.10, 4.00);
    parts_box(b, 2.0, 3.6, -1.0, 1.0, 1.0, 1.12);
    mesh_part(b, 0, "cab", "paint_white_missile", HEAT_CABIN);
    static const double cab[6][2] = {{5.95, 0.80}, {8.18, 0.70}, {8.24, 1.70},
                                     {8.00, 3.00}, {7.20, 3.70}, {5.95, 3.80}};
    parts_profile(b, 6, cab, -1.24, 1.24);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double screen[4][2] = {{8.22, 1.85}, {8.03, 2.85}, {8.05, 2.86}, {8.245, 1.86}};
    parts_profile(b, 4, screen, -1.12, 1.12);
    for (int side = -1; side <= 1; side += 2)
        parts_box(b, 6.9, 7.85, side < 0 ? -1.25 : 1.23, side < 0 ? -1.23 : 1.25, 1.75, 2.65);
    mesh_part(b, 0, "grille", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, 8.15, 8.245, -0.95, 0.95, 0.90, 1.50);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, 5.75, 1.0, 0.9, 5.75, 1.0, 3.4, 0.08);
    lamps(b, 8.25, 0.80, 1.15, 0.55, 0.80);
    axles(b, 5, (const double[]){6.95, 3.25, -4.1, -5.4, -6.7}, 1.07, 0.50, 0.18);
}

static void build_trailer(MeshBuilder *b)
{
    mesh_part(b, 0, "frame", "paint_olive", HEAT_PASSIVE);
    parts_box(b, -1.85, 1.80, -0.40, 0.40, 0.75, 0.95);
    for (int side = -1; side <= 1; side += 2) parts_bar(b, 1.7, side * 0.38, 0.82, 3.35, side * 0.03, 0.80, 0.05);
    parts_bar(b, 2.4, 0, 0.1, 2.4, 0, 0.80, 0.05); /* the leg it stands on */
    parts_box(b, 2.25, 2.55, -0.1, 0.1, 0, 0.05);
    mesh_part(b, 0, "bed", "paint_olive", HEAT_PASSIVE);
    parts_box(b, -1.99, 1.92, -1.215, 1.215, 0.95, 1.08);
    parts_boxes(b, -1.98, 1.91, 1.16, 1.214, 1.06, 1.55);
    parts_box(b, -1.985, -1.93, -1.16, 1.16, 1.06, 1.55);
    parts_box(b, 1.86, 1.915, -1.16, 1.16, 1.06, 1.55);
    mesh_part(b, 0, "canvas", "canvas", HEAT_PASSIVE);
    const Station cover[3] = {
        {-1.95, 1.19, -2.30, -1.50, 0.3}, {0, 1.18, -2.28, -1.50, 0.3}, {1.88, 1.19, -2.30, -1.50, 0.3}};
    mesh_loft(b, place_at(0, 0, 0), cover, 3);
    axles(b, 1, (const double[]){-0.15}, 1.02, 0.55, 0.17);
}

static void build_shelter(MeshBuilder *b)
{
    mesh_part(b, 0, "frame", "paint_olive", HEAT_PASSIVE);
    parts_box(b, -3.3, 3.2, -0.42, 0.42, 0.75, 1.02);
    parts_box(b, 3.15, 3.35, -1.15, 1.15, 0.60, 0.88);
    mesh_part(b, 0, "shelter", "paint_olive", HEAT_CABIN);
    parts_box(b, -3.35, 0.85, -1.20, 1.20, 1.15, 3.15);
    parts_box(b, -2.9, -0.9, -0.6, 0.6, 3.14, 3.30);
    parts_box(b, 0.84, 1.05, -0.7, 0.7, 2.2, 2.9);
    mesh_part(b, 0, "cab", "paint_olive", HEAT_CABIN);
    static const double cab[5][2] = {{1.10, 1.00}, {2.35, 1.00}, {2.35, 1.65}, {2.15, 2.35}, {1.10, 2.40}};
    parts_profile(b, 5, cab, -1.05, 1.05);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double screen[4][2] = {{2.35, 1.72}, {2.19, 2.28}, {2.21, 2.29}, {2.37, 1.73}};
    parts_profile(b, 4, screen, -0.95, 0.95);
    for (int side = -1; side <= 1; side += 2)
        parts_box(b, 1.3, 2.1, side < 0 ? -1.06 : 1.04, side < 0 ? -1.04 : 1.06, 1.75, 2.25);
    mesh_part(b, 0, "bonnet", "paint_olive", HEAT_ENGINE_DECK);
    parts_box(b, 2.3, 3.25, -0.65, 0.65, 0.95, 1.60);
    mesh_part(b, 0, "wings", "paint_olive", HEAT_PASSIVE);
    parts_boxes(b, 2.0, 3.25, 0.60, 1.15, 1.12, 1.20);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, 0.98, 1.0, 0.9, 0.98, 1.0, 2.4, 0.06);
    lamps(b, 3.29, 0.70, 0.95, 0.95, 1.10);
    axles(b, 3, (const double[]){2.45, -1.20, -2.45}, 0.95, 0.52, 0.18);
}

static void build_rocket_truck(MeshBuilder *b)
{
    mesh_part(b, 0, "frame", "paint_olive", HEAT_PASSIVE);
    parts_box(b, -3.6, 3.5, -0.42, 0.42, 0.85, 1.10);
    parts_box(b, 3.45, 3.675, -1.15, 1.15, 0.70, 0.98);
    parts_box(b, -3.55, 0.35, -1.15, 1.15, 1.10, 1.30);
    mesh_part(b, 0, "cab", "paint_olive", HEAT_CABIN);
    static const double cab[5][2] = {{0.55, 1.05}, {2.00, 1.05}, {2.00, 1.80}, {1.70, 2.52}, {0.55, 2.55}};
    parts_profile(b, 5, cab, -1.10, 1.10);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double screen[4][2] = {{1.97, 1.88}, {1.73, 2.46}, {1.75, 2.47}, {2.00, 1.89}};
    parts_profile(b, 4, screen, -0.98, 0.98);
    for (int side = -1; side <= 1; side += 2)
        parts_box(b, 0.75, 1.60, side < 0 ? -1.11 : 1.09, side < 0 ? -1.09 : 1.11, 1.85, 2.40);
    mesh_part(b, 0, "bonnet", "paint_olive", HEAT_ENGINE_DECK);
    parts_box(b, 1.95, 3.50, -0.68, 0.68, 1.00, 1.80);
    mesh_part(b, 0, "wings", "paint_olive", HEAT_PASSIVE);
    parts_boxes(b, 1.9, 3.45, 0.62, 1.18, 1.36, 1.44);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, 0.42, 1.0, 0.9, 0.42, 1.0, 2.6, 0.06);
    lamps(b, 3.54, 0.70, 1.0, 1.10, 1.28);
    const int table = mesh_node(b, "table", 0, -1.9, 0, -1.30);
    mesh_joint(b, table, 0, 0, 1, 4096, 11, 1, -1);
    mesh_part(b, table, "table", "paint_olive", HEAT_PASSIVE);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), -0.02, 0.35, 0.55);
    mesh_box(b, place_at(0, 0, 0), -0.7, -0.7, -0.62, 0.3, 0.7, -0.34);
    const int tubes = mesh_node(b, "tubes", table, -0.5, 0, -0.72);
    mesh_joint(b, tubes, 0, 1, 0, 4736, 13, 0, 55 * rad_per_deg);
    mesh_part(b, tubes, "tubes", "paint_olive", HEAT_GUN);
    mesh_box(b, place_at(0, 0, 0), 0.2, -1.05, 0.02, 1.4, 1.05, 0.10);
    for (int row = 0; row < 4; row++)
        for (int i = 0; i < 10; i++)
            mesh_tube(b, place_at(0, -0.99 + 0.22 * i, -0.12 - 0.27 * row), -1.1, 1.9, 0.105, 0.062);
    axles(b, 3, (const double[]){2.55, -0.98, -2.38}, 1.0, 0.60, 0.18);
}

Status parametric_wheeled(Model *out, const char *name, double sag_m)
{
    static const ShapeKind kinds[] = {
        {"car", build_car, 0},
        {"jeep", build_jeep, 0},
        {"motorcycle", build_motorcycle, 0.002},
        {"robot", build_robot, 0.002},
        {"bus", build_bus, 0},
        {"carrier_wheeled", build_carrier_wheeled, 0},
        {"truck_heavy", build_truck_heavy, 0},
        {"semi_trailer", build_semi_trailer, 0},
        {"trailer", build_trailer, 0},
        {"shelter", build_shelter, 0},
        {"rocket_truck", build_rocket_truck, 0},
    };
    return parts_build(out, kinds, name, "chassis", sag_m);
}
