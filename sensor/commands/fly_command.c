/* sensor/commands/fly_command.c: `pitviper fly`: flies the missiles of a scenario with true sight, or one by what is
 * seen in its own frames: a table of how close they came, over seeds, and a recording of one. */
#include "sensor/commands/commands.h"
#include "pitviper_output.h"

#include "dis/capture/recorder.h"
#include "dis/pdu/decode.h"
#include "entities/exercise/exercise.h"
#include "entities/flight/engagement.h"
#include "sensor/commands/exercise_scenario_private.h"
#include "sensor/commands/fly_loop_private.h"
#include "sensor/commands/fly_plot_private.h"
#include "sensor/commands/overwrite.h"
#include "sensor/commands/plant_judge.h"
#include "sensor/node/run/stop.h"
#include "sensor/settings/command_line.h"

#include <stdlib.h>

enum { max_sets = 256, max_seeds = 10000, max_misses = 100000 };

typedef struct Options {
    const char *scenario, *out, *missile, *plot;
    bool        overwrite;
    int         seeds, set_count;
    bool        waits; /* --limit or --start is given */
    const char *set[max_sets];
    FlyLoop     loop;
} Options;

static const char help[] =
    "usage: pitviper fly SCENARIO [-o LOG] [options] [-- OPTIONS OF THE FRAMES]\n"
    "\n"
    "Flies the missiles of a scenario (shots with `flies: ROW` of etc/missiles.csv) with true sight of their targets, and "
    "prints a\n"
    "table (CSV): how each flight ended and how close it came. SCENARIO is a YAML file, or the name of a bundled one, as "
    "of\n"
    "`pitviper exercise`, which sends the same Fire, Entity States and Detonation.\n"
    "\n"
    "  -o, --out LOG        a recording of the exercise, for `pitviper replay`; of one seed\n"
    "  --overwrite          replace an existing LOG; without it that is an error\n"
    "  --missile ROW        all shots whose munitions are entities, and that name no other row, fly by this row\n"
    "  --seeds N            the scenario's seed and the N - 1 after it; then the circular error probable (CEP): the median\n"
    "                       of the closest approaches, with its 95 % interval by order statistics, 6 flights or more\n"
    "  --plot FILE          paths of the flights (the first 100) as SVG, from the side and from above\n"
    "  --set KEY=VALUE      one key of the scenario, such as seed=7; may be repeated; shots.NAME.KEY=VALUE is of all "
    "shots\n"
    "                       whose munition has that name: sight_every_s, sight_late_s, sight_error_m, hit_m ...\n"
    "\n"
    "In the loop: missiles one after the other, whose seeker's frames are rendered as they fly, and guide them. Options of "
    "`pitviper\n"
    "replay` for the frames follow --, as --size, --bands, --rate (20), --set.\n"
    "  --frames DIR         renders, into DIR; without --recogniser the line of sight of each frame is the true one\n"
    "  --sight WHAT         without --recogniser: truth, or radar: the strongest detection of radar.preset in the gate\n"
    "  --recogniser COMMAND a program that answers each frame by UDP (`pitviper help answers`); by /bin/sh, with\n"
    "                       PITVIPER_MEMORY, PITVIPER_PORT and PITVIPER_OUT in its environment; DIR/sights.csv has its "
    "answers\n"
    "  --limit S            longest wait for an answer (2); then the missile has none to that frame\n"
    "  --start S            the same for the first (30)\n"
    "  --sights FILE        flies by the answers of a flight before, its sights.csv: to the same bits\n";

static bool whole(int *out, const char *text)
{
    long long number;
    if (text_to_long(&number, text) && number >= 1 && number <= max_seeds) {
        *out = (int)number;
        return true;
    }
    log_error("fly: --seeds: '%s' is not a whole number in 1 .. %d", text, max_seeds);
    return false;
}

static bool seconds(double *out, const char *name, const char *text)
{
    if (text_to_double(out, text) && *out > 0 && *out <= 3600) return true;
    log_error("fly: --%s: '%s' is not a time in seconds above 0, up to 3600", name, text);
    return false;
}

/* Whether what is given goes together. */
static int parse_wrong(const Options *o)
{
    if (o->loop.recogniser && o->loop.sights)
        return command_line_wrong("fly", "--sights has the answers of a flight before: without --recogniser");
    if (o->loop.radar && (o->loop.sights || o->loop.recogniser))
        return command_line_wrong("fly", "--sight radar: without --recogniser and --sights");
    if (o->loop.sights && o->seeds > 1) return command_line_wrong("fly", "--sights is of one flight: without --seeds");
    if (o->waits && !o->loop.recogniser)
        return command_line_wrong("fly",
                                  "--limit and --start are of a recogniser's answers: with --recogniser COMMAND");
    if (o->loop.given_count > 0 && !fly_loop_asked(&o->loop))
        return command_line_wrong("fly", "options after -- are of frames: with --frames DIR or --recogniser COMMAND");
    return 0;
}

/* Returns 0 to go on; else the program exits with this code - 1. */
static int parse(Options *o, int argc, char **argv)
{
    enum {
        OUT = 'o',
        HELP = 'h',
        SET = 256,
        OVERWRITE,
        MISSILE,
        SEEDS,
        FRAMES,
        RECOGNISER,
        LIMIT,
        START,
        SIGHTS,
        SIGHT,
        PLOT
    };
    static const struct option options[] = {{"out", 1, NULL, OUT},         {"overwrite", 0, NULL, OVERWRITE},
                                            {"missile", 1, NULL, MISSILE}, {"seeds", 1, NULL, SEEDS},
                                            {"set", 1, NULL, SET},         {"plot", 1, NULL, PLOT},
                                            {"frames", 1, NULL, FRAMES},   {"recogniser", 1, NULL, RECOGNISER},
                                            {"limit", 1, NULL, LIMIT},     {"start", 1, NULL, START},
                                            {"sights", 1, NULL, SIGHTS},   {"sight", 1, NULL, SIGHT},
                                            {"help", 0, NULL, HELP},       {NULL, 0, NULL, 0}};
    for (int i = 1; i < argc; i++) /* what follows is of the frames */
        if (strcmp(argv[i], "--") == 0) {
            o->loop.given = argv + i + 1;
            o->loop.given_count = argc - i - 1;
            argc = i;
        }
    if (o->loop.given_count > fly_loop_given_most)
        return 1 + command_line_wrong("fly", "more than %d words after --", fly_loop_given_most);
    optind = 0; /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "o:h", options)) != -1;) {
        bool ok = true;
        switch (option) {
        case OUT:
            o->out = optarg;
            break;
        case OVERWRITE:
            o->overwrite = true;
            break;
        case MISSILE:
            o->missile = optarg;
            break;
        case SEEDS:
            ok = whole(&o->seeds, optarg);
            break;
        case SET:
            ok = o->set_count < max_sets;
            if (ok) o->set[o->set_count++] = optarg;
            else log_error("fly: more than %d of --set", max_sets);
            break;
        case PLOT:
            o->plot = optarg;
            break;
        case FRAMES:
            o->loop.frames = optarg;
            break;
        case RECOGNISER:
            o->loop.recogniser = optarg;
            break;
        case LIMIT:
            ok = seconds(&o->loop.limit_s, "limit", optarg);
            o->waits = true;
            break;
        case START:
            ok = seconds(&o->loop.start_s, "start", optarg);
            o->waits = true;
            break;
        case SIGHTS:
            o->loop.sights = optarg;
            break;
        case SIGHT:
            o->loop.radar = strcmp(optarg, "radar") == 0;
            ok = o->loop.radar || strcmp(optarg, "truth") == 0;
            if (!ok)
                log_error(
                    "fly: --sight: '%s' is neither truth nor radar; a recogniser is --recogniser COMMAND, an operator "
                    "steers in `pitviper run --fly ROW`",
                    optarg);
            break;
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
        return 1 + command_line_wrong("fly", "one SCENARIO at a time, not also '%s'", argv[optind + 1]);
    if (optind == argc)
        return 1 + command_line_wrong("fly", "no SCENARIO is named: usage: pitviper fly SCENARIO [-o LOG]");
    if (o->out && o->seeds > 1)
        return 1 + command_line_wrong("fly", "-o LOG is of one seed: leave --seeds out, and give --set seed=N");
    if (o->out && !dis_recorder_name("fly: -o", o->out)) return 1 + 2;
    const int wrong = parse_wrong(o);
    if (wrong) return 1 + wrong;
    o->loop.overwrite = o->overwrite;
    o->loop.several = o->seeds > 1;
    o->scenario = argv[optind];
    return 0;
}

/* ---- one seed -------------------------------------------------------------------------------------- */

static const char *result_name(const CastRound *round)
{
    switch (round->result) {
    case dis_result_entity_impact:
        return "entity";
    case dis_result_ground_impact:
        return "ground";
    default:
        return "none";
    }
}

static void print_row(const Cast *cast, const CastFlight *flight, const FlyLoopCounts *counts)
{
    const CastRound *round = &cast->round[flight->round];
    char             marking[12] = "", shown[64] = "";
    if (round->munition >= 0) {
        cast_marking(marking, cast, round->munition);
        text_escape(shown, sizeof shown, marking, strnlen(marking, 11));
    }
    for (char *at = shown; *at; at++)
        if (*at == ',' || *at == '"') *at = ' ';
    printf("%lld,%d,%s,%s,%.3f,%.6f,%s,%s,%.6g,%.2f,%.2f,%.4f", cast->scenario->seed, flight->round + 1, shown,
           cast->scenario->shot[round->shot].flies, round->fire_s, flight->flight_s, result_name(round),
           flight_end_name((FlightEnd)flight->end), flight->miss_m, flight->end_mps, flight->most_lateral_mps2,
           flight->guided_share);
    if (counts)
        printf(",%d,%d,%d,%d,%d,%llu", counts->frames, counts->verdicts[LOOP_SEEN], counts->verdicts[LOOP_EMPTY],
               counts->verdicts[LOOP_OUTSIDE], counts->verdicts[LOOP_NONE], (unsigned long long)counts->late);
    putchar('\n');
}

typedef struct Recording {
    DisRecorder *recorder;
    int64_t      epoch_ns;
    bool         failed;
} Recording;

static bool take_datagram(void *user, double t_s, const uint8_t *bytes, size_t octets)
{
    Recording *r = user;
    if (dis_recorder_add(r->recorder, r->epoch_ns + llround(t_s * 1e9), NULL, dis_port, bytes, octets) != STATUS_OK)
        r->failed = true;
    return !r->failed && !stop_asked();
}

/* Writes the exercise of a cast. */
static Status write_exercise(const Cast *cast, const char *path, const char *comment)
{
    Recording    r = {0};
    Exercise    *exercise = NULL;
    const double epoch_unix_s = exercise_scenario_epoch(cast->scenario);
    Status       status = STATUS_OK;
    r.epoch_ns = (int64_t)floor(epoch_unix_s) * 1000000000 + llround(fmod(epoch_unix_s, 1) * 1e9);
    if (status == STATUS_OK) status = dis_recorder_open(&r.recorder, path, comment);
    if (status == STATUS_OK) status = dis_recorder_begin(r.recorder);
    if (status == STATUS_OK) status = exercise_create(&exercise, cast, epoch_unix_s, take_datagram, &r);
    while (status == STATUS_OK && exercise_step(exercise)) {
    }
    if (exercise) exercise_finish(exercise);
    exercise_destroy(exercise);
    if (dis_recorder_close(r.recorder) != STATUS_OK || r.failed) status = STATUS_IO;
    return status;
}

static Status record(const Cast *cast, const Options *o)
{
    char   comment[300];
    Status status = overwrite_file("fly", o->out, o->overwrite);
    snprintf(comment, sizeof comment, "pitviper fly %.200s", o->scenario);
    if (status == STATUS_OK) status = write_exercise(cast, o->out, comment);
    for (int i = 0; i < cast->flight_count && status == STATUS_OK; i++)
        if (cast->round[cast->flight[i].round].impact_s > cast->scenario->duration_s)
            log_warn("fly: round %d is still in the air when the scenario ends, at %g s: no Detonation is in %s; see "
                     "duration_s",
                     cast->flight[i].round + 1, cast->scenario->duration_s, o->out);
    return status;
}

/* Closest approaches, and paths, so far. */
typedef struct Misses {
    int      count;
    double   miss_m[max_misses];
    FlyPaths paths;
} Misses;

static void take(Misses *misses, const Cast *cast, const CastFlight *flight, const Options *o)
{
    if (misses->count < max_misses) misses->miss_m[misses->count++] = flight->miss_m;
    if (o->plot) fly_paths_take(&misses->paths, cast, flight);
}

/* By what is seen in their frames. */
static Status fly_in_loop(Misses *misses, Scenario *scenario, const HideJudge *hide, const Options *o)
{
    Cast          *cast = NULL;
    FlyLoopCounts *counts = NULL;
    const Scenario as_given = *scenario;
    Status         status = cast_create_held(&cast, scenario, hide);
    if (status == STATUS_OK && !(counts = calloc((size_t)cast->flight_count, sizeof *counts)))
        status = STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = fly_loop_seed(counts, cast, scenario, &o->loop, write_exercise);
    for (int i = 0; status == STATUS_OK && !stop_asked() && i < cast->flight_count; i++) {
        print_row(cast, &cast->flight[i], &counts[i]);
        take(misses, cast, &cast->flight[i], o);
    }
    fflush(stdout);
    if (status == STATUS_OK && !stop_asked() && o->out) status = record(cast, o);
    cast_destroy(cast);
    free(counts);
    scenario->duration_s = as_given.duration_s;
    scenario->dis.threshold_m = as_given.dis.threshold_m;
    return status;
}

static Status fly_seed(Misses *misses, const Scenario *scenario, const HideJudge *hide, const Options *o)
{
    Cast  *cast = NULL;
    Status status = cast_create_judged(&cast, scenario, hide);
    if (status == STATUS_OK && cast->flight_count == 0) {
        log_error(
            "fly: %s: no shot flies: give --missile ROW, or `flies: ROW` with its shots; etc/missiles.csv has the "
            "rows",
            scenario->path);
        status = STATUS_BAD_VALUE;
    }
    for (int i = 0; status == STATUS_OK && i < cast->flight_count; i++) {
        print_row(cast, &cast->flight[i], NULL);
        take(misses, cast, &cast->flight[i], o);
    }
    if (status == STATUS_OK && o->out) status = record(cast, o);
    cast_destroy(cast);
    return status;
}

/* ---- over seeds ------------------------------------------------------------------------------------ */

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The largest rank k, from 1, with P(B < k) <= 2.5 % for B of count throws of a coin: the k-th smallest and the k-th
 * largest enclose the median in 95 % and more; 0: too few. */
static int median_rank(int count)
{
    double term = pow(0.5, count), below = 0; /* log-free: 0.5^1074 is the least double; beyond, the normal limit */
    if (count > 1000) return (int)floor(0.5 * (count + 1) - 1.959964 * 0.5 * sqrt(count));
    for (int k = 0; k < count; k++) {
        below += term;
        if (below > 0.025) return k;
        term *= (double)(count - k) / (k + 1);
    }
    return 0;
}

static void print_cep(Misses *m)
{
    qsort(m->miss_m, (size_t)m->count, sizeof *m->miss_m, compare);
    const int    half = m->count / 2, k = median_rank(m->count);
    const double cep_m = m->count % 2 ? m->miss_m[half] : 0.5 * (m->miss_m[half - 1] + m->miss_m[half]);
    log_print("CEP %.4g m over %d flights", cep_m, m->count);
    if (k > 0) log_print(", 95 %% interval %.4g .. %.4g m", m->miss_m[k - 1], m->miss_m[m->count - k]);
    log_print("\n");
}

static Status fly(Scenario *scenario, const Options *o)
{
    PlantJudge *judge = NULL;
    Misses     *misses = calloc(1, sizeof *misses);
    Status      status = misses ? plant_judge_create(&judge, "avx2") : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        const HideJudge hide = plant_judge_hide(judge);
        const bool      loop = fly_loop_asked(&o->loop);
        printf("seed,round,munition,missile,fire_s,flight_s,hit,end,miss_m,end_mps,most_lateral_mps2,guided_share%s\n",
               loop ? ",frames,seen,empty,outside,none,late" : "");
        for (int i = 0; i < o->seeds && status == STATUS_OK && !stop_asked(); i++, scenario->seed++)
            status = loop ? fly_in_loop(misses, scenario, &hide, o) : fly_seed(misses, scenario, &hide, o);
        if (fflush(stdout) != 0 || ferror(stdout)) {
            log_error("fly: cannot write the table");
            status = STATUS_IO;
        }
        if (status == STATUS_OK && misses->count > 1) print_cep(misses);
        if (status == STATUS_OK && o->plot) status = fly_paths_write(&misses->paths, o->plot, o->scenario);
    }
    plant_judge_destroy(judge);
    free(misses);
    return status;
}

static Status fly_by(Scenario *scenario, const Options *o)
{
    for (int i = 0; o->missile && i < scenario->shot_count; i++) {
        ScenarioShot *shot = &scenario->shot[i];
        if (!shot->entity || *shot->flies) continue;
        if (strlen(o->missile) >= sizeof shot->flies) {
            log_error("fly: --missile: '%s' is longer than %zu letters", o->missile, sizeof shot->flies - 1);
            return STATUS_BAD_VALUE;
        }
        snprintf(shot->flies, sizeof shot->flies, "%s", o->missile);
    }
    return scenario_check(scenario);
}

/* Each flight with frames has a node, whose seed is the scenario's. */
static Status check_seeds(const Scenario *scenario, const Options *o)
{
    static const long long most = 2147483647; /* as `seed` of a node */
    if (!fly_loop_asked(&o->loop) || scenario->seed + o->seeds - 1 <= most) return STATUS_OK;
    log_error("fly: seed: flights with frames have seeds up to %lld, those of a node: not %lld", most,
              (long long)scenario->seed + o->seeds - 1);
    return STATUS_BAD_VALUE;
}

int fly_command(int argc, char **argv)
{
    Options   o = {.seeds = 1, .loop = {.limit_s = 2, .start_s = 30}};
    Scenario  scenario = {0};
    const int stop = parse(&o, argc, argv);
    if (stop) return stop - 1;
    Status status = exercise_scenario_read(&scenario, "fly", o.scenario);
    if (status == STATUS_NO_MEMORY) log_error("fly: out of memory");
    if (status != STATUS_OK) return 1;
    for (int i = 0; i < o.set_count; i++)
        if (!exercise_scenario_set(&scenario, "fly", o.set[i])) {
            scenario_destroy(&scenario);
            return 2;
        }
    stop_by_signals();
    if (fly_loop_asked(&o.loop)) thread_flush_denormals();
    status = check_seeds(&scenario, &o);
    if (status == STATUS_OK) status = fly_by(&scenario, &o);
    if (status == STATUS_OK && o.plot) status = overwrite_file("fly", o.plot, o.overwrite);
    if (status == STATUS_OK) status = fly(&scenario, &o);
    if (status == STATUS_NO_MEMORY) log_error("fly: out of memory");
    scenario_destroy(&scenario);
    if (status == STATUS_OK && stop_asked()) return stop_exit_code();
    return status == STATUS_OK ? 0 : 1;
}
