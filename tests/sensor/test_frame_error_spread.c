/* What a frame says of its pixels, median_k and beyond_1k, against the same frame sampled finely: 12 x 12 rays in every
 * pixel, adaptive sampling off, on a ground of four times as many posts and with heat in finer steps, pixel by pixel.
 * labels: physics deep */
#include "tests/sensor/error_scenes.h"

#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Of the differences in apparent temperature between two frames. */
static void spread_of(double *median_k, double *beyond, const TrialFrame *a, const TrialFrame *b, Band band)
{
    static double      apart_k[width_px * height_px];
    const World       *world = &a->scene->world;
    const PlanckTable *planck = band == BAND_MWIR ? world->planck_mwir : world->planck_lwir;
    const float       *p = band == BAND_MWIR ? a->picture.mwir : a->picture.lwir;
    const float       *q = band == BAND_MWIR ? b->picture.mwir : b->picture.lwir;
    int                over = 0;
    for (int i = 0; i < width_px * height_px; i++) {
        apart_k[i] = fabs(planck_table_temp(planck, (double)p[i]) - planck_table_temp(planck, (double)q[i]));
        over += apart_k[i] > 1;
    }
    qsort(apart_k, width_px * height_px, sizeof *apart_k, by_value);
    *median_k = apart_k[width_px * height_px / 2];
    *beyond = over / (double)(width_px * height_px);
}

static const ErrorScene scenes[] = {
    {"vehicles at 60 m", 60, 12, 40, 6, false, 0, true},
    {"vehicles at 250 m", 250, 40, 20, 8, false, 0, true},
    {"vehicles at 600 m", 600, 60, 12, 10, false, 0, false},
};

static bool within(double estimate, double truth, double factor)
{
    return estimate < factor * truth && truth < factor * estimate;
}

/* The median is never below the truth, and at most 30 % above it in LWIR (measured: 4 to 20 %), 35 % in MWIR (16 to 32
 * %; why it is more is not known; it was 28 % before direct light that heats, and with it what is estimated of heat's
 * error, rose by a tenth). The share beyond 1 K within a factor of 2 in LWIR, of 4 in MWIR, whose slope, W/(m2 sr K),
 * is twice as steep at a hot hull as at the mean by which sampling is turned into kelvin. */
static bool holds(const FrameError *error, Band band, double median_k, double beyond)
{
    return error->median_k[band] >= median_k && error->median_k[band] <= (band == BAND_MWIR ? 1.35 : 1.3) * median_k &&
           within(error->beyond_1k[band], beyond, band == BAND_MWIR ? 4 : 2);
}

static void pixels_are_as_good_as_they_say(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        ErrorCase  c;
        TrialScene fine;
        open_case(&c, &scenes[k]);
        open_scene(&fine, &lab.fine, &scenes[k]);
        HeatConfig heat = heat_default_config();
        heat.step_s = 300, heat.facets = 11, heat.grid = (GroundGrid){0.0012, 1.17, 3, 0.002};
        CHECK(trial_scene_warm(&fine, &heat) == STATUS_OK);
        fine.past_parts = 8;
        RenderRequest request = c.request;
        request.samples = 12, request.edge_samples = request.target_samples = 0;
        const TrialFrame better = frame_of(&fine, &request, 1);
        for (int b = BAND_MWIR; b <= BAND_LWIR; b++) {
            double median_k, beyond;
            spread_of(&median_k, &beyond, &c.frame, &better, (Band)b);
            print_message("%-20s %-5s median: estimate %.3f K, truth %.3f K; beyond 1 K: estimate %.4f, truth %.4f\n",
                          scenes[k].name, band_name((Band)b), c.error.median_k[b], median_k, c.error.beyond_1k[b],
                          beyond);
            CHECK(holds(&c.error, (Band)b, median_k, beyond));
            /* twins: a frame that is a pixel row off, and one that is the reference itself, are not what it says */
            CHECK(!holds(&c.error, (Band)b, 0, 0));
            float *shifted = b == BAND_MWIR ? c.frame.picture.mwir : c.frame.picture.lwir;
            memmove(shifted + width_px, shifted, sizeof *shifted * width_px * (height_px - 1));
            spread_of(&median_k, &beyond, &c.frame, &better, (Band)b);
            CHECK(!holds(&c.error, (Band)b, median_k, beyond));
        }
        trial_scene_close(&fine);
        close_case(&c);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(pixels_are_as_good_as_they_say)};
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
