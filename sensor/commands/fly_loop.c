/* sensor/commands/fly_loop.c: one flight in the loop: its exercise, its node, its recogniser, and what came of it. */
#include "sensor/commands/fly_loop_private.h"

#include "pitviper_output.h"
#include "sensor/commands/overwrite.h"
#include "sensor/node/clock/flight_clock.h"
#include "sensor/node/flight/node_flight.h"
#include "sensor/node/flight/recogniser.h"
#include "sensor/node/run/host_run.h"
#include "sensor/node/run/stop.h"

#include <arpa/inet.h>
#include <errno.h>
#include <ftw.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

enum { path_size = 4096 };

/* One flight, while its node runs. */
typedef struct Flying {
    const FlyLoop *o;
    FlightLoop    *loop;
    FlightClock    clock;
    Recogniser     recogniser;
    Session       *session;
    Player        *player;
    Cast          *cast;
    FlyLoopCounts *counts; /* [flight_count of the cast] */
    FlyLoopWrite  *write;
    Scenario      *scenario;
    DisLog        *log_of;         /* [rounds]: of the exercise as it is after each but the last */
    int            flight, rounds; /* of the cast, in the air; how many have ended */
    int64_t        offset;         /* ticks of the node less those of the scenario */
    Status         status;         /* of a hand-over */
    char           scratch[path_size - 64], log[path_size], out[path_size];
} Flying;

/* ---- scratch ----------------------------------------------------------------------------------------- */

static int remove_one(const char *path, const struct stat *about, int kind, struct FTW *at)
{
    (void)about, (void)kind, (void)at;
    (void)output_remove(path); /* what stays is left to the system's clearing of its folder */
    return 0;
}

static Status make_scratch(Flying *f)
{
    const char *tmp = getenv("TMPDIR");
    snprintf(f->scratch, sizeof f->scratch, "%.3900s/pitviper-fly-XXXXXX", tmp && *tmp ? tmp : "/tmp");
    if (!mkdtemp(f->scratch)) {
        log_error("fly: no folder for a while at %s: %s; see TMPDIR", f->scratch, strerror(errno));
        *f->scratch = 0;
        return STATUS_IO;
    }
    snprintf(f->log, sizeof f->log, "%s/exercise.pcapng", f->scratch);
    return STATUS_OK;
}

/* A UDP port that is free now. */
static int free_port(void)
{
    struct sockaddr_in own = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t          octets = sizeof own;
    const int          s = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const bool         good = s >= 0 && bind(s, (struct sockaddr *)&own, octets) == 0 &&
                      getsockname(s, (struct sockaddr *)&own, &octets) == 0;
    if (s >= 0) close(s);
    return good ? ntohs(own.sin_port) : 0;
}

/* ---- round after round --------------------------------------------------------------------------- */

static DisEntityId id_of(const Cast *cast, int entity)
{
    const Scenario *s = cast->scenario;
    return (DisEntityId){(uint16_t)s->dis.site, (uint16_t)s->dis.application, cast->entity[entity].number};
}

/* Gives the loop a round that is held, but for when it is launched. */
static Status take_round(FlightLoop *loop, const Cast *cast, int number)
{
    static const double memory = 0.6; /* of the filter, where the shot says none */
    const CastFlight   *flight = &cast->flight[number];
    const CastRound    *round = &cast->round[flight->round];
    const ScenarioShot *shot = &cast->scenario->shot[round->shot];
    if (round->munition < 0 || round->target < 0) {
        log_error("fly: %s:%d: in a loop with frames a shot is at an entity, and its munition is one (at, entity)",
                  cast->scenario->path, shot->line);
        return STATUS_BAD_VALUE;
    }
    loop->id = id_of(cast, round->munition);
    loop->target = id_of(cast, round->target);
    loop->missile = flight->missile;
    memcpy(loop->p_ecef, flight->p_ecef, sizeof loop->p_ecef);
    memcpy(loop->v_ecef_mps, flight->v_ecef_mps, sizeof loop->v_ecef_mps);
    loop->late_s = shot->sight_late_s;
    loop->memory = shot->sight_memory > 0 ? shot->sight_memory : memory;
    return STATUS_OK;
}

/* What came of a round, into the cast and the counts. */
static Status conclude(Flying *f)
{
    const FlightLoop *loop = f->loop;
    Cast             *cast = f->cast;
    CastFlight       *flight = &cast->flight[f->flight];
    const double      launch_s = cast->round[flight->round].fire_s;
    const CastFlown   flown = {.state = loop->track,
                               .states = loop->track_count,
                               .end = (int)loop->end,
                               .hit = loop->hit,
                               .impact_s = launch_s + loop->end_s - (double)loop->launch_tick * loop->world.step_s,
                               .impact_ecef = {loop->end_ecef[0], loop->end_ecef[1], loop->end_ecef[2]},
                               .miss_m = loop->miss.least_m};
    FlyLoopCounts    *counts = &f->counts[f->flight];
    flight->end_mps = v3_length(loop->state.v_ecef_mps);
    flight->most_lateral_mps2 = loop->most_lateral_mps2;
    flight->guided_share =
        (double)loop->guided / (double)(loop->guided + loop->coasted + !(loop->guided + loop->coasted));
    *counts = (FlyLoopCounts){.frames = loop->frames, .late = loop->late};
    memcpy(counts->verdicts, loop->verdicts, sizeof counts->verdicts);
    f->rounds++;
    return cast_take_flight(cast, f->flight, &flown);
}

/* The held round that is to be launched first, other than one; -1: none. */
static int next_round(const Cast *cast, int other)
{
    int next = -1;
    for (int i = 0; i < cast->flight_count; i++)
        if (i != other && cast->flight[i].held && (next < 0 || cast->flight[i].tick < cast->flight[next].tick))
            next = i;
    return next;
}

static const char shown_as[] = "pitviper fly: as the frames show it";

/* The exercise as it goes on after the round that has ended: what it hit, and the launch of the next. */
static Status change_exercise(Flying *f, double from_s)
{
    DisLog          *log = &f->log_of[f->rounds - 1];
    const CastRound *round = &f->cast->round[f->cast->flight[f->flight].round];
    char             path[path_size];
    f->scenario->duration_s =
        fmax(f->scenario->duration_s, round->fire_s + f->cast->flight[f->flight].missile.life_s + 1);
    snprintf(path, sizeof path, "%s/exercise_%d.pcapng", f->scratch, f->rounds);
    Status status = f->write(f->cast, path, shown_as);
    if (status == STATUS_OK) status = dis_log_open(log, path, dis_port_any);
    return status == STATUS_OK ? player_change_log(f->player, log, from_s) : status;
}

/* The next round takes the frame: launched when the scenario says, at the frame at t_s at the earliest. */
static bool hand_over(void *user, double t_s)
{
    Flying      *f = user;
    FlightLoop  *loop = f->loop;
    const double ended_s = loop->end_s, step_s = loop->world.step_s;
    const int    next = next_round(f->cast, f->flight);
    if (next < 0 || f->status != STATUS_OK) return false;
    f->status = conclude(f);
    if (f->status != STATUS_OK) return false;
    f->flight = next;
    const int64_t from = (int64_t)ceil(t_s / step_s - 1e-6) - f->offset, planned = f->cast->flight[f->flight].tick;
    f->status = cast_hold_until(f->cast, f->flight, (double)(planned > from ? planned : from) * step_s);
    if (f->status == STATUS_OK) f->status = change_exercise(f, ended_s - step_s);
    if (f->status == STATUS_OK) f->status = take_round(loop, f->cast, f->flight);
    if (f->status != STATUS_OK) return false;
    flight_loop_next(loop);
    loop->launch_tick = f->cast->flight[f->flight].tick + f->offset;
    return true;
}

/* The first round; the others wait, unheard of. */
static Status begin(Flying *f, const FlyLoop *o)
{
    Status status = STATUS_OK;
    f->loop->source = o->sights ? LOOP_RECORDED : o->recogniser ? LOOP_ANSWERS : o->radar ? LOOP_RADAR : LOOP_TRUE;
    f->loop->limit_s = o->limit_s;
    f->loop->start_s = o->start_s;
    f->flight = next_round(f->cast, -1);
    for (int i = 0; i < f->cast->flight_count && status == STATUS_OK; i++) {
        status = take_round(f->loop, f->cast, i); /* refused before anything flies */
        if (status == STATUS_OK && i != f->flight) status = cast_hold_until(f->cast, i, INFINITY);
    }
    return status == STATUS_OK ? take_round(f->loop, f->cast, f->flight) : status;
}

/* ---- the node ---------------------------------------------------------------------------------------- */

/* The options of the node: those of the loop, and over them what was given. */
static Status node_options(Options *out, Flying *f, const Cast *cast)
{
    enum { own_most = 24, text_size = 128 };
    const FlyLoop    *o = f->o;
    const CastFlight *flight = &cast->flight[f->flight];
    char              own[own_most][text_size];
    char             *argv[own_most + fly_loop_given_most + 8];
    char              aim[dis_id_text_size];
    static char       called[] = "pitviper replay", out_flag[] = "--out", set[] = "--set", overwrite[] = "--overwrite",
                no_files[] = "--no-files";
    int argc = 0, n = 0;
    argv[argc++] = called;
    argv[argc++] = f->log;
    argv[argc++] = out_flag;
    argv[argc++] = f->out;
    if (o->overwrite) argv[argc++] = overwrite;
    if (!o->frames) argv[argc++] = no_files;
    dis_entity_id_text(aim, f->loop->target);
    snprintf(own[n++], text_size, "exercise.host=observer");
    snprintf(own[n++], text_size, "exercise.aim=%s", aim);
    snprintf(own[n++], text_size, "seed=%lld", cast->scenario->seed);
    snprintf(own[n++], text_size, "sensor.rate_hz=20");
    if (flight->missile.field_rad > 0)
        snprintf(own[n++], text_size, "sensor.hfov_deg=%.6g", flight->missile.field_rad / rad_per_deg);
    if (o->recogniser && !o->sights) {
        const int port = free_port();
        if (!port) {
            log_error("fly: no free UDP port on 127.0.0.1 for a recogniser's answers: %s", strerror(errno));
            return STATUS_IO;
        }
        snprintf(own[n++], text_size, "publish.memory=pitviper_fly_%ld", (long)getpid());
        snprintf(own[n++], text_size, "publish.detections_port=%d", port);
        snprintf(own[n++], text_size, "publish.memory_slots=16"); /* frames that may wait for late answers at once */
    }
    for (int i = 0; i < n; i++) argv[argc++] = set, argv[argc++] = own[i];
    for (int i = 0; i < o->given_count; i++) argv[argc++] = o->given[i];
    argv[argc] = NULL;
    const int stop = options_parse(out, COMMAND_REPLAY, argc, argv);
    if (stop) return STATUS_BAD_VALUE;
    out->log = f->log; /* options_parse may keep pointers into argv, which is gone soon */
    out->out = f->out;
    if (out->sweep || out->host_count > 0 || out->only_count > 0 || isfinite(out->speed) ||
        *out->config.exercise.cigi || out->config.exercise.causal) {
        log_error(
            "fly: options of the frames (after --): without --sweep, --host, --only, --speed, --cigi, --causal: the "
            "missile is the host, and its flight the clock");
        return STATUS_BAD_VALUE;
    }
    if (!flight_mount_good(&out->config)) return STATUS_BAD_VALUE;
    if (o->radar && strcmp(out->config.radar.preset, "none") == 0) {
        log_error("fly: --sight radar: of which radar? for example -- --bands lwir,radar --set radar.preset=seeker_35");
        return STATUS_BAD_VALUE;
    }
    if (*out->config.flight.missile) {
        log_error("fly: flight.missile: is of a live node; the shot's `flies`, or --missile, says what flies");
        return STATUS_BAD_VALUE;
    }
    if (o->recogniser && !o->sights && !out->config.publish.detections_port) {
        log_error("fly: --recogniser: publish.detections_port is where its answers come: not 0");
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

static bool over(void *user)
{
    (void)user;
    return stop_asked();
}

static Status make_frame(void *user, const FrameTime *frame)
{
    Flying *f = user;
    bool    shown;
    return session_frame(&shown, f->session, frame);
}

static Status fly_frames(Run *run, Session *session, Player *player, const HostPlan *plan, const FrameGrid *grid)
{
    Flying       *f = run->user;
    const Config *config = &run->options.config;
    const Shot   *shot = survey_shot(&run->made->survey, f->loop->id);
    (void)plan;
    if (!shot || !isfinite(shot->fire_s)) {
        log_error("fly: no Fire is in the exercise (faults.loss?)");
        return STATUS_BAD_VALUE;
    }
    f->session = session;
    f->player = player;
    f->loop->launch_tick = llround(shot->fire_s / f->loop->world.step_s);
    f->offset = f->loop->launch_tick - f->cast->flight[f->flight].tick;
    Status status = flight_clock_begin(&f->clock, grid);
    if (status == STATUS_OK && f->loop->source == LOOP_ANSWERS)
        status = recogniser_start(&f->recogniser, f->o->recogniser, config->publish.memory,
                                  config->publish.detections_port, f->out);
    if (status == STATUS_OK) status = frame_loop(&run->stopped, &(FrameLoop){run->clock, over, NULL, make_frame, f});
    if (status == STATUS_OK) status = f->status;
    if (status == STATUS_OK && f->loop->out_of_memory) status = STATUS_NO_MEMORY;
    if (status == STATUS_OK && f->loop->strange) status = STATUS_BAD_VALUE;
    return status;
}

static Status run_node(Flying *f, const Cast *cast)
{
    Run *run = calloc(1, sizeof *run);
    if (!run) return STATUS_NO_MEMORY;
    f->clock = flight_clock(f->loop);
    f->clock.hand_over = hand_over;
    f->clock.user = f;
    run->frames = fly_frames;
    run->user = f;
    run->clock = &f->clock.clock;
    run->flight = f->loop;
    run->log_name = "exercise.pcapng";
    Status status = node_options(&run->options, f, cast);
    if (status == STATUS_OK) status = run_prepare(run);
    if (status == STATUS_OK) status = run_made(run);
    if (status == STATUS_OK) status = made_log(run->made, f->log, &run->options.config);
    if (status == STATUS_OK) {
        const DisLog *log = &run->made->log;
        strcpy(run->log_sha256, run->made->log_sha256);
        run->link = &log->counters;
        run->view = *log;
        const DisLog from = made_log_by(run->made, &run->options.config, false);
        status = run_survey(run, log, &from);
    }
    if (status == STATUS_OK) status = run_check(run, NULL);
    if (status == STATUS_OK) status = overwrite_folder("fly", f->out, f->o->overwrite);
    if (status == STATUS_OK) status = run_host(run, NULL);
    recogniser_stop(&f->recogniser);
    run_close(run);
    output_release(f->out);
    free(run);
    return status;
}

/* ---- one flight -------------------------------------------------------------------------------------- */

static void set_out(Flying *f, const Scenario *scenario)
{
    if (!f->o->frames) snprintf(f->out, sizeof f->out, "%s/out", f->scratch);
    else if (f->o->several) snprintf(f->out, sizeof f->out, "%.3900s/seed_%lld", f->o->frames, scenario->seed);
    else snprintf(f->out, sizeof f->out, "%s", f->o->frames);
}

/* What is left of it, also after a failure. */
static void drop(Flying *f)
{
    for (int i = 0; i < f->cast->flight_count && f->log_of; i++) dis_log_close(&f->log_of[i]);
    free(f->log_of);
    if (*f->scratch) nftw(f->scratch, remove_one, 16, FTW_DEPTH | FTW_PHYS);
    flight_loop_free(f->loop);
    free(f->loop);
}

static Status write_sights(const Flying *f)
{
    char       path[path_size + 16];
    const bool answered = f->loop->source == LOOP_ANSWERS || f->loop->source == LOOP_RECORDED;
    if (!f->loop->ended || !f->o->frames || !answered) return STATUS_OK;
    snprintf(path, sizeof path, "%s/sights.csv", f->out);
    return loop_sights_write(f->loop, path);
}

Status fly_loop_seed(FlyLoopCounts *counts, Cast *cast, Scenario *scenario, const FlyLoop *o, FlyLoopWrite *write)
{
    static const double finest_m = 0.05; /* of dead reckoning: the frames show the target where it is */
    FlightLoop         *loop = calloc(1, sizeof *loop);
    Flying       f = {.o = o, .loop = loop, .cast = cast, .counts = counts, .write = write, .scenario = scenario};
    const double duration_s = scenario->duration_s;
    const bool   shown = !log_is_quiet() && !log_is_verbose();
    Status       status = loop ? flight_loop_begin(loop) : STATUS_NO_MEMORY;
    if (status != STATUS_OK) {
        free(loop);
        return status;
    }
    f.log_of = calloc((size_t)cast->flight_count, sizeof *f.log_of);
    status = f.log_of ? begin(&f, o) : STATUS_NO_MEMORY;
    loop->filter = sight_filter(loop->memory);
    loop->gone = o->recogniser && !o->sights ? recogniser_gone : NULL;
    loop->user = &f.recogniser;
    if (status == STATUS_OK) status = make_scratch(&f);
    if (status == STATUS_OK && o->sights) status = loop_sights_read(loop, o->sights);
    set_out(&f, scenario);
    scenario->dis.threshold_m = fmin(scenario->dis.threshold_m, finest_m);
    scenario->duration_s =
        fmax(duration_s, cast->round[cast->flight[f.flight].round].fire_s + loop->missile.life_s + 1);
    if (status == STATUS_OK) status = write(cast, f.log, shown_as);
    if (shown) log_set_level(LOG_WARN); /* standard output is the table's; run.json has the choices */
    if (status == STATUS_OK) status = run_node(&f, cast);
    loop_sights_say_refused(loop);
    if (shown) log_set_level(LOG_INFO);
    if (status == STATUS_OK && loop->ended) status = conclude(&f);
    else if (status == STATUS_OK && !stop_asked()) {
        log_error("fly: the flight did not end");
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK) status = write_sights(&f);
    scenario->duration_s = duration_s;
    for (int i = 0; i < cast->flight_count; i++)
        if (!cast->flight[i].held)
            scenario->duration_s = fmax(scenario->duration_s, cast->round[cast->flight[i].round].impact_s + 2);
    drop(&f);
    return status;
}
