/* dis/log_clock.h: exercise times of all PDUs of a recording, each by what the whole recording tells of its sender's
 * clock. */
#ifndef DIS_LOG_CLOCK_H
#define DIS_LOG_CLOCK_H

#include "dis/exercise_clock.h"
#include "dis/log.h"

typedef struct DisLogTimes {
    ExerciseInstant       *pdu; /* [count]: of every PDU of dis_next_pdu, in its order, that is of the exercise; t_s NaN
                                 * for one that names no sender */
    size_t                 count;
    ExerciseClockAnomalies doubts;
} DisLogTimes;

/* exercise: only this id; -1: all. */
Status dis_log_times(DisLogTimes *out, const DisLog *log, int exercise);
void   dis_log_times_release(DisLogTimes *times);

#endif
