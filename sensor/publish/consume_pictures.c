/* sensor/publish/consume_pictures.c: the consumer that writes image files. */
#include "sensor/publish/consumers.h"

#include <pthread.h>
#include <stdlib.h>

/* Levels of dropped frames, until the next frame is put: the last levels_kept, beyond which an automatic level with
 * a time constant of seconds (detector.agc_s) no longer depends on them. */
enum { levels_kept = 1024 };

typedef struct Pictures {
    Consumer        consumer;
    PictureFiles    of;
    Chains          spare;
    bool            patient;
    RetryBackoff        patience;
    pthread_mutex_t lock; /* protects the following: frames are dropped in another thread than they are put */
    DisplayLevels  *missed;
    int             first, count;
} Pictures;

void chains_destroy(Chains *chains)
{
    for (int b = 0; b < BAND_COUNT; b++) chain_destroy(chains->band[b]);
    *chains = (Chains){{NULL}};
}

static FrameFiles files_of(const Pictures *p, const Frame *frame, const Chains *chains)
{
    return (FrameFiles){.out = p->of.out,
                        .config = p->of.config,
                        .world = frame->world,
                        .picture = &frame->seen.picture,
                        .snapshot = &frame->seen.snapshot,
                        .request = &frame->request,
                        .host = frame->host,
                        .config_sha256 = frame->provenance.config_sha256,
                        .frame = frame->number,
                        .time_s = frame->time_s,
                        .unix_s = frame->unix_s,
                        .png = p->of.config->publish.png,
                        .chain = chains->band,
                        .level = p->of.level,
                        .rate_px_s = {frame->rate_px_s[0], frame->rate_px_s[1]}};
}

/* Whether displays are computed at all. */
static bool shows(const Pictures *p) { return p->of.config->publish.png || p->of.config->detector.raw; }

static void note_levels(Pictures *p, const Frame *frame, const Chains *chains)
{
    const FrameFiles files = files_of(p, frame, chains);
    TruthNoise       ignored;
    DisplayLevels    now;
    if (!shows(p)) return;
    frame_expose(&ignored, chains->band, files.picture, files.config);
    if (display_levels(&now, &files) != STATUS_OK || now.bands == 0) return;
    pthread_mutex_lock(&p->lock);
    p->missed[(p->first + p->count) % levels_kept] = now;
    if (p->count < levels_kept) p->count++;
    else p->first = (p->first + 1) % levels_kept;
    pthread_mutex_unlock(&p->lock);
}

static void follow_missed(Pictures *p)
{
    pthread_mutex_lock(&p->lock);
    for (; p->count > 0; p->count--) {
        display_follow(p->of.level, &p->missed[p->first], p->of.config->detector.agc_s);
        p->first = (p->first + 1) % levels_kept;
    }
    pthread_mutex_unlock(&p->lock);
}

static void left_out(Consumer *consumer, const Frame *frame)
{
    Pictures *p = (Pictures *)consumer;
    note_levels(p, frame, &p->spare);
}

static Status put(Consumer *consumer, Frame *frame)
{
    Pictures        *p     = (Pictures *)consumer;
    const FrameFiles files = files_of(p, frame, &p->of.chains);
    TruthNoise       ignored;
    Status           status = STATUS_IO;
    const bool       due    = !p->patient || retry_due(&p->patience);
    if (p->patient) follow_missed(p);
    if (due) {
        frame_expose(&ignored, files.chain, files.picture, files.config);
        status = frame_files_write(*frame->seen.sha256 ? NULL : frame->seen.sha256, &files, p->of.pool);
    } else {
        note_levels(p, frame, &p->of.chains);
    }
    if (p->patient) retry_done(&p->patience, due, status);
    return status;
}

static Status close_pictures(Consumer *consumer)
{
    Pictures *p = (Pictures *)consumer;
    chains_destroy(&p->of.chains);
    chains_destroy(&p->spare);
    pthread_mutex_destroy(&p->lock);
    free(p->missed);
    free(p);
    return STATUS_OK;
}

Status consume_pictures(Consumer **out, const PictureFiles *made_of)
{
    Pictures *p = calloc(1, sizeof *p);
    if (!p) {
        Chains chains = made_of->chains;
        chains_destroy(&chains);
        if (made_of->spare) chains_destroy(made_of->spare);
        return STATUS_NO_MEMORY;
    }
    p->consumer = (Consumer){0, put, left_out, close_pictures, "pictures"};
    p->of       = *made_of;
    p->patience = (RetryBackoff){.what = "picture files"};
    p->patient  = made_of->spare != NULL;
    if (p->patient) {
        p->spare  = *made_of->spare;
        p->missed = calloc(levels_kept, sizeof *p->missed);
    }
    if (frame_files_truth(p->of.config)) p->consumer.wants |= WANT_PLANES;
    if (shows(p)) p->consumer.wants |= WANT_CELLS;
    pthread_mutex_init(&p->lock, NULL);
    if (!p->patient || p->missed) {
        *out = &p->consumer;
        return STATUS_OK;
    }
    close_pictures(&p->consumer);
    return STATUS_NO_MEMORY;
}
