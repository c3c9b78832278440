/* Waveforms by their times and frequencies: responses to a point, range-Doppler coupling, smear, folding, eclipsing and
 * signal to noise, of each row of etc/radars.csv that has one, against closed forms worked out here. labels: physics */
#include "tests/check.h"

#include "render/scattering/paths/radar_path.h"
#include "sensor/radar/echo.h"
#include "sensor/radar/radar_preset.h"

static const double      c_mps = 299792458.0;
static const char *const of_kind[waveform_kinds] = {"seeker_94", "stepped_35", "pulse_doppler_ku", "fmcw_94"};

typedef struct Chain {
    RadarPreset   preset;
    EchoGrid     *grid;
    IntervalPlan *plan;
    Interval      interval;
    RangeDoppler  map;
} Chain;

static void open_chain(Chain *chain, const char *name, const char *range_window, int pulses, bool uncompensated)
{
    char   path[4096];
    Window range, doppler;
    *chain = (Chain){0};
    CHECK(etc_path(path, sizeof path, "radars.csv") && radar_preset_read(&chain->preset, path, name) == STATUS_OK);
    Waveform *w = &chain->preset.wave;
    if (pulses) w->pulses = pulses;
    w->uncompensated = uncompensated;
    const size_t all = interval_channels * (size_t)w->samples * (size_t)w->pulses;
    CHECK(!window_parse(&range, range_window) && !window_parse(&doppler, "rect"));
    CHECK(echo_grid_create(&chain->grid, w) == STATUS_OK &&
          interval_plan_create(&chain->plan, w, &range, &doppler) == STATUS_OK);
    chain->interval = (Interval){.wave = *w, .sample = calloc(all, sizeof *chain->interval.sample)};
    chain->map.cell = calloc(all, sizeof *chain->map.cell);
    CHECK(chain->interval.sample && chain->map.cell);
}

static void close_chain(Chain *chain)
{
    echo_grid_destroy(chain->grid);
    interval_plan_destroy(chain->plan);
    free(chain->interval.sample);
    free(chain->map.cell);
}

/* One echo of amplitude 1 into the sum channel's map; range and rate over the reference's. */
static const double complex *map_of(Chain *chain, double range_m, double rate_mps)
{
    echo_add(chain->grid, &(Echo){2 * range_m, 2 * rate_mps / chain->preset.wave.repeat_hz, {1, 0, 0, 0}}, 1, NULL);
    echo_sum(chain->interval.sample, chain->grid);
    interval_process(&chain->map, chain->plan, &chain->interval, NULL);
    return chain->map.cell;
}

static double power_of(double complex v) { return creal(v) * creal(v) + cimag(v) * cimag(v); }

/* Power of a row's samples compressed at any range, by their sum. */
static double response(const Chain *chain, int row, double range_m)
{
    const Waveform *w = &chain->preset.wave;
    double complex  sum = 0;
    for (int m = 0; m < w->samples; m++)
        sum += chain->interval.sample[(size_t)row * (size_t)w->samples + (size_t)m] *
               cexp(I * 4 * pi_rad / c_mps * (m - w->samples / 2) * (w->bandwidth_hz / w->samples) * range_m);
    return power_of(sum / w->samples);
}

/* Where it is greatest about a range, by search and the parabola of three. */
static double peak_near(const Chain *chain, int row, double range_m, double reach_m)
{
    enum { steps = 400 };
    const double step_m = 2 * reach_m / steps;
    double       best = 0, best_m = NAN;
    for (int i = 0; i <= steps; i++) {
        const double at_m = range_m - reach_m + i * step_m, power = response(chain, row, at_m);
        if (power > best) best = power, best_m = at_m;
    }
    const double before = response(chain, row, best_m - step_m), after = response(chain, row, best_m + step_m);
    return best_m + 0.5 * step_m * (before - after) / (before - 2 * best + after);
}

/* An echo that keeps its path, moved under the cells by 64ths of one: sin(pi x) / (M sin(pi x / M)) without a window;
 * widths and highest side lobes as in shared/data/radar/signal/windows_psf.csv (SciPy, 256 points). */
static void points_respond_as_their_window(void **state)
{
    (void)state;
    for (int kind = 0; kind < waveform_kinds; kind++) {
        Chain rect, taylor;
        open_chain(&rect, of_kind[kind], "rect", 2, false);
        open_chain(&taylor, of_kind[kind], "taylor:5:40", 2, false);
        const int    samples = rect.preset.wave.samples, row = samples; /* of rows, the second: range rate 0 */
        const double cell_m = c_mps / (2 * rect.preset.wave.bandwidth_hz);
        double       error = 0, half[2] = {0, 0}, side[2] = {0, 0};
        for (int i = 0; i < 64; i++) {
            const double          shift = i / 64.0;
            const double complex *sharp = map_of(&rect, -shift * cell_m, 0) + row + samples / 2;
            const double complex *soft = map_of(&taylor, -shift * cell_m, 0) + row + samples / 2;
            for (int k = -samples / 2; k < samples / 2; k++) {
                const double x = pi_rad * (k + shift), want = x != 0 ? sin(x) / (samples * sin(x / samples)) : 1;
                error = fmax(error, fabs(cabs(sharp[k]) - fabs(want)));
                const double complex v[2] = {sharp[k], soft[k]};
                const double main_lobe[2] = {1, 1.83}; /* cells to the first null; Taylor's: s (A^2 + 1/4)^(1/2) */
                for (int w = 0; w < 2; w++) {
                    if (power_of(v[w]) >= 0.5) half[w] += 1 / 64.0;
                    if (fabs(k + shift) > main_lobe[w]) side[w] = fmax(side[w], power_of(v[w]));
                }
            }
        }
        printf("%s: %.4f and %.4f cells wide, side lobes %.2f and %.2f dB\n", waveform_name[kind], half[0], half[1],
               10 * log10(side[0]), 10 * log10(side[1]));
        CHECK(error < 2e-6);
        /* widths are counted in 64ths */
        CHECK_NEAR(half[0], 0.8859, 1.01 / 64);
        CHECK_NEAR(10 * log10(side[0]), -13.26, 0.02);
        CHECK_NEAR(half[1], 1.2460, 1.01 / 64);
        CHECK_NEAR(10 * log10(side[1]), -40.13, 0.1);
        close_chain(&rect);
        close_chain(&taylor);
    }
}

/* f0 v T / B on paper: 94 GHz, 50 m/s, 20 us, 500 MHz: 0.188 m; 35 GHz, 10 m/s, 256 / 100 kHz, 512 MHz: 1.75 m; 94 GHz,
 * 20 m/s, 100 us, 150 MHz: 1.25333 m; a coded pulse: none. On top of that the row's own time. */
static void rates_move_echoes_in_range(void **state)
{
    (void)state;
    const double rate_mps[waveform_kinds] = {50, 10, 100, 20}, shift_m[waveform_kinds] = {0.188, 1.75, 0, 1.25333333};
    for (int kind = 0; kind < waveform_kinds; kind++)
        for (int sign = -1; sign <= 1; sign += 2) {
            Chain chain;
            open_chain(&chain, of_kind[kind], "rect", 0, false);
            const Waveform *w = &chain.preset.wave;
            const double    at_m = 3.7;
            (void)map_of(&chain, at_m, sign * rate_mps[kind]);
            for (int row = 0; row < w->pulses; row += w->pulses - 1) {
                const double t_s = (row - 0.5 * (w->pulses - 1)) / w->repeat_hz;
                const double want_m = at_m + sign * (shift_m[kind] + rate_mps[kind] * t_s);
                CHECK_NEAR(waveform_appears_m(w, at_m, sign * rate_mps[kind]), at_m + sign * shift_m[kind], 1e-6);
                /* delays are in steps of what the band's ends part by 2e-3 rad */
                CHECK_NEAR(peak_near(&chain, row, want_m, 1.5 * c_mps / (2 * w->bandwidth_hz)), want_m,
                           2e-3 * c_mps / (2 * w->bandwidth_hz));
            }
            WaveformTiming timing;
            waveform_timing(&timing, w);
            CHECK_NEAR(timing.coupling_s * rate_mps[kind], shift_m[kind], 1e-6);
            close_chain(&chain);
        }
}

/* What a burst leaves of a point at an offset from it, whose phase bends by q at the band's ends: the integral of
 * exp(-j q u^2 + j 2 pi B d u / c) / 2 over u = -1 .. 1, a Fresnel integral, by Simpson's rule. */
static double bent(double q, double offset_m, double bandwidth_hz)
{
    enum { panels = 400 };
    double complex sum = 0;
    for (int i = 0; i <= panels; i++) {
        const double u = 2.0 * i / panels - 1;
        sum += (i == 0 || i == panels ? 1
                : i % 2               ? 4
                                      : 2) *
               cexp(I * u * (2 * pi_rad * bandwidth_hz / c_mps * offset_m - q * u)) / (3.0 * panels);
    }
    return power_of(sum);
}

/* A rate of 300 m/s that the receiver does not follow, over a burst of 2.56 ms of 512 MHz: 52.5 m too near, which is
 * folded over by the window of 74.9 m; and q = pi B v T / c = 4.12 rad: lower, and wide. Followed: where and as it is.
 */
static void a_burst_smears_unless_followed(void **state)
{
    (void)state;
    const double rate_mps = -300, q = pi_rad * 512e6 * rate_mps * 2.56e-3 / c_mps;
    for (int uncompensated = 0; uncompensated < 2; uncompensated++) {
        Chain chain;
        open_chain(&chain, "stepped_35", "rect", 16, uncompensated);
        const Waveform *w = &chain.preset.wave;
        const double    turn = pi_rad * w->centre_hz * 2 * rate_mps / c_mps * w->pulse_s,
                     within = pow(sin(turn) / turn, 2);
        const double window_m = c_mps * 256 / (2 * 512e6), row_s = 0.5 * 2.56e-3; /* row 8 of 16 is half a row late */
        const double middle_m = 2 + uncompensated * (rate_mps * (row_s + 35e9 * 2.56e-3 / 512e6) + window_m);
        CHECK_NEAR(waveform_appears_m(w, 2, uncompensated * rate_mps), middle_m - uncompensated * rate_mps * row_s,
                   1e-3);
        const double peak = uncompensated ? bent(q, 0, 512e6) : 1, left = uncompensated ? within : 1;
        echo_unfollowed(chain.grid, uncompensated ? 2 * rate_mps / w->repeat_hz : 0);
        (void)map_of(&chain, 2, 0);
        CHECK_NEAR(10 * log10(response(&chain, 8, middle_m) / (left * peak)), 0, 0.02);
        double edge[2][2] = {{0}};
        for (int k = -1500; k <= 1500; k++)
            for (int paper = 0; paper < 2; paper++) {
                const double at_m = k * 1e-3, power = paper ? bent(uncompensated * q, at_m, 512e6)
                                                            : response(&chain, 8, middle_m + at_m) / left;
                if (power < 0.5 * peak) continue;
                if (edge[paper][0] == 0) edge[paper][0] = at_m;
                edge[paper][1] = at_m;
            }
        const double wide_m = edge[0][1] - edge[0][0];
        printf("stepped, %s: %.2f dB, %.3f m wide, on paper %.3f\n", uncompensated ? "not followed" : "followed",
               10 * log10(response(&chain, 8, middle_m)), wide_m, edge[1][1] - edge[1][0]);
        CHECK_NEAR(wide_m, edge[1][1] - edge[1][0], 0.004); /* the sum's middle is half a step from the integral's */
        CHECK(uncompensated ? wide_m > 1 : fabs(wide_m - 0.886 * c_mps / (2 * 512e6)) < 0.003);
        close_chain(&chain);
    }
}

/* 100 kHz: 1498.96 m and 908.46 m/s (16.5 GHz) look alike; 1 us of the 10 is deaf. */
static void pulse_doppler_folds_over_and_is_deaf(void **state)
{
    (void)state;
    Chain chain;
    open_chain(&chain, "pulse_doppler_ku", "rect", 0, false);
    const Waveform *w = &chain.preset.wave;
    const int       samples = w->samples, rows = w->pulses;
    const double    cell_m = 11.71064, row_mps = 908.4619939 / rows, fold_m = 1498.96229, blind_mps = 908.4619939;
    for (int folds = -2; folds <= 7; folds++)
        for (int blind = -1; blind <= 2; blind++) {
            const double complex *cell =
                map_of(&chain, 20 * cell_m + folds * fold_m, -30 * row_mps + blind * blind_mps);
            size_t peak = 0;
            for (size_t i = 0; i < (size_t)samples * (size_t)rows; i++)
                if (power_of(cell[i]) > power_of(cell[peak])) peak = i;
            CHECK_NEAR(waveform_appears_m(w, 20 * cell_m + folds * fold_m, 0), 20 * cell_m, 1e-3);
            CHECK(peak == (size_t)(rows / 2 - 30) * (size_t)samples + (size_t)(samples / 2 + 20));
            /* within a pulse of 1 us its own Doppler takes sinc^2; 256 rows of 10 us of up to 1800 m/s walk by 4.6 m
             * of 11.7 */
            const double turn = pi_rad * 2 * (blind * blind_mps - 30 * row_mps) / c_mps * 16.5e9 * 1e-6;
            const double walk = 0.5 * pi_rad * (blind * blind_mps - 30 * row_mps) * rows * 1e-5 / cell_m;
            CHECK_NEAR(10 * log10(power_of(cell[peak]) / pow(sin(turn) / turn, 2)), 0, 0.05 + walk * walk);
        }
    /* distance, share of a pulse of 149.9 m that arrives past the transmitter's */
    const double at[][2] = {{0, 0},         {74.95, 0.5}, {149.9, 1},     {1000, 1}, {1349, 1},
                            {1424.01, 0.5}, {1498.96, 0}, {1573.91, 0.5}, {5000, 1}};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) CHECK_NEAR(waveform_share(w, at[i][0]), at[i][1], 1e-3);
    close_chain(&chain);
}

/* A sweep of 150 MHz in 100 us beats at 10.00692 kHz a metre; the greatest beat, 2048 in 100 us, is at 2046.58 m. An
 * echo from 1500 m misses the first 10.007 us. */
static void fmcw_beats(void **state)
{
    (void)state;
    Chain          chain;
    WaveformTiming timing;
    open_chain(&chain, "fmcw_94", "rect", 2, false);
    const Waveform *w = &chain.preset.wave;
    waveform_timing(&timing, w);
    CHECK_NEAR(timing.beat_hz_m, 10006.92, 0.01);
    CHECK_NEAR(timing.window_m, 2046.58, 0.01);
    CHECK_NEAR(timing.beat_hz_m * timing.window_m, 2048 / 100e-6, 1);
    CHECK_NEAR(waveform_share(w, 1500), 0.899930, 1e-5);
    (void)map_of(&chain, 100,
                 0); /* farther than the reference: its phase falls, at 1.000692 MHz, from sample to sample */
    const double complex step = chain.interval.sample[1001] / chain.interval.sample[1000];
    CHECK_NEAR(carg(step), -2 * pi_rad * 1000692.0 * 100e-6 / 2048, 1e-5);
    close_chain(&chain);
}

/* P G^2 lambda^2 sigma / ((4 pi)^3 R^4 L) times the energy's time over k T F, by hand for each row: of pulses 20 us x
 * 64; 0.5 us x 256 x 16; 1 us x 256; 100 us x 64, of which an echo from 1200 m misses 8.0055 %, 0.7248 dB. */
static void signal_to_noise_is_the_radar_equations(void **state)
{
    (void)state;
    const double on_air_s[waveform_kinds] = {20e-6 * 64, 0.5e-6 * 256 * 16, 1e-6 * 256, 100e-6 * 64};
    for (int kind = 0; kind < waveform_kinds; kind++) {
        Chain chain;
        open_chain(&chain, of_kind[kind], "rect", 0, false);
        const RadarPreset *p = &chain.preset;
        const Receiver     receiver = {.noise_figure = p->receiver.noise_figure};
        const size_t       plane = (size_t)p->wave.samples * (size_t)p->wave.pulses;
        const double       range_m = 1200, rcs_m2 = 10, wave_m = c_mps / p->wave.centre_hz;
        const double   gain = 0.75 * pow(pi_rad * p->antenna.diameter_m / wave_m, 2); /* of a dish tapered to 0.75 */
        ReceiverReport report;
        interval_receive(&report, &chain.interval, &receiver, 5, 0, 0);
        interval_process(&chain.map, chain.plan, &chain.interval, NULL);
        double floor_w = 0;
        for (size_t i = 0; i < interval_channels * plane; i++)
            floor_w += power_of(chain.map.cell[i]) / (double)(interval_channels * plane);
        const AntennaGain at = antenna_gain(&p->antenna, 0, 0);
        const RadarLink   link = {p->power_w, 1, 1, wave_m, range_m, p->loss};
        const double      amplitude =
            sqrt(radar_received_w(&link, rcs_m2)) * at.sum * at.sum * waveform_share(&p->wave, range_m);
        const double peak_w = power_of(
            map_of(&chain, 0, 0)[(size_t)p->wave.pulses / 2 * (size_t)p->wave.samples + (size_t)p->wave.samples / 2]);
        const double got_db = 10 * log10(peak_w * amplitude * amplitude / floor_w);
        const double received_w =
            p->power_w * gain * gain * wave_m * wave_m * rcs_m2 / (pow(4 * pi_rad, 3) * pow(range_m, 4) * p->loss);
        const double want_db =
            10 * log10(received_w * on_air_s[kind] / (1.380649e-23 * 290 * p->receiver.noise_figure)) -
            (kind == WAVEFORM_FMCW ? 0.7248 : 0);
        printf("%s: %.2f dB, on paper %.2f\n", waveform_name[kind], got_db, want_db);
        CHECK_NEAR(got_db, want_db, 0.1);
        close_chain(&chain);
    }
}

/* Phase noise of a pulse is that of a row, of a stepped burst of each sample: exp(-s^2) of the peak is left, and the
 * rest is spread over Doppler alone, or over the whole map. */
static void phase_noise_is_of_each_pulse(void **state)
{
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        Chain          chain;
        ReceiverReport report;
        const Receiver receiver = {.noise_figure = 1, .phase_noise_rad = 0.1};
        open_chain(&chain, of_kind[kind], "rect", 0, false);
        const int samples = chain.preset.wave.samples, rows = chain.preset.wave.pulses;
        (void)map_of(&chain, 0, 0);
        interval_receive(&report, &chain.interval, &receiver, 9, 0, 0);
        interval_process(&chain.map, chain.plan, &chain.interval, NULL);
        double column = 0, others = 0;
        for (int y = 0; y < rows; y++)
            for (int x = 0; x < samples; x++) {
                if (x == samples / 2 && y == rows / 2) continue;
                *(x == samples / 2 ? &column : &others) += power_of(chain.map.cell[y * samples + x]);
            }
        const double lost = 1 - exp(-0.01), spread = kind == WAVEFORM_STEPPED ? others : column;
        CHECK_NEAR(spread / lost, 1, kind == WAVEFORM_STEPPED ? 0.1 : 0.5); /* of 4096 draws, and 64 */
        CHECK((kind == WAVEFORM_STEPPED ? column : others) < 0.02 * spread);
        close_chain(&chain);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_respond_as_their_window),
        cmocka_unit_test(rates_move_echoes_in_range),
        cmocka_unit_test(a_burst_smears_unless_followed),
        cmocka_unit_test(pulse_doppler_folds_over_and_is_deaf),
        cmocka_unit_test(fmcw_beats),
        cmocka_unit_test(signal_to_noise_is_the_radar_equations),
        cmocka_unit_test(phase_noise_is_of_each_pulse),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
