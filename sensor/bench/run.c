/* sensor/bench/run.c: the bench command: the selected suites, the machine, and the results. */
#include "sensor/bench/bench_private.h"
#include "pitviper_output.h"

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

static void usage(FILE *to, BenchNext *next)
{
    size_t state[2] = {0};
    fputs("usage: pitviper bench WHAT [options]\n"
          "       pitviper bench all [options]            everything there is, one after the other\n"
          "       pitviper bench compare A.csv B.csv [--report FILE] [--slower FACTOR]\n\n"
          "Speed of this build on this machine, each figure with its error beside it. Ratios are of runs in turn.\n"
          "compare says what two runs' tables have in common and what became faster, slower or worse; it ends with 1\n"
          "when an error went beyond its limit, or a row is slower than by this factor.\n\n"
          "  --csv FILE       the table for machines, and for compare\n"
          "  --report FILE    the tables and plots as one HTML page\n"
          "  --plots DIR      each approximation's settings as NAME.svg: run time against error\n"
          "  --quick          few rounds and small scenes: seconds\n"
          "  --threads N      default: one for each processor\n", to);
    for (const BenchSuite *suite; (suite = next(state));) {
        if (!is_first(suite, next)) continue;
        fprintf(to, "\n  %s\n", suite->name);
        size_t part_state[2] = {0};
        for (const BenchSuite *part; (part = next(part_state));)
            if (strcmp(part->name, suite->name) == 0) usage_suite(to, part);
    }
}

static bool suite_has_option(const BenchSuite *suite, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = suite->options; at && *at;) {
        if (strncmp(at, name, length) == 0 && at[length] == '=') return true;
        at += strcspn(at, ",");
        at += *at == ',';
    }
    return false;
}

/* Of any selected suite. */
static bool has_option(const Bench *bench, const char *name, BenchNext *next)
{
    size_t state[2] = {0};
    for (const BenchSuite *suite; (suite = next(state));)
        if ((bench->all || strcmp(suite->name, bench->suite) == 0) && suite_has_option(suite, name)) return true;
    return false;
}

static bool parse_threads(int *out, const char *value)
{
    long long number;
    if (!text_to_long(&number, value) || number < 1 || number > 256) {
        log_error("bench: --threads: '%s' is not a whole number in 1 .. 256", value);
        return false;
    }
    *out = (int)number;
    return true;
}

typedef struct Outputs {
    const char *csv, *report;
} Outputs;

/* False when the line is not an option of this bench; logs why. */
static bool parse(Bench *bench, Outputs *out, int argc, char **argv, BenchNext *next)
{
    for (int i = 1; i < argc; i++) {
        const char *name = strncmp(argv[i], "--", 2) == 0 ? argv[i] + 2 : "";
        const char *value = i + 1 < argc ? argv[i + 1] : NULL;
        const char **to = strcmp(name, "csv") == 0 ? &out->csv : strcmp(name, "report") == 0 ? &out->report
                        : strcmp(name, "plots") == 0 ? &bench->plots : NULL;
        const bool threads = strcmp(name, "threads") == 0;
        if (strcmp(name, "quick") == 0) {
            bench->quick = true;
            continue;
        }
        if ((!to && !threads && !has_option(bench, name, next)) || strlen(name) >= sizeof bench->option->name) {
            log_error("bench: %s has no option %s; `pitviper bench --help` lists them", bench->suite, argv[i]);
            return false;
        }
        if (!value || bench->options == bench_options_max) {
            log_error("bench: --%s needs a value", name);
            return false;
        }
        i++;
        if (to) {
            *to = value;
        } else if (threads) {
            if (!parse_threads(&bench->threads, value)) return false;
        } else {
            BenchOption *option = &bench->option[bench->options++];
            strcpy(option->name, name);
            option->value = value;
        }
    }
    return true;
}

/* ---- a run ------------------------------------------------------------------------------------ */

/* Header lines are `# key: value`; compare reads them. */
static void csv_head(const Bench *bench, const BenchMachine *m, const char *line)
{
    char when[32];
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

/* The suites of that name in all libraries, one after the other. */
static void run_part(Bench *bench, const char *name, BenchNext *next)
{
    const double begun_s = wall_clock_s();
    size_t       state[2] = {0};
    BenchPart   *part = &bench->part[bench->parts++];
    *part        = (BenchPart){.name = name, .first = bench->kept_count};
    bench->suite = name;
    for (const BenchSuite *suite; (suite = next(state));) {
        if (strcmp(suite->name, name) != 0) continue;
        if (!part->help) part->help = suite->help;
        if (!part->reads) part->reads = suite->reads;
        part->failed += suite->run(bench) != STATUS_OK;
    }
    part->count  = bench->kept_count - part->first;
    part->took_s = wall_clock_s() - begun_s;
}

static bool done_before(const Bench *bench, const char *name)
{
    for (int p = 0; p < bench->parts; p++)
        if (strcmp(bench->part[p].name, name) == 0) return true;
    return false;
}

static void run_all(Bench *bench, const char *only, BenchNext *next)
{
    size_t state[2] = {0};
    for (const BenchSuite *suite; (suite = next(state)) && bench->parts < bench_parts_max;)
        if (bench->all ? !done_before(bench, suite->name) : bench->parts == 0 && strcmp(suite->name, only) == 0)
            run_part(bench, suite->name, next);
    log_status(NULL);
}

static bool known_suite(const char *name, BenchNext *next)
{
    size_t state[2] = {0};
    for (const BenchSuite *suite; (suite = next(state));)
        if (strcmp(suite->name, name) == 0) return true;
    return false;
}

/* The last lines of output, and the exit code. */
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
    if (argc < 2 || strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        usage(argc < 2 ? stderr : stdout, next);
        return argc < 2 ? 2 : 0;
    }
    if (strcmp(argv[1], "compare") == 0) return bench_compare(argc - 1, argv + 1);
    bench.suite = argv[1];
    bench.part  = part;
    bench.all   = strcmp(argv[1], "all") == 0;
    if (!bench.all && !known_suite(argv[1], next)) {
        text_print(stderr, "pitviper bench: no such bench: %s; `pitviper bench --help` lists them\n", bench.suite);
        return 2;
    }
    if (!parse(&bench, &out, argc - 1, argv + 1, next)) return 2;
    if (out.csv && !(bench.csv = output_file(out.csv, OUTPUT_STREAM))) {
        log_error("bench: cannot write %s: %s; choose another place with --csv", out.csv, output_reason(errno));
        return 1;
    }
    thread_flush_denormals();
    bench_machine_read(&machine);
    bench_machine_line(line, &machine);
    puts(line);
    if (bench.csv) csv_head(&bench, &machine, line);
    run_all(&bench, argv[1], next);
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
