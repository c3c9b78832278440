/* The latency ledger: what is done when, from several threads; lines of truth.jsonl wait for it, at most two frames;
 * percentiles against sorted values; histograms against their edges. labels: threads */
#include "tests/check.h"

#include "sensor/publish/consumers/consumers.h"
#include "sensor/publish/consumers/consumer.h"

#include <pthread.h>
#include <unistd.h>

/* ---- statistics -------------------------------------------------------------------------------------- */

static int by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

/* Values over six decades and beyond the edges: each percentile is not below the nearest rank, and at most 2.4 % above.
 */
static void percentiles_and_histogram(void **state)
{
    (void)state;
    enum { count = 997 };
    static double  ms[count];
    uint64_t       random = 1, below[latency_edges + 1] = {0};
    Latency       *latency = NULL;
    LatencySummary s;
    assert_int_equal(latency_create(&latency), STATUS_OK);
    for (int i = 0; i < count; i++) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        ms[i] = pow(10, -3 + 8 * (double)(random >> 11) / 9007199254740992.0);
        latency_begin(latency, &(LatencyTimes){.render_s = 1000, .rendered_s = 1000 + 1e-3 * ms[i]});
    }
    latency_summary(&s, latency);
    const LatencyFigures *f = &s.stage[LATENCY_RENDER];
    for (int i = 0; i < count; i++) {
        int k = 0;
        while (k < latency_edges && ms[i] >= s.edge_ms[k]) k++;
        below[k]++;
    }
    qsort(ms, count, sizeof *ms, by_value);
    const double exact[3] = {ms[count / 2], ms[(int)ceil(0.95 * count) - 1], ms[(int)ceil(0.99 * count) - 1]};
    const double got[3] = {f->median_ms, f->p95_ms, f->p99_ms};
    for (int k = 0; k < 3; k++) CHECK(got[k] > exact[k] * (1 - 1e-6) && got[k] < exact[k] * 1.024);
    CHECK(f->count == count && fabs(f->max_ms / ms[count - 1] - 1) < 1e-6 && f->left_out == 0);
    for (int k = 0; k <= latency_edges; k++) CHECK(f->histogram[k] == below[k]);
    CHECK(fabs(s.edge_ms[0] - 0.01) < 1e-12 && fabs(s.edge_ms[5] - 0.1) < 1e-12 && s.edge_ms[latency_edges - 1] == 1e4);
    CHECK(s.stage[LATENCY_ARRIVAL_TO_POSE].count == 0 && isnan(s.stage[LATENCY_DISPLAY].median_ms));
    latency_destroy(latency);
}

static void stages_of_a_frame(void **state)
{
    (void)state;
    Latency       *latency = NULL;
    LatencyLine    line;
    LatencySummary s;
    LatencyTimes times = {.arrived_s = 10, .posed_s = 10.004, .render_s = 10.005, .rendered_s = 10.025, .fresh = true};
    assert_int_equal(latency_create(&latency), STATUS_OK);
    const uint64_t first = latency_begin(latency, &times);
    times.fresh = false; /* the same datagram again: in the frame's line, in no statistics */
    const uint64_t second = latency_begin(latency, &times);
    latency_displayed(latency, second, wall_clock_s());
    latency_line(&line, latency, first);
    CHECK(fabs(line.stage_ms[LATENCY_ARRIVAL_TO_POSE] - 4) < 1e-6 &&
          fabs(line.stage_ms[LATENCY_POSE_TO_RENDER] - 1) < 1e-6);
    CHECK(fabs(line.stage_ms[LATENCY_RENDER] - 20) < 1e-6 && isnan(line.stage_ms[LATENCY_DISPLAY]) &&
          line.consumers == 0);
    latency_line(&line, latency, second);
    CHECK(fabs(line.stage_ms[LATENCY_ARRIVAL_TO_POSE] - 4) < 1e-6 && line.stage_ms[LATENCY_DISPLAY] >= 0);
    latency_summary(&s, latency);
    CHECK(s.stage[LATENCY_ARRIVAL_TO_POSE].count == 1 && s.stage[LATENCY_RENDER].count == 2);
    for (int i = 0; i < latency_frames; i++) latency_begin(latency, &times); /* and it is kept no longer */
    latency_line(&line, latency, first);
    CHECK(isnan(line.stage_ms[LATENCY_RENDER]) && latency_complete(latency, first));
    latency_destroy(latency);
}

/* ---- consumers and queues ---------------------------------------------------------------------------- */

typedef struct Gate {
    Consumer        consumer;
    pthread_mutex_t lock;
    pthread_cond_t  changed;
    bool            open, entered;
    int             passed;
} Gate;

static Status gate_put(Consumer *consumer, Frame *frame)
{
    (void)frame;
    Gate *g = (Gate *)consumer;
    pthread_mutex_lock(&g->lock);
    g->entered = true;
    pthread_cond_broadcast(&g->changed);
    while (!g->open) pthread_cond_wait(&g->changed, &g->lock);
    g->passed++;
    pthread_mutex_unlock(&g->lock);
    return STATUS_OK;
}

static Status gate_close(Consumer *consumer)
{
    (void)consumer;
    return STATUS_OK;
}

static void gate_make(Gate *g, const char *name, bool open)
{
    *g = (Gate){.consumer = {0, gate_put, NULL, gate_close, name}, .open = open};
    pthread_mutex_init(&g->lock, NULL);
    pthread_cond_init(&g->changed, NULL);
}

static void gate_entered(Gate *g)
{
    pthread_mutex_lock(&g->lock);
    while (!g->entered) pthread_cond_wait(&g->changed, &g->lock);
    pthread_mutex_unlock(&g->lock);
}

static void gate_open(Gate *g)
{
    pthread_mutex_lock(&g->lock);
    g->open = true;
    pthread_cond_broadcast(&g->changed);
    pthread_mutex_unlock(&g->lock);
}

typedef struct Lines {
    char       folder[temp_path_size], path[temp_path_size + 32];
    Consumers  list;
    Gate       fast, slow;
    FramePool *pool;
    Latency   *latency;
    uint64_t   last_key;
} Lines;

static const Snapshot      nobody_there;
static const Sun           no_sun;
static const RenderRequest no_bands = {.view = {.width = 1, .height = 1, .focal_px = 1}};

static void put_frame(Lines *l, int number, bool ledger)
{
    Frame *f = frame_pool_take(l->pool);
    f->number = number;
    f->record = (FrameRecord){.frame = number,
                              .snapshot = &nobody_there,
                              .sun = &no_sun,
                              .request = &no_bands,
                              .p_eye_ecef = {6.4e6, 0, 0},
                              .r_ecef_from_body = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                              .hfov_rad = 0.1};
    f->times = (LatencyTimes){.posed_s = 1, .render_s = 1.5, .rendered_s = wall_clock_s()};
    f->latency = ledger ? l->latency : NULL;
    f->latency_key = l->last_key = ledger ? latency_begin(l->latency, &f->times) : 0;
    assert_int_equal(consumers_put(&l->list, f), STATUS_OK);
    frame_release(f);
}

static int lines_in(const Lines *l, int with_latency, const char *word)
{
    static char line[8192];
    FILE       *file = fopen(l->path, "r");
    int         n = 0;
    while (file && fgets(line, sizeof line, file))
        n += with_latency < 0 ||
             (strstr(line, "\"latency_ms\":{") != NULL && strstr(line, word) != NULL) == with_latency;
    if (file) fclose(file);
    return n;
}

static void lines_open(Lines *l)
{
    Consumer *lines = NULL, *queue = NULL;
    Consumers behind = {0};
    *l = (Lines){0};
    CHECK(temp_folder(l->folder));
    snprintf(l->path, sizeof l->path, "%s/truth.jsonl", l->folder);
    gate_make(&l->fast, "fast", true);
    gate_make(&l->slow, "slow", false);
    assert_int_equal(latency_create(&l->latency), STATUS_OK);
    assert_int_equal(frame_pool_create(&l->pool, 3), STATUS_OK);
    assert_int_equal(consume_truth_lines(&lines, l->folder, false, NULL), STATUS_OK);
    assert_int_equal(lines->begin(lines), STATUS_OK);
    consumers_add(&l->list, lines);
    consumers_add(&l->list, &l->fast.consumer);
    consumers_add(&behind, &l->slow.consumer);
    consumers_expect(&behind, l->latency);
    assert_int_equal(consumer_queue_open(&queue, &behind, &(QueueOf){.rule = QUEUE_LEAVE_OUT, .waiting = 1}),
                     STATUS_OK);
    consumers_add(&l->list, queue);
    consumers_expect(&l->list, l->latency);
}

static void lines_close(Lines *l)
{
    frame_pool_destroy(l->pool);
    latency_destroy(l->latency);
    remove(l->path);
    remove(l->folder);
}

/* A consumer behind a queue is stalled: lines wait two frames and no longer, then without it; what it is not given is
 * counted; what it gets in the end is in the line that still waits. */
static void a_line_waits_two_frames(void **state)
{
    (void)state;
    Lines          l;
    LatencySummary s;
    lines_open(&l);
    put_frame(&l, 0, true);
    gate_entered(&l.slow);
    CHECK(lines_in(&l, -1, "") == 0);
    put_frame(&l, 1, true);
    CHECK(lines_in(&l, -1, "") == 0);
    put_frame(&l, 2, true);
    CHECK(lines_in(&l, -1, "") == 1 && lines_in(&l, 1, "\"fast\":") == 1 && lines_in(&l, 1, "\"slow\":") == 0);
    for (int i = 3; i < 10; i++) put_frame(&l, i, true);
    CHECK(lines_in(&l, -1, "") == 8);
    gate_open(&l.slow);
    assert_int_equal(consumers_close(&l.list), STATUS_OK); /* frame 9 reaches it before the lines are closed */
    CHECK(lines_in(&l, -1, "") == 10 && lines_in(&l, 1, "\"slow\":") == 1 && lines_in(&l, 1, "\"truth_lines\":") == 10);
    latency_summary(&s, l.latency);
    CHECK(s.consumers == 3 && strcmp(s.name[0], "slow") == 0);
    CHECK(s.consumer[0].count == 2 && s.consumer[0].left_out == 8 && s.consumer[1].count == 10);
    lines_close(&l);
}

/* All are done: the line is written with the next frame. Without a ledger: at once, and without latency_ms. */
static void a_line_waits_no_longer_than_needed(void **state)
{
    (void)state;
    Lines l;
    lines_open(&l);
    gate_open(&l.slow);
    for (int i = 0; i < 3; i++) {
        put_frame(&l, i, true);
        for (int k = 0; k < 120000 && !latency_complete(l.latency, l.last_key); k++) usleep(1000);
        CHECK(latency_complete(l.latency, l.last_key) && lines_in(&l, -1, "") == i);
    }
    CHECK(lines_in(&l, 1, "\"slow\":") == 2);
    assert_int_equal(consumers_close(&l.list), STATUS_OK);
    CHECK(lines_in(&l, 1, "\"slow\":") == 3);
    lines_close(&l);

    lines_open(&l);
    gate_open(&l.slow);
    for (int i = 0; i < 3; i++) {
        put_frame(&l, i, false);
        CHECK(lines_in(&l, 0, "") == i + 1);
    }
    assert_int_equal(consumers_close(&l.list), STATUS_OK);
    lines_close(&l);
}

/* Two of one name: done when the last is. */
static void consumers_of_one_name(void **state)
{
    (void)state;
    Latency       *latency = NULL;
    LatencyLine    line;
    LatencySummary s;
    assert_int_equal(latency_create(&latency), STATUS_OK);
    latency_expect(latency, "video");
    latency_expect(latency, NULL);
    latency_expect(latency, "video");
    const double   now_s = wall_clock_s();
    const uint64_t key = latency_begin(latency, &(LatencyTimes){.render_s = now_s, .rendered_s = now_s});
    latency_done(latency, key, now_s, "video");
    latency_done(latency, key, now_s, "never heard of");
    latency_line(&line, latency, key);
    CHECK(line.consumers == 1 && isnan(line.done_ms[0]) && !latency_complete(latency, key));
    latency_done(latency, key, now_s, "video");
    latency_line(&line, latency, key);
    CHECK(line.done_ms[0] >= 0 && latency_complete(latency, key));
    latency_summary(&s, latency);
    CHECK(s.consumer[0].count == 1);
    latency_destroy(latency);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(percentiles_and_histogram), cmocka_unit_test(stages_of_a_frame),
        cmocka_unit_test(a_line_waits_two_frames),   cmocka_unit_test(a_line_waits_no_longer_than_needed),
        cmocka_unit_test(consumers_of_one_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
