/* pitviper_bench.c: the harness of benchmarks: who runs, how long, and the table.
 *
 * Times are wall times of rounds; in a round every work that is compared runs once, so that a busy neighbour falls on
 * both sides of a ratio. The median says what to expect, the best what the machine can. */
#include "pitviper.h"

#include <stdlib.h>
#include <unistd.h>

enum { max_options = 16, what_width = 66 };

typedef struct BenchOption {
    char        name[24];
    const char *value;
} BenchOption;

struct Bench {
    const char *suite;
    bool        quick, terminal;
    int         threads, options, rows, broken; /* broken: rows whose error is beyond its limit */
    BenchOption option[max_options];
    FILE       *csv;
};

bool bench_quick(const Bench *bench) { return bench->quick; }
int  bench_threads(const Bench *bench) { return bench->threads; }

const char *bench_option(const Bench *bench, const char *name)
{
    for (int i = 0; i < bench->options; i++)
        if (strcmp(bench->option[i].name, name) == 0) return bench->option[i].value;
    return NULL;
}

void bench_progress(Bench *bench, const char *what)
{
    if (bench->terminal) fprintf(stderr, "\r\x1b[K%s ...", what);
}

/* ---- time ------------------------------------------------------------------------------------- */

static int by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

static double median(const double *value, int count)
{
    double sorted[bench_rounds_max];
    memcpy(sorted, value, (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, by_value);
    return count % 2 ? sorted[count / 2] : 0.5 * (sorted[count / 2 - 1] + sorted[count / 2]);
}

void bench_time_finish(BenchTime *time)
{
    time->median_s = median(time->item_s, time->rounds);
    time->best_s   = INFINITY;
    for (int r = 0; r < time->rounds; r++) time->best_s = fmin(time->best_s, time->item_s[r]);
}

void bench_time(BenchTime *out, Bench *bench, const BenchWork *work, int count)
{
    const double budget_s = count * (bench->quick ? 0.02 : 1.0);
    const int    least = bench->quick ? 3 : 7;
    int          rounds = 0;
    for (int k = 0; k < count; k++) work[k].run(work[k].user);
    for (const double begun_s = wall_clock_s();
         rounds < least || (rounds < bench_rounds_max && wall_clock_s() - begun_s < budget_s); rounds++)
        for (int k = 0; k < count; k++) {
            const double start_s = wall_clock_s();
            work[k].run(work[k].user);
            out[k].item_s[rounds] = (wall_clock_s() - start_s) / work[k].items;
        }
    for (int k = 0; k < count; k++) {
        out[k].rounds = rounds;
        bench_time_finish(&out[k]);
    }
}

double bench_ratio(const BenchTime *a, const BenchTime *b)
{
    double ratio[bench_rounds_max];
    for (int r = 0; r < a->rounds; r++) ratio[r] = a->item_s[r] / b->item_s[r];
    return median(ratio, a->rounds);
}

/* ---- rows ------------------------------------------------------------------------------------- */

BenchRow bench_row(const char *what)
{
    return (BenchRow){.what = what, .median = NAN, .best = NAN, .rate = NAN, .ratio = NAN, .error = NAN,
                      .error_limit = NAN};
}

BenchRow bench_row_of(const char *what, const BenchTime *time, const char *rate_unit, double per_rate)
{
    BenchRow row  = bench_row(what);
    row.median    = time->median_s;
    row.best      = time->best_s;
    row.unit      = "s";
    row.rate      = rate_unit ? 1 / (time->median_s * per_rate) : NAN;
    row.rate_unit = rate_unit;
    return row;
}

static const char *or_empty(const char *text) { return text ? text : ""; }

/* Three figures and a unit; seconds in what fits. */
static void show(char out[32], double value, const char *unit)
{
    static const struct { double s; const char *unit; } steps[] = {{1, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}};
    *out = 0;
    if (isnan(value)) return;
    if (unit && strcmp(unit, "s") == 0) {
        int k = 0;
        while (k < 3 && fabs(value) < steps[k].s) k++;
        value /= steps[k].s;
        unit = steps[k].unit;
    }
    const double size = fabs(value);
    if (value == 0) snprintf(out, 32, "0 %.16s", or_empty(unit));
    else if (size < 1e-3) snprintf(out, 32, "%.1e %.16s", value, or_empty(unit));
    else snprintf(out, 32, "%.*f %.16s", size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 4, value, or_empty(unit));
}

static void show_head(const Bench *bench)
{
    printf("\n%-*s %10s %10s  %-18s %-22s %s\n", what_width, bench->suite, "median", "best", "rate",
           "ratio to", "error");
}

static void csv_text(FILE *file, const char *text)
{
    fputc(',', file);
    if (!text) return;
    if (!strpbrk(text, ",\"")) {
        fputs(text, file);
        return;
    }
    fputc('"', file);
    for (; *text; text++) fprintf(file, *text == '"' ? "\"\"" : "%c", *text);
    fputc('"', file);
}

static void csv_number(FILE *file, double value)
{
    fputc(',', file);
    if (!isnan(value)) fprintf(file, "%.9g", value);
}

void bench_add(Bench *bench, const BenchRow *row)
{
    char       median_text[32], best[32], rate[32], ratio[96] = "", error[32];
    const bool judged = !isnan(row->error_limit), holds = !judged || row->error <= row->error_limit;
    if (bench->rows++ == 0) show_head(bench);
    bench->broken += !holds;
    show(median_text, row->median, row->unit);
    show(best, row->best, row->unit);
    show(rate, row->rate, row->rate_unit);
    show(error, row->error, row->error_unit);
    if (!isnan(row->ratio)) snprintf(ratio, sizeof ratio, "%.2f x %.80s", row->ratio, or_empty(row->to));
    if (bench->terminal) fputs("\r\x1b[K", stderr);
    printf("%-*s %10s %10s  %-18s %-22s %s%s%s%s\n", what_width, row->what, median_text, best, rate, ratio, error,
           row->against ? ": " : "", or_empty(row->against), holds ? "" : "  ** beyond its limit **");
    fflush(stdout);
    if (!bench->csv) return;
    fputs(bench->suite, bench->csv);
    csv_text(bench->csv, row->what);
    csv_number(bench->csv, row->median);
    csv_number(bench->csv, row->best);
    csv_text(bench->csv, row->unit);
    csv_number(bench->csv, row->rate);
    csv_text(bench->csv, row->rate_unit);
    csv_number(bench->csv, row->ratio);
    csv_text(bench->csv, row->to);
    csv_number(bench->csv, row->error);
    csv_number(bench->csv, row->error_limit);
    csv_text(bench->csv, row->error_unit);
    csv_text(bench->csv, row->against);
    csv_text(bench->csv, judged ? (holds ? "yes" : "no") : NULL);
    fputc('\n', bench->csv);
}

/* ---- knobs ------------------------------------------------------------------------------------ */

void bench_knob(Bench *bench, const BenchKnob *knob, const BenchPoint *point, int count)
{
    char what[256];
    for (int i = 0; i < count; i++) {
        snprintf(what, sizeof what, "%s: %s%s", knob->name, point[i].setting, point[i].is_default ? " (default)" : "");
        BenchRow row   = bench_row_of(what, &point[i].time, NULL, 1);
        row.error      = point[i].error;
        row.error_unit = knob->error_unit;
        row.against    = knob->against;
        if (point[i].is_default) row.error_limit = knob->stated;
        bench_add(bench, &row);
    }
}

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
        bool        known = strcmp(name, "csv") == 0 || strcmp(name, "threads") == 0;
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
        if (!value || bench->options == max_options) {
            log_error("bench: --%s needs a value", name);
            return false;
        }
        i++;
        if (strcmp(name, "csv") == 0) {
            *csv = value;
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
                "error_unit,against,holds\n", machine);
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
    return failed == STATUS_OK && bench.broken == 0 ? 0 : 1;
}
