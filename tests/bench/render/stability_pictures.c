/* tests/bench/render/stability_pictures.c: whole pictures: a block from 0.1 m to 200 km and at any place on the
 * Earth, every field of view and size. References: a rectangle of known size, reflectance and temperature; the same
 * picture elsewhere. */
#include "tests/bench/suites.h"
#include "tests/scenes/stress_world.h"

#include <stdlib.h>

static void worse(double *worst, double error)
{
    if (!(error <= *worst)) *worst = isnan(error) ? INFINITY : error;
}

/* Attitude of an upright block whose left side faces a viewer along d_enu, which is level. */
static void facing(double r[9], const double d_enu[3])
{
    const double right[3] = {d_enu[0], d_enu[1], d_enu[2]}, down[3] = {0, 0, -1};
    double       forward[3];
    v3_cross(forward, right, down);
    for (int k = 0; k < 3; k++) r[3 * k] = forward[k], r[3 * k + 1] = right[k], r[3 * k + 2] = down[k];
}

/* ---- ranges ------------------------------------------------------------------------------------- */

typedef struct Ranges {
    StressWorld *world;
    bool         done;
    /* worst relative errors: radiance, against rho E cos / pi and Planck; size, of the area; edge_px in pixels; of the
     * range */
    double radiance, size, edge_px, range;
} Ranges;

/* Lets the block fill 100 columns at every range, sampled in both ways: as what it is, and as a small target, 5 columns
 * wide. */
static void one_range(Ranges *r, double range_m, double columns)
{
    StressWorld *w = r->world;
    const double north[3] = {0, 1, 0}, sun_enu[3] = {0, -0.6, 0.8}, eye[3] = {0, 0, 50}, to[3] = {0, range_m, 50};
    const int    width = (int)(1.6 * columns) / 2 * 2, height = (int)(0.8 * columns) / 2 * 2;
    const View   view = stress_view(eye, north, 0, width, height, columns * range_m / stress_size_m[0]);
    const RenderRequest request = stress_request(&view);
    double              attitude[9];
    stress_no_air(w, sun_enu);
    stress_clear(w);
    facing(attitude, north);
    stress_add(w, to, attitude);
    if (!stress_render(w, &request)) {
        r->radiance = INFINITY;
        return;
    }
    const Picture      *p = &w->picture;
    const TargetPixels *t = &p->target[0];
    const size_t        middle = (size_t)(height / 2) * (size_t)width + (size_t)(width / 2);
    const double        half_px[2] = {0.5 * columns, 0.5 * columns * stress_size_m[2] / stress_size_m[0]},
                 area = 4 * half_px[0] * half_px[1];
    const double temp_k = w->air.light.weather.air_temp_k,
                 optical = (double)stress_rho / pi_rad * stress_sun_w_m2 * 0.6;
    const double thermal = (1 - (double)stress_rho_ir) * planck_band(8e-6, 12e-6, temp_k, NULL);
    worse(&r->radiance, fabs((t->small ? t->mean[picture_optical] : (double)p->optical[0][middle]) / optical - 1));
    worse(&r->radiance, fabs((t->small ? t->mean[picture_lwir] : (double)p->lwir[middle]) / thermal - 1));
    /* half a pixel off the axis both ways; of a small target it is that of a sample near by */
    if (!t->small)
        worse(&r->range,
              fabs((double)p->range_m[middle] / (range_m * sqrt(1 + 0.5 / (view.focal_px * view.focal_px))) - 1));
    worse(&r->size, fabs(t->visible / area - 1));
    for (int k = 0; k < 4; k++)
        worse(&r->edge_px,
              fabs(t->projected_box[k] - (0.5 * (k % 2 ? height : width) + (k < 2 ? -1 : 1) * half_px[k % 2])));
}

static const Ranges *ranges(void *user, bool quick)
{
    Ranges *r = user;
    if (r->done) return r;
    r->done = true;
    for (int k = 0; k <= (quick ? 6 : 60); k++) {
        const double range_m = 0.1 * pow(2e6, k / (quick ? 6.0 : 60));
        one_range(r, range_m, 100);
        one_range(r, range_m, 5);
    }
    return r;
}

static double range_radiance(void *user, bool quick) { return ranges(user, quick)->radiance; }
static double range_size(void *user, bool quick) { return ranges(user, quick)->size; }
static double range_edge(void *user, bool quick) { return ranges(user, quick)->edge_px; }
static double range_range(void *user, bool quick) { return ranges(user, quick)->range; }

/* ---- origins ------------------------------------------------------------------------------------ */

typedef struct Origins {
    StressWorld *world;
    bool         done;
    double       pixels, radiance, edge_px;
} Origins;

enum { origin_px = 96 };

static bool origin_picture(StressWorld *w, const double away_enu[3])
{
    const double sun_enu[3] = {0, -0.6, 0.8}, d_enu[3] = {0.3, 0.9, -0.1};
    double       eye[3] = {10, -200, 40}, r[9], level[3] = {0.6, 0.8, 0};
    v3_add(eye, eye, away_enu);
    const View          view = stress_view(eye, d_enu, 0.1, origin_px, origin_px, 200);
    const RenderRequest request = stress_request(&view);
    stress_no_air(w, sun_enu);
    stress_clear(w);
    facing(r, level);
    for (int k = 0; k < 8; k++) {
        double p[3] = {20 + 12 * k, 10 + 15 * k, 15 + k};
        v3_add(p, p, away_enu);
        stress_add(w, p, r);
    }
    return stress_render(w, &request);
}

/* Puts the terrain's origin elsewhere on the Earth, and the scene up to 200 km from it: the picture must be the same.
 */
static const Origins *origins(void *user, bool quick)
{
    Origins        *o = user;
    static float    optical[origin_px * origin_px], lwir[origin_px * origin_px];
    static uint32_t entity[origin_px * origin_px];
    double          box[8][4], none[3] = {0, 0, 0};
    Dice            dice = {.stream = 50};
    if (o->done) return o;
    o->done = true;
    StressWorld     *w = o->world;
    const LocalFrame home = w->world.frame;
    if (!origin_picture(w, none)) o->pixels = INFINITY;
    memcpy(optical, w->picture.optical[0], sizeof optical);
    memcpy(lwir, w->picture.lwir, sizeof lwir);
    memcpy(entity, w->picture.entity, sizeof entity);
    for (int k = 0; k < 8; k++) memcpy(box[k], w->picture.target[k].projected_box, sizeof box[k]);
    for (int n = quick ? 8 : 200; n > 0; n--) {
        const Geodetic place = {n % 5 == 0 ? 0.5 * pi_rad : stress_uniform(&dice, -1.57, 1.57),
                                stress_uniform(&dice, -pi_rad, pi_rad), stress_uniform(&dice, -400, 9000)};
        double away[3];
        stress_direction(away, &dice);
        v3_scale(away, n % 3 ? stress_log_uniform(&dice, 1, 200e3) : 200e3, away);
        if (local_frame_at(&w->world.frame, &place) != STATUS_OK || !origin_picture(w, away)) o->pixels = INFINITY;
        for (int i = 0; i < origin_px * origin_px && w->picture.optical[0]; i++) {
            if (entity[i] != w->picture.entity[i]) {
                o->pixels++;
                continue;
            }
            worse(&o->radiance, fabs((double)w->picture.lwir[i] - (double)lwir[i]) / 10);
        }
        for (int k = 0; k < 8; k++)
            for (int s = 0; s < 4; s++) worse(&o->edge_px, fabs(w->picture.target[k].projected_box[s] - box[k][s]));
    }
    w->world.frame = home;
    return o;
}

static double origin_pixels(void *user, bool quick) { return origins(user, quick)->pixels; }
static double origin_radiance(void *user, bool quick) { return origins(user, quick)->radiance; }
static double origin_edge(void *user, bool quick) { return origins(user, quick)->edge_px; }

/* ---- fields of view ------------------------------------------------------------------------------ */

typedef struct Fields {
    double length, back_px;
} Fields;

/* Rays of 0.01 to 179 degrees: of unit length, and in agreement with their projection: 0.01 degree over 8192 px is a
 * focal length of 4.7e7 px, of which a rounding is 1e-8. Towards the rim of a wide view a pixel is as much larger as
 * its tangent. */
static Fields fields(bool quick)
{
    Fields worst = {0};
    Dice   dice = {.stream = 51};
    for (int n = quick ? 20000 : 1000000; n > 0; n--) {
        const double hfov_rad = stress_log_uniform(&dice, 0.01, 179) * rad_per_deg;
        const int    width = n % 3 ? (int)stress_log_uniform(&dice, 1, 8192) : 8192;
        View         view = {.width = width,
                             .height = n % 2 ? width : 1 + 8191 * (n % 4 == 0),
                             .focal_px = view_focal_px(width, hfov_rad)};
        double       d[3], cam[3];
        stress_any_rotation(view.r_enu_from_cam, &dice);
        const double column = stress_uniform(&dice, 0, width), row = stress_uniform(&dice, 0, view.height);
        view_ray(d, &view, column, row);
        m3_tmul_v3(cam, view.r_enu_from_cam, d);
        worse(&worst.length, fabs(v3_length(d) - 1));
        worse(&worst.back_px,
              fabs(0.5 * width + view.focal_px * cam[0] / cam[2] - column) / fmax(1, hypot(cam[0], cam[1]) / cam[2]));
        worse(&worst.back_px, fabs(0.5 * view.height + view.focal_px * cam[1] / cam[2] - row) /
                                  fmax(1, hypot(cam[0], cam[1]) / cam[2]));
    }
    return worst;
}

static double field_length(void *user, bool quick)
{
    (void)user;
    return fields(quick).length;
}
static double field_back(void *user, bool quick)
{
    (void)user;
    return fields(quick).back_px;
}

/* ---- sizes --------------------------------------------------------------------------------------- */

/* A view of the ground from 300 m with some blocks on it, one sample a pixel: the edges pass would depend on
 * neighbours. */
static RenderRequest size_request(StressWorld *w, int width, int height)
{
    const double  d_enu[3] = {0, 1, -0.4};
    const double  eye[3] = {0, -400, 300};
    const View    view = stress_view(eye, d_enu, 0.05, width, height, 600);
    RenderRequest request = stress_request(&view);
    double        r[9], level[3] = {0.6, 0.8, 0};
    facing(r, level);
    stress_clear(w);
    for (int k = 0; k < 30; k++) {
        const double p[3] = {8.0 * k - 120, 15.0 * k - 300, 20};
        stress_add(w, p, r);
    }
    request.edge_samples = request.target_samples = 0;
    return request;
}

/* Odd, long, thin and single: each equals the middle of the largest, which has the same rays there, to the bit. */
static double sizes(void *user, bool quick)
{
    static const int size[][2] = {{1, 1},    {3, 1},    {1, 3},    {31, 33},  {33, 7},
                                  {1, 8191}, {8191, 1}, {1, 8192}, {8192, 1}, {64, 64}};
    StressWorld     *w = user;
    double           wrong = 0;
    Arena           *kept = arena_create(), *own = w->arena;
    Picture          small;
    if (!kept || stress_real_air(w, 0.5, 300) != STATUS_OK) return INFINITY;
    w->world.landscape = &w->landscape;
    for (int k = 0; k < 10; k++) {
        RenderRequest request = size_request(w, size[k][0], size[k][1]);
        w->arena = kept;
        bool made = stress_render(w, &request);
        w->arena = own;
        small = w->picture;
        wrong += made ? stress_bad_values(&small) : INFINITY;
        /* the sizes have the same parity, so that the middles agree, and differ by a row or column of tiles at least */
        request.view.width = size[k][0] % 2 + (size[k][0] > 100 ? 8190 : quick ? 64 : 256);
        request.view.height = size[k][1] % 2 + (size[k][1] > 100 ? 8190 : quick ? 64 : 256);
        const int w0 = size[k][0] < request.view.width ? size[k][0] : request.view.width;
        const int h0 = size[k][1] < request.view.height ? size[k][1] : request.view.height;
        made = made && stress_render(w, &request);
        wrong += made ? stress_differences(&small, (size[k][0] - w0) / 2, (size[k][1] - h0) / 2, &w->picture,
                                           (request.view.width - w0) / 2, (request.view.height - h0) / 2, w0, h0)
                      : INFINITY;
    }
    w->world.landscape = NULL;
    arena_destroy(kept);
    return wrong;
}

/* Renders the largest possible size, long-wave alone: its centre must be that of a small one, and its values valid. */
static double largest(void *user, bool quick)
{
    StressWorld  *w = user;
    Arena        *kept = arena_create(), *own = w->arena;
    RenderRequest request = size_request(w, 256, 256);
    double        wrong = 0;
    (void)quick;
    if (!kept || stress_real_air(w, 0.5, 300) != STATUS_OK) return INFINITY;
    request.bands = 1 << BAND_LWIR;
    w->world.landscape = &w->landscape;
    w->arena = kept;
    bool          made = stress_render(w, &request);
    const Picture small = w->picture;
    w->arena = own;
    request.view.width = request.view.height = 8192;
    request.truth = false;
    made = made && stress_render(w, &request);
    if (made) {
        w->picture.range_m = NULL;
        wrong = stress_bad_values(&w->picture);
        for (int y = 0; y < 256; y++)
            wrong +=
                memcmp(w->picture.lwir + (size_t)(3968 + y) * 8192 + 3968, small.lwir + (size_t)y * 256, 256 * 4) != 0;
    }
    w->world.landscape = NULL;
    arena_destroy(kept);
    arena_destroy(w->arena); /* the memory of such a picture is released */
    w->arena = arena_create();
    return made && w->arena ? wrong : INFINITY;
}

/* Puts one block in front of every pixel, at the finest sampling, for the largest fixed-point sums, which are compared
 * with count and mean. */
static double full_sums(void *user, bool quick)
{
    StressWorld *w = user;
    const double north[3] = {0, 1, 0}, eye[3] = {0, 0, 50}, to[3] = {0, 3, 50}, sun_enu[3] = {0, -0.6, 0.8};
    double       worst = 0, r[9];
    const int    side[4] = {quick ? 256 : 4096, 256, 64, 40}, samples[4] = {1, 1, 4, 16}, edge[4] = {0, 4, 0, 0};
    facing(r, north);
    for (int k = 0; k < 4; k++) {
        const View    view = stress_view(eye, north, 0, side[k], side[k], 3.0 * side[k]);
        RenderRequest request = stress_request(&view);
        request.bands = 1 << BAND_OPTICAL;
        request.samples = samples[k], request.edge_samples = edge[k];
        stress_no_air(w, sun_enu);
        stress_clear(w);
        stress_add(w, to, r);
        if (!stress_render(w, &request)) return INFINITY;
        const TargetPixels *t = &w->picture.target[0];
        double              sum = 0;
        for (int y = 0; y < side[k]; y++)
            for (int x = 0; x < side[k]; x++) {
                const double u = (x + 0.5 - 0.5 * side[k]) / view.focal_px,
                             v = (y + 0.5 - 0.5 * side[k]) / view.focal_px;
                sum += pow(1 + u * u + v * v, -1.5) * ((double)stress_rho / pi_rad * stress_sun_w_m2 * 0.6);
            }
        worse(&worst, fabs(t->visible / ((double)side[k] * side[k]) - 1));
        worse(&worst, fabs(t->radiance[picture_optical] / sum - 1));
    }
    return worst;
}

Status bench_stability_pictures(Bench *bench)
{
    static const StressCase range_cases[] = {
        {"picture: a block at 0.1 m .. 200 km: radiance", range_radiance, 1e-5, "relative",
         "rho E cos / pi and Planck, no air"},
        {"picture: its area", range_size, 1e-3, "relative", "4 x 1.5 m by range"},
        {"picture: its edges", range_edge, 1e-6, "px", "4 x 1.5 m by range"},
        {"picture: its range", range_range, 1e-7, "relative", "where it was put; a float holds 6e-8"},
    };
    static const StressCase origin_cases[] = {
        {"picture: any place on Earth, to 200 km from the origin: pixels", origin_pixels, 0, "pixels of another",
         "the same at home"},
        {"picture: the same: radiance", origin_radiance, 1e-5, "relative", "the same at home"},
        {"picture: the same: edges", origin_edge, 1e-6, "px", "the same at home"},
    };
    static const StressCase cases[] = {
        {"view: 0.01 .. 179 degrees: rays", field_length, 1e-15, "of unit length", "1"},
        {"view: 0.01 .. 179 degrees: back to the picture", field_back, 5e-8, "px", "where the ray began"},
        {"picture: 1 x 1, odd, 8192 x 1, 1 x 8192", sizes, 0, "values", "the middle of a larger one, to the bit"},
        {"picture: a target before every sample, to 16 x 16", full_sums, 1e-6, "relative", "count, and a double's sum"},
    };
    static const StressCase full[] = {
        {"picture: 8192 x 8192", largest, 0, "values", "finite, not below 0; a small one, to the bit"},
    };
    StressWorld world;
    Status      status = stress_world_open(&world, bench_threads(bench));
    if (status != STATUS_OK) return status;
    Ranges  of_ranges = {.world = &world};
    Origins of_origins = {.world = &world};
    stress_cases(bench, range_cases, sizeof range_cases / sizeof *range_cases, &of_ranges);
    stress_cases(bench, origin_cases, sizeof origin_cases / sizeof *origin_cases, &of_origins);
    stress_cases(bench, cases, sizeof cases / sizeof *cases, &world);
    if (!bench_quick(bench)) stress_cases(bench, full, sizeof full / sizeof *full, &world);
    stress_world_close(&world);
    return STATUS_OK;
}
