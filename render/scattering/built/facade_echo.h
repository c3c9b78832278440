/* render/scattering/built/facade_echo.h: what a piece of a wall or roof returns to a radar: mirrored, scattered, and by
 * way of the ground before it.
 *
 *     mirrored     physical optics with Fresnel's reflection and Ament's roughness, the phase of each piece linear over
 *                  it, from the bumps of its plane too. A rectangle a by b of metal at the normal: 4 pi (a b /
 * lambda)^2 scattered    a complex Gaussian amplitude, fixed to the piece, of mean facade_sigma0 times its area; HH, VV
 * and HV are independent by ground    antenna, wall, ground, antenna, and the other way round: by the image of the
 * antenna in the plane of the ground before the wall (ground_bounce.h). Of a wall a by b of metal on metal, at right
 * angles to it, e above the ground: 16 pi (a b cos e / lambda)^2, all at the range of the wall's foot
 *
 * ENU is the frame of all, so a bearing's h is along the level. Pieces must be small: k side^2 / (4 range) below 0.2
 * (facade_piece_m); then a sum of pieces is as exact near a wall as far from it. Left out: shadow within a piece,
 * edges, waves that go through (rooms), waves by the ground both ways. */
#ifndef RENDER_SCATTERING_BUILT_FACADE_ECHO_H
#define RENDER_SCATTERING_BUILT_FACADE_ECHO_H

#include "render/scattering/built/facade_table.h"
#include "render/scattering/built/pieces.h"
#include "render/scattering/paths/ground_bounce.h"

/* The radar that looks. */
typedef struct FacadeLook {
    double      p_enu[3], right[3]; /* of the antenna; its first axis, as ground_bounce.h */
    double      frequency_hz, k;
    ClutterBand band;
} FacadeLook;

/* What a triangle of something built is made of, and where it lies. */
typedef struct Facade {
    PiecePlane       plane; /* ENU */
    const FacadeRow *row;
    RadarSurface     surface;
    uint64_t         bumps;  /* seed of them: the same of all triangles of a plane */
    uint32_t         number; /* tells pieces of one cell apart */
} Facade;

/* Largest side of a piece at a range, m. */
double facade_piece_m(double k, double range_m);

/* S of a piece about its middle, in the bases of scatter.h at the direction to the antenna. mirrored false: only what
 * is scattered. 0 from behind. */
void facade_echo(ScatterMatrix *out, const Facade *facade, const Piece *piece, const FacadeLook *look, bool mirrored);

/* How far off the mirror direction a facade is: half of the sum of the unit directions to transmitter and receiver, as
 * far as it lies in the plane; its parts along the plane's s and t. 0: the plane mirrors one to the other. */
void facade_off_mirror(double off[2], const PiecePlane *plane, const double to_tx[3], const double to_rx[3]);

/* The ground before a piece as a mirror. */
typedef struct FacadeGround {
    GroundPlane    plane; /* about the piece's middle, ENU axes */
    ScatterAntenna direct, image;
    double         extra_m;                    /* path by the ground over the direct one */
    double         foot_enu[3], mirror_enu[3]; /* below the piece's middle on the plane; where waves are reflected */
} FacadeGround;
/* Of the piece's middle, and a point and the normal of the plane. False: the antenna or the piece is beneath it, or the
 * wall does not face its image. */
bool facade_ground(FacadeGround *out, const Facade *facade, const Piece *piece, const FacadeLook *look,
                   const double p_ground[3], const double n_ground[3]);
/* S of both ways round together, about twice the paths over the middle: that to it, and that by the plane; in the
 * antenna's axes. 0 where less than ground_least_coherence is mirrored. */
void facade_by_ground(ScatterMatrix *out, const Facade *facade, const Piece *piece, const FacadeLook *look,
                      const FacadeGround *ground, const GroundSurface *surface);

#endif
