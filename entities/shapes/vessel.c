/* entities/shapes/vessel.c: vessels other than the frigate: boats, aircraft carrier, submarine, cargo ship, tanker.
 *
 * Published length over all, beam and draught (Jane's Fighting Ships; US Navy fact files; owners' data; the same in the
 * open encyclopedias): Nimitz class 332.8 m x 76.8 m (flight deck; hull 40.8 m) x 11.3 m; Los Angeles class submarine
 * 110.3 x 10.1 x 9.4; Mark VI patrol boat 26 x 6.2 x 1.5 (Cyclone class 54.6 x 7.6 x 2.3); rigid inflatable boat 11 m
 * NSW 10.95 x 3.20 x 0.91; cargo ship: Panamax container ship 294 x 32.2 x 12; tanker: Aframax 245 x 42 x 14. Heights
 * above water, superstructures and lines are estimates.
 *
 * The base is the waterline: z = 0 is the sea, and the hull reaches its draught below it. Superstructures are boxes and
 * the hull is a few sections of straight lines: good for a silhouette, not for lines. */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

/* One hull section: at x the half widths at keel, waterline and deck, and heights (the keel's negative). */
typedef struct Section {
    double x, keel_half, water_half, deck_half, keel_h, deck_h;
} Section;

/* Both halves of a hull between sections as one slab a bay: below the waterline `bottom`, above it `sides`. */
static void hull(MeshBuilder *b, int count, const Section *s, const char *bottom, const char *sides)
{
    for (int part = 0; part < 2; part++) {
        mesh_part(b, 0, part ? "sides" : "bottom", part ? sides : bottom, HEAT_HULL);
        for (int i = 0; i + 1 < count; i++) {
            /* slabs are drawn in (x, z) and run along y: shape x is to the right, shape y forward */
            double at[2][4][2];
            for (int k = 0; k < 2; k++) {
                const Section *c = s + i + k;
                const double   low = part ? 0 : c->keel_half, high = part ? c->deck_half : c->water_half;
                const double foot = part ? c->water_half : low, z0 = part ? 0 : -c->keel_h, z1 = part ? -c->deck_h : 0;
                const double outline[4][2] = {{foot, z0}, {high, z1}, {-high, z1}, {-foot, z0}};
                memcpy(at[k], outline, sizeof outline);
            }
            Place        place = place_at(0, 0, 0);
            const double m[9] = {0, 1, 0, 1, 0, 0, 0, 0, 1};
            memcpy(place.m, m, sizeof m);
            mesh_slab(b, place, 4, (const double(*)[2])at[0], s[i].x, (const double(*)[2])at[1], s[i + 1].x);
        }
    }
}

static int radar(MeshBuilder *b, double x, double y, double h, double half_width)
{
    const int node = mesh_node(b, "radar", 0, x, y, -h);
    mesh_joint(b, node, 0, 0, 1, 5376, 11, 1, -1);
    mesh_node_get(b, node)->spin_rps_moving = 24 * 2 * pi_rad / 60;
    mesh_part(b, node, "radar", "metal_dark", HEAT_PASSIVE);
    mesh_box(b, place_at(0, 0, 0), -0.07 * half_width, -half_width, -0.35 * half_width, 0.07 * half_width, half_width,
             0.02);
    return node;
}

static void build_boat(MeshBuilder *b)
{
    static const Section s[6] = {{-13, 1.2, 2.7, 2.9, -0.9, 1.9}, {-8, 1.2, 2.9, 3.05, -1.3, 2.0},
                                 {0, 0.8, 2.9, 3.1, -1.5, 2.2},   {6, 0.4, 2.3, 2.9, -1.4, 2.6},
                                 {10, 0.15, 1.2, 2.0, -0.9, 3.0}, {13, 0.03, 0.06, 0.12, -0.03, 3.4}};
    hull(b, 6, s, "paint_antifouling", "paint_ship_grey");
    mesh_part(b, 0, "superstructure", "paint_ship_grey", HEAT_CABIN);
    static const double house[5][2] = {{-4.5, 2.0}, {4.6, 2.0}, {3.2, 4.3}, {2.4, 4.6}, {-4.5, 4.4}};
    parts_profile(b, 5, house, -2.2, 2.2);
    static const double bridge[4][2] = {{-2.0, 4.3}, {2.2, 4.3}, {1.4, 6.2}, {-1.6, 6.2}};
    parts_profile(b, 4, bridge, -1.7, 1.7);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    static const double pane[4][2] = {{3.70, 3.5}, {3.30, 4.15}, {3.34, 4.17}, {3.75, 3.52}};
    parts_profile(b, 4, pane, -1.9, 1.9);
    static const double upper[4][2] = {{1.98, 5.0}, {1.55, 5.95}, {1.59, 5.97}, {2.02, 5.02}};
    parts_profile(b, 4, upper, -1.5, 1.5);
    mesh_part(b, 0, "mast", "paint_ship_grey", HEAT_PASSIVE);
    parts_bar(b, -1.4, 0, 6.1, -2.2, 0, 9.3, 0.12);
    parts_bar(b, -1.9, -1.1, 8.2, -1.9, 1.1, 8.2, 0.05);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_boxes(b, -13.1, -12.6, 1.2, 1.8, 0.3, 0.7);
    mesh_part(b, 0, "engine_deck", "paint_deck_grey", HEAT_ENGINE_DECK);
    parts_box(b, -10.5, -5.5, -1.6, 1.6, 1.95, 2.5);
    const int mount = mesh_node(b, "gun_mount", 0, 7.0, 0, -2.72);
    mesh_joint(b, mount, 0, 0, 1, 4096, 11, 1, -1);
    mesh_part(b, mount, "gun_mount", "paint_ship_grey", HEAT_TURRET);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), -0.3, 0.6, 0.45);
    const int gun = mesh_node(b, "gun", mount, 0.2, 0, -0.75);
    mesh_joint(b, gun, 0, 1, 0, 4416, 13, -10 * rad_per_deg, 70 * rad_per_deg);
    mesh_part(b, gun, "gun", "steel_worn", HEAT_GUN);
    mesh_box(b, place_at(0, 0, 0), -0.5, -0.3, -0.3, 0.4, 0.3, 0.2);
    mesh_cylinder(b, place_at(0, 0, 0), 0.3, 2.2, 0.05);
    radar(b, -1.7, 0, 7.2, 0.9);
}

static void build_rhib(MeshBuilder *b)
{
    static const Section s[5] = {{-5.2, 0.5, 1.2, 1.25, -0.35, 0.55},
                                 {-1, 0.4, 1.2, 1.3, -0.55, 0.6},
                                 {2.5, 0.25, 0.95, 1.2, -0.5, 0.7},
                                 {4.4, 0.08, 0.4, 0.75, -0.3, 0.85},
                                 {5.2, 0.02, 0.04, 0.15, -0.05, 0.95}};
    hull(b, 5, s, "paint_ship_grey", "paint_ship_grey");
    mesh_part(b, 0, "collar", "rubber_black", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        parts_limb(b, (double[3]){-5.15, side * 1.30, -0.60}, 0.28, (double[3]){2.2, side * 1.30, -0.66}, 0.30);
        parts_limb(b, (double[3]){2.2, side * 1.30, -0.66}, 0.30, (double[3]){5.22, side * 0.12, -0.98}, 0.25);
    }
    mesh_part(b, 0, "console", "paint_ship_grey", HEAT_CABIN);
    static const double console[4][2] = {{-0.5, 0.5}, {1.2, 0.5}, {0.6, 1.7}, {-0.3, 1.7}};
    parts_profile(b, 4, console, -0.55, 0.55);
    parts_box(b, -2.4, -1.0, -0.55, 0.55, 0.5, 1.1);
    mesh_part(b, 0, "arch", "paint_ship_grey", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) parts_bar(b, -3.4, side * 1.0, 0.6, -3.8, side * 0.9, 2.5, 0.06);
    parts_bar(b, -3.8, -0.95, 2.5, -3.8, 0.95, 2.5, 0.06);
    parts_bar(b, -3.8, 0, 2.5, -3.9, 0, 3.0, 0.02);
    mesh_part(b, 0, "engine", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, -5.475, -4.4, -0.6, 0.6, 0.4, 1.15);
}

static void build_carrier_ship(MeshBuilder *b)
{
    static const Section s[6] = {{-158, 6, 17, 19, -4, 14},       {-120, 14, 20.2, 20.4, -11.3, 14},
                                 {60, 15, 20.4, 20.4, -11.3, 14}, {115, 8, 15, 19, -11.3, 14.5},
                                 {150, 2, 6, 13, -11.0, 15.5},    {163, 0.6, 1.0, 9, -9, 16}};
    hull(b, 6, s, "paint_antifouling", "paint_ship_grey");
    mesh_part(b, 0, "flight_deck", "paint_deck_grey", HEAT_PASSIVE);
    /* seen from above: the angled deck juts out to the left; island on the right */
    const double plan[11][2] = {{-166.4, -24}, {-166.4, 26}, {-125, 30}, {-100, 38.3}, {30, 38.5},  {62, 26},
                                {166.4, 17},   {166.4, -16}, {95, -20},  {72, -38.3},  {-60, -38.3}};
    double       low[11][2], high[11][2];
    for (int i = 0; i < 11; i++) {
        high[i][0] = plan[i][0], high[i][1] = plan[i][1];
        low[i][0] = 0.995 * plan[i][0], low[i][1] = 0.94 * plan[i][1];
    }
    mesh_slab(b, parts_upright(0, 0, 0), 11, (const double(*)[2])low, 15.6, (const double(*)[2])high, 19.6);
    mesh_part(b, 0, "sponsons", "paint_ship_grey", HEAT_HULL);
    parts_boxes(b, -110, 60, 18, 34, 11.5, 15.7);
    mesh_part(b, 0, "landing_line", "paint_white_wood", HEAT_PASSIVE);
    const double strip[4][2] = {{-164, 9}, {-164, 10.5}, {74, -27}, {74, -28.5}};
    double       above[4][2];
    memcpy(above, strip, sizeof above);
    mesh_slab(b, parts_upright(0, 0, 0), 4, strip, 19.5, (const double(*)[2])above, 19.64);
    mesh_part(b, 0, "island", "paint_ship_grey", HEAT_CABIN);
    static const double island[6][2] = {{-55, 19.5}, {-15, 19.5}, {-15, 34}, {-20, 42}, {-42, 42}, {-55, 32}};
    parts_profile(b, 6, island, 26, 36);
    parts_box(b, -44, -20, 24.8, 36.5, 36, 39);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    parts_box(b, -15.5, -14.9, 26.8, 35.2, 30, 32.5);
    parts_box(b, -43, -21, 24.7, 25, 36.8, 38.2);
    mesh_part(b, 0, "mast", "paint_ship_grey", HEAT_PASSIVE);
    parts_bar(b, -30, 31, 41.5, -30, 31, 63, 1.3);
    parts_bar(b, -30, 25.5, 54, -30, 36.5, 54, 0.5);
    parts_bar(b, -50, 31, 31.5, -50, 31, 48, 1.0);
    radar(b, -38, 31, 44.5, 3.5);
}

static void build_submarine(MeshBuilder *b)
{
    /* at the surface: the deck stands a little out of the water, the sail above it */
    const double  half = 110.3 / 2, r = 10.1 / 2, axis_h = r - 9.4;
    const Station s[9] = {{-half, 0.15, -axis_h - 0.15, -axis_h + 0.15, 1},
                          {-half + 9, 1.6, -axis_h - 1.6, -axis_h + 1.6, 1},
                          {-half + 19, 3.5, -axis_h - 3.5, -axis_h + 3.5, 1},
                          {-half + 32, 0.985 * r, -axis_h - 0.985 * r, -axis_h + 0.985 * r, 1},
                          {-half + 38, r, -axis_h - r, -axis_h + r, 1},
                          {half - 14, r, -axis_h - r, -axis_h + r, 1},
                          {half - 5.5, 0.82 * r, -axis_h - 0.82 * r, -axis_h + 0.82 * r, 1},
                          {half - 1.5, 0.48 * r, -axis_h - 0.48 * r, -axis_h + 0.48 * r, 1},
                          {half, 0.12 * r, -axis_h - 0.1 * r, -axis_h + 0.1 * r, 1}};
    mesh_part(b, 0, "pressure_hull", "paint_black_gloss", HEAT_HULL);
    mesh_loft(b, place_at(0, 0, 0), s, 9);
    mesh_part(b, 0, "sail", "paint_black_gloss", HEAT_CABIN);
    const double low[8][2] = {{14, 0}, {16.5, 0.9}, {20, 1.25},  {24, 1.0},
                              {26, 0}, {24, -1.0},  {20, -1.25}, {16.5, -0.9}};
    double       top[8][2];
    for (int i = 0; i < 8; i++) {
        top[i][0] = 20 + 0.94 * (low[i][0] - 20);
        top[i][1] = 0.85 * low[i][1];
    }
    mesh_slab(b, parts_upright(0, 0, 0), 8, low, axis_h + 0.7 * r, (const double(*)[2])top, 6.0);
    mesh_part(b, 0, "planes", "paint_black_gloss", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        parts_wing(b, parts_side(side), 22.3, 19.3, 0.4, -3.4, 21.6, 19.8, 5.0, -3.4, 0.16);
        parts_wing(b, parts_side(side), -44.0, -48.0, 0.3, -axis_h, -45.2, -48.2, 4.9, -axis_h, 0.14);
    }
    parts_fin(b, 0, -45.0, -49.5, axis_h - 4.6, -45.5, -49.0, axis_h + 5.3, 0.12);
    mesh_part(b, 0, "masts", "metal_dark", HEAT_PASSIVE);
    parts_bar(b, 22, 0, 5.8, 22, 0, 9.6, 0.16);
    parts_bar(b, 20, 0.3, 5.8, 20, 0.3, 8.2, 0.12);
    parts_bar(b, 18.5, -0.3, 5.8, 18.5, -0.3, 7.4, 0.20);
}

static void merchant(MeshBuilder *b, double half, double half_beam, double draught, double deck)
{
    const Section s[6] = {{-half, 0.25 * half_beam, 0.7 * half_beam, 0.86 * half_beam, -0.25 * draught, deck},
                          {-0.80 * half, 0.75 * half_beam, half_beam, half_beam, -draught, deck},
                          {0.70 * half, 0.9 * half_beam, half_beam, half_beam, -draught, deck},
                          {0.88 * half, 0.5 * half_beam, 0.62 * half_beam, 0.85 * half_beam, -draught, deck + 1},
                          {0.97 * half, 0.12 * half_beam, 0.2 * half_beam, 0.45 * half_beam, -draught, deck + 2.5},
                          {half, 0.01 * half_beam, 0.03 * half_beam, 0.12 * half_beam, -0.8 * draught, deck + 3}};
    hull(b, 6, s, "paint_antifouling", "paint_black_gloss");
}

static void build_cargo_ship(MeshBuilder *b)
{
    merchant(b, 147, 16.1, 12, 9.5);
    mesh_part(b, 0, "containers", "brick_red", HEAT_PASSIVE);
    for (int i = 0; i < 11; i++) {
        static const int tiers[11] = {4, 5, 5, 0, 5, 6, 5, 6, 5, 4, 3};
        const double     x = -128 + 22 * i;
        if (tiers[i] > 0)
            parts_box(b, x, x + 20, -(i == 10 ? 11 : 15.5), i == 10 ? 11 : 15.5, 9.4, 9.5 + 2.6 * tiers[i]);
    }
    mesh_part(b, 0, "superstructure", "paint_white_wood", HEAT_CABIN);
    parts_box(b, -62, -50, -14, 14, 9.4, 34);
    parts_box(b, -60, -51, -16.0, 16.0, 31, 33.6);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    parts_box(b, -50.1, -49.8, -13, 13, 31.4, 33);
    mesh_part(b, 0, "funnel", "metal_dark", HEAT_EXHAUST);
    parts_box(b, -68, -63.5, -4, 4, 9.4, 37);
    mesh_part(b, 0, "mast", "paint_white_wood", HEAT_PASSIVE);
    parts_bar(b, -55, 0, 33.5, -55, 0, 46, 0.5);
    parts_bar(b, 132, 0, 10, 132, 0, 24, 0.4);
}

static void build_tanker(MeshBuilder *b)
{
    merchant(b, 122.5, 21, 14, 7);
    mesh_part(b, 0, "deck", "brick_red", HEAT_PASSIVE);
    parts_box(b, -80, 100, -19, 19, 6.9, 7.1);
    for (int i = 0; i < 5; i++) parts_box(b, -60 + 32 * i, -57 + 32 * i, -15, 15, 7.0, 8.2);
    parts_box(b, -75, 95, -1.6, 1.6, 7.0, 9.4);
    for (int side = -1; side <= 1; side += 2) parts_bar(b, 12, side * 10, 7, 12, side * 10, 20, 0.7);
    mesh_part(b, 0, "superstructure", "paint_white_wood", HEAT_CABIN);
    parts_box(b, -100, -86, -16, 16, 6.9, 24);
    parts_box(b, -98, -87, -21, 21, 24, 27);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    parts_box(b, -87.1, -86.8, -18, 18, 24.6, 26.4);
    mesh_part(b, 0, "funnel", "metal_dark", HEAT_EXHAUST);
    parts_box(b, -112, -104, -4.5, 4.5, 6.9, 30);
    mesh_part(b, 0, "mast", "paint_white_wood", HEAT_PASSIVE);
    parts_bar(b, -92, 0, 26.9, -92, 0, 37, 0.5);
    parts_bar(b, 108, 0, 7.5, 108, 0, 20, 0.4);
}

Status parametric_vessel(Model *out, const char *name, double sag_m)
{
    static const ShapeKind kinds[] = {
        {"boat", build_boat, 0},
        {"rhib", build_rhib, 0},
        {"aircraft_carrier", build_carrier_ship, 0},
        {"submarine", build_submarine, 0},
        {"cargo_ship", build_cargo_ship, 0},
        {"tanker", build_tanker, 0},
    };
    return parts_build(out, kinds, name, "hull", sag_m);
}
