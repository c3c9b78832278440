/* sensor/node/session_consumers.c: the consumers of a session's frames, from the configuration. */
#include "sensor/node/session_private.h"

#include "sensor/publish/pairs.h"

#include <stdlib.h>

/* The detectors of one consumer. */
static Status chains_of(Chains *out, const Sensors *sensors, const Config *config)
{
    *out = (Chains){{NULL}};
    const Status status = sensors_chains(out->band, sensors, config);
    if (status != STATUS_OK) chains_destroy(out);
    return status;
}

static Status add_pictures(Consumers *list, Session *s, Pool *pool)
{
    const SessionShared *shared = s->shared;
    PictureFiles         of     = {.out = s->out, .config = shared->config, .pool = pool, .level = s->level};
    Chains               spare;
    Consumer            *consumer = NULL;
    Status               status   = chains_of(&of.chains, shared->sensors, shared->config);
    if (status != STATUS_OK) return status;
    if (shared->live) {
        status   = chains_of(&spare, shared->sensors, shared->config);
        of.spare = &spare;
    }
    if (status == STATUS_OK) status = consume_pictures(&consumer, &of);
    else chains_destroy(&of.chains);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_pairs(Consumers *list, Session *s, Pool *pool, unsigned raw)
{
    const SessionShared *shared = s->shared;
    PairsOf              of = {.out = s->out, .config = shared->config, .config_sha256 = shared->config_sha256,
                               .pool = pool, .bands = shared->bands, .raw = raw, .level = s->level};
    Consumer            *consumer = NULL;
    Sensors             *quiet    = malloc(sizeof *quiet);
    if (!quiet) return STATUS_NO_MEMORY;
    *quiet = *shared->sensors;
    for (int b = 0; b < BAND_COUNT; b++) quiet->preset[b].noise_scale = 0;
    Status status = chains_of(&of.clean, quiet, shared->config);
    if (status == STATUS_OK) status = chains_of(&of.background, shared->sensors, shared->config);
    if (status == STATUS_OK) status = chains_of(&of.background_clean, quiet, shared->config);
    free(quiet);
    if (status == STATUS_OK) {
        status = consume_pairs(&consumer, &of);
    } else {
        chains_destroy(&of.clean);
        chains_destroy(&of.background);
        chains_destroy(&of.background_clean);
    }
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_truth_lines(Consumers *list, Session *s)
{
    Consumer    *consumer = NULL;
    const Status status   = consume_truth_lines(&consumer, s->out, s->shared->live, &s->lines_failed);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_hashes(Consumers *list, Session *s, FrameDone *done)
{
    Consumer    *consumer = NULL;
    const Status status   = consume_hashes(&consumer, done, s);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_coco(Consumers *list, Session *s)
{
    Consumer    *consumer = NULL;
    const Status status   = consume_coco(&consumer, s->out, s->shared->config, s->shared->config_sha256);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_call(Consumers *list, const SessionShared *shared)
{
    Consumer    *consumer = NULL;
    const Status status   = consume_by_call(&consumer, shared->publish, shared->user);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_queue(Session *s, Consumers *behind, QueueRule rule)
{
    Consumer    *consumer = NULL;
    consumers_expect(behind, s->latency);
    const Status status   = frame_queue_open(&consumer, behind, rule, rule == QUEUE_WAIT ? NULL : &s->written);
    return status == STATUS_OK ? consumers_add(&s->consumers, consumer) : status;
}

/* A replay with more than one thread publishes a frame while the next is rendered. */
static Status for_replay(Session *s, FrameDone *done, unsigned raw)
{
    const Config *config  = s->shared->config;
    const int     threads = pool_threads(s->shared->pool);
    const bool    behind  = threads > 1;
    Consumers     list    = {0};
    Status        status  = behind ? pool_create(&s->publish_pool, threads) : STATUS_OK;
    Pool         *pool    = behind ? s->publish_pool : s->shared->pool;
    if (status == STATUS_OK && config->publish.files) status = add_pictures(&list, s, pool);
    if (status == STATUS_OK) status = add_truth_lines(&list, s);
    if (status == STATUS_OK && config->publish.coco) status = add_coco(&list, s);
    if (status == STATUS_OK && strcmp(config->publish.pairs, "off") != 0) status = add_pairs(&list, s, pool, raw);
    if (status == STATUS_OK) status = add_hashes(&list, s, done);
    if (status == STATUS_OK && behind) return add_queue(s, &list, QUEUE_WAIT);
    for (int i = 0; i < list.count && status == STATUS_OK; i++) status = consumers_add(&s->consumers, list.consumer[i]);
    if (status != STATUS_OK) consumers_close(&list);
    return status;
}

/* A slow disk never delays a live node: image files are written by a thread of their own, and dropped when it is
 * late. */
static Status for_live(Session *s, FrameDone *done)
{
    Consumers pictures = {0};
    Status    status   = add_truth_lines(&s->consumers, s);
    if (status == STATUS_OK) status = add_hashes(&s->consumers, s, done);
    if (status != STATUS_OK || !s->shared->config->publish.files) return status;
    status = pool_create(&s->publish_pool, 1);
    if (status == STATUS_OK) status = add_pictures(&pictures, s, s->publish_pool);
    return status == STATUS_OK ? add_queue(s, &pictures, QUEUE_LEAVE_OUT) : status;
}

Status session_consumers(Session *s, FrameDone *done)
{
    const SessionShared *shared = s->shared;
    const Config        *config = shared->config;
    unsigned             raw    = 0;
    for (int b = 0; b < BAND_COUNT; b++)
        if (s->chain[b] && config->detector.raw && config->publish.files) raw |= 1u << b;
    const unsigned kept   = shared->bands | (frame_files_truth(config) ? frame_truth : 0);
    Status         status = frame_files_prepare(s->out, config->publish.files ? kept : 0, raw);
    if (status == STATUS_OK && shared->wall_s) status = latency_create(&s->latency);
    if (status == STATUS_OK && shared->publish) status = add_call(&s->consumers, shared); /* before the disk */
    if (status == STATUS_OK) status = shared->live ? for_live(s, done) : for_replay(s, done, raw);
    consumers_expect(&s->consumers, s->latency);
    s->wants = consumers_wants(&s->consumers) | (shared->save_count > 0 ? WANT_PLANES : 0); /* a frame file: of all */
    return status == STATUS_OK ? frame_pool_create(&s->frames, s->publish_pool ? queue_frames : 1) : status;
}
