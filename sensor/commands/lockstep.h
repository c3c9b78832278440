/* sensor/commands/lockstep.h: a replay whose frames a CIGI host asks for, one by one (exercise.cigi). */
#ifndef SENSOR_COMMANDS_LOCKSTEP_H
#define SENSOR_COMMANDS_LOCKSTEP_H

#include "sensor/node/clock/cigi_clock.h"
#include "sensor/node/run/host_run.h"

/* Must outlive the run. */
typedef struct Lockstep {
    CigiClock clock;
} Lockstep;

/* Where the settings name a host: opens its link, and makes its clock and its frames the run's. */
Status lockstep_begin(Lockstep *out, Run *run);
void   lockstep_end(Lockstep *lockstep);

#endif
