/* sensor/publish/consume_by_call.c: consumers that call a function: with each record; with each frame and its hash. */
#include "sensor/publish/consumers.h"

#include <stdlib.h>

typedef struct Call {
    Consumer   consumer;
    FrameCall *call;
    FrameDone *done;
    void      *user;
    bool       hashes;
} Call;

static Status put_record(Consumer *consumer, Frame *frame)
{
    const Call *c = (const Call *)consumer;
    c->call(c->user, &frame->record);
    return STATUS_OK;
}

static Status put_hash(Consumer *consumer, Frame *frame)
{
    const Call  *c      = (const Call *)consumer;
    const Status status = c->hashes ? frame_sha256(&frame->seen) : STATUS_OK;
    if (status == STATUS_OK) c->done(c->user, frame);
    return status;
}

static Status close_call(Consumer *consumer)
{
    free(consumer);
    return STATUS_OK;
}

static Status open_call(Consumer **out, const Call *made_of)
{
    Call *c = malloc(sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    *c   = *made_of;
    *out = &c->consumer;
    return STATUS_OK;
}

Status consume_by_call(Consumer **out, FrameCall *call, void *user, bool targets)
{
    const Call made = {.consumer = {targets ? WANT_TARGETS : 0, put_record, NULL, close_call, NULL},
                       .call = call, .user = user};
    return open_call(out, &made);
}

Status consume_hashes(Consumer **out, FrameDone *done, void *user, bool hashes)
{
    return open_call(out, &(Call){.consumer = {hashes ? WANT_SHA256 : 0, put_hash, NULL, close_call, NULL},
                                  .done = done, .user = user, .hashes = hashes});
}
