/* sensor/node/opening.h: what a causal run makes its choices from: what was heard up to exercise.listen_s after the
 * first usable Entity State. A live node and `replay --causal` of its recording come to the same by the same rule.
 *
 * The exercise begins with that Entity State, or at most opening_before datagrams earlier (a Start/Resume that tells
 * the time of day comes first): nobody has to keep more of a long silence. */
#ifndef SENSOR_NODE_OPENING_H
#define SENSOR_NODE_OPENING_H

#include "dis/log.h"
#include "sensor/settings/config.h"

enum { opening_before = 1024 };

/* Whether this node sent it, by the sender of its first PDU (node.site, node.application). */
bool opening_own(const DisDatagram *datagram, const Config *config);
/* Takes this node's own datagrams out of a log; how many. */
int  opening_drop_own(DisLog *log, const Config *config);

/* Whether a PDU is an Entity State whose entity and place can be used. */
bool opening_usable(const DisHeader *header, const uint8_t *pdu);
/* Whether a datagram holds one, of the exercise that is configured, if one is. header: its; may be NULL. */
bool opening_starts(DisHeader *header, const DisDatagram *datagram, const Config *config);
/* Arrival time, Unix s, up to which is listened when this datagram starts. */
double opening_until_s(const DisDatagram *starts, const Config *config);

/* The rule on a whole log. view: the log from where the exercise begins; heard: those of it that were received in time
 * for the choices; both borrow from the log. False when nothing in it starts. */
bool opening_of(DisLog *view, DisLog *heard, double *until_s, const DisLog *log, const Config *config);

#endif
