/* sensor/verify/regress/case_scores.c: the recogniser of a case, run on the frames it has rendered, and its answers
 * scored. */
#include "sensor/verify/regress/run_case.h"

#include "sensor/frame/field.h"
#include "sensor/frame/frame.h"
#include "sensor/score/score.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

enum { path_size = case_path_size + 64, tail_size = 3000 };

/* ---- the recogniser ------------------------------------------------------------------------------ */

/* The last line that is not empty. */
static void last_line(char *out, size_t out_size, const char *text)
{
    const char *end = text + strlen(text);
    while (end > text && strchr(" \t\n", end[-1])) end--;
    const char *line = end;
    while (line > text && line[-1] != '\n') line--;
    if (end > line) snprintf(out, out_size, "%.*s", (int)(end - line), line);
    else snprintf(out, out_size, "it said nothing");
}

/* What it said last: on its error output, else on the other. */
static void take_tail(char *out, CaseResult *r, const char *out_path, const char *error_path)
{
    case_child_tail(out, tail_size, error_path);
    if (strspn(out, " \t\n") == strlen(out)) case_child_tail(out, tail_size, out_path);
    run_case_say(r, out);
}

/* COMMAND OUT, by the shell in the case's folder. False: the result of the case is set. */
static bool run_command(CaseResult *r, const char *out, const char *folder)
{
    char script[sizeof r->c.scores.command + 16], out_path[path_size], error_path[path_size], tail[tail_size],
        last[400];
    ChildEnd end;
    snprintf(script, sizeof script, "%s \"$1\"", r->c.scores.command);
    snprintf(out_path, sizeof out_path, "%.4080s/recogniser.stdout", r->work);
    snprintf(error_path, sizeof error_path, "%.4080s/recogniser.stderr", r->work);
    const ChildLine line = {.program = "/bin/sh",
                            .folder = folder,
                            .apart = true,
                            .count = 5,
                            .argument = {"sh", "-c", script, "recogniser", out, NULL}};
    const size_t    n = strlen(r->command);
    case_child_text(r->command + n, sizeof r->command - n - 2, &line);
    strcat(r->command, "\n");
    if (case_child_run(&end, &line, out_path, error_path, r->c.scores.timeout_s) != STATUS_OK)
        return run_case_end(r, CASE_BROKEN, "the recogniser cannot be started: no processes, or no memory");
    take_tail(tail, r, out_path, error_path);
    last_line(last, sizeof last, tail);
    if (end.stopped) return run_case_end(r, CASE_BROKEN, "stopped");
    if (end.timed_out)
        return run_case_end(r, CASE_BROKEN, "the recogniser was ended after %g s (scores.timeout_s): %s",
                            r->c.scores.timeout_s, last);
    if (end.signal) return run_case_end(r, CASE_BROKEN, "the recogniser crashed: %s: %s", strsignal(end.signal), last);
    if (end.code) return run_case_end(r, CASE_BROKEN, "the recogniser failed with exit code %d: %s", end.code, last);
    return true;
}

/* ---- scores.json -------------------------------------------------------------------------------- */

#define OF_RATES(member) FIELD_MEMBER(ScoreRates, member)
#define RATE_ROWS                                                                                                      \
    {"chances", "", "", "", "targets to be found: one a target, frame and band", OF_RATES(chances)},                   \
        {"found", "", "", "", "those that an answer names", OF_RATES(found)},                                          \
        {"recognised", "", "", "", "those that an answer of their class names", OF_RATES(recognised)},                 \
        {"frames", "", "", "", "frames times bands", OF_RATES(frames)},                                                \
        {"false_alarms", "", "", "", "answers that name nothing", OF_RATES(false_alarms)},                             \
        {"detection", "", "", "without chances", "found of chances", OF_RATES(detection.value)},                       \
        {"detection_low", "", "", "without chances", "lower bound of 95 %", OF_RATES(detection.low)},                  \
        {"detection_high", "", "", "without chances", "upper bound of 95 %", OF_RATES(detection.high)},                \
        {"false_alarms_per_frame", "", "", "without frames", "", OF_RATES(per_frame.value)},                           \
        {"false_alarms_low", "", "", "without frames", "lower bound of 95 %", OF_RATES(per_frame.low)},                \
        {"false_alarms_high", "", "", "without frames", "upper bound of 95 %", OF_RATES(per_frame.high)},

static const Field rate_rows[] = {RATE_ROWS};

static const void *next_band(FieldAt *at, int i)
{
    const ScoreRecogniser *r = at->of;
    if (i >= BAND_COUNT) return NULL;
    return field_keyed(at, r->bands & 1u << i ? band_name((Band)i) : "", &r->band[i]);
}

static const void *total_of(const void *of) { return &((const ScoreRecogniser *)of)->total; }

#define OF_ALL(member) FIELD_MEMBER(ScoreRecogniser, member)
static const Field band_rows[] = {
    {"BAND", "", "", "not scored", "", .item = next_band, FIELD_OBJECT(rate_rows)},
};
static const Field all_rows[] = {
    {"answers", "", "", "", "in these frames", OF_ALL(answers)},
    {"ap", "", "", "without a target", "mean of AP over classes", OF_ALL(map)},
    {"ap50", "", "", "without a target", "the same at an IoU of 0.5", OF_ALL(map50)},
    {"all", "", "", "", "", .in = total_of, FIELD_OBJECT(rate_rows)},
    {"bands", "", "", "", "", FIELD_OBJECT(band_rows)},
};

static void put_line(FILE *to, const void *user) { fprintf(to, "%s\n", (const char *)user); }

static Status write_scores(const ScoreRecogniser *r, const char *out)
{
    char   path[path_size];
    Status status = STATUS_NO_MEMORY;
    snprintf(path, sizeof path, "%.4080s/scores.json", out);
    char *line = field_line(&FIELD_TABLE(all_rows), r, 15);
    if (line) status = text_write_file("regress", path, put_line, line);
    free(line);
    return status;
}

/* ---- a case ------------------------------------------------------------------------------------- */

static bool score_answers(CaseResult *r, const char *out, const char *answers)
{
    ScoreReport        report;
    const ScoreRequest asked = {.out = out, .recognisers = 1, .answers = {answers}, .rules = score_default_rules()};
    Status             status = score_run(&report, &asked);
    if (status == STATUS_OK) {
        status = write_scores(&report.recogniser[0], out);
        score_report_free(&report);
    }
    if (status == STATUS_OK) return true;
    char        last[400];
    const char *head = log_head(LOG_ERROR);
    last_line(last, sizeof last, r->said);
    return run_case_end(r, CASE_BROKEN, "its answers cannot be scored: %s",
                        strncmp(last, head, strlen(head)) == 0 ? last + strlen(head) : last);
}

bool case_scores(CaseResult *r)
{
    char answers[case_path_size + 64], named[path_size], reason[256];
    if (!case_has_scores(&r->c)) return true;
    snprintf(named, sizeof named, "%.4080s/out", r->work);
    char *out = realpath(named, NULL), *folder = realpath(r->c.folder, NULL);
    bool  ok = out && folder && strlen(out) < case_path_size;
    if (!ok) run_case_end(r, CASE_BROKEN, "scores: cannot find %.300s: %s", named, strerror(errno));
    if (ok && *r->c.scores.command) {
        ok = run_command(r, out, folder);
        snprintf(answers, sizeof answers, "%s/answers.jsonl", out);
        if (ok && access(answers, R_OK) != 0)
            ok = run_case_end(r, CASE_BROKEN,
                              "the recogniser wrote no answers.jsonl into the folder that is its last argument, %.300s",
                              out);
    } else if (ok && !case_path(answers, reason, &r->c, r->c.scores.answers)) {
        ok = run_case_end(r, CASE_BROKEN, "scores.answers: %s", reason);
    } else if (ok && access(answers, R_OK) != 0) {
        ok = run_case_end(r, CASE_BROKEN, "scores.answers: %.300s: %s; record them, or name a command", answers,
                          strerror(errno));
    }
    ok = ok && score_answers(r, out, answers);
    free(out);
    free(folder);
    return ok;
}
