/* Frames and consumers: what is rendered is what is wanted; a queue hands on in order, stops at the first failure, and
 * leaves out what is late; a display's memory takes part of what is left out; arrays of any axes have names, shapes and
 * hashes. labels: threads */
#include "tests/check.h"
#include "tests/render/hand_world.h"

#include "sensor/publish/consumers/consumers.h"
#include "sensor/publish/consumers/consumer.h"

#include <pthread.h>
#include <sys/stat.h>

/* ---- a consumer that notes what it gets ------------------------------------------------------------- */

enum { notes_max = 64 };

typedef struct Noting {
    Consumer        consumer;
    int             put_count, left_out_count, closed, fail_at;
    int             number[notes_max], left_out[notes_max];
    pthread_mutex_t lock; /* of open, and of put_count */
    pthread_cond_t  opened;
    bool            open;    /* else put waits */
    bool            entered; /* put is there */
} Noting;

static Status noting_put(Consumer *consumer, Frame *frame)
{
    Noting *n = (Noting *)consumer;
    pthread_mutex_lock(&n->lock);
    n->entered = true;
    pthread_cond_broadcast(&n->opened);
    while (!n->open) pthread_cond_wait(&n->opened, &n->lock);
    n->number[n->put_count++] = frame->number;
    pthread_mutex_unlock(&n->lock);
    return frame->number == n->fail_at ? STATUS_IO : STATUS_OK;
}

static void noting_left_out(Consumer *consumer, const Frame *frame)
{
    Noting *n = (Noting *)consumer;
    n->left_out[n->left_out_count++] = frame->number;
}

static Status noting_close(Consumer *consumer)
{
    ((Noting *)consumer)->closed++;
    return STATUS_OK;
}

static void noting(Noting *n, unsigned wants, int fail_at, bool open)
{
    *n = (Noting){
        .consumer = {wants, noting_put, noting_left_out, noting_close, NULL}, .fail_at = fail_at, .open = open};
    pthread_mutex_init(&n->lock, NULL);
    pthread_cond_init(&n->opened, NULL);
}

static void wait_entered(Noting *n)
{
    pthread_mutex_lock(&n->lock);
    while (!n->entered) pthread_cond_wait(&n->opened, &n->lock);
    pthread_mutex_unlock(&n->lock);
}

static void let_go(Noting *n)
{
    pthread_mutex_lock(&n->lock);
    n->open = true;
    pthread_cond_broadcast(&n->opened);
    pthread_mutex_unlock(&n->lock);
}

static Status put_number(Consumer *queue, FramePool *pool, int number)
{
    Frame *frame = frame_pool_take(pool);
    frame->number = number;
    const Status status = queue->put(queue, frame);
    frame_release(frame);
    return status;
}

/* ---- wants ------------------------------------------------------------------------------------------ */

static void what_is_not_wanted_is_not_made(void **state)
{
    (void)state;
    const double sun_enu[3] = {0, 0.6, 0.8};
    hand_air_on(sun_enu, 2);
    hand_clear();
    const double at[3] = {0, 60, 0}, level[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    hand_add(0, at, level);
    const View    view = hand_view((const double[3]){0, 0, 30}, (const double[3]){0, 1, -0.45}, 32, 24, 60);
    RenderRequest request = hand_request(&view);
    Noting        one, two;
    Consumers     list = {0};
    float         radiance[3][32 * 24];

    /* none; pictures alone; what judges targets and what a detector needs, from two consumers */
    const unsigned wants[3][2] = {{0, 0}, {0, WANT_CELLS}, {WANT_TARGETS | WANT_ERROR, WANT_CELLS}};
    for (int k = 0; k < 3; k++) {
        noting(&one, wants[k][0], -1, true);
        noting(&two, wants[k][1], -1, true);
        assert_int_equal(consumers_add(&list, &one.consumer), STATUS_OK);
        assert_int_equal(consumers_add(&list, &two.consumer), STATUS_OK);
        CHECK(consumers_wants(&list) == (wants[k][0] | wants[k][1]));
        request.hand_over_cells = request.budget = true;
        consumers_request(&request, consumers_wants(&list));
        CHECK(request.truth == (k == 2) && request.hand_over_cells == (k > 0) && request.budget == (k == 2));
        const Picture picture = hand_render(&request, hand.pool);
        FrameArray    plane[frame_max_planes];
        int           truth = 0, planes = frame_planes(plane, &picture, &request);
        for (int i = 0; i < planes; i++) truth += plane[i].kind == PLANE_TRUTH;
        CHECK(truth == (k == 2 ? 8 : 0) && (picture.target != NULL) == (k == 2) &&
              (picture.budget != NULL) == (k == 2));
        CHECK(planes - truth >= 3); /* its bands, always: the same */
        memcpy(radiance[k], picture.lwir, sizeof radiance[k]);
        assert_memory_equal(radiance[k], radiance[0], sizeof radiance[0]);
        assert_int_equal(consumers_close(&list), STATUS_OK);
        CHECK(one.closed == 1 && two.closed == 1 && list.count == 0);
    }
    consumers_request(&request, WANT_SHA256); /* a hash is of truth too */
    CHECK(request.truth && !request.hand_over_cells);
}

/* ---- the queue -------------------------------------------------------------------------------------- */

static void a_queue_hands_on_in_order(void **state)
{
    (void)state;
    Noting     first, last;
    Consumers  list = {0};
    Consumer  *queue = NULL;
    FramePool *pool = NULL;
    noting(&first, WANT_PLANES, -1, true);
    noting(&last, WANT_SHA256, -1, true);
    consumers_add(&list, &first.consumer);
    consumers_add(&list, &last.consumer);
    assert_int_equal(frame_pool_create(&pool, 3), STATUS_OK);
    assert_int_equal(consumer_queue_open(&queue, &list, &(QueueOf){.rule = QUEUE_WAIT, .waiting = 1}), STATUS_OK);
    CHECK(queue->wants == (WANT_PLANES | WANT_SHA256));
    for (int i = 0; i < notes_max; i++) assert_int_equal(put_number(queue, pool, i), STATUS_OK);
    assert_int_equal(queue->close(queue), STATUS_OK);
    CHECK(first.put_count == notes_max && last.put_count == notes_max && first.closed == 1 && last.closed == 1);
    for (int i = 0; i < notes_max; i++) CHECK(first.number[i] == i && last.number[i] == i);
    CHECK(first.left_out_count == 0);
    frame_pool_destroy(pool);
}

/* Nothing behind the first failure gets through, and who puts is told; the consumer behind it never sees that frame. */
static void a_queue_stops_at_the_first_failure(void **state)
{
    (void)state;
    Noting        failing, behind;
    Consumers     list = {0};
    Consumer     *queue = NULL;
    FramePool    *pool = NULL;
    QueueCounters counts = {0};
    Status        status = STATUS_OK;
    int           puts = 0;
    noting(&failing, 0, 3, true);
    noting(&behind, 0, -1, true);
    consumers_add(&list, &failing.consumer);
    consumers_add(&list, &behind.consumer);
    assert_int_equal(frame_pool_create(&pool, 3), STATUS_OK);
    assert_int_equal(
        consumer_queue_open(&queue, &list, &(QueueOf){.rule = QUEUE_WAIT, .waiting = 1, .counters = &counts}),
        STATUS_OK);
    while (status == STATUS_OK && puts < notes_max) status = put_number(queue, pool, puts++);
    assert_int_equal(status, STATUS_IO);
    assert_int_equal(queue->close(queue), STATUS_IO);
    CHECK(puts >= 5 && puts <= 7); /* one waits, one may be on its way */
    CHECK(failing.put_count == 4 && behind.put_count == 3 && counts.handed == 3 && counts.failed == 1);
    frame_pool_destroy(pool);
}

/* The first frame is held up; of the others the newest waits, the rest are left out and told, in order. */
static void a_late_queue_leaves_out(void **state)
{
    (void)state;
    Noting        slow;
    Consumers     list = {0};
    Consumer     *queue = NULL;
    FramePool    *pool = NULL;
    QueueCounters counts = {0};
    noting(&slow, 0, 0, false);
    consumers_add(&list, &slow.consumer);
    assert_int_equal(frame_pool_create(&pool, 3), STATUS_OK);
    assert_int_equal(
        consumer_queue_open(&queue, &list, &(QueueOf){.rule = QUEUE_LEAVE_OUT, .waiting = 1, .counters = &counts}),
        STATUS_OK);
    assert_int_equal(put_number(queue, pool, 0), STATUS_OK);
    wait_entered(&slow);
    for (int i = 1; i < 20; i++) assert_int_equal(put_number(queue, pool, i), STATUS_OK); /* never waits */
    let_go(&slow);
    assert_int_equal(queue->close(queue), STATUS_OK); /* a failure ends nothing */
    CHECK(slow.put_count == 2 && slow.number[0] == 0 && slow.number[1] == 19);
    CHECK(slow.left_out_count == 18 && counts.left_out == 18 && counts.handed == 1 && counts.failed == 1);
    for (int i = 0; i < 18; i++) CHECK(slow.left_out[i] == i + 1);
    frame_pool_destroy(pool);
}

/* ---- levels ----------------------------------------------------------------------------------------- */

/* The level of the last display after frames of different brightness, of which `made` are put to the displays, and of
 * those `written` to the files: the latter makes no difference. */
static DetectorLevel shown_after(unsigned made, unsigned written)
{
    enum { side = 16, frames = 5 };
    Config        config = config_default();
    Consumer     *displays = NULL, *pictures = NULL;
    FramePool    *pool = NULL;
    const Sensors none = {0};
    char          folder[temp_path_size], path[temp_path_size + 64];
    static float  plane[side * side];
    DetectorLevel last = {NAN, NAN};
    config.detector.agc_s = 2;
    config.detector.raw = false;
    config.publish.png = config.publish.files = true;
    strcpy(config.publish.planes, "none");
    CHECK(temp_folder(folder));
    assert_int_equal(frame_files_prepare(folder, 1u << BAND_LWIR, 0), STATUS_OK);
    assert_int_equal(frame_pool_create(&pool, 1), STATUS_OK);
    assert_int_equal(consume_displays(&displays, &config, &none, hand.pool, false), STATUS_OK);
    assert_int_equal(consume_pictures(&pictures, &(PictureFiles){.out = folder, .config = &config, .pool = hand.pool}),
                     STATUS_OK);
    CHECK(displays->wants == WANT_CELLS && pictures->wants == WANT_DISPLAY);
    for (int k = 0; k < frames; k++) {
        Frame *f = frame_pool_take(pool);
        for (int i = 0; i < side * side; i++) plane[i] = 30.0f + (float)(k * k) + 0.05f * (float)i;
        f->number = k;
        f->time_s = 100 + 0.4 * k;
        f->world = &hand.world;
        f->request = (RenderRequest){.bands = 1u << BAND_LWIR};
        f->seen.picture = (Picture){.width = side, .height = side, .lwir = plane};
        f->seen.plane_count = frame_planes(f->seen.plane, &f->seen.picture, &f->request);
        f->provenance.config_sha256 = "";
        if (made >> k & 1) assert_int_equal(displays->put(displays, f), STATUS_OK);
        if (made >> k & 1) last = f->display[BAND_LWIR].level;
        if (written >> k & 1) assert_int_equal(pictures->put(pictures, f), STATUS_OK);
        if (written >> k & 1) CHECK(*f->seen.sha256); /* computed beside the files */
        frame_release(f);
        for (int e = 0; e < 2; e++) {
            snprintf(path, sizeof path, "%s/frames/lwir/%06d.%s", folder, k, e ? "png" : "exr");
            CHECK((remove(path) == 0) == (written >> k & 1));
        }
    }
    assert_int_equal(pictures->close(pictures), STATUS_OK);
    assert_int_equal(displays->close(displays), STATUS_OK);
    frame_pool_destroy(pool);
    snprintf(path, sizeof path, "%s/frames/lwir", folder);
    remove(path);
    snprintf(path, sizeof path, "%s/frames", folder);
    remove(path);
    remove(folder);
    return last;
}

static void frames_left_out_move_the_level(void **state)
{
    (void)state;
    const DetectorLevel all = shown_after(0x1f, 0x1f), late = shown_after(0x1f, 0x12);
    const DetectorLevel never_made = shown_after(0x11, 0x11);
    CHECK(late.low == all.low && late.high == all.high);
    CHECK(fabs(never_made.low - all.low) > 0.1); /* the twin: frames that no detector saw do not move it */
}

/* 8, 10, 12 and 16 bits of one display agree to a step of the coarser. */
static void a_display_of_any_depth(void **state)
{
    (void)state;
    enum { side = 16, count = side * side };
    Config       config = config_default();
    Camera       camera = {.chain = {NULL}};
    FrameDisplay display[BAND_COUNT];
    static float plane[count];
    uint8_t      eight[count];
    uint16_t     deep[3][count];
    for (int i = 0; i < count; i++) plane[i] = 30.0f + 0.01f * (float)i;
    config.detector.noise = 0;
    const Picture    picture = {.width = side, .height = side, .lwir = plane};
    const DisplaysOf of = {.config = &config, .picture = &picture, .camera = &camera};
    Arena           *arena = arena_create();
    assert_non_null(arena);
    assert_int_equal(frame_displays_make(display, &of, 1u << BAND_LWIR | 1u << BAND_MWIR, hand.pool, arena), STATUS_OK);
    CHECK(display[BAND_LWIR].planes == 1 && display[BAND_MWIR].planes == 0 && !display[BAND_LWIR].counts[0]);
    frame_display_quantise(eight, &display[BAND_LWIR], count, 8);
    for (int k = 0; k < 3; k++) frame_display_quantise(deep[k], &display[BAND_LWIR], count, k == 2 ? 16 : 10 + 2 * k);
    for (int i = 0; i < count; i++) {
        CHECK(deep[0][i] <= 1023 && deep[1][i] <= 4095 && deep[2][i] >> 4 == deep[1][i] &&
              deep[2][i] >> 6 == deep[0][i]);
        CHECK(fabs(deep[2][i] / 65535.0 - eight[i] / 255.0) <= 0.5 / 255 + 1e-5);
    }
    CHECK(eight[0] < 20 && eight[count - 1] > 235 && deep[2][1] > deep[2][0]);
    arena_destroy(arena);
}

/* ---- arrays ----------------------------------------------------------------------------------------- */

static void arrays_of_any_axes(void **state)
{
    (void)state;
    static float values[2 * 2 * 3 * 4]; /* pulses, channels, bins; complex */
    for (int i = 0; i < 48; i++) values[i] = (float)i;
    FrameView   view = {.plane_count = 1,
                        .plane = {{.group = "radar",
                                   .name = "echo",
                                   .unit = "V",
                                   .type = PLANE_C64,
                                   .axes = 3,
                                   .axis = {"pulse", "channel", "bin"},
                                   .size = {2, 3, 4},
                                   .values = values}}};
    char        name[frame_plane_name_size];
    const Plane plane = frame_plane(name, &view.plane[0]);
    CHECK(plane.width == 4 && plane.height == 6 && strcmp(name, "radar/echo") == 0);
    char hash[3][sha256_text_size];
    for (int k = 0; k < 3; k++) {
        if (k == 1) values[47] = -1; /* the imaginary part of the last */
        if (k == 2) values[47] = 47, view.plane[0].type = PLANE_F32;
        *view.sha256 = 0;
        assert_int_equal(frame_sha256(&view), STATUS_OK);
        memcpy(hash[k], view.sha256, sizeof hash[k]);
    }
    CHECK(strcmp(hash[0], hash[1]) != 0 && strcmp(hash[0], hash[2]) != 0);
}

/* ---- a list ------------------------------------------------------------------------------------------ */

/* One that notes when it is begun, put and closed, among all. */
typedef struct Numbered {
    Consumer consumer;
    int      begun, put, closed;
    Status   begins, puts, closes;
} Numbered;

static int turn;

static Status numbered_begin(Consumer *consumer)
{
    Numbered *n = (Numbered *)consumer;
    n->begun = ++turn;
    return n->begins;
}

static Status numbered_put(Consumer *consumer, Frame *frame)
{
    Numbered *n = (Numbered *)consumer;
    CHECK(frame->publish_begun_s > 0);
    n->put = ++turn;
    return n->puts;
}

static Status numbered_close(Consumer *consumer)
{
    Numbered *n = (Numbered *)consumer;
    n->closed = ++turn;
    return n->closes;
}

static void numbered(Consumers *list, Numbered *n, int count)
{
    *list = (Consumers){.count = 0};
    turn = 0;
    for (int i = 0; i < count; i++) {
        n[i] = (Numbered){.consumer = {1u << i % 4, numbered_put, NULL, numbered_close, NULL, numbered_begin}};
        CHECK(consumers_add(list, &n[i].consumer) == STATUS_OK);
    }
}

/* In order, up to the first failure; closed are all, those that wait for the others last; the first failure is told. */
static void a_list_is_used_as_one(void **state)
{
    (void)state;
    static Frame frame;
    Consumers    list;
    Numbered     n[consumers_max + 1] = {0};
    numbered(&list, n, consumers_max);
    CHECK(consumers_add(&list, NULL) == STATUS_OK && list.count == consumers_max);
    n[consumers_max] = (Numbered){.consumer = {0, numbered_put, NULL, numbered_close, NULL, NULL}};
    CHECK(consumers_add(&list, &n[consumers_max].consumer) == STATUS_BAD_VALUE && n[consumers_max].closed == 1);
    CHECK(consumers_wants(&list) == 0xF && consumers_close(&list) == STATUS_OK && list.count == 0);

    numbered(&list, n, 5);
    n[1].consumer.begin = NULL;
    n[1].consumer.wants = n[3].consumer.wants = WANT_LATENCY;
    CHECK(consumers_begin(&list) == STATUS_OK && n[0].begun == 1 && n[1].begun == 0 && n[2].begun == 2 &&
          n[4].begun == 4);
    n[2].begins = STATUS_IO;
    turn = 0;
    CHECK(consumers_begin(&list) == STATUS_IO && turn == 2);
    turn = 0;
    frame.publish_begun_s = 0;
    const double before_s = wall_clock_s();
    CHECK(consumers_put(&list, &frame) == STATUS_OK && turn == 5 && n[0].put == 1 && n[4].put == 5);
    CHECK(frame.publish_begun_s >= before_s && frame.publish_begun_s <= wall_clock_s());
    frame.publish_begun_s = 5; /* by another list before */
    n[2].puts = STATUS_BAD_VALUE, n[3].puts = STATUS_IO;
    turn = 0;
    CHECK(consumers_put(&list, &frame) == STATUS_BAD_VALUE && turn == 3 && frame.publish_begun_s == 5);
    n[3].closes = STATUS_IO, n[4].closes = STATUS_BAD_VALUE; /* the third is closed after the fourth */
    turn = 0;
    CHECK(consumers_close(&list) == STATUS_BAD_VALUE && turn == 5);
    CHECK(n[0].closed == 1 && n[2].closed == 2 && n[4].closed == 3 && n[1].closed == 4 && n[3].closed == 5);
}

/* What a request must have of what consumers want; what the caller does not ask for is not added. */
static void what_consumers_want_of_a_request(void **state)
{
    (void)state;
    static const struct {
        unsigned wants;
        bool     truth, cells, budget;
    } of[] = {{0, false, false, false},           {WANT_PLANES, true, false, false}, {WANT_TARGETS, true, false, false},
              {WANT_SHA256, true, false, false},  {WANT_ERROR, true, false, true},   {WANT_CELLS, false, true, false},
              {WANT_DISPLAY, false, false, false}};
    for (size_t k = 0; k < sizeof of / sizeof *of; k++)
        for (int asked = 0; asked < 2; asked++) {
            RenderRequest request = {.hand_over_cells = asked, .budget = asked};
            consumers_request(&request, of[k].wants);
            CHECK(request.truth == of[k].truth && request.hand_over_cells == (asked && of[k].cells) &&
                  request.budget == (asked && of[k].budget));
        }
}

/* ---- paths ------------------------------------------------------------------------------------------ */

static int  errors;
static void count_errors(void *user, LogLevel level, const char *line)
{
    (void)user;
    (void)level;
    errors += strncmp(line, "out:", 4) == 0 || strstr(line, " out:") != NULL;
}

/* A folder whose files' names would be cut is refused before anything is made. */
static void a_long_path_is_refused(void **state)
{
    (void)state;
    static char  out[frame_path_size + 8];
    const size_t longest = frame_path_size - frame_path_room - 1;
    char         found[frame_path_size];
    memset(out, 'x', sizeof out - 1);
    memcpy(out, "/dev/null/", 10);
    errors = 0;
    log_set_sink(count_errors, NULL);
    for (size_t n = longest; n < sizeof out; n++) {
        char kept = out[n];
        out[n] = 0;
        const Status status = frame_files_prepare(out, 1u << BAND_LWIR, 0);
        CHECK(status == (n > longest ? STATUS_BAD_VALUE : STATUS_IO)); /* no such folder, and a name too long */
        CHECK(!frame_files_earlier(found, out));
        out[n] = kept;
    }
    char             path[frame_path_size];
    const FrameFiles files = {.out = out};
    CHECK(!frame_path(path, &files, "frames", "lwir", "png"));
    log_set_sink(NULL, NULL);
    CHECK(errors == (int)(sizeof out - longest) + 1);
}

static int open_all(void **state)
{
    (void)state;
    return hand_open(true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_not_wanted_is_not_made),
        cmocka_unit_test(a_queue_hands_on_in_order),
        cmocka_unit_test(a_queue_stops_at_the_first_failure),
        cmocka_unit_test(a_late_queue_leaves_out),
        cmocka_unit_test(frames_left_out_move_the_level),
        cmocka_unit_test(a_display_of_any_depth),
        cmocka_unit_test(arrays_of_any_axes),
        cmocka_unit_test(a_list_is_used_as_one),
        cmocka_unit_test(what_consumers_want_of_a_request),
        cmocka_unit_test(a_long_path_is_refused),
    };
    return cmocka_run_group_tests(tests, open_all, hand_close);
}
