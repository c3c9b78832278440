/* render/probe_day_private.h: what probes of heat share: tables, air and weather of a place, without a scene, and the
 * day of a row.
 *
 * Each local day (by the sun's mean time at the place) is an exercise of its own, warmed up over the two days before
 * its midnight, so that a row's answer depends on no other row. */
#ifndef RENDER_PROBE_DAY_PRIVATE_H
#define RENDER_PROBE_DAY_PRIVATE_H

#include "render/frame/world.h"
#include "render/probe_private.h"

typedef struct ProbeDay {
    Materials      materials;
    GroundKinds    ground;
    PlanckTable   *planck[2];
    Atmosphere    *atmosphere;
    WeatherCourse *course;
    HeatDrive      drive; /* exercise_s: the midnight of the day that something is warm for */
    Arena         *arena;
} ProbeDay;

/* Of the probe's options (terrain/probe.h). probe_day_close after success and failure. */
Status probe_day_open(ProbeDay *out, int argc, char **argv);
void   probe_day_close(ProbeDay *day); /* accepts zeroes */

/* The midnight before a time, of a longitude's mean solar time. */
double probe_midnight_s(double unix_s, double lon_rad);
/* NULL, or what a row's time is not. */
const char *probe_time_fault(double unix_s);

#endif
