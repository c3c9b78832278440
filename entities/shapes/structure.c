/* entities/shapes/structure.c: things that stand: crates, radar on its mast, tent, bridge, buoy, satellite; rolling
 * stock; an animal; a house.
 *
 * Sizes: crates: a pallet of 1.22 x 1.02 m (the 48 x 40 inch pallet of MIL-P-15011), loaded to 1.20 m; radar: AN/TPQ-36
 * class trailer with a mast, 4.3 x 2.1 x 3.9 m, estimate; tent: GP medium 9.75 x 4.88 x 3.05 (US Army TM 10-8340);
 * bridge: a two-lane girder span of 30 m, 8.0 m wide, its deck 6 m over the ground, estimate; buoy: AN/SSQ-53 0.91 m
 * long, 0.124 m across, its float at the surface; satellite: body of 3 m with wings of 17 m (GPS IIF class 17.3 x 2.5
 * x 2.2); locomotive: GE ES44AC 22.3 x 3.12 x 4.7; railcar: 50-foot box car 16.9 x 3.2 x 4.6; animal: a horse 2.4 m
 * long, 1.6 m at the withers, estimate. */

#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

static void build_crates(MeshBuilder *b)
{
    mesh_part(b, 0, "pallet", "wood_pine", HEAT_PASSIVE);
    for (int i = -1; i <= 1; i++) parts_box(b, -0.61, 0.61, 0.46 * i - 0.045, 0.46 * i + 0.045, 0, 0.10);
    for (int i = 0; i < 6; i++) parts_box(b, -0.61 + 0.218 * i, -0.48 + 0.218 * i, -0.51, 0.51, 0.10, 0.125);
    mesh_part(b, 0, "crates", "paint_olive", HEAT_PASSIVE);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++) {
            const double x = -0.60 + 0.61 * i;
            parts_box(b, x, x + 0.59, -0.50, 0.50, 0.126 + 0.54 * k, 0.126 + 0.54 * k + (k ? 0.534 : 0.525));
        }
    mesh_part(b, 0, "battens", "wood_pine", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 2; i++)
            parts_box(b, -0.40 + 0.61 * i, -0.30 + 0.61 * i, side < 0 ? -0.51 : 0.49, side < 0 ? -0.49 : 0.51, 0.15,
                      1.17);
}

static void build_radar(MeshBuilder *b)
{
    mesh_part(b, 0, "trailer", "paint_olive", HEAT_PASSIVE);
    parts_box(b, -1.9, 1.5, -0.9, 0.9, 0.60, 0.85);
    parts_bar(b, 1.4, 0, 0.7, 2.15, 0, 0.55, 0.06);
    for (int side = -1; side <= 1; side += 2)
        for (int end = -1; end <= 1; end += 2) {
            parts_bar(b, end * 1.3, side * 0.95, 0.02, end * 1.3, side * 0.95, 0.75, 0.05);
            parts_box(b, end * 1.3 - 0.12, end * 1.3 + 0.12, side < 0 ? -1.05 : 0.83, side < 0 ? -0.83 : 1.05, 0, 0.05);
        }
    mesh_part(b, 0, "cabinet", "paint_olive", HEAT_CABIN);
    parts_box(b, -1.85, -0.5, -0.85, 0.85, 0.84, 2.10);
    mesh_part(b, 0, "generator", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, 0.75, 1.45, -0.7, 0.7, 0.84, 1.45);
    mesh_part(b, 0, "mast", "paint_olive", HEAT_PASSIVE);
    parts_bar(b, 0.1, 0, 0.8, 0.1, 0, 2.45, 0.16);
    for (int side = -1; side <= 1; side += 2) parts_wheel(b, "wheel", side, 0, -0.1, side * 0.93, 0.42, 0.11);
    const int head = mesh_node(b, "antenna", 0, 0.1, 0, -2.45);
    mesh_joint(b, head, 0, 0, 1, 5376, 11, 1, -1);
    mesh_node_get(b, head)->spin_rps_moving = 12 * 2 * pi_rad / 60;
    mesh_part(b, head, "antenna", "paint_olive", HEAT_PASSIVE);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), -0.05, 0.25, 0.26);
    static const double panel[4][2] = {{0.20, -0.10}, {0.38, -0.10}, {0.10, -1.45}, {-0.05, -1.45}};
    mesh_prism(b, place_at(0, 0, 0), 4, panel, -1.04, 1.04);
    mesh_part(b, head, "antenna_face", "radome_glass_fibre", HEAT_PASSIVE);
    static const double face[4][2] = {{0.375, -0.16}, {0.395, -0.16}, {0.13, -1.40}, {0.11, -1.40}};
    mesh_prism(b, place_at(0, 0, 0), 4, face, -0.98, 0.98);
}

static void build_tent(MeshBuilder *b)
{
    /* walls to 1.5 m, a ridge along x, the roof a little over the walls */
    mesh_part(b, 0, "walls", "canvas", HEAT_CABIN);
    parts_block(b, (Rectangle){-4.80, 4.80, -2.42, 2.42}, 0, (Rectangle){-4.80, 4.80, -2.36, 2.36}, 1.55);
    mesh_part(b, 0, "roof", "canvas", HEAT_PASSIVE);
    static const double low[4][2] = {{-4.875, -2.44}, {4.875, -2.44}, {4.875, 2.44}, {-4.875, 2.44}};
    static const double ridge[4][2] = {{-3.4, -0.03}, {3.4, -0.03}, {3.4, 0.03}, {-3.4, 0.03}};
    mesh_slab(b, parts_upright(0, 0, 0), 4, low, 1.50, ridge, 3.05);
    mesh_part(b, 0, "door", "cloth_olive", HEAT_PASSIVE);
    parts_box(b, 4.79, 4.83, -0.7, 0.7, 0.02, 1.50);
}

static void build_bridge(MeshBuilder *b)
{
    mesh_part(b, 0, "deck", "concrete", HEAT_PASSIVE);
    parts_box(b, -15, 15, -4, 4, 5.6, 6.0);
    mesh_part(b, 0, "road", "asphalt_road", HEAT_PASSIVE);
    parts_box(b, -15, 15, -3.3, 3.3, 5.99, 6.03);
    mesh_part(b, 0, "girders", "metal_steel_oxidized", HEAT_PASSIVE);
    for (int i = -1; i <= 1; i++) parts_box(b, -14.5, 14.5, 2.6 * i - 0.2, 2.6 * i + 0.2, 4.5, 5.61);
    mesh_part(b, 0, "piers", "concrete", HEAT_PASSIVE);
    for (int i = -1; i <= 1; i += 2) {
        parts_box(b, 9.5 * i - 0.7, 9.5 * i + 0.7, -3.4, 3.4, 0, 4.52);
        parts_box(b, 9.5 * i - 1.2, 9.5 * i + 1.2, -3.9, 3.9, 0, 0.8);
    }
    mesh_part(b, 0, "railings", "metal_steel_galvanized", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        parts_bar(b, -14.95, side * 3.9, 7.0, 14.95, side * 3.9, 7.0, 0.05);
        parts_bar(b, -14.95, side * 3.9, 6.5, 14.95, side * 3.9, 6.5, 0.04);
        for (int i = 0; i < 13; i++)
            parts_bar(b, -14.9 + 29.8 / 12 * i, side * 3.9, 5.95, -14.9 + 29.8 / 12 * i, side * 3.9, 7.0, 0.045);
    }
}

static void build_buoy(MeshBuilder *b)
{
    mesh_part(b, 0, "tube", "metal_aluminium_bare", HEAT_PASSIVE);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), 0, 0.62, 0.062);
    mesh_part(b, 0, "float", "paint_white_missile", HEAT_PASSIVE);
    mesh_profile_begin(b, 0.61, 0);
    mesh_profile_line(b, 0.61, 0.058);
    mesh_profile_line(b, 0.72, 0.062);
    mesh_profile_arc(b, 0.72, 0, -0.5 * pi_rad);
    mesh_lathe(b, place_axis(0, 0, 0, 0, 0, -1));
    mesh_part(b, 0, "aerial", "metal_dark", HEAT_PASSIVE);
    parts_bar(b, 0, 0, 0.77, 0, 0, 0.91, 0.005);
}

static void build_satellite(MeshBuilder *b)
{
    mesh_part(b, 0, "body", "metal_aluminium_bare", HEAT_PASSIVE);
    parts_box(b, -1.1, 1.1, -1.2, 1.2, 0, 2.0);
    mesh_part(b, 0, "panels", "paint_black_gloss", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 3; i++) {
            const double y0 = 1.9 + 2.28 * i, y1 = y0 + 2.19;
            parts_box(b, -1.25, 1.25, side < 0 ? -y1 : y0, side < 0 ? -y0 : y1, 0.98, 1.02);
        }
    mesh_part(b, 0, "booms", "metal_dark", HEAT_PASSIVE);
    parts_bar(b, 0, -8.6, 1.0, 0, 8.6, 1.0, 0.05);
    mesh_part(b, 0, "antenna", "radome_glass_fibre", HEAT_PASSIVE);
    mesh_cone(b, place_axis(0, 0, -1.95, 0, 0, -1), 0, 0.25, 0.30, 0.9);
}

static void bogie(MeshBuilder *b, double x, int first, int axles, double step, double radius)
{
    for (int i = 0; i < axles; i++)
        for (int side = -1; side <= 1; side += 2) {
            const double at = x + step * (0.5 * (axles - 1) - i);
            const int    node = parts_wheel_node(b, 0, "wheel", side, first + i, at, side * 0.75, -radius, radius);
            mesh_part(b, node, "wheel", "steel_worn", HEAT_WHEEL);
            parts_disc(b, place_axis(0, 0, 0, 0, side, 0), radius, 0.07, 6);
        }
}

static void build_locomotive(MeshBuilder *b)
{
    mesh_part(b, 0, "frame", "metal_dark", HEAT_PASSIVE);
    parts_box(b, -10.9, 10.9, -1.50, 1.50, 1.25, 1.65);
    parts_box(b, -2.8, 2.6, -1.30, 1.30, 0.45, 1.26); /* fuel tank */
    parts_boxes(b, -10.0, -5.6, 0.85, 1.15, 0.42, 0.85);
    parts_boxes(b, 5.6, 10.0, 0.85, 1.15, 0.42, 0.85);
    for (int end = -1; end <= 1; end += 2) {
        parts_box(b, end < 0 ? -10.95 : 10.6, end < 0 ? -10.6 : 10.95, -1.45, 1.45, 0.30, 1.30);
        parts_box(b, end < 0 ? -11.15 : 10.9, end < 0 ? -10.9 : 11.15, -0.18, 0.18, 0.75, 1.10); /* coupler */
    }
    mesh_part(b, 0, "cab", "paint_sand", HEAT_CABIN);
    parts_box(b, 6.1, 8.9, -1.56, 1.56, 1.64, 4.55);
    static const double nose[4][2] = {{8.85, 1.64}, {10.6, 1.64}, {10.3, 3.0}, {8.85, 3.15}};
    parts_profile(b, 4, nose, -0.95, 0.95);
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    parts_boxes(b, 8.86, 8.92, 0.15, 1.35, 3.35, 4.15);
    for (int side = -1; side <= 1; side += 2)
        parts_box(b, 6.5, 8.4, side < 0 ? -1.565 : 1.54, side < 0 ? -1.54 : 1.565, 3.3, 4.1);
    mesh_part(b, 0, "hood", "paint_sand", HEAT_ENGINE_DECK);
    parts_box(b, -8.2, 6.12, -0.98, 0.98, 1.64, 4.45);
    mesh_part(b, 0, "radiator", "metal_dark", HEAT_ENGINE_DECK);
    parts_box(b, -10.7, -8.18, -1.45, 1.45, 3.2, 4.70);
    parts_box(b, -10.5, -8.19, -0.98, 0.98, 1.64, 3.22);
    mesh_part(b, 0, "exhaust", "metal_dark", HEAT_EXHAUST);
    parts_box(b, -2.2, -1.0, -0.35, 0.35, 4.44, 4.68);
    mesh_part(b, 0, "railings", "paint_white_wood", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        parts_bar(b, -8.0, side * 1.45, 2.6, 6.0, side * 1.45, 2.6, 0.03);
        for (int i = 0; i < 8; i++) parts_bar(b, -8.0 + 2 * i, side * 1.45, 1.6, -8.0 + 2 * i, side * 1.45, 2.6, 0.03);
    }
    bogie(b, 7.8, 1, 3, 1.95, 0.533);
    bogie(b, -7.8, 4, 3, 1.95, 0.533);
}

static void build_railcar(MeshBuilder *b)
{
    mesh_part(b, 0, "body", "brick_red", HEAT_PASSIVE);
    parts_box(b, -7.75, 7.75, -1.50, 1.50, 1.10, 4.35);
    parts_block(b, (Rectangle){-7.78, 7.78, -1.54, 1.54}, 4.30, (Rectangle){-7.7, 7.7, -0.3, 0.3}, 4.60);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 11; i++)
            if (i != 5)
                parts_box(b, -7.5 + 1.48 * i, -7.4 + 1.48 * i, side < 0 ? -1.57 : 1.49, side < 0 ? -1.49 : 1.57, 1.15,
                          4.29);
    mesh_part(b, 0, "doors", "paint_deck_grey", HEAT_PASSIVE);
    parts_boxes(b, -1.25, 1.25, 1.45, 1.60, 1.20, 4.20);
    mesh_part(b, 0, "frame", "metal_dark", HEAT_PASSIVE);
    parts_box(b, -8.2, 8.2, -0.35, 0.35, 0.80, 1.12);
    for (int end = -1; end <= 1; end += 2) {
        parts_box(b, end < 0 ? -8.45 : 8.15, end < 0 ? -8.15 : 8.45, -0.15, 0.15, 0.78, 1.05);
        parts_boxes(b, end * 5.9 - 1.2, end * 5.9 + 1.2, 0.85, 1.05, 0.35, 0.62);
        parts_box(b, end * 5.9 - 0.2, end * 5.9 + 0.2, -1.0, 1.0, 0.40, 0.81);
    }
    bogie(b, 5.9, 1, 2, 1.68, 0.457);
    bogie(b, -5.9, 3, 2, 1.68, 0.457);
}

static void build_animal(MeshBuilder *b)
{
    mesh_part(b, 0, "body", "bark_pine", HEAT_CLOTHING);
    parts_limb(b, (double[3]){-0.55, 0, -1.20}, 0.30, (double[3]){0.45, 0, -1.20}, 0.29);
    parts_limb(b, (double[3]){0.60, 0, -1.32}, 0.20, (double[3]){1.02, 0, -1.85}, 0.12);
    parts_limb(b, (double[3]){1.02, 0, -1.88}, 0.13, (double[3]){1.38, 0, -1.62}, 0.075);
    for (int side = -1; side <= 1; side += 2) {
        parts_limb(b, (double[3]){0.55, side * 0.16, -1.05}, 0.13, (double[3]){0.58, side * 0.16, -0.50}, 0.065);
        parts_limb(b, (double[3]){0.58, side * 0.16, -0.50}, 0.06, (double[3]){0.56, side * 0.16, -0.06}, 0.055);
        parts_limb(b, (double[3]){-0.65, side * 0.17, -1.10}, 0.17, (double[3]){-0.78, side * 0.17, -0.55}, 0.07);
        parts_limb(b, (double[3]){-0.78, side * 0.17, -0.55}, 0.065, (double[3]){-0.70, side * 0.17, -0.06}, 0.055);
        parts_limb(b, (double[3]){1.02, side * 0.07, -1.97}, 0.035, (double[3]){1.00, side * 0.08, -2.10}, 0.015);
    }
    mesh_part(b, 0, "hair", "metal_dark", HEAT_PASSIVE);
    parts_limb(b, (double[3]){-0.85, 0, -1.30}, 0.05, (double[3]){-0.99, 0, -0.65}, 0.04);
    parts_fin(b, 0, 1.00, 0.86, 1.93, 0.98, 0.90, 1.99, 0.2);
    /* hooves make the ground */
    mesh_part(b, 0, "hooves", "metal_dark", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        parts_box(b, 0.50, 0.64, side * 0.16 - 0.06, side * 0.16 + 0.06, 0, 0.07);
        parts_box(b, -0.76, -0.62, side * 0.17 - 0.06, side * 0.17 + 0.06, 0, 0.07);
    }
}

/* What has no shape: a stand-in of a centimetre that is never placed in a scene (catalog_has_shape). */
static void build_none(MeshBuilder *b)
{
    mesh_part(b, 0, "nothing", "paint_grey", HEAT_PASSIVE);
    parts_box(b, -0.005, 0.005, -0.005, 0.005, 0, 0.01);
}

Status parametric_structure(Model *out, const char *name, double sag_m)
{
    static const ShapeKind kinds[] = {
        {"crates", build_crates, 0},
        {"radar", build_radar, 0},
        {"tent", build_tent, 0},
        {"bridge", build_bridge, 0},
        {"buoy", build_buoy, 0.001},
        {"satellite", build_satellite, 0},
        {"locomotive", build_locomotive, 0},
        {"railcar", build_railcar, 0},
        {"animal", build_animal, 0},
        {"none", build_none, 0},
        {"chaff", build_none, 0},
    };
    return parts_build(out, kinds, name, "body", sag_m);
}

/* ---- house ---------------------------------------------------------------------------------- */

/* Detached house of two storeys under a gable roof. It stands for no one house: 10.0 m by 8.0 m in plan, storeys of 2.7
 * m, eaves at 5.4 m, roof pitched 40 degrees (ridge at 8.756 m) with an overhang of 0.4 m, as the common run of central
 * European houses; door leaf 2.11 m by 0.985 m (DIN 18101), windows 1.20 m by 1.35 m. Brick outside, clay tiles, timber
 * door and frames. The door faces forward (+x), the ridge runs across (y), the chimney stands right of the middle
 * behind the ridge. All rooms are taken as one heated inside. */

static const double half_depth_m = 4.0, half_width_m = 5.0; /* along x, along y */
static const double eaves_m = 5.4, pitch_rad = 40 * rad_per_deg, overhang_m = 0.4, tiles_m = 0.12;
static const double plinth_m = 0.35, storey_m = 2.7;

static void build_walls(MeshBuilder *b)
{
    const double ridge_m = eaves_m + half_depth_m * tan(pitch_rad);
    mesh_part(b, 0, "plinth", "concrete", HEAT_PASSIVE);
    mesh_box(b, place_at(0, 0, 0), -half_depth_m - 0.03, -half_width_m - 0.03, -plinth_m, half_depth_m + 0.03,
             half_width_m + 0.03, 0);
    mesh_box(b, place_at(0, 0, 0), half_depth_m, -1.0, -0.17, half_depth_m + 1.1, 1.0, 0); /* step */
    mesh_part(b, 0, "walls", "brick_red", HEAT_DWELLING);
    const double gable[5][2] = {{-half_depth_m, -plinth_m},
                                {half_depth_m, -plinth_m},
                                {half_depth_m, -eaves_m},
                                {0, -ridge_m},
                                {-half_depth_m, -eaves_m}};
    mesh_prism(b, place_at(0, 0, 0), 5, gable, -half_width_m, half_width_m);
}

static void build_roof(MeshBuilder *b)
{
    /* one slab a side, its underside on the wall plate; the two meet at the ridge */
    const double reach = half_depth_m + overhang_m * cos(pitch_rad), drop = reach * tan(pitch_rad);
    const double ridge_m = eaves_m + half_depth_m * tan(pitch_rad), thick = tiles_m / cos(pitch_rad);
    mesh_part(b, 0, "roof", "roof_tile_clay", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        const double slope[4][2] = {{0, -ridge_m},
                                    {side * reach, -ridge_m + drop},
                                    {side * reach, -ridge_m + drop - thick},
                                    {0, -ridge_m - thick}};
        mesh_prism(b, place_at(0, 0, 0), 4, slope, -half_width_m - overhang_m, half_width_m + overhang_m);
    }
    mesh_bar(b, (double[3]){0, -half_width_m - overhang_m, -ridge_m - thick},
             (double[3]){0, half_width_m + overhang_m, -ridge_m - thick}, 0.11);
    mesh_part(b, 0, "gutters", "metal_steel_galvanized", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        const double x = side * (reach + 0.06), z = -ridge_m + drop - 0.02;
        mesh_bar(b, (double[3]){x, -half_width_m - overhang_m, z}, (double[3]){x, half_width_m + overhang_m, z}, 0.065);
        /* downpipe at one corner, back under the eaves */
        const double y = side * 4.85, wall_x = side * (half_depth_m + 0.07);
        mesh_bar(b, (double[3]){x, y, z}, (double[3]){wall_x, y, z + 0.45}, 0.04);
        mesh_bar(b, (double[3]){wall_x, y, z + 0.42}, (double[3]){wall_x, y, -0.05}, 0.04);
    }
}

/* A window on a wall: place x outwards from the wall's face, y along it, z down; its middle at the place. */
static void build_frame(MeshBuilder *b, Place place, double width_m, double height_m)
{
    const double w = 0.5 * width_m, h = 0.5 * height_m, f = 0.07;
    mesh_box(b, place, -0.02, -w, -h, 0.05, -w + f, h);
    mesh_box(b, place, -0.02, w - f, -h, 0.05, w, h);
    mesh_box(b, place, -0.02, -w + f, -h, 0.05, w - f, -h + f);
    mesh_box(b, place, -0.02, -w + f, h - f, 0.05, w - f, h);
    mesh_box(b, place, -0.02, -0.03, -h + f, 0.045, 0.03, h - f);      /* mullion */
    mesh_box(b, place, -0.02, -w - 0.05, h, 0.12, w + 0.05, h + 0.05); /* sill */
}

enum { window_capacity = 24 };

/* Front and back by column and storey (the door takes one place), gable ends two a storey. */
static int window_places(Place *place)
{
    int count = 0;
    for (int storey = 0; storey < 2; storey++) {
        const double z = -(plinth_m + storey * storey_m + 1.45);
        for (int side = -1; side <= 1; side += 2) {
            for (int i = -1; i <= 1; i++) {
                if (side > 0 && storey == 0 && i == 0) continue;
                place[count++] = place_axis(side * half_depth_m, 3.1 * i, z, side, 0, 0);
            }
            for (int i = -1; i <= 1; i += 2) place[count++] = place_axis(1.9 * i, side * half_width_m, z, 0, side, 0);
        }
    }
    return count;
}

static void build_openings(MeshBuilder *b)
{
    Place     place[window_capacity];
    const int count = window_places(place);
    for (int i = 0; i < count; i++) { /* shape z must be down: place_axis leaves the roll open */
        const double *m = place[i].m;
        const double  upright[9] = {m[0], -m[3], 0, m[3], m[0], 0, 0, 0, 1};
        memcpy(place[i].m, upright, sizeof upright);
    }
    mesh_part(b, 0, "window_frames", "paint_white_wood", HEAT_PASSIVE);
    for (int i = 0; i < count; i++) build_frame(b, place[i], 1.20, 1.35);
    mesh_part(b, 0, "windows", "glass_window", HEAT_WINDOW);
    for (int i = 0; i < count; i++) mesh_box(b, place[i], -0.02, -0.54, -0.61, 0.02, 0.54, 0.61);
    mesh_part(b, 0, "door", "wood_pine", HEAT_DWELLING);
    mesh_box(b, place_at(0, 0, 0), half_depth_m - 0.02, -0.4925, -0.17 - 2.11, half_depth_m + 0.03, 0.4925, -0.17);
    for (int i = 0; i < 2; i++) /* two raised panels and the handle */
        mesh_box(b, place_at(0, 0, -0.95 * i), half_depth_m, -0.34, -1.10, half_depth_m + 0.045, 0.34, -0.40);
    mesh_bar(b, (double[3]){half_depth_m, 0.42, -1.22}, (double[3]){half_depth_m + 0.09, 0.42, -1.22}, 0.012);
    mesh_bar(b, (double[3]){half_depth_m + 0.085, 0.43, -1.22}, (double[3]){half_depth_m + 0.085, 0.30, -1.22}, 0.011);
    mesh_part(b, 0, "door_frame", "paint_white_wood", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        mesh_box(b, parts_side(side), half_depth_m - 0.02, 0.4925, -2.37, half_depth_m + 0.06, 0.58, -0.17);
    mesh_box(b, place_at(0, 0, 0), half_depth_m - 0.02, -0.4925, -2.37, half_depth_m + 0.06, 0.4925, -2.28);
    mesh_box(b, place_at(0, 0, 0), half_depth_m - 0.02, -0.95, -2.62, half_depth_m + 0.90, 0.95, -2.54); /* canopy */
}

static void build_chimney(MeshBuilder *b)
{
    mesh_part(b, 0, "chimney", "brick_red", HEAT_FLUE);
    mesh_box(b, place_at(0, 0, 0), -1.45, 1.55, -9.6, -0.85, 2.15, -7.0);
    mesh_box(b, place_at(0, 0, 0), -1.52, 1.48, -9.7, -0.78, 2.22, -9.55);
    mesh_part(b, 0, "flue", "motor_nozzle", HEAT_FLUE);
    mesh_tube(b, place_axis(-1.15, 1.85, -9.6, 0, 0, -1), 0, 0.35, 0.14, 0.11);
}

Status parametric_building(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("building", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "house", -1, 0, 0, 0);
    build_walls(b);
    build_roof(b);
    build_openings(b);
    build_chimney(b);
    return mesh_builder_finish(out, b);
}
