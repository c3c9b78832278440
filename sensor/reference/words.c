/* sensor/reference/words.c: lists that the program has, for words in capitals. */
#include "sensor/reference/words.h"

#include "render/scene/view.h"

const char *reference_band(int i) { return i < BAND_COUNT ? band_name((Band)i) : NULL; }
