/* sensor/commands/inspect/findings_private.h: the findings of one pass over a log, for its summary. */
#ifndef SENSOR_COMMANDS_INSPECT_FINDINGS_PRIVATE_H
#define SENSOR_COMMANDS_INSPECT_FINDINGS_PRIVATE_H

#include "dis/pdu/decode.h"
#include "dis/clock/exercise_clock.h"
#include "dis/capture/log.h"

typedef struct EntityRow {
    DisEntityId   id;
    DisEntityType type;
    char          marking[11];
    uint8_t       force, most_variable;
    uint64_t      reports;
    bool          placed; /* some report had a usable position */
    double        first_s, last_s;
    double        first_ecef[3], last_ecef[3];
    double        travelled_m, fastest_mps;
    uint32_t      algorithms[8]; /* bit set over 0 .. 255 */
    bool          deactivated;
} EntityRow;

typedef struct SenderRow {
    DisEntityId id; /* entity 0 */
    uint64_t    pdus, absolute, unstamped;
    bool        version[8];
} SenderRow;

typedef struct EventRow {
    double        t_s;
    bool          fire;
    DisEntityId   firing, target, munition;
    DisEntityType type;
    uint8_t       result;
} EventRow;

/* A growing array of rows, with a hash over their ids where they have one. */
typedef struct Rows {
    size_t    size; /* of a row */
    int       count, capacity;
    char     *row;
    uint32_t *slot; /* row + 1, 0 = empty [slots] */
    uint32_t  slots;
} Rows;

typedef struct Findings {
    DisCounters            counters;
    uint64_t               version[8], exercise[256];
    double                 first_s, last_s;
    Rows                   entities, senders, events;
    uint64_t               removed, started, stopped;
    ExerciseClockAnomalies doubts; /* senders whose stamps are not a clock */
} Findings;

static inline void *findings_row(const Rows *rows, int i) { return rows->row + (size_t)i * rows->size; }

/* exercise: only this one; -1: all. Entities and senders in the order of their ids, events in that of the log.
 * findings_release after a failure too. */
Status findings_gather(Findings *out, const DisLog *log, int exercise);
void   findings_release(Findings *findings);

#endif
