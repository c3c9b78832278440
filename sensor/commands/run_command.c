/* sensor/commands/run_command.c: `pitviper run`: receives, makes the choices, then renders frame after frame by the
 * clock. */
#include "sensor/commands/commands.h"
#include "pitviper_output.h"

#include "sensor/node/clock/live_clock.h"
#include "sensor/node/flight/node_flight.h"
#include "sensor/node/live/health.h"
#include "sensor/publish/consumers/consumer.h"
#include "sensor/publish/files/frame_files.h"
#include "sensor/node/run/host_run.h"
#include "sensor/node/live/live_recording.h"
#include "sensor/node/live/pace.h"
#include "sensor/node/live/ready.h"
#include "sensor/node/player/heard.h"
#include "sensor/node/player/player.h"
#include "sensor/commands/lockstep.h"
#include "sensor/commands/overwrite.h"
#include "sensor/publish/video/video_names.h"
#include "sensor/settings/config.h"
#include "sensor/node/run/stop.h"

#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <strings.h>
#include <unistd.h>

static const double  flush_s = 0.5, show_s = 1;
static const int64_t check_ns = 100000000; /* a signal may be delivered to another thread: polled at this interval */

typedef struct Live {
    Run            run;
    DisUdp        *udp;
    LiveRecording *recording;    /* NULL: none, or closed */
    bool           record_whole; /* it holds all received datagrams, and can be read again */
    char           where[dis_udp_where_size];
    LiveCounters   counters;
    Health         health;
    Ready          ready;
    HealthLosses   losses;
    double         health_s;                /* when it was last checked */
    char           host[dis_id_text_size];  /* at the end */
    char           to[run_network_to_size]; /* destination, for messages */
    Heard          heard;                   /* before the choices */
    LiveClock      clock;
    Lockstep       lockstep; /* with a CIGI host, in place of the clock */
    Player        *player;   /* once there is one */
    Session       *session;  /* likewise */
    /* wall clock, s */
    double   begun_s, flushed_s, shown_s;
    uint64_t shown_frames; /* frames kept by shown_s */
    Pace     pace;
    bool     host_there; /* in the last frame that was due */
    int64_t  due_ns;     /* Unix time of the present frame */
    double   latency_s;  /* the longest time from due_ns until a frame was rendered, since shown_s; NaN: none */
} Live;

/* Whether it is to send Data PDUs. */
static bool publishes(const Live *l) { return l->run.options.config.publish.dis != PUBLISH_DIS_OFF; }

/* ---- when to stop ------------------------------------------------------------------------------ */

static bool over(const Live *l) { return stop_asked() || wall_clock_s() - l->begun_s >= l->run.options.for_s; }

/* ---- what arrives ------------------------------------------------------------------------------ */

static void flush_recording(Live *l)
{
    const double now_s = wall_clock_s();
    if (!l->recording || now_s - l->flushed_s < flush_s) return;
    live_recording_flush(l->recording);
    l->flushed_s = now_s;
}

/* The exercise to join before the choices are made: as configured; -1: any. */
static int exercise_to_join(const Live *l)
{
    return l->player ? l->run.exercise : l->run.options.config.exercise.exercise;
}

/* Takes the next datagram of another sender that arrived until until_ns. False: there is none. */
static bool take(DisDatagram *out, Live *l, int64_t until_ns)
{
    DisArrival a;
    while (dis_udp_take(&a, l->udp, until_ns)) {
        /* what arrived between the opening of the socket and that of the recording */
        if (l->recording && a.capture_ns < live_recording_first_ns(l->recording)) continue;
        *out = (DisDatagram){.capture_s = dis_unix_s(a.capture_ns), .octets = a.octets, .bytes = a.bytes};
        out->packet_s = out->capture_s;
        if (player_own(out, &l->run.options.config)) {
            l->run.own++;
            health_own(&l->health, wall_clock_s());
            continue;
        }
        health_received(&l->health, out, exercise_to_join(l), !l->player, wall_clock_s());
        return true;
    }
    return false;
}

static void read_counters(Live *l)
{
    const DisUdpCounters c = dis_udp_counters(l->udp);
    l->counters.datagrams = c.datagrams;
    l->counters.lost_kernel = c.lost_kernel;
    l->counters.lost_queue = c.lost_queue;
    l->counters.sent = c.sent;
    l->counters.send_failed = c.send_failed;
    l->health.sample.error = c.send_error;
    l->health.sample.away = c.away;
}

static HealthNames names_of(const Live *l, const Session *session)
{
    const Config *config = &l->run.options.config;
    return (HealthNames){.where = l->where,
                         .to = l->to,
                         .exercise = exercise_to_join(l),
                         .site = config->node.site,
                         .application = config->node.application,
                         .host = session ? session_host(session) : config->exercise.host};
}

/* Reports changes of health, and the status line of a terminal; session: NULL before there is one. About ten times a
 * second. */
static void check_health(Live *l, const Session *session)
{
    char         line[health_line_size], left_out[latency_lost_size] = "";
    const double now_s = wall_clock_s();
    if (now_s - l->health_s < 1e-9 * (double)check_ns) return;
    l->health_s = now_s;
    read_counters(l);
    if (session) {
        l->health.sample.entities = session_entities(session);
        l->health.sample.over_rate = session_over_rate(session);
        const SessionReady ready = session_ready(session);
        ready_check(&l->ready, &ready, now_s);
        l->counters.ready_s = l->ready.first_s;
        l->health.sample.preparing = ready.waiting;
        health_losses(&l->losses, session_lost(left_out, session), left_out, now_s, false);
    }
    const HealthNames names = names_of(l, session);
    health_check(&l->health, &l->counters, &names, now_s);
    if (now_s - l->shown_s < show_s) return;
    const uint64_t   kept = l->health.sample.frames - l->counters.frames_lacking;
    const HealthPace pace = {.kept_hz = (double)(kept - l->shown_frames) / (now_s - l->shown_s),
                             .rate_hz = l->counters.rate_hz,
                             .step = pace_step_name(l->pace.step),
                             .latency_s = l->latency_s,
                             .left_out = left_out};
    health_line(line, &l->health, &pace);
    log_status(line);
    l->shown_frames = kept;
    l->shown_s = now_s;
    l->latency_s = NAN;
}

/* ---- listening --------------------------------------------------------------------------------- */

/* Collects the datagrams for the choices, by the rule of player_opening, as they arrive. heard: false when the node is
 * stopped before. */
static Status listen_first(bool *heard, Live *l)
{
    const Config *config = &l->run.options.config;
    int64_t       until_ns = INT64_MAX; /* not begun */
    DisDatagram   datagram;
    *heard = false;
    while (!over(l)) {
        const bool last = until_ns < INT64_MAX && dis_udp_now_ns() > until_ns;
        if (last) dis_udp_close_tick(l->udp, until_ns);
        while (take(&datagram, l, until_ns)) {
            const Status status = heard_add(&l->heard, &datagram);
            if (status != STATUS_OK) return status;
            if (until_ns < INT64_MAX) continue;
            if (player_starts(&l->run.first, &datagram, config)) {
                l->run.until_s = player_listens_until_s(&datagram, config);
                until_ns = dis_unix_ns_until(l->run.until_s);
                if (l->heard.count > player_opening_before + 1)
                    heard_drop(&l->heard, l->heard.count - player_opening_before - 1);
                l->ready.heard_s = l->ready.since_s = wall_clock_s();
                log_info("run: heard the first entity; listening for %g s (exercise.listen_s)",
                         config->exercise.listen_s);
                log_info(
                    "run: what stood or drove before is not known%s; for what stands at its first report, a time for "
                    "which it has stood there is drawn (heat.stood_min)",
                    *config->heat.marks ? " beyond heat.marks" : " (heat.marks)");
            } else if (l->heard.count >= 4 * player_opening_before) {
                heard_drop(&l->heard, l->heard.count - player_opening_before);
            }
        }
        if (last) {
            *heard = true;
            break;
        }
        flush_recording(l);
        check_health(l, NULL);
        const int64_t look = dis_udp_now_ns() + check_ns;
        dis_udp_wait(l->udp, until_ns < look ? until_ns + 1 : look);
    }
    l->run.view = (DisLog){.count = l->heard.count, .datagram = l->heard.datagram};
    return STATUS_OK;
}

/* ---- publishing -------------------------------------------------------------------------------- */

/* Counts every frame rendered, before it is sent. */
static void count_frame(void *user, const Frame *frame)
{
    Live *l = user;
    bool  lacks = false;
    l->latency_s = fmax(l->latency_s, 1e-9 * (double)(dis_udp_now_ns() - l->due_ns));
    for (int i = 0; i < frame->outputs; i++) lacks |= frame->output[i].left_out && frame->output[i].kind->noted;
    l->counters.frames_lacking += lacks;
    l->counters.frames_at[frame->request.sampling]++;
    health_frame(&l->health, &frame->record, wall_clock_s());
}

/* Writes a note into the recording. That one has no room for notes (.pcap) was said when it was opened. */
static void note(void *user, const char *text)
{
    const Live *l = user;
    live_recording_note(l->recording, dis_udp_now_ns(), text);
}

/* What a CIGI host says, into the recording. */
static void record_host(void *user, const uint8_t from[16], uint16_t port, const uint8_t *bytes, size_t octets)
{
    const Live *l = user;
    live_recording_add(l->recording, dis_udp_now_ns(), from, port, l->run.options.config.exercise.cigi_port, bytes,
                       octets);
}

static Status send_pdu(void *user, const uint8_t *pdu, size_t octets)
{
    const Live *l = user;
    return dis_udp_send(l->udp, pdu, octets);
}

/* ---- frame after frame ------------------------------------------------------------------------- */

static unsigned choose_quality(void *user, const FrameTime *frame)
{
    Live        *l = user;
    const double gone_s = 1e-9 * (double)(dis_udp_now_ns() - live_clock_due_ns(&l->clock, frame->t_s));
    return pace_choose(&l->pace, session_host(l->session), gone_s, wall_clock_s());
}

static Status feed(Live *l, int64_t until_ns)
{
    DisDatagram datagram;
    while (take(&datagram, l, until_ns)) {
        const Status status = player_add(l->player, &datagram, true);
        if (status != STATUS_OK) {
            log_error("run: out of memory for what was heard");
            return status;
        }
    }
    return STATUS_OK;
}

/* Receives while the clock waits for a frame. */
static Status receive(void *user, const FrameTime *next)
{
    Live *l = user;
    check_health(l, l->session);
    return feed(l, live_clock_due_ns(&l->clock, next->t_s));
}

static bool enough(void *user)
{
    const Live *l = user;
    const int   most = l->run.options.frames;
    return over(l) || session_flight_over(l->session) || (most && session_result(l->session)->frames >= most);
}

static Status make_frame(void *user, const FrameTime *frame)
{
    Live *l = user;
    bool  shown = false;
    l->due_ns = live_clock_due_ns(&l->clock, frame->t_s);
    dis_udp_close_tick(l->udp, l->due_ns);
    Status status = feed(l, l->due_ns);
    if (status == STATUS_OK) status = session_frame(&shown, l->session, frame);
    if (status == STATUS_OK && !shown) l->health.sample.missing++;
    if (l->host_there || shown) l->counters.frames_late += frame->dropped; /* without a host none was to be made */
    l->host_there = shown;
    flush_recording(l);
    check_health(l, l->session);
    pace_done(&l->pace, status == STATUS_OK && shown, wall_clock_s());
    return status;
}

/* Closes the recording with the remaining datagrams, and hashes it. */
static void conclude(Live *l)
{
    DisDatagram   datagram;
    const int64_t last_ns = dis_udp_now_ns();
    dis_udp_close_tick(l->udp, last_ns);
    while (take(&datagram, l, last_ns)) {
    }
    read_counters(l);
    if (!l->recording) return;
    const char *path = l->run.options.config.record.path;
    l->counters.record_failed = live_recording_failed(l->recording);
    l->record_whole = live_recording_close(l->recording) == STATUS_OK && l->counters.record_failed == 0;
    l->recording = NULL;
    if (!l->record_whole) {
        log_error("run: the recording %s ends early: %llu datagrams and more are not in it", path,
                  (unsigned long long)l->counters.record_failed);
    } else if (sha256_file(l->run.log_sha256, path) != STATUS_OK) {
        log_error("run: the recording %s cannot be read again, and run.json does not name it by its hash", path);
        l->record_whole = false;
    }
}

static Status live_frames(Run *run, Session *session, Player *player, const HostPlan *plan, const FrameGrid *grid)
{
    Live         *l = run->user;
    const Config *config = &run->options.config;
    const double  given_s = config_span_time_s(config->exercise.from_s, plan->start_s, NAN); /* NaN: none */
    l->clock.grid = *grid;
    l->clock.first = fmax(ceil(fmax(plan->start_s, given_s) * grid->rate_hz - 1e-9) - grid->origin, 0);
    l->clock.to_s = config_span_time_s(config->exercise.to_s, plan->start_s, NAN);
    l->clock.player = l->player = player;
    l->session = session;
    l->counters.rate_hz = grid->rate_hz;
    l->pace = pace_begin(config, grid->rate_hz);
    health_rendering(&l->health, wall_clock_s());
    l->health.sample.host = plan->any_munition                  ? HEALTH_MUNITION
                            : dis_entity_id_is_none(plan->host) ? HEALTH_OBSERVER
                                                                : HEALTH_BY_ID;
    lockstep_span(&l->lockstep, run, fmax(plan->start_s, given_s), l->clock.to_s);
    const Status status = frame_loop(NULL, &(FrameLoop){run->clock, enough, receive, make_frame, l});
    /* and those that were due while the last one was made */
    if (status == STATUS_OK && over(l) && l->host_there) l->counters.frames_late += live_clock_behind(&l->clock);
    char left_out[latency_lost_size];
    log_status(NULL);
    health_losses(&l->losses, session_lost(left_out, session), left_out, wall_clock_s(), true);
    snprintf(l->host, sizeof l->host, "%s", session_host(session));
    l->health.sample.entities = session_entities(session);
    conclude(l);
    run->stopped = stop_asked();
    return status;
}

/* ---- the command ------------------------------------------------------------------------------- */

static Status open_network(Live *l)
{
    Config      *config = &l->run.options.config;
    DisUdpConfig udp;
    if (config->exercise.port == dis_port_any) {
        log_error("run: exercise.port: 0 is any port, for a recording; a node listens on one, 1 .. 65535");
        return STATUS_BAD_VALUE;
    }
    udp = run_network(config);
    dis_udp_where(l->where, &udp);
    run_network_to(l->to, &udp);
    return dis_udp_open(&l->udp, &udp);
}

/* Opens folder, videos and recording, when everything else is known to be right. */
static Status open_files(Live *l)
{
    const Options *o = &l->run.options;
    const Config  *config = &o->config;
    char           comment[dis_udp_where_size + 40];
    Status         status = STATUS_OK;
    if (*config->record.path) status = overwrite_file("run", config->record.path, o->overwrite);
    if (status == STATUS_OK) status = overwrite_folder("run", o->out, o->overwrite);
    if (status == STATUS_OK) status = overwrite_video("run", config, l->run.bands, NULL, o->overwrite);
    if (status != STATUS_OK || !*config->record.path) return status;
    snprintf(comment, sizeof comment, "pitviper run: %s", l->where);
    const bool radar = strcmp(config->radar.preset, "none") != 0, less = radar || config->quality.deadline;
    if (*config->exercise.cigi && strcasecmp(output_ending(config->record.path), ".pcap") == 0)
        log_warn(
            "run: exercise.cigi: %s has no room for when the host's frames are (pcap): no replay has them; name it "
            ".pcapng",
            config->record.path);
    if (strcasecmp(output_ending(config->record.path), ".pcap") == 0)
        log_warn("run: %s has no room for %s%s%swhat the ground was made from (pcap): a replay makes that by the whole "
                 "recording%s; name it .pcapng",
                 config->record.path, less ? "which frames give up sampling (quality.deadline)" : "",
                 radar ? ", or are without radar" : "", less ? ", and for " : "",
                 less ? ", and has frames in all" : "");
    if (strcasecmp(output_ending(config->record.path), ".pcap") == 0 && node_flight_asked(config))
        log_warn(
            "run: %s has no room for how the missile flies (pcap), and no replay will fly it again; name it .pcapng",
            config->record.path);
    lockstep_record(&l->lockstep, &(CigiTap){record_host, note, l});
    return live_recording_open(&l->recording, config->record.path, comment, l->udp, run_network(config).port);
}

/* Whether there was nothing to render so far, and nothing is wrong. */
static bool idle(HealthReason reason)
{
    return reason == HEALTH_NOTHING || reason == HEALTH_NO_ENTITY || reason == HEALTH_NO_MUNITION ||
           reason == HEALTH_EARLY;
}

/* A run fails when one kind of result that was asked for is missing altogether: frames, files, or PDUs. A run that is
 * stopped while it waits does not fail. */
static Status verdict(Live *l)
{
    HealthSample *s = &l->health.sample;
    char          text[health_text_size];
    HealthNames   names = names_of(l, NULL);
    if (*l->host) names.host = l->host;
    s->now_s = wall_clock_s();
    if (s->frames == 0) {
        const HealthReason reason = health_final(s);
        health_text(text, reason, s, &names);
        if (stop_asked() && idle(reason)) {
            log_info("run: stopped before the first frame, while it waited: %s", health_name(reason));
            return STATUS_OK;
        }
        log_error("run: ended before the first frame: %s", text);
        return STATUS_IO;
    }
    if (s->publishes && l->counters.sent == 0 && l->counters.send_failed > 0) {
        health_text(text, HEALTH_NOT_SENT, s, &names);
        log_error("run: %s", text);
        return STATUS_IO;
    }
    if (l->run.options.config.publish.files && l->counters.files_failed + l->counters.files_left_out >= s->frames) {
        log_error("run: none of %llu frames has its files in %s; see above", (unsigned long long)s->frames,
                  l->run.options.out);
        return STATUS_IO;
    }
    return STATUS_OK;
}

static Status run_node(Live *l)
{
    bool           heard;
    const Options *o = &l->run.options;
    Status         status = run_measure_machine(&l->run);
    if (status == STATUS_OK) status = run_prepare(&l->run);
    if (status == STATUS_OK) status = open_network(l);
    if (status == STATUS_OK) status = lockstep_begin(&l->lockstep, &l->run, &l->clock);
    /* now, not hours later when the first entity is received; the socket first: an older recording must not be lost for
     * nothing */
    if (status == STATUS_OK) status = open_files(l);
    if (status != STATUS_OK) return status;
    l->begun_s = l->shown_s = wall_clock_s();
    health_begin(&l->health, l->begun_s);
    l->health.sample.publishes = publishes(l);
    log_info("run: listening on %s; Ctrl-C ends it", l->where);
    video_watch_print(&o->config, l->run.bands);
    status = listen_first(&heard, l);
    log_status(NULL);
    if (status == STATUS_OK && heard) {
        status = run_survey(&l->run, &l->run.view, &l->run.view);
        if (status == STATUS_OK) status = run_host(&l->run, NULL);
    } else {
        conclude(l);
        l->run.stopped = stop_asked();
        if (status == STATUS_OK) status = run_unheard(&l->run);
    }
    health_summary(&l->counters, &l->health.sample, l->run.own);
    pace_summary(&l->counters);
    return status == STATUS_OK ? verdict(l) : status;
}

int run_command(int argc, char **argv)
{
    Live      live = {.run = {.frames = live_frames, .log_name = "live"}, .clock = live_clock()};
    Live     *l = &live;
    char      name[sizeof l->run.options.config.record.path];
    const int stop = options_parse(&l->run.options, COMMAND_RUN, argc, argv);
    if (stop) return stop - 1;
    l->run.options.config.exercise.causal = true;
    l->run.live = &l->counters;
    l->run.user = l;
    l->run.publish = count_frame;
    if (l->run.options.config.quality.deadline && !*l->run.options.config.exercise.cigi) l->run.choose = choose_quality;
    if (publishes(l)) l->run.send = send_pdu;
    l->run.report = send_pdu;
    if (*l->run.options.config.record.path) l->run.note = note;
    l->run.clock = &l->clock.clock;
    memcpy(name, l->run.options.config.record.path, sizeof name);
    if (*name) l->run.log_name = basename(name);
    l->latency_s = NAN;

    stop_by_signals();
    thread_flush_denormals();
    const Status status = run_node(l);
    if (publish_hangs()) { /* a thread of it never returns, and uses what would be freed */
        fflush(stdout);
        _exit(1);
    }
    live_recording_close(l->recording);
    dis_udp_close(l->udp);
    run_close(&l->run);
    lockstep_end(&l->lockstep);
    heard_free(&l->heard);
    return status == STATUS_OK && (!*name || l->record_whole) ? 0 : 1;
}
