/* entities/shapes/countryside.c: cow, sheep, deer; hay bale; camp fire, burning barrel, smouldering heap.
 *
 * Sizes: cow: a dairy cow 2.5 m long, 1.45 m at the withers (Holstein: 1.45 .. 1.50, breed standards); sheep: 1.2 m
 * long, 0.7 m at the withers; deer: roe deer 1.2 m long, 0.72 m at the shoulder (Apollonio et al., European Ungulates,
 * 2010); bale: round, 1.25 m across, 1.2 m wide (makers' data); campfire: a bed of embers of 0.9 m with split logs and
 * flames to 0.85 m; barrel: 200 l drum 0.88 m high, 0.585 m across (ISO 15750), flames 0.5 m over its rim; smoulder: a
 * heap 3 m across, 1.1 m high, estimate. Wool, hide and fur are cloth over a body for their heat. */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

static void limb(MeshBuilder *b, double x0, double y0, double h0, double r0, double x1, double y1, double h1, double r1)
{
    parts_limb(b, (double[3]){x0, y0, -h0}, r0, (double[3]){x1, y1, -h1}, r1);
}

/* Four legs of two pieces each, and hooves that make the ground. */
static void legs(MeshBuilder *b, double front_x, double rear_x, double y, double hip_m, double radius, const char *hide)
{
    mesh_part(b, 0, "legs", hide, HEAT_CLOTHING);
    for (int side = -1; side <= 1; side += 2) {
        limb(b, front_x, side * y, hip_m, 1.7 * radius, front_x + 0.02, side * y, 0.5 * hip_m, radius);
        limb(b, front_x + 0.02, side * y, 0.5 * hip_m, radius, front_x, side * y, 1.6 * radius, 0.8 * radius);
        limb(b, rear_x, side * y, hip_m, 2.2 * radius, rear_x - 0.12 * hip_m, side * y, 0.5 * hip_m, radius);
        limb(b, rear_x - 0.12 * hip_m, side * y, 0.5 * hip_m, radius, rear_x - 0.06 * hip_m, side * y, 1.6 * radius,
             0.8 * radius);
    }
    mesh_part(b, 0, "hooves", "metal_dark", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2)
        for (int rear = 0; rear < 2; rear++) {
            const double x = rear ? rear_x - 0.06 * hip_m : front_x, r = 1.1 * radius;
            parts_box(b, x - r, x + 1.2 * r, side * y - r, side * y + r, 0, 1.2 * radius);
        }
}

static void build_cow(MeshBuilder *b)
{
    const Station trunk[6] = {{-0.82, 0.16, -1.36, -0.98, 0.9}, {-0.66, 0.27, -1.44, -0.82, 0.8},
                              {-0.20, 0.37, -1.41, -0.62, 0.9}, {0.30, 0.35, -1.42, -0.60, 0.9},
                              {0.66, 0.25, -1.46, -0.72, 0.9},  {0.86, 0.14, -1.40, -0.92, 1}};
    mesh_part(b, 0, "body", "hide_brown", HEAT_CLOTHING);
    mesh_loft(b, place_at(0, 0, 0), trunk, 6);
    limb(b, 0.72, 0, 1.22, 0.20, 1.12, 0, 1.34, 0.14);
    mesh_part(b, 0, "head", "hide_brown", HEAT_CLOTHING);
    limb(b, 1.14, 0, 1.38, 0.135, 1.50, 0, 1.12, 0.085);
    for (int side = -1; side <= 1; side += 2) {
        limb(b, 1.10, side * 0.10, 1.46, 0.035, 1.08, side * 0.26, 1.43, 0.05);
        limb(b, 1.12, side * 0.08, 1.50, 0.03, 1.16, side * 0.17, 1.60, 0.012);
    }
    mesh_part(b, 0, "udder", "skin", HEAT_SKIN);
    limb(b, -0.52, -0.08, 0.66, 0.15, -0.52, 0.08, 0.66, 0.15);
    limb(b, 1.52, 0, 1.11, 0.06, 1.55, 0, 1.09, 0.055); /* muzzle */
    mesh_part(b, 0, "tail", "hide_brown", HEAT_PASSIVE);
    limb(b, -0.84, 0, 1.34, 0.03, -0.93, 0, 0.75, 0.025);
    limb(b, -0.93, 0, 0.75, 0.045, -0.94, 0, 0.55, 0.03);
    legs(b, 0.52, -0.62, 0.17, 0.78, 0.055, "hide_brown");
}

static void build_sheep(MeshBuilder *b)
{
    const Station fleece[5] = {{-0.50, 0.12, -0.66, -0.42, 1},
                               {-0.36, 0.23, -0.72, -0.30, 0.95},
                               {0.00, 0.26, -0.73, -0.28, 0.95},
                               {0.34, 0.21, -0.72, -0.32, 0.95},
                               {0.46, 0.12, -0.68, -0.44, 1}};
    mesh_part(b, 0, "fleece", "wool", HEAT_CLOTHING);
    mesh_loft(b, place_at(0, 0, 0), fleece, 5);
    limb(b, 0.38, 0, 0.60, 0.13, 0.54, 0, 0.72, 0.09);
    mesh_part(b, 0, "head", "hide_brown", HEAT_SKIN);
    limb(b, 0.54, 0, 0.76, 0.075, 0.72, 0, 0.66, 0.045);
    for (int side = -1; side <= 1; side += 2) limb(b, 0.53, side * 0.06, 0.80, 0.02, 0.51, side * 0.15, 0.78, 0.025);
    legs(b, 0.28, -0.32, 0.11, 0.34, 0.026, "hide_brown");
}

static void build_deer(MeshBuilder *b)
{
    const Station trunk[5] = {{-0.44, 0.08, -0.74, -0.56, 0.9},
                              {-0.32, 0.14, -0.76, -0.48, 0.9},
                              {0.00, 0.15, -0.73, -0.42, 0.95},
                              {0.28, 0.13, -0.73, -0.44, 0.95},
                              {0.42, 0.08, -0.72, -0.54, 1}};
    mesh_part(b, 0, "body", "hide_brown", HEAT_CLOTHING);
    mesh_loft(b, place_at(0, 0, 0), trunk, 5);
    limb(b, 0.38, 0, 0.66, 0.085, 0.56, 0, 0.95, 0.055);
    mesh_part(b, 0, "head", "hide_brown", HEAT_SKIN);
    limb(b, 0.56, 0, 1.00, 0.06, 0.74, 0, 0.92, 0.03);
    for (int side = -1; side <= 1; side += 2) limb(b, 0.54, side * 0.05, 1.04, 0.018, 0.49, side * 0.11, 1.14, 0.022);
    legs(b, 0.28, -0.30, 0.075, 0.50, 0.02, "hide_brown");
}

static const double straw_m = 0.1; /* what a day warms of pressed straw */

static void build_bale(MeshBuilder *b)
{
    mesh_part(b, 0, "straw", "grass_dry", HEAT_PASSIVE);
    mesh_cylinder(b, place_axis(0, 0, -0.62, 0, 1, 0), -0.6, 0.6, 0.625);
    mesh_part(b, 0, "foot", "grass_dry", HEAT_PASSIVE); /* where it has sunk down */
    parts_box(b, -0.24, 0.24, -0.6, 0.6, 0, 0.08);
}

/* Tongues of flame about a middle: the lasting part of a buoyant flame, which its material makes thin. */
static void flames(MeshBuilder *b, double base_m, double radius_m, double high_m)
{
    mesh_part(b, 0, "flames", "flame", HEAT_FIRE);
    for (int i = 0; i < 5; i++) {
        const double turn = 2 * pi_rad * i / 5, off = i ? 0.5 * radius_m : 0, h = high_m * (i ? 0.55 + 0.09 * i : 1);
        const double r = radius_m * (i ? 0.34 : 0.5);
        mesh_profile_begin(b, 0, 0);
        mesh_profile_line(b, 0, 0.7 * r);
        mesh_profile_line(b, 0.25 * h, r);
        mesh_profile_line(b, 0.6 * h, 0.55 * r);
        mesh_profile_line(b, h, 0);
        mesh_lathe(b, place_axis(off * cos(turn), off * sin(turn), -base_m, 0.12 * cos(turn), 0.12 * sin(turn), -1));
    }
}

static void build_campfire(MeshBuilder *b)
{
    mesh_part(b, 0, "embers", "charcoal", HEAT_EMBER);
    mesh_cone(b, place_axis(0, 0, 0, 0, 0, -1), 0, 0.45, 0.10, 0.25);
    mesh_part(b, 0, "logs", "charcoal", HEAT_EMBER);
    for (int i = 0; i < 5; i++) {
        const double turn = 2 * pi_rad * i / 5 + 0.3, c = cos(turn), s = sin(turn), r = 0.05 + 0.008 * (i % 3);
        parts_bar(b, 0.48 * c, 0.48 * s, 0.06 + r, 0.04 * c, 0.04 * s, 0.34 + 0.03 * i, r);
    }
    flames(b, 0.1, 0.26, 0.75);
}

static void build_barrel(MeshBuilder *b)
{
    const Place up = place_axis(0, 0, 0, 0, 0, -1);
    mesh_part(b, 0, "drum", "rust", HEAT_PASSIVE);
    mesh_tube(b, up, 0, 0.88, 0.285, 0.280);
    for (int i = 0; i < 2; i++) mesh_tube(b, up, 0.28 + 0.29 * i, 0.31 + 0.29 * i, 0.2925, 0.284);
    mesh_part(b, 0, "embers", "charcoal", HEAT_EMBER);
    mesh_cone(b, up, 0.02, 0.279, 0.80, 0.279);
    for (int i = 0; i < 3; i++) {
        const double turn = 2.1 * i;
        parts_bar(b, 0.15 * cos(turn), 0.15 * sin(turn), 0.5, -0.12 * cos(turn), -0.2 * sin(turn), 1.02, 0.035);
    }
    flames(b, 0.8, 0.25, 0.6);
}

static void build_smoulder(MeshBuilder *b)
{
    mesh_part(b, 0, "heap", "ash_crust", HEAT_SMOULDER);
    static const double lump[5][4] = {{0, 0, 1.5, 1.1},
                                      {0.7, 0.4, 0.9, 0.75},
                                      {-0.6, 0.6, 0.85, 0.7},
                                      {-0.4, -0.7, 0.9, 0.65},
                                      {0.6, -0.6, 0.8, 0.6}};
    for (int i = 0; i < 5; i++) {
        const double *l = lump[i];
        mesh_profile_begin(b, 0, 0);
        mesh_profile_line(b, 0, l[2]);
        mesh_profile_line(b, 0.55 * l[3], 0.72 * l[2]);
        mesh_profile_line(b, 0.9 * l[3], 0.30 * l[2]);
        mesh_profile_line(b, l[3], 0);
        mesh_lathe(b, place_axis(l[0], l[1], 0, 0, 0, -1));
    }
}

Status parametric_countryside(Model *out, const char *name, double sag_m)
{
    static const ShapeKind kinds[] = {
        {"cow", build_cow, 0.003},           {"sheep", build_sheep, 0.003},       {"deer", build_deer, 0.003},
        {"bale", build_bale, 0.003},         {"campfire", build_campfire, 0.003}, {"barrel", build_barrel, 0.003},
        {"smoulder", build_smoulder, 0.003},
    };
    const Status status = parts_build(out, kinds, name, "body", sag_m);
    for (int p = 0; status == STATUS_OK && strcmp(name, "bale") == 0 && p < out->part_count; p++)
        out->part[p].thickness_m = straw_m;
    return status;
}
