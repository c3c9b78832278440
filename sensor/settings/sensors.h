/* sensor/settings/sensors.h: which sensor of etc/sensors.csv each band has, with the user's own settings over it. */
#ifndef SENSOR_SETTINGS_SENSORS_H
#define SENSOR_SETTINGS_SENSORS_H

#include "sensor/detector/chain.h"
#include "sensor/node/choices.h"
#include "sensor/settings/config.h"

typedef struct Sensors {
    bool         has[BAND_COUNT];
    SensorPreset preset[BAND_COUNT];
    int          sheet_band; /* whose sensor is that of sensor.table; 0, optical: none */
    Lens         lens;       /* of the picture, which all bands share: the first sensor's, or as the user says */
    double       lateral[2]; /* RenderRequest */
} Sensors;

/* Reads sensor.preset; raster and field of view of the first go into *config where the user has given none. A choice a
 * sensor says what it can do. STATUS_BAD_VALUE, logged: an unknown name, two of one band, a band that is not shown, noise
 * given beside a sensor's own, a lens that folds the picture. */
Status sensors_choose(Sensors *out, Choices *choices, Config *config, unsigned bands);

/* The detectors of the bands that have one, at their beginning; others stay NULL. On failure those made are in chain,
 * for the caller to destroy. */
Status sensors_chains(Chain *chain[BAND_COUNT], const Sensors *sensors, const Config *config);

#endif
