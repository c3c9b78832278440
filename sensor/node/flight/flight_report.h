/* sensor/node/flight/flight_report.h: a missile in the loop as others in the exercise see it: its Fire, Entity States
 * and Detonation.
 *
 * An Entity State is due at each tick of 10 ms at which dead reckoning of the last one is a threshold off, or a
 * heartbeat after it; so at every tick a receiver's dead reckoning is within the thresholds, as far as the network
 * delivers. Dead reckoning is FVW (5): straight attitude, position by velocity and acceleration in world axes. What is
 * sent follows from the flight alone, so a replay sends the same octets. */
#ifndef SENSOR_NODE_FLIGHT_FLIGHT_REPORT_H
#define SENSOR_NODE_FLIGHT_FLIGHT_REPORT_H

#include "entities/motion/dead_reckoning.h"
#include "sensor/node/flight/flight_loop.h"

typedef struct FlightReportOf {
    uint8_t       version, exercise; /* as in the exercise */
    DisEntityId   shooter;           /* 0:0:0: none */
    DisEntityType type;
    uint8_t       force;
    double        threshold_m, threshold_rad, heartbeat_s;
    void         *user;
    /* The raw time stamp of an exercise time. */
    uint32_t (*stamp)(void *user, double t_s);
    void (*send)(void *user, double t_s, const uint8_t *pdu, size_t octets);
} FlightReportOf;

typedef struct FlightReport {
    FlightReportOf of;
    uint16_t       event; /* number of the Fire */
    bool           known, closed;
    double         said_s; /* of the last Entity State */
    Kinematics     said;   /* as rounded in it */
    FlightState    before; /* at the tick before */
    bool           before_known;
    uint64_t       states; /* Entity States sent */
} FlightReport;

/* At each tick of 10 ms from the launch on: what is due of it. The Detonation, and an Entity State that deactivates,
 * are the last. */
void flight_report_tick(FlightReport *report, const FlightLoop *loop, const LoopScene *scene, double t_s);
/* For the next missile, with the next event. */
void flight_report_next(FlightReport *report);

#endif
