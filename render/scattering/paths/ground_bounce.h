/* render/scattering/paths/ground_bounce.h: the ground as a mirror of radar waves: how each surface class reflects,
 * the ground near a target as a plane, and the paths of a target by way of it. */
#ifndef RENDER_SCATTERING_PATHS_GROUND_BOUNCE_H
#define RENDER_SCATTERING_PATHS_GROUND_BOUNCE_H

#include "render/scattering/field/total_field.h"
#include "render/scattering/radar_surfaces.h"
#include "terrain/surface.h"

/* ---- what it is made of ------------------------------------------------------------------------- */

/* The ground as a rough half space, one for each class of surface, from etc/radar/ground.csv (with a source a row). */
enum { ground_points = 8 };

/* One class of surface. Its permittivity is a straight line over log frequency between points, and constant beyond
 * them. */
typedef struct GroundRow {
    int    points;
    double frequency_hz[ground_points], e1[ground_points], e2[ground_points];
    double rms_m; /* of heights about the mean plane */
    bool   waves; /* heights of a sinusoid with random amplitude and phase; else normal */
} GroundRow;

typedef struct GroundTable {
    GroundRow row[SURFACE_COUNT]; /* [SURFACE_NONE] is as bare soil */
} GroundTable;

/* Each class must have a row; failures are logged with file, line, column and range, and leave *out as it was. */
Status ground_table_open(GroundTable *out, const char *path);

/* At one frequency. */
typedef struct GroundSurface {
    double complex eps;
    double         rms_m;
    bool           waves;
} GroundSurface;
GroundSurface ground_surface(const GroundRow *row, double frequency_hz);

/* Share of the amplitude that the mean plane mirrors coherently; x = 2 (k rms sin grazing)^2. Normal heights: exp(-x)
 * (Ament, Proc. IRE 41, 142, 1953). Waves: exp(-x) I0(x) (Miller, Brown & Vegh, IEE Proc. F 131(2), 1984). Slopes
 * small, nothing in its own shadow. Within 3e-7 (tests/render/test_ground_bounce.c). */
double ground_roughness(double rms_m, bool waves, double k, double sin_grazing);

/* Reflection coefficients for E across and in the plane of incidence, with the signs of radar_surfaces.h; the roughness
 * is included. */
void ground_reflection(double complex *te, double complex *tm, const GroundSurface *surface, double k,
                       double sin_grazing);

/* ---- a plane and the image in it ---------------------------------------------------------------- */

/* The ground near a target as a plane mirror, and the antenna's image in it.
 *
 * By way of the ground a target is lit, and seen, as from the image of the antenna in the plane: same path, and the
 * same direction from where the plane is crossed. The image lies beneath the plane; nothing of the target that does
 * counts for it. */

/* In the target's frame: a point p is n . p + height_m above it. */
typedef struct GroundPlane {
    double n[3];     /* unit, up */
    double height_m; /* of the target's origin above it */
} GroundPlane;

/* p_ground, n_ground: a point of the plane and its upward unit normal, in the frame that the target's origin and axes
 * are given in. */
void ground_plane(GroundPlane *out, const double p_ground[3], const double n_ground[3], const double p_target[3],
                  const double r_from_body[9]);
static inline double ground_above_m(const GroundPlane *plane, const double p[3])
{
    return v3_dot(plane->n, p) + plane->height_m;
}

/* The antenna's image. Returns how much farther it is from the target's origin than the antenna, m (also where both
 * are at infinity: of one plane wave after the other). */
double ground_image(ScatterAntenna *image, const ScatterAntenna *antenna, const GroundPlane *plane);

/* Takes out of a field made for images what does not see them by way of the ground: what lies beneath the plane, and
 * what the target itself hides from the antenna on the way between antenna and ground (between ground and target the
 * list is right already). image: whether the field's transmitter, receiver is an image. Hits beneath between a path's
 * first point and its last are not known, and stay. The order is kept: the same bits for any threads. */
Status ground_hide(TotalField *field, const RadarTarget *target, const GroundPlane *plane, const bool image[2],
                   Pool *pool);

/* ---- paths -------------------------------------------------------------------------------------- */

/* A target and the ground near it: the four paths between antenna and target.
 *
 *     S = S(a, a) + e L' S(i, a) + e S(a, i) L + e^2 L' S(i, i) L,      e = exp(-j k extra) r_a / r_i
 *
 * S(q, p): the target's field for a receiver q and a transmitter p, each the antenna, a, or its image in the plane of
 * the ground, i (ground_image); L: what a leg by way of the ground does to polarisation, Fresnel's reflection and the
 * loss of coherence by roughness among it; L' its transpose, extra what the leg is longer. By reciprocity S(i, a) is
 * the transpose of S(a, i), so three fields are made, not four.
 *
 * Source: two-ray propagation and image theory, e.g. Skolnik, Radar Handbook, 3rd ed., ch. 26 (pattern-propagation
 * factor F: a point has F^4); Knott, Shaeffer & Tuley, Radar Cross Section, 2nd ed. (target on a ground plane).
 *
 * Range: a plane that reaches over the first Fresnel zone about the reflection, the antenna above it, grazing angles
 * above some 0.3 degrees (the Earth's curvature spreads nothing). Left out: waves from target to ground to target,
 * and what the ground scatters incoherently (by way of it: lost; on its own: clutter.h). */

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
/* An antenna and its mirror image beneath a ground plane. */
typedef struct GroundMirror {
    const ScatterAntenna *antenna, *image; /* image: filled by ground_image */
    double                extra_m;         /* the extra path that ground_image returned */
    const GroundPlane    *plane;
} GroundMirror;
/* The leg by the ground. False: the antenna is beneath the plane. */
bool ground_leg_image(GroundLeg *out, const GroundMirror *from, const GroundSurface *surface, double k,
                      const double right[3]);

/* Turns a field of the target, s, into the antenna's axes, out. s has the receiver at the end of one leg and the
 * transmitter at the end of the other, in the target's bases. out leaves out the spread and the phase of the extra
 * paths. s and out may be the same. */
void ground_through(ScatterMatrix *out, const ScatterMatrix *s, const GroundLeg *receive, const GroundLeg *transmit);

/* Fields of a target by paths: direct; transmitted directly and received by the ground; by the ground both ways. */
typedef struct GroundFields {
    ScatterMatrix direct, once, twice;
} GroundFields;
/* Sums these fields, in the antenna's axes. */
void ground_sum(ScatterMatrix *out, const GroundFields *s, const GroundLeg *direct, const GroundLeg *image, double k);

/* Below this coherence c the ground's paths are left out: what is missed is at most 2 c |S(i, a)| + c^2 |S(i, i)|, as
 * a perfect mirror would have them; test_ground_bounce_fields.c. */
extern const double ground_least_coherence;

/* Where on the ground the leg to a target is reflected: towards the antenna from the target's foot on the plane. */
void ground_reflection_point(double p[3], const ScatterAntenna *image, const GroundPlane *plane);

#endif
