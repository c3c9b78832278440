/* sensor/node/live/live_recording.h: records the datagrams of a live node to a file, in the receiving thread: the
 * recording is complete also when the node is busy with a frame or its queue is full. */
#ifndef SENSOR_NODE_LIVE_LIVE_RECORDING_H
#define SENSOR_NODE_LIVE_LIVE_RECORDING_H

#include "dis/network/udp.h"

typedef struct LiveRecording LiveRecording;

/* Records every datagram from now on. STATUS_IO, logged: the file cannot be written. */
Status live_recording_open(LiveRecording **out, const char *path, const char *comment, DisUdp *udp, int port);
/* A datagram to another port of this machine, now: of a CIGI host. */
void live_recording_add(LiveRecording *recording, int64_t unix_ns, const uint8_t from[16], uint16_t from_port, int port,
                        const uint8_t *bytes, size_t octets);
/* dis_recorder_note, now. */
Status live_recording_note(LiveRecording *recording, int64_t unix_ns, const char *text);
/* Capture time of the first datagram of the exercise in it, Unix ns; INT64_MAX: there is none. Those that arrived
 * before are not in it, and a node whose replay is to have the same frames does not use them. */
int64_t live_recording_first_ns(LiveRecording *recording);
/* Flushes to the operating system, so that the recording of a killed program is complete. NULL is valid, here and
 * below. */
void live_recording_flush(LiveRecording *recording);
/* Counts the datagrams that could not be recorded. */
uint64_t live_recording_failed(LiveRecording *recording);
/* Stops recording. STATUS_IO when anything was not written. The udp must still be open. */
Status live_recording_close(LiveRecording *recording);

#endif
