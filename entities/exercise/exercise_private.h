/* entities/exercise/exercise_private.h: from PDUs to datagrams: time stamps, bundles, and simulated network faults;
 * malformed ones.
 *
 * Loss, duplication and reordering depend on the datagram's number alone: the same scenario gives the same octets. */
#ifndef ENTITIES_EXERCISE_EXERCISE_PRIVATE_H
#define ENTITIES_EXERCISE_EXERCISE_PRIVATE_H

#include "entities/exercise/exercise.h"

enum { link_capacity = 65536 };

typedef struct ExerciseLink {
    const Scenario *scenario;
    double          epoch_unix_s; /* of exercise time 0: absolute stamps */
    ExerciseSink   *sink;
    void           *user;
    bool            stopped;
    uint64_t        number; /* of datagrams generated */
    ExerciseCounts  counts;
    size_t          pending, held; /* octets of a bundle; of a datagram reordered with the next */
    double          pending_s;
    uint8_t         bundle[link_capacity], behind[link_capacity];
} ExerciseLink;

DisHeader link_header(const ExerciseLink *link, uint8_t type, uint8_t family, double t_s);
/* Alone, or with others of the same time. */
void link_pdu(ExerciseLink *link, double t_s, const uint8_t *bytes, size_t octets);
void link_flush(ExerciseLink *link);
/* Sends the datagrams still delayed. */
void link_finish(ExerciseLink *link, double t_s);

/* One malformed datagram of each kind, in turn, 0 .. exercise_bad_kinds - 1. */
enum { exercise_bad_kinds = 14 };
void exercise_send_bad(ExerciseLink *link, const Cast *cast, DisEntityState *es, int kind, double t_s);
/* Entity State of an entity with these kinematics (world axes), as its algorithm requires; without articulation. */
void exercise_fill_state(DisEntityState *es, const ExerciseLink *link, const Cast *cast, int entity,
                         const Kinematics *k, uint32_t appearance, double t_s);

#endif
