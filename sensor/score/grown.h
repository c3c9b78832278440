/* sensor/score/grown.h: lists that grow. */
#ifndef SENSOR_SCORE_GROWN_H
#define SENSOR_SCORE_GROWN_H

#include "pitviper.h"

#include <stdlib.h>

/* The list with room for so many; the old one, and *status STATUS_NO_MEMORY, where memory is out. */
static inline void *grown(Status *status, void *list, size_t count, size_t size)
{
    void *more = *status == STATUS_OK && count <= INT32_MAX / 4 ? realloc(list, count * size) : NULL;
    if (!more) *status = STATUS_NO_MEMORY;
    return more ? more : list;
}

#endif
