/* A column of detectors swept over the picture, with stages that are added up (scanning_flir2): when each column is
 * taken, what belongs to a row, and what the stages gain; against kinematics, the sweep by lines turned over, and the
 * square root of their number. labels: physics */
#include "tests/check.h"

#include "render/materials/planck.h"
#include "sensor/detector/chain.h"

enum { width = 160, height = 120, pixels = width * height, frames = 40 };
static float        plane[pixels], turned[pixels], by_lines[pixels], by_columns[pixels], line[width + line_scan_taps];
static const double still[2] = {0, 0};

static SensorPreset preset_of(const char *name)
{
    char         path[512];
    SensorPreset p;
    CHECK(etc_path(path, sizeof path, "sensors.csv"));
    assert_int_equal(preset_read(&p, path, name), STATUS_OK);
    return p;
}

static void run_chain(Chain *chain, int frame, const double rate_px_s[2])
{
    const float *in[1] = {plane};
    chain_expose(chain, in);
    chain_run(chain, in, NULL, frame, rate_px_s);
}

static void fill(double temp_k)
{
    for (int i = 0; i < pixels; i++) plane[i] = (float)planck_band(8e-6, 12e-6, temp_k, NULL);
}

/* A picture with rows and columns exchanged, and its motion, swept by columns: the one swept by lines, exchanged, to
 * the bit. */
static void columns_are_lines_turned_over(void **state)
{
    (void)state;
    static const double active[2] = {0, 0.8}, rates[3][2] = {{300, -200}, {0, 1500}, {-2500, 0}};
    for (int i = 0; i < pixels; i++) plane[i] = (float)(100 + 50 * random_uniform(3, 1, 0, (uint64_t)i));
    for (int r = 0; r < height; r++)
        for (int c = 0; c < width; c++) turned[c * height + r] = plane[r * width + c];
    for (int n = 0; n < 6; n++) {
        const double  *rate = rates[n % 3], exchanged[2] = {rate[1], rate[0]};
        const LineScan lines = {.line_s = 1e-4, .active = active[n / 3]},
                       columns = {.line_s = 1e-4, .active = active[n / 3], .by_columns = true};
        line_scan_resample(by_lines, turned, height, width, &lines, exchanged, line);
        line_scan_resample(by_columns, plane, width, height, &columns, rate, line);
        for (int r = 0; r < height; r++)
            for (int c = 0; c < width; c++) CHECK(by_columns[r * width + c] == by_lines[c * height + r]);
    }
}

/* Each column stands where the scene is at its time: a level edge that falls is a slope, of rate x the time of a
 * column. */
static void each_column_has_its_own_time(void **state)
{
    (void)state;
    SensorPreset p = preset_of("scanning_flir2");
    CHECK(p.scan.by_columns && p.tdi == 4);
    const double rate_px_s[2] = {0, 800};
    for (int i = 0; i < pixels; i++) plane[i] = (float)(10 + 0.05 * (i / width));
    line_scan_resample(by_columns, plane, width, height, &p.scan, rate_px_s, line);
    for (int c = 0; c < width; c++) {
        const double t_s = p.scan.line_s * (c + 0.5 - 0.5 * width);
        CHECK_NEAR(line_scan_time_s(&p.scan, width, height, c + 0.5, 3), t_s, 1e-15);
        /* 16 taps place a slope within 0.005 px, the phases within 1/512 */
        CHECK_NEAR((by_columns[60 * width + c] - 10) / 0.05, 60 - rate_px_s[1] * t_s, 0.005 + 1.0 / 512);
    }
}

/* Temporal noise over signal of a pixel, K. */
static double netd_k(const SensorPreset *p)
{
    static double sum[pixels], sum2[pixels];
    Chain        *chain;
    double        warm = 0, cool = 0, variance = 0;
    assert_int_equal(chain_create(&chain, p, width, height, 1, 5), STATUS_OK);
    memset(sum, 0, sizeof sum), memset(sum2, 0, sizeof sum2);
    fill(301);
    run_chain(chain, 1000, still);
    for (int i = 0; i < pixels; i++) warm += chain_counts(chain, 0)[i] / (double)pixels;
    fill(299);
    run_chain(chain, 1000, still);
    for (int i = 0; i < pixels; i++) cool += chain_counts(chain, 0)[i] / (double)pixels;
    fill(300);
    for (int f = 0; f < frames; f++) {
        run_chain(chain, f, still);
        for (int i = 0; i < pixels; i++) {
            const double x = chain_counts(chain, 0)[i];
            sum[i] += x, sum2[i] += x * x;
        }
    }
    for (int i = 0; i < pixels; i++) variance += (sum2[i] - sum[i] * sum[i] / frames) / (frames - 1) / pixels;
    chain_destroy(chain);
    return sqrt(variance) / (0.5 * (warm - cool));
}

/* One, four and nine stages, with photons, dark current and reading all at work: noise falls by the root of their
 * number. Steps of the converter are fine here. 40 x 19200 samples: 0.1 % of sigma. */
static void stages_gain_the_root_of_their_number(void **state)
{
    (void)state;
    SensorPreset p = preset_of("scanning_flir2");
    for (int a = NOISE_TV; a < noise_axes; a++) p.ratio.sigma[a] = 0;
    p.prnu = p.line_noise = p.ac_per_line = 0;
    p.bits = 16;
    p.photons.well_e = 4e7;
    double one_k = 0;
    for (int root = 1; root <= 3; root++) {
        const int stages = root * root;
        p.tdi = stages;
        const double got_k = netd_k(&p);
        if (stages == 1) {
            one_k = got_k;
            /* by hand: the square root of all electrons and read_e squared, over electrons a kelvin */
            CHECK_NEAR(got_k / photon_netd_k(&p.photons, 300, 4e7 / 65535, 0), 1, 0.01);
        }
        CHECK_NEAR(one_k / got_k, root, 0.01 * root);
    }
}

/* A row is one detector's: fixed noise and gain are the same all along it, and differ from row to row. */
static void a_row_has_one_detector(void **state)
{
    (void)state;
    SensorPreset p = preset_of("scanning_flir2");
    Chain       *chain;
    p.ratio = (Noise3d){.sigma = {[NOISE_V] = 1}};
    p.prnu = 0.01;
    p.photons.read_e = p.ac_per_line = p.line_noise = 0;
    p.photons.well_e = 1.2e7;
    assert_int_equal(chain_create(&chain, &p, width, height, 1, 5), STATUS_OK);
    fill(300);
    static double mean[height];
    double        spread = 0, all = 0, along = 0;
    for (int f = 0; f < 64; f++) {
        run_chain(chain, f, still);
        for (int r = 0; r < height; r++)
            for (int c = 0; c < width; c++)
                mean[r] += chain_counts(chain, 0)[r * width + c] / (64.0 * width),
                    all += chain_counts(chain, 0)[r * width + c] / (64.0 * pixels);
    }
    for (int r = 0; r < height; r++) spread += (mean[r] - all) * (mean[r] - all) / (height - 1);
    /* halves of a row differ by temporal noise alone */
    for (int r = 0; r < height; r++) {
        double half = 0;
        for (int c = 0; c < width; c++)
            half += (c < width / 2 ? 1 : -1) * (double)chain_counts(chain, 0)[r * width + c] / width;
        along += half * half / height;
    }
    const PhotonDetector d = preset_photons(&p);
    const double         signal_e = photon_electrons(&d, 300, NULL), step_e = chain_step_e(chain);
    const double sigma2 = signal_e + d.dark_e, want2 = (sigma2 + 1e-4 * signal_e * signal_e) / (step_e * step_e);
    /* variances of 120 rows: three of their standard errors of 13 %, so that half and double fail */
    CHECK_NEAR(spread / want2, 1, 3 * sqrt(2.0 / height));
    CHECK_NEAR(along / (sigma2 / (step_e * step_e) / width), 1, 3 * sqrt(2.0 / height));
    chain_destroy(chain);
}

/* Ripples along the rows lose what a detector passes over while a stage looks: sinc(time / column time x f), beside
 * those down the columns; the scene's own motion is smeared over all stages. */
static void the_sweep_blurs_along_the_rows(void **state)
{
    (void)state;
    SensorPreset p = preset_of("scanning_flir2");
    Chain       *chain;
    p.noise_scale = p.ac_per_line = 0;
    p.bits = 16;
    p.photons.integration_s = 0.9 * p.scan.line_s;
    preset_refresh(&p);
    assert_int_equal(chain_create(&chain, &p, width, height, 1, 5), STATUS_OK);
    double       amplitude[3] = {0};
    const double moving[2] = {0, 0.25 / (4 * p.photons.integration_s)};
    for (int k = 0; k < 3; k++) {
        for (int r = 0; r < height; r++)
            for (int c = 0; c < width; c++)
                plane[r * width + c] = (float)(30 + 10 * cos(2 * pi_rad * ((k == 0 ? c : r) + 0.5) / 5));
        run_chain(chain, 0, k == 2 ? moving : still);
        double re = 0, im = 0;
        for (int r = 20; r < 100; r++)
            for (int c = 40; c < 120; c++) {
                const double a = 2 * pi_rad * (k == 0 ? c : r) / 5;
                re += chain_counts(chain, 0)[r * width + c] * cos(a),
                    im += chain_counts(chain, 0)[r * width + c] * sin(a);
            }
        amplitude[k] = hypot(re, im);
    }
    const double x = pi_rad * 0.9 / 5, y = pi_rad * 0.25 / 5;
    CHECK_NEAR(amplitude[0] / amplitude[1], sin(x) / x, 0.002);
    /* down the columns, each at its own time: the phase runs across the picture, so that 80 columns do not add up whole
     */
    const double turn = 2 * pi_rad / 5 * moving[1] * preset_of("scanning_flir2").scan.line_s,
                 lost = sin(40 * turn) / (80 * sin(turn / 2));
    CHECK_NEAR(amplitude[2] / amplitude[1] / fabs(lost), sin(y) / y, 0.004);
    chain_destroy(chain);
}

int main(void)
{
    thread_flush_denormals();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_are_lines_turned_over),        cmocka_unit_test(each_column_has_its_own_time),
        cmocka_unit_test(stages_gain_the_root_of_their_number), cmocka_unit_test(a_row_has_one_detector),
        cmocka_unit_test(the_sweep_blurs_along_the_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
