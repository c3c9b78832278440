/* entities/shapes/parts.c: wheels, tracks, guns and other shapes that several built-in models share. */

#include "entities/shapes/parts_private.h"

#include <stdio.h>

static const double tread_m = 0.001; /* the corner of a cleat reaches this much deeper on a bend */

Place parts_mirrored(Place place, int side) { return side < 0 ? place_mirror_y(place) : place; }

Place parts_side(int side) { return parts_mirrored(place_at(0, 0, 0), side); }

Place parts_upright(double x, double y, double z)
{
    static const double m[9] = {1, 0, 0, 0, 0, 1, 0, -1, 0};
    Place               place = place_at(x, y, z);
    memcpy(place.m, m, sizeof m);
    return place;
}

void parts_block(MeshBuilder *b, Rectangle at_low, double low_m, Rectangle at_high, double high_m)
{
    const Rectangle *l = &at_low, *h = &at_high;
    const double     base[4][2] = {{l->x0, l->y0}, {l->x1, l->y0}, {l->x1, l->y1}, {l->x0, l->y1}};
    const double     roof[4][2] = {{h->x0, h->y0}, {h->x1, h->y0}, {h->x1, h->y1}, {h->x0, h->y1}};
    mesh_slab(b, parts_upright(0, 0, 0), 4, base, low_m, roof, high_m);
}

void parts_wing(MeshBuilder *b, Place place, double lead0, double trail0, double y0, double z0, double lead1,
                double trail1, double y1, double z1, double thickness)
{
    double section[2][6][2];
    for (int end = 0; end < 2; end++) {
        const double lead = end ? lead1 : lead0, chord = lead - (end ? trail1 : trail0), z = end ? z1 : z0;
        const double half = 0.5 * thickness * chord;
        const double points[6][2] = {
            {lead, z},         {lead - 0.25 * chord, z - half}, {lead - 0.60 * chord, z - half},
            {lead - chord, z}, {lead - 0.60 * chord, z + half}, {lead - 0.25 * chord, z + half}};
        memcpy(section[end], points, sizeof points);
    }
    mesh_slab(b, place, 6, (const double(*)[2])section[0], y0, (const double(*)[2])section[1], y1);
}

void parts_limb(MeshBuilder *b, const double from[3], double from_radius, const double to[3], double to_radius)
{
    double d[3];
    v3_sub(d, to, from);
    const double length = v3_length(d);
    /* the common tangent cone touches both balls at this angle from the axis */
    const double touch_rad = acos(clamp((from_radius - to_radius) / length, -1, 1));
    mesh_profile_begin(b, -from_radius, 0);
    mesh_profile_arc(b, 0, 0, -(pi_rad - touch_rad));
    mesh_profile_line(b, length + to_radius * cos(touch_rad), to_radius * sin(touch_rad));
    mesh_profile_arc(b, length, 0, -touch_rad);
    mesh_lathe(b, place_axis(from[0], from[1], from[2], d[0], d[1], d[2]));
}

/* ---- tracked running gear ---------------------------------------------------------------------- */

static double wheel_z(const RunningGear *g) { return -(g->road_radius_m + g->band_m + g->cleat_m + tread_m); }

void parts_tracks(MeshBuilder *b, const RunningGear *gear)
{
    const RunningGear *g = gear;
    const BeltWheel    wheel[4] = {
           {g->first_x_m, wheel_z(g), g->road_radius_m},
           {g->front_x_m, g->front_z_m, g->front_radius_m},
           {g->rear_x_m, g->rear_z_m, g->rear_radius_m},
           {g->first_x_m - (g->road_wheels - 1) * g->step_m, wheel_z(g), g->road_radius_m},
    };
    for (int side = -1; side <= 1; side += 2) {
        mesh_part(b, 0, side < 0 ? "track_left" : "track_right", "steel_worn", HEAT_TRACK);
        const Belt band = {g->band_m,
                           g->half_gauge_m - 0.5 * g->track_width_m,
                           g->half_gauge_m + 0.5 * g->track_width_m,
                           g->links,
                           g->cleat_m,
                           g->cleat_length_m};
        mesh_belt(b, parts_side(side), wheel, 4, &band);
    }
}

int parts_wheel_node(MeshBuilder *b, int parent, const char *kind, int side, int number, double x, double y, double z,
                     double radius_m)
{
    char        name[24];
    const char *where = side < 0 ? "_left" : side > 0 ? "_right" : "";
    if (number > 0) snprintf(name, sizeof name, "%s%s_%d", kind, where, number);
    else snprintf(name, sizeof name, "%s%s", kind, where);
    const int node = mesh_node(b, name, parent, x, y, z);
    /* about -y, so that travelling forward takes the top of the wheel forward */
    mesh_joint(b, node, 0, -1, 0, 0, 0, 1, -1);
    mesh_node_get(b, node)->roll_radius_m = radius_m;
    return node;
}

static Place about_axle(Place place, double angle_rad)
{
    const double axle[3] = {place.m[0], place.m[3], place.m[6]};
    return place_turned(place, axle, angle_rad);
}

void parts_disc(MeshBuilder *b, Place place, double radius_m, double half_width_m, int ribs)
{
    const double r = radius_m, w = half_width_m;
    mesh_profile_begin(b, -w, 0);
    mesh_profile_line(b, -w, r);
    mesh_profile_line(b, 0.9 * w, r);
    mesh_profile_line(b, 0.9 * w, 0.86 * r);
    mesh_profile_line(b, 0.3 * w, 0.70 * r);
    mesh_profile_line(b, 0.5 * w, 0.42 * r);
    mesh_profile_line(b, w, 0.34 * r);
    mesh_profile_line(b, w, 0);
    mesh_lathe(b, place);
    for (int i = 0; i < ribs; i++) {
        const Place rib = about_axle(place, 2 * pi_rad * i / ribs);
        mesh_box(b, rib, 0.2 * w, -0.06 * r, 0.36 * r, 0.75 * w, 0.06 * r, 0.84 * r);
    }
}

void parts_track_wheels(MeshBuilder *b, const RunningGear *gear, int side)
{
    const RunningGear *g = gear;
    const Place        outwards = place_axis(0, 0, 0, 0, side, 0);
    const double       y = side * g->half_gauge_m, half = 0.32 * g->track_width_m, r = g->road_radius_m;
    for (int i = 0; i < g->road_wheels; i++) {
        const int node = parts_wheel_node(b, 0, "wheel", side, i + 1, g->first_x_m - i * g->step_m, y, wheel_z(g), r);
        mesh_part(b, node, "wheel_disc", "paint_olive", HEAT_WHEEL);
        parts_disc(b, outwards, 0.85 * r, half, 6);
        mesh_part(b, node, "wheel_tyre", "rubber_black", HEAT_WHEEL);
        /* two rims with the guide horns' gap between them */
        mesh_tube(b, outwards, 0.2 * half, half, r, 0.80 * r);
        mesh_tube(b, outwards, -half, -0.2 * half, r, 0.80 * r);
    }
    for (int end = 0; end < 2; end++) {
        const bool   front = end == 0, drives = front == g->front_drives;
        const double x = front ? g->front_x_m : g->rear_x_m, z = front ? g->front_z_m : g->rear_z_m;
        const double radius = front ? g->front_radius_m : g->rear_radius_m;
        const int    node = parts_wheel_node(b, 0, drives ? "sprocket" : "idler", side, 0, x, y, z, radius);
        mesh_part(b, node, drives ? "sprocket" : "idler", drives ? "steel_worn" : "paint_olive", HEAT_WHEEL);
        parts_disc(b, outwards, drives ? radius - 0.03 : radius, half, drives ? 7 : 5);
        for (int i = 0; drives && i < 12; i++) {
            const Place tooth = about_axle(outwards, 2 * pi_rad * i / 12);
            mesh_box(b, tooth, 0.45 * half, -0.03, radius - 0.06, 0.75 * half, 0.03, radius);
            mesh_box(b, tooth, -0.75 * half, -0.03, radius - 0.06, -0.45 * half, 0.03, radius);
        }
    }
}

/* ---- simple pieces -------------------------------------------------------------------------- */

void parts_box(MeshBuilder *b, double x0, double x1, double y0, double y1, double low_m, double high_m)
{
    mesh_box(b, place_at(0, 0, 0), x0, y0, -high_m, x1, y1, -low_m);
}

void parts_boxes(MeshBuilder *b, double x0, double x1, double y0, double y1, double low_m, double high_m)
{
    for (int side = -1; side <= 1; side += 2) mesh_box(b, parts_side(side), x0, y0, -high_m, x1, y1, -low_m);
}

void parts_profile(MeshBuilder *b, int count, const double (*outline)[2], double y0, double y1)
{
    double down[64][2];
    for (int i = 0; i < count; i++) {
        down[i][0] = outline[i][0];
        down[i][1] = -outline[i][1];
    }
    mesh_prism(b, place_at(0, 0, 0), count, (const double(*)[2])down, y0, y1);
}

void parts_bar(MeshBuilder *b, double x0, double y0, double h0, double x1, double y1, double h1, double radius)
{
    mesh_bar(b, (double[3]){x0, y0, -h0}, (double[3]){x1, y1, -h1}, radius);
}

void parts_fin(MeshBuilder *b, double y, double lead0, double trail0, double low_m, double lead1, double trail1,
               double high_m, double thickness)
{
    parts_wing(b, parts_upright(0, y, 0), lead0, trail0, low_m, 0, lead1, trail1, high_m, 0, thickness);
}

void parts_wheel(MeshBuilder *b, const char *kind, int side, int number, double x, double y, double radius,
                 double half_width)
{
    const int    node = parts_wheel_node(b, 0, kind, side, number, x, y, -radius, radius);
    const Place  outwards = place_axis(0, 0, 0, 0, side < 0 ? -1 : 1, 0);
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

void parts_propeller(MeshBuilder *b, const char *name, double x, double y, double h, double radius, int blades,
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

void parts_rotor(MeshBuilder *b, const char *name, double x, double y, double h, double radius, double chord,
                 int blades, double rpm)
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

Status parts_build(Model *out, const ShapeKind *kinds, const char *name, const char *root, double sag_m)
{
    while (strcmp(kinds->name, name) != 0) kinds++;
    MeshBuilder *b = mesh_builder_create(name, kinds->most_sag_m > 0 ? fmin(sag_m, kinds->most_sag_m) : sag_m);
    if (!b) return STATUS_NO_MEMORY;
    mesh_node(b, root, -1, 0, 0, 0);
    kinds->build(b);
    const Status status = mesh_builder_finish(out, b);
    if (status == STATUS_OK) out->sag_m = sag_m; /* as asked: what is finer is within it */
    return status;
}
