/* render/scene/view.h: a camera: where it looks, what of the scene falls where on its picture, its bands. */
#ifndef RENDER_SCENE_VIEW_H
#define RENDER_SCENE_VIEW_H

#include "pitviper.h"

/* ---- the lens -------------------------------------------------------------------------------- */

/* Distortion of a lens: where a direction falls on the image, and back.
 *
 * Points are tangents: (x, y) / z of a direction, and on the image (column - width / 2, row - height / 2) / focal_px.
 * With r2 = x^2 + y^2 and g = 1 + k1 r2 + k2 r2^2 + k3 r2^3 a direction (x, y) falls on
 *     (x g + 2 p1 x y + p2 (r2 + 2 x^2), y g + p1 (r2 + 2 y^2) + 2 p2 x y).
 * Source: Brown, "Decentering distortion of lenses", Photogrammetric Engineering 32 (1966) 444; "Close-range camera
 * calibration", 37 (1971) 855; signs and order of p1, p2 as OpenCV has them.
 *
 * Inverse: Newton's method, a fixed number of steps, so that arrays and single points give the same bits;
 * view_lens_make rejects a lens for which those steps do not converge to 1e-12. Beyond the picture a polynomial may
 * fold back into it; from `reach` on the image of a direction r u is therefore r / reach times that of reach u, a
 * straight line outwards. */

typedef struct Lens {
    double k[3], p[2];
    double reach;      /* tangent off the axis up to which the polynomial holds; 0: no distortion at all */
    double tangent[2]; /* extent of the picture to either side, and up or down; with margin */
    double bend;       /* bound of the second derivatives of the inverse within the picture */
} Lens;

static const double lens_room = 1.04; /* margin beyond the picture in which a lens must be valid: for lateral colour */

/* half: of the picture, tangents on the image. STATUS_BAD_VALUE, not logged: the lens folds within the picture, or
 * nearly. */
Status view_lens_make(Lens *out, const double k[3], const double p[2], const double half[2]);

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
void view_lens_image(double image[2], const Lens *lens, double x, double y);
void view_lens_back(double out[2], const Lens *lens, double x_image, double y_image);
/* Area on the image per area of directions, both in squared tangents; within the picture. */
double view_lens_area(const Lens *lens, double x, double y);
/* Extent in tangents (left, top, right, bottom) that holds a rectangle of the image; never too small. */
void view_lens_box(double out[4], const Lens *lens, const double image[4]);

/* ---- the camera ------------------------------------------------------------------------------ */

typedef enum Band { BAND_OPTICAL, BAND_MWIR, BAND_LWIR, BAND_RADAR, BAND_COUNT } Band;
const char *band_name(Band band); /* optical, mwir, lwir, radar */

/* Pinhole: x right, y down, z along the boresight. A direction (x, y, z) falls on
 * column = width / 2 + focal_px x / z, row = height / 2 + focal_px y / z; the first pixel's centre is
 * (0.5, 0.5). A lens moves (x / z, y / z) before that; it must be made for this picture. */
typedef struct View {
    double p_enu[3];
    double r_enu_from_cam[9];
    int    width, height;
    double focal_px;
    Lens   lens; /* all 0: none */
} View;

static inline bool view_has_lens(const View *view) { return view->lens.reach > 0; }

static inline double view_focal_px(int width, double hfov_rad) { return 0.5 * width / tan(0.5 * hfov_rad); }

/* Unit direction through an image point. */
static inline void view_ray(double d_enu[3], const View *view, double column_px, double row_px)
{
    double d_cam[3] = {(column_px - 0.5 * view->width) / view->focal_px, (row_px - 0.5 * view->height) / view->focal_px,
                       1};
    if (view_has_lens(view)) view_lens_back(d_cam, &view->lens, d_cam[0], d_cam[1]);
    const double n = 1 / sqrt(d_cam[0] * d_cam[0] + d_cam[1] * d_cam[1] + 1);
    v3_scale(d_cam, n, d_cam);
    m3_mul_v3(d_enu, view->r_enu_from_cam, d_cam);
}

/* The same of `count` points. */
void view_rays(double *const d_enu[3], const View *view, int count, const double *column_px, const double *row_px);

/* Image position of a point in front of the eye (p_cam[2] > 0). */
static inline void view_project(double image_px[2], const View *view, const double p_cam[3])
{
    if (view_has_lens(view)) {
        double image[2];
        view_lens_image(image, &view->lens, p_cam[0] / p_cam[2], p_cam[1] / p_cam[2]);
        image_px[0] = 0.5 * view->width + view->focal_px * image[0];
        image_px[1] = 0.5 * view->height + view->focal_px * image[1];
        return;
    }
    image_px[0] = 0.5 * view->width + view->focal_px * p_cam[0] / p_cam[2];
    image_px[1] = 0.5 * view->height + view->focal_px * p_cam[1] / p_cam[2];
}

/* Tangents (x / z, y / z: left, top, right, bottom) between which a rectangle of the image lies. */
static inline void view_box_tangents(double out[4], const View *view, const double box_px[4])
{
    for (int k = 0; k < 4; k++) out[k] = (box_px[k] - 0.5 * (k % 2 ? view->height : view->width)) / view->focal_px;
    if (view_has_lens(view)) view_lens_box(out, &view->lens, (const double[4]){out[0], out[1], out[2], out[3]});
}

/* Tangents at the picture's sides: what it shows lies within. */
static inline void view_half_tangents(double half[2], const View *view)
{
    half[0] = view_has_lens(view) ? view->lens.tangent[0] : 0.5 * view->width / view->focal_px;
    half[1] = view_has_lens(view) ? view->lens.tangent[1] : 0.5 * view->height / view->focal_px;
}

/* Solid angle of a pixel, at its centre, over 1 / focal_px^2: cos^3 of the angle off the axis, and by how much less of
 * the image a lens gives to an area of directions. tests/render/test_lens.c */
static inline double view_pixel_share(const View *view, int x, int y)
{
    double at[2] = {(x + 0.5 - 0.5 * view->width) / view->focal_px, (y + 0.5 - 0.5 * view->height) / view->focal_px},
           area = 1;
    if (view_has_lens(view)) {
        lens_back_within(at, &view->lens, at[0], at[1]);
        area = view_lens_area(&view->lens, at[0], at[1]);
    }
    const double square = 1 / (1 + at[0] * at[0] + at[1] * at[1]);
    return square * sqrt(square) / area;
}

/* Of the optical band: three pictures or one. */
typedef enum OpticalChannels {
    OPTICAL_PAN,
    OPTICAL_RGB,
    OPTICAL_NIR,
    OPTICAL_RED,
    OPTICAL_BLUE /* one of the three, as render() requests it where colours differ in magnification */
} OpticalChannels;

static const double view_most_lateral = 0.02; /* less than the margin of a lens */

/* ---- axes of a camera, from its viewing direction and its up direction ----------------------- */

static const double camera_vertical_rad = 2e-3; /* reason: sensor/node/session/seeker_private.h */

bool view_near_vertical(const double d_enu[3]);

/* right = d x top: of unit vectors that are not parallel. */
void view_topped(double r_enu_from_cam[9], const double d_enu[3], const double top_enu[3]);
/* Upright in ENU, along a direction of any length; within camera_vertical_rad of straight up or down, and along no
 * direction (zero, not finite: taken as north), the top is north. */
void view_upright(double r_enu_from_cam[9], const double d_enu[3]);

#endif
