/* sensor/detector/preset.h: a sensor as a row of etc/sensors.csv. */
#ifndef SENSOR_DETECTOR_PRESET_H
#define SENSOR_DETECTOR_PRESET_H

#include "pitviper_channels.h"
#include "render/scene/view.h"
#include "sensor/detector/noise3d.h"
#include "sensor/detector/photons.h"
#include "sensor/detector/scan.h"

typedef struct SensorPreset {
    char           name[32];
    Band           band;               /* optical, mwir or lwir */
    const SpectralChannel *channel;    /* the one it is for; NULL: the visible ones, or all of the band */
    OpticalChannels optical;           /* its response in the optical band */
    double         width_px, height_px, hfov_deg;
    double         lens[5], lateral[2]; /* k1 k2 k3 p1 p2 (render/scene/lens.h); R and B over G, less 1 */
    PhotonDetector photons;            /* low_m, high_m: the band's; dark_e for integration_s; of one stage */
    double         tdi;                /* stages whose electrons are summed; 0 or 1: no TDI */
    double         obscuration, footprint, jitter_px;
    bool           auto_exposure;
    double         dark_e_s;
    double         bits;
    Noise3d        ratio;              /* of the temporal noise of a pixel, as etc/sensors.csv says; tvh: 1 */
    double         prnu;
    Scan           scan;
    double         ac_per_line, line_noise, line_noise_px;
    double         bad_share, bad_clustered, bad_patched;
    double         noise_scale;        /* of all noise and non-uniformity; 1 */
    bool           smear;              /* motion within the integration time, and between lines */
} SensorPreset;

/* The row of that name. On error logs file, line, column, value and range; for an unknown name the known
 * ones. */
Status preset_read(SensorPreset *out, const char *path, const char *name);
/* Whether a table has a row of that name. */
/* Every row of a table is read; the first that is wrong is logged. */
Status preset_check(const char *path);
Status preset_has(bool *has, const char *path, const char *name);
/* The detector seen by the converter: tdi stages integrate the same point one after another, so that light and dark
 * current add, read noise adds in squares, and NETD improves by the root of their number. */
PhotonDetector preset_photons(const SensorPreset *preset);
/* After fields were changed by settings. */
void   preset_refresh(SensorPreset *preset);
/* Edges of a band in wavelength, as in the renderer. Channel 0 .. 2 of OPTICAL_RGB: R G B; -1: the whole. */
void   preset_band(double *low_m, double *high_m, Band band, OpticalChannels optical, int channel);

#endif
