/* Windows of radar processing against the figures that SciPy's windows have, zero-padded 256 times, and what is
 * known on paper. labels: physics */
#include "tests/check.h"

#include "sensor/radar/window_private.h"

/* data/radar/signal/windows_psf.csv: N = 256, SciPy's hann, hamming, taylor, chebwin, kaiser (sym = True). Its
 * widths are between samples 1 / 256 of a bin apart, as ours are. */
static const struct {
    const char *window;
    double      width, pslr_db, islr_db, noise_bins;
} judged[] = {
    {"rect", 0.885900093222, -13.2610291687, -9.68065956817, 1},
    {"hann", 1.44623254965, -31.4673086846, -32.884454374, 1.50588235294},
    {"hamming", 1.30633927917, -42.6611130959, -34.3831671171, 1.36666815499},
    {"taylor:4:35", 1.18415979321, -35.166525714, -27.1331091746, 1.23426506877},
    {"taylor:5:40", 1.24600776634, -40.1316323641, -31.3695379782, 1.30051567933},
    {"chebyshev:60", 1.44995220199, -60.0000000031, -40.8365796736, 1.52209443992},
    {"kaiser:6", 1.40736457769, -43.8461742302, -43.8374125259, 1.4722472005},
};

static void figures_are_those_of_scipy(void **state)
{
    (void)state;
    double w[256];
    for (size_t i = 0; i < sizeof judged / sizeof *judged; i++) {
        Window        window;
        WindowFigures f;
        CHECK(window_parse(&window, judged[i].window) == NULL);
        CHECK(window_weights(w, 256, &window) == STATUS_OK && window_figures(&f, w, 256) == STATUS_OK);
        CHECK_NEAR(f.noise_bins, judged[i].noise_bins, 1e-9);
        CHECK_NEAR(f.width_3db, judged[i].width, 1e-4); /* of interpolation between its samples */
        CHECK_NEAR(f.pslr_db, judged[i].pslr_db, 1e-3); /* of a side lobe's top between them */
        CHECK_NEAR(f.islr_db, judged[i].islr_db, 0.02); /* of where the main lobe ends, by a sample */
        CHECK_NEAR(f.loss_db, 10 * log10(judged[i].noise_bins), 1e-8);
    }
}

/* Odd lengths too: all side lobes of a Dolph-Chebyshev window are at one level. */
static void chebyshev_has_one_level(void **state)
{
    (void)state;
    double        w[201];
    WindowFigures f;
    for (int n = 31; n <= 201; n += 34) {
        const Window window = {.kind = WINDOW_CHEBYSHEV, .sidelobe_db = 50};
        CHECK(window_weights(w, n, &window) == STATUS_OK && window_figures(&f, w, n) == STATUS_OK);
        CHECK_NEAR(f.pslr_db, -50, 2e-3);
        for (int i = 0; i < n; i++) CHECK_NEAR(w[i], w[n - 1 - i], 1e-12);
    }
}

static void bad_words_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "",         "box",         "taylor",        "taylor:0:40", "taylor:5:9", "taylor:17:40",
        "taylor:5", "chebyshev:9", "chebyshev:60x", "kaiser:-1",   "kaiser:nan", "kaiser:41"};
    Window w = {.kind = WINDOW_KAISER, .beta = 6};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) CHECK(window_parse(&w, bad[i]) != NULL);
    CHECK(w.kind == WINDOW_KAISER && w.beta == 6);
    CHECK(window_weights(&(double){0}, 1, &w) == STATUS_BAD_VALUE);
    /* nothing is written beyond the last weight */
    for (int kind = WINDOW_RECT; kind <= WINDOW_KAISER; kind++) {
        double       of[10] = {[9] = 777};
        const Window each = {.kind = (WindowKind)kind, .beta = 6, .sidelobe_db = 40, .nbar = 4};
        CHECK(window_weights(of, 9, &each) == STATUS_OK && of[9] == 777 && of[4] == 1);
    }
    static double even[4097];
    WindowFigures f;
    for (int i = 0; i < 4097; i++) even[i] = 1;
    CHECK(window_figures(&f, even, 3) == STATUS_BAD_VALUE && window_figures(&f, even, 4097) == STATUS_BAD_VALUE);
    CHECK(window_figures(&f, even, 4) == STATUS_OK && window_figures(&f, even, 4096) == STATUS_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_are_those_of_scipy),
        cmocka_unit_test(chebyshev_has_one_level),
        cmocka_unit_test(bad_words_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
