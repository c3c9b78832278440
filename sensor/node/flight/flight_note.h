/* sensor/node/flight/flight_note.h: what flew the missile of a live node, noted in its recording: each launch, and each
 * line of sight that was taken. By these alone it is flown again to the same bits, whatever frames are rendered then.
 *
 * Times are exercise time. Numbers are hexadecimal, so that they come back to the bit. */
#ifndef SENSOR_NODE_FLIGHT_FLIGHT_NOTE_H
#define SENSOR_NODE_FLIGHT_FLIGHT_NOTE_H

#include "sensor/node/flight/flight_loop.h"

typedef struct FlightNote {
    bool       launch;
    int64_t    tick;    /* of a launch, ms */
    double     taken_s; /* of a sight: time of the frame that it was taken at */
    bool       after;   /* that frame was made with it not yet taken */
    LoopUsable usable;
} FlightNote;

/* One line. */
enum { flight_note_size = 640 };
void flight_note_text(char out[flight_note_size], const FlightNote *note);
/* A line, which ends with 0 or a line feed, that is to the octet what flight_note_text writes, within the ranges of its
 * values. */
bool flight_note_read(FlightNote *out, const char *line);
/* All of DisLog.notes, in order; other notes are passed over. notes may be NULL. *out NULL: there are none; the caller
 * frees it. */
Status flight_notes_read(FlightNote **out, int *count, const char *notes);

#endif
