/* render/radar/ground_plane.h: the ground near a target as a plane mirror, and the antenna's image in it.
 *
 * By way of the ground a target is lit, and seen, as from the image of the antenna in the plane: same path, and the
 * same direction from where the plane is crossed. The image lies beneath the plane; nothing of the target that does
 * counts for it. */
#ifndef RENDER_RADAR_GROUND_PLANE_H
#define RENDER_RADAR_GROUND_PLANE_H

#include "render/radar/total_field.h"

/* In the target's frame: a point p is n . p + height_m above it. */
typedef struct GroundPlane {
    double n[3];      /* unit, up */
    double height_m;  /* of the target's origin above it */
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
/* A direction mirrored. Of that to an image: that from the ground to the antenna. */
void ground_mirror(double out[3], const double d[3], const GroundPlane *plane);

/* Takes out of a field made for images what does not see them by way of the ground: what lies beneath the plane, and
 * what the target itself hides from the antenna on the way between antenna and ground (between ground and target the
 * list is right already). image: whether the field's transmitter, receiver is an image. Hits beneath between a path's
 * first point and its last are not known, and stay. The order is kept: the same bits for any threads. */
Status ground_hide(TotalField *field, const RadarTarget *target, const GroundPlane *plane, const bool image[2],
                   Pool *pool);

#endif
