/* sensor/commands/exercise_command.c: `pitviper exercise`: writes the datagrams of a scenario to a file, to the
 * network by the clock, or one by one to a folder. */
#include "sensor/commands/commands.h"
#include "pitviper_output.h"

#include "dis/capture/recorder.h"
#include "dis/network/udp.h"
#include "entities/exercise/exercise.h"
#include "sensor/settings/command_line.h"
#include "sensor/commands/exercise_places_private.h"
#include "sensor/commands/exercise_scenario_private.h"
#include "sensor/commands/overwrite.h"
#include "sensor/commands/plant_judge.h"
#include "sensor/node/run/stop.h"

#include <errno.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

enum { max_sets = 256, path_size = 4096 };

typedef struct Options {
    const char  *scenario, *out, *send, *datagrams, *places;
    double       speed;
    bool         overwrite;
    DisUdpConfig udp;
    int          set_count;
    const char  *set[max_sets];
} Options;

static const char help[] =
    "usage: pitviper exercise SCENARIO (-o LOG | --send ADDRESS) [options]\n"
    "\n"
    "Generates the DIS traffic of a scenario as a simulator does: Entity States when dead reckoning deviates from the "
    "true\n"
    "pose, and by heartbeat; Fire and Detonation. SCENARIO is a YAML file, or the name of a bundled one:\n"
    "\n"
    "  demo            a column of 3 tanks and 2 trucks; a helicopter hits the last truck with a missile; 30 s\n"
    "  no-vehicles     the helicopter and its missile, which hits the ground\n"
    "  no-missile      without shots\n"
    "  guns            demo, and the first tank fires at the ground beside the road every 6 s\n"
    "  bad-pdus        demo, with malformed PDUs in between\n"
    "  empty           without entities\n"
    "  aircraft        helicopters and aircraft in turns, and a ship\n"
    "  fly-stand       a helicopter fires at a truck that stands, for `pitviper fly`\n"
    "  fly-cross       the same at one that crosses at 15 m/s\n"
    "  fly-turn        the same at one that turns 3 s before the missile arrives\n"
    "  crowd           10 000 entities on 12 x 16 km, unlimited in time; --set scale=0.1: fewer\n"
    "\n"
    "output\n"
    "  -o, --out LOG        a recording: pcapng, or pcap if the name ends in .pcap; as fast as possible\n"
    "  --send ADDRESS       HOST, HOST:PORT, or [IPv6]:PORT; a host, a broadcast or a multicast group; port 3000;\n"
    "                       in real time, until the scenario ends or Ctrl-C\n"
    "  --overwrite          replace an existing LOG; without it that is an error\n"
    "  --datagrams DIR      write each datagram as a file to this folder\n"
    "  --places FILE        a table (CSV) of where each entity with `hide` stands: what hides it, planned and estimated "
    "share\n"
    "scenario\n"
    "  --set KEY=VALUE      one key of the scenario, such as dis.version=6, dis.bundle=true, place.lat_deg=44 or "
    "seed=7;\n"
    "                       may be repeated; vehicles.NAME.KEY=VALUE is of all vehicles of that name,\n"
    "                       shots.NAME.KEY=VALUE of all shots\n"
    "  --keys               print every key of a scenario, with its range and default\n"
    "with --send\n"
    "  --interface NAME     send from this network interface, such as eth0\n"
    "  --ttl N              multicast hops, 0 .. 255 (1)\n"
    "  --speed X            exercise seconds per second, 0.01 .. 1000, or max (1)\n";

/* ---- command line ----------------------------------------------------------------------------- */

static bool to_number(char out[dis_udp_address_size], const char *host)
{
    const struct addrinfo hints = {.ai_socktype = SOCK_DGRAM};
    struct addrinfo      *found = NULL;
    const int             failure = getaddrinfo(host, NULL, &hints, &found);
    if (failure ||
        getnameinfo(found->ai_addr, found->ai_addrlen, out, dis_udp_address_size, NULL, 0, NI_NUMERICHOST) != 0) {
        log_error("exercise: --send: no address is known for '%s': %s; give one in numbers", host,
                  gai_strerror(failure));
        if (!failure) freeaddrinfo(found);
        return false;
    }
    freeaddrinfo(found);
    return true;
}

/* HOST, HOST:PORT, [v6], [v6]:PORT; an IPv6 address by itself has two colons or more. */
static bool parse_address(DisUdpConfig *udp, const char *text)
{
    char        host[256];
    const char *from = text, *end = text + strlen(text), *port = NULL;
    if (*text == '[') {
        from = text + 1;
        end = strchr(from, ']');
        if (end && end[1] == ':') port = end + 2;
        else if (end && end[1]) end = NULL;
    } else if (strchr(text, ':') && strchr(text, ':') == strrchr(text, ':')) {
        end = strchr(text, ':');
        port = end + 1;
    }
    long long number = dis_port;
    if (!end || end == from || end - from >= (long)sizeof host ||
        (port && !(text_to_long(&number, port) && number >= 1 && number <= 65535))) {
        log_error("exercise: --send: '%s' is not HOST, HOST:PORT or [IPv6]:PORT with a port in 1 .. 65535, for example "
                  "239.1.2.3:3000",
                  text);
        return false;
    }
    memcpy(host, from, (size_t)(end - from));
    host[end - from] = 0;
    udp->port = (int)number;
    return to_number(udp->address, host);
}

static bool whole(int *out, const char *option, const char *text, int low, int high)
{
    long long number;
    if (text_to_long(&number, text) && number >= low && number <= high) {
        *out = (int)number;
        return true;
    }
    log_error("exercise: --%s: '%s' is not a whole number in %d .. %d", option, text, low, high);
    return false;
}

static bool parse_speed(double *out, const char *text)
{
    if (strcmp(text, "max") == 0) {
        *out = INFINITY;
        return true;
    }
    if (text_to_double(out, text) && *out >= 0.01 && *out <= 1000) return true;
    log_error("exercise: --speed: '%s' is neither `max` nor a number in 0.01 .. 1000", text);
    return false;
}

/* Returns 0 to go on; else the program exits with this code - 1. */
static int parse(Options *o, int argc, char **argv)
{
    enum { OUT = 'o', HELP = 'h', SEND = 256, SET, DATAGRAMS, INTERFACE, TTL, SPEED, KEYS, OVERWRITE, PLACES };
    static const struct option options[] = {{"out", 1, NULL, OUT},
                                            {"send", 1, NULL, SEND},
                                            {"set", 1, NULL, SET},
                                            {"datagrams", 1, NULL, DATAGRAMS},
                                            {"places", 1, NULL, PLACES},
                                            {"ttl", 1, NULL, TTL},
                                            {"speed", 1, NULL, SPEED},
                                            {"keys", 0, NULL, KEYS},
                                            {"interface", 1, NULL, INTERFACE},
                                            {"overwrite", 0, NULL, OVERWRITE},
                                            {"help", 0, NULL, HELP},
                                            {NULL, 0, NULL, 0}};
    const char                *of_sending = NULL; /* an option that means nothing without --send */
    optind = 0;                                   /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "o:h", options)) != -1;) {
        bool ok = true;
        if (option == INTERFACE) of_sending = "interface";
        if (option == TTL) of_sending = "ttl";
        if (option == SPEED) of_sending = "speed";
        switch (option) {
        case OUT:
            o->out = optarg;
            break;
        case SEND:
            o->send = optarg;
            break;
        case OVERWRITE:
            o->overwrite = true;
            break;
        case DATAGRAMS:
            o->datagrams = optarg;
            break;
        case PLACES:
            o->places = optarg;
            break;
        case SET:
            ok = o->set_count < max_sets;
            if (ok) o->set[o->set_count++] = optarg;
            else log_error("exercise: more than %d of --set", max_sets);
            break;
        case INTERFACE:
            ok = optarg[0] && strlen(optarg) < sizeof o->udp.interface;
            if (ok) strcpy(o->udp.interface, optarg);
            else log_error("exercise: --interface: '%s' is not the name of an interface; `ip link` lists them", optarg);
            break;
        case TTL:
            ok = whole(&o->udp.ttl, "ttl", optarg, 0, 255);
            break;
        case SPEED:
            ok = parse_speed(&o->speed, optarg);
            break;
        case KEYS:
            scenario_write_keys(stdout);
            return 1;
        case HELP:
            fputs(help, stdout);
            return 1;
        default:
            ok = false;
            break; /* reported by command_line_option */
        }
        if (!ok) return 1 + 2;
    }
    if (optind + 1 < argc)
        return 1 + command_line_wrong("exercise", "one SCENARIO at a time, not also '%s'", argv[optind + 1]);
    if (optind == argc || !(o->out || o->send || o->datagrams))
        return 1 + command_line_wrong("exercise", "%s: usage: pitviper exercise SCENARIO (-o LOG | --send ADDRESS)",
                                      optind == argc ? "no SCENARIO is named"
                                                     : "neither -o LOG nor --send ADDRESS is given");
    if (of_sending && !o->send) {
        log_error("exercise: --%s is of datagrams that are sent: give --send ADDRESS too, or leave it out", of_sending);
        return 1 + 2;
    }
    if (o->out && !dis_recorder_name("exercise: -o", o->out)) return 1 + 2;
    o->scenario = argv[optind];
    return !o->send || parse_address(&o->udp, o->send) ? 0 : 1 + 2;
}

/* ---- destinations of datagrams ----------------------------------------------------------------------- */

typedef struct Run {
    DisUdp      *udp;
    DisRecorder *recorder;
    const char  *datagrams;
    int64_t      epoch_ns;
    int          files;
    bool         failed, stopped; /* stopped: before the end of the scenario */
} Run;

/* Writes each PDU as DIR/NNNN.pdu, for the corpus of a fuzzer. */
static bool datagram_file(Run *run, const uint8_t *bytes, size_t octets)
{
    char path[path_size];
    if (!run->datagrams) return true;
    const int length = snprintf(path, sizeof path, "%s/%04d.pdu", run->datagrams, ++run->files);
    FILE     *file = length > 0 && length < (int)sizeof path ? output_file(path, 0) : NULL;
    bool      ok = file && (octets == 0 || fwrite(bytes, octets, 1, file) == 1);
    if (file && fclose(file) != 0) ok = false;
    if (!ok) log_error("exercise: cannot write %s: %s", path, output_reason(errno));
    return ok;
}

static bool take_datagram(void *user, double t_s, const uint8_t *bytes, size_t octets)
{
    Run *run = user;
    if (run->udp) dis_udp_send(run->udp, bytes, octets); /* counted when it fails */
    if (run->recorder &&
        dis_recorder_add(run->recorder, run->epoch_ns + llround(t_s * 1e9), NULL, dis_port, bytes, octets) != STATUS_OK)
        run->failed = true;
    if (!datagram_file(run, bytes, octets)) run->failed = true;
    return !run->failed;
}

/* ---- the run ---------------------------------------------------------------------------------- */

/* Sleeps until the wall clock reaches `until_s`, or a signal. Returns at once when that has passed: due datagrams
 * are sent, late or not. */
static void wait_until(double until_s)
{
    while (!stop_asked()) {
        const double left_s = until_s - wall_clock_s();
        if (!(left_s > 0)) return;
        const double          part_s = fmin(left_s, 0.1);
        const struct timespec part = {0, (long)(part_s * 1e9)};
        nanosleep(&part, NULL);
    }
}

static void show_progress(const Exercise *exercise)
{
    const ExerciseCounts *counts = exercise_counts(exercise);
    char                  text[160];
    snprintf(text, sizeof text, "%.0f s  %d entities  %llu PDUs  %llu datagrams", exercise_time(exercise),
             exercise_most_received(exercise), (unsigned long long)counts->pdus, (unsigned long long)counts->datagrams);
    log_status(text);
}

static Status play(Run *run, const Cast *cast, double epoch_unix_s, double speed)
{
    Exercise *exercise;
    Status    status = exercise_create(&exercise, cast, epoch_unix_s, take_datagram, run);
    if (status != STATUS_OK) return status;
    const double begun_s = wall_clock_s();
    double       shown_s = begun_s, time_s = 0;
    bool         more = true;
    while (more && !stop_asked()) {
        if (run->udp && isfinite(speed)) wait_until(begun_s + exercise_time(exercise) / speed);
        if (stop_asked()) break;
        time_s = exercise_time(exercise);
        more = exercise_step(exercise);
        if (wall_clock_s() - shown_s >= 1) {
            show_progress(exercise);
            shown_s = wall_clock_s();
        }
    }
    log_status(NULL);
    run->stopped = more && stop_asked();
    exercise_finish(exercise);

    const ExerciseCounts *counts = exercise_counts(exercise);
    log_print("%.1f s, %d entities, %llu PDUs, %llu datagrams, %llu octets", fmin(time_s, cast->scenario->duration_s),
              exercise_most_received(exercise), (unsigned long long)counts->pdus, (unsigned long long)counts->datagrams,
              (unsigned long long)counts->octets);
    if (counts->malformed) log_print(", %llu malformed", (unsigned long long)counts->malformed);
    if (counts->lost || counts->duplicated || counts->overtaken)
        log_print(", %llu lost, %llu twice, %llu overtaken", (unsigned long long)counts->lost,
                  (unsigned long long)counts->duplicated, (unsigned long long)counts->overtaken);
    log_print("\n");
    exercise_destroy(exercise);
    return run->failed ? STATUS_IO : STATUS_OK;
}

static Status open_outputs(Run *run, const Options *o, double epoch_unix_s)
{
    char   comment[300];
    Status status = STATUS_OK;
    if (o->datagrams && output_folder(o->datagrams) != 0) {
        log_error("exercise: cannot make %s: %s", o->datagrams, output_reason(errno));
        return STATUS_IO;
    }
    run->datagrams = o->datagrams;
    if (o->send) status = dis_udp_open_sender(&run->udp, &o->udp);
    snprintf(comment, sizeof comment, "pitviper exercise %.200s", o->scenario);
    if (status == STATUS_OK && o->out) status = dis_recorder_open(&run->recorder, o->out, comment);
    if (status == STATUS_OK && o->out) status = dis_recorder_begin(run->recorder);
    /* whole seconds and the fraction apart: a double of Unix time resolves only 0.2 us */
    run->epoch_ns = (int64_t)floor(epoch_unix_s) * 1000000000 + llround(fmod(epoch_unix_s, 1) * 1e9);
    return status;
}

int exercise_command(int argc, char **argv)
{
    Options     o = {.speed = 1, .udp = dis_udp_default_config()};
    Scenario    scenario = {0};
    Cast       *cast = NULL;
    Run         run = {0};
    PlantJudge *judge = NULL;
    const int   stop = parse(&o, argc, argv);
    if (stop) return stop - 1;

    Status status = exercise_scenario_read(&scenario, "exercise", o.scenario);
    if (status == STATUS_NO_MEMORY) log_error("exercise: out of memory");
    if (status != STATUS_OK) return 1;
    for (int i = 0; i < o.set_count; i++)
        if (!exercise_scenario_set(&scenario, "exercise", o.set[i])) {
            scenario_destroy(&scenario);
            return 2;
        }
    status = scenario_check(&scenario);
    if (status == STATUS_OK) status = plant_judge_create(&judge, "avx2");
    if (status == STATUS_OK) {
        const HideJudge hide = plant_judge_hide(judge);
        status = cast_create_judged(&cast, &scenario, &hide);
    }
    plant_judge_destroy(judge);
    if (status == STATUS_OK && o.out) status = overwrite_file("exercise", o.out, o.overwrite);
    if (status == STATUS_OK) status = exercise_places(cast, o.places, o.overwrite);
    if (status == STATUS_OK) {
        stop_by_signals();
        const double epoch_unix_s = o.send ? 1e-9 * (double)dis_udp_now_ns() : exercise_scenario_epoch(&scenario);
        status = open_outputs(&run, &o, epoch_unix_s);
        if (status == STATUS_OK) status = play(&run, cast, epoch_unix_s, o.speed);
    }
    if (status == STATUS_NO_MEMORY) log_error("exercise: out of memory");
    if (dis_recorder_close(run.recorder) != STATUS_OK) status = STATUS_IO;
    if (run.udp) {
        const DisUdpCounters counters = dis_udp_counters(run.udp);
        if (counters.send_failed && !counters.sent) {
            log_error("exercise: --send %s: none of %llu datagrams could be sent: %s; `ip route get` says where they "
                      "would leave, --interface names another way",
                      o.send, (unsigned long long)counters.send_failed, strerror(counters.send_error));
            status = STATUS_IO;
        } else if (counters.send_failed) {
            log_warn("exercise: --send %s: %llu of %llu datagrams were not taken by the network: %s", o.send,
                     (unsigned long long)counters.send_failed,
                     (unsigned long long)(counters.sent + counters.send_failed), strerror(counters.send_error));
        }
        dis_udp_close(run.udp);
    }
    cast_destroy(cast);
    scenario_destroy(&scenario);
    if (status == STATUS_OK && run.stopped && o.out) {
        log_warn("exercise: stopped before the end of the scenario: %s is whole as far as it goes", o.out);
        if (!o.send) return stop_exit_code();
    }
    return status == STATUS_OK ? 0 : 1;
}
