/* sensor/verify/regress/regress.c: the command `pitviper regress`: its options, the cases given, their output and
 * summary. */
#include "sensor/verify/regress/regress.h"
#include "pitviper_output.h"

#include "sensor/node/run/stop.h"
#include "sensor/publish/files/frame_files.h"
#include "sensor/publish/images/image_file.h"
#include "sensor/verify/regress/run_case.h"
#include "sensor/settings/command_line.h"

#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { cases_max = 4096 };

static const char help[] =
    "usage: pitviper regress CASE ... [options]\n"
    "       pitviper regress --update CASE ... --why TEXT [options]\n"
    "       pitviper regress bisect OLD NEW CASE [options]\n"
    "\n"
    "Re-renders recorded exercises and compares images, truth and counters with approved baselines. CASE is a folder "
    "with\n"
    "a case.yaml, or a folder of such folders.\n"
    "\n"
    "  --update             approve: write the baseline (record/) from the present output, and card.md\n"
    "  --why TEXT           the reason, kept in card.md; required with --update, and only there\n"
    "  --allow-missing      skip a case whose log is missing; otherwise it fails, unless its case.yaml has\n"
    "                       log_may_be_absent: true\n"
    "  --junit FILE         JUnit XML for a test server\n"
    "  --report FILE        one HTML page: expected, actual and difference of each channel that failed\n"
    "  --work DIR           working folder, kept (default: a temporary folder, kept when a case fails)\n"
    "  --jobs N             cases in parallel (default: one per processor)\n"
    "  --threads N          threads of each case (default: the remaining processors)\n"
    "  --isa NAME           instruction set of the ray tracer: avx2 (default), sse4.2, avx512\n"
    "  --keys               print every key of case.yaml, with its range and default\n"
    "  --help               print this help\n"
    "\n"
    "bisect: which difference of two programs, folders of tables or files of settings moves a case\n"
    "  (`pitviper regress bisect --help`)\n"
    "\n"
    "a case\n"
    "  case.yaml            purpose: one sentence; scenario: (a name of `pitviper exercise`, or a file) or log: (a\n"
    "                       file, or ${PITVIPER_DATA}/...); config: | (settings of replay); frames: [3, 7, 12];\n"
    "                       tolerance: what differs from the defaults; scores: a recogniser's command, or its recorded\n"
    "                       answers. --keys prints all\n"
    "  record/              the baseline, written by --update: a small EXR per frame, truth.jsonl, run.json, scores.json\n"
    "  card.md              written by --update: when and why the baseline changed, newest first\n"
    "\n"
    "compared, in the order of the data path; the first failed channel is named, as the probable cause of the others\n"
    "  counters, time, pose of the sensor, sun, motion of the targets; entity, part, range, normal, visible targets;\n"
    "  material; temperature; optical, mwir, lwir, radar, radar profile; target signals; scores of a recogniser; error\n"
    "  budget. Ids and counters must be equal; radiance may differ by 0.05 K apparent, 1 % of optical radiance,\n"
    "  0.1 dB, in all but 0.1 % of the pixels. The rounding of the baseline is within these tolerances.\n"
    "\n"
    "Differences of the inputs from those of the baseline (tables, models, settings, log, libraries, choices) are\n"
    "reported before any channel, by hashes in run.json. Each case runs in processes of its own: a crash or a timeout\n"
    "fails only that case. A missing log or baseline fails the case, unless allowed. --update prints the automatic\n"
    "choices: host, aim, terrain, time. Exit code: 0: nothing failed; 1: a case failed; 2: usage; 130, 143: stopped\n"
    "by Ctrl-C, by SIGTERM.\n";

typedef struct Options {
    bool        update, allow_missing;
    const char *why, *junit, *report, *work, *isa;
    int         jobs, threads;
} Options;

typedef struct Suite {
    Options         o;
    CaseResult    **result;
    int             count, done, printed;
    CaseHow         how;
    bool           *ended;
    double          begun_s;
    pthread_mutex_t lock;
} Suite;

/* ---- command line ----------------------------------------------------------------------------- */

static int refuse(const char *format, const char *text)
{
    char line[512];
    snprintf(line, sizeof line, format, text);
    return 1 + command_line_wrong("regress", "%s", line);
}

static bool parse_count(int *out, const char *text)
{
    long long value;
    if (!text_to_long(&value, text) || value < 1 || value > 256) return false;
    *out = (int)value;
    return true;
}

/* Returns 0 to continue; else the program exits with this code - 1. */
static int parse(Options *o, int argc, char **argv)
{
    enum { UPDATE = 256, WHY, JUNIT, REPORT, WORK, JOBS, THREADS, ISA, KEYS, ALLOW, HELP };
    static const struct option options[] = {
        {"update", 0, NULL, UPDATE},       {"why", 1, NULL, WHY},   {"junit", 1, NULL, JUNIT},
        {"report", 1, NULL, REPORT},       {"work", 1, NULL, WORK}, {"jobs", 1, NULL, JOBS},
        {"threads", 1, NULL, THREADS},     {"isa", 1, NULL, ISA},   {"keys", 0, NULL, KEYS},
        {"allow-missing", 0, NULL, ALLOW}, {"help", 0, NULL, HELP}, {NULL, 0, NULL, 0}};
    optind = 0;
    for (int option; (option = command_line_option(argc, argv, "", options)) != -1;) {
        switch (option) {
        case UPDATE:
            o->update = true;
            break;
        case WHY:
            o->why = optarg;
            break;
        case JUNIT:
            o->junit = optarg;
            break;
        case REPORT:
            o->report = optarg;
            break;
        case WORK:
            o->work = optarg;
            break;
        case JOBS:
            if (!parse_count(&o->jobs, optarg)) return refuse("--jobs: '%s' is not a whole number in 1 .. 256", optarg);
            break;
        case THREADS:
            if (!parse_count(&o->threads, optarg))
                return refuse("--threads: '%s' is not a whole number in 1 .. 256", optarg);
            break;
        case ISA:
            if (strcmp(optarg, "avx2") != 0 && strcmp(optarg, "sse4.2") != 0 && strcmp(optarg, "avx512") != 0)
                return refuse("--isa: '%s' is not avx2, sse4.2 or avx512", optarg);
            o->isa = optarg;
            break;
        case ALLOW:
            o->allow_missing = true;
            break;
        case KEYS:
            case_write_keys(stdout);
            return 1;
        case HELP:
            fputs(help, stdout);
            return 1;
        default:
            return 1 + 2; /* reported by command_line_option */
        }
    }
    if (optind == argc) return refuse("no CASE is named: usage: pitviper regress CASE ... [options]%s", "");
    if (o->update && (!o->why || strspn(o->why, " \t\r\n") == strlen(o->why)))
        return refuse("--update needs --why TEXT: %s", "one sentence why the baseline changes; card.md keeps it");
    if (o->why && !o->update) return refuse("--why needs --update; %s", "give both, or neither");
    if (o->update && (o->junit || o->report))
        return refuse("--update makes no comparison, so --junit and --report do not apply; %s",
                      "run again without --update");
    if (o->work && !*o->work) return refuse("--work: the name of the folder is empty%s", "");
    return 0;
}

/* ---- the cases -------------------------------------------------------------------------------- */

static bool is_case(const char *folder)
{
    char        path[case_path_size + 16];
    struct stat there;
    snprintf(path, sizeof path, "%.4090s/case.yaml", folder);
    return stat(path, &there) == 0;
}

static int count_named(const Suite *s, const char *name)
{
    int count = 0;
    for (int i = 0; i < s->count; i++) count += strcmp(s->result[i]->c.name, name) == 0;
    return count;
}

/* False, logged: the case cannot be read, is given twice, or there are too many. */
static bool add_case(Suite *s, const char *folder)
{
    CaseResult *r = calloc(1, sizeof *r);
    if (!r || s->count == cases_max) {
        free(r);
        log_error("regress: more than %d cases, or out of memory", cases_max);
        return false;
    }
    char *real = realpath(folder, NULL);
    for (int i = 0; i < s->count; i++) {
        char      *other = realpath(s->result[i]->c.folder, NULL);
        const bool same = real && other && strcmp(real, other) == 0;
        free(other);
        if (!same) continue;
        log_error("regress: %s is given twice", folder);
        free(real);
        free(r);
        return false;
    }
    free(real);
    if (case_read(&r->c, folder) != STATUS_OK) {
        free(r);
        return false;
    }
    const int before = count_named(s, r->c.name);
    if (before == 0) snprintf(r->work, sizeof r->work, "%.3900s/%s", s->o.work, r->c.name);
    else snprintf(r->work, sizeof r->work, "%.3900s/%s-%d", s->o.work, r->c.name, before + 1);
    s->result[s->count++] = r;
    return true;
}

static bool add_argument(Suite *s, const char *argument)
{
    struct dirent **entry;
    char            path[case_path_size];
    char           *folder = strdup(argument);
    bool            ok = folder != NULL;
    int             found = 0;
    for (size_t n = ok ? strlen(folder) : 0; n > 1 && folder[n - 1] == '/'; n--) folder[n - 1] = 0;
    const int entries = ok && !is_case(folder) ? scandir(folder, &entry, NULL, alphasort) : -1;
    for (int i = 0; i < entries; i++) {
        if (ok && entry[i]->d_name[0] != '.' &&
            snprintf(path, sizeof path, "%s/%s", folder, entry[i]->d_name) < (int)sizeof path && is_case(path)) {
            ok = add_case(s, path);
            found++;
        }
        free(entry[i]);
    }
    if (entries >= 0) free(entry);
    if (ok && found == 0) ok = add_case(s, folder); /* which reports what is missing */
    free(folder);
    return ok;
}

/* ---- output ---------------------------------------------------------------------------------- */

const char *case_state_name(CaseState state)
{
    static const char *const names[CASE_STATES] = {"ok", "FAILED", "FAILED", "FAILED", "skipped"};
    return names[state];
}

/* Prints lines, each after the case's name and a word. */
static void print_lines(const CaseResult *r, const char *word, const char *text)
{
    for (size_t length; *text; text += length + (text[length] == '\n')) {
        length = strcspn(text, "\n");
        text_print(stdout, "%-24s %s%.*s\n", r->c.name, word, (int)length, text);
    }
}

/* Prints a case's line: the inputs that changed, then the channels that failed. */
static void print_line(const CaseResult *r)
{
    if (r->state == CASE_FAILED) print_lines(r, "changed: ", r->verdict.remarks);
    if (r->updated) print_lines(r, "chosen: ", r->chosen);
    text_print(stdout, "%-24s %s%s%s", r->c.name, r->updated ? "updated" : case_state_name(r->state),
               *r->line ? ": "
                          ""
                        : "",
               r->line);
    if (r->state != CASE_SKIPPED && r->state != CASE_NO_RECORD) printf("  (%.1f s)", r->seconds);
    putchar('\n');
}

static void show_progress(const Suite *s)
{
    char text[64];
    snprintf(text, sizeof text, "%d of %d cases, %.0f s", s->done, s->count, wall_clock_s() - s->begun_s);
    log_status(s->done == s->count ? NULL : text);
}

/* Results are printed in the order given, each as soon as those before it are done. */
static void take_case(void *user, int worker, int task)
{
    Suite *s = user;
    (void)worker;
    run_case(s->result[task], &s->how);
    pthread_mutex_lock(&s->lock);
    s->ended[task] = true;
    s->done++;
    log_status(NULL);
    for (; s->printed < s->count && s->ended[s->printed]; s->printed++) print_line(s->result[s->printed]);
    fflush(stdout);
    show_progress(s);
    pthread_mutex_unlock(&s->lock);
}

/* ---- folders ---------------------------------------------------------------------------------- */

/* Opens a temporary folder (its path in own), or the one given by --work. */
static bool open_work(Suite *s, char own[case_path_size])
{
    *own = 0;
    if (s->o.work) return frame_files_folder(s->o.work) == STATUS_OK;
    if (!temp_folder(own)) return false;
    s->o.work = own;
    return true;
}

/* Told before the cases are run, and not after. */
static bool can_report(const Options *o)
{
    const char *const path[] = {o->junit, o->report}, *const option[] = {"--junit", "--report"};
    for (int i = 0; i < 2; i++) {
        if (!path[i] || output_check(path[i], OUTPUT_STREAM) == 0) continue;
        log_error("regress: %s: cannot write %s: %s; choose another place", option[i], path[i], output_reason(errno));
        return false;
    }
    return true;
}

/* ---- the command ------------------------------------------------------------------------------ */

static bool run_all(Suite *s)
{
    Pool     *pool;
    const int processors = thread_processors();
    int       jobs = s->o.jobs ? s->o.jobs : processors;
    if (jobs > s->count) jobs = s->count;
    const int left = processors / jobs > 1 ? processors / jobs : 1;
    s->how = (CaseHow){.threads = s->o.threads ? s->o.threads : left,
                       .isa = s->o.isa,
                       .update = s->o.update,
                       .allow_missing = s->o.allow_missing,
                       .why = s->o.why};
    s->begun_s = wall_clock_s();
    if (image_file_prepare() != STATUS_OK || image_read_prepare() != STATUS_OK) return false; /* baselines are images */
    if (pool_create(&pool, jobs) != STATUS_OK) {
        log_error("regress: cannot start %d threads; give fewer --jobs", jobs);
        return false;
    }
    log_set_sink(run_case_log, NULL);
    show_progress(s);
    pool_run(pool, s->count, take_case, s);
    log_set_sink(NULL, NULL);
    pool_destroy(pool);
    return true;
}

static int summary(const Suite *s)
{
    int of[CASE_STATES] = {0};
    for (int i = 0; i < s->count; i++) of[s->result[i]->state]++;
    const int failed = of[CASE_FAILED] + of[CASE_BROKEN] + of[CASE_NO_RECORD];
    printf("%d case%s: %d %s, %d failed, %d skipped, %.1f s\n", s->count, s->count == 1 ? "" : "s", of[CASE_OK],
           s->o.update ? "updated" : "ok", failed, of[CASE_SKIPPED], wall_clock_s() - s->begun_s);
    return failed;
}

int regress_cases_command(int argc, char **argv)
{
    Suite     s = {.lock = PTHREAD_MUTEX_INITIALIZER};
    char      own[case_path_size];
    const int stop = parse(&s.o, argc, argv);
    int       code = 1, failed = 0;
    if (stop) return stop - 1;
    thread_flush_denormals();
    stop_by_signals();
    s.result = calloc(cases_max, sizeof *s.result);
    s.ended = calloc(cases_max, sizeof *s.ended);
    if (!s.result || !s.ended || !open_work(&s, own)) goto done;
    for (int i = optind; i < argc; i++)
        if (!add_argument(&s, argv[i])) {
            code = 2;
            goto done;
        }
    if (!can_report(&s.o) || !run_all(&s)) goto done;
    failed = summary(&s);
    code = !failed ? 0 : stop_asked() ? stop_exit_code() : 1;
    if (s.o.junit && regress_junit_write(s.o.junit, (const CaseResult *const *)s.result, s.count) != STATUS_OK)
        code = 1;
    if (s.o.report && regress_report_write(s.o.report, (const CaseResult *const *)s.result, s.count) != STATUS_OK)
        code = 1;
    for (int i = 0; i < s.count && *own; i++)
        if (s.result[i]->state == CASE_OK || s.result[i]->state == CASE_SKIPPED) run_case_remove(s.result[i]->work);
    if (failed && *own && access(own, F_OK) == 0 && rmdir(own) != 0)
        text_print(stdout,
                   "the output of the failed "
                   "cases is kept in %s\n",
                   own);

done:
    if (!failed && s.o.work && *own) run_case_remove(own);
    for (int i = 0; i < s.count; i++) free(s.result[i]);
    free(s.result);
    free(s.ended);
    return code;
}
