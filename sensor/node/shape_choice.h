/* sensor/node/shape_choice.h: which types of an exercise have no shape to be seen by, said before the first frame. */
#ifndef SENSOR_NODE_SHAPE_CHOICE_H
#define SENSOR_NODE_SHAPE_CHOICE_H

#include "sensor/node/choices.h"

/* Builds the models of all that the survey heard, so that no frame waits for one, and says of each type once when
 * nothing is seen of it (`none` in the catalog), or when no row knows it (a wedge stands for it). At most four types by
 * name. */
void choose_shapes(Choices *choices, const Survey *survey, const Catalog *catalog);

#endif
