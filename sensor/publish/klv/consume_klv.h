/* sensor/publish/klv/consume_klv.h: the consumer that writes OUT/BAND.klv: the metadata packets of each frame, one
 * behind the other, for readers without video; and the geoid that metadata needs.
 *
 * Targets as publish.vmti has it; truth is marked. */
#ifndef SENSOR_PUBLISH_KLV_CONSUME_KLV_H
#define SENSOR_PUBLISH_KLV_CONSUME_KLV_H

#include "sensor/publish/consumers/consumer.h"
#include "sensor/settings/config.h"
#include "sensor/publish/klv/klv.h"
#include "sensor/publish/answers/answers.h"

typedef struct KlvFiles {
    const char   *out; /* an existing folder */
    const Config *config;
    unsigned      bands;   /* 1 << Band */
    bool          patient; /* a packet that cannot be written is dropped, and counted in the log */
    const Geoid  *geoid;   /* NULL: no heights above mean sea level */
    Answers      *answers; /* of a recogniser, for publish.vmti=atr; outlive the consumer; NULL: none */
} KlvFiles;
Status consume_klv(Consumer **out, const KlvFiles *made_of);

/* The grid of terrain.geoid, or the installed one. False, and one line logged: there is none, and heights above mean
 * sea level will be absent. */
bool klv_geoid_open(Geoid *out, const Config *config);

/* ---- the packet of a frame, and its targets ------------------------------------------------------ */

/* Detections of a recogniser's answer as targets of the metadata.
 *
 * They belong to the frame that was answered, mostly an earlier one than that of the packet: the VMTI local set has the
 * time and the number of that frame. The newest answer to a band is in each packet until a newer one is received, or
 * until it is klv_answers_s old. */

static const double klv_answers_s = 1;

/* One for each thread that makes metadata. */
typedef struct KlvAnswers {
    Answers   *from;
    Answer     newest;
    KlvTarget  kept[klv_most_targets];
    KlvTargets targets;
} KlvAnswers;

/* The packet of a band, with the targets of publish.vmti (vmti). Returns its octets; 0: there is none. */
size_t klv_of_band(uint8_t out[klv_most_octets], KlvAnswers *kept, enum VmtiSource vmti, const Frame *frame, Band band,
                   const Geoid *geoid);

/* A box is rounded outwards to whole pixels; a line of sight without one is the pixel that it goes through. The id is
 * the track; of a detection without one 2^32 plus its place in the list, which says nothing from frame to frame. */
void klv_of_answer(KlvTargets *out, KlvTarget kept[klv_most_targets], const Answer *answer);

#endif
