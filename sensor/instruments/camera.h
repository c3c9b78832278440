/* sensor/instruments/camera.h: the camera as an instrument: the picture's bands behind the detectors of sensor.preset.
 * Their displays are made later, by consume_displays, if a consumer wants them: by a Camera of its own, in its thread,
 * which carries their levels. A session that has targets has a camera. */
#ifndef SENSOR_INSTRUMENTS_CAMERA_H
#define SENSOR_INSTRUMENTS_CAMERA_H

#include "sensor/instruments/instrument.h"

extern const InstrumentKind camera_kind;

/* The detectors of the list's first camera; NULL: there is none. */
const Camera *camera_of(const Instruments *list);
/* Their noise at the mean radiance of the frame's picture; NULL: no consumer wants targets. */
const TruthNoise *camera_noise(const Frame *frame);

#endif
