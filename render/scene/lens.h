/* render/scene/lens.h: distortion of a lens: where a direction falls on the image, and back.
 *
 * Points are tangents: (x, y) / z of a direction, and on the image (column - width / 2, row - height / 2) / focal_px.
 * With r2 = x^2 + y^2 and g = 1 + k1 r2 + k2 r2^2 + k3 r2^3 a direction (x, y) falls on
 *     (x g + 2 p1 x y + p2 (r2 + 2 x^2), y g + p1 (r2 + 2 y^2) + 2 p2 x y).
 * Source: Brown, "Decentering distortion of lenses", Photogrammetric Engineering 32 (1966) 444; "Close-range camera
 * calibration", 37 (1971) 855; signs and order of p1, p2 as OpenCV has them.
 *
 * Inverse: Newton's method, a fixed number of steps, so that arrays and single points give the same bits; lens_make
 * rejects a lens for which those steps do not converge to 1e-12. Beyond the picture a polynomial may fold back into it;
 * from `reach` on the image of a direction r u is therefore r / reach times that of reach u, a straight line
 * outwards. */
#ifndef RENDER_SCENE_LENS_H
#define RENDER_SCENE_LENS_H

#include "pitviper.h"

typedef struct Lens {
    double k[3], p[2];
    double reach;      /* tangent off the axis up to which the polynomial holds; 0: no distortion at all */
    double tangent[2]; /* extent of the picture to either side, and up or down; with margin */
    double bend;       /* bound of the second derivatives of the inverse within the picture */
} Lens;

static const double lens_room = 1.04; /* margin beyond the picture in which a lens must be valid: for lateral colour */

/* half: of the picture, tangents on the image. STATUS_BAD_VALUE, not logged: the lens folds within the picture, or
 * nearly. */
Status lens_make(Lens *out, const double k[3], const double p[2], const double half[2]);

/* By the polynomial alone. */
static inline void lens_polynomial(double out[2], const Lens *l, double x, double y)
{
    const double r2 = x * x + y * y, g = 1 + r2 * (l->k[0] + r2 * (l->k[1] + r2 * l->k[2]));
    out[0] = x * g + 2 * l->p[0] * x * y + l->p[1] * (r2 + 2 * x * x);
    out[1] = y * g + l->p[0] * (r2 + 2 * y * y) + 2 * l->p[1] * x * y;
}

/* Its derivatives: d image x / dx, d image y / dy, and the mixed one, which is the same both ways. */
static inline void lens_slopes(double out[3], const Lens *l, double x, double y)
{
    const double r2 = x * x + y * y, g = 1 + r2 * (l->k[0] + r2 * (l->k[1] + r2 * l->k[2]));
    const double slope = l->k[0] + r2 * (2 * l->k[1] + r2 * 3 * l->k[2]);
    out[0] = g + 2 * x * x * slope + 2 * l->p[0] * y + 6 * l->p[1] * x;
    out[1] = g + 2 * y * y * slope + 6 * l->p[0] * y + 2 * l->p[1] * x;
    out[2] = 2 * x * y * slope + 2 * l->p[0] * x + 2 * l->p[1] * y;
}

/* The inverse for a point within the picture. */
enum { lens_newton_steps = 6 };
static inline void lens_back_within(double out[2], const Lens *l, double x_image, double y_image)
{
    const double r2 = x_image * x_image + y_image * y_image;
    const double per_g = 1 / (1 + r2 * (l->k[0] + r2 * (l->k[1] + r2 * l->k[2])));
    double       x = x_image * per_g, y = y_image * per_g;
    for (int n = 0; n < lens_newton_steps; n++) {
        double at[2], s[3];
        lens_polynomial(at, l, x, y);
        lens_slopes(s, l, x, y);
        const double dx = x_image - at[0], dy = y_image - at[1], per_det = 1 / (s[0] * s[1] - s[2] * s[2]);
        x += (s[1] * dx - s[2] * dy) * per_det;
        y += (s[0] * dy - s[2] * dx) * per_det;
    }
    out[0] = x;
    out[1] = y;
}

/* Anywhere. Of a lens with distortion. */
void lens_image(double image[2], const Lens *lens, double x, double y);
void lens_back(double out[2], const Lens *lens, double x_image, double y_image);
/* Area on the image per area of directions, both in squared tangents; within the picture. */
double lens_area(const Lens *lens, double x, double y);
/* Extent in tangents (left, top, right, bottom) that holds a rectangle of the image; never too small. */
void lens_box(double out[4], const Lens *lens, const double image[4]);

#endif
