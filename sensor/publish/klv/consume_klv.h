/* sensor/publish/klv/consume_klv.h: the consumer that writes OUT/BAND.klv: the metadata packets of each frame, one
 * behind the other, for readers without video; and the geoid that metadata needs.
 *
 * Targets as publish.vmti has it; truth is marked. */
#ifndef SENSOR_PUBLISH_KLV_CONSUME_KLV_H
#define SENSOR_PUBLISH_KLV_CONSUME_KLV_H

#include "sensor/publish/consumer.h"
#include "sensor/publish/klv/klv_detections.h"
#include "sensor/settings/config.h"

typedef struct KlvFiles {
    const char   *out;     /* an existing folder */
    const Config *config;
    unsigned      bands;   /* 1 << Band */
    bool          patient; /* a packet that cannot be written is dropped, and counted in the log */
    const Geoid  *geoid;   /* NULL: no heights above mean sea level */
    Detections   *detections; /* of a recogniser, for publish.vmti=atr; outlive the consumer; NULL: none */
} KlvFiles;
Status consume_klv(Consumer **out, const KlvFiles *made_of);

/* The grid of terrain.geoid, or the installed one. False, and one line logged: there is none, and heights above mean
 * sea level will be absent. */
bool   klv_geoid_open(Geoid *out, const Config *config);

#endif
