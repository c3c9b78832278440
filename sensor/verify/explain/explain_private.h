/* sensor/verify/explain/explain_private.h: what a pixel met of scenery, for its text and its JSON. */
#ifndef SENSOR_VERIFY_EXPLAIN_EXPLAIN_PRIVATE_H
#define SENSOR_VERIFY_EXPLAIN_EXPLAIN_PRIVATE_H

#include "sensor/verify/explain/explain.h"

struct json_t;

/* `house 00000000000004d2, wall`; `car 00000000000004d2 (clutter), hull`. */
void explain_scenery_name(char *out, size_t size, const Explained *e, const PixelSample *sample);
/* Where its temperature comes from: a line; and members of a JSON object. */
void explain_scenery_heat(FILE *to, const SceneryHeatOf *heat);
void explain_scenery_json(struct json_t *out, const SceneryHeatOf *heat);

#endif
