/* entities/parametric/building.c: detached house of two storeys under a gable roof. It stands for no one house: 10.0
 * m by 8.0 m in plan, storeys of 2.7 m, eaves at 5.4 m, roof pitched 40 degrees (ridge at 8.756 m) with an overhang
 * of 0.4 m, as the common run of central European houses; door leaf 2.11 m by 0.985 m (DIN 18101), windows 1.20 m by
 * 1.35 m. Brick outside, clay tiles, timber door and frames. The door faces forward (+x), the ridge runs across (y),
 * the chimney stands right of the middle behind the ridge. All rooms are taken as one heated inside. */
#include "entities/parametric/parametric.h"
#include "entities/parametric/parts.h"

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
    const double gable[5][2] = {{-half_depth_m, -plinth_m}, {half_depth_m, -plinth_m}, {half_depth_m, -eaves_m},
                                {0, -ridge_m}, {-half_depth_m, -eaves_m}};
    mesh_prism(b, place_at(0, 0, 0), 5, gable, -half_width_m, half_width_m);
}

static void build_roof(MeshBuilder *b)
{
    /* one slab a side, its underside on the wall plate; the two meet at the ridge */
    const double reach = half_depth_m + overhang_m * cos(pitch_rad), drop = reach * tan(pitch_rad);
    const double ridge_m = eaves_m + half_depth_m * tan(pitch_rad), thick = tiles_m / cos(pitch_rad);
    mesh_part(b, 0, "roof", "roof_tile_clay", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        const double slope[4][2] = {{0, -ridge_m}, {side * reach, -ridge_m + drop},
                                    {side * reach, -ridge_m + drop - thick}, {0, -ridge_m - thick}};
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
    mesh_box(b, place, -0.02, -0.03, -h + f, 0.045, 0.03, h - f);       /* mullion */
    mesh_box(b, place, -0.02, -w - 0.05, h, 0.12, w + 0.05, h + 0.05);  /* sill */
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
            for (int i = -1; i <= 1; i += 2)
                place[count++] = place_axis(1.9 * i, side * half_width_m, z, 0, side, 0);
        }
    }
    return count;
}

static void build_openings(MeshBuilder *b)
{
    Place place[window_capacity];
    const int count = window_places(place);
    for (int i = 0; i < count; i++) { /* shape z must be down: place_axis leaves the roll open */
        const double *m = place[i].m;
        const double upright[9] = {m[0], -m[3], 0, m[3], m[0], 0, 0, 0, 1};
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
