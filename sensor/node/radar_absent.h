/* sensor/node/radar_absent.h: the frames of a live node that had no radar, for want of signatures, as notes of its
 * recording, so that a replay leaves out the same.
 *
 * A note holds for the frame of that number and time alone: a replay at another rate has its radar in every frame. */
#ifndef SENSOR_NODE_RADAR_ABSENT_H
#define SENSOR_NODE_RADAR_ABSENT_H

#include "pitviper.h"

enum { radar_absent_text_size = 96 };
void radar_absent_text(char out[radar_absent_text_size], int number, double t_s);

typedef struct RadarAbsent RadarAbsent;
/* From DisLog.notes; other notes are passed over. *out NULL: none. */
Status radar_absent_read(RadarAbsent **out, const char *notes);
void   radar_absent_free(RadarAbsent *absent); /* accepts NULL */
bool   radar_absent_in(const RadarAbsent *absent, int number, double t_s); /* of NULL: false */

#endif
