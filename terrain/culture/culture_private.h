/* terrain/culture/culture_private.h: what the files of this folder share. */
#ifndef TERRAIN_CULTURE_CULTURE_PRIVATE_H
#define TERRAIN_CULTURE_CULTURE_PRIVATE_H

#include "terrain/culture/culture.h"

void culture_index_free(Culture *culture);

/* Which records are near some place: [buildings], [lines], [points]. */
typedef struct CultureMarks {
    bool *building, *line, *point;
} CultureMarks;
/* Adds those within more_m of a place. */
void culture_mark_near(CultureMarks *marks, const Culture *culture, double x_m, double y_m, double more_m);

#endif
