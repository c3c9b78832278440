/* sensor/node/cigi/cigi_recorded.h: what a CIGI host said to a live node, from that node's recording: its datagrams, in
 * the order in which they were used, and where its time began.
 *
 * In a recording they are UDP packets to exercise.cigi_port, as on the network; exercise time less the host's is a note
 * (dis_recorder_note) with the number of the datagram from which on it holds. Lockstep, scene and frames follow from
 * these alone, so that a replay of them has the same frames to the bit. */
#ifndef SENSOR_NODE_CIGI_CIGI_RECORDED_H
#define SENSOR_NODE_CIGI_CIGI_RECORDED_H

#include "dis/capture/log.h"

typedef struct CigiTimeNote {
    uint64_t datagram; /* 1: the first of the host */
    double   offset_s; /* exercise time less the host's, from that one on */
    int      port;     /* to which the host's datagrams go */
} CigiTimeNote;

/* One line; the number is hexadecimal, so that it comes back to the bit. */
enum { cigi_time_note_size = 120 };
void cigi_time_note_text(char out[cigi_time_note_size], const CigiTimeNote *note);
/* The next such note at or behind *at, which is moved on; others are passed over. False: there is none that is one to
 * the octet and within the ranges of its values. *at may be NULL. */
bool cigi_time_note_next(CigiTimeNote *out, const char **at);

typedef struct CigiRecorded CigiRecorded;
/* STATUS_BAD_VALUE, logged: the recording has no such host, or is a pipe, which cannot be read twice. port: where the
 * host's datagrams go, unless the notes say another. */
Status cigi_recorded_open(CigiRecorded **out, const char *path, int port);
void   cigi_recorded_close(CigiRecorded *recorded); /* accepts NULL */
/* The next datagram, valid until the next call. False: there is none. */
bool cigi_recorded_take(const uint8_t **datagram, size_t *octets, CigiRecorded *recorded);
/* Exercise time less the host's, by the notes up to the datagram that was taken last. */
double cigi_recorded_offset_s(CigiRecorded *recorded);

#endif
