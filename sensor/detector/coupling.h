/* sensor/detector/coupling.h: AC coupling: what a capacitor between detector and amplifier leaves of a line. */
#ifndef SENSOR_DETECTOR_COUPLING_H
#define SENSOR_DETECTOR_COUPLING_H

#include "sensor/detector/scan.h"

/* First-order high pass along each line in the direction of its scan, each value held for cutoff_hz x pixel_s =
 * fc_t: a step droops to exp(-2 pi fc_t) a pixel. At the start of each line the capacitor is charged to the
 * plane's mean (direct current restored on a reference during the turn), and that mean is put back, so the level
 * stays and a line needs no other. What is hot pulls what comes after it down: a shadow to the right, or on
 * returning lines to the left. */
void coupling_apply(float *plane, int width, int height, const Scan *scan, double fc_t);

#endif
