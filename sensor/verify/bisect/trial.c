/* sensor/verify/bisect/trial.c: a run of the case with some of the differences, compared with OLD's. */
#include "sensor/verify/bisect/bisect_private.h"
#include "pitviper_output.h"

#include "sensor/node/run/stop.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

/* ---- tables ----------------------------------------------------------------------------------------- */

/* A link to the file of OLD or NEW. */
static bool link_file(const Bisect *b, const char *path, const TableFile *f, bool new)
{
    char from[bisect_path_size];
    snprintf(from, sizeof from, "%s/%s", new ? b->d.new.tables : b->d.old.tables, f->name);
    return (new ? f->in_new : f->in_old) ? symlink(from, path) == 0 : true;
}

/* The table with some of NEW's rows. */
static bool write_rows(const char *path, const TableFile *f, const bool *is_new)
{
    FILE *file = output_begin(path, 0);
    if (!file) return false;
    row_changes_write(file, &f->rows, is_new);
    return output_end(file, path);
}

/* first: the index of the file's first difference; in: NULL is OLD. */
static bool put_file(const Bisect *b, const char *path, const TableFile *f, int first, const bool *in)
{
    int some = 0;
    if (!f->differs || !in) return link_file(b, path, f, false);
    const int count = f->by_rows ? f->rows.count : 1;
    for (int i = 0; i < count; i++) some += in[first + i];
    if (some == 0 || some == count) return link_file(b, path, f, some > 0);
    return write_rows(path, f, in + first);
}

/* The folder of tables with these differences: links to OLD's and NEW's files, and files of mixed rows. */
static bool make_tables(const Bisect *b, const char *folder, const bool *in)
{
    char path[bisect_path_size], above[bisect_path_size] = "";
    int  first = 0;
    run_case_remove(folder);
    while (first < b->d.count && b->d.difference[first].group[level_parts] != 1) first++;
    bool ok = output_folder(folder) == 0;
    for (int i = 0; i < b->d.tables.count && ok; i++) {
        const TableFile *f = &b->d.tables.file[i];
        snprintf(path, sizeof path, "%s/%s", folder, f->name);
        char *slash = strrchr(path, '/');
        *slash = 0;
        if (strcmp(path, above) != 0) ok = output_folder(path) == 0;
        snprintf(above, sizeof above, "%s", path);
        *slash = '/';
        ok = ok && put_file(b, path, f, first, in);
        if (f->differs) first += f->by_rows ? f->rows.count : 1;
    }
    if (!ok) log_error("regress: bisect: cannot make the tables in %s: %s", folder, output_reason(errno));
    return ok;
}

/* ---- settings ----------------------------------------------------------------------------------- */

static bool make_settings(const Bisect *b, const char *path, const bool *in)
{
    Config mixed = b->d.from;
    for (int i = 0; i < b->d.count; i++)
        if (in[i]) config_take(&mixed, &b->d.to, b->d.difference[i].key);
    FILE *file = output_begin(path, 0);
    if (file) config_write_settings(file, &mixed);
    const bool ok = file && output_end(file, path);
    if (!ok) log_error("regress: bisect: cannot write %s: %s", path, output_reason(errno));
    return ok;
}

/* ---- a run ---------------------------------------------------------------------------------------- */

/* Whether a difference of this kind is in. */
static bool has(const Bisect *b, const bool *in, DifferenceKind kind)
{
    for (int i = 0; i < b->d.count; i++)
        if (b->d.difference[i].kind == kind) return in[i];
    return false;
}

static bool lists(const Bisect *b, DifferenceKind kind)
{
    for (int i = 0; i < b->d.count; i++)
        if (b->d.difference[i].kind == kind) return true;
    return false;
}

void trial_run(CaseResult *r, Bisect *b, const char *work, const bool *in, bool new, bool compare)
{
    char        tables[case_path_size + 16], settings[case_path_size + 32];
    const Side *side = new ? &b->d.new : &b->d.old;
    CaseHow     how = {.threads = b->threads, .isa = b->isa, .record = compare ? b->record : "", .verbose = !in};
    bool       *none = NULL;
    *r = (CaseResult){.c = b->c};
    snprintf(r->work, sizeof r->work, "%.3900s/%s", b->work, work);
    snprintf(tables, sizeof tables, "%s/tables", r->work);
    snprintf(settings, sizeof settings, "%s/settings.yaml", r->work);
    bool ok = output_folder(r->work) == 0;
    if (ok && side->kind == SIDE_SETTINGS) {
        none = calloc((size_t)b->d.count + 1, sizeof *none);
        for (int i = 0; none && new &&i < b->d.count; i++) none[i] = true;
        how.settings = settings;
        ok = none && make_settings(b, settings, in ? in : none);
        free(none);
    } else if (ok && in) {
        how.tables = tables;
        ok = make_tables(b, tables, in);
    } else {
        how.tables = side->tables; /* "" of a program whose tables are not known yet: its own */
    }
    if (side->kind == SIDE_PROGRAM) {
        const bool program = in ? has(b, in, OF_PROGRAM) : new;
        const bool generator = in && lists(b, OF_GENERATOR) ? has(b, in, OF_GENERATOR) : program;
        how.program = program ? b->d.new.program : b->d.old.program;
        how.generator = generator ? b->d.new.program : b->d.old.program;
    }
    if (!ok) {
        r->state = CASE_BROKEN;
        snprintf(r->line, sizeof r->line, "its tables or settings could not be written");
        return;
    }
    log_set_sink(run_case_log, NULL);
    run_case(r, &how);
    log_set_sink(NULL, NULL);
}

/* ---- answers ------------------------------------------------------------------------------------ */

static void show_progress(const Bisect *b, int size)
{
    char text[120];
    snprintf(text, sizeof text, "run %d: %d of %d differences, %.0f s", b->runs, size, b->d.count,
             wall_clock_s() - b->begun_s);
    log_status(text);
}

static DeltaAnswer answer_of(const Bisect *b, CaseResult *r)
{
    if (r->state != CASE_OK && r->state != CASE_FAILED) return stop_asked() ? DELTA_STOP : DELTA_UNKNOWN;
    if (r->verdict.channel[b->moved].failed) return DELTA_MOVES;
    if (!r->verdict.channel[CHANNEL_SIZE].failed) return DELTA_STILL;
    snprintf(r->line, sizeof r->line, "frames have another size, so that nothing else can be compared");
    return DELTA_UNKNOWN;
}

static int find_trial(const Bisect *b, const bool *in)
{
    for (int i = 0; i < b->trials; i++)
        if (memcmp(b->trial[i].in, in, (size_t)b->d.count * sizeof *in) == 0) return i;
    return -1;
}

static int add_trial(Bisect *b, const bool *in, int size)
{
    if (b->trials == b->trials_room) {
        const int room = 2 * b->trials_room + 16;
        Trial    *more = realloc(b->trial, (size_t)room * sizeof *more);
        if (!more) return -1;
        b->trial = more;
        b->trials_room = room;
    }
    bool *copy = malloc((size_t)b->d.count + 1);
    if (!copy) return -1;
    memcpy(copy, in, (size_t)b->d.count * sizeof *in);
    b->trial[b->trials] = (Trial){.in = copy, .size = size, .first = -1};
    return b->trials++;
}

DeltaAnswer trial_answer(int *trial, Bisect *b, const bool *in)
{
    CaseResult *r = b->tried;
    int         size = 0;
    *trial = find_trial(b, in);
    if (*trial >= 0) return b->trial[*trial].answer;
    for (int i = 0; i < b->d.count; i++) size += in[i];
    const bool all = size == b->d.count, none = size == 0; /* known without a run */
    if (!all && !none && (b->runs == b->runs_most || stop_asked())) return DELTA_STOP;
    *trial = add_trial(b, in, size);
    if (*trial < 0) return DELTA_STOP;
    Trial *t = &b->trial[*trial];
    if (none) return t->answer = DELTA_STILL;
    if (all) r = b->new;
    else {
        b->runs++;
        show_progress(b, size);
        trial_run(r, b, "trial", in, false, true);
        log_status(NULL);
    }
    t->answer = answer_of(b, r);
    if (r->compared) t->first = r->verdict.first;
    snprintf(t->line, sizeof t->line, "%s", r->line);
    log_detail("regress: bisect: run %d: %d of %d differences: %s", b->runs, size, b->d.count,
               *t->line ? t->line : "nothing moves");
    return t->answer;
}
