/* sensor/score/json_pick.h: a JSON text without the members that are not wanted, so that a reader of some fields of a
 * long line need not build all of them. */
#ifndef SENSOR_SCORE_JSON_PICK_H
#define SENSOR_SCORE_JSON_PICK_H

#include "pitviper.h"

/* Writes the value to out, of at least `length` octets; of objects only members whose key is one of the names, at any
 * depth. Returns the octets written; 0: it is no JSON, as far as brackets, texts, commas and colons say, or has more
 * than 64 levels: a parser that is given the whole says where. What is passed over is not looked at more closely. */
size_t json_pick(char *out, const char *text, size_t length, const char *const *names, int count);

#endif
