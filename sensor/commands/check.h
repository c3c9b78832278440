/* sensor/commands/check.h: `pitviper check`: whether a file of settings is good, before an exercise depends on it. */
#ifndef SENSOR_COMMANDS_CHECK_H
#define SENSOR_COMMANDS_CHECK_H

/* argv[0] is "check". Returns the exit code: 0 all good, 1 one is not, 2 the command was wrong. */
int check_command(int argc, char **argv);

#endif
