/* dis/log_clock.c: a recording's PDUs through the exercise clock, twice: to learn the senders' clocks, and by them. */
#include "dis/log_clock.h"

#include "dis/datagram.h"

#include <stdlib.h>

static Status add(DisLogTimes *times, size_t *capacity, ExerciseInstant at)
{
    if (times->count == *capacity) {
        const size_t     larger = *capacity ? 2 * *capacity : 4096;
        ExerciseInstant *grown  = realloc(times->pdu, larger * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        times->pdu = grown;
        *capacity  = larger;
    }
    times->pdu[times->count++] = at;
    return STATUS_OK;
}

/* Those whose PDUs all count from their stamps in the end are no anomaly. */
static void keep_anomalies(ExerciseClockAnomalies *doubts)
{
    int kept = 0;
    for (int i = 0; i < doubts->count; i++)
        if (doubts->sender[i].by_arrival > 0 || doubts->sender[i].reason == EXERCISE_CLOCK_SHARED)
            doubts->sender[kept++] = doubts->sender[i];
    doubts->count = kept;
}

Status dis_log_times(DisLogTimes *out, const DisLog *log, int exercise)
{
    DisLogTimes    times = {0};
    size_t         capacity = 0;
    DisCounters    ignored = {0};
    ExerciseClock *clock = NULL;
    Status         status = exercise_clock_create(&clock);
    for (int i = 0; i < log->count && status == STATUS_OK; i++) {
        const DisDatagram d = dis_log_datagram(log, i);
        const uint8_t    *at = d.bytes, *pdu;
        DisHeader         header;
        while (status == STATUS_OK && dis_next_pdu(&header, &pdu, &at, d.bytes + d.octets, &ignored))
            if (exercise < 0 || header.exercise == exercise)
                status = add(&times, &capacity, exercise_clock_pdu_instant(clock, &header, pdu, d.capture_s));
    }
    if (status == STATUS_OK) status = exercise_clock_whole(clock);
    if (status == STATUS_OK) {
        for (size_t i = 0; i < times.count; i++) exercise_clock_whole_time(clock, &times.pdu[i]);
        times.doubts = *exercise_clock_anomalies(clock);
        keep_anomalies(&times.doubts);
        *out = times;
    } else {
        dis_log_times_release(&times);
    }
    exercise_clock_destroy(clock);
    return status;
}

void dis_log_times_release(DisLogTimes *times)
{
    free(times->pdu);
    *times = (DisLogTimes){0};
}
