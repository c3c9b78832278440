/* sensor/node/ground_store.h: the ground of a node from a terrain store (terrain.store). */
#ifndef SENSOR_NODE_GROUND_STORE_H
#define SENSOR_NODE_GROUND_STORE_H

#include "sensor/node/choices.h"

/* The store's own local frame, for everything. Looks at the store's sources: changed ones are imported again first.
 * aim: the frame that the exercise would have by itself; STATUS_BAD_VALUE, logged, when that is not on the store's
 * ground. */
Status ground_store_frame(LocalFrame *out, Choices *choices, const Config *config, const LocalFrame *aim);
/* The store's landscape, and what is in it as choices. */
Status ground_store_open(Landscape *out, Choices *choices, const Config *config);

#endif
