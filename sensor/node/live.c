/* sensor/node/live.c: listen, choose, then one frame after the other by the clock. */
#include "sensor/node/live.h"

#include "dis/exercise_clock.h"
#include "dis/udp.h"
#include "sensor/bench/quality.h"
#include "sensor/node/frame_files.h"
#include "sensor/node/host_run.h"
#include "sensor/node/live_recording.h"
#include "sensor/node/opening.h"
#include "sensor/node/quality.h"
#include "sensor/node/stop.h"
#include "sensor/publish/dis_records.h"

#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static const double  silent_s = 10, remind_s = 60, flush_s = 0.5, show_s = 0.5;
static const int64_t look_ns = 100000000; /* a signal may come to another thread: looked for so often */

typedef struct Live {
    Run          run;
    DisUdp      *udp;
    LiveRecording *recording;       /* NULL: none, or closed */
    bool         record_whole;      /* all that was heard is in it */
    char         where[dis_udp_where_size];
    LiveCounters counters;
    /* what was heard before the choices, each datagram its own memory */
    DisDatagram *heard;
    int          heard_count, heard_capacity;
    DisHeader    first;             /* of the first usable Entity State */
    const Player *player;           /* once there is one */
    /* wall clock, s */
    double       begun_s, heard_s, flushed_s, shown_s, late_said_s, lost_said_s;
    bool         silence_said;
    uint64_t     late_said, lost_said;
    double       rate_from_s;       /* of the rate that is shown */
    int          rate_from;
} Live;

/* ---- when to stop ------------------------------------------------------------------------------ */

static bool over(const Live *l)
{
    return stop_asked() || wall_clock_s() - l->begun_s >= l->run.options.for_s;
}

/* ---- what arrives ------------------------------------------------------------------------------ */

static void flush_recording(Live *l)
{
    const double now_s = wall_clock_s();
    if (!l->recording || now_s - l->flushed_s < flush_s) return;
    live_recording_flush(l->recording);
    l->flushed_s = now_s;
}

/* The next datagram of somebody else, not after until_ns. */
static bool take(DisDatagram *out, Live *l, int64_t until_ns)
{
    DisArrival a;
    while (dis_udp_take(&a, l->udp, until_ns)) {
        *out = (DisDatagram){.capture_s = dis_unix_s(a.capture_ns), .octets = a.octets, .bytes = a.bytes};
        out->packet_s = out->capture_s;
        if (opening_own(out, &l->run.options.config)) {
            l->run.own++;
            continue;
        }
        l->heard_s      = wall_clock_s();
        l->silence_said = false;
        return true;
    }
    return false;
}

static uint64_t lost(const LiveCounters *c) { return c->lost_kernel + c->lost_queue; }

static void read_counters(Live *l)
{
    const DisUdpCounters c = dis_udp_counters(l->udp);
    l->counters.datagrams   = c.datagrams;
    l->counters.lost_kernel = c.lost_kernel;
    l->counters.lost_queue  = c.lost_queue;
    l->counters.sent        = c.sent;
    l->counters.send_failed = c.send_failed;
}

/* Each thing once, then a minute of silence about it. */
static void say_troubles(Live *l)
{
    const double now_s = wall_clock_s();
    read_counters(l);
    if (!l->silence_said && now_s - l->heard_s >= silent_s) {
        log_warn("run: nothing heard on %s for %.0f s; going on. `pitviper record --for 5 -o heard.pcapng` shows "
                 "what comes at all; --port, --address and --interface say where", l->where, silent_s);
        l->silence_said = true;
    }
    if (lost(&l->counters) > l->lost_said && now_s - l->lost_said_s >= remind_s) {
        log_warn("run: datagrams lost: in the kernel %llu, in the queue %llu; a larger network.queue_mb or "
                 "net.core.rmem_max, or a higher sensor.rate_hz, helps", (unsigned long long)l->counters.lost_kernel,
                 (unsigned long long)l->counters.lost_queue);
        l->lost_said   = lost(&l->counters);
        l->lost_said_s = now_s;
    }
    if (l->counters.frames_late > l->late_said && now_s - l->late_said_s >= remind_s) {
        log_warn("run: frames left out: %llu, their time had passed; a smaller --size, fewer --bands or a lower --rate "
                 "helps",
                 (unsigned long long)l->counters.frames_late);
        l->late_said   = l->counters.frames_late;
        l->late_said_s = now_s;
    }
}

/* ---- listening --------------------------------------------------------------------------------- */

static void forget_heard(Live *l, int count)
{
    for (int i = 0; i < count; i++) free((void *)(uintptr_t)l->heard[i].bytes);
    l->heard_count -= count;
    memmove(l->heard, l->heard + count, (size_t)l->heard_count * sizeof *l->heard);
}

static Status keep_heard(Live *l, const DisDatagram *datagram)
{
    if (l->heard_count == l->heard_capacity) {
        const int    larger = l->heard_capacity ? 2 * l->heard_capacity : 4 * opening_before;
        DisDatagram *grown  = realloc(l->heard, (size_t)larger * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        l->heard          = grown;
        l->heard_capacity = larger;
    }
    uint8_t *bytes = malloc(datagram->octets + 1);
    if (!bytes) return STATUS_NO_MEMORY;
    memcpy(bytes, datagram->bytes, datagram->octets);
    l->heard[l->heard_count]         = *datagram;
    l->heard[l->heard_count++].bytes = bytes;
    return STATUS_OK;
}

/* What the choices are made from: the rule of opening.h, as it comes. heard: false when told to stop before. */
static Status listen_first(bool *heard, Live *l)
{
    const Config *config   = &l->run.options.config;
    int64_t       until_ns = INT64_MAX; /* not begun */
    DisDatagram   datagram;
    *heard = false;
    while (!over(l)) {
        const bool last = until_ns < INT64_MAX && dis_udp_now_ns() > until_ns;
        if (last) dis_udp_close_tick(l->udp, until_ns);
        while (take(&datagram, l, until_ns)) {
            const Status status = keep_heard(l, &datagram);
            if (status != STATUS_OK) return status;
            if (until_ns < INT64_MAX) continue;
            if (opening_starts(&l->first, &datagram, config)) {
                l->run.until_s = opening_until_s(&datagram, config);
                until_ns       = dis_unix_ns_until(l->run.until_s);
                if (l->heard_count > opening_before + 1) forget_heard(l, l->heard_count - opening_before - 1);
                log_info("run: heard the first entity; listening for %g s (exercise.listen_s)",
                         config->exercise.listen_s);
            } else if (l->heard_count >= 4 * opening_before) {
                forget_heard(l, l->heard_count - opening_before);
            }
        }
        if (last) {
            *heard = true;
            break;
        }
        flush_recording(l);
        say_troubles(l);
        const int64_t look = dis_udp_now_ns() + look_ns;
        dis_udp_wait(l->udp, until_ns < look ? until_ns + 1 : look);
    }
    l->run.view = (DisLog){.count = l->heard_count, .datagram = l->heard};
    return STATUS_OK;
}

/* ---- publishing -------------------------------------------------------------------------------- */

static void publish_frame(void *user, const FrameRecord *frame)
{
    Live         *l      = user;
    const Config *config = &l->run.options.config;
    uint8_t       pdu[dis_smallest_mtu];
    const bool    truth = strcmp(config->publish.dis, "truth") == 0;
    const DisRecordSender sender = {.version = l->first.version,
                                    .exercise = (uint8_t)(l->run.exercise >= 0 ? l->run.exercise : l->first.exercise),
                                    .site = (uint16_t)config->node.site,
                                    .application = (uint16_t)config->node.application,
                                    .timestamp = dis_timestamp(player_arrival_s(l->player, frame->time_s), false)};
    for (int b = 0; b < BAND_COUNT; b++)
        if (l->run.bands >> b & 1) dis_udp_send(l->udp, pdu, dis_record_frame(pdu, &sender, frame, (Band)b, truth));
}

/* ---- frame after frame ------------------------------------------------------------------------- */

static void show_progress(Live *l, const Session *session, int number, bool end)
{
    const double now_s = wall_clock_s();
    if (!isatty(STDERR_FILENO)) return;
    if (end) {
        fputs("\r\x1b[K", stderr);
        return;
    }
    if (now_s - l->shown_s < show_s) return;
    const int made = session_result(session)->frames;
    fprintf(stderr, "\r  frame %d  %.1f /s  %d entities  %llu late  %llu lost   ", number,
            (made - l->rate_from) / (now_s - l->rate_from_s), session_entities(session),
            (unsigned long long)l->counters.frames_late, (unsigned long long)lost(&l->counters));
    l->rate_from   = made;
    l->rate_from_s = l->shown_s = now_s;
}

static Status feed(Live *l, Player *player, int64_t until_ns)
{
    DisDatagram datagram;
    while (take(&datagram, l, until_ns)) {
        const Status status = player_add(player, &datagram, true);
        if (status != STATUS_OK) {
            log_error("run: out of memory for what was heard");
            return status;
        }
    }
    return STATUS_OK;
}

/* Until that Unix time has passed, taking in what comes. False: it is over. */
static Status wait_until(bool *there, Live *l, Player *player, int64_t until_ns)
{
    for (;;) {
        const int64_t now_ns = dis_udp_now_ns();
        *there = now_ns > until_ns;
        if (*there || over(l)) return STATUS_OK;
        const int64_t         wake_ns = until_ns < now_ns + look_ns ? until_ns + 1 : now_ns + look_ns;
        const struct timespec wake    = {(time_t)(wake_ns / 1000000000), (long)(wake_ns % 1000000000)};
        clock_nanosleep(CLOCK_REALTIME, TIMER_ABSTIME, &wake, NULL);
        const Status status = feed(l, player, until_ns);
        if (status != STATUS_OK) return status;
    }
}

/* The rest of what came into the recording, and what it is known by. */
static void conclude(Live *l)
{
    DisDatagram   datagram;
    const int64_t last_ns = dis_udp_now_ns();
    dis_udp_close_tick(l->udp, last_ns);
    while (take(&datagram, l, last_ns)) {}
    read_counters(l);
    if (!l->recording) return;
    const char *path          = l->run.options.config.record.path;
    l->counters.record_failed = live_recording_failed(l->recording);
    l->record_whole           = live_recording_close(l->recording) == STATUS_OK && l->counters.record_failed == 0;
    l->recording              = NULL;
    if (l->record_whole) sha256_file(l->run.log_sha256, path);
    else log_error("run: the recording %s ends early: %llu datagrams and more are not in it", path,
                   (unsigned long long)l->counters.record_failed);
}

/* The newest frame whose time has come, else the next: who is late leaves frames out, and queues none. */
static Status live_frames(Run *run, Session *session, Player *player, const HostPlan *plan, const FrameGrid *grid)
{
    Live          *l      = run->user;
    const Options *o      = &run->options;
    Status         status = STATUS_OK;
    double         last   = -1; /* number of the last frame */
    const double   from_s = fmax(plan->start_s, o->config.exercise.from_s); /* NaN: none */
    const double   first  = fmax(ceil(from_s * grid->rate_hz - 1e-9) - grid->origin, 0);
    l->player      = player;
    l->rate_from_s = wall_clock_s();
    while (status == STATUS_OK && !over(l) && !(o->frames && session_result(session)->frames >= o->frames)) {
        const double now_s  = player_time_s(player, dis_unix_s(dis_udp_now_ns()));
        const double newest = floor(now_s * grid->rate_hz) - grid->origin;
        const double n      = fmax(fmax(newest, last + 1), first);
        const double t_s    = frame_grid_s(grid, n);
        if (t_s > o->config.exercise.to_s) break;
        const int64_t until_ns = dis_unix_ns_until(player_arrival_s(player, t_s));
        bool          there, shown;
        status = wait_until(&there, l, player, until_ns);
        if (status != STATUS_OK || !there) break;
        if (last >= 0 && n > last + 1) l->counters.frames_late += (uint64_t)(n - last - 1);
        last = n;
        dis_udp_close_tick(l->udp, until_ns);
        status = feed(l, player, until_ns);
        if (status == STATUS_OK) status = session_frame(&shown, session, (int)n, t_s);
        flush_recording(l);
        say_troubles(l);
        show_progress(l, session, (int)n, false);
    }
    show_progress(l, session, 0, true);
    conclude(l);
    return status;
}

/* ---- the command ------------------------------------------------------------------------------- */

static Status open_network(Live *l)
{
    Config      *config = &l->run.options.config;
    DisUdpConfig udp    = dis_udp_default_config();
    char         comment[dis_udp_where_size + 40];
    if (config->exercise.port == dis_port_any) {
        log_error("run: exercise.port: 0 is any port, for a recording; a node listens on one, 1 .. 65535");
        return STATUS_BAD_VALUE;
    }
    if (config->exercise.port != dis_port_default) udp.port = config->exercise.port;
    _Static_assert(sizeof udp.address == sizeof config->network.address, "one address");
    memcpy(udp.address, config->network.address, sizeof udp.address);
    memcpy(udp.interface, config->network.interface, sizeof udp.interface);
    udp.ttl          = config->network.ttl;
    udp.queue_octets = config->network.queue_mb << 20;
    dis_udp_where(l->where, &udp);
    Status status = dis_udp_open(&l->udp, &udp);
    if (status != STATUS_OK || !*config->record.path) return status;
    snprintf(comment, sizeof comment, "pitviper run: %s", l->where);
    return live_recording_open(&l->recording, config->record.path, comment, l->udp, udp.port);
}

/* How long this machine takes over a frame, once: the one clock that a choice of quality hangs on. Said so that a replay
 * with the same quality.machine_factor makes the same pictures. */
static Status measure_machine(Live *l)
{
    Config *config = &l->run.options.config;
    char    path[1024], text[32];
    double  factor;
    if (!quality_wants_factor(config)) return STATUS_OK;
    if (*config->quality.table) snprintf(path, sizeof path, "%s", config->quality.table);
    else if (!etc_path(path, sizeof path, "quality.csv")) return STATUS_BAD_VALUE;
    Status status = bench_machine_factor(&factor, path, l->run.options.threads);
    if (status != STATUS_OK) return status;
    snprintf(text, sizeof text, "%g", factor);
    choice_add(&l->run.choices, "machine: %s times the time in the table of settings, measured (quality.machine_factor)", text);
    return config_set(config, "quality.machine_factor", text, "run");
}

static Status run_node(Live *l)
{
    bool   heard;
    Status status = measure_machine(l);
    if (status == STATUS_OK) status = run_prepare(&l->run);
    /* now, not when the first entity is heard, hours later */
    if (status == STATUS_OK) status = frame_files_folder(l->run.options.out);
    if (status == STATUS_OK) status = open_network(l);
    if (status != STATUS_OK) return status;
    l->begun_s = l->heard_s = wall_clock_s();
    log_info("run: listening on %s; Ctrl-C ends it", l->where);
    status = listen_first(&heard, l);
    if (status != STATUS_OK || !heard) {
        conclude(l);
        if (status == STATUS_OK)
            log_info("run: ended before the first frame: %llu datagrams heard",
                     (unsigned long long)l->counters.datagrams);
        return status;
    }
    status = run_survey(&l->run, &l->run.view);
    if (status == STATUS_OK) status = run_host(&l->run, NULL);
    log_info("run: %llu datagrams heard, %llu of them our own; lost %llu; frames left out %llu",
             (unsigned long long)l->counters.datagrams, (unsigned long long)l->run.own,
             (unsigned long long)lost(&l->counters), (unsigned long long)l->counters.frames_late);
    if (l->counters.files_failed || l->counters.files_left_out)
        log_warn("run: frames without their files: %llu for want of time, %llu could not be written; --no-png or "
                 "--no-files leaves more time", (unsigned long long)l->counters.files_left_out,
                 (unsigned long long)l->counters.files_failed);
    return status;
}

int run_command(int argc, char **argv)
{
    Live  live = {.run = {.frames = live_frames, .log_name = "live"}};
    Live *l    = &live;
    char  name[sizeof l->run.options.config.record.path];
    const int stop = options_parse(&l->run.options, COMMAND_RUN, argc, argv);
    if (stop) return stop - 1;
    l->run.options.config.causal = true;
    l->run.live                  = &l->counters;
    l->run.user                  = l;
    if (strcmp(l->run.options.config.publish.dis, "off") != 0) l->run.publish = publish_frame;
    memcpy(name, l->run.options.config.record.path, sizeof name);
    if (*name) l->run.log_name = basename(name);
    l->late_said_s = l->lost_said_s = -INFINITY;

    stop_by_signals();
    thread_flush_denormals();
    const Status status = run_node(l);
    live_recording_close(l->recording);
    dis_udp_close(l->udp);
    run_close(&l->run);
    forget_heard(l, l->heard_count);
    free(l->heard);
    return status == STATUS_OK && (!*name || l->record_whole) ? 0 : 1;
}
