/* render/scene/view.c: the names of bands, and many rays at once. */
#include "render/scene/view.h"

#include "pitviper_channels.h"

/* A channel in another's place gives the band its own name. */
static const char *name_in(ChannelPlace place, const char *standard)
{
    return channel_in(place)->standard || !*channel_in(place)->name ? standard : channel_in(place)->name;
}

const char *band_name(Band band)
{
    switch (band) {
    case BAND_OPTICAL: return name_in(SPECTRAL_NIR, "optical");
    case BAND_MWIR:    return name_in(SPECTRAL_MWIR, "mwir");
    case BAND_LWIR:    return name_in(SPECTRAL_LWIR, "lwir");
    case BAND_RADAR:   return "radar";
    case BAND_COUNT:   break;
    }
    return "unknown";
}

/* Without a lens; view_ray's operations in its order. */
static void straight_rays(double *restrict dx, double *restrict dy, double *restrict dz, const View *view, int count,
                          const double *restrict column_px, const double *restrict row_px)
{
    const double *r = view->r_enu_from_cam, centre_x = 0.5 * view->width, centre_y = 0.5 * view->height;
    const double  focal_px = view->focal_px;
    for (int i = 0; i < count; i++) {
        const double x_cam = (column_px[i] - centre_x) / focal_px, y_cam = (row_px[i] - centre_y) / focal_px;
        const double n = 1 / sqrt(x_cam * x_cam + y_cam * y_cam + 1), x = n * x_cam, y = n * y_cam, z = n * 1;
        dx[i] = r[0] * x + r[1] * y + r[2] * z;
        dy[i] = r[3] * x + r[4] * y + r[5] * z;
        dz[i] = r[6] * x + r[7] * y + r[8] * z;
    }
}

void view_rays(double *const d_enu[3], const View *view, int count, const double *column_px, const double *row_px)
{
    if (!view_has_lens(view)) {
        straight_rays(d_enu[0], d_enu[1], d_enu[2], view, count, column_px, row_px);
        return;
    }
    for (int i = 0; i < count; i++) {
        double d[3];
        view_ray(d, view, column_px[i], row_px[i]);
        for (int k = 0; k < 3; k++) d_enu[k][i] = d[k];
    }
}
