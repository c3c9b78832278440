/* render/scattering/field/edge_field_private.h: the field that a target's edges scatter beyond physical optics.
 *
 * Each wedge is divided where an antenna loses sight of it, and into segments short enough that both paths are linear
 * along one and directions hardly change. A segment contributes
 *
 *     S_qp(k) = amplitude_qp sinc(k slope length / 2) exp(-j k path),      sinc x = sin x / x
 *
 * with an amplitude that holds at every frequency (edge_fringe), so that segments made once serve a whole band, up
 * to the k they were made for. It is to be added to physical optics of the same faces. Segments of higher order
 * (edge pairs, below) are of the same form, but for edge_fade.
 *
 * Against an integral over the whole edge, 30 m and beyond: 2e-3 of its largest value (tests/render/test_edges.c).
 *
 * Metal only. First order: an edge is lit by the incident wave alone; what parallel edges of a flat face do to one wave
 * is in the edge pairs. What corners add is left out. */
#ifndef RENDER_SCATTERING_FIELD_EDGE_FIELD_PRIVATE_H
#define RENDER_SCATTERING_FIELD_EDGE_FIELD_PRIVATE_H

#include "render/scattering/field/wedges_private.h"
#include "render/scattering/scatter.h"

/* Whether a point beside an edge (target frame, clear of the metal) sees the transmitter (0) or the receiver (1). The
 * receiver is asked for only where the transmitter is seen; where both are one antenna, it need not be traced. */
typedef bool EdgeVisible(void *user, const double p[3], int antenna);

typedef struct EdgeConfig {
    double       k_per_m;  /* the largest wave number that will be asked for, > 0 */
    double       sample_m; /* longest stretch that counts as seen or unseen as a whole, > 0; 0.05 */
    double       clear_m;  /* distance from the edge, away from its faces, of the points that are tested; 1e-4 */
    EdgeVisible *visible;  /* NULL: nothing hides but an edge's own faces */
    void        *user;
} EdgeConfig;

typedef struct EdgeSegment {
    int            wedge, part; /* whose it is; of the model */
    int            order;       /* 0: first order; n: of n waves along a face, and its amplitude goes with k^(-n / 2) */
    int            zero;        /* no gaps: segments are compared as octets */
    double         p[3], length_m;  /* middle */
    double complex amplitude[2][2]; /* m; [received][transmitted], 0: h, 1: v; first order: real */
    double         order_k;         /* the k, 1/m, that this amplitude is of */
    double         path_m, slope;   /* as in scatter.h, the mean along the segment; its change per length of edge */
    double         u[2][3];         /* unit directions to transmitter and receiver: d path = -dp . (u[0] + u[1]) */
} EdgeSegment;

typedef struct EdgeSegments {
    int          count, capacity;
    EdgeSegment *segment; /* by wedge, then along it */
} EdgeSegments;

/* Factor of a segment's amplitude at another k. */
static inline double edge_fade(const EdgeSegment *s, double k_per_m)
{
    if (s->order == 0) return 1;
    return s->order == 1 ? sqrt(s->order_k / k_per_m) : s->order_k / k_per_m;
}

/* Appends those of wedges (target frame). Antennas farther than every edge. STATUS_NO_MEMORY: out is as it was. */
Status edge_segments(EdgeSegments *out, const Wedge *wedge, int count, const ScatterAntenna *transmitter,
                     const ScatterAntenna *receiver, const EdgeConfig *config);
void   edge_segments_destroy(EdgeSegments *segments); /* frees and zeroes; accepts zeroes */

/* Adds the field of segments to out, in their order; k_per_m: not above that of their config. */
void edge_segments_field(ScatterMatrix *out, const EdgeSegments *segments, double k_per_m);

/* Adds the same for one frequency, config->k_per_m, and keeps no segments. */
void edge_field(ScatterMatrix *out, const Wedge *wedge, int count, const ScatterAntenna *transmitter,
                const ScatterAntenna *receiver, const EdgeConfig *config);

/* ---- a length of edge --------------------------------------------------------------------------- */

/* What a conducting wedge scatters beyond physical optics, per length of edge.
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
 * edge_fringe_limit, about what faces of 400 wavelengths would give. Exactly along a face, away from grazing
 * incidence, the limit depends on the direction of approach, and the mean is given. Backscatter meets neither.
 *
 * Not included: waves diffracted twice, corners' own currents. */
static const double edge_fringe_limit = 4;

/* D [received][transmitted], 0: h, 1: v. u_t, u_r: unit directions from the edge to the antennas; t, r: their
 * polarisations (unit, across u_t and u_r). All 0 where the transmitter is inside the metal or the edge is seen end-on
 * to 1e-7 rad. */
void edge_fringe(double out[2][2], const WedgeFrame *wedge, const double u_t[3], const double t[2][3],
                 const double u_r[3], const double r[2][3]);

/* Angle of a direction about the edge, from face 1 through free space, rad: 0 .. 2 pi; above exterior_pi pi: into the
 * metal. Directions along a face, to 1e-9 rad, are outside. */
double edge_angle(const WedgeFrame *wedge, const double u[3]);

/* ---- edge pairs --------------------------------------------------------------------------------- */

/* Waves that cross a flat face from one edge to another: diffraction of second and third order.
 *
 * Two parallel edges that face one another across one flat face of metal, as those of a plate: a wave diffracted at
 * the first travels along the face and is diffracted at the second, or sent back and diffracted at the first. Only a
 * magnetic field along the edges can do so (the electric field across them): along metal the other one vanishes.
 * Keller's coefficients of both wedges (any exterior angle), each with the other at grazing, where half of the field is
 * the incident wave; the transition function of the uniform theory keeps the coefficient finite where an antenna is in
 * the plane of the face.
 *
 * To be added to physical optics and first order. Pairs count where they overlap by a Fresnel zone,
 * sqrt(lambda width), at least: below that the edges are not straight ones seen from each other. Amplitudes are those
 * of one frequency (EdgeSegment.order).
 *
 * Against integral equations (plates, tests/render/test_edges.c): across the edges, 0 to 90 degrees, the median
 * error falls from 1.8 to 0.6 dB at 9 wavelengths. Left out: edges that are not parallel, waves along curved faces,
 * higher orders, waves from one face to the next.
 *
 * Source: Keller, J. Opt. Soc. Am. 52(2), 116, 1962; Kouyoumjian & Pathak, Proc. IEEE 62(11), 1448, 1974. */

/* Two wedges of a list and which of their faces they share; along: where they overlap, from the first wedge's first
 * end, m. */
typedef struct EdgePair {
    int    wedge[2];
    int    face[2]; /* 0: face 1 of the frame, 1: face 2 */
    double along_m[2], width_m;
} EdgePair;

typedef struct EdgePairs {
    int       count, capacity;
    EdgePair *pair; /* ascending in wedge[0], then wedge[1], each pair once */
} EdgePairs;

/* Finds the pairs among wedges that are of one part each. It fails only with STATUS_NO_MEMORY. */
Status edge_pairs_find(EdgePairs *out, const Wedge *wedge, int count);
void   edge_pairs_destroy(EdgePairs *pairs); /* frees and zeroes; accepts zeroes */

/* Whether nothing stands on the way from p to q, both just above a face of outward normal n, and metal is under it. */
typedef bool EdgeClear(void *user, const double p[3], const double q[3], const double n[3]);

typedef struct EdgePairConfig {
    EdgeConfig edge;    /* visible and sample_m as there */
    double     k_per_m; /* that amplitudes are made for, > 0 */
    EdgeClear *clear;   /* NULL: every pair has its face */
    double     least_m; /* pairs that add less than this to S are left out before rays are traced; 0: none */
} EdgePairConfig;

/* Appends segments of pairs of these wedges (target frame): their place is halfway between the edges. */
Status edge_pair_segments(EdgeSegments *out, const EdgePair *pair, int count, const Wedge *wedge,
                          const ScatterAntenna *transmitter, const ScatterAntenna *receiver,
                          const EdgePairConfig *config);

/* The transition function of the uniform theory of diffraction: 2 j sqrt(x) exp(j x) times the integral of exp(-j t^2)
 * from sqrt(x) on; x >= 0. 0 at 0, 1 at infinity; within 2e-4. */
double complex edge_transition(double x);

#endif
