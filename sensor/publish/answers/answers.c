/* sensor/publish/answers/answers.c: answers received on loopback: checked, the newest of each band kept, all written to
 * answers.jsonl. */
#include "sensor/publish/answers/answers.h"
#include "sensor/publish/answers/answer_lines_private.h"

#include <arpa/inet.h>
#include <errno.h>
#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <stdio.h>

/* ---- the receiver -------------------------------------------------------------------------------- */

typedef struct KnownFrame {
    AnswerFrame of;
    int64_t     time_us;  /* of its exercise time, since 1970 */
    unsigned    answered; /* 1 << band */
} KnownFrame;

struct Answers {
    int             socket, stop; /* stop: an eventfd */
    AnswersOf       of;
    bool            running;
    pthread_t       thread;
    Answer          one;                        /* of the thread */
    uint8_t         octets[answer_octets_most]; /* of the thread */
    pthread_mutex_t lock;                       /* of what follows */
    AnswerLines    *lines;                      /* NULL: no file */
    KnownFrame      known[answer_frames_kept];
    int             known_count, known_next;
    bool            has[BAND_COUNT];
    Answer          newest[BAND_COUNT];
    AnswerCounters  counters;
    AnswersTaken   *taken; /* NULL: none is told */
    void           *taken_user;
};

/* ---- one datagram -------------------------------------------------------------------------- */

/* The frame that an answer names: its number, its time and both must be right. Of frames that are near its time the
 * nearest. */
static KnownFrame *known(Answers *a, const Answer *one)
{
    KnownFrame *found = NULL;
    int64_t     nearest_us = answer_time_us + 1;
    for (int i = 0; i < a->known_count; i++) {
        KnownFrame   *k = &a->known[i];
        const int64_t off_us = one->timed ? llabs(k->time_us - one->time_us) : 0;
        const bool    numbered =
            !one->numbered || (((uint32_t)k->of.number ^ (uint32_t)one->frame) & one->number_bits) == 0;
        if (!numbered || off_us >= nearest_us) continue;
        nearest_us = off_us;
        found = k;
    }
    return found;
}

/* Completes a well-formed answer and keeps it. The lock must be held. */
static AnswerReason keep(Answers *a, Answer *one, double now_s, AnswerArrival *arrival)
{
    KnownFrame *frame = known(a, one);
    if (!frame) return ANSWER_FRAME;
    if (frame->answered >> one->band & 1) return ANSWER_REPEATED;
    frame->answered |= 1u << one->band;
    const AnswerFrame *of = &frame->of;
    one->frame = of->number;
    one->time_s = of->time_s;
    one->unix_s = of->unix_s;
    one->received_s = now_s;
    answer_complete(one, &of->camera);
    arrival->latency_ms = of->rendered_s > 0 ? 1e3 * (now_s - of->rendered_s) : NAN;
    arrival->age_ms = of->instant_s > 0 ? 1e3 * (now_s - of->instant_s) : NAN;
    arrival->late = a->has[one->band] && of->time_s < a->newest[one->band].time_s;
    if (arrival->late) return ANSWER_LATE;
    a->newest[one->band] = *one;
    a->has[one->band] = true;
    return ANSWER_GOOD;
}

/* False: there is none, or a passing error: poll decides again. */
static bool receive(Answers *a)
{
    AnswerArrival  arrival;
    AnswerCounters written = {.lines = 0};
    const ssize_t  size = recv(a->socket, a->octets, sizeof a->octets, MSG_DONTWAIT);
    const double   now_s = wall_clock_s();
    if (size < 0) return false;
    AnswerReason reason = answer_read(&a->one, a->octets, (size_t)size, &a->of.scope);
    pthread_mutex_lock(&a->lock);
    if (reason == ANSWER_GOOD) reason = keep(a, &a->one, now_s, &arrival);
    a->counters.datagrams[a->one.form][reason]++;
    AnswerLines  *lines = a->lines;
    AnswersTaken *taken = a->taken;
    pthread_mutex_unlock(&a->lock);
    if (taken && (reason == ANSWER_GOOD || reason == ANSWER_LATE)) taken(a->taken_user, &a->one);
    if (!lines || (reason != ANSWER_GOOD && reason != ANSWER_LATE)) return true;
    answer_lines_write(lines, &a->one, &arrival, &written);
    pthread_mutex_lock(&a->lock);
    a->counters.lines += written.lines;
    a->counters.lines_failed += written.lines_failed;
    pthread_mutex_unlock(&a->lock);
    return true;
}

static void *work(void *user)
{
    enum { at_once = 256, at_the_end = 65536 }; /* then it is asked whether to stop; more than the socket holds */
    Answers      *a = user;
    struct pollfd ready[2] = {{.fd = a->socket, .events = POLLIN}, {.fd = a->stop, .events = POLLIN}};
    for (;;) {
        const int count = poll(ready, 2, -1);
        if (count < 0 && errno != EINTR) return NULL;
        for (int i = 0; count > 0 && ready[0].revents && i < at_once && receive(a); i++) {
        }
        if (count <= 0 || !ready[1].revents) continue;
        for (int i = 0; i < at_the_end && receive(a); i++) {
        }
        return NULL;
    }
}

/* What the kernel had no room for. */
static uint64_t lost_kernel(const Answers *a)
{
    uint32_t   info[SK_MEMINFO_VARS] = {0};
    socklen_t  octets = sizeof info;
    const bool told = a->socket >= 0 && getsockopt(a->socket, SOL_SOCKET, SO_MEMINFO, info, &octets) == 0 &&
                      octets > SK_MEMINFO_DROPS * sizeof *info;
    return told ? info[SK_MEMINFO_DROPS] : 0;
}

/* ---- open and close ------------------------------------------------------------------------- */

static Status open_socket(Answers *a)
{
    const struct sockaddr_in own = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)a->of.port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const int room = 1 << 20; /* as far as the system allows */
    a->stop = eventfd(0, EFD_CLOEXEC);
    a->socket = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    setsockopt(a->socket, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    if (a->stop >= 0 && a->socket >= 0 && bind(a->socket, (const struct sockaddr *)&own, sizeof own) == 0)
        return STATUS_OK;
    log_error("answers: cannot receive on 127.0.0.1 port %d: %s; choose another publish.detections_port", a->of.port,
              strerror(errno));
    return STATUS_IO;
}

Status answers_open(Answers **out, const AnswersOf *of)
{
    Answers *a = calloc(1, sizeof *a);
    if (!a) return STATUS_NO_MEMORY;
    a->socket = a->stop = -1;
    a->of = *of;
    pthread_mutex_init(&a->lock, NULL);
    Status status = open_socket(a);
    if (status == STATUS_OK) {
        sigset_t all, before; /* signals are for the main thread */
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before);
        a->running = pthread_create(&a->thread, NULL, work, a) == 0;
        pthread_sigmask(SIG_SETMASK, &before, NULL);
        if (!a->running) status = STATUS_NO_MEMORY;
    }
    if (status == STATUS_OK) *out = a;
    else answers_close(a, NULL);
    return status;
}

Status answers_record(Answers *a, const char *folder)
{
    AnswerLines *lines = NULL;
    const Status status = answer_lines_open(&lines, folder);
    if (status != STATUS_OK) return status;
    pthread_mutex_lock(&a->lock);
    a->lines = lines;
    pthread_mutex_unlock(&a->lock);
    return STATUS_OK;
}

static void report(const AnswerCounters *c)
{
    char           text[640];
    size_t         used = 0;
    const uint64_t taken = answer_datagrams(c, ANSWER_GOOD);
    *text = 0;
    for (int i = ANSWER_GOOD + 1; i < ANSWER_REASONS; i++) {
        const uint64_t count = answer_datagrams(c, (AnswerReason)i);
        if (count && used < sizeof text)
            used += (size_t)snprintf(text + used, sizeof text - used, ", %s %llu", answer_reason_name[i],
                                     (unsigned long long)count);
    }
    if (c->lost_kernel && used < sizeof text)
        snprintf(text + used, sizeof text - used, ", lost, since they came too fast, %llu",
                 (unsigned long long)c->lost_kernel);
    if (*text) log_warn("answers: %llu datagrams taken; refused%s", (unsigned long long)taken, text + 1);
    else log_info("answers: %llu datagrams taken", (unsigned long long)taken);
}

void answers_close(Answers *a, AnswerCounters *counters)
{
    if (counters) *counters = (AnswerCounters){.lines = 0};
    if (!a) return;
    if (a->running) {
        eventfd_write(a->stop, 1);
        pthread_join(a->thread, NULL);
        answers_counters(a, &a->counters);
        report(&a->counters);
        if (counters) *counters = a->counters;
    }
    answer_lines_close(a->lines);
    if (a->socket >= 0) close(a->socket);
    if (a->stop >= 0) close(a->stop);
    pthread_mutex_destroy(&a->lock);
    free(a);
}

/* ---- frames and results ---------------------------------------------------------------------- */

void answers_frame(Answers *a, const AnswerFrame *frame)
{
    pthread_mutex_lock(&a->lock);
    a->known[a->known_next] = (KnownFrame){.of = *frame, .time_us = llround(1e6 * frame->unix_s)};
    a->known_next = (a->known_next + 1) % answer_frames_kept;
    if (a->known_count < answer_frames_kept) a->known_count++;
    pthread_mutex_unlock(&a->lock);
}

bool answers_latest(Answers *a, Band band, Answer *out)
{
    pthread_mutex_lock(&a->lock);
    const bool has = a->has[band];
    if (has) *out = a->newest[band];
    pthread_mutex_unlock(&a->lock);
    return has;
}

void answers_watch(Answers *a, AnswersTaken *taken, void *user)
{
    pthread_mutex_lock(&a->lock);
    a->taken = taken;
    a->taken_user = user;
    pthread_mutex_unlock(&a->lock);
}

void answers_counters(Answers *a, AnswerCounters *out)
{
    pthread_mutex_lock(&a->lock);
    a->counters.lost_kernel = lost_kernel(a);
    *out = a->counters;
    pthread_mutex_unlock(&a->lock);
}

typedef struct AnswersConsumer {
    Consumer    consumer;
    Answers    *answers;
    const char *folder;
} AnswersConsumer;

static Status put(Consumer *consumer, Frame *frame)
{
    AnswerFrame of = {.number = frame->number,
                      .time_s = frame->time_s,
                      .unix_s = frame->unix_s,
                      .rendered_s = frame->times.rendered_s,
                      .instant_s = frame->times.instant_s};
    answer_camera(&of.camera, &frame->record);
    answers_frame(((AnswersConsumer *)consumer)->answers, &of);
    return STATUS_OK;
}

static Status begin(Consumer *consumer)
{
    const AnswersConsumer *c = (AnswersConsumer *)consumer;
    return answers_record(c->answers, c->folder);
}

static Status close_consumer(Consumer *consumer)
{
    free(consumer);
    return STATUS_OK;
}

Status consume_answers(Consumer **out, Answers *answers, const char *folder)
{
    AnswersConsumer *c = malloc(sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    *c = (AnswersConsumer){{.begin = begin, .put = put, .close = close_consumer}, answers, folder};
    *out = &c->consumer;
    return STATUS_OK;
}
