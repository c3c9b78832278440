/* sensor/node/live.h: `pitviper run`: a node on a DIS exercise. Its frames are those that `replay --causal` makes of
 * its recording, to the bit: the same functions, asked at the same exercise times, by the same arrival times. */
#ifndef SENSOR_NODE_LIVE_H
#define SENSOR_NODE_LIVE_H

/* argv[0] is "run". Returns the exit code: 0 ended as told, 1 it could not begin or go on, 2 the command was wrong. */
int run_command(int argc, char **argv);

#endif
