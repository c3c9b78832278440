/* sensor/verify/bisect/bisect.c: the command `pitviper regress bisect`: its options, the runs of OLD and NEW, the
 * search between them. */
#include "sensor/verify/bisect/bisect.h"
#include "pitviper_output.h"

#include "sensor/node/run/stop.h"
#include "sensor/publish/images/image_file.h"
#include "sensor/settings/command_line.h"
#include "sensor/verify/bisect/bisect_private.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

static const char help[] =
    "usage: pitviper regress bisect OLD NEW CASE [options]\n"
    "\n"
    "Of two versions, finds the single difference that moves a case of `pitviper regress`: the first channel along the\n"
    "data path in which NEW is beyond the case's tolerances of OLD. OLD and NEW are both\n"
    "\n"
    "  programs             pitviper, or a folder with it (an installation, a build): the program and its tables are\n"
    "                       tried apart, then the files and rows of the tables\n"
    "  folders of tables    such as etc or share/pitviper (as for PITVIPER_ETC): each file that differs is tried, then\n"
    "                       each row in it\n"
    "  files of settings    their keys over those of the case: each key that differs is tried. Keys of network,\n"
    "                       publish, record and cache are left as in the case\n"
    "\n"
    "Each run has some of the differences as in NEW, the others as in OLD, and is compared with OLD's own output; CASE\n"
    "needs no baseline. Of six or fewer each is tried alone; of more, halves are. What is found moves the channel with no\n"
    "other difference, and the others are tried without it. Differences that only act together are named together.\n"
    "\n"
    "  --out DIR            also DIR/report.html, with images, DIR/bisect.json, and in DIR/work the runs of OLD, NEW and\n"
    "                       each cause; without it only temporary files are written\n"
    "  --old-tables DIR     tables of the program OLD; by default those that it says it reads\n"
    "  --new-tables DIR     the same of NEW\n"
    "  --runs N             at most so many runs of the case, beside those of OLD and NEW: 1 .. 10000 (default 200)\n"
    "  --threads N          threads of a run (default: all processors)\n"
    "  --isa NAME           instruction set of the ray tracer: avx2 (default), sse4.2, avx512\n"
    "  --help               print this help\n"
    "\n"
    "Exit code: 0: no channel moves; 1: one does, and what moves it is named; 2: usage; 3: OLD or NEW cannot run the case,\n"
    "or what moves it was not found; 130, 143: stopped by Ctrl-C, by SIGTERM.\n";

enum { code_still = 0, code_moved = 1, code_usage = 2, code_not_known = 3 };

typedef struct Options {
    const char *out, *old_tables, *new_tables, *isa, *old, *new, *folder;
    int         runs, threads;
} Options;

static bool parse_count(int *out, const char *text, int most, const char *option)
{
    long long value;
    if (text_to_long(&value, text) && value >= 1 && value <= most) {
        *out = (int)value;
        return true;
    }
    command_line_wrong("regress bisect", "%s: '%s' is not a whole number in 1 .. %d", option, text, most);
    return false;
}

/* Returns 0 to continue; else the program exits with this code - 1. */
static int parse(Options *o, int argc, char **argv)
{
    enum { OUT = 256, OLD_TABLES, NEW_TABLES, RUNS, THREADS, ISA, HELP };
    static const struct option options[] = {{"out", 1, NULL, OUT},
                                            {"old-tables", 1, NULL, OLD_TABLES},
                                            {"new-tables", 1, NULL, NEW_TABLES},
                                            {"runs", 1, NULL, RUNS},
                                            {"threads", 1, NULL, THREADS},
                                            {"isa", 1, NULL, ISA},
                                            {"help", 0, NULL, HELP},
                                            {NULL, 0, NULL, 0}};
    optind = 0;
    for (int option; (option = command_line_option(argc, argv, "", options)) != -1;) {
        switch (option) {
        case OUT:
            o->out = optarg;
            break;
        case OLD_TABLES:
            o->old_tables = optarg;
            break;
        case NEW_TABLES:
            o->new_tables = optarg;
            break;
        case RUNS:
            if (!parse_count(&o->runs, optarg, 10000, "--runs")) return 1 + code_usage;
            break;
        case THREADS:
            if (!parse_count(&o->threads, optarg, 256, "--threads")) return 1 + code_usage;
            break;
        case ISA:
            if (strcmp(optarg, "avx2") != 0 && strcmp(optarg, "sse4.2") != 0 && strcmp(optarg, "avx512") != 0)
                return 1 + command_line_wrong("regress bisect", "--isa: '%s' is not avx2, sse4.2 or avx512", optarg);
            o->isa = optarg;
            break;
        case HELP:
            fputs(help, stdout);
            return 1;
        default:
            return 1 + code_usage; /* reported by command_line_option */
        }
    }
    if (argc - optind != 3)
        return 1 + command_line_wrong("regress bisect",
                                      "%d arguments where OLD NEW CASE are three: usage: pitviper "
                                      "regress bisect OLD NEW CASE [options]",
                                      argc - optind);
    if (o->out && !*o->out) return 1 + command_line_wrong("regress bisect", "--out: the name of the folder is empty");
    o->old = argv[optind];
    o->new = argv[optind + 1];
    o->folder = argv[optind + 2];
    return 0;
}

static Status open_sides(Bisect *b, const Options *o)
{
    Differences *d = &b->d;
    Status       status = side_open(&d->old, o->old, o->old_tables);
    if (status == STATUS_OK) status = side_open(&d->new, o->new, o->new_tables);
    if (status == STATUS_OK && d->old.kind != d->new.kind) {
        log_error("regress: bisect: %s and %s are not of one kind: %s, %s; name two of one", o->old, o->new,
                  side_kind_name(d->old.kind), side_kind_name(d->new.kind));
        status = STATUS_BAD_VALUE;
    }
    if (status == STATUS_OK && d->old.kind != SIDE_PROGRAM && (o->old_tables || o->new_tables)) {
        log_error("regress: bisect: --old-tables and --new-tables are of programs, and %s are given; leave them out",
                  side_kind_name(d->old.kind));
        status = STATUS_BAD_VALUE;
    }
    return status;
}

/* DIR/work, which must be new; or a temporary folder, in own. */
static bool open_work(Bisect *b, const Options *o, char own[temp_path_size])
{
    char work[case_path_size];
    if (!o->out) {
        if (!temp_folder(own)) return false;
        char *real = realpath(own, NULL);
        snprintf(b->work, sizeof b->work, "%s", real ? real : own);
        free(real);
        return true;
    }
    if (snprintf(work, sizeof work, "%s/work", o->out) > case_path_size - 400) {
        log_error("regress: bisect: --out: the path is too long; change to a nearer folder");
        return false;
    }
    if (access(work, F_OK) == 0) {
        log_error("regress: bisect: --out: %s is there, of an earlier bisection; remove it, or name another folder",
                  work);
        return false;
    }
    char *real = output_folder(work) == 0 ? realpath(work, NULL) : NULL;
    if (!real || strlen(real) > case_path_size - 300) {
        log_error("regress: bisect: --out: cannot make %s: %s; name another folder", work, output_reason(errno));
        free(real);
        return false;
    }
    snprintf(b->work, sizeof b->work, "%s", real);
    free(real);
    return true;
}

/* ---- OLD and NEW -------------------------------------------------------------------------------- */

static bool run_side(CaseResult *r, Bisect *b, const char *word, bool new)
{
    log_status(new ? "the run of NEW" : "the run of OLD");
    trial_run(r, b, word, NULL, new, new);
    log_status(NULL);
    if (r->state == CASE_OK || r->state == CASE_FAILED) return true;
    if (stop_asked()) return false;
    log_error("regress: bisect: %s (%s) cannot run %s: %s", new ? "NEW" : "OLD", new ? b->d.new.given : b->d.old.given,
              b->c.name, r->line);
    return false;
}

static void compare_approved(Bisect *b)
{
    char record[case_path_size + 64], out[case_path_size + 64];
    snprintf(record, sizeof record, "%.4080s/record", b->c.folder);
    snprintf(out, sizeof out, "%.4080s/out", b->old->work);
    if (access(record, F_OK) != 0) return;
    log_suppress(true);
    b->compared_approved = verdict_of(&b->approved, &b->c, record, out) == STATUS_OK;
    log_suppress(false);
    if (b->compared_approved && b->approved.first >= 0)
        text_print(stdout, "%-24s old is not its approved baseline: %s: %s\n", b->c.name,
                   verdict_channel_name((Channel)b->approved.first), b->approved.channel[b->approved.first].line);
}

static bool same_logs(const Bisect *b)
{
    char   path[bisect_path_size], *was = NULL, *is = NULL;
    size_t octets[2] = {0};
    snprintf(path, sizeof path, "%s/log.pcapng", b->old->work);
    bool same = access(path, F_OK) != 0; /* a recording of its own */
    if (!same && text_read_file(&was, &octets[0], "regress", path, (size_t)1 << 30) == STATUS_OK) {
        snprintf(path, sizeof path, "%s/log.pcapng", b->new->work);
        same = text_read_file(&is, &octets[1], "regress", path, (size_t)1 << 30) == STATUS_OK &&
               octets[0] == octets[1] && memcmp(was, is, octets[0]) == 0;
    }
    free(was);
    free(is);
    return same;
}

static void say_differences(const Bisect *b)
{
    int files = 0;
    for (int i = 0; i < b->d.tables.count; i++) files += b->d.tables.file[i].differs;
    text_print(stdout, "%-24s of %s: old %s, new %s: %d difference%s", b->c.name, side_kind_name(b->d.old.kind),
               b->d.old.given, b->d.new.given, b->d.count, b->d.count == 1 ? "" : "s");
    if (files) printf(", in %d table%s", files, files == 1 ? "" : "s");
    putchar('\n');
}

/* What NEW's run moves is known after it. False: the bisection ends, with *code. */
static bool run_both(int *code, Bisect *b)
{
    char         said[bisect_path_size];
    Differences *d = &b->d;
    const bool   program = d->old.kind == SIDE_PROGRAM;
    *code = code_not_known;
    if (!program && differences_find(d, &b->c, false) != STATUS_OK) {
        *code = code_usage;
        return false;
    }
    if (!program) say_differences(b);
    if (!program && d->count == 0) {
        *code = code_still;
        return false;
    }
    if (!run_side(b->old, b, "old", false)) return false;
    snprintf(b->record, sizeof b->record, "%.4000s/record", b->old->work);
    if (case_write_record(b->old, b->record) != STATUS_OK) return false;
    compare_approved(b);
    if (!run_side(b->new, b, "new", true)) return false;
    b->moved = (Channel)(b->new->verdict.first < 0 ? 0 : b->new->verdict.first);
    for (int new = 0; new < 2; new ++) {
        const CaseResult *r = new ? b->new : b->old;
        Side             *side = new ? &d->new : &d->old;
        snprintf(said, sizeof said, "%s/replay.stderr", r->work);
        if (program && side_find_tables(side, said, new ? "--new-tables" : "--old-tables") != STATUS_OK) return false;
        if (new &&program && differences_find(d, &b->c, !same_logs(b)) != STATUS_OK) return false;
    }
    for (int new = 0; new < 2 && d->old.kind != SIDE_SETTINGS; new ++) {
        snprintf(said, sizeof said, "%s/replay.stderr", new ? b->new->work : b->old->work);
        table_files_note_read(&d->tables, new ? d->new.tables : d->old.tables, said);
    }
    if (program) say_differences(b);
    if (b->new->verdict.first >= 0 && d->count > 0) return true;
    *code = b->new->verdict.first < 0 ? code_still : code_not_known;
    if (b->new->verdict.first < 0) text_print(stdout, "%-24s no channel moves beyond its tolerance\n", b->c.name);
    else
        log_error(
            "regress: bisect: %s and %s have one program and the same tables, and yet %s moves: libraries beside them differ, or a run is not repeatable",
            d->old.given, d->new.given, verdict_channel_name(b->moved));
    return false;
}

/* ---- the command ------------------------------------------------------------------------------------ */

static int end_code(const Bisect *b)
{
    bool whole = b->cause_count > 0;
    for (int i = 0; i < b->cause_count; i++) whole = whole && b->cause[i].smallest;
    if (!whole && b->runs == b->runs_most)
        log_warn("regress: bisect: ended after %d runs; more are allowed by --runs", b->runs);
    return whole ? code_moved : code_not_known;
}

static int bisect(Bisect *b, const Options *o)
{
    int        code;
    const bool both = run_both(&code, b);
    if (stop_asked()) return stop_exit_code();
    if (both) {
        if (bisect_search(b) != STATUS_OK) {
            log_error("regress: bisect: out of memory");
            return code_not_known;
        }
        bisect_print(b);
        code = stop_asked() ? stop_exit_code() : end_code(b);
        text_print(stdout, "%d cause%s in %d difference%s: %d run%s, %.1f s\n", b->cause_count,
                   b->cause_count == 1 ? "" : "s", b->d.count, b->d.count == 1 ? "" : "s", b->runs,
                   b->runs == 1 ? "" : "s", wall_clock_s() - b->begun_s);
    }
    const bool told = both || (code == code_still && *b->record);
    if (o->out && told && !stop_asked() && bisect_write(b, o->out) != STATUS_OK) code = code_not_known;
    return code;
}

static void close_bisect(Bisect *b, const char *own)
{
    char path[bisect_path_size];
    if (*own) run_case_remove(own);
    else if (*b->work && snprintf(path, sizeof path, "%s/trial", b->work) < (int)sizeof path) run_case_remove(path);
    for (int i = 0; i < b->trials; i++) free(b->trial[i].in);
    for (int i = 0; i < b->cause_count; i++) free(b->cause[i].in);
    free(b->trial);
    differences_free(&b->d);
    free(b->old);
    free(b->new);
    free(b->tried);
    free(b);
}

int bisect_command(int argc, char **argv)
{
    Options   o = {.runs = 200, .threads = thread_processors()};
    char      own[temp_path_size] = "";
    int       code = code_usage;
    const int stop = parse(&o, argc, argv);
    if (stop) return stop - 1;
    thread_flush_denormals();
    stop_by_signals();
    Bisect *b = calloc(1, sizeof *b);
    if (!b) return code_not_known;
    b->threads = o.threads;
    b->isa = o.isa;
    b->runs_most = o.runs;
    b->begun_s = wall_clock_s();
    b->old = calloc(1, sizeof *b->old);
    b->new = calloc(1, sizeof *b->new);
    b->tried = calloc(1, sizeof *b->tried);
    const bool room = b->old && b->new && b->tried;
    if (room && open_sides(b, &o) == STATUS_OK && case_read(&b->c, o.folder) == STATUS_OK) {
        code = code_not_known;
        if (image_file_prepare() == STATUS_OK && image_read_prepare() == STATUS_OK && open_work(b, &o, own))
            code = bisect(b, &o);
    }
    close_bisect(b, own);
    return code;
}
