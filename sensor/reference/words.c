/* sensor/reference/words.c: values of placeholders that are lists in the program. */
#include "sensor/reference/words.h"

#include "render/scene/view.h"

const char *reference_band(int i) { return i < BAND_COUNT ? band_name((Band)i) : NULL; }
