/* sensor/node/session/session_consumers.c: the consumers of a session's frames, from the configuration. */
#include "sensor/node/session/session_private.h"

#include "sensor/publish/memory/consume_memory.h"
#include "sensor/publish/projector/consume_projector.h"
#include "sensor/publish/consumers/consume_pairs.h"
#include "sensor/publish/video/consume_video.h"
#include "sensor/instruments/radar.h"

/* Adds displays, if a consumer of the other list wants them. */
static Status add_displays(Consumers *list, Session *s, Pool *pool, unsigned wants)
{
    const SessionShared *shared = s->shared;
    Consumer            *consumer = NULL;
    if (!(wants & (WANT_DISPLAY | WANT_COUNTS))) return STATUS_OK;
    const Status status =
        consume_displays(&consumer, shared->config, shared->sensors, pool, (wants & WANT_COUNTS) != 0);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_pictures(Consumers *list, Session *s, Pool *pool)
{
    Consumer    *consumer = NULL;
    const Status status = consume_pictures(
        &consumer,
        &(PictureFiles){.out = s->out, .config = s->shared->config, .pool = pool, .patient = s->shared->live});
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_radar(Consumers *list, Session *s, Pool *pool)
{
    Consumer *consumer = NULL;
    if (!instruments_find(&s->instruments, &radar_kind)) return STATUS_OK;
    const Status status = consume_radar(
        &consumer,
        &(PictureFiles){.out = s->out, .config = s->shared->config, .pool = pool, .patient = s->shared->live});
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_latest(Consumers *list, Session *s)
{
    Consumer    *consumer = NULL;
    const Status status = consume_latest(&consumer, s->out, s->shared->live);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

/* The geoid, for heights above mean sea level in metadata; NULL: there is none. */
static const Geoid *geoid_of(Session *s)
{
    if (!s->geoid.n_m) klv_geoid_open(&s->geoid, s->shared->config);
    return s->geoid.n_m ? &s->geoid : NULL;
}

/* to: those of the configured outputs, VideoTo. patient: a failure ends nothing. */
static Status add_video(Consumers *list, Session *s, unsigned to, bool patient)
{
    const SessionShared *shared = s->shared;
    const char          *slash = strrchr(s->out, '/');
    if (!(to & video_wanted(shared->config))) return STATUS_OK;
    const VideoOf of = {.config = shared->config,
                        .to = to,
                        .bands = shared->bands,
                        .rate_hz = s->plan.rate_hz,
                        .patient = patient,
                        .geoid = geoid_of(s),
                        .answers = s->answers,
                        .sent = &s->result.sent.stream,
                        .apart = shared->live,
                        .latency = s->latency,
                        .host_folder = !shared->several ? NULL
                                       : slash          ? slash + 1
                                                        : s->out};
    Consumer     *consumer = NULL;
    const Status  status = consume_video(&consumer, &of);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_pairs(Consumers *list, Session *s, Pool *pool, unsigned raw)
{
    const SessionShared *shared = s->shared;
    const PairsOf        of = {.out = s->out,
                               .config = shared->config,
                               .config_sha256 = shared->config_sha256,
                               .pool = pool,
                               .sensors = shared->sensors,
                               .bands = shared->bands,
                               .raw = raw};
    Consumer            *consumer = NULL;
    const Status         status = consume_pairs(&consumer, &of);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_truth_lines(Consumers *list, Session *s)
{
    Consumer *consumer = NULL;
    if (!s->shared->config->publish.truth) return STATUS_OK;
    const Status status = consume_truth_lines(&consumer, s->out, s->shared->live, &s->lines_failed);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_hashes(Consumers *list, Session *s, FrameDone *done)
{
    Consumer    *consumer = NULL;
    const Status status = consume_hashes(&consumer, done, s, s->shared->config->publish.truth);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_coco(Consumers *list, Session *s)
{
    Consumer    *consumer = NULL;
    const Status status = consume_coco(&consumer, s->out, s->shared->config, s->shared->config_sha256);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_klv(Consumers *list, Session *s)
{
    const KlvFiles of = {.out = s->out,
                         .config = s->shared->config,
                         .bands = s->shared->bands,
                         .patient = s->shared->live,
                         .geoid = geoid_of(s),
                         .answers = s->answers};
    Consumer      *consumer = NULL;
    const Status   status = consume_klv(&consumer, &of);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static Status add_call(Consumers *list, const SessionShared *shared)
{
    Consumer    *consumer = NULL;
    const Status status = consume_by_call(&consumer, shared->publish, shared->user, shared->config->publish.truth);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

/* Adds the consumers of a recogniser's answers: answers.jsonl, and metadata. */
static Status add_answers(Consumers *list, Session *s)
{
    const Config *config = s->shared->config;
    Consumer     *consumer = NULL;
    if (!config->publish.detections_port) return STATUS_OK;
    const AnswersOf of = {config->publish.detections_port,
                          {s->shared->bands, config->sensor.width_px, config->sensor.height_px}};
    Status          status = answers_open(&s->answers, &of);
    if (status == STATUS_OK && s->shared->flight) answers_watch(s->answers, loop_sights_taken, s->shared->flight);
    if (status == STATUS_OK) status = consume_answers(&consumer, s->answers, s->out);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

/* Adds shared memory. It never waits, so it comes before all other consumers; with raw counts it comes after the
 * displays, which make these. */
static Status add_memory(Consumers *list, Session *s, bool behind_displays)
{
    const SessionShared *shared = s->shared;
    const Config        *config = shared->config;
    Consumer            *consumer = NULL;
    const bool           counts = config->publish.memory_planes == MEMORY_PLANES_COUNTS;
    if (!*config->publish.memory || counts != behind_displays) return STATUS_OK;
    MemoryOf      of = {.config = config,
                        .config_sha256 = shared->config_sha256,
                        .bands = shared->bands,
                        .unnamed = &s->result.sent.frames_unnamed,
                        .host = shared->several ? s->host_text : NULL};
    const Camera *camera = camera_of(&s->instruments);
    for (int b = 0; b < BAND_COUNT && camera; b++)
        if (camera->chain[b]) of.count_bits[b] = (int)lround(log2(chain_full(camera->chain[b]) + 1));
    const Status status = consume_memory(&consumer, &of);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

/* Adds the window on a display, behind the displays' images. It takes a frame at once, or as long as the settings
 * say. */
static Status add_projector(Consumers *list, Session *s)
{
    const Config *config = s->shared->config;
    const Camera *camera = camera_of(&s->instruments);
    Consumer     *consumer = NULL;
    if (!*config->projector.band) return STATUS_OK;
    ProjectorOf of = {.config = config,
                      .live = s->shared->live,
                      .bands = s->shared->bands,
                      .latency = s->latency,
                      .counters = &s->result.sent.projector};
    for (int b = 0; b < BAND_COUNT && camera; b++)
        if (camera->chain[b]) of.count_bits[b] = (int)lround(log2(chain_full(camera->chain[b]) + 1));
    const Status status = consume_projector(&consumer, &of);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

static double arrival_s(const void *player, double t_s) { return player_arrival_s(player, t_s); }

static Status add_dis(Consumers *list, const Session *s)
{
    Consumer *consumer = NULL;
    DisOf     of = *s->shared->dis;
    of.arrival_s = arrival_s;
    of.clock = s->player;
    const Status status = consume_dis(&consumer, &of);
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

/* Puts consumers behind a queue, into a list. */
static Status add_queue(Consumers *list, Session *s, Consumers *behind, const QueueOf *of)
{
    Consumer *consumer = NULL;
    if (behind->count == 0) return STATUS_OK;
    consumers_expect(behind, s->latency);
    const Status status = consumer_queue_open(&consumer, behind, of);
    if (status == STATUS_OK) s->queued += of->waiting + 1;
    return status == STATUS_OK ? consumers_add(list, consumer) : status;
}

/* Takes over all consumers of the other list, which is empty then. */
static Status add_all(Consumers *list, Consumers *others)
{
    Status status = STATUS_OK;
    for (int i = 0; i < others->count; i++) {
        const Status one = consumers_add(list, others->consumer[i]);
        if (status == STATUS_OK) status = one;
    }
    others->count = 0;
    return status;
}

/* What is needed beyond what consumers state: a frame file is of all planes; so are image files of truth. */
static unsigned further_wants(const Session *s)
{
    const Config *config = s->shared->config;
    return s->shared->save_count > 0 || (config->publish.files && frame_files_truth(config)) ? WANT_PLANES : 0;
}

/* ---- what a session's frames go to -------------------------------------------------------------- */

/* Files of a replay: nothing is dropped, a slow disk delays it. A stream by the clock is not among them. */
static Status replay_files(Consumers *list, Session *s, FrameDone *done, Pool *pool, unsigned raw)
{
    const Config *config = s->shared->config;
    Status        status = config->publish.files ? add_pictures(list, s, pool) : STATUS_OK;
    if (status == STATUS_OK && config->publish.files) status = add_radar(list, s, pool);
    if (status == STATUS_OK && config->publish.latest) status = add_latest(list, s);
    if (status == STATUS_OK)
        status = add_video(list, s, clock_on_wall(s->shared->clock) ? VIDEO_TO_FILE : VIDEO_TO_FILE | VIDEO_TO_STREAM,
                           false);
    if (status == STATUS_OK) status = add_truth_lines(list, s);
    if (status == STATUS_OK && config->publish.coco) status = add_coco(list, s);
    if (status == STATUS_OK && config->publish.klv_files) status = add_klv(list, s);
    if (status == STATUS_OK && config->publish.pairs != PUBLISH_PAIRS_OFF) status = add_pairs(list, s, pool, raw);
    return status == STATUS_OK ? add_hashes(list, s, done) : status;
}

/* With more than one thread a frame is published while the next is rendered; a peer that waits for it has it first. */
static Status for_replay(Session *s, FrameDone *done, unsigned raw)
{
    const int  threads = pool_threads(s->shared->pool);
    const bool behind = threads > 1 && !s->shared->cigi;
    Consumers  first = {0}, files = {0}, all = {0};
    Status     status = behind ? pool_create(&s->publish_pool, threads) : STATUS_OK;
    Pool      *pool = behind ? s->publish_pool : s->shared->pool;
    if (status == STATUS_OK) status = add_memory(&first, s, true);
    if (status == STATUS_OK) status = add_projector(&first, s);
    if (status == STATUS_OK) status = replay_files(&files, s, done, pool, raw);
    if (status == STATUS_OK) status = add_displays(&all, s, pool, consumers_wants(&first) | consumers_wants(&files));
    if (status == STATUS_OK) status = add_all(&all, &first);
    if (status == STATUS_OK) status = add_all(&all, &files);
    if (status == STATUS_OK)
        status = behind ? add_queue(&s->consumers, s, &all, &(QueueOf){.rule = QUEUE_WAIT, .waiting = 1})
                        : add_all(&s->consumers, &all);
    if (status != STATUS_OK) consumers_close(&first);
    if (status != STATUS_OK) consumers_close(&files);
    if (status != STATUS_OK) consumers_close(&all);
    return status;
}

/* A live node's files: each consumer has a thread of its own, so that one whose disk is late loses its own frames and
 * no other's. */
typedef struct LiveFile {
    Status (*add)(Consumers *list, Session *s);
    bool        wanted;
    int         waiting; /* frames */
    const char *what;
} LiveFile;

static Status add_live_pictures(Consumers *list, Session *s) { return add_pictures(list, s, s->publish_pool); }
static Status add_live_radar(Consumers *list, Session *s) { return add_radar(list, s, s->publish_pool); }

/* Adds them to a list. further_wants: what they want is added to it. */
static Status live_files(Consumers *list, Session *s, unsigned *further)
{
    enum { kinds = 5 };
    const Config  *config = s->shared->config;
    const LiveFile kind[kinds] = {{add_truth_lines, config->publish.truth, queue_waiting_most, "truth.jsonl"},
                                  {add_live_pictures, config->publish.files, 1, "image files"},
                                  {add_live_radar, config->publish.files, 1, "files of the radar"},
                                  {add_latest, config->publish.latest, 1, "latest pictures"},
                                  {add_klv, config->publish.klv_files, 1, "files of metadata"}};
    Status         status = STATUS_OK;
    _Static_assert(kinds == sizeof s->written / sizeof *s->written, "counters of each");
    for (int k = 0; k < kinds && status == STATUS_OK; k++) {
        Consumers one = {0};
        if (kind[k].wanted) status = kind[k].add(&one, s);
        *further |= consumers_wants(&one);
        const QueueOf of = {.rule = QUEUE_LEAVE_OUT,
                            .disk = true,
                            .waiting = kind[k].waiting,
                            .what = kind[k].what,
                            .counters = &s->written[k]};
        if (status == STATUS_OK) status = add_queue(list, s, &one, &of);
        if (status != STATUS_OK) consumers_close(&one);
    }
    return status;
}

/* A live node: what is shown and sent is sent at once or left out, before all else; hashes are taken in a thread of
 * their own, and files are written in those of live_files, which get the frame from that one. */
static Status for_live(Session *s, FrameDone *done)
{
    Consumers first = {0}, sent = {0}, behind = {0};
    unsigned  wants = 0;
    Status    status = pool_create(&s->publish_pool, 1);
    if (status == STATUS_OK) status = add_memory(&first, s, true);
    if (status == STATUS_OK) status = add_projector(&first, s);
    if (status == STATUS_OK) status = add_hashes(&behind, s, done);
    if (status == STATUS_OK) status = live_files(&behind, s, &wants);
    if (status == STATUS_OK) status = add_video(&sent, s, VIDEO_TO_FILE | VIDEO_TO_STREAM, true);
    wants |= consumers_wants(&first) | consumers_wants(&sent);
    if (status == STATUS_OK) status = add_displays(&s->consumers, s, s->shared->pool, wants);
    const QueueOf video = {.rule = QUEUE_LEAVE_OUT, .waiting = 1, .urgent = true, .what = "video"};
    const QueueOf all = {.rule = QUEUE_WAIT, .waiting = 1};
    if (status == STATUS_OK) status = add_queue(&s->consumers, s, &sent, &video); /* before the hashes */
    if (status == STATUS_OK) status = add_all(&s->consumers, &first);
    if (status == STATUS_OK && s->shared->dis) status = add_dis(&s->consumers, s);
    if (status == STATUS_OK) status = add_queue(&s->consumers, s, &behind, &all);
    if (status != STATUS_OK) consumers_close(&behind);
    if (status != STATUS_OK) consumers_close(&sent);
    if (status != STATUS_OK) consumers_close(&first);
    return status;
}

/* A replay by the clock: what is sent is sent at once or left out, and never delays rendering; its files delay it. */
static Status by_the_clock(Session *s, FrameDone *done, unsigned raw)
{
    Consumers first = {0}, files = {0}, sent = {0};
    Status    status = pool_create(&s->publish_pool, pool_threads(s->shared->pool));
    if (status == STATUS_OK) status = add_memory(&first, s, true);
    if (status == STATUS_OK) status = add_projector(&first, s);
    if (status == STATUS_OK) status = replay_files(&files, s, done, s->publish_pool, raw);
    if (status == STATUS_OK) status = add_video(&sent, s, VIDEO_TO_STREAM, true);
    const unsigned wants = consumers_wants(&first) | consumers_wants(&sent) | consumers_wants(&files);
    if (status == STATUS_OK) status = add_displays(&s->consumers, s, s->shared->pool, wants);
    const QueueOf video = {.rule = QUEUE_LEAVE_OUT, .waiting = 1, .urgent = true, .what = "video"};
    const QueueOf all = {.rule = QUEUE_WAIT, .waiting = 1};
    if (status == STATUS_OK) status = add_queue(&s->consumers, s, &sent, &video);
    if (status == STATUS_OK) status = add_all(&s->consumers, &first);
    if (status == STATUS_OK) status = add_queue(&s->consumers, s, &files, &all);
    if (status != STATUS_OK) consumers_close(&files);
    if (status != STATUS_OK) consumers_close(&sent);
    if (status != STATUS_OK) consumers_close(&first);
    return status;
}

/* Removes the videos of an earlier run in this run's folder, also of bands that this run lacks. */
static void clear_videos(const Session *s)
{
    const char  *folder = s->shared->config->publish.video;
    const size_t length = strlen(s->out);
    char         earlier[frame_path_size];
    if (video_kind(folder) == VIDEO_FOLDER && strncmp(folder, s->out, length) == 0 && folder[length] == '/' &&
        frame_files_earlier(earlier, s->out))
        frame_files_clear_videos(folder);
}

Status session_begin_files(Session *s)
{
    const Config  *config = s->shared->config;
    const unsigned kept = s->shared->bands | (frame_files_truth(config) ? frame_truth : 0);
    if (s->result.begun) return STATUS_OK;
    s->result.begun = true;
    clear_videos(s);
    Status status = frame_files_prepare(s->out, config->publish.files ? kept : 0, s->raw);
    return status == STATUS_OK ? consumers_begin(&s->consumers) : status;
}

Status session_consumers(Session *s, FrameDone *done)
{
    const SessionShared *shared = s->shared;
    const Config        *config = shared->config;
    const Camera        *camera = camera_of(&s->instruments);
    unsigned             raw = 0;
    for (int b = 0; b < BAND_COUNT && camera; b++)
        if (camera->chain[b] && config->detector.raw && config->publish.files) raw |= 1u << b;
    s->raw = raw;
    Status status = clock_on_wall(shared->clock) ? latency_create(&s->latency) : STATUS_OK;
    if (status == STATUS_OK) status = add_answers(&s->consumers, s); /* before a frame can be answered */
    if (status == STATUS_OK) status = add_memory(&s->consumers, s, false);
    if (status == STATUS_OK && shared->publish) status = add_call(&s->consumers, shared);
    if (status == STATUS_OK && shared->dis && !shared->live) status = add_dis(&s->consumers, s); /* before the disk */
    if (status == STATUS_OK && shared->live) status = for_live(s, done);
    else if (status == STATUS_OK)
        status = clock_on_wall(shared->clock) ? by_the_clock(s, done, raw) : for_replay(s, done, raw);
    consumers_expect(&s->consumers, s->latency);
    s->wants = consumers_wants(&s->consumers) | further_wants(s);
    /* the frame being rendered, and of each queue the frames that wait and the one being published */
    return status == STATUS_OK ? frame_pool_create(&s->frames, 1 + s->queued) : status;
}
