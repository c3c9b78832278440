/* sensor/node/shape_choice.h: types of an exercise without a shape, reported before the first frame. */
#ifndef SENSOR_NODE_SHAPE_CHOICE_H
#define SENSOR_NODE_SHAPE_CHOICE_H

#include "sensor/node/choices.h"

/* Builds the models of all types in the survey, so that no frame waits for one, and reports each type once when it
 * is not rendered (`none` in the catalog), or when no row matches (rendered as a wedge). At most four types by name. */
void choose_shapes(Choices *choices, const Survey *survey, const Catalog *catalog);

#endif
