/* sensor/publish/consume_coco.c: the consumer that writes coco.json. */
#include "sensor/publish/consumers.h"

#include <stdlib.h>

typedef struct CocoConsumer {
    Consumer consumer;
    Coco    *coco;
} CocoConsumer;

static Status put(Consumer *consumer, Frame *frame)
{
    return coco_frame(((CocoConsumer *)consumer)->coco, &frame->record, frame->seen.picture.entity);
}

static Status close_coco(Consumer *consumer)
{
    CocoConsumer *c      = (CocoConsumer *)consumer;
    const Status  status = coco_close(c->coco);
    free(c);
    return status;
}

static Status begin(Consumer *consumer) { return coco_begin(((CocoConsumer *)consumer)->coco); }

Status consume_coco(Consumer **out, const char *folder, const Config *config, const char *config_sha256)
{
    CocoConsumer *c = calloc(1, sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    c->consumer         = (Consumer){WANT_TARGETS | WANT_PLANES, put, NULL, close_coco, "coco", begin};
    const Status status = coco_open(&c->coco, folder, config->publish.png ? "png" : "exr",
                                    (CocoLimits){config->publish.coco_min_pixels, config->publish.coco_min_visible,
                                                 config->publish.coco_min_snr},
                                    config_sha256, config->seed);
    if (status == STATUS_OK) *out = &c->consumer;
    else free(c);
    return status;
}
