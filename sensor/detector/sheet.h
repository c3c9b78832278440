/* sensor/detector/sheet.h: a sensor from a data sheet, with the input parameters of the FLIR92 model.
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
#ifndef SENSOR_DETECTOR_SHEET_H
#define SENSOR_DETECTOR_SHEET_H

#include "sensor/detector/preset.h"

/* On failure logs file, line, key, value and range; *out is as it was. */
Status sheet_read(SensorPreset *out, const char *path);

#endif
