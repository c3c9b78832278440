/* sensor/commands/check.h: `pitviper check`: validates a settings file before an exercise depends on it. */
#ifndef SENSOR_COMMANDS_CHECK_H
#define SENSOR_COMMANDS_CHECK_H

/* argv[0] is "check". Returns the exit code: 0 all valid, 1 one is not, 2 wrong usage. */
int check_command(int argc, char **argv);

#endif
