/* sensor/commands/exercise_places_private.h: what `pitviper exercise` says of entities that hide. */
#ifndef SENSOR_COMMANDS_EXERCISE_PLACES_PRIVATE_H
#define SENSOR_COMMANDS_EXERCISE_PLACES_PRIVATE_H

#include "entities/exercise/cast_private.h"

/* Prints the settings of a node with this ground, and what hides; writes the table of places to a file, NULL: to none.
 * Nothing without ground.invented. STATUS_IO, STATUS_BAD_VALUE: logged. */
Status exercise_places(const Cast *cast, const char *path, bool overwrite);
/* The place of the scenario's ground as the setting terrain.place has it. */
enum { exercise_place_size = 80 };
void exercise_place_text(char out[exercise_place_size], const Scenario *scenario);

#endif
