/* sensor/publish/consume_pictures.c: the consumer that writes image files. */
#include "sensor/publish/consumers.h"

#include <stdlib.h>

typedef struct Pictures {
    Consumer     consumer;
    PictureFiles of;
    RetryBackoff retry;
} Pictures;

static Status put(Consumer *consumer, Frame *frame)
{
    Pictures        *p     = (Pictures *)consumer;
    const Config    *config = p->of.config;
    const FrameFiles files = {.out = p->of.out, .config = config, .world = frame->world,
                              .picture = &frame->seen.picture, .snapshot = &frame->seen.snapshot,
                              .request = &frame->request, .host = frame->host,
                              .config_sha256 = frame->provenance.config_sha256, .frame = frame->number,
                              .time_s = frame->time_s, .unix_s = frame->unix_s, .png = config->publish.png,
                              .raw = config->detector.raw, .display = frame->display};
    const bool       due    = !p->of.patient || retry_due(&p->retry);
    Status           status = STATUS_IO;
    if (due) status = frame_files_write(*frame->seen.sha256 ? NULL : frame->seen.sha256, &files, p->of.pool);
    if (p->of.patient) retry_done(&p->retry, due, status);
    return status;
}

static Status close_pictures(Consumer *consumer)
{
    free(consumer);
    return STATUS_OK;
}

Status consume_pictures(Consumer **out, const PictureFiles *made_of)
{
    Pictures *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    const Config *config = made_of->config;
    *p = (Pictures){.consumer = {0, put, NULL, close_pictures, "image_files"}, .of = *made_of,
                    .retry = {.what = "picture files"}};
    if (frame_files_truth(config)) p->consumer.wants |= WANT_PLANES;
    if (config->publish.png) p->consumer.wants |= WANT_DISPLAY;
    if (config->detector.raw) p->consumer.wants |= WANT_COUNTS;
    *out = &p->consumer;
    return STATUS_OK;
}
