/* sensor/node/player/heard.h: datagrams that a live node keeps from before its choices. */
#ifndef SENSOR_NODE_PLAYER_HEARD_H
#define SENSOR_NODE_PLAYER_HEARD_H

#include "dis/capture/log.h"

/* In order of arrival; each owns its octets. Zeroed: none. */
typedef struct Heard {
    DisDatagram *datagram; /* [count] */
    int          count, capacity;
} Heard;

/* A copy. */
Status heard_add(Heard *heard, const DisDatagram *datagram);
/* Forgets the oldest. */
void heard_drop(Heard *heard, int count);
void heard_free(Heard *heard);

#endif
