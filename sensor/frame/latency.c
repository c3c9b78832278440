/* sensor/frame/latency.c: the latest frames' ledgers, and fine histograms of all, under one lock. */
#include "sensor/frame/latency_private.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

/* Fine bins: 100 a decade, 1 us .. 1000 s, and one on each side. 20 of them are one of the published histogram. */
enum {
    fine_decade = 100,
    fine_decades = 9,
    fine_first = -3,
    fine_count = fine_decade * fine_decades + 2,
    edge_decade = 5,
    edge_first = -2,
    edge_fine = fine_decade / edge_decade
};
_Static_assert((int)fine_count == (int)latency_bins, "bins of a histogram");

typedef struct Entry {
    uint64_t key; /* 0: none */
    double   stage_ms[LATENCY_STAGE_COUNT];
    double   done_ms[latency_consumers_max]; /* when the last consumer of that name was done so far */
    int      waits[latency_consumers_max];   /* consumers of that name that are not done yet */
    int      outstanding;                    /* their sum */
} Entry;

struct Latency {
    pthread_mutex_t  lock;
    uint64_t         keys;
    int              consumers;
    char             name[latency_consumers_max][latency_name_size];
    int              expected[latency_consumers_max];
    Entry            entry[latency_frames];
    LatencyHistogram stage[LATENCY_STAGE_COUNT], consumer[latency_consumers_max];
};

const char *const latency_stage_name[LATENCY_STAGE_COUNT] = {"arrival_to_pose", "pose_to_render", "render", "display"};

Status latency_create(Latency **out)
{
    Latency *l = calloc(1, sizeof *l);
    if (!l) return STATUS_NO_MEMORY;
    pthread_mutex_init(&l->lock, NULL);
    *out = l;
    return STATUS_OK;
}

void latency_destroy(Latency *l)
{
    if (!l) return;
    pthread_mutex_destroy(&l->lock);
    free(l);
}

/* -1: not in the ledger. */
static int index_of(const Latency *l, const char *name)
{
    for (int i = 0; name && i < l->consumers; i++)
        if (strcmp(l->name[i], name) == 0) return i;
    return -1;
}

void latency_expect(Latency *l, const char *name)
{
    int i = index_of(l, name);
    if (!name || strlen(name) >= latency_name_size || (i < 0 && l->consumers == latency_consumers_max)) return;
    if (i < 0) memcpy(l->name[i = l->consumers++], name, strlen(name) + 1);
    l->expected[i]++;
}

/* ---- statistics -------------------------------------------------------------------------------------- */

void latency_count(LatencyHistogram *h, double ms)
{
    if (isnan(ms)) return;
    const double at = ms > 0 ? floor((log10(ms) - fine_first) * fine_decade) + 1 : 0;
    h->bin[(int)clamp(at, 0, fine_count - 1)]++;
    h->count++;
    h->max_ms = fmax(h->max_ms, ms);
}

/* Returns the upper limit of the bin with the nearest rank. */
static double percentile(const LatencyHistogram *h, double share)
{
    const uint64_t rank = (uint64_t)fmax(1, ceil(share * (double)h->count - 1e-9));
    uint64_t       sum = 0;
    for (int i = 0; i < fine_count - 1; i++) {
        sum += h->bin[i];
        if (sum >= rank) return fmin(pow(10, fine_first + (double)i / fine_decade), h->max_ms);
    }
    return h->max_ms;
}

void latency_figures(LatencyFigures *out, const LatencyHistogram *h)
{
    *out = (LatencyFigures){
        .count = h->count, .left_out = h->left_out, .median_ms = NAN, .p95_ms = NAN, .p99_ms = NAN, .max_ms = NAN};
    for (int i = 0; i < fine_count; i++) { /* fine bin i > 0 begins at fine_first + (i - 1) / fine_decade */
        const int below = i - 1 - (edge_first - fine_first) * fine_decade;
        const int k = i == 0 || below < 0 ? 0 : below / edge_fine + 1;
        out->histogram[k < latency_edges ? k : latency_edges] += h->bin[i];
    }
    if (h->count == 0) return;
    out->median_ms = percentile(h, 0.5);
    out->p95_ms = percentile(h, 0.95);
    out->p99_ms = percentile(h, 0.99);
    out->max_ms = h->max_ms;
}

void latency_summary(LatencySummary *out, Latency *l)
{
    memset(out, 0, sizeof *out);
    for (int i = 0; i < latency_edges; i++) out->edge_ms[i] = pow(10, edge_first + (double)i / edge_decade);
    pthread_mutex_lock(&l->lock);
    for (int i = 0; i < LATENCY_STAGE_COUNT; i++) latency_figures(&out->stage[i], &l->stage[i]);
    out->consumers = l->consumers;
    memcpy(out->name, l->name, sizeof out->name);
    for (int i = 0; i < l->consumers; i++) latency_figures(&out->consumer[i], &l->consumer[i]);
    pthread_mutex_unlock(&l->lock);
}

uint64_t latency_lost(char out[latency_lost_size], Latency *l)
{
    uint64_t sum = 0;
    size_t   n = 0;
    *out = 0;
    pthread_mutex_lock(&l->lock);
    for (int i = 0; i < l->consumers; i++) {
        const uint64_t lost = l->consumer[i].left_out;
        sum += lost;
        if (lost && n < latency_lost_size)
            n += (size_t)snprintf(out + n, latency_lost_size - n, "%s%s %llu", n ? ", " : "", l->name[i],
                                  (unsigned long long)lost);
    }
    pthread_mutex_unlock(&l->lock);
    return sum;
}

/* ---- a frame ----------------------------------------------------------------------------------------- */

static double span_ms(double from_s, double to_s)
{
    return from_s > 0 && to_s > 0 ? 1e3 * fmax(0, to_s - from_s) : NAN;
}

uint64_t latency_begin(Latency *l, const LatencyTimes *t)
{
    pthread_mutex_lock(&l->lock);
    const uint64_t key = ++l->keys;
    Entry         *e = &l->entry[key % latency_frames];
    *e = (Entry){.key = key,
                 .stage_ms = {span_ms(t->arrived_s, t->posed_s), span_ms(t->posed_s, t->render_s),
                              span_ms(t->render_s, t->rendered_s), NAN}};
    for (int i = 0; i < LATENCY_STAGE_COUNT; i++)
        if (i != LATENCY_ARRIVAL_TO_POSE || t->fresh) latency_count(&l->stage[i], e->stage_ms[i]);
    for (int i = 0; i < l->consumers; i++) {
        e->done_ms[i] = NAN;
        e->waits[i] = l->expected[i];
        e->outstanding += l->expected[i];
    }
    pthread_mutex_unlock(&l->lock);
    return key;
}

static Entry *find(Latency *l, uint64_t key)
{
    Entry *e = &l->entry[key % latency_frames];
    return key > 0 && e->key == key ? e : NULL;
}

/* One of consumer i less is outstanding. True: it was the last of that name, or the frame is no longer kept. */
static bool settle(Entry *e, int i)
{
    if (!e) return true;
    if (e->waits[i] == 0) return false;
    e->outstanding--;
    return --e->waits[i] == 0;
}

void latency_displayed(Latency *l, uint64_t key, double rendered_s)
{
    const double ms = 1e3 * fmax(0, wall_clock_s() - rendered_s);
    pthread_mutex_lock(&l->lock);
    Entry *e = find(l, key);
    if (e) e->stage_ms[LATENCY_DISPLAY] = ms;
    latency_count(&l->stage[LATENCY_DISPLAY], ms);
    pthread_mutex_unlock(&l->lock);
}

void latency_done(Latency *l, uint64_t key, double rendered_s, const char *name)
{
    latency_done_at(l, key, rendered_s, name, wall_clock_s());
}

void latency_done_at(Latency *l, uint64_t key, double rendered_s, const char *name, double done_s)
{
    const int    i = index_of(l, name); /* names do not change any more */
    const double ms = 1e3 * fmax(0, done_s - rendered_s);
    if (i < 0) return;
    pthread_mutex_lock(&l->lock);
    Entry *e = find(l, key);
    if (settle(e, i)) {
        if (e) e->done_ms[i] = ms;
        latency_count(&l->consumer[i], ms);
    }
    pthread_mutex_unlock(&l->lock);
}

void latency_left_out(Latency *l, uint64_t key, const char *name)
{
    const int i = index_of(l, name);
    if (i < 0) return;
    pthread_mutex_lock(&l->lock);
    Entry *e = find(l, key);
    l->consumer[i].left_out++;
    settle(e, i);
    pthread_mutex_unlock(&l->lock);
}

bool latency_complete(Latency *l, uint64_t key)
{
    pthread_mutex_lock(&l->lock);
    const Entry *e = find(l, key);
    const bool   complete = !e || e->outstanding == 0;
    pthread_mutex_unlock(&l->lock);
    return complete;
}

void latency_line(LatencyLine *out, Latency *l, uint64_t key)
{
    for (int i = 0; i < LATENCY_STAGE_COUNT; i++) out->stage_ms[i] = NAN;
    out->consumers = 0;
    pthread_mutex_lock(&l->lock);
    const Entry *e = find(l, key);
    if (e) {
        memcpy(out->stage_ms, e->stage_ms, sizeof out->stage_ms);
        out->consumers = l->consumers;
        memcpy(out->name, l->name, sizeof out->name);
        memcpy(out->done_ms, e->done_ms, sizeof out->done_ms);
    }
    pthread_mutex_unlock(&l->lock);
}
