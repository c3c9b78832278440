/* sensor/publish/klv/klv_private.h: what the encoders of the local sets share. */
#ifndef SENSOR_PUBLISH_KLV_KLV_PRIVATE_H
#define SENSOR_PUBLISH_KLV_KLV_PRIVATE_H

#include "sensor/publish/klv/klv.h"
#include "sensor/publish/klv/klv_writer_private.h"

/* Names of sensors as they are in both local sets. */
const char *klv_sensor_name(const KlvSource *source);
double      klv_vfov_deg(const FrameRecord *record);
/* Converts to microseconds since 1970. False, with out untouched: it is not a time from 1970 to 2200. */
bool klv_time_us(uint64_t *out, double unix_s);

/* Writes the VMTI local set as the value of tag 74: without key, length and checksum, which the packet around it has.
 * time_us: the time of the packet. */
void klv_vmti(KlvWriter *w, const FrameRecord *record, uint64_t time_us, const KlvSource *source,
              const KlvTargets *targets);

#endif
