/* sensor/publish/klv/klv_detections.h: detections received from a recogniser as targets of the metadata.
 *
 * They belong to the frame that they were found in, mostly an earlier one than that of the packet: the VMTI local set
 * has the time and the number of that frame. The newest of a band are in each packet until newer ones are received, or
 * until they are klv_detections_s old. */
#ifndef SENSOR_PUBLISH_KLV_KLV_DETECTIONS_H
#define SENSOR_PUBLISH_KLV_KLV_DETECTIONS_H

#include "sensor/publish/klv/klv.h"
#include "sensor/publish/memory/detections.h"

static const double klv_detections_s = 1;

/* One for each thread that makes metadata. */
typedef struct KlvDetections {
    Detections  *from;
    DetectionSet set;
    KlvTarget    kept[klv_most_targets];
    KlvTargets   targets;
} KlvDetections;

/* The targets of a frame; NULL: none are known. Valid until the next call. */
const KlvTargets *klv_detections(KlvDetections *kept, const Frame *frame, Band band);

/* The packet of a band, with the targets of publish.vmti (vmti). Returns its octets; 0: there is none. */
size_t klv_of_band(uint8_t out[klv_most_octets], KlvDetections *kept, const char *vmti, const Frame *frame, Band band,
                   const Geoid *geoid);

/* A box is rounded outwards to whole pixels. The id is the track; of a detection without one 2^32 plus its place in the
 * list, which says nothing from frame to frame. */
void klv_of_detections(KlvTargets *out, KlvTarget kept[klv_most_targets], const DetectionSet *set);

#endif
