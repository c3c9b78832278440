/* sensor/node/run/world_note.h: what a live node's world was made from, noted in its recording, so that every replay of
 * that makes the very same ground, plants and roads.
 *
 * The ground follows from settings, the datagrams that were heard when it was made, and where it lies. Settings are the
 * replay's; the rest is in the note. A recording without a note gives a world by all that it holds. */
#ifndef SENSOR_NODE_RUN_WORLD_NOTE_H
#define SENSOR_NODE_RUN_WORLD_NOTE_H

#include "sensor/node/choices/choices.h"
#include "terrain/earth/geodesy.h"

typedef struct WorldNote {
    double      until_s; /* arrival of the last datagram that may have a part in it, Unix time */
    Geodetic    origin;  /* of its frame */
    WoodsSquare square;
} WorldNote;

/* One line. Numbers are hexadecimal, so that they come back to the bit. */
enum { world_note_size = 320 };
void world_note_text(char out[world_note_size], const WorldNote *note);
/* The first such note of DisLog.notes. False: there is none that is one to the octet and within the ranges of its
 * values; notes may be NULL. */
bool world_note_read(WorldNote *out, const char *notes);

#endif
