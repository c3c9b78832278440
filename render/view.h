/* render/view.h: one camera, and what somebody wants of it. */
#ifndef RENDER_VIEW_H
#define RENDER_VIEW_H

#include "pitviper.h"

typedef enum Band { BAND_OPTICAL, BAND_MWIR, BAND_LWIR, BAND_RADAR, BAND_COUNT } Band;
const char *band_name(Band band); /* optical, mwir, lwir, radar */

/* Pinhole: x right, y down, z along the boresight. A direction (x, y, z) falls on
 * column = width / 2 + focal_px x / z, row = height / 2 + focal_px y / z; the first pixel's centre is
 * (0.5, 0.5). */
typedef struct View {
    double p_enu[3];
    double r_enu_from_cam[9];
    int    width, height;
    double focal_px;
} View;

static inline double view_focal_px(int width, double hfov_rad) { return 0.5 * width / tan(0.5 * hfov_rad); }

/* Unit direction through an image point. */
static inline void view_ray(double d_enu[3], const View *view, double column_px, double row_px)
{
    double d_cam[3] = {(column_px - 0.5 * view->width) / view->focal_px,
                       (row_px - 0.5 * view->height) / view->focal_px, 1};
    const double n = 1 / sqrt(d_cam[0] * d_cam[0] + d_cam[1] * d_cam[1] + 1);
    v3_scale(d_cam, n, d_cam);
    m3_mul_v3(d_enu, view->r_enu_from_cam, d_cam);
}

/* Of the optical band: three pictures or one. */
typedef enum OpticalChannels { OPTICAL_PAN, OPTICAL_RGB, OPTICAL_NIR } OpticalChannels;

typedef struct RenderRequest {
    View     view;
    unsigned bands;          /* 1 << Band, those somebody consumes */
    bool     truth;          /* id, part, material, range, normal, temperature planes and target counts */
    OpticalChannels optical;
    int      sky_samples;    /* directions a hit in which sky and surroundings are asked for light; 0: the quick form */
    bool     sky_visibility; /* with the quick form: what stands near hides sky and ground (render/sky_visibility.h) */
    int      samples;        /* a side: samples^2 rays a pixel, on a turned grid, box-averaged. 1 .. 16 */
    int      edge_samples;   /* the same where neighbours disagree, 2 .. 16; not above samples: nowhere */
    int      target_samples; /* rays a side over the whole of a target that is small on the image, 8 .. 256; 0: as all */
    int      hidden_entity;  /* snapshot index whose parts the eye does not see (they cast shadows); -1: none */
    unsigned skips_off;      /* 1 << Skip (render/skip.h): not left out but computed; must give the same bits */
    bool     budget;         /* estimate how wrong the planes are: Picture.budget */
    double   profile_near_m, profile_bin_m; /* radar range profile */
    int      profile_bins;
} RenderRequest;

#endif
