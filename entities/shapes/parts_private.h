/* entities/shapes/parts_private.h: pieces that several built-in models share, for the files of the shapes alone. */
#ifndef ENTITIES_SHAPES_PARTS_PRIVATE_H
#define ENTITIES_SHAPES_PARTS_PRIVATE_H

#include "entities/shapes/mesh_builder.h"

/* The node's axes, or their mirror image on the left: side 1 right, -1 left. */
Place parts_side(int side);
/* Shape y is up, shape x forward, shape z to the right: slabs drawn on the ground and lifted. */
Place parts_upright(double x, double y, double z);
Place parts_mirrored(Place place, int side);

/* A block that stands on a rectangle and ends in another; heights are up (positive). */
typedef struct Rectangle {
    double x0, x1, y0, y1;
} Rectangle;
void parts_block(MeshBuilder *b, Rectangle at_low, double low_m, Rectangle at_high, double high_m);

/* Half a wing, drawn on the place's x and along its y, z thick: six-sided lozenge section, thickness as a share of
 * the chord. y0 < y1. */
void parts_wing(MeshBuilder *b, Place place, double lead0, double trail0, double y0, double z0, double lead1,
                double trail1, double y1, double z1, double thickness);

/* A round-ended, tapered bar: a limb. */
void parts_limb(MeshBuilder *b, const double from[3], double from_radius, const double to[3], double to_radius);

/* ---- tracked running gear ---------------------------------------------------------------------- */

typedef struct RunningGear {
    double half_gauge_m, track_width_m;
    double band_m, cleat_m, cleat_length_m; /* thickness of the track under the wheel, and of its links' bars */
    int    links;
    int    road_wheels; /* the first at first_x_m, each step_m behind the one before */
    double first_x_m, step_m, road_radius_m;
    double front_x_m, front_z_m, front_radius_m;
    double rear_x_m, rear_z_m, rear_radius_m;
    bool   front_drives; /* the sprocket is in front, the idler behind; else the other way */
} RunningGear;

/* Both bands, as parts track_left and track_right of node 0. */
void parts_tracks(MeshBuilder *b, const RunningGear *gear);
/* Wheels of one side: a rolling node each, wheel_<side>_1 .., idler_<side>, sprocket_<side>. */
void parts_track_wheels(MeshBuilder *b, const RunningGear *gear, int side);
/* A rolling node; number 0: none in the name. */
int parts_wheel_node(MeshBuilder *b, int parent, const char *kind, int side, int number, double x, double y, double z,
                     double radius_m);
/* A dished wheel disc with ribs; place: x outwards. */
void parts_disc(MeshBuilder *b, Place place, double radius_m, double half_width_m, int ribs);

/* ---- simple pieces -------------------------------------------------------------------------- */

/* Heights are up and positive here, metres above the model's base; x is forward, y right. */

void parts_box(MeshBuilder *b, double x0, double x1, double y0, double y1, double low_m, double high_m);
/* The same on both sides: y0 < y1 of the right one. */
void parts_boxes(MeshBuilder *b, double x0, double x1, double y0, double y1, double low_m, double high_m);
/* A side view (x, height), extruded across from y0 to y1. */
void parts_profile(MeshBuilder *b, int count, const double (*outline)[2], double y0, double y1);
void parts_bar(MeshBuilder *b, double x0, double y0, double h0, double x1, double y1, double h1, double radius);
/* A fin that stands: quarter outline in x at two heights, thick_m across at the foot. */
void parts_fin(MeshBuilder *b, double y, double lead0, double trail0, double low_m, double lead1, double trail1,
               double high_m, double thickness);

/* A rolling node `wheel_<side>_<number>` with parts tyre and rim, standing on the ground: its axle is at its radius. */
void parts_wheel(MeshBuilder *b, const char *kind, int side, int number, double x, double y, double radius,
                 double half_width);
/* A spinning node of `blades` blades about the x axis (a propeller) or the z axis (a rotor), hub at x, y, height. */
void parts_propeller(MeshBuilder *b, const char *name, double x, double y, double h, double radius, int blades,
                     double rpm);
void parts_rotor(MeshBuilder *b, const char *name, double x, double y, double h, double radius, double chord,
                 int blades, double rpm);

/* A shape of a file that holds several: what builds it, and the largest chord error that it is made with; 0: any. */
typedef struct ShapeKind {
    const char *name;
    void (*build)(MeshBuilder *b);
    double most_sag_m;
} ShapeKind;
/* Builds the shape of this name, which is one of the kinds, about a node `root`. */
Status parts_build(Model *out, const ShapeKind *kinds, const char *name, const char *root, double sag_m);

#endif
