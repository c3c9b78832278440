/* sensor/reference/words.h: placeholders used in several topics. */
#ifndef SENSOR_REFERENCE_WORDS_H
#define SENSOR_REFERENCE_WORDS_H

#include "sensor/reference/reference.h"

const char *reference_band(int i); /* optical ...; NULL at the end */

#define REFERENCE_WORD_BAND {"BAND", "one of", reference_band, NULL}

#define REFERENCE_WORD_CONSUMER                                                                                        \
    {"CONSUMER", "what the frame went to: image_files, truth_lines, dis, memory, video and so on", NULL, NULL}

#endif
