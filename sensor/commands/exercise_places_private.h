/* sensor/commands/exercise_places_private.h: what `pitviper exercise` says of entities that hide. */
#ifndef SENSOR_COMMANDS_EXERCISE_PLACES_PRIVATE_H
#define SENSOR_COMMANDS_EXERCISE_PLACES_PRIVATE_H

#include "entities/exercise/exercise.h"

/* Prints the settings of a node with this ground, and what hides; writes the table of places to a file, NULL: to none.
 * Nothing without ground.planted. STATUS_IO, STATUS_BAD_VALUE: logged. */
Status exercise_places(const Cast *cast, const char *path, bool overwrite);

#endif
