/* sensor/publish/consume_dis.c: a consumer that sends each frame and its radar's detections as Data PDUs, and
 * announces the video streams. */
#include "sensor/publish/consume_dis.h"

#include "dis/exercise_clock.h"

#include <stdlib.h>

typedef struct Sending {
    Consumer consumer;
    DisOf    of;
    double   announced; /* intervals of dis_announce_s at the last announcement; NaN: none so far */
} Sending;

/* With the first frame of each interval of exercise time. */
static bool announcement_is_due(Sending *s, double time_s)
{
    const double interval = floor(time_s / dis_announce_s);
    if (interval == s->announced) return false;
    s->announced = interval;
    return true;
}

static void announce(const Sending *s, const DisRecordSender *sender, const FrameRecord *record)
{
    uint8_t pdu[dis_smallest_mtu];
    int     stream = 0;
    for (int b = 0; b < BAND_COUNT; b++)
        if (s->of.bands >> b & 1) {
            const size_t octets = dis_record_stream(pdu, sender, record, (Band)b, s->of.config, stream++);
            if (octets > 0) s->of.send(s->of.user, pdu, octets);
        }
}

static Status put(Consumer *consumer, Frame *frame)
{
    Sending              *s      = (Sending *)consumer;
    const Config         *config = s->of.config;
    const FrameRecord    *record = &frame->record;
    const bool            truth  = strcmp(config->publish.dis, "truth") == 0;
    const DisRecordSender sender = {.version = s->of.version, .exercise = s->of.exercise,
                                    .site = (uint16_t)config->node.site,
                                    .application = (uint16_t)config->node.application,
                                    .timestamp = dis_timestamp(s->of.arrival_s(s->of.clock, record->time_s), false)};
    uint8_t               pdu[dis_smallest_mtu];
    if (*config->publish.stream && announcement_is_due(s, record->time_s)) announce(s, &sender, record);
    for (int b = 0; b < BAND_COUNT; b++)
        if (s->of.bands >> b & 1)
            s->of.send(s->of.user, pdu, dis_record_frame(pdu, &sender, record, (Band)b, truth));
    for (int n = 0; record->radar && n < dis_record_radar_count(record); n++)
        s->of.send(s->of.user, pdu, dis_record_radar(pdu, &sender, record, n));
    return STATUS_OK;
}

static Status close_sending(Consumer *consumer)
{
    free(consumer);
    return STATUS_OK;
}

Status consume_dis(Consumer **out, const DisOf *of)
{
    Sending *s = malloc(sizeof *s);
    if (!s) return STATUS_NO_MEMORY;
    *s   = (Sending){.consumer = {WANT_TARGETS, put, NULL, close_sending, "dis"}, .of = *of, .announced = NAN};
    *out = &s->consumer;
    return STATUS_OK;
}
