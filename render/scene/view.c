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
    case BAND_OPTICAL:
        return name_in(SPECTRAL_NIR, "optical");
    case BAND_MWIR:
        return name_in(SPECTRAL_MWIR, "mwir");
    case BAND_LWIR:
        return name_in(SPECTRAL_LWIR, "lwir");
    case BAND_RADAR:
        return "radar";
    case BAND_COUNT:
        break;
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

/* ---- axes of a camera from its viewing direction and its up direction ------------------------ */

void view_topped(double r_enu_from_cam[9], const double d_enu[3], const double top_enu[3])
{
    double right[3], down[3];
    v3_cross(right, d_enu, top_enu);
    v3_normalize(right, right);
    v3_cross(down, d_enu, right);
    for (int i = 0; i < 3; i++) {
        r_enu_from_cam[3 * i] = right[i];
        r_enu_from_cam[3 * i + 1] = down[i];
        r_enu_from_cam[3 * i + 2] = d_enu[i];
    }
}

bool view_near_vertical(const double d_enu[3]) { return !(hypot(d_enu[0], d_enu[1]) > sin(camera_vertical_rad)); }

void view_upright(double r_enu_from_cam[9], const double d_enu[3])
{
    static const double north[3] = {0, 1, 0}, up[3] = {0, 0, 1};
    double              d[3] = {d_enu[0], d_enu[1], d_enu[2]};
    /* what is unit to rounding keeps its bits */
    if (!(fabs(v3_dot(d, d) - 1) <= 1e-14) && !v3_normalize(d, d)) memcpy(d, north, sizeof d);
    view_topped(r_enu_from_cam, d, view_near_vertical(d) ? north : up);
}

/* ---- distortion of a lens -------------------------------------------------------------------- */

/* Distortion of a lens: validity of a lens for a picture, and points outside the picture. */

/* Least slopes of an accepted lens: 0.1 is a picture compressed tenfold. */
static const double least_slope = 0.1;

enum { side_points = 16, march_steps = 64, grid = 32 };

static bool is_plain(const double k[3], const double p[2])
{
    return k[0] == 0 && k[1] == 0 && k[2] == 0 && p[0] == 0 && p[1] == 0;
}

static bool slopes_are_good(const Lens *l, double x, double y)
{
    double s[3];
    lens_slopes(s, l, x, y);
    return s[0] >= least_slope && s[1] >= least_slope && s[0] * s[1] - s[2] * s[2] >= least_slope * least_slope;
}

static double miss(const Lens *l, const double at[2], double x_image, double y_image)
{
    double image[2];
    lens_polynomial(image, l, at[0], at[1]);
    return hypot(image[0] - x_image, image[1] - y_image);
}

/* Newton's method from where `at` is. */
static bool solve(double at[2], const Lens *l, double x_image, double y_image)
{
    for (int n = 0; n < 30; n++) {
        double image[2], s[3];
        if (!slopes_are_good(l, at[0], at[1])) return false;
        lens_polynomial(image, l, at[0], at[1]);
        lens_slopes(s, l, at[0], at[1]);
        const double dx = x_image - image[0], dy = y_image - image[1], det = s[0] * s[1] - s[2] * s[2];
        at[0] += (s[1] * dx - s[2] * dy) / det;
        at[1] += (s[0] * dy - s[2] * dx) / det;
    }
    return miss(l, at, x_image, y_image) <= 1e-13 * (1 + hypot(x_image, y_image));
}

/* A point of the rectangle's outline, n = 0 .. 4 side_points - 1. */
static void outline_point(double out[2], const double half[2], int n)
{
    const double along = 2.0 * (n % side_points) / side_points - 1;
    const int    side = n / side_points;
    out[0] = half[0] * (side == 0 ? along : side == 1 ? 1 : side == 2 ? -along : -1);
    out[1] = half[1] * (side == 0 ? -1 : side == 1 ? along : side == 2 ? 1 : -along);
}

/* From the centre out to the outline on the branch of the centre; and whether the fast inverse finds it. */
static bool follow_outline(Lens *l, const double half[2])
{
    double farthest = 0;
    for (int n = 0; n < 4 * side_points; n++) {
        double end[2], at[2] = {0, 0}, quick[2];
        outline_point(end, half, n);
        for (int m = 1; m <= march_steps; m++) {
            const double x = end[0] * m / march_steps, y = end[1] * m / march_steps;
            if (!solve(at, l, x, y)) return false;
            lens_back_within(quick, l, x, y);
            if (!(hypot(quick[0] - at[0], quick[1] - at[1]) <= 1e-12)) return false;
        }
        farthest = fmax(farthest, hypot(at[0], at[1]));
        for (int k = 0; k < 2; k++) l->tangent[k] = fmax(l->tangent[k], fabs(at[k]));
    }
    l->reach = 1.01 * farthest;
    for (int a = 0; a < 64; a++)
        for (int n = 1; n <= march_steps; n++) {
            const double r = l->reach * n / march_steps, angle_rad = 2 * pi_rad * a / 64;
            if (!slopes_are_good(l, r * cos(angle_rad), r * sin(angle_rad))) return false;
        }
    return true;
}

/* Twice the largest second difference of the inverse on a grid over the picture. */
static void bound_bend(Lens *l, const double half[2])
{
    const double hx = 2 * half[0] / grid, hy = 2 * half[1] / grid;
    double       most = 0;
    for (int j = 1; j < grid; j++)
        for (int i = 1; i < grid; i++) {
            double at[3][3][2];
            for (int n = 0; n < 9; n++)
                lens_back_within(at[n / 3][n % 3], l, (i + n % 3 - 1) * hx - half[0], (j + n / 3 - 1) * hy - half[1]);
            for (int c = 0; c < 2; c++) {
                const double xx = at[1][0][c] - 2 * at[1][1][c] + at[1][2][c],
                             yy = at[0][1][c] - 2 * at[1][1][c] + at[2][1][c];
                most = fmax(most, fmax(fabs(xx) / (hx * hx), fabs(yy) / (hy * hy)));
            }
        }
    l->bend = 2 * most;
}

Status view_lens_make(Lens *out, const double k[3], const double p[2], const double half[2])
{
    Lens         l = {.k = {k[0], k[1], k[2]}, .p = {p[0], p[1]}};
    const double wide[2] = {lens_room * half[0], lens_room * half[1]};
    if (is_plain(k, p)) {
        *out = (Lens){0};
        return STATUS_OK;
    }
    if (!isfinite(k[0] + k[1] + k[2] + p[0] + p[1]) || !(half[0] > 0 && half[1] > 0)) return STATUS_BAD_VALUE;
    if (!follow_outline(&l, wide)) return STATUS_BAD_VALUE;
    bound_bend(&l, wide);
    const double step = 2 * fmax(wide[0], wide[1]) / side_points;
    for (int c = 0; c < 2; c++) l.tangent[c] += l.bend * step * step / 8;
    *out = l;
    return STATUS_OK;
}

/* The map beyond `reach` and its slopes; those are not the same both ways: [d x / dx, d x / dy, d y / dx, d y / dy]. */
static void image_beyond(double image[2], double slope[4], const Lens *l, double x, double y)
{
    const double r = hypot(x, y), u[2] = {x / r, y / r}, far = r / l->reach;
    double       edge[2], s[3];
    lens_polynomial(edge, l, l->reach * u[0], l->reach * u[1]);
    lens_slopes(s, l, l->reach * u[0], l->reach * u[1]);
    for (int c = 0; c < 2; c++) image[c] = far * edge[c];
    if (!slope) return;
    /* along u it grows by edge / reach; across by the polynomial's slopes at the reach */
    const double across[3] = {1 - u[0] * u[0], -u[0] * u[1], 1 - u[1] * u[1]};
    slope[0] = edge[0] / l->reach * u[0] + s[0] * across[0] + s[2] * across[1];
    slope[1] = edge[0] / l->reach * u[1] + s[0] * across[1] + s[2] * across[2];
    slope[2] = edge[1] / l->reach * u[0] + s[2] * across[0] + s[1] * across[1];
    slope[3] = edge[1] / l->reach * u[1] + s[2] * across[1] + s[1] * across[2];
}

void view_lens_image(double image[2], const Lens *l, double x, double y)
{
    if (x * x + y * y <= l->reach * l->reach) lens_polynomial(image, l, x, y);
    else image_beyond(image, NULL, l, x, y);
}

void view_lens_back(double out[2], const Lens *l, double x_image, double y_image)
{
    double at[2];
    lens_back_within(at, l, x_image, y_image);
    if (at[0] * at[0] + at[1] * at[1] <= l->reach * l->reach && miss(l, at, x_image, y_image) <= 1e-10) {
        memcpy(out, at, sizeof at);
        return;
    }
    at[0] = x_image, at[1] = y_image;
    for (int n = 0; n < 30; n++) {
        double image[2], s[4];
        if (at[0] * at[0] + at[1] * at[1] <= l->reach * l->reach) { /* the next step must start outside */
            const double out_by = 1.0001 * l->reach / hypot(at[0], at[1]);
            at[0] = isfinite(out_by) ? at[0] * out_by : 1.0001 * l->reach,
            at[1] = isfinite(out_by) ? at[1] * out_by : 0;
        }
        image_beyond(image, s, l, at[0], at[1]);
        const double dx = x_image - image[0], dy = y_image - image[1], det = s[0] * s[3] - s[1] * s[2];
        at[0] += (s[3] * dx - s[1] * dy) / det;
        at[1] += (s[0] * dy - s[2] * dx) / det;
    }
    memcpy(out, at, sizeof at);
}

double view_lens_area(const Lens *l, double x, double y)
{
    double s[3];
    lens_slopes(s, l, x, y);
    return s[0] * s[1] - s[2] * s[2];
}

void view_lens_box(double out[4], const Lens *l, const double image[4])
{
    enum { points = 3 }; /* on each side */
    const double w = image[2] - image[0], h = image[3] - image[1];
    double       box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY}, farthest = 0;
    for (int n = 0; n < points * points; n++) {
        double at[2];
        view_lens_back(at, l, image[0] + 0.5 * w * (n % points), image[1] + 0.5 * h * (n / points));
        farthest = fmax(farthest, hypot(at[0], at[1]));
        for (int c = 0; c < 2; c++) box[c] = fmin(box[c], at[c]), box[c + 2] = fmax(box[c + 2], at[c]);
    }
    /* an arc between points that are half a side apart; over the kink at the reach, anything so large can be */
    const double half = 0.5 * fmax(w, h);
    const double room = farthest < l->reach ? l->bend * half * half / 8 : 0.5 * half + l->bend * half * half;
    for (int c = 0; c < 2; c++) out[c] = box[c] - room - 1e-12, out[c + 2] = box[c + 2] + room + 1e-12;
}
