/* render/radar/ground_bounce.h: a target and the ground near it: the four paths between antenna and target.
 *
 *     S = S(a, a) + e L' S(i, a) + e S(a, i) L + e^2 L' S(i, i) L,      e = exp(-j k extra) r_a / r_i
 *
 * S(q, p): the target's field for a receiver q and a transmitter p, each the antenna, a, or its image in the plane of
 * the ground, i (ground_plane.h); L: what a leg by way of the ground does to polarisation, Fresnel's reflection and the
 * loss of coherence by roughness among it; L' its transpose, extra what the leg is longer. By reciprocity S(i, a) is
 * the transpose of S(a, i), so three fields are made, not four.
 *
 * Source: two-ray propagation and image theory, e.g. Skolnik, Radar Handbook, 3rd ed., ch. 26 (pattern-propagation
 * factor F: a point has F^4); Knott, Shaeffer & Tuley, Radar Cross Section, 2nd ed. (target on a ground plane).
 *
 * Range: a plane that reaches over the first Fresnel zone about the reflection, the antenna above it, grazing angles
 * above some 0.3 degrees (the Earth's curvature spreads nothing). Left out: waves from target to ground to target,
 * and what the ground scatters incoherently (by way of it: lost; on its own: clutter.h). */
#ifndef RENDER_RADAR_GROUND_BOUNCE_H
#define RENDER_RADAR_GROUND_BOUNCE_H

#include "render/radar/ground_plane.h"
#include "render/radar/ground_table.h"

/* From the antenna's polarisation to the field at the target in its basis there (scatter.h): [target h, v][antenna's
 * first, second axis]. A field at the target returns by the transpose. */
typedef struct GroundLeg {
    double complex m[2][2];
    double         extra_m;   /* path to the target's origin over the direct one */
    double         spread;    /* amplitude over the direct one: r_a / r_i */
    double         coherence; /* larger of |te|, |tm| */
} GroundLeg;

/* right: direction in the target's frame along which, as far as it is across the line of sight, the antenna's first
 * axis lies; the second is u x first. Must not lie along it. */
void ground_leg_direct(GroundLeg *out, const ScatterAntenna *antenna, const double right[3]);
/* image: of ground_image, with the extra path that it returned. False: the antenna is beneath the plane. */
bool ground_leg_image(GroundLeg *out, const ScatterAntenna *antenna, const ScatterAntenna *image, double extra_m,
                      const GroundPlane *plane, const GroundSurface *surface, double k, const double right[3]);

/* s: of a receiver at the end of one leg and a transmitter at the end of the other, in the target's bases; out: in the
 * antenna's axes, without spread and phase of the extra paths. May be one. */
void ground_through(ScatterMatrix *out, const ScatterMatrix *s, const GroundLeg *receive, const GroundLeg *transmit);

/* Fields of a target by paths: direct; transmitted directly and received by the ground; by the ground both ways. */
typedef struct GroundFields {
    ScatterMatrix direct, once, twice;
} GroundFields;
/* Their sum, in the antenna's axes. */
void ground_sum(ScatterMatrix *out, const GroundFields *s, const GroundLeg *direct, const GroundLeg *image, double k);

/* Below this coherence c the ground's paths are left out: what is missed is at most 2 c |S(i, a)| + c^2 |S(i, i)|, as
 * a perfect mirror would have them; test_ground_bounce.c. */
extern const double ground_least_coherence;

/* Where on the ground the leg to a target is reflected: towards the antenna from the target's foot on the plane. */
void ground_reflection_point(double p[3], const ScatterAntenna *image, const GroundPlane *plane);

#endif
