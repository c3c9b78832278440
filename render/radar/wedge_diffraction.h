/* render/radar/wedge_diffraction.h: what a conducting wedge scatters beyond physical optics, per length of edge.
 *
 * The fringe current of a face (the exact current of an infinite wedge in a plane wave, less physical optics' 2 n x H
 * on lit faces) is integrated along the strip that starts at a point of the edge and runs along the face in the
 * direction of the diffracted ray that grazes it (Michaeli, IEEE Trans. Antennas Propag. 34(7) 1986, pp. 912-918,
 * "Elimination of infinities in equivalent edge currents, part I"). The strip's far field is the incremental length
 * diffraction coefficient
 *
 *     d S_qp = D_qp exp(-j k path) dl,      S = S_physical_optics + integral of dS along all edges
 *
 * in the conventions of scatter.h, where physical optics is -(j k / 2 pi) integral of q . (n x (d x p)) exp(-j k path)
 * dA over every lit face, whether the receiver sees that face or not. D has no unit, is real, and is the same at every
 * frequency: k enters through the phase alone.
 *
 * Directions are arbitrary, off the diffraction cone too. On the cone D is exact for an infinite edge; elsewhere only
 * the ends of an edge count, and the result depends on the choice of strip, as with every such coefficient.
 *
 * Finite everywhere: poles of the exact and of the physical-optics part cancel at shadow and reflection boundaries, and
 * are cancelled before evaluation. Two true singularities are left, both bistatic: incidence and scattering along the
 * same face in the same direction (Ufimtsev's), and forward along the edge itself. There each entry of D is limited to
 * wedge_fringe_limit, about what faces of 400 wavelengths would give. Exactly along a face, away from grazing
 * incidence, the limit depends on the direction of approach, and the mean is given. Backscatter meets neither.
 *
 * Not included: waves diffracted twice, corners' own currents. */
#ifndef RENDER_RADAR_WEDGE_DIFFRACTION_H
#define RENDER_RADAR_WEDGE_DIFFRACTION_H

#include "render/radar/scatter.h"

static const double wedge_fringe_limit = 4;

/* z along the edge; x in face 1, away from the edge; y = z x x: the outward normal of face 1. Face 2 is at the angle
 * exterior_pi pi from face 1, counted from x to y through free space: 1 < exterior_pi <= 2; 2: a half plane. */
typedef struct WedgeFrame {
    double x[3], y[3], z[3];
    double exterior_pi;
} WedgeFrame;

/* D [received][transmitted], 0: h, 1: v. u_t, u_r: unit directions from the edge to the antennas; t, r: their
 * polarisations (unit, across u_t and u_r). All 0 where the transmitter is inside the metal or the edge is seen end-on
 * to 1e-7 rad. */
void wedge_fringe(double out[2][2], const WedgeFrame *wedge, const double u_t[3], const double t[2][3],
                  const double u_r[3], const double r[2][3]);

/* Angle of a direction about the edge, from face 1 through free space, rad: 0 .. 2 pi; above exterior_pi pi: into the
 * metal. Directions along a face, to 1e-9 rad, are outside. */
double wedge_angle(const WedgeFrame *wedge, const double u[3]);

#endif
