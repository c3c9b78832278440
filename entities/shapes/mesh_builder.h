/* entities/shapes/mesh_builder.h: builds the closed shells of the parametric models.
 *
 * A builder collects nodes, parts and shells, and hands over a Model. Every primitive adds one closed shell
 * (outward, edge-manifold by vertex position) to the part begun last. Curved surfaces carry smooth normals,
 * flat ones flat normals; vertices on a shared edge are bit-equal in position.
 *
 * Chord error (sag_m): vertices lie on the true surface, so a chord over an arc of radius r and angle a is r (1 - cos(a
 * / 2)) inside it. Singly curved surfaces (cylinders, cones, belts) use the whole chord error for that; doubly curved
 * ones halve it (lathes with arcs) or split it 2 : 2 : 1 (lofts: around, along, the twist of a facet's diagonal).
 * A full circle has 8 to 4096 sides; at 4096 the error is 2.9e-7 of the radius, so 1e-5 m holds to 34 m.
 * tests/entities/test_parametric.c measures all three kinds against their true surfaces.
 *
 * Running out of memory latches; mesh_builder_finish reports it. Wrong use by the program itself is asserted. */
#ifndef ENTITIES_SHAPES_MESH_BUILDER_H
#define ENTITIES_SHAPES_MESH_BUILDER_H

#include "entities/models/model.h"

typedef struct MeshBuilder MeshBuilder;

/* Where a shape goes: p_node = p + m p_shape. The columns of m are orthogonal (rotation, scale per axis,
 * mirror: all allowed); winding and normals follow. */
typedef struct Place {
    double p[3];
    double m[9];
} Place;

Place place_at(double x, double y, double z);                                    /* shape axes = node axes */
Place place_axis(double x, double y, double z, double dx, double dy, double dz); /* shape x along d, any roll */
Place place_scaled(Place place, double sx, double sy, double sz);                /* scale along the shape's own axes */
Place place_turned(Place place, const double axis[3], double angle_rad);         /* shape turned about its own origin */
Place place_mirror_y(Place place); /* the same shape on the other side, y -> -y */

MeshBuilder *mesh_builder_create(const char *model_name, double sag_m); /* NULL: no memory */
/* Returns the model (measured, validated by tests) and frees the builder, for any status. */
Status mesh_builder_finish(Model *out, MeshBuilder *b);

/* A node that does not move; the caller may then set the rest through mesh_node_get (valid until the next
 * mesh_node). */
int        mesh_node(MeshBuilder *b, const char *name, int parent, double x, double y, double z);
ModelNode *mesh_node_get(MeshBuilder *b, int node);
/* Makes a node turn: unit axis, limits in rad (low > high: none). */
void mesh_joint(MeshBuilder *b, int node, double ax, double ay, double az, uint32_t dis_class, uint32_t dis_metric,
                double low_rad, double high_rad);
/* Begins a part; nodes must come in ascending order. */
void mesh_part(MeshBuilder *b, int node, const char *name, const char *material, HeatRole role);

/* Sides of a full circle for a radius and a chord error. */
int mesh_circle_sides(double radius_m, double sag_m);

/* ---- bodies of revolution about the shape's x axis ------------------------------------------ */

/* The meridian runs from low x to high x with the outside on its left (r up): start on the axis and end on
 * the axis, or come back to the start for a ring (tube, tyre). Corners between pieces stay sharp. */
void mesh_profile_begin(MeshBuilder *b, double x, double r);
void mesh_profile_line(MeshBuilder *b, double x, double r);
/* Circular arc about (cx, cr) of the radius at which the meridian stands, by `turn_rad` (negative: clockwise,
 * bulging outward on the way to higher x). */
void mesh_profile_arc(MeshBuilder *b, double cx, double cr, double turn_rad);
void mesh_lathe(MeshBuilder *b, Place place);

void mesh_cylinder(MeshBuilder *b, Place place, double x0, double x1, double radius);
void mesh_cone(MeshBuilder *b, Place place, double x0, double r0, double x1, double r1);
void mesh_tube(MeshBuilder *b, Place place, double x0, double x1, double radius, double bore);
void mesh_sphere(MeshBuilder *b, Place place, double radius);
/* Straight round bar between two points. */
void mesh_bar(MeshBuilder *b, const double from[3], const double to[3], double radius);

/* ---- flat-faced shapes ---------------------------------------------------------------------- */

void mesh_box(MeshBuilder *b, Place place, double x0, double y0, double z0, double x1, double y1, double z1);
/* A polygon (x, z) drawn at y0 and again, perhaps moved and scaled, at y1 (same count, 3 .. 64, no crossing,
 * either winding, y0 < y1), joined by faces. Both must triangulate alike; concave ones are allowed. */
void mesh_slab(MeshBuilder *b, Place place, int count, const double (*at_y0)[2], double y0, const double (*at_y1)[2],
               double y1);
void mesh_prism(MeshBuilder *b, Place place, int count, const double (*outline)[2], double y0, double y1);

/* ---- lofted bodies along the shape's x axis -------------------------------------------------- */

/* One cross section: a rectangle with elliptic corners. round 1: an ellipse; small: nearly a rectangle. */
typedef struct Station {
    double x, half_width, top, bottom, round; /* top < bottom: z is down */
} Station;

/* The true section between stations (monotone cubic in x for width, top and bottom; linear for round). */
Station mesh_station_at(const Station *station, int count, double x);
/* Smooth in both directions, flat at both ends. x ascending. */
void mesh_loft(MeshBuilder *b, Place place, const Station *station, int count);

/* ---- tracks ----------------------------------------------------------------------------------- */

typedef struct BeltWheel {
    double x, z, radius;
} BeltWheel;

/* A closed band from y0 to y1. */
typedef struct Belt {
    double thickness, y0, y1; /* thickness: outwards */
    int    cleats; /* boxes of cleat_length along the band standing cleat_height proud of it, evenly spaced */
    double cleat_height, cleat_length;
} Belt;

/* A closed band in the xz plane, around wheels given in order around (either way; the band touches each). */
void mesh_belt(MeshBuilder *b, Place place, const BeltWheel *wheel, int count, const Belt *belt);

#endif
