/* tests/bench/measure.c: what is measured and shown: the rounds, their medians, and the rows of the table.
 *
 * Times are wall times of rounds; in a round every compared work runs once, so that other load on the machine
 * affects both sides of a ratio. The median is the expected time, the best the limit of the machine. */
#include "tests/bench/bench_private.h"

#include <stdlib.h>
#include <unistd.h>

enum { what_width = 66 };

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
    char text[160];
    (void)bench;
    snprintf(text, sizeof text, "%s ...", what);
    log_status(text);
}

/* ---- time ------------------------------------------------------------------------------------- */

static int by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

double bench_quantile(const double *value, int count, double share)
{
    double sorted[bench_rounds_max];
    memcpy(sorted, value, (size_t)count * sizeof *sorted);
    qsort(sorted, (size_t)count, sizeof *sorted, by_value);
    const double place = share * (count - 1);
    const int    below = (int)place;
    return below + 1 < count ? sorted[below] + (place - below) * (sorted[below + 1] - sorted[below])
                             : sorted[count - 1];
}

void bench_time_finish(BenchTime *time)
{
    time->median_s = bench_quantile(time->item_s, time->rounds, 0.5);
    time->best_s = INFINITY;
    for (int r = 0; r < time->rounds; r++) time->best_s = fmin(time->best_s, time->item_s[r]);
}

void bench_time_more(BenchTime *time, Bench *bench, const BenchWork *work, int count)
{
    const double budget_s = count * (bench->quick ? 0.02 : 1.0);
    const int    first = time[0].rounds, least = first + (bench->quick ? 2 : 7);
    int          rounds = first;
    for (int k = 0; k < count; k++) work[k].run(work[k].user);
    for (const double begun_s = wall_clock_s();
         rounds < bench_rounds_max && (rounds < least || wall_clock_s() - begun_s < budget_s); rounds++)
        for (int n = 0; n < count; n++) {
            /* forward and backward, so that no work always follows the same one and its state of the caches */
            const int    k = rounds % 2 ? count - 1 - n : n;
            const double start_s = wall_clock_s();
            work[k].run(work[k].user);
            time[k].item_s[rounds] = (wall_clock_s() - start_s) / work[k].items;
        }
    for (int k = 0; k < count; k++) {
        time[k].rounds = rounds;
        bench_time_finish(&time[k]);
    }
}

void bench_time(BenchTime *out, Bench *bench, const BenchWork *work, int count)
{
    for (int k = 0; k < count; k++) out[k].rounds = 0;
    bench_time_more(out, bench, work, count);
}

double bench_ratio(const BenchTime *a, const BenchTime *b)
{
    double ratio[bench_rounds_max];
    for (int r = 0; r < a->rounds; r++) ratio[r] = a->item_s[r] / b->item_s[r];
    return bench_quantile(ratio, a->rounds, 0.5);
}

/* ---- rows ------------------------------------------------------------------------------------- */

BenchRow bench_row(const char *what)
{
    return (BenchRow){.what = what,
                      .median = NAN,
                      .best = NAN,
                      .rate = NAN,
                      .ratio = NAN,
                      .error = NAN,
                      .error_limit = NAN,
                      .low = NAN,
                      .high = NAN};
}

BenchRow bench_row_of(const char *what, const BenchTime *time, const char *rate_unit, double per_rate)
{
    BenchRow row = bench_row(what);
    row.median = time->median_s;
    row.best = time->best_s;
    if (time->rounds > 0) {
        row.low = bench_quantile(time->item_s, time->rounds, 0.25);
        row.high = bench_quantile(time->item_s, time->rounds, 0.75);
    }
    row.unit = "s";
    row.rate = rate_unit ? 1 / (time->median_s * per_rate) : NAN;
    row.rate_unit = rate_unit;
    return row;
}

static const char *or_empty(const char *text) { return text ? text : ""; }

void bench_show(char out[32], double value, const char *unit)
{
    static const struct {
        double      s;
        const char *unit;
    } steps[] = {{1, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}};
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
    printf("\n%-*s %10s %10s  %-18s %-22s %s\n", what_width, bench->suite, "median", "best", "rate", "ratio to",
           "error");
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

bool bench_holds(const BenchRow *row) { return isnan(row->error_limit) || row->error <= row->error_limit; }

static void csv_row(FILE *file, const char *suite, const BenchRow *row)
{
    fputs(suite, file);
    csv_text(file, row->what);
    csv_number(file, row->median);
    csv_number(file, row->best);
    csv_text(file, row->unit);
    csv_number(file, row->rate);
    csv_text(file, row->rate_unit);
    csv_number(file, row->ratio);
    csv_text(file, row->to);
    csv_number(file, row->error);
    csv_number(file, row->error_limit);
    csv_text(file, row->error_unit);
    csv_text(file, row->against);
    csv_text(file, isnan(row->error_limit) ? NULL : bench_holds(row) ? "yes" : "no");
    csv_number(file, row->low);
    csv_number(file, row->high);
    csv_text(file, row->mark);
    fputc('\n', file);
}

static bool keep_text(const char **text)
{
    if (!*text) return true;
    *text = strdup(*text);
    return *text;
}

void bench_forget(Bench *bench)
{
    for (int i = 0; i < bench->kept_count; i++) {
        const BenchRow   *row = &bench->kept[i].row;
        const char *const texts[] = {row->what,       row->unit,    row->rate_unit, row->to,
                                     row->error_unit, row->against, row->mark,      bench->kept[i].plot};
        for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) free((void *)(uintptr_t)texts[k]);
    }
    free(bench->kept);
    free(bench->block);
    bench->kept = NULL;
    bench->block = NULL;
    bench->kept_count = bench->blocks = 0;
}

static bool keep(Bench *bench, const BenchRow *row)
{
    if (bench->kept_count == bench->kept_capacity) {
        const int  larger = bench->kept_capacity ? 2 * bench->kept_capacity : 64;
        BenchKept *grown = realloc(bench->kept, (size_t)larger * sizeof *grown);
        if (!grown) return false;
        bench->kept = grown;
        bench->kept_capacity = larger;
    }
    BenchRow *kept = &bench->kept[bench->kept_count].row;
    bench->kept[bench->kept_count++] = (BenchKept){.row = *row};
    const char **texts[] = {&kept->what,       &kept->unit,    &kept->rate_unit, &kept->to,
                            &kept->error_unit, &kept->against, &kept->mark};
    bool         ok = true;
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) ok = keep_text(texts[k]) && ok;
    return ok;
}

void bench_add(Bench *bench, const BenchRow *row)
{
    char       median_text[32], best[32], rate[32], ratio[96] = "", error[32], limit[32], what[256];
    const bool holds = bench_holds(row);
    if (bench->rows++ == 0 || bench->part[bench->parts - 1].first == bench->kept_count) show_head(bench);
    bench->broken += !holds;
    if (!keep(bench, row)) bench->out_of_memory = true;
    snprintf(what, sizeof what, "%s%s%s", row->what, row->mark ? " " : "", or_empty(row->mark));
    bench_show(median_text, row->median, row->unit);
    bench_show(best, row->best, row->unit);
    bench_show(rate, row->rate, row->rate_unit);
    bench_show(error, row->error, row->error_unit);
    bench_show(limit, row->error_limit, row->error_unit);
    if (!isnan(row->ratio))
        snprintf(ratio, sizeof ratio, row->ratio < 0.1 ? "%.2g x %.80s" : "%.2f x %.80s", row->ratio,
                 or_empty(row->to));
    log_status(NULL);
    printf("%-*s %10s %10s  %-18s %-22s %s%s%s%s%s%s\n", what_width, what, median_text, best, rate, ratio, error,
           *limit ? ", limit " : "", limit, row->against ? ": " : "", or_empty(row->against),
           holds ? "" : "  ** beyond its limit **");
    fflush(stdout);
    if (bench->csv) csv_row(bench->csv, bench->suite, row);
}

void bench_worse(double *worst, double error)
{
    error = fabs(error);
    if (!(error <= *worst)) *worst = isnan(error) ? INFINITY : error;
}

void bench_stress(Bench *bench, const char *what, double error, double limit, const char *unit, const char *against)
{
    BenchRow row = bench_row(what);
    row.error = error;
    row.error_limit = limit;
    row.error_unit = unit;
    row.against = against;
    bench_add(bench, &row);
}
