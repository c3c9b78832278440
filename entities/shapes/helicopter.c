/* entities/shapes/helicopter.c: attack helicopter of the AH-1 class. Published for the AH-1G/S (US Army TM
 * 55-1520-236-10; Jane's All the World's Aircraft): fuselage 13.59 m long and 0.99 m wide, height 4.11 m, main rotor
 * of two blades 13.41 m across with a chord of 0.686 m at 324 rpm, tail rotor 2.59 m across at 1,654 rpm on the
 * right of the fin, stub wings of 3.15 m span, skids 2.13 m apart, chin turret of +-110 degrees, gun +20.5 .. -50
 * degrees. The rotor turns counter-clockwise seen from above. Sections of the body are estimates from the three-view
 * drawings in those books. At rest the blades lie fore and aft, the tail rotor's up and down. */
#include "entities/shapes/mesh_builder.h"
#include "entities/shapes/parametric.h"

static const double hub_x_m = 1.70, hub_z_m = -3.93, rotor_radius_m = 13.41 / 2, rotor_chord_m = 0.686;
static const double tail_hub_x_m = -6.42, tail_hub_y_m = 0.34, tail_hub_z_m = -2.78, tail_radius_m = 2.59 / 2;
static const double half_span_m = 3.15 / 2, half_skid_track_m = 1.065, skid_radius_m = 0.05;

static Place mirrored(int side)
{
    const Place here = place_at(0, 0, 0);
    return side < 0 ? place_mirror_y(here) : here;
}

static void build_fuselage(MeshBuilder *b)
{
    const Place          here = place_at(0, 0, 0);
    static const Station body[12] = {
        {6.795, 0.07, -1.42, -1.22, 1.0}, {6.68, 0.20, -1.56, -1.06, 1.0},  {6.40, 0.31, -1.70, -0.93, 0.9},
        {5.90, 0.39, -1.83, -0.82, 0.75}, {5.00, 0.46, -1.98, -0.74, 0.6},  {3.80, 0.495, -2.10, -0.70, 0.5},
        {2.20, 0.495, -2.20, -0.70, 0.5}, {0.60, 0.495, -2.20, -0.72, 0.5}, {-0.60, 0.46, -2.16, -0.82, 0.55},
        {-1.80, 0.36, -2.10, -1.12, 0.7}, {-3.20, 0.27, -2.05, -1.38, 0.9}, {-6.30, 0.14, -1.98, -1.66, 1.0},
    };
    Station ascending[12];
    for (int i = 0; i < 12; i++) ascending[i] = body[11 - i];
    mesh_part(b, 0, "fuselage", "paint_olive", HEAT_HULL);
    mesh_loft(b, here, ascending, 12);

    /* fin, swept back, and the tail bumper under it */
    mesh_part(b, 0, "fin", "paint_olive", HEAT_PASSIVE);
    {
        /* drawn flat as (x, thickness) and lofted upwards: shape y is up */
        static const double root[6][2] = {{-5.30, 0}, {-5.65, 0.09},  {-6.30, 0.06},
                                          {-6.50, 0}, {-6.30, -0.06}, {-5.65, -0.09}};
        static const double tip[6][2] = {{-6.22, 0},  {-6.36, 0.045}, {-6.66, 0.03},
                                         {-6.795, 0}, {-6.66, -0.03}, {-6.36, -0.045}};
        Place               up = here;
        const double        m[9] = {1, 0, 0, 0, 0, 1, 0, -1, 0};
        for (int i = 0; i < 9; i++) up.m[i] = m[i];
        mesh_slab(b, up, 6, root, 1.75, tip, 3.25);
        /* tail rotor gearbox and its shaft, out to the right */
        mesh_bar(b, (double[3]){tail_hub_x_m, -0.05, tail_hub_z_m},
                 (double[3]){tail_hub_x_m, tail_hub_y_m, tail_hub_z_m}, 0.06);
        mesh_sphere(b, place_scaled(place_at(tail_hub_x_m, 0, tail_hub_z_m), 0.22, 0.12, 0.14), 1);
        mesh_bar(b, (double[3]){-6.1, 0, -1.75}, (double[3]){-6.55, 0, -1.35}, 0.025);
    }
    /* the missile system's telescope under the nose, fixed here */
    mesh_part(b, 0, "sight", "glass_window", HEAT_CABIN);
    mesh_sphere(b, place_at(6.52, 0, -1.10), 0.19);
    /* stabiliser across the boom */
    mesh_part(b, 0, "stabiliser", "paint_olive", HEAT_PASSIVE);
    static const double root[6][2] = {{-3.60, -1.80}, {-3.75, -1.845}, {-4.15, -1.83},
                                      {-4.32, -1.80}, {-4.15, -1.785}, {-3.75, -1.775}};
    static const double tip[6][2] = {{-3.80, -1.80}, {-3.90, -1.825}, {-4.15, -1.82},
                                     {-4.28, -1.80}, {-4.15, -1.79},  {-3.90, -1.785}};
    for (int side = -1; side <= 1; side += 2) mesh_slab(b, mirrored(side), 6, root, 0.05, tip, 1.05);
}

static void build_canopy(MeshBuilder *b)
{
    /* gunner in front, pilot behind and higher */
    static const Station glass[7] = {
        {2.55, 0.40, -2.72, -1.80, 0.55}, {3.05, 0.43, -2.80, -1.80, 0.55}, {3.60, 0.44, -2.78, -1.78, 0.55},
        {4.20, 0.43, -2.60, -1.74, 0.55}, {4.75, 0.41, -2.46, -1.70, 0.55}, {5.25, 0.36, -2.24, -1.66, 0.6},
        {5.80, 0.24, -1.86, -1.60, 0.8},
    };
    const Place here = place_at(0, 0, 0);
    mesh_part(b, 0, "canopy", "glass_window", HEAT_CABIN);
    mesh_loft(b, here, glass, 7);
    /* frames: the same sections, a centimetre prouder, 5 cm wide; and a sill along each side */
    mesh_part(b, 0, "canopy_frame", "paint_olive", HEAT_CABIN);
    static const double frame_x_m[4] = {2.58, 3.55, 4.45, 5.25};
    for (int i = 0; i < 4; i++) {
        Station rib[2];
        for (int k = 0; k < 2; k++) {
            rib[k] = mesh_station_at(glass, 7, frame_x_m[i] + 0.06 * k);
            rib[k].half_width += 0.012;
            rib[k].top -= 0.012;
        }
        mesh_loft(b, here, rib, 2);
    }
    for (int side = -1; side <= 1; side += 2)
        mesh_bar(b, (double[3]){2.55, side * 0.43, -2.16}, (double[3]){5.20, side * 0.385, -1.99}, 0.035);
    mesh_bar(b, (double[3]){2.55, 0, -2.725}, (double[3]){3.40, 0, -2.80}, 0.02);
}

static void build_engine(MeshBuilder *b)
{
    /* gearbox and engine cowling on the back, from the canopy to the jet pipe */
    static const Station cowl[7] = {
        {-1.75, 0.27, -2.72, -2.02, 0.9}, {-1.20, 0.36, -2.86, -2.02, 0.75}, {-0.20, 0.42, -2.95, -2.02, 0.6},
        {0.80, 0.43, -3.02, -2.00, 0.55}, {1.70, 0.42, -3.06, -2.00, 0.55},  {2.30, 0.40, -2.98, -2.00, 0.6},
        {2.62, 0.34, -2.78, -2.00, 0.7},
    };
    const Place here = place_at(0, 0, 0);
    mesh_part(b, 0, "engine_cowling", "paint_olive", HEAT_ENGINE_DECK);
    mesh_loft(b, here, cowl, 7);
    /* mast fairing */
    static const Station mast[3] = {
        {1.15, 0.10, -3.30, -2.95, 0.9}, {1.65, 0.17, -3.36, -2.95, 0.9}, {2.20, 0.09, -3.22, -2.95, 0.9}};
    mesh_loft(b, here, mast, 3);
    mesh_part(b, 0, "intakes", "metal_dark", HEAT_ENGINE_DECK);
    for (int side = -1; side <= 1; side += 2) {
        static const Station scoop[2] = {{0.35, 0.10, -2.86, -2.42, 0.6}, {0.95, 0.13, -2.92, -2.38, 0.6}};
        mesh_loft(b, place_at(0, side * 0.42, 0), scoop, 2);
    }
    /* jet pipe, hollow, tilted up by 12 degrees, with the turbine's last stage dark inside */
    mesh_part(b, 0, "jet_pipe", "metal_dark", HEAT_TURBINE);
    {
        const Place pipe = place_axis(-1.45, 0, -2.40, -cos(0.21), 0, -sin(0.21));
        mesh_profile_begin(b, 0, 0);
        mesh_profile_line(b, 0, 0.25);
        mesh_profile_line(b, 0.85, 0.25);
        mesh_profile_line(b, 0.85, 0.235);
        mesh_profile_line(b, 0.30, 0.235);
        mesh_profile_line(b, 0.55, 0);
        mesh_lathe(b, pipe);
    }
}

static void build_wings_and_stores(MeshBuilder *b)
{
    /* wings: an aerofoil of eight sides, slightly tapered, leading edge first */
    static const double root[8][2] = {{2.12, -1.52}, {2.02, -1.57}, {1.80, -1.59}, {1.50, -1.56},
                                      {1.22, -1.51}, {1.50, -1.48}, {1.80, -1.47}, {2.02, -1.48}};
    static const double tip[8][2] = {{1.95, -1.52}, {1.88, -1.55}, {1.72, -1.565}, {1.50, -1.545},
                                     {1.28, -1.51}, {1.50, -1.49}, {1.72, -1.485}, {1.88, -1.49}};
    mesh_part(b, 0, "wings", "paint_olive", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        mesh_slab(b, mirrored(side), 8, root, 0.42, tip, half_span_m);
        mesh_box(b, mirrored(side), 1.45, 0.90, -1.50, 1.90, 0.95, -1.30); /* pylons */
        mesh_box(b, mirrored(side), 1.45, 1.38, -1.50, 1.90, 1.43, -1.36);
    }
    mesh_part(b, 0, "launchers", "paint_olive", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        /* four tubes outboard, open at both ends, in a frame */
        for (int i = 0; i < 4; i++) {
            const double y = side * (1.325 + 0.165 * (i % 2)), z = -1.275 + 0.18 * (i / 2);
            mesh_tube(b, place_at(0.95, y, z), 0, 1.30, 0.082, 0.076);
        }
        mesh_box(b, mirrored(side), 1.25, 1.235, -1.365, 1.32, 1.575, -1.005);
        mesh_box(b, mirrored(side), 1.88, 1.235, -1.365, 1.95, 1.575, -1.005);
        /* rocket pod inboard, rounded nose */
        const double pod_y = side * 0.925;
        mesh_profile_begin(b, 0.90, 0);
        mesh_profile_line(b, 0.90, 0.15);
        mesh_profile_line(b, 1.10, 0.20);
        mesh_profile_line(b, 2.15, 0.20);
        mesh_profile_line(b, 2.40, 0.17);
        mesh_profile_line(b, 2.40, 0);
        mesh_lathe(b, place_at(0, pod_y, -1.12));
    }
    mesh_part(b, 0, "rocket_tubes", "metal_dark", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 7; i++) {
            const double a = pi_rad / 3 * i, q = i == 6 ? 0 : 0.10;
            mesh_cylinder(b, place_at(2.38, side * 0.925 + q * cos(a), -1.12 + q * sin(a)), 0, 0.03, 0.037);
        }
}

static void build_skids(MeshBuilder *b)
{
    const double z = -skid_radius_m;
    mesh_part(b, 0, "skids", "paint_olive", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        const double y = side * half_skid_track_m;
        /* straight on the ground, the tip turned up in three steps; balls close the joints */
        const double bend[5][3] = {
            {0.10, y, z}, {3.55, y, z}, {3.85, y, z - 0.05}, {4.08, y, z - 0.16}, {4.20, y, z - 0.32}};
        for (int i = 0; i < 4; i++) {
            mesh_bar(b, bend[i], bend[i + 1], skid_radius_m);
            if (i > 0) mesh_sphere(b, place_at(bend[i][0], y, bend[i][2]), skid_radius_m);
        }
        /* cross tubes, faired */
        for (int i = 0; i < 2; i++) {
            const double x = i ? 3.05 : 0.95;
            const double leg[3][3] = {{x, y, z}, {x, side * 0.88, -0.52}, {x, side * 0.30, -0.80}};
            mesh_bar(b, leg[0], leg[1], 0.055);
            mesh_bar(b, leg[1], leg[2], 0.055);
            mesh_sphere(b, place_at(leg[1][0], leg[1][1], leg[1][2]), 0.055);
        }
    }
}

/* A blade along +x of the place, chord along y, from a root to a radius. */
static void build_blade(MeshBuilder *b, Place place, double root_m, double tip_m, double chord_m)
{
    /* slab axes: outline in (chord, thickness), drawn along the span */
    const double c = chord_m;
    const double outline[6][2] = {{0.30 * c, 0},  {0.18 * c, 0.047 * c},   {-0.05 * c, 0.047 * c},
                                  {-0.70 * c, 0}, {-0.05 * c, -0.047 * c}, {0.18 * c, -0.047 * c}};
    /* shape (x, y, z) = (chord, span, thickness) */
    const double turn[9] = {0, 1, 0, 1, 0, 0, 0, 0, 1};
    Place        along = place;
    m3_mul(along.m, place.m, turn);
    mesh_prism(b, along, 6, outline, root_m, tip_m);
}

static void build_main_rotor(MeshBuilder *b, int rotor)
{
    mesh_part(b, rotor, "hub", "metal_dark", HEAT_ROTOR);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), -0.75, 0.12, 0.065);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), 0.0, 0.18, 0.13);
    mesh_cylinder(b, place_axis(0, 0, 0.35, 0, 0, -1), 0, 0.08, 0.22); /* swash plate */
    for (int i = 0; i < 2; i++) {
        const double s = i ? -1 : 1;
        mesh_box(b, place_at(0, 0, 0), i ? -0.95 : 0.0, -0.10, -0.10, i ? 0.0 : 0.95, 0.10, 0.0);
        mesh_bar(b, (double[3]){s * 0.35, s * 0.18, -0.03}, (double[3]){s * 0.15, s * 0.15, 0.33}, 0.018);
        /* stabiliser-bar weights of the teetering hub's grips */
        mesh_cylinder(b, place_axis(s * 0.55, 0, -0.05, 0, 1, 0), -0.16, 0.16, 0.07);
    }
    mesh_part(b, rotor, "blades", "paint_olive", HEAT_ROTOR);
    for (int i = 0; i < 2; i++) {
        /* the leading edge goes ahead counter-clockwise seen from above: to the left (-y) of the blade that
         * points forward */
        const Place place = place_turned(place_at(0, 0, -0.05), (double[3]){0, 0, 1}, i * pi_rad);
        build_blade(b, place_scaled(place, 1, -1, 1), 0.75, rotor_radius_m, rotor_chord_m);
    }
}

static void build_tail_rotor(MeshBuilder *b, int rotor)
{
    mesh_part(b, rotor, "tail_blades", "paint_olive", HEAT_ROTOR);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 1, 0), -0.04, 0.07, 0.07);
    for (int i = 0; i < 2; i++) {
        /* span up or down, chord along x, thickness along y */
        const double s = i ? 1 : -1, m[9] = {0, 1, 0, 0, 0, s, s, 0, 0};
        Place        place = place_at(0, 0.02, 0);
        memcpy(place.m, m, sizeof m);
        build_blade(b, place, 0.05, tail_radius_m, 0.29);
    }
}

Status parametric_helicopter(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("helicopter", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "fuselage", -1, 0, 0, 0);
    build_fuselage(b);
    build_canopy(b);
    build_engine(b);
    build_wings_and_stores(b);
    build_skids(b);

    const int turret = mesh_node(b, "turret", 0, 5.45, 0, -0.80);
    mesh_joint(b, turret, 0, 0, 1, 4096, 11, -110 * rad_per_deg, 110 * rad_per_deg);
    mesh_part(b, turret, "chin_turret", "paint_olive", HEAT_TURRET);
    mesh_sphere(b, place_scaled(place_at(0, 0, 0), 0.30, 0.27, 0.30), 1);
    const int gun = mesh_node(b, "gun", turret, 0.12, 0, 0.10);
    mesh_joint(b, gun, 0, 1, 0, 4416, 13, -50 * rad_per_deg, 20.5 * rad_per_deg);
    mesh_part(b, gun, "chin_gun", "metal_dark", HEAT_GUN);
    for (int i = 0; i < 3; i++) { /* three barrels in a bundle, two clamps */
        const double a = 2 * pi_rad * i / 3;
        mesh_cylinder(b, place_at(0, 0.042 * cos(a), 0.042 * sin(a)), 0.10, 1.35, 0.018);
    }
    mesh_cylinder(b, place_at(0, 0, 0), 0.05, 0.35, 0.075);
    mesh_cylinder(b, place_at(0, 0, 0), 0.90, 0.96, 0.070);
    mesh_cylinder(b, place_at(0, 0, 0), 1.28, 1.33, 0.066);

    const int rotor = mesh_node(b, "main_rotor", 0, hub_x_m, 0, hub_z_m);
    mesh_joint(b, rotor, 0, 0, -1, 0, 0, 1, -1); /* about up: counter-clockwise seen from above */
    mesh_node_get(b, rotor)->spin_rps_moving = 324 * 2 * pi_rad / 60;
    build_main_rotor(b, rotor);
    const int tail = mesh_node(b, "tail_rotor", 0, tail_hub_x_m, tail_hub_y_m, tail_hub_z_m);
    mesh_joint(b, tail, 0, 1, 0, 0, 0, 1, -1);
    mesh_node_get(b, tail)->spin_rps_moving = 1654 * 2 * pi_rad / 60;
    build_tail_rotor(b, tail);
    return mesh_builder_finish(out, b);
}
