/* render/scattering/built/pieces.h: triangles cut along a grid of their plane into pieces, over which waves have one
 * direction and a linear phase. */
#ifndef RENDER_SCATTERING_BUILT_PIECES_H
#define RENDER_SCATTERING_BUILT_PIECES_H

#include "pitviper.h"

enum { piece_corners_most = 7 }; /* of a triangle cut by four lines */

/* A plane with axes of its own, which all triangles in it share: s is level (of a level plane: along x), t = n x s. */
typedef struct PiecePlane {
    double n[3], s[3], t[3], offset_m; /* unit; n . p of its points */
} PiecePlane;
/* Of a triangle, anti-clockwise seen from the side of n. Returns its area, m^2; 0: it has none, and the plane is not
 * filled. */
double piece_plane(PiecePlane *out, const double corner[3][3]);
/* A place of the plane. */
static inline void piece_place(double p[3], const PiecePlane *plane, double s_m, double t_m)
{
    for (int k = 0; k < 3; k++) p[k] = plane->offset_m * plane->n[k] + s_m * plane->s[k] + t_m * plane->t[k];
}

typedef struct Piece {
    int32_t i, j;                          /* cell of the grid: of s and t, in sides, rounded down */
    int     corners;                       /* 3 .. piece_corners_most, anti-clockwise */
    double  corner[piece_corners_most][2]; /* s, t, m */
    double  middle[2], area_m2;            /* of its centroid */
} Piece;

/* Gives each piece of a triangle in cells of side_m along s and t to take, row by row of t; pieces under 1e-6 of a
 * cell, which rounding makes, are left out. Their areas add up to the triangle's. A triangle over more than 2^20 cells
 * is left out: returns false. */
typedef void PieceTake(void *user, const Piece *piece);
bool         pieces_cut(const PiecePlane *plane, const double corner[3][3], const double side_m[2], PieceTake *take,
                        void *user);
/* How many cells the box about a triangle meets: a bound on its pieces. */
double pieces_bound(const PiecePlane *plane, const double corner[3][3], const double side_m[2]);

#endif
