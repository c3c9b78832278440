/* sensor/node/opening.h: the datagrams on which the choices of a causal run are based: those received up to
 * exercise.listen_s after the first usable Entity State. A live node and `replay --causal` of its recording select
 * the same ones by the same rule.
 *
 * The exercise begins with that Entity State, or at most opening_before datagrams earlier (a Start/Resume with the
 * time of day comes first): a long silence needs no more memory. */
#ifndef SENSOR_NODE_OPENING_H
#define SENSOR_NODE_OPENING_H

#include "dis/log.h"
#include "sensor/settings/config.h"

enum { opening_before = 1024 };

/* Whether this node sent it, by the sender of its first PDU (node.site, node.application). */
bool opening_own(const DisDatagram *datagram, const Config *config);
/* Removes this node's own datagrams from a log; returns how many. */
int  opening_drop_own(DisLog *log, const Config *config);

/* Whether a PDU is an Entity State with a usable entity id and position. */
bool opening_usable(const DisHeader *header, const uint8_t *pdu);
/* Whether a datagram contains one, of the configured exercise if there is one. header: its header; may be NULL. */
bool opening_starts(DisHeader *header, const DisDatagram *datagram, const Config *config);
/* Arrival time, Unix s, at which listening ends when this datagram starts it. */
double opening_until_s(const DisDatagram *starts, const Config *config);

/* The rule applied to a complete log. view: the log from the beginning of the exercise; heard: its datagrams
 * received in time for the choices; both borrow from the log. False when no datagram starts it. */
bool opening_of(DisLog *view, DisLog *heard, double *until_s, const DisLog *log, const Config *config);

#endif
