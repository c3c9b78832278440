/* main.c: the table of commands, and `probe`, `bench` and `help`. */
#include "entities/probe.h"
#include "render/probe.h"
#include "sensor/commands/commands.h"
#include "sensor/node/run/stop.h"
#include "sensor/commands/program.h"
#include "sensor/probe.h"
#include "sensor/reference/reference.h"
#include "sensor/settings/config.h"
#include "sensor/settings/command_line.h"
#include "terrain/probe.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- the probes of all folders ---------------------------------------------------------------------- */

typedef struct RoomList {
    const void *first;
    size_t      size; /* of one */
    const int  *count;
} RoomList;
#define ROOM_LIST(list, count)                                                                                         \
    {                                                                                                                  \
        list, sizeof *(list), &(count)                                                                                 \
    }

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
          "-c FILE, or --config: settings, whose models.materials are read.\n",
          to);
    for (const Probe *probe; (probe = next_probe(state));)
        fprintf(to, "\n  %s%s%s\n      %s\n      in:  %s\n      out: %s\n", probe->name, probe->arguments ? " " : "",
                probe->arguments ? probe->arguments : "", probe->help, probe->in, probe->out);
}

static int probe_command(int argc, char **argv)
{
    size_t state[2] = {0};
    if (argc < 2)
        return command_line_wrong("probe", "no probe is named: usage: pitviper probe WHAT [ARGUMENT ...] < rows.csv");
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
            return command_line_wrong("probe",
                                      "%s takes no argument, but '%s' was given; rows are read from standard input",
                                      probe->name, argv[2]);
        return probe_run(probe, argc - 1, argv + 1, stdin, stdout) == STATUS_OK ? 0 : 1;
    }
    return command_line_wrong("probe", "no such %s: %s%s", argv[1][0] == '-' ? "option" : "probe", argv[1],
                              word_hint(&meant));
}

/* ---- the benches ------------------------------------------------------------------------------------ */

/* Another program, pitviper-bench: the one beside this, else the first on PATH, takes this one's place. */
static int run_bench(int argc, char **argv)
{
    static char   name[] = "pitviper-bench", quiet[] = "--quiet", verbose[] = "--verbose";
    char          path[PATH_MAX + sizeof name];
    const ssize_t length = readlink("/proc/self/exe", path, PATH_MAX);
    char        **words = calloc((size_t)argc + 2, sizeof *words);
    int           count = 0;
    if (!words) return 1;
    path[length > 0 ? length : 0] = 0;
    char *slash = strrchr(path, '/');
    words[count++] = name;
    if (log_is_quiet()) words[count++] = quiet;
    else if (log_is_verbose()) words[count++] = verbose;
    for (int i = 1; i < argc; i++) words[count++] = argv[i];
    if (slash) {
        strcpy(slash + 1, name);
        execv(path, words);
    }
    execvp(name, words);
    const int reason = errno;
    free(words);
    log_error(
        "bench: cannot run pitviper-bench, neither beside pitviper nor on PATH: %s; build it (cmake --build FOLDER "
        "--target pitviper-bench) or install it beside pitviper",
        strerror(reason));
    return 1;
}

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
    {"explain", explain_command, "what one pixel of a saved frame is made of: rays, surfaces, light, air, detector",
     true, true},
    {"regress", regress_command, "re-render recorded exercises and compare them with approved baselines", true, false},
    {"score", score_command, "score a recogniser's answers against the truth of a run", true, false},
    {"inspect", inspect_command, "list the entities of a recording, what they did, what was malformed", true, true},
    {"check", check_command, "validate a configuration file; or print one to start from", true, true},
    {"exercise", exercise_command, "generate an exercise from a scenario: record it or send it", true, false},
    {"fly", fly_command, "fly the missiles of a scenario with true sight: how close they come; record it", true, false},
    {"record", record_command, "record an exercise from the network", false, false},
    {"model", model_command, "list models; describe or draw one, built in or from a file", true, false},
    {"heat", heat_command, "a vehicle's temperatures over a clear day: table, plot and thermal images", true, false},
    {"range", range_command, "how far a sensor's observer detects, recognises, identifies: table and plot", true,
     false},
    {"rcs", rcs_command, "a target's radar cross section over aspect: table, polar plot and a radar image", true,
     false},
    {"terrain", terrain_command, "make a terrain store from elevation, land cover and photographs; describe one", true,
     false},
    {"probe", probe_command, "evaluate one model for rows of CSV: Planck, sun, geoid, atmosphere, rays ...", false,
     true},
    {"bench", run_bench, "benchmark this build on this machine: times with their errors", false, false},
};
enum { command_count = sizeof commands / sizeof commands[0] };

static void usage(FILE *to)
{
    fputs("pitviper " PITVIPER_VERSION ": multispectral sensor simulation on DIS networks\n\n"
          "usage: pitviper COMMAND ...; `pitviper COMMAND --help` lists its options\n\n",
          to);
    for (int i = 0; i < command_count; i++) fprintf(to, "  %-10s %s\n", commands[i].name, commands[i].help);
    fprintf(to, "\nEvery command takes, before or after its name:\n\n%s", program_common_help);
    fputs("\nevery field of every product, with Python to read it: `pitviper help TOPIC`; topics:\n", to);
    reference_list(to);
    fputs("\nall topics as Markdown: `pitviper help --markdown`\n", to);
}

/* ---- the command line -------------------------------------------------------------------------- */

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
        const bool help = program_asks_for("--help", "-h", argc, argv);
        if (program_asks_for("--version", "-V", argc, argv)) {
            puts("pitviper " PITVIPER_VERSION);
            return 0;
        }
        if (!help && !program_tables_there(commands[i].reads_tables, argc, argv)) return 1;
        snprintf(called, sizeof called, "pitviper %s", argv[0]);
        if (!commands[i].only_prints) stop_outlive_readers();
        argv[0] = called; /* program name in getopt's messages */
        const int code = commands[i].run(argc, argv);
        if (help && code == 0) printf("\n%s", program_common_help);
        return code;
    }
    return unknown(argv[0][0] == '-' ? "option" : "command", argv[0], false);
}

/* Runs `pitviper help`, with a COMMAND, a TOPIC or --markdown. */
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

/* Optional parts, for --verbose --version. */
static const char built_with[] =
#ifdef PITVIPER_VIDEO
    "videos and streams (FFmpeg): yes\n"
#else
    "videos and streams: no, built without FFmpeg's libraries (libavcodec-dev libavformat-dev libavutil-dev)\n"
#endif
#ifdef PITVIPER_SDL
    "frames on a display (SDL2): yes";
#else
    "frames on a display: no, built without SDL2 (libsdl2-dev)";
#endif

int main(int argc, char **argv)
{
    program_fill_closed();
    thread_flush_denormals(); /* so that a probe computes as a frame does */
    if (!program_take_verbosity(&argc, argv)) return 2;
    if (argc < 2) {
        log_error("no command is given; `pitviper --help` lists them, `pitviper replay LOG` renders a recording");
        return 2;
    }
    if (argc > 2 && strcmp(argv[1], "help") == 0) return program_printed(help_command(argc - 2, argv + 2));
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0) {
        usage(stdout);
        return program_printed(0);
    }
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0) {
        puts("pitviper " PITVIPER_VERSION);
        if (log_is_verbose()) puts(built_with);
        return program_printed(0);
    }
    return program_printed(run_named(argc - 1, argv + 1));
}
