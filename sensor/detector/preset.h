/* sensor/detector/preset.h: a sensor, as a row of etc/sensors.csv or from a data sheet. */
#ifndef SENSOR_DETECTOR_PRESET_H
#define SENSOR_DETECTOR_PRESET_H

#include "pitviper_channels.h"
#include "render/scene/view.h"
#include "sensor/detector/array_noise.h"
#include "sensor/detector/line_scan_private.h"
#include "sensor/detector/photons.h"

typedef struct SensorPreset {
    char                   name[32];
    Band                   band;    /* optical, mwir or lwir */
    const SpectralChannel *channel; /* the one it is for; NULL: the visible ones, or all of the band */
    OpticalChannels        optical; /* its response in the optical band */
    double                 width_px, height_px, hfov_deg;
    double                 lens[5], lateral[2]; /* k1 k2 k3 p1 p2 (render/scene/view.h); R and B over G, less 1 */
    PhotonDetector         photons; /* low_m .. response: the band's; dark_e for integration_s; of one stage */
    double                 tdi;     /* stages whose electrons are summed; 0 or 1: no TDI */
    double                 obscuration, footprint, jitter_px;
    bool                   auto_exposure;
    double                 dark_e_s;
    double                 bits;
    Noise3d                ratio; /* of the temporal noise of a pixel, as etc/sensors.csv says; tvh: 1 */
    double                 prnu;
    LineScan               scan;
    double                 ac_per_line, line_noise, line_noise_px;
    double                 bad_share, bad_clustered, bad_patched;
    double                 noise_scale; /* of all noise and non-uniformity; 1 */
    bool                   smear;       /* motion within the integration time, and between lines */
} SensorPreset;

/* Reads the row of that name. An error is logged with file, line, column, value and range; an unknown name with the
 * known ones. */
Status preset_read(SensorPreset *out, const char *path, const char *name);
/* Every row of a table is read; the first that is wrong is logged. */
Status preset_check(const char *path);
/* Whether a table has a row of that name. */
Status preset_has(bool *has, const char *path, const char *name);
/* The detector seen by the converter: tdi stages integrate the same point one after another, so that light and dark
 * current add, read noise adds in squares, and NETD improves by the root of their number. */
PhotonDetector preset_photons(const SensorPreset *preset);
/* After fields were changed by settings. */
void preset_refresh(SensorPreset *preset);
/* Edges of a band in wavelength, as the renderer has them. Channel 0 .. 2 of OPTICAL_RGB: R, G, B; -1: the whole band.
 */
void preset_band(double *low_m, double *high_m, Band band, OpticalChannels optical, int channel);
/* The same with the channel's response. */
SpectralBand preset_seen(Band band, OpticalChannels optical, int channel);

/* ---- sheet.c: data sheets ----------------------------------------------------------------------- */

/* A sensor from a data sheet, with the input parameters of the FLIR92 model.
 *
 * Text, one entry per line: key, value, and its unit, which may be omitted but must otherwise be the one below; #
 * begins a comment. Every key once; unknown ones are refused. The example is etc/sensors/example_flir2.sheet.
 *
 *   name                     text          word of letters, digits, _ - .
 *   sensor_type              word          staring; parallel: one column of detectors swept over the image
 *   spectral_cut_on          microns       the band must be LWIR (7 .. 14) or MWIR (3 .. 5.5), of which our own
 *   spectral_cut_off         microns       is taken: 8 .. 12 or 3.4 .. 4.8
 *   f_number                 -             focal length over aperture
 *   obscuration              -             central, share of the diameter; 0
 *   eff_focal_length         cm
 *   avg_optical_trans        -             with what is obscured counted as lost
 *   horz_dimension           microns       of a detector's sensitive area
 *   vert_dimension           microns
 *   horz_unit_cell           microns       staring: from detector to detector; both the same (square pixels)
 *   vert_unit_cell           microns
 *   samples_per_hifov        -             parallel: samples a detector's width, 1; and rows a detector's height, 1
 *   samples_per_vifov        -
 *   horz_detectors           -             staring: columns
 *   vert_detectors           -             rows (parallel: detectors of the column)
 *   horz_fov                 degrees       parallel: of the sweep
 *   frame_rate               Hz            parallel
 *   scan_efficiency          -             parallel: share of a frame that the sweep takes; 1
 *   detectors_in_tdi         -             parallel: 1
 *   integration_time         microsec      of one stage; parallel: that from column to column
 *   quantum_efficiency       -             of the detector's own area
 *   netd                     kelvin        at 300 K, of a pixel, temporal. This or peak_d_star: what counting photons
 *   peak_d_star              1e10          leaves open is noise of the reading. In 1e10 cm sqrt(Hz) / W; a netd that
 *                                          photons do not allow is refused
 *   dark_current             electrons/s   of a stage; 0
 *   well_capacity            electrons     of what is converted; 2.5 times what 300 K gives
 *   adc_bits                 -             14
 *   sigma_tv_tvh ...         -             three-dimensional noise (and th, vh, t, v, h) over that of a pixel; 0
 *   rms_motion               mrad          random image motion, a direction; 0
 *   high_pass_3db_cuton      Hz            parallel: of the AC coupling; 0
 *
 * Source of the entries: Scott & D'Agostino, "NVEOD FLIR92 thermal imaging systems performance model", SPIE 1689
 * (1992); those of its display and observer are no part of a sensor here. */

/* On failure logs file, line, key, value and range; *out is as it was. */
Status preset_read_sheet(SensorPreset *out, const char *path);

#endif
