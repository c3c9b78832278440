/* sensor/commands/replay_command.c: `pitviper replay LOG`: replays a recorded exercise to images and truth. */
#include "sensor/commands/commands.h"

#include "dis/pdu/decode.h"
#include "pitviper_output.h"
#include "sensor/publish/files/frame_files.h"
#include "sensor/node/clock/log_clock.h"
#include "sensor/node/run/host_run.h"
#include "sensor/node/player/player.h"
#include "sensor/commands/lockstep.h"
#include "sensor/commands/overwrite.h"
#include "sensor/commands/program.h"
#include "sensor/publish/video/video_names.h"
#include "sensor/settings/config.h"
#include "sensor/node/run/stop.h"
#include "sensor/commands/sweep/sweep.h"

#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* ---- the frames ------------------------------------------------------------------------------ */

static void show_progress(double n, double first, double last, double begun_s)
{
    const double done = (n - first + 1) / (last - first + 1), spent_s = wall_clock_s() - begun_s;
    char         text[96];
    snprintf(text, sizeof text, "frame %.0f of %.0f  %3.0f %%  %.0f s left", n - first + 1, last - first + 1,
             100 * done, spent_s * (1 - done) / done);
    log_status(text);
}

/* Whether frame n is requested; at: of --only, the next one. */
static bool wanted(const Options *o, int *at, double n)
{
    if (o->only_count == 0) return true;
    while (*at < o->only_count && o->only[*at] < n) (*at)++;
    return *at < o->only_count && o->only[*at] == n;
}

/* Ends the span at the last frame that --only names. All of these frames, and those to be saved, must be in the span.
 */
static Status take_only(double *last, const Options *o, double first)
{
    for (int i = 0, at = 0; i < o->save_count; i++)
        if (o->save[i] < first || o->save[i] > *last || !wanted(o, &at, o->save[i])) {
            log_error(
                "replay: --save-frame: frame %d is not rendered: they go from %.0f to %.0f%s; see also --from, --to and --rate",
                o->save[i], first, *last, o->only_count ? ", those of --only" : "");
            return STATUS_BAD_VALUE;
        }
    if (o->only_count == 0) return STATUS_OK;
    const int low = o->only[0], high = o->only[o->only_count - 1];
    if (low < first || high > *last) {
        log_error("replay: --only: there is no frame %d, they go from %.0f to %.0f; see also --from, --to and --rate",
                  low < first ? low : high, first, *last);
        return STATUS_BAD_VALUE;
    }
    *last = high;
    return STATUS_OK;
}

/* The span of the plan and of --from and --to, or, causal, to the last datagram received unless --to is later. span_s:
 * its ends, exercise time. */
static Status find_span(LogSpan *out, double span_s[2], const Run *run, const Player *player, const HostPlan *plan,
                        const FrameGrid *grid)
{
    const Options *o = &run->options;
    const Config  *config = &o->config;
    double         from_s = plan->start_s, to_s = plan->end_s;
    const double   first_s = run->made->survey.first_s,
                 last_s = config->exercise.causal ? player_last_s(player) : run->made->survey.last_s;
    const double wanted_from_s = config_span_time_s(config->exercise.from_s, first_s, last_s);
    const double wanted_to_s = config_span_time_s(config->exercise.to_s, first_s, last_s);
    if (config_span_outside(config->exercise.from_s, config->exercise.to_s, first_s, last_s)) return STATUS_BAD_VALUE;
    if (!isfinite(to_s) && isnan(wanted_to_s)) to_s = last_s;
    if (wanted_from_s > from_s) from_s = wanted_from_s;
    if (wanted_to_s < to_s) to_s = wanted_to_s;

    double     first = ceil(from_s * grid->rate_hz - 1e-9) - grid->origin;
    double     last = floor(to_s * grid->rate_hz + 1e-9) - grid->origin;
    const bool single = to_s >= from_s && !(last >= first); /* shorter than an interval: one frame, at its start */
    if (!(last >= first || single) || last > 999999) {
        char host[dis_id_text_size];
        choice_host_name(host, plan);
        log_error("replay: %s between %.3f and %.3f s at %g Hz: the recording goes from %.3f to %.3f s (+0 to +%.3f), "
                  "%s can be "
                  "shown from %.3f s on; widen --from and --to or change --rate%s",
                  last >= first ? "more than a million frames" : "no frame", from_s, to_s, grid->rate_hz, first_s,
                  last_s, last_s - first_s, host, plan->start_s,
                  config->exercise.causal ? ", or listen less (exercise.listen_s)" : "");
        return STATUS_BAD_VALUE;
    }
    if (single) last = first;
    const Status status = take_only(&last, o, first);
    *out = (LogSpan){*grid, (int)first, (int)last, o->only, o->only_count, single ? from_s : NAN};
    span_s[0] = from_s, span_s[1] = to_s;
    return status;
}

static Status check_span(Run *run, const Player *player, const HostPlan *plan, const FrameGrid *grid)
{
    LogSpan span;
    double  span_s[2];
    return find_span(&span, span_s, run, player, plan, grid);
}

/* What the loop over frames works on. */
typedef struct Replay {
    Session  *session;
    LogClock *clock;
} Replay;

static bool over(void *user)
{
    (void)user;
    return stop_asked();
}

static Status make_frame(void *user, const FrameTime *frame)
{
    const Replay  *r = user;
    const LogSpan *span = &r->clock->span;
    bool           shown;
    const Status   status = session_frame(&shown, r->session, frame);
    if (status == STATUS_OK) show_progress(frame->number, span->first, span->last, r->clock->begun_s);
    return status;
}

static Status replay_frames(Run *run, Session *session, Player *player, const HostPlan *plan, const FrameGrid *grid)
{
    LogSpan span;
    double  span_s[2];
    Status  status = find_span(&span, span_s, run, player, plan, grid);
    if (status != STATUS_OK) return status;
    Replay replay = {session, (LogClock *)run->clock};
    log_clock_begin(replay.clock, &span);
    status = frame_loop(&run->stopped, &(FrameLoop){run->clock, over, NULL, make_frame, &replay});
    log_status(NULL);
    if (status != STATUS_OK) return status;
    if (session_result(session)->frames == 0 && !run->stopped) {
        if (plan->any_munition)
            log_error("replay: exercise.host: munition: none flew at a frame's time between %.3f and %.3f s; `pitviper "
                      "inspect %s` lists who was there, --host ID or --host observer shows what there is",
                      span_s[0], span_s[1], run->options.log);
        else
            log_error("replay: %s was never there at a frame's time; see `pitviper inspect`, --from, --to and --rate",
                      session_host(session));
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

/* ---- the log --------------------------------------------------------------------------------- */

/* Checks all hosts before the first frame of any, so that an error in the last is not found after an hour. */
static Status check_hosts(DisEntityId host[options_hosts_max], const Run *run)
{
    const Options *o = &run->options;
    for (int i = 0; i < o->host_count; i++) {
        const bool observer = strcmp(o->host[i], host_observer) == 0;
        if (observer) {
            host[i] = (DisEntityId){0};
        } else if (!dis_entity_id_parse(&host[i], o->host[i]) || dis_entity_id_is_none(host[i])) {
            log_error("replay: --host: '%s' is not site:application:entity, for example 1:3001:82, nor observer%s",
                      o->host[i], strcmp(o->host[i], host_munition) == 0 ? "; munition goes alone" : "");
            return STATUS_BAD_VALUE;
        }
        for (int k = 0; k < i; k++)
            if (dis_entity_id_compare(host[i], host[k]) == 0) {
                log_error("replay: --host: %s is given twice", o->host[i]);
                return STATUS_BAD_VALUE;
            }
        if (!observer && !survey_track(&run->made->survey, host[i]) && !o->config.exercise.causal) {
            log_error("replay: --host: %s is not in the log; `pitviper inspect LOG` lists the entities", o->host[i]);
            return STATUS_BAD_VALUE;
        }
    }
    return STATUS_OK;
}

/* Tells why a log shows nothing: other exercises, what is malformed, or another port. */
static void log_nothing(const Run *run, const DisLog *log)
{
    const char        *path = run->options.log;
    const DisCounters *c = &run->made->survey.counters;
    char               heard[128] = "";
    size_t             n = 0;
    int                why = 0;
    if (c->dropped[DIS_DROP_OTHER_EXERCISE] > 0) {
        bool        there[256] = {false};
        int         first = -1;
        DisCounters ignored = {0};
        for (int i = 0; i < log->count; i++) {
            const DisDatagram d = dis_log_datagram(log, i);
            const uint8_t    *at = d.bytes, *pdu, *end = at + d.octets;
            DisHeader         header;
            while (dis_next_pdu(&header, &pdu, &at, end, &ignored)) there[header.exercise] = true;
        }
        for (int e = 0; e < 256 && n + 8 < sizeof heard; e++) {
            if (!there[e] || e == run->exercise) continue;
            n += (size_t)snprintf(heard + n, sizeof heard - n, "%s%d", n ? ", " : "", e);
            if (first < 0) first = e;
        }
        log_error(
            "replay: %s holds no Entity State with a usable position of exercise %d (%llu datagrams heard); it holds PDUs "
            "of exercise %s: --set exercise.exercise=%d takes that one, -2 all",
            path, run->exercise, (unsigned long long)c->datagrams, heard, first);
        return;
    }
    for (int i = 1; i < DIS_DROP_COUNT; i++)
        if (c->dropped[i] > c->dropped[why]) why = i;
    if (c->dropped[why] > 0)
        log_error(
            "replay: %s holds no Entity State with a usable position (%llu datagrams heard); %llu PDUs are dropped, most for "
            "%s; `pitviper inspect %s` says what it holds",
            path, (unsigned long long)c->datagrams, (unsigned long long)c->dropped[why], dis_drop_cause((DisDrop)why),
            path);
    else
        log_error("replay: %s holds no Entity State with a usable position (%llu datagrams heard); "
                  "`pitviper inspect %s` says what it holds, --set exercise.port=N takes another port",
                  path, (unsigned long long)c->datagrams, path);
}

/* What the world follows from: what a live node had heard when it made its own, as its recording notes, else all. */
static DisLog world_log(Run *run)
{
    const Config *config = &run->options.config;
    DisLog        view, from, all = made_log_by(run->made, config, false);
    run->noted = world_note_read(&run->world_note, run->made->log.notes);
    if (!run->noted) return all;
    const DisLog arrived = made_log_by(run->made, config, true);
    double       until_s = run->world_note.until_s;
    run->noted = player_opening_until(&view, &from, &until_s, &arrived, config);
    return run->noted ? from : all;
}

/* The first usable Entity State, whose version and exercise what is sent has. */
static void find_first(Run *run, const DisLog *log)
{
    for (int i = 0; i < log->count; i++) {
        const DisDatagram datagram = dis_log_datagram(log, i);
        if (player_starts(&run->first, &datagram, &run->options.config)) return;
    }
}

static Status open_log(Run *run)
{
    const Options *o = &run->options;
    DisLog         heard, from;
    Status         status = run_made(run);
    if (status == STATUS_OK) status = made_log(run->made, o->log, &o->config);
    run->stopped = status != STATUS_OK && stop_asked(); /* while a pipe was waited for */
    if (status != STATUS_OK) return status;
    const DisLog *log = &run->made->log;
    strcpy(run->log_sha256, run->made->log_sha256);
    run->link = &log->counters;
    if (log->retimed)
        choice_add(&run->choices, "clock: the time stamps; the capture's packet times do not keep pace with them");
    if (log->any_port && o->config.exercise.port == dis_port_default)
        choice_add(&run->choices, "port: any that carries DIS, nothing went to 3000 (exercise.port)");
    run->own = run->made->own;
    if (run->own > 0)
        choice_add(&run->choices,
                   "own: %llu datagrams of %d:%d are this node's, left out (node.site, "
                   "node.application)",
                   (unsigned long long)run->own, o->config.node.site, o->config.node.application);
    run->view = heard = *log;
    find_first(run, log);
    const bool starts =
        !o->config.exercise.causal || player_opening(&run->view, &heard, &run->until_s, log, &o->config);
    from = world_log(run);
    status = run_survey(run, &heard, &from);
    if (status == STATUS_OK && dis_log_failed(log)) status = STATUS_IO;
    if (status == STATUS_OK && (!starts || run->made->survey.track_count == 0)) {
        log_nothing(run, log);
        return STATUS_BAD_VALUE;
    }
    return status;
}

/* ---- Data PDUs -------------------------------------------------------------------------------- */

typedef struct Sending {
    DisUdp *udp;                     /* NULL: nothing is sent */
    char    to[run_network_to_size]; /* for messages */
} Sending;

static Status send_pdu(void *user, const uint8_t *pdu, size_t octets)
{
    const Sending *s = user;
    return dis_udp_send(s->udp, pdu, octets);
}

/* Opens the sending of a replay at the pace of the recording or a multiple of it, which sends what the live node would;
 * at full speed a replay would flood the network. */
static Status open_sending(Sending *s, Run *run)
{
    const Options     *o = &run->options;
    const DisUdpConfig udp = run_network(&o->config);
    if (o->config.publish.dis == PUBLISH_DIS_OFF) return STATUS_OK;
    if (!isfinite(o->speed)) {
        log_warn("replay: publish.dis: Data PDUs are not sent at full speed; add --speed 1 to send them at the pace of "
                 "the recording");
        return STATUS_OK;
    }
    run_network_to(s->to, &udp);
    const Status status = dis_udp_open_sender(&s->udp, &udp);
    if (status != STATUS_OK) return status;
    run->send = send_pdu;
    run->user = s;
    log_info("replay: Data PDUs go to %s from %d:%d (publish.dis)", s->to, o->config.node.site,
             o->config.node.application);
    return STATUS_OK;
}

/* A replay that was to send, and could not send one PDU, has failed. */
static Status close_sending(Sending *s)
{
    if (!s->udp) return STATUS_OK;
    const DisUdpCounters c = dis_udp_counters(s->udp);
    dis_udp_close(s->udp);
    s->udp = NULL;
    if (c.sent == 0 && c.send_failed > 0) {
        log_error("replay: none of %llu Data PDUs could be sent to %s: %s; see --address and --interface",
                  (unsigned long long)c.send_failed, s->to, strerror(c.send_error));
        return STATUS_IO;
    }
    log_info("replay: Data PDUs sent %llu, not sent %llu", (unsigned long long)c.sent,
             (unsigned long long)c.send_failed);
    return STATUS_OK;
}

/* ---- the command ------------------------------------------------------------------------------- */

/* Checks the folders of all hosts, and their videos: the last thing that is asked before the world is set up. */
static Status open_folders(const Run *run, const DisEntityId host[])
{
    const Options *o = &run->options;
    char           name[run_folder_size];
    const bool     there = access(o->out, F_OK) == 0; /* else a video may be meant for it */
    Status         status = STATUS_OK;
    if (there && o->host_count <= 1) status = overwrite_video("replay", &o->config, run->bands, NULL, o->overwrite);
    if (status == STATUS_OK) status = overwrite_folder("replay", o->out, o->overwrite);
    if (status == STATUS_OK && !there && o->host_count <= 1)
        status = overwrite_video("replay", &o->config, run->bands, NULL, o->overwrite);
    for (int i = 0; status == STATUS_OK && o->host_count > 1 && i < o->host_count; i++) {
        run_folder(name, o, host[i]);
        status = overwrite_folder("replay", name, o->overwrite);
        if (status == STATUS_OK)
            status = overwrite_video("replay", &o->config, run->bands, basename(name), o->overwrite);
    }
    return status;
}

/* Finds everything that can be known to be wrong, in seconds, before a file is touched. */
static Status prepare(Run *run, DisEntityId host[options_hosts_max])
{
    const Options *o = &run->options;
    Status         status = run_prepare(run);
    if (status == STATUS_OK) status = video_hosts_check(&o->config, o->host_count);
    if (status == STATUS_OK) status = open_log(run);
    if (status == STATUS_OK) status = check_hosts(host, run);
    if (status == STATUS_OK && o->host_count == 0) status = run_check(run, NULL);
    for (int i = 0; i < o->host_count && status == STATUS_OK; i++) status = run_check(run, &host[i]);
    return status;
}

static Status look_at_variant(Run *run)
{
    DisEntityId host[options_hosts_max];
    run->check = check_span;
    return prepare(run, host);
}

/* made: of a run before in this process; NULL: there is none. */
static int replay(const Options *options, MadeWorld *made)
{
    LogClock clock = log_clock(options->speed);
    Run run = {.options = *options, .made = made, .check = check_span, .frames = replay_frames, .clock = &clock.clock};
    Lockstep    lockstep;
    Sending     sending = {0};
    DisEntityId host[options_hosts_max];
    char        log_name[4096];
    snprintf(log_name, sizeof log_name, "%s", run.options.log);
    run.log_name = basename(log_name);
    Status failed = STATUS_OK, status = lockstep_begin(&lockstep, &run, NULL);
    if (status == STATUS_OK) status = prepare(&run, host);
    if (status == STATUS_OK) status = open_sending(&sending, &run);
    if (status == STATUS_OK) status = open_folders(&run, host);
    if (status == STATUS_OK) video_watch_print(&run.options.config, run.bands);
    if (status == STATUS_OK && run.options.host_count == 0) status = run_host(&run, NULL);
    int done = 0;
    for (int i = 0; status == STATUS_OK && !run.stopped && i < run.options.host_count; i++) {
        const Status one = run_host(&run, &host[i]);
        if (one != STATUS_OK) failed = one; /* the others are still rendered */
        else if (done++ == 0 && run.options.host_count > 1) frame_files_clear(run.options.out); /* a run of one host */
    }
    lockstep_end(&lockstep);
    if (status == STATUS_OK) status = failed;
    const Status sent = close_sending(&sending);
    if (status == STATUS_OK) status = sent;
    if (status == STATUS_NO_MEMORY)
        log_error("replay: out of memory; smaller pictures (--size), fewer bands (--bands) or more memory");

    const bool unheard = run.stopped && run.made && run.made->log.count == 0;
    run_close(&run);
    output_release(run.options.out);
    if (status != STATUS_OK && !unheard) return 1;
    return run.stopped ? stop_exit_code() : 0;
}

/* A variant of a sweep, in a process that has made others. */
static int replay_variant(int argc, char **argv, MadeWorld *made)
{
    static char called[] = "pitviper replay"; /* for messages: argv begins with the program and the command */
    Options    *options = argc > 1 ? malloc(sizeof *options) : NULL;
    if (options) argv[1] = called;
    const int stop = options ? options_parse(options, COMMAND_REPLAY, argc - 1, argv + 1) : 1 + 1;
    const int code = stop ? stop - 1 : replay(options, made);
    free(options);
    return program_printed(code);
}

int replay_command(int argc, char **argv)
{
    Options options;
    thread_flush_denormals();
    if (argc == 2 && strcmp(argv[1], sweep_worker_option) == 0) {
        stop_by_signals();
        return sweep_worker(replay_variant);
    }
    const int stop = options_parse(&options, COMMAND_REPLAY, argc, argv);
    if (stop) return stop - 1;
    stop_by_signals();
    return options.sweep ? sweep_replay(&options, look_at_variant) : replay(&options, NULL);
}
