/* sensor/instruments/radar.h: the seeker's radar (sensor/radar/) as an instrument: on the camera's axis, about the same
 * aim. It fills record.radar and, with the error budget, record.radar_error. */
#ifndef SENSOR_INSTRUMENTS_RADAR_H
#define SENSOR_INSTRUMENTS_RADAR_H

#include "sensor/instruments/instrument.h"
#include "sensor/radar/seeker_radar.h"

extern const InstrumentKind radar_kind;

/* What the frame's first radar measured; NULL: there is none, or it was left out. */
const RadarFrame *radar_of(const Frame *frame);

/* The radar of radar.preset, which is not none. live: signatures that are missing are made in the background. cache:
 * where they are kept without radar.library; NULL: nowhere. */
Status radar_open(SeekerRadar **out, const Config *config, const char *isa, bool live, Cache *cache);

#endif
