/* sensor/score/sequences.h: the folders of OUT that have truth: OUT itself, those of its hosts, or the variants of its
 * sweep. */
#ifndef SENSOR_SCORE_SEQUENCES_H
#define SENSOR_SCORE_SEQUENCES_H

#include "pitviper.h"

enum { sequences_most = 1000000, sequence_path_size = 4096 };

typedef struct Sequences {
    bool sweep;
    int  count, room;
    char (*name)[256]; /* of the folder in OUT, by name; "": OUT itself */
} Sequences;

/* Variants are those of manifest.jsonl that did not fail. STATUS_BAD_VALUE, logged: there is no truth; STATUS_IO;
 * STATUS_NO_MEMORY. */
Status sequences_find(Sequences *out, const char *folder);
void   sequences_free(Sequences *sequences);
/* FOLDER/SEQUENCE/FILE; false: too long. */
bool sequence_path(char out[sequence_path_size], const char *folder, const char *sequence, const char *file);

#endif
