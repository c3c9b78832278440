/* sensor/acquisition/acquisition.h: what an observer of a sensor's pictures resolves of a target: cycles, by the bars
 * of the MRTD (Johnson), and the TTP value, by the contrast that the whole of frequencies adds above threshold.
 *
 * Contrasts are apparent, at the sensor, in the unit of MrtdNoise: kelvins, or the difference over the background's
 * mean. Frequencies are cycles a pixel; times the root of a target's area in pixels they are cycles on the target. No
 * sensor says more than 0.5 here: what its sampled picture holds without aliasing.
 *
 * Cycles: the highest frequency whose four bars are resolved at the contrast (sensor/detector/mrtd.h), the geometric
 * mean of vertical and horizontal bars, as FLIR92's two-dimensional MRTD.
 *
 * TTP: the geometric mean over both axes of
 *
 *     integral over f, where C > CTF(f), of sqrt(C / CTF(f)) df
 *     CTF(f) = CTF_eye(f) / (MTF_sensor(f) MTF_display(f)) sqrt(1 + alpha^2 sigma^2(f))
 *
 * C = contrast / (2 scene), at most 1: the display's mean luminance stands for a difference of `scene` (the scene
 * contrast temperature). sigma(f) is the noise, over scene, that the eye's channel about f sees, per root hertz; alpha
 * = 169.6 root hertz. Noise that stays is that of eye_s: sigma^2 eye_s. Source: Vollmerhausen & Jacobs, AMSEL-NV-TR-230
 * (2004); Vollmerhausen, Jacobs & Driggers, Opt. Eng. 43 (2004) 2806. */
#ifndef SENSOR_ACQUISITION_ACQUISITION_H
#define SENSOR_ACQUISITION_ACQUISITION_H

#include "sensor/detector/mrtd.h"

typedef struct AcquisitionObserver {
    double snr;             /* of the bars */
    double frame_hz, eye_s; /* pictures a second; time over which the eye sums them */
    double picture_rad;     /* height of the displayed picture, at the eye */
    double luminance_cd_m2; /* of the display, mean */
    double scene;           /* in the unit of the contrast; NaN: 5 K, or 1 of reflected light */
} AcquisitionObserver;

/* 2.5, 30 Hz, 0.2 s; 0.4 rad, as a picture of 20 cm at 50 cm; 34.26 cd/m2 (10 foot-lamberts); NaN. */
AcquisitionObserver acquisition_default_observer(void);

/* What does not depend on noise and contrast, at one frequency. Axis 0: vertical bars, 1: horizontal ones. */
typedef struct AcquisitionNode {
    double   f_cyc_px;
    MrtdBars bars;
    double   threshold[2]; /* CTF without noise, modulation */
    double   seen; /* share of white noise along an axis that the eye's channel sees there: a bandwidth, per pixel */
    double   seen_line; /* the same of noise along the lines, whose spectrum is its own */
} AcquisitionNode;

enum { acquisition_nodes = 96 };

/* A sensor's curves: some 10 ms to prepare, once a run; a query takes 3 us. */
typedef struct Acquisition {
    SensorPreset        preset;
    AcquisitionObserver observer;      /* scene: filled in */
    double              all, all_line; /* as seen and seen_line, across the channel: of all frequencies */
    AcquisitionNode     node[acquisition_nodes];
} Acquisition;

void acquisition_prepare(Acquisition *out, const SensorPreset *preset, const AcquisitionObserver *observer);
/* One node, directly. of: prepared. */
void acquisition_node(AcquisitionNode *node, const Acquisition *of, double f_cyc_px);

/* CTF of both axes at a node, with noise. */
void acquisition_threshold(double ctf[2], const Acquisition *of, const AcquisitionNode *node, const MrtdNoise *noise);

/* Cycles a pixel that are resolved; 0: none. contrast: of either sign. Between nodes MRTD is a power of f: within 0.1 %
 * of the direct solution above 0.05 cycles a pixel (tests/sensor/test_acquisition.c). */
double acquisition_cycles_px(const Acquisition *of, const MrtdNoise *noise, double contrast);
/* TTP, per pixel. Within 0.25 % of the integral over 60 times as many nodes (same test). */
double acquisition_ttp_px(const Acquisition *of, const MrtdNoise *noise, double contrast);

#endif
