/* sensor/node/session/aim_error.h: by how much a sensor misses its aim: an offset for the whole run, and a slow walk.
 *
 * Both are functions of seed, host and time alone, whatever frames there are. The walk is Gaussian, in azimuth and in
 * elevation of the picture each: a sum over normal numbers every quarter of the time constant, by counter, weighted by
 * exp(-2 (t - t_k)^2 / tau^2), so that it is smooth, its variance is sigma^2 to 1e-9, and its correlation over a time d
 * is exp(-(d / tau)^2): 1/e after tau (tests/sensor/test_aim_error.c). */
#ifndef SENSOR_NODE_SESSION_AIM_ERROR_H
#define SENSOR_NODE_SESSION_AIM_ERROR_H

#include "sensor/settings/config.h"
#include "sensor/settings/aim_offset.h"
#include "dis/pdu/pdu.h"

/* Where the aim appears: tangents of its angles from the boresight, to the right and down. who: the host, else the aim
 * of an observer. */
void aim_error_at(double tangent[2], const Config *config, DisEntityId who, double t_s);
/* The walk alone, rad. axis: 0, 1. */
double aim_walk_rad(uint64_t seed, uint64_t who, int axis, double sigma_rad, double tau_s, double t_s);
/* Turns a camera by the smallest angle that puts what is on its boresight there. */
void aim_error_turn(double r_enu_from_cam[9], const double tangent[2]);

#endif
