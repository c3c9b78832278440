/* tests/bench/bench_command.c: the bench command: the selected suites, the machine, and the results. */
#include "tests/bench/bench_private.h"
#include "pitviper_output.h"
#include "sensor/settings/command_line.h"

#include <errno.h>
#include <time.h>
#include <unistd.h>

/* ---- the command ------------------------------------------------------------------------------ */

static void usage_suite(FILE *to, const BenchSuite *suite)
{
    fprintf(to, "      %s\n", suite->help);
    for (const char *at = suite->options; at && *at;) {
        const int length = (int)strcspn(at, ","), name = (int)strcspn(at, "=");
        fprintf(to, "      --%.*s %.*s\n", name, at, length - name - 1, at + name + 1);
        at += length + (at[length] == ',');
    }
}

/* Whether it is the first of its name: several libraries have parts of the same suite. */
static bool is_first(const BenchSuite *suite, BenchNext *next)
{
    size_t            state[2] = {0};
    const BenchSuite *other;
    while ((other = next(state)) != suite)
        if (strcmp(other->name, suite->name) == 0) return false;
    return true;
}

static const char common_options[] =
    "  --csv FILE       the table for machines, and for compare\n"
    "  --report FILE    the tables and plots as one HTML page\n"
    "  --plots DIR      each approximation's settings as NAME.svg: run time against error\n"
    "  --quick          few rounds and small scenes: seconds\n"
    "  --threads N      default: one for each processor\n";

static void usage_parts(FILE *to, const char *name, BenchNext *next)
{
    size_t state[2] = {0};
    fprintf(to, "\n  %s\n", name);
    for (const BenchSuite *part; (part = next(state));)
        if (strcmp(part->name, name) == 0) usage_suite(to, part);
}

/* Of one bench. */
static void usage_of(FILE *to, const char *name, BenchNext *next)
{
    fprintf(to, "usage: pitviper bench %s [options]\n\n%s", name, common_options);
    usage_parts(to, name, next);
}

static void usage(FILE *to, BenchNext *next)
{
    size_t state[2] = {0};
    fputs("usage: pitviper bench WHAT [options]\n"
          "       pitviper bench all [options]            everything there is, one after the other\n"
          "       pitviper bench compare A.csv B.csv [--report FILE] [--slower FACTOR]\n\n"
          "Speed of this build on this machine, each figure with its error beside it. Ratios are of runs in turn.\n"
          "compare says what two runs' tables have in common and what became faster, slower or worse; it ends with 1\n"
          "when an error went beyond its limit, or a row is slower than by this factor.\n\n",
          to);
    fputs(common_options, to);
    for (const BenchSuite *suite; (suite = next(state));)
        if (is_first(suite, next)) usage_parts(to, suite->name, next);
}

typedef struct Outputs {
    const char *csv, *report;
} Outputs;

enum { CSV = 256, REPORT, PLOTS, QUICK, THREADS, HELP, OF_SUITE, list_most = bench_options_max + 8 };

/* Whether a suite of this name is to run. */
static bool is_asked(const Bench *bench, const BenchSuite *suite)
{
    return (bench->all || strcmp(suite->name, bench->suite) == 0) &&
           (!bench->room || (suite->room && strcmp(suite->room, bench->room) == 0));
}

/* The options of every bench, then those of the suites that are to run; their names go into bench->option. */
static void list_options(struct option list[list_most], Bench *bench, BenchNext *next)
{
    static const struct option common[] = {{"csv", 1, NULL, CSV},         {"report", 1, NULL, REPORT},
                                           {"plots", 1, NULL, PLOTS},     {"quick", 0, NULL, QUICK},
                                           {"threads", 1, NULL, THREADS}, {"help", 0, NULL, HELP}};
    enum { count = sizeof common / sizeof *common };
    size_t state[2] = {0};
    memcpy(list, common, sizeof common);
    for (const BenchSuite *suite; (suite = next(state));)
        for (const char *at = is_asked(bench, suite) ? suite->options : NULL; at && *at;) {
            BenchOption *option = &bench->option[bench->options];
            if (bench->options == bench_options_max) break;
            snprintf(option->name, sizeof option->name, "%.*s", (int)strcspn(at, "="), at);
            list[count + bench->options] = (struct option){option->name, 1, NULL, OF_SUITE + bench->options};
            bench->options++;
            at += strcspn(at, ",");
            at += *at == ',';
        }
    list[count + bench->options] = (struct option){NULL, 0, NULL, 0};
}

/* Returns 0 to go on; else the program exits with this code - 1. */
static int parse(Bench *bench, Outputs *out, int argc, char **argv, BenchNext *next)
{
    static char   called[] = "pitviper bench";
    struct option list[list_most];
    list_options(list, bench, next);
    argv[0] = called; /* of messages */
    optind = 0;       /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "", list)) != -1;) switch (option) {
        case CSV:
            out->csv = optarg;
            break;
        case REPORT:
            out->report = optarg;
            break;
        case PLOTS:
            bench->plots = optarg;
            break;
        case QUICK:
            bench->quick = true;
            break;
        case THREADS:
            if (!command_line_threads(&bench->threads, "bench", optarg)) return 1 + 2;
            break;
        case HELP:
            if (bench->all) usage(stdout, next);
            else usage_of(stdout, bench->suite, next);
            return 1 + 0;
        case '?':
            return 1 + 2; /* reported by command_line_option */
        default:
            bench->option[option - OF_SUITE].value = optarg;
        }
    if (optind < argc) return 1 + command_line_wrong("bench", "%s takes no '%s'", bench->suite, argv[optind]);
    return 0;
}

/* Checks beforehand what would be refused only after minutes: values of options, files that cannot be written. Returns
 * 0 if all is good; else the exit code. */
static int check(const Bench *bench, const Outputs *out, BenchNext *next)
{
    size_t state[2] = {0};
    for (const BenchSuite *suite; (suite = next(state));)
        if (is_asked(bench, suite) && suite->check && suite->check(bench) != STATUS_OK) return 2;
    if (out->report && output_check(out->report, OUTPUT_STREAM) != 0) {
        log_error("bench: --report: cannot write %s: %s; choose another place", out->report, output_reason(errno));
        return 1;
    }
    if (bench->plots && output_folder(bench->plots) != 0) {
        log_error("bench: --plots: cannot make the folder %s: %s; choose another place", bench->plots,
                  output_reason(errno));
        return 1;
    }
    return 0;
}

/* ---- a run ------------------------------------------------------------------------------------ */

/* Header lines are `# key: value`; compare reads them. */
static void csv_head(const Bench *bench, const BenchMachine *m, const char *line)
{
    char         when[32];
    const time_t now = time(NULL);
    struct tm    utc;
    strftime(when, sizeof when, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
    fprintf(bench->csv,
            "# %s\n# version: %s\n# machine: %s, %d cores, %s\n# rounds: %s\n# threads: %d\n# when: %s\n"
            "# system: %s, governor %s, %.1f GB\n# built: x86-64-v3, %s\n# libraries: %s\n",
            line, PITVIPER_VERSION, m->processor, m->cores, m->isa, bench->quick ? "quick" : "full", bench->threads,
            when, m->system, m->governor, m->memory_gb, m->compiler, m->libraries);
    fputs("bench,what,median,best,unit,rate,rate_unit,ratio,ratio_to,error,error_limit,error_unit,against,holds,lower_"
          "quartile,"
          "upper_quartile,mark\n",
          bench->csv);
}

/* Runs the suites of that name in all libraries, one after the other. */
static void run_part(Bench *bench, const char *name, BenchNext *next)
{
    const double begun_s = wall_clock_s();
    size_t       state[2] = {0};
    BenchPart   *part = &bench->part[bench->parts++];
    *part = (BenchPart){.name = name, .first = bench->kept_count};
    bench->suite = name;
    for (const BenchSuite *suite; (suite = next(state));) {
        if (strcmp(suite->name, name) != 0 || !is_asked(bench, suite)) continue;
        if (!part->help) part->help = suite->help;
        if (!part->reads) part->reads = suite->reads;
        part->failed += suite->run(bench) != STATUS_OK;
    }
    part->count = bench->kept_count - part->first;
    part->took_s = wall_clock_s() - begun_s;
}

static bool done_before(const Bench *bench, const char *name)
{
    for (int p = 0; p < bench->parts; p++)
        if (strcmp(bench->part[p].name, name) == 0) return true;
    return false;
}

static void run_all(Bench *bench, BenchNext *next)
{
    size_t state[2] = {0};
    for (const BenchSuite *suite; (suite = next(state)) && bench->parts < bench_parts_max;)
        if (is_asked(bench, suite) && !done_before(bench, suite->name)) run_part(bench, suite->name, next);
    log_status(NULL);
}

/* Takes a bench's name apart: SUITE or `all`, for one room alone with /ROOM after it, as tests/CMakeLists.txt runs
 * them. False, with a message: there is none of that name. */
static bool read_name(Bench *bench, char *typed, BenchNext *next)
{
    size_t    state[2] = {0};
    char     *slash = strchr(typed, '/');
    WordMeant meant = word_meant(typed);
    if (slash) *slash = 0, bench->room = slash + 1;
    bench->suite = typed;
    bench->all = strcmp(typed, "all") == 0;
    if (bench->all && !bench->room) return true;
    word_consider_list(&meant, "all|compare", '|');
    for (const BenchSuite *suite; (suite = next(state));) {
        if (is_asked(bench, suite)) return true;
        word_consider(&meant, suite->name);
    }
    if (slash) *slash = '/';
    command_line_wrong("bench", "no such bench: %s%s", typed, word_hint(&meant));
    return false;
}

/* Prints the last lines of output, and returns the exit code. */
static int conclude(const Bench *bench, double took_s)
{
    int failed = 0;
    for (int p = 0; p < bench->parts; p++) {
        failed += bench->part[p].failed;
        if (bench->part[p].failed) log_error("bench: %s: did not come to its end", bench->part[p].name);
    }
    if (bench->out_of_memory) log_error("bench: out of memory for the table");
    if (bench->all) {
        printf("\n%d rows of %d suites in %.0f s\n", bench->rows, bench->parts, took_s);
        for (int i = 0; i < bench->kept_count; i++)
            if (!bench_holds(&bench->kept[i].row)) printf("** beyond its limit: %s\n", bench->kept[i].row.what);
    }
    if (bench->broken > 0) log_error("bench: %d of %d rows have an error beyond its limit", bench->broken, bench->rows);
    return failed == 0 && bench->broken == 0 && !bench->out_of_memory && !bench->spoilt ? 0 : 1;
}

int bench_command(int argc, char **argv, BenchNext *next)
{
    Bench        bench = {.threads = thread_processors()};
    BenchPart    part[bench_parts_max];
    BenchMachine machine;
    Outputs      out = {NULL, NULL};
    char         line[512];
    const double begun_s = wall_clock_s();
    if (argc < 2) return command_line_wrong("bench", "no bench is named: usage: pitviper bench WHAT [options]");
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        usage(stdout, next);
        return 0;
    }
    if (strcmp(argv[1], "compare") == 0) return bench_compare(argc - 1, argv + 1);
    bench.part = part;
    if (!read_name(&bench, argv[1], next)) return 2;
    const int stop = parse(&bench, &out, argc - 1, argv + 1, next);
    if (stop) return stop - 1;
    const int wrong = check(&bench, &out, next);
    if (wrong) return wrong;
    if (out.csv && !(bench.csv = output_file(out.csv, OUTPUT_STREAM))) {
        log_error("bench: --csv: cannot write %s: %s; choose another place", out.csv, output_reason(errno));
        return 1;
    }
    thread_flush_denormals();
    bench_machine_read(&machine);
    bench_machine_line(line, &machine);
    puts(line);
    if (bench.csv) csv_head(&bench, &machine, line);
    run_all(&bench, next);
    const double took_s = wall_clock_s() - begun_s;
    const bool   spoilt = bench.csv && ferror(bench.csv);
    if (bench.csv && (fclose(bench.csv) != 0 || spoilt)) {
        log_error("bench: cannot write %s", out.csv);
        bench.spoilt = true;
    }
    if (out.report && bench_report(&bench, &machine, out.report, took_s) != STATUS_OK) bench.spoilt = true;
    const int code = conclude(&bench, took_s);
    bench_forget(&bench);
    return code;
}
