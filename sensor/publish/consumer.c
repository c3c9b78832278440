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

Status consumers_put(const Consumers *list, Frame *frame)
{
    Status status = STATUS_OK;
    if (frame->publish_begun_s == 0) frame->publish_begun_s = wall_clock_s();
    for (int i = 0; i < list->count && status == STATUS_OK; i++)
        status = list->consumer[i]->put(list->consumer[i], frame);
    return status;
}

Status consumers_close(Consumers *list)
{
    Status status = STATUS_OK;
    for (int i = 0; i < list->count; i++) {
        const Status one = list->consumer[i]->close(list->consumer[i]);
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
