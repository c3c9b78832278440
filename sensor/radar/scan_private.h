/* sensor/radar/scan_private.h: a scan in the making. */
#ifndef SENSOR_RADAR_SCAN_PRIVATE_H
#define SENSOR_RADAR_SCAN_PRIVATE_H

#include "sensor/radar/seeker_radar_private.h"

typedef struct ScanWork {
    Making       *making;
    RadarScan    *scan;
    Making       *beam;             /* [positions] */
    double       *weight;           /* [pulses]: Doppler window, over its sum */
    double        width_bins;       /* of that window at half power */
    double        beamwidth_rad;    /* one way */
    double        metre_per_column;
} ScanWork;

/* What the scan has for a place that is at p_enu at the frame's time and moves evenly. */
typedef struct ScanLook {
    double beam_w, sharp_w, resolution_m;
    bool   sharpened;
} ScanLook;

/* False: out of sector or window. */
bool scan_look(ScanLook *out, const ScanWork *work, const double p_enu[3], const double v_enu_mps[3]);

/* The sharpened picture, and the frame's pixels: scan's arrays. */
Status scan_sharpen(ScanWork *work);
Status scan_pixels(ScanWork *work);

#endif
