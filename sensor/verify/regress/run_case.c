/* sensor/verify/regress/run_case.c: runs one case: its log, settings and replay, then the comparison or the update. */
#include "sensor/verify/regress/run_case.h"
#include "pitviper_output.h"

#include "sensor/settings/config.h"
#include "sensor/publish/files/frame_files.h"
#include "sensor/node/run/stop.h"

#include <errno.h>
#include <ftw.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum { path_size = case_path_size + 64, tail_size = 3000 };

/* ---- messages ---------------------------------------------------------------------------- */

static _Thread_local CaseResult *case_here;

void run_case_say(CaseResult *r, const char *text)
{
    const size_t n = strlen(r->said);
    snprintf(r->said + n, sizeof r->said - n, "%s", text);
}

void run_case_log(void *user, LogLevel level, const char *line)
{
    (void)user;
    if (!case_here) {
        fprintf(stderr, "%s%s\n", log_head(level), line);
        return;
    }
    run_case_say(case_here, log_head(level));
    run_case_say(case_here, line);
    run_case_say(case_here, "\n");
}

/* Finds the last error in the output of the processes. */
static void last_error(char *out, size_t out_size, const char *said)
{
    const char       *found = NULL;
    const char *const head = log_head(LOG_ERROR);
    for (const char *at = said; (at = strstr(at, head)); at++)
        if (at == said || at[-1] == '\n') found = at + strlen(head);
    if (found) snprintf(out, out_size, "%.*s", (int)strcspn(found, "\n"), found);
    else snprintf(out, out_size, "no error message");
}

bool run_case_end(CaseResult *r, CaseState state, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    r->state = state;
    vsnprintf(r->line, sizeof r->line, format, arguments);
    va_end(arguments);
    return false;
}

/* ---- children -------------------------------------------------------------------------------- */

/* False when the process failed; the result of the case is set then. */
static bool run_child(CaseResult *r, const ChildLine *line, const char *name)
{
    char     out_path[path_size], error_path[path_size], tail[tail_size], reason[512];
    ChildEnd end;
    snprintf(out_path, sizeof out_path, "%.4080s/%s.stdout", r->work, name);
    snprintf(error_path, sizeof error_path, "%.4080s/%s.stderr", r->work, name);
    const size_t n = strlen(r->command);
    case_child_text(r->command + n, sizeof r->command - n - 2, line);
    strcat(r->command, "\n");
    if (case_child_run(&end, line, out_path, error_path, r->c.timeout_s) != STATUS_OK) {
        last_error(reason, sizeof reason, r->said);
        return run_case_end(r, CASE_BROKEN, "%s", reason);
    }
    case_child_tail(tail, sizeof tail, error_path);
    run_case_say(r, tail);
    if (end.stopped) return run_case_end(r, CASE_BROKEN, "stopped");
    if (end.timed_out)
        return run_case_end(r, CASE_BROKEN,
                            "`pitviper %s` was ended after %g s (timeout_s); it hangs, or the case needs more time",
                            name, r->c.timeout_s);
    if (end.signal) return run_case_end(r, CASE_BROKEN, "`pitviper %s` crashed: %s", name, strsignal(end.signal));
    if (end.code) {
        last_error(reason, sizeof reason, tail);
        return run_case_end(r, CASE_BROKEN, "`pitviper %s` failed: %s", name, reason);
    }
    return true;
}

/* The log of a scenario; false when the case has ended. */
static bool make_log(char log[path_size], CaseResult *r, const CaseHow *how)
{
    char        scenario[case_path_size], reason[256], set[sizeof r->c.scenario_set];
    ChildLine   line = {.program = how->generator, .tables = how->tables};
    struct stat there;
    if (!case_path(scenario, reason, &r->c, r->c.scenario)) return run_case_end(r, CASE_BROKEN, "scenario: %s", reason);
    const bool is_file = stat(scenario, &there) == 0 && S_ISREG(there.st_mode);
    if (!is_file && strpbrk(r->c.scenario, "/."))
        return run_case_end(r, CASE_BROKEN, "scenario: there is no file %.400s", scenario);
    snprintf(log, path_size, "%.4080s/log.pcapng", r->work);
    bool fits = case_child_add(&line, "pitviper") && case_child_add(&line, "exercise") &&
                case_child_add(&line, is_file ? scenario : r->c.scenario) && case_child_add(&line, "--overwrite") &&
                case_child_add(&line, "-o") && case_child_add(&line, log);
    memcpy(set, r->c.scenario_set, sizeof set);
    char *rest = set;
    for (char *one; (one = strtok_r(rest, " \t\r\n", &rest));)
        fits = fits && case_child_add(&line, "--set") && case_child_add(&line, one);
    if (!fits) return run_case_end(r, CASE_BROKEN, "scenario_set: too many settings");
    return run_child(r, &line, "exercise");
}

static bool find_log(char log[path_size], CaseResult *r, const CaseHow *how)
{
    static const char next[] = "; provide it, or allow its absence (log_may_be_absent: true in case.yaml, or "
                               "--allow-missing)";
    char              path[case_path_size], reason[256];
    const bool        allowed = r->c.log_may_be_absent || how->allow_missing;
    const CaseState   state = allowed ? CASE_SKIPPED : CASE_BROKEN;
    if (!case_path(path, reason, &r->c, r->c.log))
        return run_case_end(r, state, "log missing: %s%s", reason, allowed ? "" : next);
    if (access(path, R_OK) != 0)
        return run_case_end(r, state, "log missing: %.400s: %s%s", path, strerror(errno), allowed ? "" : next);
    snprintf(log, path_size, "%s", path);
    return true;
}

/* Paths in the settings of a case are relative to its folder, but config.yaml is in the work folder: they are made
 * absolute. A file that cannot be parsed is left as it is: the run reports what is wrong with it. */
static bool make_paths_absolute(const char *config, const CaseResult *r)
{
    char    in_case[path_size];
    Config *read = malloc(sizeof *read);
    bool    ok = read != NULL;
    snprintf(in_case, sizeof in_case, "%.4000s/case.yaml", r->c.folder);
    log_suppress(true);
    if (ok) *read = config_default();
    if (ok && config_read_as(read, config, in_case) == STATUS_OK) {
        FILE *file = output_file(config, 0);
        if (file) config_write_settings(file, read);
        ok = file && fclose(file) == 0;
    }
    log_suppress(false);
    free(read);
    return ok;
}

/* config.yaml of the work folder, from `config` of the case; the file that `config_file` names; or another's. */
static bool find_config(char config[path_size], CaseResult *r, const CaseHow *how)
{
    char path[case_path_size], reason[256];
    *config = 0;
    if (how->settings) {
        snprintf(config, path_size, "%s", how->settings);
    } else if (*r->c.config_file) {
        if (!case_path(path, reason, &r->c, r->c.config_file))
            return run_case_end(r, CASE_BROKEN, "config_file: %s", reason);
        snprintf(config, path_size, "%s", path);
    } else if (*r->c.config) {
        snprintf(config, path_size, "%.4080s/config.yaml", r->work);
        FILE *file = output_file(config, 0);
        bool  ok = file && fputs(r->c.config, file) >= 0;
        if (file && fclose(file) != 0) ok = false;
        ok = ok && make_paths_absolute(config, r);
        if (!ok)
            return run_case_end(r, CASE_BROKEN, "cannot write %.300s: %s; choose another place with --work", config,
                                output_reason(errno));
    }
    return true;
}

static bool replay_case(CaseResult *r, const CaseHow *how, const char *log, const char *config)
{
    char      out[path_size], only[8 * case_frames_max], threads[16];
    size_t    n = 0;
    ChildLine line = {.program = how->program, .tables = how->tables};
    for (int i = 0; i < r->c.frames.count; i++)
        n += (size_t)snprintf(only + n, sizeof only - n, "%s%.0f", i ? "," : "", r->c.frames.number[i]);
    snprintf(out, sizeof out, "%.4080s/out", r->work);
    snprintf(threads, sizeof threads, "%d", how->threads);
    const char *const fixed[] = {"pitviper", "replay",
                                 log,        "--out",
                                 out,        "--only",
                                 only,       "--threads",
                                 threads,    "--overwrite",
                                 "--set",    "publish.files=true",
                                 "--set",    "publish.planes=all"};
    for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++) case_child_add(&line, fixed[i]);
    if (*config) {
        case_child_add(&line, "--config");
        case_child_add(&line, config);
    }
    if (!*r->c.scores.command) case_child_add(&line, "--no-png"); /* a recogniser may want to see displays */
    if (r->c.causal) case_child_add(&line, "--causal");
    if (how->verbose) case_child_add(&line, "--verbose");
    if (how->isa) {
        case_child_add(&line, "--isa");
        case_child_add(&line, how->isa);
    }
    frame_files_clear(out); /* products of an earlier run in the same --work must not be compared */
    return run_child(r, &line, "replay");
}

/* ---- the case -------------------------------------------------------------------------------- */

static bool has_record(CaseResult *r)
{
    char path[path_size];
    snprintf(path, sizeof path, "%.4090s/run.json", r->record);
    if (access(path, F_OK) != 0)
        return run_case_end(
            r, CASE_NO_RECORD,
            "no baseline yet: inspect the output, then approve it with `pitviper regress --update %.300s "
            "--why "
            "TEXT`",
            r->c.folder);
    for (int i = 0; i < r->c.frames.count; i++) {
        snprintf(path, sizeof path, "%.4090s/%06.0f.exr", r->record, r->c.frames.number[i]);
        if (access(path, F_OK) != 0)
            return run_case_end(r, CASE_BROKEN,
                                "the baseline has no frame %.0f: `pitviper regress --update %.300s --why TEXT` writes "
                                "it again",
                                r->c.frames.number[i], r->c.folder);
    }
    return true;
}

static void compare_case(CaseResult *r)
{
    char out[path_size], reason[512];
    snprintf(out, sizeof out, "%.4080s/out", r->work);
    r->compared = verdict_of(&r->verdict, &r->c, r->record, out) == STATUS_OK;
    if (!r->compared) {
        last_error(reason, sizeof reason, r->said);
        run_case_end(r, CASE_BROKEN, "%s", reason);
        return;
    }
    const int first = r->verdict.first;
    r->state = first < 0 ? CASE_OK : CASE_FAILED;
    if (first < 0) {
        if (strstr(r->verdict.remarks, "bits differ"))
            snprintf(r->line, sizeof r->line, "%s", strstr(r->verdict.remarks, "bits differ"));
        r->line[strcspn(r->line, "\n")] = 0;
        if (!case_has_scores(&r->c)) return;
        const size_t n = strlen(r->line);
        snprintf(r->line + n, sizeof r->line - n, "%s%s", n ? "; " : "", r->verdict.channel[CHANNEL_SCORES].line);
        return;
    }
    int others = 0;
    for (int k = first + 1; k < CHANNEL_COUNT; k++) others += r->verdict.channel[k].failed;
    snprintf(r->line, sizeof r->line, "%s: %s", verdict_channel_name((Channel)first), r->verdict.channel[first].line);
    size_t n = strlen(r->line);
    if (others)
        n += (size_t)snprintf(r->line + n, sizeof r->line - n, " (and %d channel%s after it)", others,
                              others > 1 ? "s" : "");
    if (r->verdict.other_log) snprintf(r->line + n, sizeof r->line - n, "; and the log is not that of the baseline");
}

static void run_steps(CaseResult *r, const CaseHow *how)
{
    char log[path_size], config[path_size];
    if (*r->c.log && !find_log(log, r, how)) return;
    if (how->record) snprintf(r->record, sizeof r->record, "%s", how->record);
    else snprintf(r->record, sizeof r->record, "%.4080s/record", r->c.folder);
    if (!how->update && *r->record && !has_record(r)) return;
    if (frame_files_folder(r->work) != STATUS_OK) {
        run_case_end(r, CASE_BROKEN, "cannot make the folder %.300s; choose another place with --work", r->work);
        return;
    }
    if (!*r->c.log && !make_log(log, r, how)) return;
    if (!find_config(config, r, how) || !replay_case(r, how, log, config) || !case_scores(r)) return;
    if (how->update) case_update(r, how->why);
    else if (*r->record) compare_case(r);
    else r->state = CASE_OK;
}

void run_case(CaseResult *r, const CaseHow *how)
{
    const double begun_s = wall_clock_s();
    if (stop_asked()) {
        run_case_end(r, CASE_BROKEN, "stopped");
        return;
    }
    case_here = r;
    run_steps(r, how);
    case_here = NULL;
    r->seconds = wall_clock_s() - begun_s;
}

/* ---- folders of its own -------------------------------------------------------------------------- */

static int remove_one(const char *path, const struct stat *about, int kind, struct FTW *where)
{
    (void)about;
    (void)kind;
    (void)where;
    return remove(path);
}

void run_case_remove(const char *folder) { nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS | FTW_MOUNT); }
