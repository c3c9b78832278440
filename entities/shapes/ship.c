/* entities/shapes/ship.c: patrol frigate of the Floreal class. Published (Jane's Fighting Ships; the same in the
 * open encyclopedias): 93.5 m long over all, 85.2 m on the waterline, 14.0 m beam, 4.3 m draught, 2,950 t at full
 * load; 100 mm gun forward (barrel 5.5 m, elevation -15 .. +80 degrees), hangar and flight deck aft, two funnels
 * side by side. The lines are drawn to those figures, with chines for the bilge's curve; superstructure, mast and
 * fittings are estimates.
 *
 * The base is the waterline: z = 0 is the sea, the hull reaches 4.3 m below it, and the origin lies half way along.
 *
 * Articulated: gun turret (4096 azimuth), gun (4416 elevation), two small guns (5696 and 5728 azimuth, 6016 and 6048
 * elevation; left, right), radar (5376 azimuth; unreported it turns at 24 rpm while the ship runs). */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

#include <stdlib.h>

static const double half_length_m = 93.5 / 2, half_beam_m = 14.0 / 2, draught_m = 4.3;
static const double stern_wl_m = -42.2, stem_wl_m = 43.0;        /* the waterline's ends: 85.2 m */
static const double fore_foot_m = 36.0, run_m = -14.0;           /* the keel is level between */
static const double deck_aft_m = 4.4, deck_m = 5.2, bow_m = 7.6; /* heights of the upper deck */
static const double bilge_power = 11; /* how full the midship section is: chosen for the displacement */

/* ---- lines -------------------------------------------------------------------------------------- */

static double smooth(double t) { return t <= 0 ? 0 : t >= 1 ? 1 : t * t * (3 - 2 * t); }

/* Keel's depth below the waterline; the transom and the raked stem are above it. */
static double keel_z(double x)
{
    if (x < run_m) return draught_m - (draught_m)*pow((run_m - x) / (run_m - stern_wl_m), 2.0);
    if (x <= fore_foot_m) return draught_m;
    if (x <= stem_wl_m) return draught_m * (1 - pow((x - fore_foot_m) / (stem_wl_m - fore_foot_m), 1.5));
    return -bow_m * (x - stem_wl_m) / (half_length_m - stem_wl_m) * 0.995;
}

static double deck_z(double x)
{
    return -(deck_m + (deck_aft_m - deck_m) * smooth((-10 - x) / 20) + (bow_m - deck_m) * smooth((x - 2) / 44.75));
}

static double deck_half_m(double x)
{
    if (x > 6) return fmax(half_beam_m * (1 - pow((x - 6) / (half_length_m - 6), 2.4)), 0.04);
    if (x < -15) return half_beam_m - 0.9 * pow((-15 - x) / (half_length_m - 15), 2);
    return half_beam_m;
}

/* Half-breadth at a share of the way from keel to deck: full and flat-sided amidships, a flared V at the bow. */
static double half_breadth_m(double x, double share)
{
    const double full = 1 - 0.97 * pow(1 - share, bilge_power), fine = 0.02 + 0.98 * share * (0.45 + 0.55 * share);
    return fmax(deck_half_m(x) * (full + smooth((x - 6) / 40) * (fine - full)), 0.02);
}

enum { levels = 5, hull_points = 2 * levels };

/* Outline of the section at x in (half-breadth, z), right side upwards and left side down again. below: from the keel
 * to the waterline; above: from the waterline (or the keel, where that is higher) to the deck. */
static void section_at(double outline[hull_points][2], double x, bool below)
{
    static const double below_share[levels] = {0, 0.14, 0.36, 0.68, 1}, above_share[levels] = {0, 0.2, 0.4, 0.7, 1};
    const double        keel = keel_z(x), deck = deck_z(x);
    const double        low = below ? keel : fmin(keel, 0), high = below ? 0 : deck;
    for (int i = 0; i < levels; i++) {
        const double z = low + (high - low) * (below ? below_share : above_share)[i];
        const double y = half_breadth_m(x, (keel - z) / (keel - deck));
        outline[i][0] = y;
        outline[i][1] = z;
        outline[hull_points - 1 - i][0] = -y;
        outline[hull_points - 1 - i][1] = z;
    }
}

/* How far facets between two sections leave the surface between the chines: bend of the chines along x (a quarter of
 * the second difference at the middle and the quarters) and half the twist of the strips between them. */
static double span_error_m(double x0, double x1, bool below)
{
    double a[hull_points][2], m[3][hull_points][2], c[hull_points][2], worst = 0;
    section_at(a, x0, below);
    section_at(c, x1, below);
    for (int k = 0; k < 3; k++) section_at(m[k], x0 + 0.25 * (k + 1) * (x1 - x0), below);
    for (int i = 0; i < levels; i++) {
        double bend = 0, twist = 0;
        for (int d = 0; d < 2; d++) {
            for (int k = 0; k < 3; k++) {
                const double chord = a[i][d] + 0.25 * (k + 1) * (c[i][d] - a[i][d]);
                bend = fmax(bend, fabs(m[k][i][d] - chord));
            }
            if (i + 1 < levels) twist = fmax(twist, fabs(c[i + 1][d] - a[i + 1][d] - c[i][d] + a[i][d]));
        }
        worst = fmax(worst, 1.4 * bend + 0.25 * twist);
    }
    return worst;
}

/* Slabs from section to section, as long as the chord error permits; they touch, so the caps between them are
 * inside. */
static void build_shell(MeshBuilder *b, double sag_m, double from_m, double to_m, bool below)
{
    const Place along = {{0, 0, 0}, {0, 1, 0, 1, 0, 0, 0, 0, 1}}; /* shape x across, y forward, z down */
    double      x = from_m, step = 2.0;
    while (x < to_m) {
        step = fmin(2 * step, 6.0);
        while (step > 0.01 && span_error_m(x, fmin(x + step, to_m), below) > sag_m) step *= 0.7;
        double next = x + step;
        if (next > to_m - 0.25 * step) next = to_m;
        double a[hull_points][2], c[hull_points][2];
        section_at(a, x, below);
        section_at(c, next, below);
        mesh_slab(b, along, hull_points, (const double(*)[2])a, x, (const double(*)[2])c, next);
        x = next;
    }
}

static void build_hull(MeshBuilder *b, double sag_m)
{
    mesh_part(b, 0, "hull", "paint_ship_grey", HEAT_HULL);
    build_shell(b, sag_m, -half_length_m, half_length_m, false);
    mesh_part(b, 0, "bottom", "paint_antifouling", HEAT_PASSIVE);
    build_shell(b, sag_m, stern_wl_m + 0.2, stem_wl_m - 0.05, true);
    /* the deck is another paint: plates a hand thick, laid on, narrower than the edge */
    mesh_part(b, 0, "deck", "paint_deck_grey", HEAT_PASSIVE);
    for (int i = 0; i < 22; i++) {
        const double x0 = -46.4 + 4.1 * i, x1 = x0 + 4.1;
        const double y0 = deck_half_m(x0) - 0.25, y1 = deck_half_m(x1) - 0.25, z0 = deck_z(x0), z1 = deck_z(x1);
        const double near[4][2] = {{-y0, z0 + 0.3}, {y0, z0 + 0.3}, {y0, z0 - 0.03}, {-y0, z0 - 0.03}};
        const double far[4][2] = {{-y1, z1 + 0.3}, {y1, z1 + 0.3}, {y1, z1 - 0.03}, {-y1, z1 - 0.03}};
        const Place  along = {{0, 0, 0}, {0, 1, 0, 1, 0, 0, 0, 0, 1}};
        if (y1 > 0.3) mesh_slab(b, along, 4, near, x0, far, x1);
    }
    /* stanchions and two wires along the edge */
    mesh_part(b, 0, "rails", "paint_ship_grey", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i < 34; i++) {
            const double x0 = -45.5 + 2.6 * i, x1 = x0 + 2.6;
            const double y0 = side * (deck_half_m(x0) - 0.12), y1 = side * (deck_half_m(x1) - 0.12);
            const double z0 = deck_z(x0), z1 = deck_z(x1);
            mesh_bar(b, (double[3]){x0, y0, z0 + 0.1}, (double[3]){x0, y0, z0 - 1.05}, 0.025);
            for (int k = 1; k <= 2; k++)
                mesh_bar(b, (double[3]){x0, y0, z0 - 0.5 * k}, (double[3]){x1, y1, z1 - 0.5 * k}, 0.012);
        }
    /* screws, shafts and rudders */
    mesh_part(b, 0, "screws", "metal_dark", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        mesh_bar(b, (double[3]){-20, side * 2.2, 3.2}, (double[3]){-35.5, side * 2.6, 3.0}, 0.16);
        mesh_sphere(b, place_scaled(place_at(-35.6, side * 2.6, 3.0), 0.55, 0.32, 0.32), 1);
        for (int i = 0; i < 4; i++) {
            const Place blade = place_turned(place_at(-35.6, side * 2.6, 3.0), (double[3]){1, 0, 0}, 0.5 * pi_rad * i);
            parts_wing(b, blade, 0.22, -0.22, 0.25, -0.1, 0.10, -0.10, 1.25, 0.1, 0.12);
        }
        mesh_box(b, parts_side(side), -38.6, 2.52, 0.6, -37.2, 2.68, 3.6);
    }
}

/* ---- what stands on the deck ---------------------------------------------------------------------- */

static void build_superstructure(MeshBuilder *b)
{
    mesh_part(b, 0, "superstructure", "paint_ship_grey", HEAT_CABIN);
    /* deckhouse of the full breadth, bridge, hangar; sides lean in */
    static const double house[6][2] = {{-21, -6.7}, {12, -6.7}, {18.8, -5.9}, {18.8, 5.9}, {12, 6.7}, {-21, 6.7}};
    static const double deckhouse_top[6][2] = {{-21, -6.2}, {12, -6.2}, {18, -5.4}, {18, 5.4}, {12, 6.2}, {-21, 6.2}};
    mesh_slab(b, parts_upright(0, 0, 0), 6, house, 4.9, deckhouse_top, 7.9);
    parts_block(b, (Rectangle){4, 17, -5.9, 5.9}, 7.85, (Rectangle){4, 15.5, -5.5, 5.5}, 10.5);
    parts_block(b, (Rectangle){6, 14.8, -5.2, 5.2}, 10.45, (Rectangle){6, 14.0, -4.9, 4.9}, 13.1);
    for (int side = -1; side <= 1; side += 2) /* bridge wings */
        mesh_box(b, parts_side(side), 11.0, 5.0, -11.6, 13.4, 6.6, -10.5);
    parts_block(b, (Rectangle){-20.8, -6, -5.2, 5.2}, 7.85, (Rectangle){-20.8, -7, -4.9, 4.9}, 12.0);
    /* hangar door's ribs, on the flight deck's side */
    for (int i = 0; i < 5; i++) mesh_box(b, place_at(0, 0, 0.75 * i), -20.86, -3.4, -11.4, -20.7, 3.4, -11.2);
    /* boats in the waist, one a side, on their cradles */
    for (int side = -1; side <= 1; side += 2) {
        mesh_box(b, parts_side(side), -3.8, 5.0, -8.5, -3.4, 5.9, -7.85);
        mesh_box(b, parts_side(side), -0.6, 5.0, -8.5, -0.2, 5.9, -7.85);
        mesh_bar(b, (double[3]){-2, side * 4.2, -7.8}, (double[3]){-2, side * 4.4, -11.5}, 0.18);
        mesh_bar(b, (double[3]){-2, side * 4.4, -11.4}, (double[3]){-2, side * 6.0, -11.9}, 0.14);
    }
    mesh_part(b, 0, "windows", "glass_window", HEAT_CABIN);
    for (int i = 0; i < 9; i++) { /* the bridge's front leans back: set each pane proud of it */
        const double        y = -4.35 + 0.97 * i;
        static const double pane[4][2] = {{14.50, -11.55}, {14.56, -11.55}, {14.25, -12.55}, {14.19, -12.55}};
        mesh_prism(b, place_at(0, 0, 0), 4, pane, y, y + 0.80);
    }
    for (int side = -1; side <= 1; side += 2) {
        for (int i = 0; i < 6; i++) {
            const double x = 7.2 + 1.1 * i;
            const double low[4][2] = {{x, 4.98}, {x + 0.85, 4.98}, {x + 0.85, 5.12}, {x, 5.12}};
            const double top[4][2] = {{x, 4.90}, {x + 0.85, 4.90}, {x + 0.85, 5.00}, {x, 5.00}};
            mesh_slab(b, parts_mirrored(parts_upright(0, 0, 0), side), 4, low, 11.55, top, 12.55);
        }
        for (int i = 0; i < 10; i++) /* scuttles along the deckhouse */
            mesh_cylinder(b, place_axis(-18 + 3.4 * i, side * 6.45, -6.6, 0, side, 0), -0.2, 0.05, 0.20);
    }
    mesh_part(b, 0, "boats", "rubber_black", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        const double y = side * 5.5;
        parts_limb(b, (double[3]){-4.8, y - 0.75, -8.8}, 0.28, (double[3]){0.2, y - 0.70, -8.8}, 0.26);
        parts_limb(b, (double[3]){-4.8, y + 0.75, -8.8}, 0.28, (double[3]){0.2, y + 0.70, -8.8}, 0.26);
        parts_limb(b, (double[3]){0.2, y - 0.70, -8.8}, 0.26, (double[3]){1.4, y, -9.0}, 0.24);
        parts_limb(b, (double[3]){0.2, y + 0.70, -8.8}, 0.26, (double[3]){1.4, y, -9.0}, 0.24);
        mesh_box(b, place_at(0, y, 0), -4.7, -0.7, -8.75, 0.6, 0.7, -8.5);
    }
    mesh_part(b, 0, "missile_boxes", "paint_ship_grey", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) { /* pairs behind the bridge, firing out to either side */
        const Place tube = place_axis(2.2 - 1.0 * side, -side * 2.2, -8.5, 0, side, -0.22);
        mesh_box(b, tube, 0, -0.4, -0.4, 5.2, 0.4, 0.4);
    }
}

static void build_funnels(MeshBuilder *b)
{
    mesh_part(b, 0, "funnels", "paint_ship_grey", HEAT_ENGINE_DECK);
    for (int side = -1; side <= 1; side += 2) {
        const double low[4][2] = {{-6.6, 2.2}, {-2.6, 2.2}, {-2.6, 4.6}, {-6.6, 4.6}};
        const double top[4][2] = {{-6.4, 2.5}, {-3.6, 2.5}, {-3.6, 4.3}, {-6.4, 4.3}};
        mesh_slab(b, parts_mirrored(parts_upright(0, 0, 0), side), 4, low, 7.85, top, 14.6);
    }
    mesh_part(b, 0, "uptakes", "metal_dark", HEAT_EXHAUST);
    for (int side = -1; side <= 1; side += 2) {
        mesh_box(b, parts_side(side), -6.3, 2.6, -14.75, -3.7, 4.2, -14.55);
        for (int i = 0; i < 2; i++)
            mesh_tube(b, place_axis(-5.7 + 1.3 * i, side * 3.4, -14.5, -0.25, 0, -1), 0, 1.0, 0.45, 0.40);
    }
}

static void build_mast(MeshBuilder *b)
{
    mesh_part(b, 0, "mast", "paint_ship_grey", HEAT_PASSIVE);
    parts_block(b, (Rectangle){3.6, 7.2, -1.6, 1.6}, 10.4, (Rectangle){4.9, 6.3, -0.7, 0.7}, 19.0);
    mesh_cylinder(b, place_axis(5.5, 0, -18.9, 0, 0, -1), 0, 7.6, 0.22);
    mesh_box(b, place_at(0, 0, 0), 4.6, -1.5, -19.2, 7.6, 1.5, -18.95); /* platform */
    for (int i = 0; i < 3; i++) {
        const double z = -20.6 - 1.7 * i, y = 3.6 - 0.8 * i;
        mesh_bar(b, (double[3]){5.5, -y, z}, (double[3]){5.5, y, z}, 0.09);
        for (int side = -1; side <= 1; side += 2)
            mesh_cylinder(b, place_axis(5.5, side * (y - 0.1), z, 0, 0, -1), -0.4, 1.3, 0.035);
    }
    /* whips, ensign staff */
    for (int side = -1; side <= 1; side += 2)
        mesh_bar(b, (double[3]){-9, side * 4.4, -11.9}, (double[3]){-9.5, side * 5.6, -19.5}, 0.03);
    mesh_bar(b, (double[3]){-46.3, 0, -4.3}, (double[3]){-46.6, 0, -8.0}, 0.04);
    mesh_part(b, 0, "radomes", "radome_glass_fibre", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        mesh_cylinder(b, place_axis(-10.5, side * 3.2, -11.9, 0, 0, -1), 0, 1.0, 0.35);
        mesh_sphere(b, place_at(-10.5, side * 3.2, -13.5), 0.85);
    }
    mesh_sphere(b, place_at(5.5, 0, -26.6), 0.30);
    /* fire-control director over the bridge */
    mesh_cylinder(b, place_axis(12.0, 0, -13.0, 0, 0, -1), 0, 1.2, 0.55);
    mesh_sphere(b, place_scaled(place_at(12.2, 0, -14.7), 0.75, 0.65, 0.75), 1);
}

static void build_gun_mount(MeshBuilder *b, int mount)
{
    mesh_part(b, mount, "gun_turret", "paint_ship_grey", HEAT_TURRET);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), -0.4, 0.35, 1.75);
    /* faceted gun house, 3.2 m high */
    parts_block(b, (Rectangle){-2.1, 2.1, -1.75, 1.75}, 0.30, (Rectangle){-2.1, 1.9, -1.7, 1.7}, 1.60);
    parts_block(b, (Rectangle){-2.1, 1.9, -1.7, 1.7}, 1.60, (Rectangle){-1.6, 0.5, -1.1, 1.1}, 3.20);
    mesh_sphere(b, place_at(-0.6, -0.55, -3.15), 0.38);
}

static void build_gun(MeshBuilder *b, int gun)
{
    mesh_part(b, gun, "mantlet", "paint_ship_grey", HEAT_TURRET);
    mesh_box(b, place_at(0, 0, 0), -0.4, -0.32, -0.36, 0.75, 0.32, 0.36);
    mesh_part(b, gun, "barrel", "paint_ship_grey", HEAT_GUN);
    mesh_profile_begin(b, 0.6, 0);
    mesh_profile_line(b, 0.6, 0.16);
    mesh_profile_line(b, 2.2, 0.14);
    mesh_profile_line(b, 2.3, 0.105);
    mesh_profile_line(b, 5.3, 0.085);
    mesh_profile_line(b, 5.3, 0.13);
    mesh_profile_line(b, 5.75, 0.13);
    mesh_profile_line(b, 5.75, 0.05);
    mesh_profile_line(b, 5.2, 0.05);
    mesh_profile_line(b, 5.2, 0);
    mesh_lathe(b, place_at(0, 0, 0));
}

/* Search radar: a slatted cut of a cylinder, 4.2 m wide, on its pedestal. */
static void build_radar(MeshBuilder *b, int radar)
{
    mesh_part(b, radar, "radar", "metal_dark", HEAT_PASSIVE);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), -0.05, 0.55, 0.22);
    for (int i = 0; i < 6; i++) {
        const double z = -0.70 - 0.24 * i, x = 0.35 - 0.05 * (i - 2.5) * (i - 2.5);
        for (int k = -3; k < 3; k++) {
            const double y0 = 0.7 * k, y1 = y0 + 0.7, x0 = x + 0.10 * y0 * y0 - 0.4, x1 = x + 0.10 * y1 * y1 - 0.4;
            mesh_bar(b, (double[3]){x0, y0, z}, (double[3]){x1, y1, z}, 0.05);
        }
    }
    for (int k = -3; k <= 3; k++) {
        const double y = 0.7 * k;
        mesh_bar(b, (double[3]){0.10 * y * y - 0.25, y, -0.62}, (double[3]){0.10 * y * y - 0.25, y, -2.0}, 0.045);
    }
    mesh_bar(b, (double[3]){-0.1, 0, -0.5}, (double[3]){0.95, 0, -0.75}, 0.06); /* feed */
    mesh_box(b, place_at(0, 0, 0), 0.90, -0.35, -1.0, 1.10, 0.35, -0.65);
}

Status parametric_ship(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("ship", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "hull", -1, 0, 0, 0);
    build_hull(b, sag_m);
    build_superstructure(b);
    build_funnels(b);
    build_mast(b);

    static const double gun_x_m = 27.5;
    const int           mount = mesh_node(b, "turret", 0, gun_x_m, 0, deck_z(gun_x_m));
    mesh_joint(b, mount, 0, 0, 1, 4096, 11, 1, -1);
    build_gun_mount(b, mount);
    const int gun = mesh_node(b, "gun", mount, 1.35, 0, -1.75);
    mesh_joint(b, gun, 0, 1, 0, 4416, 13, -15 * rad_per_deg, 80 * rad_per_deg);
    build_gun(b, gun);
    for (int side = -1; side <= 1; side += 2) {
        const int ring = mesh_node(b, side < 0 ? "mount_left" : "mount_right", 0, 2.0, side * 5.3, -10.5 + 2.6);
        mesh_joint(b, ring, 0, 0, 1, side < 0 ? 5696 : 5728, 11, 1, -1);
        mesh_part(b, ring, "small_mount", "paint_ship_grey", HEAT_PASSIVE);
        mesh_cone(b, place_axis(0, 0, 0, 0, 0, -1), -0.1, 0.35, 0.9, 0.18);
        mesh_box(b, place_at(0, 0, 0), 0.15, -0.45, -1.55, 0.20, 0.45, -0.80); /* shield */
        const int small = mesh_node(b, side < 0 ? "small_gun_left" : "small_gun_right", ring, 0, 0, -1.0);
        mesh_joint(b, small, 0, 1, 0, side < 0 ? 6016 : 6048, 13, -10 * rad_per_deg, 60 * rad_per_deg);
        mesh_part(b, small, "small_gun", "metal_dark", HEAT_GUN);
        mesh_box(b, place_at(0, 0, 0), -0.5, -0.08, -0.10, 0.5, 0.08, 0.10);
        mesh_cylinder(b, place_at(0, 0, 0), 0.45, 2.0, 0.025);
    }
    const int radar = mesh_node(b, "radar", 0, 6.7, 0, -19.2);
    mesh_joint(b, radar, 0, 0, 1, 5376, 11, 1, -1);
    mesh_node_get(b, radar)->spin_rps_moving = 24 * 2 * pi_rad / 60;
    build_radar(b, radar);
    return mesh_builder_finish(out, b);
}
