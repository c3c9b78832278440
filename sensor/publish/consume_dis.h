/* sensor/publish/consume_dis.h: Data PDUs (dis_records.h) as a consumer of frames: one per frame and band, as
 * publish.dis says, and the announcements of the video streams, as publish.stream says. What they contain depends on
 * the frame alone, so a live node and a replay of its recording send the same octets for the same frame. */
#ifndef SENSOR_PUBLISH_CONSUME_DIS_H
#define SENSOR_PUBLISH_CONSUME_DIS_H

#include "sensor/publish/consumer.h"
#include "sensor/publish/dis_records.h"
#include "sensor/settings/config.h"

/* Sends one datagram; must not wait. What it returns is for its own counters: a PDU that is not sent ends nothing. */
typedef Status DisSend(void *user, const uint8_t *pdu, size_t octets);
/* Unix time at which an exercise time is over, on the clock that datagrams are stamped with on arrival. */
typedef double DisArrivalTime(const void *clock, double t_s);

typedef struct DisOf {
    const Config   *config;            /* publish.dis: not off */
    unsigned        bands;
    uint8_t         version, exercise; /* as in the exercise */
    DisSend        *send;
    void           *user;
    DisArrivalTime *arrival_s;         /* of the time stamps: those of a replay are those of the recorded hour */
    const void     *clock;
} DisOf;

Status consume_dis(Consumer **out, const DisOf *of);

/* Exercise time between two announcements of a stream. */
static const double dis_announce_s = 5;

#endif
