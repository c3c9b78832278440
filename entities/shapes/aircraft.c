/* entities/shapes/aircraft.c: single-engined fighter of the F-16C class. Published (USAF fact sheet; Jane's All the
 * World's Aircraft; the same in the open encyclopedias): 15.06 m long, span 9.45 m over the tip rails, 5.09 m high,
 * wing area 27.87 m2 at aspect ratio 3.0, taper 0.21 and 40 degrees of leading-edge sweep (so span 9.144 m, centre
 * chord 5.04 m, tip 1.06 m), tailplane 5.58 m, wheel track 2.36 m, wheel base 4.00 m. Intake under the chin, bubble
 * canopy, ventral fins, nozzle 1.0 m across. Sections of the body are estimates from three-view drawings. Bombers,
 * cargo and other fixed-wing aircraft get this shape too, as there is no larger one.
 *
 * The base is the ground under the extended wheels. At rest the gear is up (a reported 3072 landing gear position of 1,
 * or slow flight unreported, puts it down), so the lowest point at rest is the belly.
 *
 * Articulated: flaperons (1120 and 1152, elevation), stabilators (1408 and 1440, elevation), rudder (1024, azimuth),
 * landing gear (3072, position). All turn right-handed about body y and z: elevation up takes a trailing edge down,
 * rudder azimuth takes its trailing edge to the left. */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

static const double half_length_m = 15.06 / 2, half_span_m = 9.144 / 2, half_rails_m = 9.45 / 2, height_m = 5.09;
static const double centre_chord_m = 5.04, tip_chord_m = 1.056, sweep_rad = 40 * rad_per_deg;
static const double wing_lead_x_m = 2.15, wing_z_m = -2.02; /* of the leading edge produced to the middle */
static const double wing_root_m = 0.62, flap_in_m = 0.80, flap_out_m = 2.95, flap_share = 0.22;
static const double tail_pivot_x_m = -6.25, tail_z_m = -1.95, tail_root_m = 0.80, half_tail_m = 5.58 / 2;
static const double half_track_m = 1.18, main_x_m = -0.95, nose_x_m = 3.05;
static const double main_radius_m = 0.33, nose_radius_m = 0.23;

static double wing_lead(double y) { return wing_lead_x_m - y * tan(sweep_rad); }
static double wing_chord(double y) { return centre_chord_m + (tip_chord_m - centre_chord_m) * y / half_span_m; }
static double wing_trail(double y) { return wing_lead(y) - wing_chord(y); }
static double wing_hinge(double y) { return wing_trail(y) + flap_share * wing_chord(y); }

static void build_fuselage(MeshBuilder *b)
{
    const Place here = place_at(0, 0, 0);
    /* after body around the duct and engine */
    static const Station after[7] = {{-6.45, 0.54, -2.46, -1.38, 1.0}, {-5.60, 0.60, -2.53, -1.30, 0.95},
                                     {-4.0, 0.66, -2.60, -1.18, 0.85}, {-2.0, 0.72, -2.64, -1.06, 0.7},
                                     {0.0, 0.74, -2.66, -1.00, 0.7},   {1.5, 0.68, -2.66, -1.00, 0.75},
                                     {2.6, 0.52, -2.60, -1.06, 0.85}};
    static const Station fore[7] = {{-0.5, 0.50, -2.78, -1.80, 0.9},  {1.5, 0.52, -2.72, -1.72, 0.85},
                                    {3.2, 0.49, -2.62, -1.62, 0.8},   {4.4, 0.45, -2.48, -1.60, 0.85},
                                    {5.3, 0.38, -2.32, -1.60, 0.95},  {5.9, 0.32, -2.20, -1.60, 1.0},
                                    {6.05, 0.305, -2.17, -1.605, 1.0}};
    /* hump behind the canopy, down to the fin */
    static const Station spine[5] = {{-4.2, 0.16, -2.78, -2.4, 0.9},
                                     {-2.0, 0.24, -2.86, -2.4, 0.9},
                                     {0.2, 0.32, -2.92, -2.4, 0.9},
                                     {1.6, 0.36, -2.98, -2.4, 0.9},
                                     {2.2, 0.36, -2.96, -2.4, 0.9}};
    mesh_part(b, 0, "fuselage", "paint_air_grey", HEAT_AIRFRAME);
    mesh_loft(b, here, after, 7);
    mesh_loft(b, here, fore, 7);
    mesh_loft(b, here, spine, 5);
    /* shelves beside the nozzle that end in the speed brakes; the tail planes turn in them */
    for (int side = -1; side <= 1; side += 2) {
        static const double root[6][2] = {{-1.6, -2.02},  {-3.0, -2.14}, {-6.2, -2.10},
                                          {-7.15, -1.98}, {-6.2, -1.86}, {-3.0, -1.88}};
        static const double edge[6][2] = {{-2.2, -2.02},  {-3.2, -2.10}, {-6.2, -2.06},
                                          {-7.05, -1.98}, {-6.2, -1.90}, {-3.2, -1.92}};
        mesh_slab(b, parts_side(side), 6, root, 0.45, edge, tail_root_m - 0.02);
        /* strakes: sharp edges from the canopy to the wing */
        static const double strake[5][2] = {{5.0, 0.38}, {3.4, 0.62}, {1.9, 1.04}, {0.4, 1.10}, {0.4, 0.40}};
        static const double edge_top[5][2] = {{4.9, 0.38}, {3.35, 0.60}, {1.9, 1.00}, {0.4, 1.06}, {0.4, 0.40}};
        mesh_slab(b, parts_mirrored(parts_upright(0, 0, wing_z_m), side), 5, strake, -0.03, edge_top, 0.05);
    }
    mesh_part(b, 0, "radome", "radome_glass_fibre", HEAT_NOSE);
    {
        const Station nose[4] = {{6.05, 0.300, -2.165, -1.610, 1.0},
                                 {6.6, 0.215, -2.09, -1.68, 1.0},
                                 {7.0, 0.120, -2.00, -1.76, 1.0},
                                 {7.20, 0.030, -1.91, -1.85, 1.0}};
        mesh_loft(b, here, nose, 4);
    }
    mesh_part(b, 0, "pitot", "steel_worn", HEAT_NOSE);
    mesh_cone(b, place_at(7.18, 0, -1.88), 0, 0.024, half_length_m - 7.18, 0.006);

    /* intake: a duct under the nose, its mouth dark behind a lip */
    mesh_part(b, 0, "intake", "paint_air_grey", HEAT_AIRFRAME);
    static const Station duct[3] = {
        {0.6, 0.60, -1.80, -0.99, 0.7}, {2.2, 0.56, -1.72, -0.96, 0.75}, {3.25, 0.50, -1.56, -0.97, 0.9}};
    mesh_loft(b, here, duct, 3);
    mesh_box(b, here, 2.2, -0.20, -1.66, 3.30, 0.20, -1.50); /* diverter under the nose */
    mesh_part(b, 0, "intake_mouth", "metal_dark", HEAT_AIRFRAME);
    static const Station mouth[2] = {{3.10, 0.46, -1.51, -1.02, 0.95}, {3.262, 0.46, -1.51, -1.02, 0.95}};
    mesh_loft(b, here, mouth, 2);
}

static void build_engine(MeshBuilder *b)
{
    mesh_part(b, 0, "engine_bay", "nozzle_steel", HEAT_ENGINE_DECK);
    static const Station bay[2] = {{-6.60, 0.535, -2.45, -1.40, 1.0}, {-6.35, 0.55, -2.47, -1.37, 1.0}};
    mesh_loft(b, place_at(0, 0, 0), bay, 2);
    /* petals that narrow backwards, open to the turbine a metre inside; ribs so that they show */
    const Place aft = place_axis(-6.55, 0, -1.925, -1, 0, 0);
    mesh_part(b, 0, "nozzle", "nozzle_steel", HEAT_TURBINE);
    mesh_profile_begin(b, 0, 0);
    mesh_profile_line(b, 0, 0.52);
    mesh_profile_line(b, 0.70, 0.42);
    mesh_profile_line(b, 0.70, 0.40);
    mesh_profile_line(b, 0.05, 0.46);
    mesh_profile_line(b, 0.05, 0);
    mesh_lathe(b, aft);
    for (int i = 0; i < 14; i++) {
        const double a = 2 * pi_rad * i / 14;
        const double p[3] = {-6.57, 0.515 * cos(a), -1.925 + 0.515 * sin(a)};
        const double q[3] = {-7.24, 0.417 * cos(a), -1.925 + 0.417 * sin(a)};
        mesh_bar(b, p, q, 0.018);
    }
    mesh_part(b, 0, "turbine", "motor_nozzle", HEAT_TURBINE);
    mesh_cone(b, aft, 0.04, 0.30, 0.45, 0.06);
}

static void build_canopy(MeshBuilder *b)
{
    static const Station glass[6] = {{2.15, 0.30, -2.96, -2.45, 0.9},  {2.80, 0.37, -3.08, -2.45, 0.95},
                                     {3.50, 0.39, -3.10, -2.40, 0.95}, {4.20, 0.37, -2.96, -2.36, 0.95},
                                     {4.90, 0.28, -2.68, -2.30, 1.0},  {5.45, 0.10, -2.36, -2.26, 1.0}};
    mesh_part(b, 0, "canopy", "glass_window", HEAT_AIRFRAME);
    mesh_loft(b, place_at(0, 0, 0), glass, 6);
    mesh_part(b, 0, "canopy_frame", "paint_air_grey", HEAT_AIRFRAME);
    Station hoop[2];
    for (int k = 0; k < 2; k++) {
        hoop[k] = mesh_station_at(glass, 6, 2.62 + 0.09 * k);
        hoop[k].half_width += 0.012;
        hoop[k].top -= 0.012;
    }
    mesh_loft(b, place_at(0, 0, 0), hoop, 2);
}

static void build_wings(MeshBuilder *b)
{
    mesh_part(b, 0, "wings", "paint_air_grey", HEAT_AIRFRAME);
    for (int side = -1; side <= 1; side += 2) {
        const Place at = parts_side(side);
        /* inboard of the flaperon, before it, and outboard of it */
        parts_wing(b, at, wing_lead(wing_root_m), wing_trail(wing_root_m), wing_root_m, wing_z_m, wing_lead(flap_in_m),
                   wing_trail(flap_in_m), flap_in_m, wing_z_m, 0.04);
        parts_wing(b, at, wing_lead(flap_in_m), wing_hinge(flap_in_m), flap_in_m, wing_z_m, wing_lead(flap_out_m),
                   wing_hinge(flap_out_m), flap_out_m, wing_z_m, 0.05);
        parts_wing(b, at, wing_lead(flap_out_m), wing_trail(flap_out_m), flap_out_m, wing_z_m, wing_lead(half_span_m),
                   wing_trail(half_span_m), half_span_m, wing_z_m, 0.04);
        /* tip rail */
        mesh_profile_begin(b, -2.95, 0);
        mesh_profile_line(b, -2.95, 0.5 * (half_rails_m - half_span_m));
        mesh_profile_line(b, -1.30, 0.5 * (half_rails_m - half_span_m));
        mesh_profile_line(b, -1.00, 0);
        mesh_lathe(b, place_at(0, side * 0.5 * (half_span_m + half_rails_m), wing_z_m));
        /* pylons */
        mesh_box(b, at, -1.6, 1.80, wing_z_m + 0.02, 0.1, 1.86, wing_z_m + 0.24);
        mesh_box(b, at, -1.9, 3.00, wing_z_m + 0.02, -0.6, 3.06, wing_z_m + 0.22);
    }
    mesh_part(b, 0, "tanks", "paint_air_grey", HEAT_AIRFRAME);
    for (int side = -1; side <= 1; side += 2) { /* 370 gallons: 5.0 m by 0.66 m */
        mesh_profile_begin(b, -3.6, 0);
        mesh_profile_line(b, -2.4, 0.25);
        mesh_profile_line(b, -1.6, 0.33);
        mesh_profile_line(b, -0.1, 0.33);
        mesh_profile_line(b, 0.8, 0.22);
        mesh_profile_line(b, 1.4, 0);
        mesh_lathe(b, place_at(0, side * 1.83, wing_z_m + 0.55));
    }
}

static void build_fin(MeshBuilder *b)
{
    const Place up = parts_upright(0, 0, 0);
    mesh_part(b, 0, "fin", "paint_air_grey", HEAT_AIRFRAME);
    /* base fairing, and the fixed part: from 2.55 m to the top, ahead of the rudder */
    static const Station base[4] = {{-6.75, 0.09, -2.66, -2.40, 0.8},
                                    {-6.0, 0.17, -2.80, -2.40, 0.8},
                                    {-4.0, 0.19, -2.86, -2.40, 0.8},
                                    {-2.6, 0.08, -2.80, -2.40, 0.9}};
    mesh_loft(b, place_at(0, 0, 0), base, 4);
    parts_wing(b, up, -3.30, -6.72, 2.55, 0, -3.62, -6.74, 2.92, 0, 0.04);
    parts_wing(b, up, -3.62, -5.97, 2.92, 0, -5.32, -6.68, 4.72, 0, 0.05);
    parts_wing(b, up, -5.32, -7.10, 4.72, 0, -5.70, -7.18, height_m, 0, 0.05);
    for (int side = -1; side <= 1; side += 2) {
        /* ventral fins: 0.5 m deep, canted out by 15 degrees */
        Place down = parts_upright(0, side * 0.52, -1.25);
        down = place_turned(down, (double[3]){1, 0, 0}, pi_rad - side * 15 * rad_per_deg);
        parts_wing(b, down, -4.35, -5.75, 0, 0, -4.75, -5.75, 0.48, 0, 0.04);
    }
}

/* Leg and wheel of one unit. Geometry is drawn extended, in body directions, from the pivot; the joint swings it up by
 * `swing` about the axis, and a DIS position of 1 (or slow flight) down again. */
typedef struct Gear {
    const char *name;
    double      p[3], wheel[3], stowed[3]; /* pivot; axle from the pivot, extended and stowed (any length) */
    double      radius_m, half_width_m;
} Gear;

static void build_gear(MeshBuilder *b, const Gear *g, int side)
{
    double from[3] = {0}, to[3] = {0}, axis[3] = {0};
    v3_normalize(from, g->wheel);
    v3_normalize(to, g->stowed);
    v3_cross(axis, to, from);
    v3_normalize(axis, axis);
    const double swing = acos(clamp(v3_dot(from, to), -1, 1));
    const int    leg = mesh_node(b, g->name, 0, g->p[0], g->p[1], g->p[2]);
    mesh_joint(b, leg, axis[0], axis[1], axis[2], 3072, 1, 0, swing);
    ModelNode *node = mesh_node_get(b, leg);
    node->dis_scale = node->value_slow = swing;
    const Place stowed = place_turned(place_at(0, 0, 0), axis, -swing);
    memcpy(node->r_parent_from_node, stowed.m, sizeof stowed.m);

    mesh_part(b, leg, "gear_leg", "paint_white_missile", HEAT_PASSIVE);
    const double hub[3] = {g->wheel[0], g->wheel[1] - (side ? side : 1) * (g->half_width_m + 0.04), g->wheel[2]};
    mesh_bar(b, (double[3]){0, 0, 0}, hub, 0.05); /* the leg stands beside the wheel */
    mesh_bar(b, hub, g->wheel, 0.04);
    const int wheel =
        parts_wheel_node(b, leg, "wheel", side, side == 0 ? 1 : 0, g->wheel[0], g->wheel[1], g->wheel[2], g->radius_m);
    const Place across = place_axis(0, 0, 0, 0, 1, 0);
    mesh_part(b, wheel, "wheel", "rubber_black", HEAT_WHEEL);
    mesh_tube(b, across, -g->half_width_m, g->half_width_m, g->radius_m, 0.55 * g->radius_m);
    mesh_part(b, wheel, "rim", "paint_white_missile", HEAT_WHEEL);
    parts_disc(b, across, 0.56 * g->radius_m, 0.8 * g->half_width_m, 5);
}

Status parametric_aircraft(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("aircraft", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "fuselage", -1, 0, 0, 0);
    build_fuselage(b);
    build_engine(b);
    build_canopy(b);
    build_wings(b);
    build_fin(b);

    for (int side = -1; side <= 1; side += 2) {
        const double y = 0.5 * (flap_in_m + flap_out_m), x = wing_hinge(y);
        const int    flap = mesh_node(b, side < 0 ? "flaperon_left" : "flaperon_right", 0, x, side * y, wing_z_m);
        double       axis[3] = {side * (wing_hinge(flap_out_m) - wing_hinge(flap_in_m)), flap_out_m - flap_in_m, 0};
        v3_normalize(axis, axis);
        mesh_joint(b, flap, axis[0], axis[1], axis[2], side < 0 ? 1120 : 1152, 13, -23 * rad_per_deg, 20 * rad_per_deg);
        mesh_part(b, flap, "flaperon", "paint_air_grey", HEAT_AIRFRAME);
        /* drawn mirrored about the node: its own y runs outwards */
        parts_wing(b, parts_side(side), wing_hinge(flap_in_m) - x, wing_trail(flap_in_m) - x, flap_in_m + 0.01 - y, 0,
                   wing_hinge(flap_out_m) - x, wing_trail(flap_out_m) - x, flap_out_m - 0.01 - y, 0, 0.09);
    }
    for (int side = -1; side <= 1; side += 2) {
        /* all-moving, drooping 10 degrees outwards */
        const char *name = side < 0 ? "stabilator_left" : "stabilator_right";
        const int   tail = mesh_node(b, name, 0, tail_pivot_x_m, 0, tail_z_m);
        mesh_joint(b, tail, 0, 1, 0, side < 0 ? 1408 : 1440, 13, -25 * rad_per_deg, 25 * rad_per_deg);
        mesh_part(b, tail, "stabilator", "paint_air_grey", HEAT_AIRFRAME);
        parts_wing(b, parts_side(side), 1.35, -0.95, tail_root_m, 0, -0.32, -half_length_m - tail_pivot_x_m,
                   half_tail_m, (half_tail_m - tail_root_m) * tan(10 * rad_per_deg), 0.045);
    }
    const int rudder = mesh_node(b, "rudder", 0, -6.325, 0, -3.82);
    double    hinge[3] = {-6.68 + 5.97, 0, -(4.72 - 2.92)};
    v3_normalize(hinge, hinge);
    mesh_joint(b, rudder, -hinge[0], 0, -hinge[2], 1024, 11, -30 * rad_per_deg, 30 * rad_per_deg);
    mesh_part(b, rudder, "rudder", "paint_air_grey", HEAT_AIRFRAME);
    parts_wing(b, parts_upright(0, 0, 0), 0.35, -0.40, 2.93 - 3.82, 0, -0.355, -0.775, 4.71 - 3.82, 0, 0.10);

    const double main_drop = 1.70, nose_drop = 1.55;
    for (int side = -1; side <= 1; side += 2) {
        const Gear main = {side < 0 ? "gear_left" : "gear_right",
                           {main_x_m, side * 0.40, -main_drop},
                           {0, side * (half_track_m - 0.40), main_drop - main_radius_m},
                           {1.0, -side * 0.12, 0.02},
                           main_radius_m,
                           0.11};
        build_gear(b, &main, side);
    }
    const Gear nose = {
        "gear_nose", {nose_x_m, 0, -nose_drop}, {0, 0, nose_drop - nose_radius_m}, {-1, 0, -0.05}, nose_radius_m, 0.08};
    build_gear(b, &nose, 0);
    return mesh_builder_finish(out, b);
}
