/* The ground's noise in pictures: one class everywhere, at three ranges, optical and LWIR, against the unfiltered noise
 * averaged over each pixel by brute force; as the eye moves, against 256 rays a pixel; and switched off.
 * labels: physics */
#include "tests/render/hand_world.h"

#include "terrain/detail/detail.h"

enum { width = 120, height = 80, pixels = width * height, side = 12 };

static const double sun_enu[3] = {0, 0.6, 0.8}, ahead[3] = {0.8, 0.1, -0.6};

static DetailTable *table;

/* Every class with the same statistics, material and temperature: no borders. Without heights, whose slopes
 * tests/terrain/test_detail.c has: light is then in proportion to the reflectance. */
static int open_world(void **state)
{
    DetailStatistics statistics[SURFACE_COUNT][detail_fields] = {{{0}}};
    (void)state;
    if (hand_open(true) != 0) return -1;
    Materials *m = &hand.world.materials;
    for (int s = 1; s < SURFACE_COUNT; s++) {
        statistics[s][DETAIL_ALBEDO] = (DetailStatistics){0.2, 0.8, 0.2, 2.5, 0.8, 1};
        statistics[s][DETAIL_WARMTH] = (DetailStatistics){0.9, 1.0, 0.2, 2.5, 0.6, -0.3};
        m->surface[s] = m->surface[SURFACE_GRASS];
    }
    detail_table_close(hand.world.detail);
    hand.world.detail = NULL;
    if (detail_table_create(&table, (const DetailStatistics(*)[detail_fields])statistics, detail_cut_off) != STATUS_OK)
        return -1;
    hand_air_off(sun_enu);
    hand_clear();
    return 0;
}

static int close_world(void **state)
{
    detail_table_close(table);
    return hand_close(state);
}

static View view_from(double range_m, double focal_px, double east_m, double north_m, int wide, int high)
{
    const double ground_m = elevation_height(&hand.landscape.elevation, east_m, north_m, NULL);
    const double eye_enu[3] = {east_m - 0.8 * range_m, north_m - 0.1 * range_m, ground_m + 0.6 * range_m};
    return hand_view(eye_enu, ahead, wide, high, focal_px);
}

static RenderRequest request_from(const View *view, int samples)
{
    RenderRequest request = hand_request(view);
    request.bands = 1 << BAND_OPTICAL | 1 << BAND_LWIR;
    request.samples = samples;
    if (samples > 1) request.edge_samples = request.target_samples = 0;
    return request;
}

/* Reflectance over the class's, and kelvins above it, of every pixel. */
static void fields_of(float *albedo, float *warmth_k, const View *view, int samples)
{
    static float lwir[pixels], pan[pixels];
    const size_t n = (size_t)view->width * (size_t)view->height;
    const double air_k = hand.air.light.weather.air_temp_k, d_k = 0.5;
    const double per_k =
        (planck_band(8e-6, 12e-6, air_k + d_k, NULL) - planck_band(8e-6, 12e-6, air_k - d_k, NULL)) / (2 * d_k) *
        (1 - (double)hand.world.materials.material[hand.world.materials.surface[SURFACE_GRASS]].rho_lwir);
    const RenderRequest request = request_from(view, samples);
    RenderRequest       even = request;
    even.samples = 1;
    arena_reset(hand.arena);
    hand.world.detail = NULL;
    const Picture off = hand_render(&even, hand.pool);
    for (size_t i = 0; i < n; i++) pan[i] = picture_plane(&off, 0)[i], lwir[i] = off.lwir[i];
    hand.world.detail = table;
    const Picture on = hand_render(&request, hand.pool);
    hand.world.detail = NULL;
    for (size_t i = 0; i < n; i++) {
        CHECK(on.range_m[i] < INFINITY);
        albedo[i] = picture_plane(&on, 0)[i] / pan[i];
        warmth_k[i] = (float)((double)(on.lwir[i] - lwir[i]) / per_k);
    }
}

/* The same by side x side unfiltered places in every pixel, on the plane of its own hit. */
static void averages_of(float *albedo, float *warmth_k, const View *view)
{
    enum { places = side * side };
    static double x_m[places], y_m[places];
    static float  a[places], w[places], none[places];
    static uint8_t class[places];
    arena_reset(hand.arena);
    const RenderRequest request = request_from(view, 1);
    const Picture       p = hand_render(&request, hand.pool);
    memset(class, SURFACE_GRASS, sizeof class);
    for (int i = 0; i < pixels; i++) {
        double       d_hit[3], sum[2] = {0};
        const double n[3] = {p.normal[0][i], p.normal[1][i], p.normal[2][i]};
        view_ray(d_hit, view, i % width + 0.5, i / width + 0.5);
        for (int k = 0; k < places; k++) {
            double d[3];
            view_ray(d, view, i % width + (k % side + 0.5) / side, i / width + (k / side + 0.5) / side);
            const double range_m = (double)p.range_m[i] * v3_dot(n, d_hit) / v3_dot(n, d);
            x_m[k] = view->p_enu[0] + range_m * d[0], y_m[k] = view->p_enu[1] + range_m * d[1];
        }
        detail_at(&(GroundDetail){.albedo = a, .warmth_k = w}, table, &hand.landscape, places, class, x_m, y_m,
                  &(GroundFootprint){none, none});
        for (int k = 0; k < places; k++) sum[0] += (double)a[k], sum[1] += (double)w[k];
        albedo[i] = (float)(sum[0] / places), warmth_k[i] = (float)(sum[1] / places);
    }
}

typedef struct Sums {
    double count, one, two, three, beside[2];
} Sums;

static void add(Sums *s, const float *v, double mean)
{
    for (int y = 0; y + 1 < height; y++)
        for (int x = 0; x + 1 < width; x++) {
            const double d = (double)v[y * width + x] - mean;
            s->count++, s->one += d, s->two += d * d, s->three += d * d * d;
            s->beside[0] += d * ((double)v[y * width + x + 1] - mean);
            s->beside[1] += d * ((double)v[(y + 1) * width + x] - mean);
        }
}

static void statistics_are_those_of_the_filtered_class(void **state)
{
    static const struct {
        double range_m, focal_px;
        int    eyes;
    } from[] = {{150, 450, 4}, {400, 450, 2}, {1200, 450, 1}};
    static float a[2][pixels], w[2][pixels];
    (void)state;
    for (size_t r = 0; r < sizeof from / sizeof *from; r++) {
        Sums sum[2][2] = {{{0}}}; /* picture, averages; albedo, temperature */
        for (int eye = 0; eye < from[r].eyes; eye++) {
            const View view = view_from(from[r].range_m, from[r].focal_px, -300 + 150 * eye, 100 * eye, width, height);
            fields_of(a[0], w[0], &view, 1);
            averages_of(a[1], w[1], &view);
            for (int k = 0; k < 2; k++) add(&sum[k][0], a[k], 1), add(&sum[k][1], w[k], 0);
        }
        for (int f = 0; f < 2; f++) {
            double variance[2], skew[2], beside[2][2];
            for (int k = 0; k < 2; k++) {
                const Sums  *s = &sum[k][f];
                const double mean = s->one / s->count;
                variance[k] = s->two / s->count - mean * mean;
                skew[k] = (s->three / s->count - 3 * mean * s->two / s->count + 2 * mean * mean * mean) /
                          (variance[k] * sqrt(variance[k]));
                for (int d = 0; d < 2; d++) beside[k][d] = (s->beside[d] / s->count - mean * mean) / variance[k];
            }
            print_message("%s at %.0f m: deviation %.4f for %.4f, skew %.2f for %.2f, beside %.2f for %.2f, "
                          "behind %.2f for %.2f\n",
                          f ? "LWIR" : "optical", from[r].range_m, sqrt(variance[0]), sqrt(variance[1]), skew[0],
                          skew[1], beside[0][0], beside[1][0], beside[0][1], beside[1][1]);
            CHECK_NEAR(variance[0] / variance[1], 1, 0.10);
            CHECK_NEAR(skew[0], skew[1], fmax(0.25 * fabs(skew[1]), 0.1));
            for (int d = 0; d < 2; d++) CHECK_NEAR(beside[0][d], beside[1][d], 0.10);
        }
    }
}

/* Eyes that move by an eighth of a pixel a frame, aside and ahead: variance over time of the pixels of a patch. */
static void a_moving_eye_sees_no_shimmer(void **state)
{
    enum { frames = 9, wide = 40, high = 28, count = wide * high };
    static const double range_m = 400, focal_px = 450;
    static float        a[2][frames][count], w[2][frames][count];
    (void)state;
    for (int ahead_too = 0; ahead_too < 2; ahead_too++) {
        double variance[2][2] = {{0}}; /* one ray, 256 rays; albedo, temperature */
        for (int k = 0; k < frames; k++) {
            View         view = view_from(range_m, focal_px, 50, 80, wide, high);
            const double pixel_m = range_m / focal_px * k / 8;
            view.p_enu[0] += ahead_too ? pixel_m / 0.6 : 0;
            view.p_enu[1] += ahead_too ? 0 : pixel_m;
            fields_of(a[0][k], w[0][k], &view, 1);
            fields_of(a[1][k], w[1][k], &view, 16);
        }
        for (int c = 0; c < 2; c++)
            for (int i = 0; i < count; i++)
                for (int f = 0; f < 2; f++) {
                    double sum = 0, square = 0;
                    for (int k = 0; k < frames; k++) {
                        const double v = f ? (double)w[c][k][i] : (double)a[c][k][i];
                        sum += v / frames, square += v * v / frames;
                    }
                    variance[c][f] += (square - sum * sum) / count;
                }
        for (int f = 0; f < 2; f++) {
            print_message("%s, eye moving %s: variance over time %.2f of that of 256 rays\n", f ? "LWIR" : "optical",
                          ahead_too ? "ahead" : "aside", variance[0][f] / variance[1][f]);
            CHECK(variance[0][f] < 1.5 * variance[1][f]);
            CHECK(variance[0][f] > 0.5 * variance[1][f]);
        }
    }
}

/* Light of slopes is linear in them: its mean over a picture is the same with one ray a pixel, with 64, and without any
 * slopes; with normals of unit length it falls by half of their variance, 2 % here. */
static void slopes_keep_the_mean_light(void **state)
{
    DetailStatistics statistics[SURFACE_COUNT][detail_fields] = {{{0}}};
    const View       view = view_from(120, 450, -200, 50, width, height);
    DetailTable     *bumps = NULL;
    double           mean[3] = {0};
    (void)state;
    for (int s = 1; s < SURFACE_COUNT; s++)
        statistics[s][DETAIL_HEIGHT] = (DetailStatistics){0.06, 0.8, 0.2, 1.5, 0.8, 0};
    CHECK(detail_table_create(&bumps, (const DetailStatistics(*)[detail_fields])statistics, detail_cut_off) ==
          STATUS_OK);
    Material   *grass = &hand.world.materials.material[hand.world.materials.surface[SURFACE_GRASS]];
    const float gloss = grass->gloss;
    grass->gloss = 0; /* what mirrors is not linear */
    for (int k = 0; k < 3; k++) {
        const RenderRequest request = request_from(&view, k == 2 ? 8 : 1);
        hand.world.detail = k == 0 ? NULL : bumps;
        arena_reset(hand.arena);
        const Picture p = hand_render(&request, hand.pool);
        for (int i = 0; i < pixels; i++) mean[k] += (double)picture_plane(&p, 0)[i] / pixels;
    }
    hand.world.detail = NULL;
    grass->gloss = gloss;
    detail_table_close(bumps);
    print_message("mean light with slopes over that without: %.4f with one ray, %.4f with 64\n", mean[1] / mean[0],
                  mean[2] / mean[0]);
    CHECK_NEAR(mean[1] / mean[0], 1, 0.004);
    CHECK_NEAR(mean[2] / mean[0], 1, 0.004);
}

/* Off: the class's one value, to the bit that of a table without noise; but along ways, whose wear and ruts are on with
 * any table. */
static void off_is_even(void **state)
{
    static const DetailStatistics none[SURFACE_COUNT][detail_fields];
    DetailTable                  *even = NULL;
    static float                  lwir[pixels], pan[pixels];
    const View                    view = view_from(2400, 2700, 0, 0, width, height); /* too far for rows and ruts */
    const RenderRequest           request = request_from(&view, 1);
    (void)state;
    CHECK(detail_table_create(&even, none, detail_cut_off) == STATUS_OK);
    arena_reset(hand.arena);
    hand.world.detail = NULL;
    const Picture off = hand_render(&request, hand.pool);
    for (int i = 0; i < pixels; i++) pan[i] = picture_plane(&off, 0)[i], lwir[i] = off.lwir[i];
    hand.world.detail = even;
    const Picture on = hand_render(&request, hand.pool);
    hand.world.detail = NULL;
    int same = 0;
    for (int i = 0; i < pixels; i++) same += pan[i] == picture_plane(&on, 0)[i] && lwir[i] == on.lwir[i];
    print_message("%d of %d the same\n", same, (int)pixels);
    CHECK(same > 0.94 * pixels);
    detail_table_close(even);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(statistics_are_those_of_the_filtered_class),
        cmocka_unit_test(a_moving_eye_sees_no_shimmer),
        cmocka_unit_test(slopes_keep_the_mean_light),
        cmocka_unit_test(off_is_even),
    };
    return cmocka_run_group_tests(tests, open_world, close_world);
}
