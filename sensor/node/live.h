/* sensor/node/live.h: `pitviper run`: a node on a DIS exercise. Its frames equal those of `replay --causal` of its
 * recording, to the bit: the same functions, at the same exercise times, with the same arrival times. */
#ifndef SENSOR_NODE_LIVE_H
#define SENSOR_NODE_LIVE_H

/* argv[0] is "run". Returns the exit code: 0 ended as requested, 1 it could not begin or continue, 2 wrong usage. */
int run_command(int argc, char **argv);

#endif
