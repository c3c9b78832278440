/* sensor/node/live_recording.h: what a live node hears into a file, in the thread that takes it off the socket: a node
 * that is busy with a frame, or a queue that is full, leaves nothing out of it. */
#ifndef SENSOR_NODE_LIVE_RECORDING_H
#define SENSOR_NODE_LIVE_RECORDING_H

#include "dis/udp.h"

typedef struct LiveRecording LiveRecording;

/* From now on all that arrives is recorded. STATUS_IO, logged: the file cannot be written. */
Status live_recording_open(LiveRecording **out, const char *path, const char *comment, DisUdp *udp, int port);
/* To the system, so that what a killed program had recorded is whole. NULL is fine, here and below. */
void   live_recording_flush(LiveRecording *recording);
/* Datagrams that could not be recorded. */
uint64_t live_recording_failed(LiveRecording *recording);
/* Nothing more is recorded. STATUS_IO when anything was not written. The udp must still be open. */
Status live_recording_close(LiveRecording *recording);

#endif
