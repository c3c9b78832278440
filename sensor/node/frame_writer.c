#include "sensor/node/frame_writer.h"

#include "sensor/node/patience.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>

enum { slots = 3, host_size = 32 };

typedef enum SlotState { SLOT_FREE, SLOT_WAITS, SLOT_WRITTEN } SlotState;

typedef struct Slot {
    SlotState     state;
    Arena        *arena;
    FrameFiles    files;
    Picture       picture;
    Snapshot      snapshot;
    RenderRequest request;
    char          host[host_size];
} Slot;

struct FrameWriter {
    const Config       *config;
    Chain              *chain[BAND_COUNT];
    FrameLevel          level[BAND_COUNT];
    Pool               *pool;  /* one thread: the writer's */
    Slot                slot[slots];
    int                 made;  /* slot of the frame that is being made */
    bool                stop, running;
    Patience            patience;
    FrameWriterCounters counters;
    pthread_mutex_t     lock;
    pthread_cond_t      work;
    pthread_t           thread;
};

static int slot_in(const FrameWriter *w, SlotState state)
{
    for (int i = 0; i < slots; i++)
        if (w->slot[i].state == state && (state != SLOT_FREE || i != w->made)) return i;
    return -1;
}

/* The detectors are this thread's: they are exposed anew, to the same. */
static Status write_slot(FrameWriter *w, Slot *slot)
{
    char       hash[sha256_text_size];
    TruthNoise noise;
    const bool due    = patience_due(&w->patience);
    Status     status = STATUS_IO;
    if (due) {
        frame_expose(&noise, w->chain, &slot->picture, w->config);
        status = frame_files_write(hash, &slot->files, w->pool);
    }
    patience_over(&w->patience, due, status);
    return status;
}

static void *write_loop(void *user)
{
    FrameWriter *w = user;
    thread_flush_denormals();
    pthread_mutex_lock(&w->lock);
    for (;;) {
        const int i = slot_in(w, SLOT_WAITS);
        if (i < 0 && w->stop) break;
        if (i < 0) {
            pthread_cond_wait(&w->work, &w->lock);
            continue;
        }
        w->slot[i].state = SLOT_WRITTEN;
        pthread_mutex_unlock(&w->lock);
        const Status status = write_slot(w, &w->slot[i]);
        pthread_mutex_lock(&w->lock);
        w->slot[i].state = SLOT_FREE;
        if (status == STATUS_OK) w->counters.written++;
        else w->counters.failed++;
    }
    pthread_mutex_unlock(&w->lock);
    return NULL;
}

Status frame_writer_create(FrameWriter **out, Chain *chain[BAND_COUNT], const Config *config)
{
    FrameWriter *w      = calloc(1, sizeof *w);
    Status       status = w ? STATUS_OK : STATUS_NO_MEMORY;
    for (int b = 0; b < BAND_COUNT; b++) {
        if (w) w->chain[b] = chain[b];
        else chain_destroy(chain[b]);
    }
    if (!w) return status;
    w->config   = config;
    w->patience = (Patience){.what = "picture files"};
    pthread_mutex_init(&w->lock, NULL);
    pthread_cond_init(&w->work, NULL);
    for (int i = 0; i < slots; i++)
        if (!(w->slot[i].arena = arena_create())) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = pool_create(&w->pool, 1);
    if (status == STATUS_OK) {
        sigset_t all, before; /* signals are for the program's own thread */
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before);
        w->running = pthread_create(&w->thread, NULL, write_loop, w) == 0;
        pthread_sigmask(SIG_SETMASK, &before, NULL);
        if (!w->running) status = STATUS_NO_MEMORY;
    }
    if (status == STATUS_OK) *out = w;
    else frame_writer_destroy(w);
    return status;
}

FrameWriterCounters frame_writer_destroy(FrameWriter *w)
{
    if (!w) return (FrameWriterCounters){0};
    if (w->running) {
        pthread_mutex_lock(&w->lock);
        w->stop = true;
        pthread_cond_signal(&w->work);
        pthread_mutex_unlock(&w->lock);
        pthread_join(w->thread, NULL);
    }
    const FrameWriterCounters counters = w->counters;
    pthread_cond_destroy(&w->work);
    pthread_mutex_destroy(&w->lock);
    pool_destroy(w->pool);
    for (int b = 0; b < BAND_COUNT; b++) chain_destroy(w->chain[b]);
    for (int i = 0; i < slots; i++) arena_destroy(w->slot[i].arena);
    free(w);
    return counters;
}

Arena *frame_writer_arena(FrameWriter *w)
{
    arena_reset(w->slot[w->made].arena);
    return w->slot[w->made].arena;
}

void frame_writer_put(FrameWriter *w, const FrameFiles *files)
{
    Slot *slot     = &w->slot[w->made];
    slot->files    = *files;
    slot->picture  = *files->picture;
    slot->snapshot = *files->snapshot;
    slot->request  = *files->request;
    snprintf(slot->host, sizeof slot->host, "%s", files->host);
    slot->files.picture  = &slot->picture;
    slot->files.snapshot = &slot->snapshot;
    slot->files.request  = &slot->request;
    slot->files.host     = slot->host;
    slot->files.chain    = w->chain;
    slot->files.level    = w->level;

    pthread_mutex_lock(&w->lock);
    const int older = slot_in(w, SLOT_WAITS);
    if (older >= 0) {
        w->slot[older].state = SLOT_FREE;
        w->counters.left_out++;
    }
    slot->state = SLOT_WAITS;
    w->made     = slot_in(w, SLOT_FREE); /* of three: one waits, one at most is being written */
    pthread_cond_signal(&w->work);
    pthread_mutex_unlock(&w->lock);
}
