/* sensor/detector/coupling.h: AC coupling between detector and amplifier: a high pass along each line. */
#ifndef SENSOR_DETECTOR_COUPLING_H
#define SENSOR_DETECTOR_COUPLING_H

#include "sensor/detector/scan.h"

/* First-order high pass along each line in the direction of its scan, each value held for cutoff_hz x pixel_s =
 * fc_t: a step droops to exp(-2 pi fc_t) per pixel. At the start of each line the capacitor is charged to the
 * plane's mean (direct current restored on a reference during the turn), and that mean is added again, so the level
 * is preserved and lines are independent. A hot object is followed by a dark trail: to the right, or on
 * returning lines to the left. */
void coupling_apply(float *plane, int width, int height, const Scan *scan, double fc_t);

#endif
