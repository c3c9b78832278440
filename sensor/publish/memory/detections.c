/* sensor/publish/memory/detections.c: detections received on loopback: checked, the newest of each band kept, all
 * written to answers.jsonl. */
#include "sensor/publish/memory/detections.h"
#include "pitviper_output.h"
#include "render/scene/view.h"

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
#include <pitviper_memory.h>
#include <stdio.h>

/* ---- a datagram of detections, checked ----------------------------------------------------------- */

const char *const detections_reason_name[DETECTIONS_REASONS] = {
    "good", "size",  "magic", "byte_order",      "version",       "count", "band",
    "box",  "score", "text",  "reserved_octets", "unknown_frame", "late",  "repeated"};

/* Printable ASCII up to the first 0, then zeros to the end. */
static bool text_is_good(const char *text, size_t size)
{
    size_t n = 0;
    while (n < size && text[n] >= 0x20 && text[n] <= 0x7e) n++;
    if (n == size) return false;
    for (; n < size; n++)
        if (text[n]) return false;
    return true;
}

static DetectionsReason check_one(const PitviperDetection *d, float width, float height)
{
    if (!(d->left >= 0 && d->right > d->left && d->right <= width && d->top >= 0 && d->bottom > d->top &&
          d->bottom <= height))
        return DETECTIONS_BOX; /* NaN too */
    if (!(d->score >= 0 && d->score <= 1)) return DETECTIONS_SCORE;
    if (!text_is_good(d->class_name, sizeof d->class_name)) return DETECTIONS_TEXT;
    return d->reserved[0] || d->reserved[1] ? DETECTIONS_RESERVED : DETECTIONS_GOOD;
}

/* A detection of version 1: its class is shorter. */
typedef struct DetectionOf1 {
    float    left, top, right, bottom, score;
    uint32_t track;
    char     class_name[16];
    uint32_t reserved[2];
} DetectionOf1;
_Static_assert(sizeof(DetectionOf1) == 48, "as version 1 was laid out");

/* The class must end with a 0 within its own room, whatever follows it here. */
static bool from_1(PitviperDetection *out, const uint8_t *bytes)
{
    DetectionOf1 d;
    memcpy(&d, bytes, sizeof d);
    *out = (PitviperDetection){.left = d.left,
                               .top = d.top,
                               .right = d.right,
                               .bottom = d.bottom,
                               .score = d.score,
                               .track = d.track,
                               .reserved = {d.reserved[0], d.reserved[1]}};
    memcpy(out->class_name, d.class_name, sizeof d.class_name);
    return d.class_name[sizeof d.class_name - 1] == 0;
}

DetectionsReason detections_parse(PitviperDetections *out, const uint8_t *bytes, size_t size, unsigned bands, int width,
                                  int height)
{
    const size_t head = PITVIPER_DETECTIONS_SIZE(0);
    if (size < head || size > sizeof *out) return DETECTIONS_SIZE;
    memset(out, 0, sizeof *out);
    memcpy(out, bytes, head);
    if (memcmp(out->magic, PITVIPER_DETECTIONS_MAGIC, sizeof out->magic) != 0) return DETECTIONS_MAGIC;
    if (out->byte_order != PITVIPER_MEMORY_BYTE_ORDER) return DETECTIONS_ORDER;
    const size_t each = out->version == 1 ? sizeof(DetectionOf1) : sizeof *out->detection;
    if (out->version < 1 || out->version > PITVIPER_DETECTIONS_VERSION || out->detection_size != each)
        return DETECTIONS_VERSION;
    if (out->count > pitviper_detections_most) return DETECTIONS_COUNT;
    if (size != head + out->count * each) return DETECTIONS_SIZE;
    if (out->band >= BAND_COUNT || !(bands >> out->band & 1)) return DETECTIONS_BAND;
    if (out->reserved) return DETECTIONS_RESERVED;
    for (uint32_t i = 0; i < out->count; i++) {
        const uint8_t *from = bytes + head + i * each;
        bool           terminated = true;
        if (out->version == 1) terminated = from_1(&out->detection[i], from);
        else memcpy(&out->detection[i], from, each);
        const DetectionsReason reason = check_one(&out->detection[i], (float)width, (float)height);
        if (reason != DETECTIONS_GOOD) return reason;
        if (!terminated) return DETECTIONS_TEXT;
    }
    out->version = PITVIPER_DETECTIONS_VERSION;
    out->detection_size = sizeof *out->detection;
    return DETECTIONS_GOOD;
}

/* ---- answers.jsonl: a line per detection in the order of arrival, also one of an answer without any  */

typedef struct Answers {
    FILE *file;
    bool  failed; /* reported */
} Answers;

/* A line; box_px .. track: only with class_name. */
typedef struct AnswerLine {
    int         frame, answer, of;
    const char *band, *class_name; /* NULL: nothing was found */
    double      time_s;            /* exercise time */
    double      box_px[4], score;
    long long   track;      /* 0: none */
    double      latency_ms; /* NaN: not known */
    bool        late;
} AnswerLine;

static const void *found(const void *of) { return ((const AnswerLine *)of)->class_name ? of : NULL; }

#define OF_LINE(member)  FIELD_MEMBER(AnswerLine, member)
#define OF_FOUND(member) FIELD_IN(found, AnswerLine, member)

static const Field answer_rows[] = {
    {"frame", "", "from 0", "", "number of the frame that was answered", OF_LINE(frame)},
    {"band", "", "", "", "BAND that was answered", OF_LINE(band)},
    {"time_s", "s", "exercise time", "", "instant of that frame", OF_LINE(time_s)},
    {"answer", "", "from 1", "", "number of the detection among those of the answer; 0: it found nothing",
     OF_LINE(answer)},
    {"of", "", "", "", "detections of the answer: so many lines belong together", OF_LINE(of)},
    {"class", "", "", "when nothing was found", "the recogniser's own word, at most 31 characters",
     OF_LINE(class_name)},
    {"box_px", "px", "image: left, top, right, bottom; from 0, the last two beyond it", "when nothing was found",
     "bounding box", OF_FOUND(box_px)},
    {"score", "", "0 .. 1", "when nothing was found", "confidence", OF_FOUND(score)},
    {"track", "", "", "when the recogniser gave none", "the same number for the same object in later frames",
     OF_FOUND(track), .unless_0 = true},
    {"latency_ms", "ms", "", "", "from the end of the frame's rendering until the answer was received",
     OF_LINE(latency_ms), .as = field_ms},
    {"late", "", "", "", "a newer frame of the band was answered before: not in metadata", OF_LINE(late)},
};
const FieldTable answer_fields = {answer_rows, sizeof answer_rows / sizeof *answer_rows};

/* Creates the file in this folder. STATUS_IO, logged. */
static Status answers_open(Answers **out, const char *folder)
{
    char     path[4096];
    Answers *a = calloc(1, sizeof *a);
    if (!a) return STATUS_NO_MEMORY;
    const bool fits = snprintf(path, sizeof path, "%s/answers.jsonl", folder) < (int)sizeof path;
    if (!fits) errno = ENAMETOOLONG;
    a->file = fits ? output_file(path, 0) : NULL;
    if (a->file) {
        *out = a;
        return STATUS_OK;
    }
    log_error("detections: cannot write %s/answers.jsonl: %s; choose another place with --out", folder,
              output_reason(errno));
    free(a);
    return STATUS_IO;
}

/* Rounds a float to the decimal that its sender wrote, since the nearest double of the float shows further digits. */
static double digits(float value, double unit) { return round((double)value / unit) * unit; }

/* The lines of an answer, flushed. What cannot be written is counted, and reported once. */
static void answers_write(Answers *a, const PitviperDetections *answer, AnswerLine line, AnswerCounters *counters)
{
    const int lines = answer->count > 0 ? (int)answer->count : 1;
    bool      ok = true;
    line.frame = answer->frame, line.band = band_name((Band)answer->band), line.of = (int)answer->count;
    for (int i = 0; i < lines; i++) {
        const PitviperDetection *d = &answer->detection[i];
        const float              box[] = {d->left, d->top, d->right, d->bottom};
        for (int k = 0; k < 4; k++) line.box_px[k] = digits(box[k], 1e-4);
        line.answer = line.of > 0 ? i + 1 : 0;
        line.class_name = line.of > 0 ? d->class_name : NULL;
        line.score = digits(d->score, 1e-6);
        line.track = d->track;
        char *text = field_line(&answer_fields, &line, 12);
        ok = text && fprintf(a->file, "%s\n", text) > 0 && ok;
        free(text);
    }
    ok = fflush(a->file) == 0 && ok;
    counters->lines += ok ? (uint64_t)lines : 0;
    counters->lines_failed += ok ? 0 : (uint64_t)lines;
    if (!ok && !a->failed)
        log_warn("detections: cannot write answers.jsonl: %s; such lines are counted", strerror(errno));
    a->failed |= !ok;
    clearerr(a->file);
}

/* NULL is valid. */
static void answers_close(Answers *a)
{
    if (!a) return;
    if (fclose(a->file) != 0 && !a->failed) log_warn("detections: cannot write answers.jsonl: %s", strerror(errno));
    free(a);
}

/* ---- the receiver -------------------------------------------------------------------------------- */

typedef struct KnownFrame {
    int      frame;
    double   time_s, unix_s, rendered_s;
    unsigned answered; /* 1 << band */
} KnownFrame;

struct Detections {
    int             socket, stop; /* stop: an eventfd */
    int             port, width, height;
    unsigned        bands;
    Answers        *answers; /* NULL: no file; of the thread */
    bool            running;
    pthread_t       thread;
    pthread_mutex_t lock; /* of what follows */
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

/* Keeps a well-formed message. The lock must be held. */
static DetectionsReason keep(KnownFrame *of, Detections *d, const PitviperDetections *one)
{
    DetectionSet *set = &d->newest[one->band];
    KnownFrame   *frame = known(d, one->frame);
    if (!frame) return DETECTIONS_FRAME;
    if (frame->answered >> one->band & 1) return DETECTIONS_REPEATED;
    frame->answered |= 1u << one->band;
    *of = *frame;
    if (d->has[one->band] && frame->time_s < set->time_s) return DETECTIONS_LATE;
    set->frame = one->frame;
    set->band = (Band)one->band;
    set->time_s = frame->time_s;
    set->unix_s = frame->unix_s;
    set->received_s = wall_clock_s();
    set->count = (int)one->count;
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
    answers_write(answers, &one,
                  (AnswerLine){.time_s = frame.time_s,
                               .late = reason == DETECTIONS_LATE,
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
    Detections   *d = user;
    struct pollfd ready[2] = {{.fd = d->socket, .events = POLLIN}, {.fd = d->stop, .events = POLLIN}};
    for (;;) {
        const int count = poll(ready, 2, -1);
        if (count < 0 && errno != EINTR) return NULL;
        for (int i = 0; count > 0 && ready[0].revents && i < at_once && receive(d); i++) {
        }
        if (count <= 0 || !ready[1].revents) continue;
        for (int i = 0; i < at_the_end && receive(d); i++) {
        }
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
    const struct sockaddr_in own = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)d->port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const int room = 1 << 20; /* as far as the system allows */
    d->stop = eventfd(0, EFD_CLOEXEC);
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
    *d = (Detections){
        .socket = -1, .stop = -1, .port = of->port, .width = of->width, .height = of->height, .bands = of->bands};
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
    const Status status = answers_open(&answers, folder);
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
        snprintf(text + used, sizeof text - used, ", lost, since they came too fast, %llu",
                 (unsigned long long)c->lost_kernel);
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
    d->known_next = (d->known_next + 1) % detections_frames_kept;
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
    *c = (DetectionsConsumer){{.begin = begin, .put = put, .close = close_consumer}, detections, folder};
    *out = &c->consumer;
    return STATUS_OK;
}
