/* entities/shapes/person.c: dismounted soldier standing at the low ready, 1.80 m to the top of the helmet and on
 * the soles. Body of 1.745 m with the segment lengths of Drillis and Contini (1966; as in Winter, "Biomechanics and
 * Motor Control"): of the stature, knee 0.285, hip 0.530, shoulder 0.818, chin 0.870, upper arm 0.186, forearm
 * 0.146, shoulders 0.259 and hips 0.191 wide, foot 0.152 long. Girths are estimates after the US Army's ANSUR
 * survey; rifle 0.84 m (M4 carbine, stock out). Clothing, vest, pack and helmet thicknesses are estimates.
 *
 * One rigid body: stance and weapon bits of a life form's appearance are not followed. */
#include "entities/shapes/parametric.h"
#include "entities/shapes/parts_private.h"

static const double stature_m = 1.745, sole_m = 0.025, height_m = 1.80;

/* Heights above the ground of the stature's share. */
static double at(double share) { return sole_m + share * stature_m; }

/* A loft that stands up: stations in x are heights, "top" is the back and "bottom" the front. */
static Place standing(double x, double y) { return place_axis(x, y, 0, 0, 0, -1); }

static void build_torso(MeshBuilder *b)
{
    /* hips, waist, chest, shoulders, neck opening */
    const Station jacket[6] = {
        {at(0.475), 0.165, -0.105, 0.115, 0.9}, {at(0.530), 0.172, -0.115, 0.115, 0.9},
        {at(0.610), 0.150, -0.100, 0.115, 0.9}, {at(0.720), 0.178, -0.115, 0.125, 0.85},
        {at(0.795), 0.212, -0.100, 0.095, 0.9}, {at(0.838), 0.085, -0.075, 0.060, 1.0},
    };
    mesh_part(b, 0, "uniform", "cloth_olive", HEAT_CLOTHING);
    mesh_loft(b, standing(0, 0), jacket, 6);
    /* upper arms and thighs meet the torso inside it */
    for (int side = -1; side <= 1; side += 2) {
        const double hip[3] = {0, side * 0.090, -at(0.510)}, knee[3] = {0.030, side * 0.105, -at(0.285)};
        const double ankle[3] = {-0.015, side * 0.115, -at(0.050)};
        parts_limb(b, hip, 0.098, knee, 0.066);
        parts_limb(b, knee, 0.068, ankle, 0.052);
        /* cargo pocket on the thigh */
        mesh_box(b, parts_side(side), -0.07, 0.155, -at(0.41), 0.08, 0.190, -at(0.33));
    }
    /* right hand at the grip, elbow out; left hand on the fore-end */
    static const double shoulder[2][3] = {{-0.010, -0.192, 0}, {-0.010, 0.192, 0}};
    static const double elbow[2][3] = {{0.080, -0.315, -1.155}, {-0.075, 0.330, -1.180}};
    static const double wrist[2][3] = {{0.310, -0.165, -1.120}, {0.160, 0.185, -1.205}};
    for (int i = 0; i < 2; i++) {
        const double top[3] = {shoulder[i][0], shoulder[i][1], -at(0.785)};
        parts_limb(b, top, 0.063, elbow[i], 0.050);
        parts_limb(b, elbow[i], 0.051, wrist[i], 0.036);
    }
}

static void build_head(MeshBuilder *b)
{
    mesh_part(b, 0, "skin", "skin", HEAT_SKIN);
    /* face and skull, neck, hands */
    mesh_sphere(b, place_scaled(place_at(0.015, 0, -at(0.925)), 0.098, 0.076, 0.118), 1);
    mesh_sphere(b, place_scaled(place_at(0.070, 0, -at(0.890)), 0.045, 0.048, 0.048), 1); /* jaw */
    mesh_box(b, place_at(0, 0, 0), 0.095, -0.013, -at(0.925), 0.126, 0.013, -at(0.905));  /* nose */
    mesh_cylinder(b, standing(-0.005, 0), at(0.80), at(0.90), 0.058);
    mesh_sphere(b, place_scaled(place_axis(0.345, -0.150, -1.112, 1, 0.4, 0.1), 0.085, 0.040, 0.048), 1);
    mesh_sphere(b, place_scaled(place_axis(0.205, 0.135, -1.215, 1, -0.8, 0), 0.080, 0.040, 0.050), 1);

    /* half an egg down to the ears, with a rim */
    mesh_part(b, 0, "helmet", "helmet_composite", HEAT_CLOTHING);
    const double rim = at(0.930), crown = height_m - rim;
    mesh_profile_begin(b, 0, 0);
    mesh_profile_line(b, 0, 1);
    mesh_profile_arc(b, 0, 0, -0.5 * pi_rad);
    const Place egg = {{-0.005, 0, -rim}, {0, 0, 0.140, 0, 0.122, 0, -crown, 0, 0}}; /* shape x is up */
    mesh_lathe(b, egg);
    for (int side = -1; side <= 1; side += 2) /* ear pieces */
        mesh_box(b, parts_side(side), -0.085, 0.075, -rim - 0.02, 0.045, 0.115, -rim + 0.055);
    mesh_box(b, place_at(0, 0, 0), -0.135, -0.085, -rim - 0.02, -0.075, 0.085, -rim + 0.045);
}

static void build_kit(MeshBuilder *b)
{
    /* plate carrier front and back, pouches, pack */
    mesh_part(b, 0, "vest", "cloth_olive", HEAT_PASSIVE);
    const Station plates[4] = {{at(0.600), 0.160, -0.150, 0.155, 0.5},
                               {at(0.660), 0.178, -0.155, 0.165, 0.5},
                               {at(0.760), 0.178, -0.155, 0.160, 0.5},
                               {at(0.810), 0.140, -0.130, 0.130, 0.6}};
    mesh_loft(b, standing(0, 0), plates, 4);
    for (int i = 0; i < 3; i++) {
        const double y = -0.13 + 0.09 * i;
        mesh_box(b, place_at(0, 0, 0), 0.14, y, -at(0.70), 0.205, y + 0.080, -at(0.60));
    }
    static const double belt_m = 0.045;
    const Station belt[2] = {{at(0.570) - belt_m, 0.168, -0.125, 0.130, 0.9}, {at(0.570), 0.165, -0.125, 0.130, 0.9}};
    mesh_loft(b, standing(0, 0), belt, 2);
    mesh_part(b, 0, "pack", "canvas", HEAT_PASSIVE);
    const Station pack[4] = {{at(0.585), 0.130, -0.330, -0.14, 0.4},
                             {at(0.640), 0.160, -0.360, -0.14, 0.4},
                             {at(0.770), 0.155, -0.340, -0.14, 0.4},
                             {at(0.815), 0.120, -0.270, -0.14, 0.5}};
    mesh_loft(b, standing(0, 0), pack, 4);

    mesh_part(b, 0, "boots", "rubber_black", HEAT_PASSIVE);
    for (int side = -1; side <= 1; side += 2) {
        /* toe to heel along x, sole flat on the ground; shaft over the ankle */
        const Station foot[4] = {{-0.090, 0.036, -0.095, 0, 0.35},
                                 {0.000, 0.044, -0.100, 0, 0.35},
                                 {0.110, 0.050, -0.075, 0, 0.35},
                                 {0.190, 0.036, -0.040, 0, 0.5}};
        mesh_loft(b, place_turned(place_at(-0.01, side * 0.118, 0), (double[3]){0, 0, 1}, side * 0.12), foot, 4);
        mesh_cone(b, standing(-0.015, side * 0.115), 0.06, 0.062, 0.27, 0.074);
    }
}

/* Along the rifle: x from the butt to the muzzle, z down. */
static void build_rifle(MeshBuilder *b)
{
    static const double butt[3] = {0.085, 0.150, -1.360}, muzzle[3] = {0.585, -0.330, -0.895};
    double              along[3], side[3], down[3];
    v3_sub(along, muzzle, butt);
    v3_normalize(along, along);
    const double vertical[3] = {0, 0, 1};
    v3_cross(side, vertical, along);
    v3_normalize(side, side);
    v3_cross(down, along, side);
    Place place = place_at(butt[0], butt[1], butt[2]);
    for (int i = 0; i < 3; i++) {
        place.m[3 * i] = along[i];
        place.m[3 * i + 1] = side[i];
        place.m[3 * i + 2] = down[i];
    }
    mesh_part(b, 0, "rifle", "metal_dark", HEAT_GUN);
    static const double stock[4][2] = {{0, -0.02}, {0.22, -0.03}, {0.22, 0.01}, {0, 0.11}};
    static const double receiver[6][2] = {{0.20, -0.04}, {0.44, -0.04}, {0.44, 0.03},
                                          {0.36, 0.05},  {0.24, 0.05},  {0.20, 0.02}};
    static const double grip[4][2] = {{0.24, 0.04}, {0.285, 0.04}, {0.255, 0.14}, {0.215, 0.135}};
    static const double magazine[4][2] = {{0.35, 0.04}, {0.41, 0.04}, {0.435, 0.20}, {0.375, 0.21}};
    mesh_prism(b, place, 4, stock, -0.018, 0.018);
    mesh_prism(b, place, 6, receiver, -0.022, 0.022);
    mesh_prism(b, place, 4, grip, -0.015, 0.015);
    mesh_prism(b, place, 4, magazine, -0.012, 0.012);
    mesh_box(b, place, 0.44, -0.026, -0.040, 0.64, 0.026, 0.020);
    mesh_box(b, place, 0.26, -0.018, -0.085, 0.36, 0.018, -0.035); /* sight */
    Place bore = place;
    for (int i = 0; i < 3; i++) bore.p[i] -= 0.010 * down[i];
    mesh_cylinder(b, bore, 0.62, 0.84, 0.010);
}

Status parametric_person(Model *out, double sag_m)
{
    MeshBuilder *b = mesh_builder_create("person", sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, "body", -1, 0, 0, 0);
    build_torso(b);
    build_head(b);
    build_kit(b);
    build_rifle(b);
    return mesh_builder_finish(out, b);
}
