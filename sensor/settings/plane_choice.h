/* sensor/settings/plane_choice.h: truth planes written to files (publish.planes, --planes). All but emissivity are computed
 * in any case: truth.jsonl, coco.json and the hash of a frame do not depend on the choice. */
#ifndef SENSOR_SETTINGS_PLANE_CHOICE_H
#define SENSOR_SETTINGS_PLANE_CHOICE_H

#include "pitviper.h"

typedef enum PlaneChoice {
    PLANE_RANGE, PLANE_ENTITY, PLANE_PART, PLANE_MATERIAL, PLANE_TEMPERATURE, PLANE_NORMAL,
    PLANE_INSTANCE, PLANE_COVER, /* of a world with plants */
    PLANE_EMISSIVITY,            /* of thermal bands, made for the file (sensor/publish/emissivity.h) */
    PLANE_CHOICES
} PlaneChoice;

enum { planes_none = 0, planes_all = (1 << PLANE_CHOICES) - 1 };

extern const char *const plane_choice_name[PLANE_CHOICES];

/* all, none, or a list of names with commas, as a set of 1 << PlaneChoice. False: it is neither. */
bool plane_choice_parse(unsigned *planes, const char *text);

/* What is wrong with a list that is refused: "; NAME is named twice", "; did you mean NAME?", or "". */
void plane_choice_why(char *out, size_t out_size, const char *text);

#endif
