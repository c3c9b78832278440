/* entities/parametric/forms.c: pieces that the simpler built-in models share. */
#include "entities/parametric/forms.h"

#include <stdio.h>

void form_box(MeshBuilder *b, double x0, double x1, double y0, double y1, double low_m, double high_m)
{
    mesh_box(b, place_at(0, 0, 0), x0, y0, -high_m, x1, y1, -low_m);
}

void form_boxes(MeshBuilder *b, double x0, double x1, double y0, double y1, double low_m, double high_m)
{
    for (int side = -1; side <= 1; side += 2) mesh_box(b, parts_side(side), x0, y0, -high_m, x1, y1, -low_m);
}

void form_profile(MeshBuilder *b, int count, const double (*outline)[2], double y0, double y1)
{
    double down[64][2];
    for (int i = 0; i < count; i++) {
        down[i][0] = outline[i][0];
        down[i][1] = -outline[i][1];
    }
    mesh_prism(b, place_at(0, 0, 0), count, (const double (*)[2])down, y0, y1);
}

void form_bar(MeshBuilder *b, double x0, double y0, double h0, double x1, double y1, double h1, double radius)
{
    mesh_bar(b, (double[3]){x0, y0, -h0}, (double[3]){x1, y1, -h1}, radius);
}

void form_fin(MeshBuilder *b, double y, double lead0, double trail0, double low_m, double lead1, double trail1,
              double high_m, double thickness)
{
    parts_wing(b, parts_upright(0, y, 0), lead0, trail0, low_m, 0, lead1, trail1, high_m, 0, thickness);
}

void form_wheel(MeshBuilder *b, const char *kind, int side, int number, double x, double y, double radius,
                double half_width)
{
    const int node = parts_wheel_node(b, 0, kind, side, number, x, y, -radius, radius);
    const Place outwards = place_axis(0, 0, 0, 0, side < 0 ? -1 : 1, 0);
    const double r = radius, w = half_width;
    mesh_part(b, node, "tyre", "rubber_black", HEAT_WHEEL);
    mesh_profile_begin(b, -0.8 * w, 0.60 * r);
    mesh_profile_line(b, -w, 0.68 * r);
    mesh_profile_line(b, -w, 0.90 * r);
    mesh_profile_line(b, -0.7 * w, r);
    mesh_profile_line(b, 0.7 * w, r);
    mesh_profile_line(b, w, 0.90 * r);
    mesh_profile_line(b, w, 0.68 * r);
    mesh_profile_line(b, 0.8 * w, 0.60 * r);
    mesh_profile_line(b, -0.8 * w, 0.60 * r);
    mesh_lathe(b, outwards);
    mesh_part(b, node, "rim", "metal_dark", HEAT_WHEEL);
    mesh_profile_begin(b, -0.7 * w, 0);
    mesh_profile_line(b, -0.7 * w, 0.62 * r);
    mesh_profile_line(b, 0.7 * w, 0.62 * r);
    mesh_profile_line(b, 0.4 * w, 0.45 * r);
    mesh_profile_line(b, 0.6 * w, 0.2 * r);
    mesh_profile_line(b, 0.6 * w, 0);
    mesh_lathe(b, outwards);
}

void form_propeller(MeshBuilder *b, const char *name, double x, double y, double h, double radius, int blades,
                    double rpm)
{
    const int node = mesh_node(b, name, 0, x, y, -h);
    mesh_joint(b, node, 1, 0, 0, 0, 0, 1, -1);
    mesh_node_get(b, node)->spin_rps_moving = rpm * 2 * pi_rad / 60;
    mesh_part(b, node, "propeller", "metal_dark", HEAT_ROTOR);
    mesh_cone(b, place_at(0, 0, 0), -0.10 * radius, 0.13 * radius, 0.22 * radius, 0.03 * radius);
    /* a blade's chord stands 30 degrees out of the disc */
    const Place flat = place_turned(place_at(0, 0, 0), (double[3]){0, 1, 0}, pi_rad / 3);
    for (int i = 0; i < blades; i++)
        parts_wing(b, place_turned(flat, (double[3]){1, 0, 0}, 2 * pi_rad * i / blades), 0.09 * radius, -0.09 * radius,
                   0.08 * radius, 0, 0.05 * radius, -0.05 * radius, radius, 0, 0.10);
}

void form_rotor(MeshBuilder *b, const char *name, double x, double y, double h, double radius, double chord, int blades,
                double rpm)
{
    const int node = mesh_node(b, name, 0, x, y, -h);
    mesh_joint(b, node, 0, 0, -1, 0, 0, 1, -1);
    mesh_node_get(b, node)->spin_rps_moving = rpm * 2 * pi_rad / 60;
    mesh_part(b, node, "hub", "metal_dark", HEAT_ROTOR);
    mesh_cylinder(b, place_axis(0, 0, 0, 0, 0, -1), -0.03 * radius, 0.03 * radius, 0.06 * radius);
    mesh_part(b, node, "blades", "paint_olive", HEAT_ROTOR);
    /* the first one lies forward */
    const Place ahead = place_turned(place_at(0, 0, 0), (double[3]){0, 0, 1}, -0.5 * pi_rad);
    for (int i = 0; i < blades; i++)
        parts_wing(b, place_turned(ahead, (double[3]){0, 0, 1}, 2 * pi_rad * i / blades), 0.5 * chord, -0.5 * chord,
                   0.06 * radius, 0, 0.4 * chord, -0.4 * chord, radius, 0, 0.10);
}
