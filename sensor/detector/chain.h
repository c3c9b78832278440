/* sensor/detector/chain.h: one band's sensor from radiance at the aperture to raw counts.
 *
 *     radiance -> electrons (solid angle, optics, quantum efficiency, time) -> optics, detector footprint,
 *     smear, jitter -> each line at its own time -> pixel-to-pixel gain -> shot, dark and read noise,
 *     three-dimensional noise, noise along lines -> AC coupling -> well, converter -> defective pixels and
 *     their replacement
 *
 * Frames are independent: all noise is a function of (seed, frame, row, column), so frames may be made in any order. */
#ifndef SENSOR_DETECTOR_CHAIN_H
#define SENSOR_DETECTOR_CHAIN_H

#include "render/frame/render.h"
#include "sensor/detector/preset.h"

typedef struct Chain Chain;

/* Share of the well that an automatic exposure fills on average: highlights of 2.8 times the mean still fit. */
static const double chain_exposed_share = 0.35;

/* Wavelength for which diffraction is computed, m: the mean of the photons over the band, of a black body of 300 K in
 * MWIR and LWIR and of 5772 K, the sun's, in the optical channels; channel as preset_band's. Against the OTF of all
 * wavelengths: within 0.001 (tests/sensor/test_sensor_mtf.c). */
double chain_wavelength_m(const SensorPreset *preset, int channel);

/* places: samples along a row of a pixel, which the image has averaged (MtfChain, render_places). Of the optical
 * band there are three channels, R G B, or one, by preset->optical; else one. */
Status chain_create(Chain **out, const SensorPreset *preset, int width, int height, int places, uint64_t seed);
void   chain_destroy(Chain *chain);

/* One pixel's values after each stage of a run: electrons, at last counts. */
typedef enum ChainStage {
    CHAIN_ELECTRONS,     /* of its radiance */
    CHAIN_SMALL_TARGETS, /* small targets in the pixels behind them */
    CHAIN_OPTICS,        /* optics, footprint, jitter, smear; small targets at their places */
    CHAIN_LINES,         /* each line at its own time */
    CHAIN_GAIN,          /* gain from pixel to pixel */
    CHAIN_NOISE,         /* + dark current, and shot, dark and read noise */
    CHAIN_PATTERN,       /* + noise of rows, columns, frames and lines */
    CHAIN_AC_COUPLED,
    CHAIN_COUNTS, /* converted, defective pixels replaced */
    chain_stages
} ChainStage;

typedef struct ChainWatch {
    size_t   px;     /* row * width + column */
    unsigned has[3]; /* of each channel, 1 << ChainStage: those that it has */
    double   value[3][chain_stages];
    int      defect; /* PIXEL_GOOD ... of array_noise.h */
    double   exposure;
} ChainWatch;

/* Notes a pixel in the runs that follow; NULL: none. */
void chain_watch(Chain *chain, ChainWatch *watch);

/* Sets the exposure for these planes, [channels], in-band W/(m2 sr). Before the calls below. */
void chain_expose(Chain *chain, const float *const radiance[]);
/* small: the small targets of the image, whose cells pass through the optics at their subpixel positions (subpixel.h);
 * NULL: they stay in whole pixels. rate_px_s: image motion of the scene, column and row. */
void chain_run(Chain *chain, const float *const radiance[], const SmallTargets *small, int frame,
               const double rate_px_s[2]);
/* Counts of the last run: [height][width], 0 .. 2^bits - 1. The second gives the same counts as numbers, for levels and
 * displays. */
const uint16_t *chain_counts(const Chain *chain, int channel);
const float    *chain_values(const Chain *chain, int channel);

/* Electrons of this radiance, before noise, with the exposure of chain_expose, which may be NULL. */
double chain_signal_e(double *exposure, const Chain *chain, int channel, double radiance_w_m2_sr);
/* Counts for this radiance, unbounded, before noise. */
double chain_counts_at(const Chain *chain, int channel, double radiance_w_m2_sr);
/* Rms of all noise at this radiance, as radiance: temporal, fixed and along lines, without defective pixels. */
double chain_sigma(const Chain *chain, int channel, double radiance_w_m2_sr);
/* The same noise as a temperature difference of a blackbody, K. */
double chain_netd_k(const Chain *chain, double temp_k);
/* Electrons per count. */
double chain_step_e(const Chain *chain);
/* Full scale in counts. */
double chain_full(const Chain *chain);

#endif
