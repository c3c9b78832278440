/* sensor/node/live_summary.h: the last lines of `pitviper run`. */
#ifndef SENSOR_NODE_LIVE_SUMMARY_H
#define SENSOR_NODE_LIVE_SUMMARY_H

#include "sensor/node/health.h"
#include "sensor/publish/records.h"

/* own: datagrams heard that the node itself had sent. */
void live_summary(const LiveCounters *counters, const HealthSample *sample, uint64_t own);

#endif
