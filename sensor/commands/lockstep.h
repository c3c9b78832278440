/* sensor/commands/lockstep.h: a replay or a live node whose frames a CIGI host asks for, one by one (exercise.cigi). */
#ifndef SENSOR_COMMANDS_LOCKSTEP_H
#define SENSOR_COMMANDS_LOCKSTEP_H

#include "sensor/node/clock/cigi_clock.h"
#include "sensor/node/run/host_run.h"

/* Must outlive the run. */
typedef struct Lockstep {
    CigiClock clock;
} Lockstep;

/* Where the settings name a host: opens its link, and makes its clock the run's; with a recording (live: NULL) its
 * frames, too. */
Status lockstep_begin(Lockstep *out, Run *run, const LiveClock *live);
/* The world is made: from here on the host is answered. from_s, to_s: as CigiClock; to_s NaN: without end. */
void lockstep_span(Lockstep *lockstep, const Run *run, double from_s, double to_s);
/* What the host says goes into a recording, too. */
void lockstep_record(Lockstep *lockstep, const CigiTap *tap);
void lockstep_end(Lockstep *lockstep);

#endif
