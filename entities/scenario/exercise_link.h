/* entities/scenario/exercise_link.h: from PDUs to datagrams: time stamps, bundles, and simulated network faults.
 *
 * Loss, duplication and reordering depend on the datagram's number alone: the same scenario gives the same octets. */
#ifndef ENTITIES_SCENARIO_EXERCISE_LINK_H
#define ENTITIES_SCENARIO_EXERCISE_LINK_H

#include "entities/scenario/scenario.h"

/* One datagram at exercise time t_s; times do not decrease. False: stop. */
typedef bool ExerciseSink(void *user, double t_s, const uint8_t *bytes, size_t octets);

typedef struct ExerciseCounts {
    uint64_t pdus, datagrams, octets; /* as sent; PDUs: as generated */
    uint64_t lost, duplicated, overtaken, malformed;
} ExerciseCounts;

enum { link_capacity = 65536 };

typedef struct ExerciseLink {
    const Scenario *scenario;
    double          epoch_unix_s; /* of exercise time 0: absolute stamps */
    ExerciseSink   *sink;
    void           *user;
    bool            stopped;
    uint64_t        number;       /* of datagrams generated */
    ExerciseCounts  counts;
    size_t          pending, held;  /* octets of a bundle; of a datagram reordered with the next */
    double          pending_s;
    uint8_t         bundle[link_capacity], behind[link_capacity];
} ExerciseLink;

DisHeader link_header(const ExerciseLink *link, uint8_t type, uint8_t family, double t_s);
/* Alone, or with others of the same time. */
void link_pdu(ExerciseLink *link, double t_s, const uint8_t *bytes, size_t octets);
void link_flush(ExerciseLink *link);
/* These octets as a datagram, without validation. */
void link_datagram(ExerciseLink *link, double t_s, const uint8_t *bytes, size_t octets);
/* Sends the datagrams still delayed. */
void link_finish(ExerciseLink *link, double t_s);

#endif
