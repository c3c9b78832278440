/* pitviper_bench_run.c: the bench command: which suites, on which machine, and what came of them. */
#include "pitviper_bench.h"

#include <stdlib.h>
#include <unistd.h>

/* ---- the machine ------------------------------------------------------------------------------ */

static void processor_name(char out[128])
{
    char  line[512];
    FILE *file = fopen("/proc/cpuinfo", "r");
    strcpy(out, "unknown processor");
    while (file && fgets(line, sizeof line, file)) {
        const char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || !colon) continue;
        snprintf(out, 128, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
        break;
    }
    if (file) fclose(file);
}

static void machine_line(char out[512])
{
    char   name[128];
    double load = NAN;
    processor_name(name);
    if (getloadavg(&load, 1) != 1) load = NAN;
    snprintf(out, 512, "%s, %d cores, %s; built for x86-64-v3 by %s %s; pitviper %s; load %.1f", name,
             thread_processors(),
             __builtin_cpu_supports("avx512f") ? "AVX-512" : __builtin_cpu_supports("avx2") ? "AVX2" : "no AVX2",
#ifdef __clang__
             "clang", __clang_version__,
#else
             "gcc", __VERSION__,
#endif
             PITVIPER_VERSION, load);
}

/* ---- the command ------------------------------------------------------------------------------ */

static void usage(FILE *to, BenchNext *next)
{
    size_t      state[2] = {0};
    const char *last = "";
    fputs("usage: pitviper bench WHAT [options]\n\n"
          "Speed of this build on this machine, each figure with its error beside it. Ratios are of runs in turn.\n\n"
          "  --csv FILE       the table for machines, too\n"
          "  --plots DIR      each approximation's settings as NAME.svg: run time against error\n"
          "  --quick          few rounds and small scenes: seconds\n"
          "  --threads N      default: one for each processor\n", to);
    for (const BenchSuite *suite; (suite = next(state)); last = suite->name) {
        if (strcmp(suite->name, last) != 0) fprintf(to, "\n  %s\n", suite->name);
        fprintf(to, "      %s\n", suite->help);
        for (const char *at = suite->options; at && *at;) {
            const int length = (int)strcspn(at, ","), name = (int)strcspn(at, "=");
            fprintf(to, "      --%.*s %.*s\n", name, at, length - name - 1, at + name + 1);
            at += length + (at[length] == ',');
        }
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

/* False when the line is not an option of this bench; says why. */
static bool parse(Bench *bench, const char **csv, int argc, char **argv, BenchNext *next)
{
    for (int i = 1; i < argc; i++) {
        const char *name = strncmp(argv[i], "--", 2) == 0 ? argv[i] + 2 : "";
        const char *value = i + 1 < argc ? argv[i + 1] : NULL;
        size_t      state[2] = {0};
        long long   number;
        bool        known = strcmp(name, "csv") == 0 || strcmp(name, "threads") == 0 || strcmp(name, "plots") == 0;
        if (strcmp(name, "quick") == 0) {
            bench->quick = true;
            continue;
        }
        for (const BenchSuite *suite; (suite = next(state));)
            known |= strcmp(suite->name, bench->suite) == 0 && suite_has_option(suite, name);
        if (!known || strlen(name) >= sizeof bench->option->name) {
            log_error("bench: %s has no option %s; `pitviper bench --help` lists them", bench->suite, argv[i]);
            return false;
        }
        if (!value || bench->options == bench_options_max) {
            log_error("bench: --%s needs a value", name);
            return false;
        }
        i++;
        if (strcmp(name, "csv") == 0) {
            *csv = value;
        } else if (strcmp(name, "plots") == 0) {
            bench->plots = value;
        } else if (strcmp(name, "threads") == 0) {
            if (!text_to_long(&number, value) || number < 1 || number > 256) {
                log_error("bench: --threads: '%s' is not a whole number in 1 .. 256", value);
                return false;
            }
            bench->threads = (int)number;
        } else {
            BenchOption *option = &bench->option[bench->options++];
            strcpy(option->name, name);
            option->value = value;
        }
    }
    return true;
}

int bench_command(int argc, char **argv, BenchNext *next)
{
    Bench       bench = {.threads = thread_processors(), .terminal = isatty(STDERR_FILENO)};
    const char *csv = NULL;
    size_t      state[2] = {0};
    char        machine[512];
    bool        found = false;
    Status      failed = STATUS_OK;
    if (argc < 2 || strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        usage(argc < 2 ? stderr : stdout, next);
        return argc < 2 ? 2 : 0;
    }
    bench.suite = argv[1];
    for (const BenchSuite *suite; (suite = next(state));) found |= strcmp(suite->name, bench.suite) == 0;
    if (!found) {
        fprintf(stderr, "pitviper bench: no such bench: %s; `pitviper bench --help` lists them\n", bench.suite);
        return 2;
    }
    if (!parse(&bench, &csv, argc - 1, argv + 1, next)) return 2;
    if (csv && !(bench.csv = fopen(csv, "w"))) {
        log_error("bench: cannot write %s; choose another place with --csv", csv);
        return 1;
    }
    thread_flush_denormals();
    machine_line(machine);
    puts(machine);
    if (bench.csv)
        fprintf(bench.csv, "# %s\nbench,what,median,best,unit,rate,rate_unit,ratio,ratio_to,error,error_limit,"
                "error_unit,against,holds,lower_quartile,upper_quartile,mark\n", machine);
    memset(state, 0, sizeof state);
    for (const BenchSuite *suite; (suite = next(state));) {
        if (strcmp(suite->name, bench.suite) != 0) continue;
        const Status status = suite->run(&bench);
        if (status != STATUS_OK) failed = status;
    }
    if (bench.terminal) fputs("\r\x1b[K", stderr);
    const bool spoilt = bench.csv && ferror(bench.csv);
    if (bench.csv && (fclose(bench.csv) != 0 || spoilt)) {
        log_error("bench: cannot write %s", csv);
        return 1;
    }
    if (bench.broken > 0) log_error("bench: %d of %d rows have an error beyond its limit", bench.broken, bench.rows);
    bench_forget(&bench);
    return failed == STATUS_OK && bench.broken == 0 && !bench.out_of_memory && !bench.spoilt ? 0 : 1;
}
