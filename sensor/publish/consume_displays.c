/* sensor/publish/consume_displays.c: the consumer that makes a frame's displays, for those after it. */
#include "sensor/publish/consumers.h"

#include <stdlib.h>

typedef struct DisplayMaker {
    Consumer      consumer;
    const Config *config;
    Pool         *pool;
    bool          counts;
    Chains        chains;
    FrameLevel    level[BAND_COUNT];
} DisplayMaker;

void chains_destroy(Chains *chains)
{
    for (int b = 0; b < BAND_COUNT; b++) chain_destroy(chains->band[b]);
    *chains = (Chains){{NULL}};
}

static Status put(Consumer *consumer, Frame *frame)
{
    DisplayMaker    *m  = (DisplayMaker *)consumer;
    const DisplaysOf of = {.config = m->config, .picture = &frame->seen.picture, .chain = m->chains.band,
                           .level = m->level, .frame = frame->number, .time_s = frame->time_s,
                           .rate_px_s = {frame->rate_px_s[0], frame->rate_px_s[1]}, .counts = m->counts};
    const Status status = displays_make(frame->display, &of, frame->request.bands, m->pool, frame->arena);
    if (frame->latency) latency_displayed(frame->latency, frame->latency_key, frame->times.rendered_s);
    return status;
}

static Status close_displays(Consumer *consumer)
{
    DisplayMaker *m = (DisplayMaker *)consumer;
    chains_destroy(&m->chains);
    free(m);
    return STATUS_OK;
}

Status consume_displays(Consumer **out, const Config *config, Pool *pool, Chains *chains, bool counts)
{
    DisplayMaker *m = calloc(1, sizeof *m);
    if (!m) {
        chains_destroy(chains);
        return STATUS_NO_MEMORY;
    }
    *m = (DisplayMaker){.consumer = {WANT_CELLS, put, NULL, close_displays, NULL}, .config = config,
                        .pool = pool, .counts = counts, .chains = *chains};
    *chains = (Chains){{NULL}};
    *out    = &m->consumer;
    return STATUS_OK;
}
