/* sensor/settings/sensors.h: the sensor of each band from etc/sensors.csv, with the overrides of the settings. */
#ifndef SENSOR_SETTINGS_SENSORS_H
#define SENSOR_SETTINGS_SENSORS_H

#include "sensor/detector/chain.h"
#include "sensor/settings/config.h"

typedef struct Sensors {
    bool         has[BAND_COUNT];
    SensorPreset preset[BAND_COUNT];
    int          sheet_band; /* band of the sensor of sensor.table; 0, optical: none */
    Lens         lens;       /* of the image, shared by all bands: of the first sensor, or as configured */
    double       lateral[2]; /* RenderRequest */
} Sensors;

/* Reads sensor.preset. The raster and field of view of the first are written to *config unless they were given. A
 * choice for each sensor lists its properties. STATUS_BAD_VALUE, logged: an unknown name, two of one band, a band that
 * is not rendered, noise given for a band whose sensor has its own, a distortion that is not invertible. */
Status sensors_choose(Sensors *out, Choices *choices, Config *config, unsigned bands);

/* The row of that name in the user's table (sensor.table), where it has one, else in etc/sensors.csv. Failures are
 * logged.
 */
Status sensors_find(SensorPreset *out, const char *name);
/* The sensor by itself: its channel takes its place for the process, before tables are read, and its band is that. */
void sensors_alone(SensorPreset *preset);

#endif
