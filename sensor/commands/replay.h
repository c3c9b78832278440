/* sensor/commands/replay.h: `pitviper replay LOG`: from a recorded exercise to images and truth. */
#ifndef SENSOR_COMMANDS_REPLAY_H
#define SENSOR_COMMANDS_REPLAY_H

/* argv[0] is "replay". Returns the exit code: 0 rendered, 1 nothing could be rendered, 2 wrong usage. */
int replay_command(int argc, char **argv);

#endif
