/* main.c: the table of commands, their common options, and `probe` and `help`. */
#include "entities/probe.h"
#include "render/probe.h"
#include "sensor/commands/commands.h"
#include "sensor/bench/sensor/suites.h"
#include "sensor/node/run/stop.h"
#include "sensor/probe.h"
#include "sensor/reference/reference.h"
#include "sensor/verify/regress/regress.h"
#include "sensor/settings/config.h"
#include "sensor/settings/command_line.h"
#include "terrain/probe.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- the probes of all folders ---------------------------------------------------------------------- */

typedef struct RoomList {
    const void *first;
    size_t      size;  /* of one */
    const int  *count;
} RoomList;
#define ROOM_LIST(list, count) {list, sizeof *(list), &(count)}

static const RoomList probe_lists[] = {
    ROOM_LIST(terrain_probes, terrain_probe_count),
    ROOM_LIST(entities_probes, entities_probe_count),
    ROOM_LIST(render_probes, render_probe_count),
    ROOM_LIST(sensor_probes, sensor_probe_count),
};

/* state: list, index in it; starts zeroed. NULL: end. */
static const void *next_of(const RoomList *list, size_t lists, size_t state[2])
{
    for (; state[0] < lists; state[0]++, state[1] = 0) {
        const RoomList *at = &list[state[0]];
        if (state[1] < (size_t)*at->count) return (const char *)at->first + at->size * state[1]++;
    }
    return NULL;
}

static const Probe *next_probe(size_t state[2])
{
    return next_of(probe_lists, sizeof probe_lists / sizeof *probe_lists, state);
}

static void probe_usage(FILE *to)
{
    size_t state[2] = {0};
    fputs("usage: pitviper probe [-c FILE] WHAT [ARGUMENT ...] < rows.csv > results.csv\n\n"
          "Evaluates one model for rows of CSV with a header: writes each row with the results appended. Other "
          "columns pass\n"
          "through; a row that cannot be computed has the reason in column `error`. $: text column, ?: optional "
          "column.\n"
          "-c FILE, or --config: settings, whose models.materials are read.\n", to);
    for (const Probe *probe; (probe = next_probe(state));)
        fprintf(to, "\n  %s%s%s\n      %s\n      in:  %s\n      out: %s\n", probe->name, probe->arguments ? " " : "",
                probe->arguments ? probe->arguments : "", probe->help, probe->in, probe->out);
}

static int probe_command(int argc, char **argv)
{
    size_t state[2] = {0};
    if (argc < 2) return command_line_wrong("probe", "no probe is named: usage: pitviper probe WHAT [ARGUMENT ...] < rows.csv");
    WordMeant meant = word_meant(argv[1]);
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            probe_usage(stdout);
            return 0;
        }
    if (strcmp(argv[1], "-c") == 0 || strcmp(argv[1], "--config") == 0) {
        if (argc < 4) return command_line_wrong("probe", "%s needs a file of settings, and after it a probe", argv[1]);
        if (config_tables_of(argv[2]) != STATUS_OK) return 1;
        argc -= 2, argv += 2;
        meant = word_meant(argv[1]);
    }
    for (const Probe *probe; (probe = next_probe(state));) {
        word_consider(&meant, probe->name);
        if (strcmp(argv[1], probe->name) != 0) continue;
        if (!probe->arguments && argc > 2)
            return command_line_wrong("probe", "%s takes no argument, but '%s' was given; rows are read from standard input",
                              probe->name, argv[2]);
        return probe_run(probe, argc - 1, argv + 1, stdin, stdout) == STATUS_OK ? 0 : 1;
    }
    return command_line_wrong("probe", "no such %s: %s%s", argv[1][0] == '-' ? "option" : "probe", argv[1], word_hint(&meant));
}

static int run_bench(int argc, char **argv) { return bench_command(argc, argv, bench_next_suite); }

/* ---- the commands ----------------------------------------------------------------------------- */

static const struct Command {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *help;
    bool        reads_tables; /* of etc/, except with --default and --keys */
    bool        only_prints;  /* and ends when what reads that has gone */
} commands[] = {
    {"run", run_command, "render a live exercise on the network", true, false},
    {"replay", replay_command, "render what a missile's seeker sees in a recorded exercise", true, false},
    {"frame", frame_command, "re-render one saved frame without its log and verify that it is the same to the bit",
     true, false},
    {"regress", regress_command, "re-render recorded exercises and compare them with approved baselines", true, false},
    {"inspect", inspect_command, "list the entities of a recording, what they did, what was malformed", true, true},
    {"check", check_command, "validate a configuration file; or print one to start from", true, true},
    {"exercise", exercise_command, "generate an exercise from a scenario: record it or send it", true, false},
    {"record", record_command, "record an exercise from the network", false, false},
    {"model", model_command, "list models; describe or draw one, built in or from a file", true, false},
    {"heat", heat_command, "a vehicle's temperatures over a clear day: table, plot and thermal images", true, false},
    {"rcs", rcs_command, "a target's radar cross section over aspect: table, polar plot and a radar image", true, false},
    {"terrain", terrain_command, "make a terrain store from elevation, land cover and photographs; describe one", true, false},
    {"probe", probe_command, "evaluate one model for rows of CSV: Planck, sun, geoid, atmosphere, rays ...", false, true},
    {"bench", run_bench, "benchmark this build on this machine: times with their errors", true, false},
};
enum { command_count = sizeof commands / sizeof commands[0] };

static const char common_help[] =
    "  -q, --quiet        only errors, warnings and requested output: no choices, progress, notices or summary\n"
    "  -v, --verbose      also the tables, settings and models read, and where the time goes\n"
    "  -h, --help         print the help of the command\n"
    "  -V, --version      print the version\n";

static void usage(FILE *to)
{
    fputs("pitviper " PITVIPER_VERSION ": multispectral sensor simulation on DIS networks\n\n"
          "usage: pitviper COMMAND ...; `pitviper COMMAND --help` lists its options\n\n", to);
    for (int i = 0; i < command_count; i++) fprintf(to, "  %-10s %s\n", commands[i].name, commands[i].help);
    fprintf(to, "\nEvery command takes, before or after its name:\n\n%s", common_help);
    fputs("\nevery field of every product, with Python to read it: `pitviper help TOPIC`; topics:\n", to);
    reference_list(to);
    fputs("\nall topics as Markdown: `pitviper help --markdown`\n", to);
}

/* ---- streams, environment, command line ---------------------------------------------------------------- */

/* If standard input, output or error is closed (`>&-`), the next file opened would get its descriptor and messages
 * would be written into recordings. /dev/null takes their place; read-only, so that printing fails and is reported. */
static void fill_closed(void)
{
    int fd;
    while ((fd = open("/dev/null", O_RDONLY)) >= 0 && fd <= STDERR_FILENO) {}
    if (fd > STDERR_FILENO) close(fd);
}

static bool environment_good(const struct Command *command, int argc, char **argv)
{
    const char *etc = getenv("PITVIPER_ETC");
    struct stat there;
    bool        reads = command->reads_tables;
    for (int i = 1; i < argc; i++) reads &= strcmp(argv[i], "--default") != 0 && strcmp(argv[i], "--keys") != 0;
    if (!etc || (stat(etc, &there) == 0 && S_ISDIR(there.st_mode))) return !reads || etc_is_complete();
    log_error("PITVIPER_ETC: there is no folder '%s'; unset it, or name the one that holds catalog.csv", etc);
    return false;
}

/* Whether standard output is a pipe that its reader has left. */
static bool reader_has_gone(void)
{
    struct pollfd out = {.fd = STDOUT_FILENO};
    return poll(&out, 1, 0) == 1 && out.revents & POLLERR;
}

/* Exit code 1 when the output could not be written; a reader that has left before the end is no failure. */
static int printed(int code)
{
    if (fflush(stdout) == 0 && !ferror(stdout)) return code;
    if (reader_has_gone()) return code;
    if (code == 0) log_error("cannot write the output: %s", errno ? strerror(errno) : "it is closed");
    return code ? code : 1;
}

/* Removes -q and -v before any `--` from the command line. False, logged, when both are given. */
static bool take_verbosity(int *argc, char **argv)
{
    bool quiet = false, verbose = false, open = true;
    int  kept = 1;
    for (int i = 1; i < *argc; i++) {
        const bool q = open && (strcmp(argv[i], "-q") == 0 || strcmp(argv[i], "--quiet") == 0);
        const bool v = open && (strcmp(argv[i], "-v") == 0 || strcmp(argv[i], "--verbose") == 0);
        open &= strcmp(argv[i], "--") != 0;
        quiet |= q, verbose |= v;
        if (!q && !v) argv[kept++] = argv[i];
    }
    argv[*argc = kept] = NULL;
    if (quiet && verbose) log_error("--quiet and --verbose exclude each other; leave one out");
    else if (quiet) log_set_level(LOG_WARN);
    else if (verbose) log_set_level(LOG_DETAIL);
    return !(quiet && verbose);
}

/* Whether an option is anywhere before `--`. */
static bool asks_for(const char *name, const char *letter, int argc, char **argv)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++)
        if (strcmp(argv[i], name) == 0 || strcmp(argv[i], letter) == 0) return true;
    return false;
}

static int unknown(const char *what, const char *typed, bool topics_too)
{
    char      topics[1024] = "";
    WordMeant meant = word_meant(typed);
    FILE     *list = topics_too ? fmemopen(topics, sizeof topics - 1, "w") : NULL;
    for (int i = 0; i < command_count; i++) word_consider(&meant, commands[i].name);
    word_consider(&meant, "help");
    if (typed[0] == '-') word_consider_list(&meant, "--help|--version", '|');
    if (list) {
        reference_list(list);
        fclose(list);
        word_consider_list(&meant, topics, ' ');
    }
    const char *hint = word_hint(&meant);
    log_error("no such %s: %s%s `pitviper --help` lists them", what, typed, *hint ? hint : ";");
    return 2;
}

static int run_named(int argc, char **argv)
{
    char called[64];
    for (int i = 0; i < command_count; i++) {
        if (strcmp(argv[0], commands[i].name) != 0) continue;
        const bool help = asks_for("--help", "-h", argc, argv);
        if (asks_for("--version", "-V", argc, argv)) {
            puts("pitviper " PITVIPER_VERSION);
            return 0;
        }
        if (!help && !environment_good(&commands[i], argc, argv)) return 1;
        snprintf(called, sizeof called, "pitviper %s", argv[0]);
        if (!commands[i].only_prints) stop_outlive_readers();
        argv[0] = called; /* program name in getopt's messages */
        const int code = commands[i].run(argc, argv);
        if (help && code == 0) printf("\n%s", common_help);
        return code;
    }
    return unknown(argv[0][0] == '-' ? "option" : "command", argv[0], false);
}

/* `pitviper help` COMMAND, TOPIC, or --markdown. */
static int help_command(int argc, char **argv)
{
    static char help[] = "--help";
    if (argc > 1) {
        log_error("help: takes one command or topic, not also '%s'", argv[1]);
        return 2;
    }
    for (int i = 0; i < command_count; i++)
        if (strcmp(argv[0], commands[i].name) == 0) return run_named(2, (char *[]){argv[0], help, NULL});
    if (strcmp(argv[0], "--markdown") == 0) {
        reference_write_markdown(stdout);
        return 0;
    }
    if (reference_write(stdout, argv[0])) return 0;
    return unknown("command or topic", argv[0], true);
}

int main(int argc, char **argv)
{
    fill_closed();
    thread_flush_denormals(); /* so that a probe computes as a frame does */
    if (!take_verbosity(&argc, argv)) return 2;
    if (argc < 2) {
        log_error("no command is given; `pitviper --help` lists them, `pitviper replay LOG` renders a recording");
        return 2;
    }
    if (argc > 2 && strcmp(argv[1], "help") == 0) return printed(help_command(argc - 2, argv + 2));
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0) {
        usage(stdout);
        return printed(0);
    }
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0) {
        puts("pitviper " PITVIPER_VERSION);
        return printed(0);
    }
    return printed(run_named(argc - 1, argv + 1));
}
