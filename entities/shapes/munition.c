/* entities/shapes/munition.c: munitions: air-to-air missile, cruise missile, ballistic missile, bomb, guided bomb,
 * shell, torpedo, mine; and the anti-tank missile in more detail.
 *
 * Published length, diameter and span (Designation-Systems.net; US Navy and USAF fact files; US Army TM 43-0001; Jane's
 * Weapons; the same in the open encyclopedias): AIM-9L/M 2.87 m long, 0.127 m across, span 0.63; BGM-109 5.56 m (6.25
 * with booster), 0.52, 2.67; R-17 (Scud B) 11.25, 0.88, span 1.81; Mk 82 2.22 (2.21 low drag), 0.273, fins 0.38;
 * GBU-12 3.27, 0.273, 1.49 fins open (folded 0.46); M107 shell 0.155 across, 0.70 long with its fuze; Mk 48 5.79,
 * 0.533; M15 mine 0.337 across, 0.124 high (0.15 with fuze); M67 grenade 0.0635 across, 0.09 high. Sections are
 * estimates.
 *
 * The base is the lowest point, as of every model; the body's axis lies along x. */

#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

typedef struct Fins {
    int    count;
    double lead0, trail0, lead1, trail1, root, tip; /* root, tip: distances from the axis */
} Fins;

typedef struct Munition {
    const char *name, *paint, *nose_paint, *fin_paint;
    double      length, radius, ogive,
        boat; /* nose's length; tapered tail's length and its end's radius: 0.6 of the body's */
    double boat_end;
    bool   round_nose, motor;
    double turn_rad; /* of the fins: pi / 4 is an X */
    Fins   fins[2];
} Munition;

static const Munition munitions[] = {
    {"missile_air",
     "paint_white_missile",
     "metal_dark",
     "paint_grey",
     2.87,
     0.0635,
     0.16,
     0,
     1,
     true,
     true,
     pi_rad / 4,
     {{4, -0.80, -1.42, -1.16, -1.42, 0.06, 0.315}, {4, 1.12, 0.86, 0.88, 0.84, 0.06, 0.275}}},
    {"missile_cruise",
     "paint_grey",
     "paint_grey",
     "paint_grey",
     5.56,
     0.26,
     0.9,
     0.9,
     0.5,
     false,
     true,
     0,
     {{4, -2.15, -2.60, -2.35, -2.62, 0.15, 0.55}, {2, 0.35, -0.15, 0.25, -0.15, 0.24, 1.335}}},
    {"missile_ballistic",
     "paint_olive",
     "paint_olive",
     "paint_olive",
     11.25,
     0.44,
     2.6,
     0.5,
     0.9,
     false,
     true,
     0,
     {{4, -4.1, -5.55, -5.2, -5.58, 0.40, 0.905}, {0}}},
    {"bomb",
     "paint_olive",
     "paint_olive",
     "paint_olive",
     2.21,
     0.1365,
     0.75,
     0.85,
     0.45,
     false,
     false,
     pi_rad / 4,
     {{4, -0.62, -1.10, -0.80, -1.10, 0.06, 0.19}, {0}}},
    {"bomb_guided",
     "paint_olive",
     "glass_window",
     "paint_olive",
     3.27,
     0.1365,
     0.45,
     0.45,
     0.7,
     false,
     false,
     pi_rad / 4,
     {{4, -1.05, -1.62, -1.35, -1.62, 0.09, 0.745}, {4, 1.20, 1.00, 1.04, 0.98, 0.08, 0.30}}},
    {"shell", "paint_olive", "steel_worn", "steel_worn", 0.70, 0.0775, 0.38, 0.09, 0.85, false, false, 0, {{0}, {0}}},
    {"torpedo",
     "paint_deck_grey",
     "rubber_black",
     "metal_dark",
     5.79,
     0.2665,
     0.30,
     1.10,
     0.35,
     true,
     false,
     0,
     {{4, -2.15, -2.62, -2.40, -2.62, 0.12, 0.265}, {0}}},
};

static void build_body(MeshBuilder *b, const Munition *m)
{
    const double half = 0.5 * m->length, r = m->radius;
    double       reach = r; /* how far below the axis anything comes */
    for (int f = 0; f < 2; f++)
        if (m->fins[f].count > 2) reach = fmax(reach, m->fins[f].tip * cos(m->turn_rad));
    const Place  axis = place_at(0, 0, -reach);
    const double shoulder = half - m->ogive;
    mesh_part(b, 0, "nose", m->nose_paint, HEAT_NOSE);
    mesh_profile_begin(b, shoulder, 0);
    mesh_profile_line(b, shoulder, r);
    if (m->round_nose && m->ogive > r) {
        mesh_profile_line(b, half - r, r);
        mesh_profile_arc(b, half - r, 0, -0.5 * pi_rad);
    } else { /* tangent ogive */
        const double bend = (m->ogive * m->ogive + r * r) / (2 * r);
        mesh_profile_arc(b, shoulder, r - bend, -asin(fmin(m->ogive / bend, 1)));
    }
    mesh_lathe(b, axis);
    mesh_part(b, 0, "body", m->paint, HEAT_AIRFRAME);
    const double end = m->motor ? -half + 0.02 * m->length : -half;
    mesh_profile_begin(b, end, 0);
    if (m->boat > 0) mesh_profile_line(b, end, m->boat_end * r);
    mesh_profile_line(b, m->boat > 0 ? -half + m->boat : end, r);
    mesh_profile_line(b, shoulder, r);
    mesh_profile_line(b, shoulder, 0);
    mesh_lathe(b, axis);
    if (m->motor) {
        mesh_part(b, 0, "nozzle", "motor_nozzle", HEAT_MOTOR);
        mesh_tube(b, axis, -half, end + 0.01 * m->length, 0.8 * m->boat_end * r, 0.6 * m->boat_end * r);
    }
    if (strcmp(m->name, "torpedo") == 0) {
        mesh_part(b, 0, "propeller", "metal_dark", HEAT_PASSIVE);
        for (int i = 0; i < 6; i++)
            parts_wing(b, place_turned(axis, (double[3]){1, 0, 0}, pi_rad * i / 3), -half + 0.20, -half + 0.05, 0.05, 0,
                       -half + 0.18, -half + 0.06, 0.22, 0, 0.1);
    }
    bool finned = false;
    for (int f = 0; f < 2; f++) {
        const Fins *fin = m->fins + f;
        for (int i = 0; i < fin->count; i++) {
            if (!finned) mesh_part(b, 0, "fins", m->fin_paint, HEAT_AIRFRAME);
            finned = true;
            const double turn = fin->count == 2 ? pi_rad * i : m->turn_rad + 2 * pi_rad * i / fin->count;
            parts_wing(b, place_turned(axis, (double[3]){1, 0, 0}, turn), fin->lead0, fin->trail0, fin->root, 0,
                       fin->lead1, fin->trail1, fin->tip, 0, 0.05);
        }
    }
}

static void build_mine(MeshBuilder *b)
{
    mesh_part(b, 0, "case", "paint_olive", HEAT_PASSIVE);
    mesh_profile_begin(b, 0, 0);
    mesh_profile_line(b, 0, 0.155);
    mesh_profile_line(b, 0.02, 0.1685);
    mesh_profile_line(b, 0.085, 0.1685);
    mesh_profile_line(b, 0.105, 0.14);
    mesh_profile_line(b, 0.105, 0);
    mesh_lathe(b, place_axis(0, 0, 0, 0, 0, -1));
    mesh_part(b, 0, "pressure_plate", "metal_dark", HEAT_PASSIVE);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), 0.10, 0.124, 0.095);
}

Status parametric_munition(Model *out, const char *name, double sag_m)
{
    const bool mine = strcmp(name, "mine") == 0;
    int        k = 0;
    while (!mine && strcmp(munitions[k].name, name) != 0) k++;
    /* calibres are small against the chord error: here no coarser than a fiftieth of the radius */
    MeshBuilder *b = mesh_builder_create(name, fmin(sag_m, 0.02 * (mine ? 0.17 : munitions[k].radius)));
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "body", -1, 0, 0, 0);
    if (mine) build_mine(b);
    else build_body(b, munitions + k);
    const Status status = mesh_builder_finish(out, b);
    if (status == STATUS_OK) out->sag_m = sag_m;
    return status;
}

/* ---- anti-tank missile ----------------------------------------------------------------------- */

/* Wire-guided anti-tank missile of the TOW class. Published for the BGM-71A: 1.17 m long, 152 mm in diameter, 0.46 m
 * across the open wings; four wings at mid body and four control fins at the tail, both as an X in flight; the flight
 * motor blows through two ports at the sides of the body between the wings, the launch motor through the tail, where
 * the beacon and the wire bobbins are too (US Army FM 3-22.34; Designation- Systems.net, M71). Sections along the body
 * are estimates.
 *
 * The base is the lowest wing tip: the axis is at 0.1626 m, and nothing has z > 0. */

static const double half_length_m = 0.585, body_radius_m = 0.076, half_span_m = 0.23;

/* A thin fin in the plane of the body axis, turned about it: 0: to the right; positive: right goes down. */
static void build_fin(MeshBuilder *b, double axis_z, double turn_rad, const double root[4][2], const double tip[4][2],
                      double from_m, double to_m)
{
    Place place = place_at(0, 0, axis_z);
    place = place_turned(place, (double[3]){1, 0, 0}, turn_rad);
    mesh_slab(b, place, 4, root, from_m, tip, to_m);
}

Status parametric_missile(Model *out, double sag_m)
{
    static const double wing_root[4][2] = {{0.16, 0.000}, {0.02, 0.004}, {-0.11, 0.000}, {0.02, -0.004}};
    static const double wing_tip[4][2] = {{-0.02, 0.000}, {-0.07, 0.002}, {-0.11, 0.000}, {-0.07, -0.002}};
    static const double fin_root[4][2] = {{-0.42, 0.000}, {-0.48, 0.004}, {-0.54, 0.000}, {-0.48, -0.004}};
    static const double fin_tip[4][2] = {{-0.48, 0.000}, {-0.51, 0.002}, {-0.54, 0.000}, {-0.51, -0.002}};
    MeshBuilder        *b = mesh_builder_create("missile", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    /* wing tips are 4 mm lozenges whose corners lie on the chord: the tip's chord is the lowest line */
    const double axis_z = -half_span_m * sqrt(0.5) - 0.002;
    const Place  axis = place_at(0, 0, axis_z);
    const double r = body_radius_m;
    const int    body = mesh_node(b, "body", -1, 0, 0, 0);

    /* warhead: a spherical cap on a cone that widens to the body */
    mesh_part(b, body, "nose", "paint_olive", HEAT_NOSE);
    {
        /* cap of radius 0.045 tangent to a cone of half angle 0.20 rad */
        static const double cap_m = 0.045, slope_rad = 0.20;
        const double        cap_x = half_length_m - cap_m;
        const double        join_x = cap_x + cap_m * sin(slope_rad), join_r = cap_m * cos(slope_rad);
        const double        base_x = join_x - (r - join_r) / tan(slope_rad);
        mesh_profile_begin(b, 0.25, 0);
        mesh_profile_line(b, 0.25, r);
        mesh_profile_line(b, base_x, r);
        mesh_profile_line(b, join_x, join_r);
        mesh_profile_arc(b, cap_x, 0, -(0.5 * pi_rad - slope_rad));
        mesh_lathe(b, axis);
    }
    mesh_part(b, body, "body", "paint_olive", HEAT_HULL);
    mesh_cylinder(b, axis, -0.585 + 0.03, -0.12, r);
    mesh_cylinder(b, axis, 0.16, 0.25, r);
    mesh_part(b, body, "motor", "paint_grey", HEAT_MOTOR);
    mesh_cylinder(b, axis, -0.12, 0.16, r);

    /* the two ports, left and right, canted back */
    mesh_part(b, body, "exhaust_ports", "motor_nozzle", HEAT_MOTOR);
    for (int side = -1; side <= 1; side += 2)
        mesh_tube(b, place_axis(0.06, 0.055 * side, axis_z, -0.5, side, 0), 0, 0.034, 0.024, 0.016);
    mesh_part(b, body, "wings", "paint_grey", HEAT_PASSIVE);
    for (int i = 0; i < 4; i++)
        build_fin(b, axis_z, (0.25 + 0.5 * i) * pi_rad, wing_root, wing_tip, 0.070, half_span_m);
    mesh_part(b, body, "fins", "paint_grey", HEAT_PASSIVE);
    for (int i = 0; i < 4; i++) build_fin(b, axis_z, (0.25 + 0.5 * i) * pi_rad, fin_root, fin_tip, 0.070, 0.17);

    mesh_part(b, body, "tail", "metal_dark", HEAT_MOTOR);
    mesh_profile_begin(b, -half_length_m + 0.04, 0);
    mesh_profile_line(b, -half_length_m + 0.004, 0.028);
    mesh_profile_line(b, -half_length_m + 0.004, 0.9 * r);
    mesh_profile_line(b, -half_length_m + 0.031, r);
    mesh_profile_line(b, -half_length_m + 0.031, 0);
    mesh_lathe(b, axis);
    /* the beacon that the launcher tracks, above the nozzle */
    mesh_part(b, body, "beacon", "glass_window", HEAT_MOTOR);
    mesh_cylinder(b, place_axis(-half_length_m, 0, axis_z - 0.048, 1, 0, 0), 0, 0.02, 0.014);
    return mesh_builder_finish(out, b);
}
