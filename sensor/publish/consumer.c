/* sensor/publish/consumer.c: a list of consumers used as one. */
#include "sensor/publish/consumer.h"

Status consumers_add(Consumers *list, Consumer *consumer)
{
    if (!consumer) return STATUS_OK;
    if (list->count == consumers_max) {
        consumer->close(consumer);
        return STATUS_BAD_VALUE;
    }
    list->consumer[list->count++] = consumer;
    return STATUS_OK;
}

unsigned consumers_wants(const Consumers *list)
{
    unsigned wants = 0;
    for (int i = 0; i < list->count; i++) wants |= list->consumer[i]->wants;
    return wants;
}

Status consumers_begin(const Consumers *list)
{
    Status status = STATUS_OK;
    for (int i = 0; i < list->count && status == STATUS_OK; i++)
        if (list->consumer[i]->begin) status = list->consumer[i]->begin(list->consumer[i]);
    return status;
}

Status consumers_put(const Consumers *list, Frame *frame)
{
    Status status = STATUS_OK;
    if (frame->publish_begun_s == 0) frame->publish_begun_s = wall_clock_s();
    for (int i = 0; i < list->count && status == STATUS_OK; i++) {
        Consumer *c = list->consumer[i];
        status      = c->put(c, frame);
        if (frame->latency && status == STATUS_OK)
            latency_done(frame->latency, frame->latency_key, frame->times.rendered_s, c->name);
    }
    return status;
}

void consumers_left_out(const Consumers *list, const Frame *frame)
{
    for (int i = 0; i < list->count; i++) {
        Consumer *c = list->consumer[i];
        if (c->left_out) c->left_out(c, frame);
        if (frame->latency) latency_left_out(frame->latency, frame->latency_key, c->name);
    }
}

void consumers_expect(const Consumers *list, Latency *latency)
{
    for (int i = 0; latency && i < list->count; i++) latency_expect(latency, list->consumer[i]->name);
}

Status consumers_close(Consumers *list)
{
    Status status = STATUS_OK;
    for (int i = 0; i < 2 * list->count; i++) {
        Consumer *c = list->consumer[i % list->count];
        if (!c || ((c->wants & WANT_LATENCY) != 0) != (i >= list->count)) continue;
        list->consumer[i % list->count] = NULL;
        const Status one = c->close(c);
        if (status == STATUS_OK) status = one;
    }
    list->count = 0;
    return status;
}

void consumers_request(RenderRequest *request, unsigned wants)
{
    request->truth            = wants & (WANT_PLANES | WANT_TARGETS | WANT_ERROR | WANT_SHA256);
    request->hand_over_cells &= (wants & WANT_CELLS) != 0;
    request->budget          &= (wants & WANT_ERROR) != 0;
}
