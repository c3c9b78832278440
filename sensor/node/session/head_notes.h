/* sensor/node/session/head_notes.h: poses of a head by which frames of a live node were made, noted in its recording,
 * so that a replay makes the same. A note is the datagram, and the time of the frame from which on it holds. */
#ifndef SENSOR_NODE_SESSION_HEAD_NOTES_H
#define SENSOR_NODE_SESSION_HEAD_NOTES_H

#include "dis/head/head_pose.h"

typedef struct HeadNote {
    double   t_s; /* exercise time of the frame */
    HeadPose pose;
} HeadNote;

/* One line; the time is hexadecimal, so that it comes back to the bit. */
enum { head_note_size = 200 };
void head_note_text(char out[head_note_size], const HeadNote *note);

typedef struct HeadNotes {
    int      count;
    HeadNote note[]; /* in order of time */
} HeadNotes;

/* Reads DisLog.notes; other notes are passed over. *out NULL: there are none. The caller frees them. */
Status head_notes_read(HeadNotes **out, const char *notes);
/* The last one at or before t_s; -1: there is none. */
int head_notes_at(const HeadNotes *notes, double t_s);

#endif
