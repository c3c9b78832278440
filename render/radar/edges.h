/* render/radar/edges.h: the field that a target's edges scatter beyond physical optics.
 *
 * Each wedge is divided where an antenna loses sight of it, and into segments short enough that both paths are linear
 * along one and directions hardly change. A segment contributes
 *
 *     S_qp(k) = amplitude_qp sinc(k slope length / 2) exp(-j k path),      sinc x = sin x / x
 *
 * with an amplitude that holds at every frequency (wedge_diffraction.h), so that segments made once serve a whole band,
 * up to the k they were made for. To be added to physical optics of the same faces. Segments of higher order
 * (edge_pairs.h) are of the same form, but for edge_fade.
 *
 * Against an integral over the whole edge, 30 m and beyond: 2e-3 of its largest value (tests/render/test_edges.c).
 *
 * Metal only. First order: an edge is lit by the incident wave alone; what parallel edges of a flat face do to one wave
 * is in edge_pairs.h. What corners add is left out. */
#ifndef RENDER_RADAR_EDGES_H
#define RENDER_RADAR_EDGES_H

#include "render/radar/wedges.h"

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
    int    wedge, part;     /* whose it is; of the model */
    int    order;           /* 0: first order; n: of n waves along a face, and its amplitude goes with k^(-n / 2) */
    int    zero;            /* no gaps: segments are compared as octets */
    double p[3], length_m;  /* middle */
    double complex amplitude[2][2]; /* m; [received][transmitted], 0: h, 1: v; first order: real */
    double order_k;         /* the k, 1/m, that this amplitude is of */
    double path_m, slope;   /* as in scatter.h, the mean along the segment; its change per length of edge */
    double u[2][3];         /* unit directions to transmitter and receiver: d path = -dp . (u[0] + u[1]) */
} EdgeSegment;

typedef struct EdgeSegments {
    int          count, capacity;
    EdgeSegment *segment; /* by wedge, then along it */
} EdgeSegments;

/* What becomes of a segment's amplitude at another k. */
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

/* The same for one frequency, config->k_per_m, without keeping segments. */
void edge_field(ScatterMatrix *out, const Wedge *wedge, int count, const ScatterAntenna *transmitter,
                const ScatterAntenna *receiver, const EdgeConfig *config);

#endif
