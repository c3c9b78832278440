/* sensor/commands/fly_command.c: `pitviper fly`: flies the missiles of a scenario with true sight: a table of how close
 * they came, over seeds, and a recording of one. */
#include "sensor/commands/commands.h"
#include "pitviper_output.h"

#include "dis/capture/recorder.h"
#include "dis/pdu/decode.h"
#include "entities/exercise/exercise.h"
#include "entities/flight/engagement.h"
#include "sensor/commands/exercise_scenario_private.h"
#include "sensor/commands/overwrite.h"
#include "sensor/commands/plant_judge.h"
#include "sensor/node/run/stop.h"
#include "sensor/settings/command_line.h"

#include <stdlib.h>

enum { max_sets = 256, max_seeds = 10000, max_misses = 100000 };

typedef struct Options {
    const char *scenario, *out, *missile;
    bool        overwrite;
    int         seeds, set_count;
    const char *set[max_sets];
} Options;

static const char help[] =
    "usage: pitviper fly SCENARIO [-o LOG] [options]\n"
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
    "  --set KEY=VALUE      one key of the scenario, such as seed=7; may be repeated; shots.NAME.KEY=VALUE is of all "
    "shots\n"
    "                       whose munition has that name: sight_every_s, sight_late_s, sight_error_m, hit_m ...\n";

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

/* Returns 0 to go on; else the program exits with this code - 1. */
static int parse(Options *o, int argc, char **argv)
{
    enum { OUT = 'o', HELP = 'h', SET = 256, OVERWRITE, MISSILE, SEEDS };
    static const struct option options[] = {{"out", 1, NULL, OUT},
                                            {"overwrite", 0, NULL, OVERWRITE},
                                            {"missile", 1, NULL, MISSILE},
                                            {"seeds", 1, NULL, SEEDS},
                                            {"set", 1, NULL, SET},
                                            {"help", 0, NULL, HELP},
                                            {NULL, 0, NULL, 0}};
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

static void print_row(const Cast *cast, const CastFlight *flight)
{
    const CastRound *round = &cast->round[flight->round];
    char             marking[12] = "", shown[64] = "";
    if (round->munition >= 0) {
        cast_marking(marking, cast, round->munition);
        text_escape(shown, sizeof shown, marking, strnlen(marking, 11));
    }
    for (char *at = shown; *at; at++)
        if (*at == ',' || *at == '"') *at = ' ';
    printf("%lld,%d,%s,%s,%.3f,%.6f,%s,%s,%.6g,%.2f,%.2f,%.4f\n", cast->scenario->seed, flight->round + 1, shown,
           cast->scenario->shot[round->shot].flies, round->fire_s, flight->flight_s, result_name(round),
           flight_end_name((FlightEnd)flight->end), flight->miss_m, flight->end_mps, flight->most_lateral_mps2,
           flight->guided_share);
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

static Status record(const Cast *cast, const Options *o)
{
    Recording    r = {0};
    Exercise    *exercise = NULL;
    char         comment[300];
    const double epoch_unix_s = exercise_scenario_epoch(cast->scenario);
    Status       status = overwrite_file("fly", o->out, o->overwrite);
    snprintf(comment, sizeof comment, "pitviper fly %.200s", o->scenario);
    r.epoch_ns = (int64_t)floor(epoch_unix_s) * 1000000000 + llround(fmod(epoch_unix_s, 1) * 1e9);
    if (status == STATUS_OK) status = dis_recorder_open(&r.recorder, o->out, comment);
    if (status == STATUS_OK) status = dis_recorder_begin(r.recorder);
    if (status == STATUS_OK) status = exercise_create(&exercise, cast, epoch_unix_s, take_datagram, &r);
    while (status == STATUS_OK && exercise_step(exercise)) {
    }
    if (exercise) exercise_finish(exercise);
    exercise_destroy(exercise);
    if (dis_recorder_close(r.recorder) != STATUS_OK || r.failed) status = STATUS_IO;
    for (int i = 0; i < cast->flight_count && status == STATUS_OK; i++)
        if (cast->round[cast->flight[i].round].impact_s > cast->scenario->duration_s)
            log_warn("fly: round %d is still in the air when the scenario ends, at %g s: no Detonation is in %s; see "
                     "duration_s",
                     cast->flight[i].round + 1, cast->scenario->duration_s, o->out);
    return status;
}

/* Closest approaches so far. */
typedef struct Misses {
    int    count;
    double miss_m[max_misses];
} Misses;

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
        print_row(cast, &cast->flight[i]);
        if (misses->count < max_misses) misses->miss_m[misses->count++] = cast->flight[i].miss_m;
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
        puts("seed,round,munition,missile,fire_s,flight_s,hit,end,miss_m,end_mps,most_lateral_mps2,guided_share");
        for (int i = 0; i < o->seeds && status == STATUS_OK && !stop_asked(); i++, scenario->seed++)
            status = fly_seed(misses, scenario, &hide, o);
        if (fflush(stdout) != 0 || ferror(stdout)) {
            log_error("fly: cannot write the table");
            status = STATUS_IO;
        }
        if (status == STATUS_OK && misses->count > 1) print_cep(misses);
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

int fly_command(int argc, char **argv)
{
    Options   o = {.seeds = 1};
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
    status = fly_by(&scenario, &o);
    if (status == STATUS_OK) status = fly(&scenario, &o);
    if (status == STATUS_NO_MEMORY) log_error("fly: out of memory");
    scenario_destroy(&scenario);
    if (status == STATUS_OK && stop_asked()) return stop_exit_code();
    return status == STATUS_OK ? 0 : 1;
}
