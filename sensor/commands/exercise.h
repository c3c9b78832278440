/* sensor/commands/exercise.h: `pitviper exercise`: an invented exercise, written as a recording or sent on the
 * network. */
#ifndef SENSOR_COMMANDS_EXERCISE_H
#define SENSOR_COMMANDS_EXERCISE_H

/* Returns the exit code: 0, 1 when something could not be done, 2 when it was not understood. */
int exercise_command(int argc, char **argv);

#endif
