/* tests/bench/tunable.c: time against error: which settings of a tunable are efficient.
 *
 * The rule. A setting dominates another when it is better, beyond noise, in time, error or memory, and not worse in
 * any of them.
 *
 *     time    rounds are interleaved, so each gives a ratio that other load on the machine hardly affects. Better:
 *             their median is below 0.9 and their upper quartile below 1. Worse: their median is above 1.05, or
 *             their lower quartile above 1
 *     error   the same inputs give the same error: its noise is the change by other inputs, a finer reference or
 *             another rounding. Better: below 0.9 of the other's, and by more than a hundredth of the stated error.
 *             Worse: above 1.02 of it. A second error of the same settings (of another band) is evaluated
 *             like the first
 *     memory  is counted, and has no noise; a tenth less is better, anything more is worse
 *
 * Better requires more than not worse: differences within noise dominate no setting. The front are the settings that
 * no other dominates. A default off the front fails, as does one whose error is above the stated one: there is another
 * setting at no cost. On quick rounds times are not checked: the dominating settings are printed. */
#include "tests/bench/bench_private.h"
#include "pitviper_output.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/stat.h>

typedef enum Verdict { WORSE, SAME, BETTER } Verdict;

static Verdict by_time(const BenchSetting *a, const BenchSetting *b)
{
    double    ratio[bench_rounds_max];
    const int rounds = a->time.rounds < b->time.rounds ? a->time.rounds : b->time.rounds;
    if (rounds < 1) return SAME;
    for (int r = 0; r < rounds; r++) ratio[r] = a->time.item_s[r] / b->time.item_s[r];
    const double low = bench_quantile(ratio, rounds, 0.25), middle = bench_quantile(ratio, rounds, 0.5);
    if (middle < 0.9 && bench_quantile(ratio, rounds, 0.75) < 1) return BETTER;
    return middle <= 1.05 && low <= 1 ? SAME : WORSE; /* NaN is worse */
}

static Verdict by_error(const BenchTunable *tunable, const BenchSetting *a, const BenchSetting *b)
{
    const double floor_error = isfinite(tunable->stated) ? 0.01 * tunable->stated : 0;
    if (a->error < 0.9 * b->error && b->error - a->error > floor_error) return BETTER;
    return a->error <= 1.02 * b->error ? SAME : WORSE;
}

static Verdict by_also(const BenchSetting *a, const BenchSetting *b)
{
    return a->also < 0.9 * b->also ? BETTER : a->also <= 1.02 * b->also ? SAME : WORSE;
}

static Verdict by_bytes(const BenchSetting *a, const BenchSetting *b)
{
    if (!(a->bytes > 0) || !(b->bytes > 0)) return SAME;
    return a->bytes < 0.9 * b->bytes ? BETTER : a->bytes <= b->bytes ? SAME : WORSE;
}

bool bench_dominates(const BenchTunable *tunable, const BenchSetting *a, const BenchSetting *b)
{
    const Verdict verdict[4] = {by_time(a, b), by_error(tunable, a, b), by_also(a, b), by_bytes(a, b)};
    bool          better = false;
    for (int k = 0; k < 4; k++) {
        if (verdict[k] == WORSE) return false;
        better |= verdict[k] == BETTER;
    }
    return better;
}

bool bench_on_front(const BenchTunable *tunable, const BenchSetting *point, int count, int index)
{
    if (isnan(point[index].error)) return false;
    for (int i = 0; i < count; i++)
        if (i != index && bench_dominates(tunable, &point[i], &point[index])) return false;
    return true;
}

/* ---- the plot --------------------------------------------------------------------------------- */

/* Makes a name fit for a file: letters, digits and `-`. */
static void file_name(char out[64], const char *name)
{
    int n = 0;
    for (; *name && n < 59; name++) {
        const bool plain = (*name >= 'a' && *name <= 'z') || (*name >= '0' && *name <= '9');
        const bool large = *name >= 'A' && *name <= 'Z';
        if (plain || large) out[n++] = (char)(large ? *name - 'A' + 'a' : *name);
        else if (n > 0 && out[n - 1] != '-') out[n++] = '-';
    }
    while (n > 0 && out[n - 1] == '-') n--;
    strcpy(out + n, ".svg");
}

static char *plot_text(const BenchTunable *tunable, const BenchSetting *point, int count)
{
    char  *text = NULL;
    size_t octets;
    FILE  *to = open_memstream(&text, &octets);
    if (!to) return NULL;
    plot_tunable(to, tunable, point, count);
    if (fclose(to) == 0) return text;
    free(text);
    return NULL;
}

static void write_plot(Bench *bench, const BenchTunable *tunable, const char *text)
{
    char path[4096], name[64];
    file_name(name, tunable->name);
    const bool fits = (size_t)snprintf(path, sizeof path, "%s/%s", bench->plots, name) < sizeof path;
    errno = ENAMETOOLONG;
    FILE *file = fits && output_folder(bench->plots) == 0 ? output_begin(path, 0) : NULL;
    if (file) fputs(text, file);
    if (file && output_end(file, path)) return;
    log_error("bench: cannot write %s: %s; choose another folder with --plots", path, output_reason(errno));
    bench->spoilt = true;
}

/* ---- rows ------------------------------------------------------------------------------------- */

/* Finds the settings that dominate the default: the best of them (NULL: none), and how many there are. */
static const BenchSetting *who_dominates(int *how_many, const BenchTunable *tunable, const BenchSetting *point,
                                         int count, int chosen)
{
    const BenchSetting *best = NULL;
    *how_many = 0;
    for (int i = 0; i < count; i++) {
        if (i == chosen || !bench_dominates(tunable, &point[i], &point[chosen])) continue;
        if ((*how_many)++ == 0 || bench_dominates(tunable, &point[i], best)) best = &point[i];
    }
    return best;
}

static int default_of(const BenchSetting *point, int count)
{
    int chosen = -1;
    for (int i = 0; i < count; i++)
        if (point[i].is_default) chosen = i;
    return chosen;
}

static void add_verdict(Bench *bench, const BenchTunable *tunable, const BenchSetting *point, int count, int chosen)
{
    char                what[160], against[256];
    int                 better;
    const BenchSetting *best = who_dominates(&better, tunable, point, count, chosen), *held = &point[chosen];
    snprintf(what, sizeof what, "%s: settings better than the default", tunable->name);
    BenchRow row = bench_row(what);
    row.error = better;
    if (!bench->quick) row.error_limit = 0;
    row.error_unit = better == 1 ? "setting" : "settings";
    snprintf(against, sizeof against, "none is better in time, error or memory alone");
    if (best) {
        char with[96] = "";
        if (best->bytes > 0 && held->bytes > 0)
            snprintf(with, sizeof with, ", %.2g x the memory", best->bytes / held->bytes);
        snprintf(against, sizeof against, "'%.60s': %.2g x the time, %.2g x the error%s%s", best->setting,
                 bench_ratio(&best->time, &held->time), held->error > 0 ? best->error / held->error : 1, with,
                 bench->quick ? "; quick rounds, not judged" : "");
    }
    row.against = against;
    bench_add(bench, &row);
}

/* ---- as text ----------------------------------------------------------------------------------- */

__attribute__((format(printf, 3, 4))) static void say(char *out, size_t size, const char *format, ...)
{
    const size_t n = strlen(out);
    va_list      arguments;
    va_start(arguments, format);
    vsnprintf(out + n, size - n, format, arguments);
    va_end(arguments);
}

static void say_trade(char *out, size_t size, const char *what, const BenchSetting *other, const BenchSetting *held)
{
    const double ratio = bench_ratio(&other->time, &held->time);
    if (other->error > 0 && held->error > 0)
        say(out, size, "%s '%.40s': %.2g x the time, %.2g x the error", what, other->setting, ratio,
            other->error / held->error);
    else
        say(out, size, "%s '%.40s': %.2g x the time, %s", what, other->setting, ratio,
            other->error > 0 ? "some error" : "no error");
    if (other->bytes > 1 && held->bytes > 1 && other->bytes != held->bytes)
        say(out, size, ", %.2g x the memory", other->bytes / held->bytes);
}

void bench_verdict(char out[512], const BenchTunable *tunable, const BenchSetting *point, int count, bool quick)
{
    const size_t size = 512;
    const int    chosen = default_of(point, count);
    char         error[32], stated[32];
    *out = 0;
    if (chosen < 0) {
        say(out, size, "No setting is the default: nothing is judged.");
        return;
    }
    const BenchSetting *held = &point[chosen], *faster = NULL, *closer = NULL;
    bench_show(error, held->error, tunable->error_unit);
    bench_show(stated, tunable->stated, tunable->error_unit);
    if (isnan(held->error)) say(out, size, "The error of the default, '%.40s', is unknown.", held->setting);
    else if (isnan(tunable->stated)) say(out, size, "The default, '%.40s', has an error of %s.", held->setting, error);
    else
        say(out, size, "The default, '%.40s', %s: %s, stated at most %s.", held->setting,
            held->error <= tunable->stated ? "keeps its stated error" : "MISSES its stated error", error, stated);
    int                 better;
    const BenchSetting *best = who_dominates(&better, tunable, point, count, chosen);
    if (best) {
        say(out, size, " %d better setting%s", better, better > 1 ? "s;" : ":");
        say_trade(out, size, "", best, held);
        say(out, size, quick ? " (quick rounds: not judged)." : ". The default is NOT on the front.");
        return;
    }
    for (int i = 0; i < count; i++) {
        if (i == chosen || isnan(point[i].error)) continue;
        const bool quicker = by_time(&point[i], held) == BETTER;
        if (quicker && (!faster || point[i].time.median_s > faster->time.median_s)) faster = &point[i];
        if (by_error(tunable, &point[i], held) == BETTER && (!closer || point[i].time.median_s < closer->time.median_s))
            closer = &point[i];
    }
    say(out, size, " It is on the front: ");
    if (faster) say_trade(out, size, "the next faster one is", faster, held);
    else say(out, size, "none is faster");
    say(out, size, "; ");
    if (closer) say_trade(out, size, "the next closer one is", closer, held);
    else say(out, size, "none is closer");
    say(out, size, ".");
}

static void keep_block(Bench *bench, const BenchTunable *tunable, const BenchSetting *point, int count, int chosen,
                       int first)
{
    if (bench->blocks == bench->blocks_capacity) {
        const int   larger = bench->blocks_capacity ? 2 * bench->blocks_capacity : 32;
        BenchBlock *grown = realloc(bench->block, (size_t)larger * sizeof *grown);
        if (!grown) {
            bench->out_of_memory = true;
            return;
        }
        bench->block = grown;
        bench->blocks_capacity = larger;
    }
    BenchBlock *b = &bench->block[bench->blocks++];
    *b = (BenchBlock){.first = first, .rows = bench->kept_count - first, .chosen = chosen < 0 ? -1 : first + chosen};
    snprintf(b->name, sizeof b->name, "%s", tunable->name);
    snprintf(b->turned_by, sizeof b->turned_by, "%s", tunable->turned_by ? tunable->turned_by : "");
    snprintf(b->of, sizeof b->of, "%s", tunable->of ? tunable->of : "");
    snprintf(b->also, sizeof b->also, "%s", point[0].also_is ? point[0].also_is : "");
    bench_verdict(b->words, tunable, point, count, bench->quick);
    for (int i = first; i < bench->kept_count; i++) b->broken |= !bench_holds(&bench->kept[i].row);
}

void bench_tunable_rows(Bench *bench, const BenchTunable *tunable, const BenchSetting *point, int count)
{
    const int chosen = default_of(point, count), before = bench->kept_count;
    char      what[256];
    for (int i = 0; i < count; i++) {
        const bool front = bench_on_front(tunable, point, count, i);
        snprintf(what, sizeof what, "%s: %s", tunable->name, point[i].setting);
        BenchRow row = bench_row_of(what, &point[i].time, NULL, 1);
        row.error = point[i].error;
        row.error_unit = tunable->error_unit;
        row.against = tunable->against;
        row.mark = i == chosen ? (front ? "* default" : "default") : front ? "*" : NULL;
        if (point[i].bytes > 1) row.rate = 1e-6 * point[i].bytes, row.rate_unit = "MB";
        if (i == chosen) row.error_limit = tunable->stated;
        else if (chosen >= 0) row.ratio = bench_ratio(&point[i].time, &point[chosen].time), row.to = "default";
        bench_add(bench, &row);
    }
    if (chosen >= 0) add_verdict(bench, tunable, point, count, chosen);
    char *text = plot_text(tunable, point, count);
    if (!text) bench->out_of_memory = true;
    if (text && bench->plots) write_plot(bench, tunable, text);
    if (bench->kept_count > before && !bench->kept[bench->kept_count - 1].plot) {
        bench->kept[bench->kept_count - 1].plot = text;
        keep_block(bench, tunable, point, count, chosen, before);
    } else {
        free(text);
    }
}

static bool default_dominated(const BenchTunable *tunable, const BenchSetting *point, int count)
{
    for (int k = 0; k < count; k++)
        if (point[k].is_default) return !bench_on_front(tunable, point, count, k);
    return false;
}

void bench_tunable(Bench *bench, const BenchTunable *tunable, const BenchWork *work, BenchSetting *point, int count)
{
    BenchTime time[bench_settings_max];
    bench_progress(bench, tunable->name);
    bench_time(time, bench, work, count);
    for (int k = 0; k < count; k++) point[k].time = time[k];
    if (!bench_quick(bench) && default_dominated(tunable, point, count)) {
        bench_time_more(time, bench, work, count);
        for (int k = 0; k < count; k++) point[k].time = time[k];
    }
    bench_tunable_rows(bench, tunable, point, count);
}
