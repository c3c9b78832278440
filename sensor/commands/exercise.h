/* sensor/commands/exercise.h: `pitviper exercise`: a generated exercise, written as a recording or sent on the
 * network. */
#ifndef SENSOR_COMMANDS_EXERCISE_H
#define SENSOR_COMMANDS_EXERCISE_H

/* Returns the exit code: 0, 1 on failure, 2 on wrong usage. */
int exercise_command(int argc, char **argv);

#endif
