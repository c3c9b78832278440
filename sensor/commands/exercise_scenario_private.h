/* sensor/commands/exercise_scenario_private.h: what `exercise` and `fly` have in common: which scenario. */
#ifndef SENSOR_COMMANDS_EXERCISE_SCENARIO_PRIVATE_H
#define SENSOR_COMMANDS_EXERCISE_SCENARIO_PRIVATE_H

#include "entities/exercise/scenario.h"

/* command: whose messages these are. which: a file, or the name of a bundled scenario. */
Status exercise_scenario_read(Scenario *scenario, const char *command, const char *which);
/* KEY=VALUE of --set; false: logged. */
bool exercise_scenario_set(Scenario *scenario, const char *command, const char *text);
/* Unix time of exercise time 0 in a recording: of dis.date, else a round one. */
double exercise_scenario_epoch(const Scenario *scenario);

#endif
