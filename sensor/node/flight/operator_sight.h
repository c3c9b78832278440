/* sensor/node/flight/operator_sight.h: an operator's aim for a missile, by UDP: one line of text a datagram.
 *
 *     aim NUMBER AZIMUTH_DEG ELEVATION_DEG [launch]
 *
 * NUMBER grows from datagram to datagram; one that does not is refused, until a second without any has passed (an
 * operator's program that was started anew). AZIMUTH_DEG is clockwise from north, ELEVATION_DEG above level, both of
 * the line of sight at the missile; `launch`: the key is pressed. A line feed may follow. Anything else is refused, and
 * counted. */
#ifndef SENSOR_NODE_FLIGHT_OPERATOR_SIGHT_H
#define SENSOR_NODE_FLIGHT_OPERATOR_SIGHT_H

#include "pitviper.h"

typedef struct OperatorAim {
    long long number; /* 0 .. 2^53 */
    double    azimuth_rad, elevation_rad;
    bool      launch;
} OperatorAim;

/* STATUS_BAD_VALUE: it is not such a line, or an angle is outside -360 .. 360, -90 .. 90. */
Status operator_aim_parse(OperatorAim *out, const uint8_t *bytes, size_t octets);
/* The line of sight of an aim from a place, ECEF, unit. False: no place on the Earth. */
bool operator_direction(double los_ecef[3], const OperatorAim *aim, const double p_ecef[3]);

typedef struct OperatorSight OperatorSight;
/* Listens on a UDP port of this machine. STATUS_IO, logged. */
Status operator_sight_open(OperatorSight **out, int port);
/* The newest since the last call; launch: of any since. False: none. Takes 1024 datagrams at most. */
bool operator_sight_newest(OperatorAim *out, OperatorSight *sight);
/* Logs the counts. NULL is valid. */
void operator_sight_close(OperatorSight *sight);

#endif
