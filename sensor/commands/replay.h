/* sensor/commands/replay.h: `pitviper replay LOG`: from a recorded exercise to pictures and truth. */
#ifndef SENSOR_COMMANDS_REPLAY_H
#define SENSOR_COMMANDS_REPLAY_H

/* argv[0] is "replay". Returns the exit code: 0 shown, 1 nothing could be shown, 2 the command was wrong. */
int replay_command(int argc, char **argv);

#endif
