/* entities/shapes/civil.c: civil vehicles and machines: van, box lorry, farm tractor, combine harvester, excavator,
 * generator on a trailer, tipping trailer, burnt-out car, freight container.
 *
 * Published length, width and height (manufacturers' data sheets): van: Mercedes Sprinter, standard wheelbase, high
 * roof 5.93 x 2.02 x 2.62 m; lorry: Mercedes Atego 1224 with a box of 7.3 m 9.15 x 2.55 x 3.65; tractor: Fendt 300
 * Vario 4.34 x 2.32 x 2.86; combine: Claas Tucano 8.7 x 7.5 (header) x 3.95; excavator: Caterpillar 320, boom
 * lowered 9.53 x 2.98 x 3.16; generator: Atlas Copco QAS 60 on its trailer 3.90 x 1.60 x 1.85; farm_trailer: tandem
 * tipper of 14 t 7.0 x 2.55 x 2.75; wreck: as the car of wheeled.c, on its rims; container: 6.06 x 2.44 x 2.59 (ISO
 * 668, 1CC). What those leave open is an estimate.
 */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

static void pair_of_wheels(MeshBuilder *b, int number, double x, double y, double radius, double half_width)
{
    for (int side = -1; side <= 1; side += 2) parts_wheel(b, "wheel", side, number, x, side * y, radius, half_width);
}

static void lamps(MeshBuilder *b, double x, double y0, double y1, double low_m, double high_m)
{
    mesh_part(b, 0, "lamps", "glass_window", HEAT_PASSIVE);
    parts_boxes(b, x - 0.04, x, y0, y1, low_m, high_m);
}

static void side_panes(MeshBuilder *b, double x0, double x1, double y, double low_m, double high_m)
{
    for (int side = -1; side <= 1; side += 2)
        parts_box(b, x0, x1, side < 0 ? -y - 0.008 : y - 0.02, side < 0 ? -y + 0.02 : y + 0.008, low_m, high_m);
}

static void build_van(MeshBuilder *b)
{
    static const double body[10][2] = {{-2.955, 0.42}, {-2.90, 0.30}, {2.75, 0.28}, {2.965, 0.42}, {2.965, 0.80},
                                       {2.80, 1.12},   {2.10, 1.32},  {1.45, 2.35}, {1.05, 2.60},  {-2.90, 2.62}};
    mesh_part(b, 0, "body", "paint_white_missile", HEAT_PASSIVE);
    parts_profile(b, 10, body, -0.98, 0.98);
    for (int side = -1; side <= 1; side += 2) /* rails and arches stand proud */
        for (int i = 0; i < 3; i++) {
            const double x[3][2] = {{-2.4, -1.35}, {-1.3, 1.3}, {1.35, 2.35}};
            parts_box(b, x[i][0], x[i][1], side < 0 ? -1.01 : 0.95, side < 0 ? -0.95 : 1.01, i == 1 ? 0.55 : 0.72,
                      i == 1 ? 0.66 : 0.84);
        }
    mesh_part(b, 0, "bonnet", "paint_white_missile", HEAT_ENGINE_DECK);
    static const double bonnet[4][2] = {{2.12, 1.30}, {2.80, 1.10}, {2.81, 1.13}, {2.13, 1.345}};
    parts_profile(b, 4, bonnet, -0.80, 0.80);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double screen[4][2] = {{2.06, 1.40}, {1.50, 2.28}, {1.52, 2.30}, {2.09, 1.41}};
    parts_profile(b, 4, screen, -0.86, 0.86);
    side_panes(b, 0.75, 1.45, 0.98, 1.42, 2.05);
    mesh_part(b, 0, "grille", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, 2.93, 2.975, -0.55, 0.55, 0.55, 0.85);
    parts_box(b, -2.965, -2.93, -0.9, 0.9, 0.34, 0.50);
    lamps(b, 2.97, 0.60, 0.88, 0.78, 0.96);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, -2.92, -0.55, 0.28, -1.4, -0.55, 0.30, 0.035);
    pair_of_wheels(b, 1, 1.85, 0.87, 0.345, 0.115);
    pair_of_wheels(b, 2, -1.82, 0.87, 0.345, 0.115);
}

static void build_lorry(MeshBuilder *b)
{
    mesh_part(b, 0, "box", "paint_white_missile", HEAT_PASSIVE);
    parts_box(b, -4.575, 2.72, -1.275, 1.275, 1.05, 3.65);
    mesh_part(b, 0, "frame", "metal_dark", HEAT_PASSIVE);
    parts_box(b, -4.4, 4.2, -0.42, 0.42, 0.72, 1.06);
    parts_box(b, -4.56, -4.40, -1.2, 1.2, 0.42, 0.58);
    parts_boxes(b, -2.2, 1.4, 0.95, 1.2, 0.45, 0.95);
    mesh_part(b, 0, "cab", "paint_white_missile", HEAT_CABIN);
    static const double cab[7][2] = {{2.86, 0.95}, {4.45, 0.42}, {4.575, 0.60}, {4.575, 1.45},
                                     {4.42, 2.52}, {4.10, 2.72}, {2.86, 2.72}};
    parts_profile(b, 7, cab, -1.14, 1.14);
    static const double spoiler[3][2] = {{2.88, 2.70}, {4.0, 2.72}, {2.95, 3.50}};
    parts_profile(b, 3, spoiler, -0.95, 0.95);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double screen[4][2] = {{4.565, 1.52}, {4.44, 2.44}, {4.46, 2.45}, {4.585, 1.53}};
    parts_profile(b, 4, screen, -1.02, 1.02);
    side_panes(b, 3.45, 4.30, 1.14, 1.60, 2.40);
    mesh_part(b, 0, "grille", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, 4.55, 4.585, -0.75, 0.75, 0.62, 1.20);
    parts_box(b, 2.90, 3.9, -0.55, 0.55, 0.55, 0.98); /* the engine below the cab */
    lamps(b, 4.59, 0.85, 1.10, 0.62, 0.82);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_box(b, 1.55, 2.35, -1.20, -0.75, 0.45, 0.90); /* one silencer; on the other side is the tank */
    mesh_part(b, 0, "tank", "paint_silver", HEAT_PASSIVE);
    parts_box(b, 1.50, 2.40, 0.75, 1.20, 0.45, 0.95);
    pair_of_wheels(b, 1, 3.55, 1.04, 0.48, 0.15);
    pair_of_wheels(b, 2, -2.05, 0.97, 0.48, 0.26);
}

static void build_tractor(MeshBuilder *b)
{
    mesh_part(b, 0, "wings", "paint_machine_green", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        static const double wing[6][2] = {{-1.78, 0.95}, {-1.55, 1.62}, {-0.90, 1.86},
                                          {-0.25, 1.62}, {-0.35, 1.55}, {-0.90, 1.78}};
        parts_profile(b, 6, wing, side < 0 ? -1.12 : 0.62, side < 0 ? -0.62 : 1.12);
    }
    mesh_part(b, 0, "bonnet", "paint_machine_green", HEAT_ENGINE_DECK);
    static const double bonnet[7][2] = {{0.35, 0.95}, {1.95, 0.95}, {2.12, 1.10}, {2.16, 1.45},
                                        {2.02, 1.64}, {1.40, 1.74}, {0.35, 1.80}};
    parts_profile(b, 7, bonnet, -0.34, 0.34);
    mesh_part(b, 0, "frame", "metal_dark", HEAT_PASSIVE);
    parts_box(b, -1.5, 2.05, -0.26, 0.26, 0.55, 0.97);
    parts_bar(b, -1.0, -1.0, 0.85, -1.0, 1.0, 0.85, 0.14);
    parts_bar(b, 1.45, -0.85, 0.58, 1.45, 0.85, 0.58, 0.09);
    for (int side = -1; side <= 1; side += 2) parts_bar(b, -1.3, side * 0.35, 0.62, -2.17, side * 0.42, 0.50, 0.05);
    mesh_part(b, 0, "cab", "metal_dark", HEAT_CABIN);
    parts_block(b, (Rectangle){-1.35, 0.38, -0.62, 0.62}, 0.95, (Rectangle){-1.40, 0.40, -0.72, 0.72}, 1.55);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    parts_block(b, (Rectangle){-1.40, 0.42, -0.74, 0.74}, 1.54, (Rectangle){-1.28, 0.22, -0.66, 0.66}, 2.66);
    mesh_part(b, 0, "roof", "paint_machine_green", HEAT_PASSIVE);
    parts_block(b, (Rectangle){-1.48, 0.38, -0.80, 0.80}, 2.64, (Rectangle){-1.35, 0.22, -0.70, 0.70}, 2.86);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, 0.62, 0.44, 1.30, 0.62, 0.44, 2.55, 0.06);
    mesh_part(b, 0, "guard", "metal_dark", HEAT_ENGINE_DECK); /* about what is hot within reach (ISO 26322-1) */
    parts_bar(b, 0.62, 0.44, 1.50, 0.62, 0.44, 2.10, 0.10);
    lamps(b, 2.165, 0.10, 0.28, 1.30, 1.45);
    pair_of_wheels(b, 1, 1.45, 0.88, 0.60, 0.20);
    pair_of_wheels(b, 2, -1.02, 0.90, 0.86, 0.26);
}

static void build_combine(MeshBuilder *b)
{
    mesh_part(b, 0, "body", "paint_machine_green", HEAT_PASSIVE);
    static const double body[8][2] = {{-3.35, 1.35}, {-3.0, 0.95}, {1.20, 0.80}, {1.55, 1.20},
                                      {1.55, 2.90},  {0.4, 3.15},  {-2.2, 3.15}, {-3.35, 2.60}};
    parts_profile(b, 8, body, -1.45, 1.45);
    parts_block(b, (Rectangle){-0.9, 1.3, -1.25, 1.25}, 3.12, (Rectangle){-1.1, 1.5, -1.5, 1.5}, 3.80); /* grain tank */
    mesh_part(b, 0, "engine", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, -2.5, -1.1, -1.2, 1.2, 3.14, 3.62);
    parts_box(b, -2.4, -1.2, 1.40, 1.48, 2.2, 3.05); /* radiator's screen */
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, -1.6, -0.8, 3.5, -1.6, -0.8, 3.95, 0.09);
    mesh_part(b, 0, "cab", "metal_dark", HEAT_CABIN);
    parts_box(b, 1.54, 2.95, -0.95, 0.95, 1.75, 2.05);
    parts_block(b, (Rectangle){1.50, 3.0, -1.05, 1.05}, 3.55, (Rectangle){1.6, 2.8, -0.95, 0.95}, 3.75);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    parts_block(b, (Rectangle){1.56, 2.80, -0.92, 0.92}, 2.04, (Rectangle){1.56, 2.97, -0.98, 0.98}, 3.56);
    mesh_part(b, 0, "header", "paint_machine_green", HEAT_PASSIVE);
    parts_box(b, 3.35, 3.55, -3.75, 3.75, 0.25, 1.15);
    static const double trough[4][2] = {{3.45, 0.08}, {4.35, 0.05}, {4.35, 0.12}, {3.50, 0.35}};
    parts_profile(b, 4, trough, -3.75, 3.75);
    static const double end[4][2] = {{3.4, 0.06}, {4.5, 0.05}, {4.45, 0.35}, {3.5, 1.15}};
    for (int side = -1; side <= 1; side += 2)
        parts_profile(b, 4, end, side < 0 ? -3.75 : 3.69, side < 0 ? -3.69 : 3.75);
    static const double feeder[4][2] = {{1.3, 1.15}, {3.45, 0.35}, {3.45, 0.95}, {1.5, 1.80}};
    parts_profile(b, 4, feeder, -0.70, 0.70);
    mesh_part(b, 0, "reel", "metal_dark", HEAT_PASSIVE);
    for (int i = 0; i < 6; i++) {
        const double turn = i * pi_rad / 3, x = 4.15 + 0.50 * cos(turn), h = 1.0 + 0.50 * sin(turn);
        parts_bar(b, x, -3.6, h, x, 3.6, h, 0.03);
        for (int side = -1; side <= 1; side += 2) parts_bar(b, 4.15, side * 3.55, 1.0, x, side * 3.55, h, 0.025);
    }
    mesh_part(b, 0, "auger", "paint_machine_green", HEAT_PASSIVE);
    parts_bar(b, 0.9, -1.55, 3.3, -4.15, -1.55, 3.15, 0.17);
    lamps(b, 2.99, 0.5, 0.9, 3.40, 3.52);
    pair_of_wheels(b, 1, 1.0, 1.28, 0.90, 0.34);
    pair_of_wheels(b, 2, -2.75, 1.15, 0.62, 0.22);
}

static void build_excavator(MeshBuilder *b)
{
    mesh_part(b, 0, "counterweight", "paint_machine_yellow", HEAT_PASSIVE);
    static const double weight[5][2] = {{-2.83, 1.15}, {-2.2, 1.10}, {-2.2, 2.05}, {-2.55, 2.10}, {-2.83, 1.85}};
    parts_profile(b, 5, weight, -1.30, 1.30);
    parts_boxes(b, -1.0, 1.35, 0.55, 1.32, 1.05, 1.60);
    mesh_part(b, 0, "engine_deck", "paint_machine_yellow", HEAT_ENGINE_DECK);
    parts_box(b, -2.22, -0.55, -1.30, 1.30, 1.05, 2.12);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, -1.7, 0.75, 2.05, -1.7, 0.75, 2.62, 0.07); /* its silencer is below the hood */
    mesh_part(b, 0, "cab", "metal_dark", HEAT_CABIN);
    static const double cab[5][2] = {{-0.25, 1.60}, {1.42, 1.60}, {1.50, 1.95}, {1.15, 2.05}, {-0.25, 2.05}};
    parts_profile(b, 5, cab, -1.28, -0.40);
    parts_box(b, -0.28, 1.20, -1.30, -0.38, 3.02, 3.16);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double pane[4][2] = {{-0.22, 2.04}, {1.48, 1.98}, {1.15, 3.04}, {-0.22, 3.04}};
    parts_profile(b, 4, pane, -1.27, -0.41);
    mesh_part(b, 0, "boom", "paint_machine_yellow", HEAT_PASSIVE);
    static const double boom[8][2] = {{0.55, 1.45}, {0.95, 1.35}, {2.2, 2.45}, {3.3, 2.75},
                                      {5.75, 2.25}, {5.85, 2.45}, {3.3, 3.10}, {1.9, 2.85}};
    parts_profile(b, 8, boom, -0.22, 0.22);
    static const double stick[6][2] = {{6.05, 2.75}, {5.45, 2.20}, {5.45, 1.90},
                                       {5.85, 1.95}, {6.35, 0.55}, {6.10, 2.55}};
    parts_profile(b, 6, stick, -0.16, 0.16);
    mesh_part(b, 0, "bucket", "steel_worn", HEAT_PASSIVE);
    static const double bucket[6][2] = {{6.45, 0.70}, {6.05, 0.85}, {5.55, 0.62},
                                        {5.40, 0.25}, {5.60, 0.02}, {6.15, 0.05}};
    parts_profile(b, 6, bucket, -0.60, 0.60);
    mesh_part(b, 0, "cylinders", "steel_worn", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) parts_bar(b, 1.05, side * 0.32, 1.35, 2.8, side * 0.28, 2.72, 0.07);
    parts_bar(b, 3.2, 0, 3.12, 5.95, 0, 2.72, 0.07);
    mesh_part(b, 0, "undercarriage", "metal_dark", HEAT_PASSIVE);
    parts_box(b, -1.0, 1.0, -0.95, 0.95, 0.45, 0.88);
    mesh_cylinder(b, place_axis(0, 0, -0.85, 0, 0, -1), 0, 0.22, 0.62);
    mesh_part(b, 0, "tracks", "metal_dark", HEAT_TRACK);
    const BeltWheel ends[2] = {{1.70, -0.46, 0.37}, {-1.70, -0.46, 0.37}};
    for (int side = -1; side <= 1; side += 2)
        mesh_belt(b, parts_side(side), ends, 2, &(Belt){0.05, 0.89, 1.49, 44, 0.03, 0.05});
    for (int side = -1; side <= 1; side += 2)
        for (int i = -3; i <= 3; i++) {
            const double x = 0.46 * i;
            parts_bar(b, x, side * 0.95, 0.28, x, side * 1.42, 0.28, 0.16);
        }
}

static void build_generator(MeshBuilder *b)
{
    mesh_part(b, 0, "cover", "paint_machine_yellow", HEAT_PASSIVE);
    parts_box(b, -1.45, 0.35, -0.62, 0.62, 0.55, 1.72);
    parts_boxes(b, -1.30, 0.20, 0.61, 0.635, 0.75, 1.45);
    mesh_part(b, 0, "engine_cover", "paint_machine_yellow", HEAT_ENGINE_DECK);
    parts_box(b, 0.34, 1.25, -0.62, 0.62, 0.55, 1.72);
    mesh_part(b, 0, "radiator", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, 1.24, 1.29, -0.52, 0.52, 0.65, 1.55);
    for (int i = 0; i < 5; i++) parts_boxes(b, 0.45 + 0.15 * i, 0.53 + 0.15 * i, 0.61, 0.63, 0.9, 1.4);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_bar(b, 0.75, 0.25, 1.65, 0.75, 0.25, 1.85, 0.055);
    for (int i = 0; i < 4; i++)
        parts_box(b, 0.45 + 0.14 * i, 0.54 + 0.14 * i, -0.40, 0.05, 1.70, 1.735); /* above the silencer */
    mesh_part(b, 0, "chassis", "metal_dark", HEAT_PASSIVE);
    parts_box(b, -1.50, 1.35, -0.50, 0.50, 0.42, 0.56);
    for (int side = -1; side <= 1; side += 2) parts_bar(b, 1.2, side * 0.42, 0.48, 2.35, side * 0.03, 0.50, 0.04);
    parts_bar(b, 1.85, 0, 0.08, 1.85, 0, 0.60, 0.035);
    parts_box(b, 1.75, 1.95, -0.08, 0.08, 0, 0.08);
    parts_boxes(b, -0.55, 0.55, 0.58, 0.80, 0.68, 0.72);
    pair_of_wheels(b, 1, 0, 0.70, 0.33, 0.09);
}

static void build_farm_trailer(MeshBuilder *b)
{
    mesh_part(b, 0, "body", "paint_machine_green", HEAT_PASSIVE);
    parts_box(b, -2.95, 2.15, -1.20, 1.20, 1.05, 1.15);
    parts_boxes(b, -2.95, 2.15, 1.16, 1.25, 1.14, 2.75);
    parts_box(b, -2.95, -2.86, -1.18, 1.18, 1.14, 2.75);
    parts_box(b, 2.06, 2.15, -1.18, 1.18, 1.14, 2.75);
    for (int i = 0; i < 6; i++) parts_boxes(b, -2.85 + i, -2.75 + i, 1.24, 1.275, 1.10, 2.74);
    mesh_part(b, 0, "load", "soil_loam_brown", HEAT_PASSIVE);
    parts_block(b, (Rectangle){-2.86, 2.06, -1.16, 1.16}, 1.15, (Rectangle){-1.6, 0.9, -0.35, 0.35}, 2.60);
    mesh_part(b, 0, "frame", "metal_dark", HEAT_PASSIVE);
    parts_box(b, -2.8, 2.2, -0.45, 0.45, 0.80, 1.06);
    for (int side = -1; side <= 1; side += 2) parts_bar(b, 2.0, side * 0.42, 0.90, 4.0, side * 0.05, 0.60, 0.07);
    parts_bar(b, 3.0, 0, 0.06, 3.0, 0, 0.75, 0.05);
    parts_box(b, 2.88, 3.12, -0.12, 0.12, 0, 0.07);
    pair_of_wheels(b, 1, -0.15, 1.0, 0.52, 0.20);
    pair_of_wheels(b, 2, -1.45, 1.0, 0.52, 0.20);
}

/* Burnt out: no glass, no tyres, sunk on its rims, bonnet and boot buckled. */
static void build_wreck(MeshBuilder *b)
{
    static const double low[10][2] = {{-2.30, 0.22}, {-2.25, 0.10}, {2.20, 0.08}, {2.30, 0.20}, {2.30, 0.46},
                                      {2.05, 0.62},  {1.10, 0.74},  {0.9, 0.66},  {-1.6, 0.70}, {-2.28, 0.78}};
    mesh_part(b, 0, "body", "rust", HEAT_PASSIVE);
    parts_profile(b, 10, low, -0.86, 0.86);
    static const double bonnet[4][2] = {{1.0, 0.72}, {1.65, 1.02}, {1.68, 1.05}, {1.02, 0.77}};
    parts_profile(b, 4, bonnet, -0.70, 0.66);
    static const double boot[4][2] = {{-2.28, 0.78}, {-1.75, 0.88}, {-1.74, 0.91}, {-2.27, 0.82}};
    parts_profile(b, 4, boot, -0.68, 0.70);
    mesh_part(b, 0, "pillars", "rust", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        parts_bar(b, 1.05, side * 0.76, 0.70, 0.32, side * 0.58, 1.22, 0.035);
        parts_bar(b, -0.35, side * 0.80, 0.70, -0.35, side * 0.60, 1.22, 0.035);
        parts_bar(b, -1.70, side * 0.74, 0.74, -1.05, side * 0.58, 1.20, 0.035);
    }
    static const double roof[5][2] = {{0.34, 1.20}, {-0.35, 1.13}, {-1.07, 1.18}, {-1.06, 1.21}, {0.33, 1.24}};
    parts_profile(b, 5, roof, -0.60, 0.60);
    mesh_part(b, 0, "inside", "burnt", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        parts_block(b, (Rectangle){-0.35, 0.15, side * 0.42 - 0.22, side * 0.42 + 0.22}, 0.64,
                    (Rectangle){-0.40, -0.28, side * 0.42 - 0.20, side * 0.42 + 0.20}, 1.05);
    parts_box(b, 1.15, 2.0, -0.45, 0.45, 0.55, 0.82);
    mesh_part(b, 0, "rims", "burnt", HEAT_PASSIVE);
    for (int i = 0; i < 4; i++) {
        const double x = i < 2 ? 1.35 : -1.35, y = i % 2 ? 0.80 : -0.80;
        parts_bar(b, x, y - 0.09, 0.205, x, y + 0.09, 0.205, 0.20);
    }
}

/* Ribbed walls between posts, doors with their bars at the rear; hollow, which no ray sees. */
static void build_container(MeshBuilder *b)
{
    mesh_part(b, 0, "walls", "paint_blue", HEAT_PASSIVE);
    parts_box(b, -2.99, 3.00, -1.18, 1.18, 0.15, 2.55);
    for (int i = 0; i < 20; i++) {
        const double x = -2.80 + 0.285 * i;
        parts_boxes(b, x, x + 0.14, 1.17, 1.21, 0.20, 2.48);
    }
    mesh_part(b, 0, "frame", "paint_blue", HEAT_PASSIVE);
    for (int end = -1; end <= 1; end += 2)
        parts_boxes(b, end < 0 ? -3.03 : 2.88, end < 0 ? -2.88 : 3.03, 1.07, 1.22, 0, 2.59);
    parts_boxes(b, -2.90, 2.90, 1.12, 1.22, 0.03, 0.19);
    mesh_part(b, 0, "doors", "metal_dark", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 2; i++)
            parts_bar(b, -3.01, side * (0.28 + 0.5 * i), 0.20, -3.01, side * (0.28 + 0.5 * i), 2.45, 0.018);
}

Status parametric_civil(Model *out, const char *name, double sag_m)
{
    static const ShapeKind kinds[] = {
        {"van", build_van, 0},
        {"lorry", build_lorry, 0},
        {"tractor", build_tractor, 0},
        {"combine", build_combine, 0},
        {"excavator", build_excavator, 0},
        {"generator", build_generator, 0},
        {"farm_trailer", build_farm_trailer, 0},
        {"wreck", build_wreck, 0},
        {"container", build_container, 0},
    };
    return parts_build(out, kinds, name, "chassis", sag_m);
}
