/* render/scene/view.h: one camera, and its possible bands and channels. */
#ifndef RENDER_SCENE_VIEW_H
#define RENDER_SCENE_VIEW_H

#include "render/scene/lens.h"

typedef enum Band { BAND_OPTICAL, BAND_MWIR, BAND_LWIR, BAND_RADAR, BAND_COUNT } Band;
const char *band_name(Band band); /* optical, mwir, lwir, radar */

/* Pinhole: x right, y down, z along the boresight. A direction (x, y, z) falls on
 * column = width / 2 + focal_px x / z, row = height / 2 + focal_px y / z; the first pixel's centre is
 * (0.5, 0.5). A lens (render/scene/lens.h) moves (x / z, y / z) before that; it must be made for this picture. */
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
    double d_cam[3] = {(column_px - 0.5 * view->width) / view->focal_px,
                       (row_px - 0.5 * view->height) / view->focal_px, 1};
    if (view_has_lens(view)) lens_back(d_cam, &view->lens, d_cam[0], d_cam[1]);
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
        lens_image(image, &view->lens, p_cam[0] / p_cam[2], p_cam[1] / p_cam[2]);
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
    for (int k = 0; k < 4; k++)
        out[k] = (box_px[k] - 0.5 * (k % 2 ? view->height : view->width)) / view->focal_px;
    if (view_has_lens(view)) lens_box(out, &view->lens, (const double[4]){out[0], out[1], out[2], out[3]});
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
        area = lens_area(&view->lens, at[0], at[1]);
    }
    const double square = 1 / (1 + at[0] * at[0] + at[1] * at[1]);
    return square * sqrt(square) / area;
}

/* Of the optical band: three pictures or one. */
typedef enum OpticalChannels {
    OPTICAL_PAN, OPTICAL_RGB, OPTICAL_NIR,
    OPTICAL_RED, OPTICAL_BLUE /* one of the three, as render() requests it where colours differ in magnification */
} OpticalChannels;

static const double view_most_lateral = 0.02; /* less than the margin of a lens */

#endif
