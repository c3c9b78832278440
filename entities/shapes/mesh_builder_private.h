/* entities/shapes/mesh_builder_private.h: internals of the builder, for the files of its shapes. */
#ifndef ENTITIES_SHAPES_MESH_BUILDER_PRIVATE_H
#define ENTITIES_SHAPES_MESH_BUILDER_PRIVATE_H

#include "entities/shapes/mesh_builder.h"

enum { meridian_capacity = 64 };

/* One piece of a meridian: a line when radius is 0, else an arc about (cx, cr). */
typedef struct Piece {
    double x0, r0, x1, r1;
    double cx, cr, radius, from_rad, turn_rad;
} Piece;

struct MeshBuilder {
    Model  model;
    int    node_capacity, part_capacity, vertex_capacity, triangle_capacity;
    Status status;
    double begin_x, begin_r, at_x, at_r; /* meridian being drawn */
    int    piece_count;
    Piece  piece[meridian_capacity];
};

/* What a place does to lengths, normals and winding. */
typedef struct Warp {
    double largest;     /* longest column: lengths grow by no more than this */
    double normal_m[9]; /* inverse transpose, up to length */
    bool   flips;
} Warp;

Warp mesh_warp(const Place *place);

/* Grows an array to hold `needed`; false, and latched, when memory is out. array: address of the pointer. */
bool mesh_grow(MeshBuilder *b, void *array, int *capacity, int needed, size_t size);
/* Reserves capacity for a shell: false when out of memory; nothing of the shell is then added. */
bool mesh_reserve(MeshBuilder *b, long long vertices, long long triangles);
void mesh_place_point(double out[3], const Place *place, const double p_shape[3]);
/* Capacity must be reserved. Returns the new vertex's index. */
uint32_t mesh_add_vertex(MeshBuilder *b, const Place *place, const Warp *warp, const double p_shape[3],
                         const double n_shape[3]);
/* Adds a triangle unless two of its corners are one place (the pole of a sphere): its edges cancel, so the
 * shell stays closed without it. */
void mesh_add_triangle(MeshBuilder *b, const Warp *warp, uint32_t i, uint32_t j, uint32_t k);
/* Two rings of `sides` vertices each, joined by a band; ring 1 lies towards higher shape x. */
void mesh_add_band(MeshBuilder *b, const Warp *warp, uint32_t ring0, uint32_t ring1, int sides);
/* Angle of a chord with this chord error; never more than 45 degrees. */
double mesh_chord_angle(double radius_m, double sag_m);

#endif
