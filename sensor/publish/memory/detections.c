/* sensor/publish/memory/detections.c: receives detections on loopback and keeps the newest of each band. */
#include "sensor/publish/memory/detections.h"

#include "sensor/publish/memory/answers.h"

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

typedef struct KnownFrame {
    int      frame;
    double   time_s, unix_s, rendered_s;
    unsigned answered; /* 1 << band */
} KnownFrame;

struct Detections {
    int             socket, stop; /* stop: an eventfd */
    int             port, width, height;
    unsigned        bands;
    Answers        *answers;      /* NULL: no file; of the thread */
    bool            running;
    pthread_t       thread;
    pthread_mutex_t lock;         /* of what follows */
    KnownFrame      known[detections_frames_kept];
    int             known_count, known_next;
    bool            has[BAND_COUNT];
    DetectionSet    newest[BAND_COUNT];
    AnswerCounters  counters;
};

/* ---- one datagram -------------------------------------------------------------------------- */

static KnownFrame *known(Detections *d, int frame)
{
    for (int i = 0; i < d->known_count; i++)
        if (d->known[i].frame == frame) return &d->known[i];
    return NULL;
}

/* A well-formed one. With the lock held. */
static DetectionsReason keep(KnownFrame *of, Detections *d, const PitviperDetections *one)
{
    DetectionSet *set   = &d->newest[one->band];
    KnownFrame   *frame = known(d, one->frame);
    if (!frame) return DETECTIONS_FRAME;
    if (frame->answered >> one->band & 1) return DETECTIONS_REPEATED;
    frame->answered |= 1u << one->band;
    *of = *frame;
    if (d->has[one->band] && frame->time_s < set->time_s) return DETECTIONS_LATE;
    set->frame      = one->frame;
    set->band       = (Band)one->band;
    set->time_s     = frame->time_s;
    set->unix_s     = frame->unix_s;
    set->received_s = wall_clock_s();
    set->count      = (int)one->count;
    memcpy(set->detection, one->detection, sizeof set->detection);
    d->has[one->band] = true;
    return DETECTIONS_GOOD;
}

/* False: there is none, or a passing error: poll decides again. */
static bool receive(Detections *d)
{
    uint8_t            bytes[sizeof(PitviperDetections) + 1]; /* one more: a longer datagram is seen as longer */
    PitviperDetections one;
    KnownFrame         frame = {0};
    AnswerCounters     written = {0};
    const ssize_t      size = recv(d->socket, bytes, sizeof bytes, MSG_DONTWAIT);
    const double       now_s = wall_clock_s();
    if (size < 0) return false;
    DetectionsReason reason = detections_parse(&one, bytes, (size_t)size, d->bands, d->width, d->height);
    pthread_mutex_lock(&d->lock);
    if (reason == DETECTIONS_GOOD) reason = keep(&frame, d, &one);
    d->counters.datagrams[reason]++;
    Answers *answers = d->answers;
    pthread_mutex_unlock(&d->lock);
    if (!answers || (reason != DETECTIONS_GOOD && reason != DETECTIONS_LATE)) return true;
    answers_write(answers, &one, &(AnsweredFrame){.time_s = frame.time_s, .late = reason == DETECTIONS_LATE,
                                                     .latency_ms = frame.rendered_s > 0 ? 1e3 * (now_s - frame.rendered_s) : NAN},
                  &written);
    pthread_mutex_lock(&d->lock);
    d->counters.lines += written.lines;
    d->counters.lines_failed += written.lines_failed;
    pthread_mutex_unlock(&d->lock);
    return true;
}

static void *work(void *user)
{
    enum { at_once = 256, at_the_end = 65536 }; /* then it is asked whether to stop; more than the socket holds */
    Detections   *d       = user;
    struct pollfd ready[2] = {{.fd = d->socket, .events = POLLIN}, {.fd = d->stop, .events = POLLIN}};
    for (;;) {
        const int count = poll(ready, 2, -1);
        if (count < 0 && errno != EINTR) return NULL;
        for (int i = 0; count > 0 && ready[0].revents && i < at_once && receive(d); i++) {}
        if (count <= 0 || !ready[1].revents) continue;
        for (int i = 0; i < at_the_end && receive(d); i++) {}
        return NULL;
    }
}

/* What the kernel had no room for. */
static uint64_t lost_kernel(const Detections *d)
{
    uint32_t   info[SK_MEMINFO_VARS] = {0};
    socklen_t  octets = sizeof info;
    const bool told = d->socket >= 0 && getsockopt(d->socket, SOL_SOCKET, SO_MEMINFO, info, &octets) == 0 &&
                      octets > SK_MEMINFO_DROPS * sizeof *info;
    return told ? info[SK_MEMINFO_DROPS] : 0;
}

/* ---- open and close ------------------------------------------------------------------------- */

static Status open_socket(Detections *d)
{
    const struct sockaddr_in own = {.sin_family = AF_INET, .sin_port = htons((uint16_t)d->port),
                                    .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const int room = 1 << 20; /* as far as the system allows */
    d->stop   = eventfd(0, EFD_CLOEXEC);
    d->socket = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    setsockopt(d->socket, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    if (d->stop >= 0 && d->socket >= 0 && bind(d->socket, (const struct sockaddr *)&own, sizeof own) == 0)
        return STATUS_OK;
    log_error("detections: cannot receive on 127.0.0.1 port %d: %s; choose another publish.detections_port", d->port,
              strerror(errno));
    return STATUS_IO;
}

Status detections_open(Detections **out, const DetectionsOf *of)
{
    Detections *d = calloc(1, sizeof *d);
    if (!d) return STATUS_NO_MEMORY;
    *d = (Detections){.socket = -1, .stop = -1, .port = of->port, .width = of->width, .height = of->height,
                      .bands = of->bands};
    pthread_mutex_init(&d->lock, NULL);
    Status status = open_socket(d);
    if (status == STATUS_OK) {
        sigset_t all, before; /* signals are for the main thread */
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before);
        d->running = pthread_create(&d->thread, NULL, work, d) == 0;
        pthread_sigmask(SIG_SETMASK, &before, NULL);
        if (!d->running) status = STATUS_NO_MEMORY;
    }
    if (status == STATUS_OK) *out = d;
    else detections_close(d, NULL);
    return status;
}

Status detections_record(Detections *d, const char *folder)
{
    Answers     *answers = NULL;
    const Status status  = answers_open(&answers, folder);
    if (status != STATUS_OK) return status;
    pthread_mutex_lock(&d->lock);
    d->answers = answers;
    pthread_mutex_unlock(&d->lock);
    return STATUS_OK;
}

static void report(const AnswerCounters *c)
{
    char           text[480];
    size_t         used = 0;
    const uint64_t taken = c->datagrams[DETECTIONS_GOOD];
    *text = 0;
    for (int i = DETECTIONS_GOOD + 1; i < DETECTIONS_REASONS; i++)
        if (c->datagrams[i] && used < sizeof text)
            used += (size_t)snprintf(text + used, sizeof text - used, ", %s %llu", detections_reason_name[i],
                                     (unsigned long long)c->datagrams[i]);
    if (c->lost_kernel && used < sizeof text)
        snprintf(text + used, sizeof text - used, ", lost, since they came too fast, %llu", (unsigned long long)c->lost_kernel);
    if (*text) log_warn("detections: %llu datagrams taken; refused%s", (unsigned long long)taken, text + 1);
    else log_info("detections: %llu datagrams taken", (unsigned long long)taken);
}

void detections_close(Detections *d, AnswerCounters *counters)
{
    if (counters) *counters = (AnswerCounters){{0}, 0, 0, 0};
    if (!d) return;
    if (d->running) {
        eventfd_write(d->stop, 1);
        pthread_join(d->thread, NULL);
        detections_counters(d, &d->counters);
        report(&d->counters);
        if (counters) *counters = d->counters;
    }
    answers_close(d->answers);
    if (d->socket >= 0) close(d->socket);
    if (d->stop >= 0) close(d->stop);
    pthread_mutex_destroy(&d->lock);
    free(d);
}

/* ---- frames and results ---------------------------------------------------------------------- */

void detections_frame(Detections *d, int frame, double time_s, double unix_s, double rendered_s)
{
    pthread_mutex_lock(&d->lock);
    d->known[d->known_next] = (KnownFrame){frame, time_s, unix_s, rendered_s, 0};
    d->known_next           = (d->known_next + 1) % detections_frames_kept;
    if (d->known_count < detections_frames_kept) d->known_count++;
    pthread_mutex_unlock(&d->lock);
}

bool detections_latest(Detections *d, Band band, DetectionSet *out)
{
    pthread_mutex_lock(&d->lock);
    const bool has = d->has[band];
    if (has) *out = d->newest[band];
    pthread_mutex_unlock(&d->lock);
    return has;
}

void detections_counters(Detections *d, AnswerCounters *out)
{
    pthread_mutex_lock(&d->lock);
    d->counters.lost_kernel = lost_kernel(d);
    *out = d->counters;
    pthread_mutex_unlock(&d->lock);
}

typedef struct DetectionsConsumer {
    Consumer    consumer;
    Detections *detections;
    const char *folder;
} DetectionsConsumer;

static Status put(Consumer *consumer, Frame *frame)
{
    detections_frame(((DetectionsConsumer *)consumer)->detections, frame->number, frame->time_s, frame->unix_s,
                     frame->times.rendered_s);
    return STATUS_OK;
}

static Status begin(Consumer *consumer)
{
    const DetectionsConsumer *c = (DetectionsConsumer *)consumer;
    return detections_record(c->detections, c->folder);
}

static Status close_consumer(Consumer *consumer)
{
    free(consumer);
    return STATUS_OK;
}

Status consume_detections(Consumer **out, Detections *detections, const char *folder)
{
    DetectionsConsumer *c = malloc(sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    *c   = (DetectionsConsumer){{.begin = begin, .put = put, .close = close_consumer}, detections, folder};
    *out = &c->consumer;
    return STATUS_OK;
}
