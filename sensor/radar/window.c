/* sensor/radar/window.c: weights by their formulas, and figures of the response to a point. */
#include "sensor/radar/window_private.h"

#include "sensor/detector/transform.h"

#include <stdlib.h>

/* Modified Bessel function of the first kind, order 0, by its series: all terms are positive, so no digits cancel. */
static double bessel_i0(double x)
{
    double sum = 1, term = 1;
    for (int k = 1; term > 1e-17 * sum; k++) {
        term *= x * x / (4.0 * k * k);
        sum += term;
    }
    return sum;
}

static void taylor(double *w, int n, double sidelobe_db, int nbar)
{
    const double a = acosh(pow(10, sidelobe_db / 20)) / pi_rad,
                 s2 = nbar * nbar / (a * a + (nbar - 0.5) * (nbar - 0.5));
    for (int i = 0; i < n; i++) w[i] = 1;
    for (int m = 1; m < nbar; m++) {
        double over = 1, under = 1;
        for (int k = 1; k < nbar; k++) {
            over *= 1 - m * m / (s2 * (a * a + (k - 0.5) * (k - 0.5)));
            if (k != m) under *= 1 - (double)(m * m) / (k * k);
        }
        const double f = (m % 2 ? 1 : -1) * over / under;
        for (int i = 0; i < n; i++) w[i] += f * cos(2 * pi_rad * m * (i - 0.5 * (n - 1)) / n);
    }
}

/* Its spectrum is a Chebyshev polynomial; the weights are that, summed at places half a sample off for even n. */
static void chebyshev(double *w, int n, double sidelobe_db)
{
    const double x0 = cosh(acosh(pow(10, sidelobe_db / 20)) / (n - 1));
    for (int i = 0; i < n; i++) {
        w[i] = 0;
        for (int k = 0; k < n; k++) {
            const double x = x0 * cos(pi_rad * k / n);
            const double t =
                fabs(x) <= 1 ? cos((n - 1) * acos(x)) : (x < 0 && n % 2 == 0 ? -1 : 1) * cosh((n - 1) * acosh(fabs(x)));
            w[i] += t * cos(2 * pi_rad * k * (i - 0.5 * (n - 1)) / n);
        }
    }
}

Status window_weights(double *w, int n, const Window *window)
{
    const bool leveled = window->kind == WINDOW_TAYLOR || window->kind == WINDOW_CHEBYSHEV;
    if (n < 2 || (leveled && !(window->sidelobe_db >= 10 && window->sidelobe_db <= 120)) ||
        (window->kind == WINDOW_TAYLOR && (window->nbar < 1 || window->nbar > 16)) ||
        (window->kind == WINDOW_KAISER && !(window->beta >= 0 && window->beta <= 40)))
        return STATUS_BAD_VALUE;
    const double last = n - 1;
    switch (window->kind) {
    case WINDOW_TAYLOR:
        taylor(w, n, window->sidelobe_db, window->nbar);
        break;
    case WINDOW_CHEBYSHEV:
        chebyshev(w, n, window->sidelobe_db);
        break;
    default:
        for (int i = 0; i < n; i++) {
            const double u = 2 * i / last - 1, turn = cos(2 * pi_rad * i / last);
            w[i] = window->kind == WINDOW_HANN      ? 0.5 - 0.5 * turn
                   : window->kind == WINDOW_HAMMING ? 0.54 - 0.46 * turn
                   : window->kind == WINDOW_KAISER  ? bessel_i0(window->beta * sqrt(fmax(1 - u * u, 0)))
                                                    : 1;
        }
    }
    double most = 0;
    for (int i = 0; i < n; i++) most = fmax(most, w[i]);
    for (int i = 0; i < n; i++) w[i] /= most;
    return STATUS_OK;
}

const char *window_parse(Window *out, const char *text)
{
    static const char *const accepted =
        "rect, hann, hamming, taylor:NBAR:DB (1 .. 16, 10 .. 120), chebyshev:DB (10 .. 120) or kaiser:BETA (0 .. 40)";
    Window w = {.kind = WINDOW_RECT};
    int    used = 0;
    if (strcmp(text, "rect") == 0) w.kind = WINDOW_RECT;
    else if (strcmp(text, "hann") == 0) w.kind = WINDOW_HANN;
    else if (strcmp(text, "hamming") == 0) w.kind = WINDOW_HAMMING;
    else if (sscanf(text, "taylor:%2d:%lf%n", &w.nbar, &w.sidelobe_db, &used) == 2 && !text[used])
        w.kind = WINDOW_TAYLOR;
    else if (sscanf(text, "chebyshev:%lf%n", &w.sidelobe_db, &used) == 1 && !text[used]) w.kind = WINDOW_CHEBYSHEV;
    else if (sscanf(text, "kaiser:%lf%n", &w.beta, &used) == 1 && !text[used]) w.kind = WINDOW_KAISER;
    else return accepted;
    double probe[2];
    if (window_weights(probe, 2, &w) != STATUS_OK) return accepted;
    *out = w;
    return NULL;
}

/* Finds the place right of the peak where the power falls to half of it, in samples. */
static double half_power(const double *power)
{
    int i = 1;
    while (power[i] > 0.5 * power[0]) i++;
    return i - 1 + (power[i - 1] - 0.5 * power[0]) / (power[i - 1] - power[i]);
}

Status window_figures(WindowFigures *out, const double *w, int n)
{
    if (n < 4 || n > 4096) return STATUS_BAD_VALUE;
    const int  count = n * window_padding, half = count / 2;
    Transform *transform = NULL;
    double    *wave = transform_alloc(2 * (size_t)count), *power = malloc((size_t)half * sizeof *power);
    Status     status =
        wave && power ? transform_create(&transform, TRANSFORM_ROWS, 1, count, wave, wave) : STATUS_NO_MEMORY;
    if (status != STATUS_OK) goto done;

    memset(wave, 0, 2 * (size_t)count * sizeof *wave);
    double sum = 0, squares = 0;
    for (int i = 0; i < n; i++) {
        wave[2 * i] = w[i];
        sum += w[i];
        squares += w[i] * w[i];
    }
    transform_run(transform);
    for (int i = 0; i < half; i++) power[i] = wave[2 * i] * wave[2 * i] + wave[2 * i + 1] * wave[2 * i + 1];

    int null = 1; /* first minimum */
    while (null < half - 1 && power[null + 1] < power[null]) null++;
    double highest = 0, main_lobe = power[0], rest = 0; /* both sides are alike */
    for (int i = 1; i < half; i++) {
        if (i < null) main_lobe += 2 * power[i];
        else rest += 2 * power[i], highest = fmax(highest, power[i]);
    }
    out->width_3db = 2 * half_power(power) / window_padding;
    out->pslr_db = 10 * log10(highest / power[0]);
    out->islr_db = 10 * log10(rest / main_lobe);
    out->noise_bins = n * squares / (sum * sum);
    out->loss_db = 10 * log10(out->noise_bins);

done:
    transform_destroy(transform);
    transform_free(wave);
    free(power);
    return status;
}
