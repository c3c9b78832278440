/* sensor/radar/radar_preset.h: a radar as a row of etc/radars.csv, or of a user's table (radar.table). */
#ifndef SENSOR_RADAR_RADAR_PRESET_H
#define SENSOR_RADAR_RADAR_PRESET_H

#include "sensor/radar/antenna_private.h"
#include "sensor/radar/interval_private.h"

typedef struct RadarPreset {
    char     name[32];
    Waveform wave;
    Antenna  antenna;
    Receiver receiver;
    Window   range_window, doppler_window;
    double   power_w, loss; /* in a pulse; a factor */
    double   pfa;
    double   far_m;       /* farthest range whose echoes fold into the window; 0: those within it alone */
    int      mti_rows;    /* of the canceller: 2 or 3 */
    bool     transmits_h; /* else vertical */
} RadarPreset;

/* Reads the row of that name. An error is logged with file, line, column, value and range; an unknown name with the
 * known ones. */
Status radar_preset_read(RadarPreset *out, const char *path, const char *name);
/* Every row of a table is read; the first that is wrong is logged. */
Status radar_preset_check(const char *path);

#endif
