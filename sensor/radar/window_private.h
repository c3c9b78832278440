/* sensor/radar/window_private.h: weights across pulses or frequencies that trade resolution for side lobes, and the
 * figures by which they are judged.
 *
 * Symmetric forms of length N. Sources: F. J. Harris, Proc. IEEE 66(1), 1978 (Hann, Hamming, Kaiser, Dolph-Chebyshev);
 * T. T. Taylor, IRE Trans. AP-3, 1955 (Taylor). Held against independent figures in tests/sensor/test_window.c. */
#ifndef SENSOR_RADAR_WINDOW_PRIVATE_H
#define SENSOR_RADAR_WINDOW_PRIVATE_H

#include "pitviper.h"

typedef enum WindowKind {
    WINDOW_RECT,
    WINDOW_HANN,
    WINDOW_HAMMING,
    WINDOW_TAYLOR,
    WINDOW_CHEBYSHEV,
    WINDOW_KAISER
} WindowKind;

typedef struct Window {
    WindowKind kind;
    double     sidelobe_db; /* below the peak, 10 .. 120: Taylor and Chebyshev */
    int        nbar;        /* Taylor: side lobes of one level, 1 .. 16 */
    double     beta;        /* Kaiser, 0 .. 40 */
} Window;

/* Fills the weights w[n], whose greatest is 1. n >= 2. Costs O(n), Chebyshev O(n^2). STATUS_BAD_VALUE: a parameter is
 * out of its range. */
Status window_weights(double *w, int n, const Window *window);
/* `rect`, `hann`, `hamming`, `taylor:5:40` (nbar, dB), `chebyshev:60` (dB), `kaiser:6` (beta). NULL, or what is
 * accepted. */
const char *window_parse(Window *out, const char *text);

/* Properties of the response to a point, from a transform of n weights zero-padded to window_padding n. */
enum { window_padding = 256 };
typedef struct WindowFigures {
    double width_3db; /* of the main lobe at half power, in bins of 1 / n: range resolution = width c / (2 bandwidth) */
    double pslr_db;   /* highest side lobe over the peak */
    double islr_db;   /* energy of all side lobes over that between the main lobe's first minima */
    double noise_bins; /* equivalent noise bandwidth, bins */
    double loss_db;    /* of signal to noise, by the weights: 10 log10 of noise_bins */
} WindowFigures;
/* n in 4 .. 4096. STATUS_NO_MEMORY. */
Status window_figures(WindowFigures *out, const double *w, int n);

#endif
