/* tests/bench/bench_compare.c: two runs side by side, row by row.
 *
 * The runs were not interleaved, so a time must change more than within one: it is faster or slower when the medians
 * differ by a tenth (quick rounds: by a third) and the interquartile ranges of the rounds do not overlap; where a
 * row has no quartiles, its best must differ, too; and a time that was measured once must differ by half. When most
 * rows changed alike the cause is the machine: the median of all ratios is reported. An error is the same on the
 * same inputs: a tenth is a change. */
#include "tests/bench/bench_private.h"
#include "sensor/settings/command_line.h"

#include <stdlib.h>

typedef struct Entry {
    const char *bench, *what, *unit, *error_unit;
    double      median, best, low, high, rate, error, limit;
} Entry;

typedef struct Run {
    Table  table;
    Entry *entry; /* [count] */
    int   *order; /* [count] by bench, what, row */
    int   *other; /* [count] the same row of the other run; -1: none */
    int    count;
    bool   quartiles;
    char   version[64], machine[256], rounds[16], threads[16];
} Run;

enum { most_octets = 16 << 20 };

typedef enum Change { SAME, FASTER, SLOWER, LESS, MORE, OTHER_UNIT } Change;

typedef struct Verdict {
    Change change;
    double ratio; /* b / a; NaN: nothing to compare */
    bool   error_worse, error_better, broken, limit_wider;
} Verdict;

/* ---- reading ---------------------------------------------------------------------------------- */

/* Empty: NaN. Else a number that is not below 0; inf where a comparison failed. */
static bool read_number(double *out, const Run *run, int row, const char *name)
{
    const int   column = table_column(&run->table, name);
    const char *text = column < 0 ? "" : table_text(&run->table, row, column);
    *out = NAN;
    if (!*text) return true;
    if (strcmp(text, "inf") == 0) {
        *out = INFINITY;
        return true;
    }
    if (text_to_double(out, text) && *out >= 0) return true;
    char shown[64];
    text_escape(shown, sizeof shown, text, strlen(text) < 40 ? strlen(text) : 40);
    log_error("bench: %s:%d: %s: '%s' is not a number from 0 up; is this a table of `pitviper bench --csv`?",
              run->table.path, run->table.line[row + 1], name, shown);
    return false;
}

static const char *read_text(const Run *run, int row, const char *name)
{
    const int column = table_column(&run->table, name);
    return column < 0 ? "" : table_text(&run->table, row, column);
}

static void read_key(char *out, size_t out_size, const char *text, const char *key)
{
    char      begin[32];
    const int length = snprintf(begin, sizeof begin, "# %s: ", key);
    snprintf(out, out_size, "unknown");
    for (const char *at = text; at && *at == '#';) {
        if (strncmp(at, begin, (size_t)length) == 0) {
            const size_t octets = strcspn(at + length, "\r\n");
            text_escape(out, out_size, at + length, octets);
            return;
        }
        at = strchr(at, '\n');
        if (at) at++;
    }
}

static Status read_head(Run *run, const char *path)
{
    char        *text = NULL;
    size_t       octets;
    const Status status = text_read_file(&text, &octets, "bench", path, most_octets);
    if (status != STATUS_OK) return status;
    read_key(run->version, sizeof run->version, text, "version");
    read_key(run->machine, sizeof run->machine, text, "machine");
    read_key(run->rounds, sizeof run->rounds, text, "rounds");
    read_key(run->threads, sizeof run->threads, text, "threads");
    free(text);
    return STATUS_OK;
}

static int by_name(const void *pa, const void *pb, void *user)
{
    const Entry *entry = user, *a = &entry[*(const int *)pa], *b = &entry[*(const int *)pb];
    const int    bench = strcmp(a->bench, b->bench), what = bench ? bench : strcmp(a->what, b->what);
    return what ? what : (a > b) - (a < b);
}

static Status run_read(Run *run, const char *path)
{
    static const char *const needed[] = {"bench", "what", "median", "unit", "error", "error_limit"};
    Status                   status = read_head(run, path);
    if (status == STATUS_OK) status = table_open(&run->table, path);
    if (status != STATUS_OK) return status;
    for (size_t k = 0; k < sizeof needed / sizeof *needed; k++)
        if (table_column(&run->table, needed[k]) < 0) {
            log_error("bench: %s: no column `%s`; is this a table of `pitviper bench --csv`?", path, needed[k]);
            return STATUS_BAD_VALUE;
        }
    run->count = run->table.rows;
    run->quartiles = table_column(&run->table, "lower_quartile") >= 0;
    run->entry = calloc((size_t)run->count + 1, sizeof *run->entry);
    run->order = calloc((size_t)run->count + 1, sizeof *run->order);
    run->other = calloc((size_t)run->count + 1, sizeof *run->other);
    if (!run->entry || !run->order || !run->other) return STATUS_NO_MEMORY;
    for (int i = 0; i < run->count; i++) {
        Entry *e = &run->entry[i];
        *e = (Entry){.bench = read_text(run, i, "bench"),
                     .what = read_text(run, i, "what"),
                     .unit = read_text(run, i, "unit"),
                     .error_unit = read_text(run, i, "error_unit")};
        run->order[i] = i;
        run->other[i] = -1;
        if (!read_number(&e->median, run, i, "median") || !read_number(&e->best, run, i, "best") ||
            !read_number(&e->low, run, i, "lower_quartile") || !read_number(&e->high, run, i, "upper_quartile") ||
            !read_number(&e->rate, run, i, "rate") || !read_number(&e->error, run, i, "error") ||
            !read_number(&e->limit, run, i, "error_limit"))
            return STATUS_BAD_VALUE;
    }
    qsort_r(run->order, (size_t)run->count, sizeof *run->order, by_name, run->entry);
    return STATUS_OK;
}

static void run_close(Run *run)
{
    table_close(&run->table);
    free(run->entry);
    free(run->order);
    free(run->other);
}

/* Rows with one name are matched in their order. */
static void match(Run *a, Run *b)
{
    for (int i = 0, k = 0; i < a->count && k < b->count;) {
        const Entry *x = &a->entry[a->order[i]], *y = &b->entry[b->order[k]];
        const int    bench = strcmp(x->bench, y->bench), what = bench ? bench : strcmp(x->what, y->what);
        if (what == 0) {
            a->other[a->order[i]] = b->order[k];
            b->other[b->order[k]] = a->order[i];
        }
        i += what <= 0;
        k += what >= 0;
    }
}

/* ---- evaluation ---------------------------------------------------------------------------------- */

/* Whether two times differ beyond noise: the head of this file says how. */
static bool apart(const Entry *a, const Entry *b, double ratio, double least)
{
    const double by = ratio > 1 ? ratio : 1 / ratio;
    if (a->high >= a->low && b->high >= b->low) return by > least && (ratio > 1 ? b->low > a->high : b->high < a->low);
    if (a->best > 0 && b->best > 0)
        return by > least && (ratio > 1 ? b->best > least * a->best : least * b->best < a->best);
    return by > 1.5;
}

static Verdict judge(const Entry *a, const Entry *b, double least)
{
    Verdict    v = {.ratio = NAN};
    const bool time = strcmp(b->unit, "s") == 0, same_unit = strcmp(a->unit, b->unit) == 0;
    if (!same_unit) {
        v.change = OTHER_UNIT;
    } else if (a->median > 0 && b->median > 0 && a->median < INFINITY && b->median < INFINITY) {
        v.ratio = b->median / a->median;
        if (time && apart(a, b, v.ratio, least)) v.change = v.ratio > 1 ? SLOWER : FASTER;
        if (!time && (v.ratio > 1.1 || v.ratio < 1 / 1.1)) v.change = v.ratio > 1 ? MORE : LESS;
    }
    const bool same_error_unit = strcmp(a->error_unit, b->error_unit) == 0;
    const bool judged = !isnan(b->limit), known = !isnan(a->error) && !isnan(b->error) && same_error_unit;
    const bool held = isnan(a->limit) || a->error <= a->limit;
    v.error_worse = (known && b->error > 1.1 * a->error) || (!isnan(a->error) && isnan(b->error));
    v.error_better = known && 1.1 * b->error < a->error;
    v.broken = judged && !(b->error <= b->limit) && (held || v.error_worse);
    v.limit_wider = (b->limit > a->limit && same_error_unit) || (!isnan(a->limit) && isnan(b->limit));
    return v;
}

static void verdict_text(char out[128], const Verdict *v)
{
    static const char *const word[] = {"", "faster", "slower", "less", "more", "another unit"};
    int                      n = 0;
    out[0] = 0;
    if (v->change == OTHER_UNIT) n = snprintf(out, 128, "another unit");
    else if (v->change != SAME)
        n = snprintf(out, 128, "%s %.2f x", word[v->change],
                     v->change == FASTER || v->change == LESS ? 1 / v->ratio : v->ratio);
    const char *error = v->broken         ? "error beyond its limit"
                        : v->error_worse  ? "error worse"
                        : v->error_better ? "error better"
                                          : NULL;
    if (error) n += snprintf(out + n, (size_t)(128 - n), "%s%s", n ? ", " : "", error);
    if (v->limit_wider) n += snprintf(out + n, (size_t)(128 - n), "%slimit wider", n ? ", " : "");
    if (n == 0) snprintf(out, 128, "within noise");
}

/* ---- output ---------------------------------------------------------------------------------- */

typedef struct Tally {
    int both, noise, faster, slower, too_slow, broken, worse, better, gone, new;
} Tally;

typedef struct Limits {
    double least;  /* factor below which a time is noise */
    double slower; /* factor beyond which a row fails */
} Limits;

typedef struct Line { /* a row of both, or of one */
    char what[192], a[32], b[32], ratio[32], error_a[32], error_b[32], verdict[128];
    bool bad;
} Line;

static void line_of(Line *out, const Entry *a, const Entry *b, const Limits *limits, Tally *tally)
{
    const Entry *one = b ? b : a;
    char         what[128], bench[32];
    text_escape(bench, sizeof bench, one->bench, strlen(one->bench));
    text_escape(what, sizeof what, one->what, strlen(one->what));
    *out = (Line){.bad = false};
    snprintf(out->what, sizeof out->what, "%s: %s", bench, what);
    if (a) bench_show(out->a, a->median, a->unit), bench_show(out->error_a, a->error, a->error_unit);
    if (b) bench_show(out->b, b->median, b->unit), bench_show(out->error_b, b->error, b->error_unit);
    if (!a || !b) {
        snprintf(out->verdict, sizeof out->verdict, a ? "only in the first" : "only in the second");
        *(a ? &tally->gone : &tally->new) += 1;
        return;
    }
    const Verdict v = judge(a, b, limits->least);
    verdict_text(out->verdict, &v);
    if (!isnan(v.ratio)) {
        snprintf(out->ratio, sizeof out->ratio, "%.2f", v.ratio);
        if (a->low > 0 && b->low > 0 && a->high > 0 && b->high > 0 && strcmp(b->unit, "s") == 0)
            snprintf(out->ratio, sizeof out->ratio, "%.2f (%.2f .. %.2f)", v.ratio, b->low / a->high, b->high / a->low);
    }
    const bool too_slow = v.change == SLOWER && v.ratio > limits->slower;
    out->bad = v.broken || too_slow;
    tally->both++;
    tally->noise += strcmp(out->verdict, "within noise") == 0;
    tally->faster += v.change == FASTER;
    tally->slower += v.change == SLOWER;
    tally->too_slow += too_slow;
    tally->broken += v.broken;
    tally->worse += v.error_worse && !v.broken;
    tally->better += v.error_better;
}

static void show_line(FILE *page, const Line *l)
{
    printf("%-70s %10s %10s  %-20s %12s %12s  %s\n", l->what, l->a, l->b, l->ratio, l->error_a, l->error_b, l->verdict);
    if (!page) return;
    const char *const cells[] = {l->a, l->b, l->ratio, l->error_a, l->error_b};
    fputs("<tr><td>", page);
    html_text(page, "%s", l->what);
    for (size_t k = 0; k < sizeof cells / sizeof *cells; k++) {
        fputs("</td><td class=\"n\">", page);
        html_text(page, "%s", cells[k]);
    }
    fprintf(page, "</td><td style=\"white-space:nowrap\" class=\"%s\">",
            l->bad                                    ? "bad"
            : strcmp(l->verdict, "within noise") == 0 ? "dim"
                                                      : "");
    html_text(page, "%s", l->verdict);
    fputs("</td></tr>\n", page);
}

static void show_text(FILE *page, const char *text)
{
    fputs("<p>", page);
    html_text(page, "%s", text);
    fputs("</p>\n", page);
}

static void remark(FILE *page, const char *text)
{
    puts(text);
    if (page) show_text(page, text);
}

/* Differences that make two runs hard to compare. */
static void show_heads(FILE *page, const Run *a, const Run *b)
{
    char text[700];
    snprintf(text, sizeof text, "first: %s, %s, %s rounds, %s threads", a->version, a->machine, a->rounds, a->threads);
    remark(page, text);
    snprintf(text, sizeof text, "second: %s, %s, %s rounds, %s threads", b->version, b->machine, b->rounds, b->threads);
    remark(page, text);
    if (strcmp(a->machine, b->machine) != 0)
        remark(page, "Different machines: times say which machine is faster, not which version.");
    if (strcmp(a->rounds, b->rounds) != 0)
        remark(page, "Quick rounds against full ones: scenes of another size, and more noise.");
    if (strcmp(a->threads, b->threads) != 0) remark(page, "Not the same number of threads.");
    if (!a->quartiles || !b->quartiles) remark(page, "Without quartiles in both, the best rounds say what noise is.");
}

static void count_rows(Tally *tally, const Run *a, const Run *b, const Limits *limits)
{
    Line line;
    for (int i = 0; i < b->count; i++)
        line_of(&line, b->other[i] < 0 ? NULL : &a->entry[b->other[i]], &b->entry[i], limits, tally);
    for (int i = 0; i < a->count; i++)
        if (a->other[i] < 0) line_of(&line, &a->entry[i], NULL, limits, tally);
}

static void show_rows(FILE *page, const Run *a, const Run *b, const Limits *limits)
{
    Line  line;
    Tally again = {0}, *tally = &again;
    printf("\n%-70s %10s %10s  %-20s %12s %12s\n", "", "first", "second", "ratio", "error", "error");
    if (page)
        fputs("<table><tr><th>row</th><th class=\"n\">first</th><th class=\"n\">second</th><th class=\"n\">ratio</th>"
              "<th class=\"n\">error, first</th><th class=\"n\">error, second</th><th>verdict</th></tr>\n",
              page);
    for (int i = 0; i < b->count; i++) {
        line_of(&line, b->other[i] < 0 ? NULL : &a->entry[b->other[i]], &b->entry[i], limits, tally);
        show_line(page, &line);
    }
    for (int i = 0; i < a->count; i++) {
        if (a->other[i] >= 0) continue;
        line_of(&line, &a->entry[i], NULL, limits, tally);
        show_line(page, &line);
    }
    if (page) fputs("</table>\n", page);
    putchar('\n');
}

static int by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

/* Shows the median of all ratios of times: the change common to all rows. */
static void show_drift(FILE *page, const Run *a, const Run *b)
{
    double *ratio = calloc((size_t)b->count + 1, sizeof *ratio);
    char    text[160];
    int     n = 0;
    for (int i = 0; ratio && i < b->count; i++) {
        const Entry *x = b->other[i] < 0 ? NULL : &a->entry[b->other[i]], *y = &b->entry[i];
        if (x && strcmp(x->unit, "s") == 0 && strcmp(y->unit, "s") == 0 && x->median > 0 && y->median > 0)
            ratio[n++] = y->median / x->median;
    }
    if (n > 0) {
        qsort(ratio, (size_t)n, sizeof *ratio, by_value);
        snprintf(text, sizeof text, "median ratio of %d times: %.2f; what moves all rows alike is the machine", n,
                 ratio[n / 2]);
        remark(page, text);
    }
    free(ratio);
}

int bench_compare(int argc, char **argv)
{
    Run         a = {.count = 0}, b = {.count = 0};
    const char *path[2] = {NULL, NULL}, *report = NULL;
    double      slower = INFINITY;
    Tally       tally = {0};
    FILE       *page = NULL;
    char        text[256];
    enum { REPORT = 256, LIMIT, HELP };
    static const struct option options[] = {
        {"report", 1, NULL, REPORT}, {"slower", 1, NULL, LIMIT}, {"help", 0, NULL, HELP}, {NULL, 0, NULL, 0}};
    static char called[] = "pitviper bench";
    argv[0] = called; /* of messages */
    optind = 0;       /* restart getopt */
    for (int option; (option = command_line_option(argc, argv, "", options)) != -1;) switch (option) {
        case REPORT:
            report = optarg;
            break;
        case LIMIT:
            if (!text_to_double(&slower, optarg) || !(slower >= 1))
                return command_line_wrong("bench", "--slower: '%s' is not a factor from 1 up", optarg);
            break;
        case HELP:
            fputs("usage: pitviper bench compare A.csv B.csv [--report FILE] [--slower FACTOR]\n", stdout);
            return 0;
        default:
            return 2; /* reported by command_line_option */
        }
    if (argc - optind != 2)
        return command_line_wrong("bench", "compare needs two tables: pitviper bench compare A.csv B.csv");
    for (int k = 0; k < 2; k++) path[k] = argv[optind + k];
    Status status = run_read(&a, path[0]);
    if (status == STATUS_OK) status = run_read(&b, path[1]);
    if (status == STATUS_NO_MEMORY) log_error("bench: out of memory for the tables");
    if (status == STATUS_OK && report && !(page = html_begin(report, "pitviper bench compare"))) status = STATUS_IO;
    if (status == STATUS_OK) {
        match(&a, &b);
        show_heads(page, &a, &b);
        const bool   quick = strcmp(a.rounds, "quick") == 0 || strcmp(b.rounds, "quick") == 0;
        const Limits limits = {quick ? 1.3 : 1.1, slower};
        show_drift(page, &a, &b);
        count_rows(&tally, &a, &b, &limits);
        snprintf(text, sizeof text,
                 "%d rows in both: %d within noise, %d faster, %d slower; errors: %d beyond their limit, %d worse, "
                 "%d better; only in the first %d, only in the second %d",
                 tally.both, tally.noise, tally.faster, tally.slower, tally.broken, tally.worse, tally.better,
                 tally.gone, tally.new);
        if (page) show_text(page, text);
        show_rows(page, &a, &b, &limits);
        puts(text);
        if (page) status = html_end(page, report);
    }
    if (tally.broken) log_error("bench: %d errors became worse, beyond their limit", tally.broken);
    if (tally.too_slow) log_error("bench: %d rows are slower by more than %g x", tally.too_slow, slower);
    run_close(&a);
    run_close(&b);
    return status == STATUS_OK && tally.broken == 0 && tally.too_slow == 0 ? 0 : 1;
}
