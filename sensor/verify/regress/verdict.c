/* sensor/verify/regress/verdict.c: compares a run with its baseline: sizes, inputs, counters, truth, planes. */
#include "sensor/verify/regress/verdict.h"

#include <stdarg.h>
#include <stdlib.h>
#include <unistd.h>

enum { file_most = 64 << 20 };

__attribute__((format(printf, 2, 3))) static void remark(Verdict *v, const char *format, ...)
{
    const size_t n = strlen(v->remarks);
    va_list      arguments;
    va_start(arguments, format);
    if (n + 2 < sizeof v->remarks) {
        vsnprintf(v->remarks + n, sizeof v->remarks - n - 1, format, arguments);
        strcat(v->remarks, "\n");
    }
    va_end(arguments);
}

static Status read_json(JsonValues *out, const Case *c, const char *folder, const char *name)
{
    char   path[case_path_size + 32], *text = NULL;
    size_t octets;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    Status status = text_read_file(&text, &octets, "regress", path, file_most);
    if (status == STATUS_OK) status = case_relative(&text, c);
    if (status == STATUS_OK) status = json_values_read(out, text, strlen(text), "regress", path);
    free(text);
    return status;
}

static const char *text_of(const JsonValues *values, const char *path)
{
    const JsonValue *value = json_values_find(values, path);
    return value && value->text ? value->text : "";
}

static bool begins(const char *text, const char *head) { return strncmp(text, head, strlen(head)) == 0; }

/* Remarks on each value below `head` that differs: tables are compared by their hash, settings by their text. */
static int remark_group(Verdict *v, const JsonValues *was, const JsonValues *is, const char *head, bool hashes)
{
    const char *const what = hashes ? "table" : "setting";
    const size_t      skip = strlen(head);
    int               count = 0;
    for (int i = 0; i < is->count; i++) {
        const JsonValue *now = &is->value[i], *then = json_values_find(was, now->path);
        if (!begins(now->path, head) || !now->text) continue;
        if (then && then->text && strcmp(then->text, now->text) == 0) continue;
        count++;
        if (!then) remark(v, "%s %s is new", what, now->path + skip);
        else if (hashes)
            remark(v, "%s %s: SHA-256 %.8s..., was %.8s...", what, now->path + skip, now->text,
                   then->text ? then->text : "?");
        else
            remark(v,
                   "%s %s is '%.200s', was "
                   "'%.200s'",
                   what, now->path + skip, now->text, then->text ? then->text : "?");
    }
    for (int i = 0; i < was->count; i++)
        if (begins(was->value[i].path, head) && !json_values_find(is, was->value[i].path)) {
            remark(v, "%s %s was removed", what, was->value[i].path + skip);
            count++;
        }
    return count;
}

static bool has_group(const JsonValues *values, const char *head)
{
    for (int i = 0; i < values->count; i++)
        if (begins(values->value[i].path, head)) return true;
    return false;
}

/* Inputs: tables, settings, log. */
static void remark_inputs(Verdict *v, const JsonValues *was, const JsonValues *is)
{
    if (has_group(was, "tables_sha256.")) remark_group(v, was, is, "tables_sha256.", true);
    if (has_group(was, "settings.")) remark_group(v, was, is, "settings.", false);
    /* where it lists them, their hash says no more: it is of absolute paths */
    if (!has_group(was, "settings.") && strcmp(text_of(was, "config_sha256"), text_of(is, "config_sha256")) != 0)
        remark(v, "settings are not those of the baseline (config_sha256), which does not list them");
    v->other_log = strcmp(text_of(was, "log_sha256"), text_of(is, "log_sha256")) != 0;
    if (v->other_log) remark(v, "the log is not that of the baseline (log_sha256)");
}

/* Remarks on differences of version, ISA, libraries and automatic choices. */
static void remark_runs(Verdict *v, const JsonValues *was, const JsonValues *is)
{
    remark_inputs(v, was, is);
    static const char *const build[] = {"pitviper", "isa"};
    v->same_build = true;
    for (int i = 0; i < 2; i++)
        if (strcmp(text_of(was, build[i]), text_of(is, build[i])) != 0) {
            v->same_build = false;
            remark(v, "%s is %s, was %s in the baseline", build[i], text_of(is, build[i]), text_of(was, build[i]));
        }
    for (int i = 0; i < is->count; i++) {
        const char *path = is->value[i].path;
        if (strncmp(path, "libraries.", 10) != 0 || !is->value[i].text) continue;
        if (strcmp(text_of(was, path), is->value[i].text) == 0) continue;
        v->same_build = false;
        remark(v, "%s is %s, was %s in the baseline", path + 10, is->value[i].text, text_of(was, path));
    }
    for (int i = 0; i < is->count; i++) {
        const char *path = is->value[i].path;
        if (strncmp(path, "choices[", 8) == 0 && is->value[i].text &&
            strcmp(text_of(was, path), is->value[i].text) != 0)
            remark(v, "chosen: %s; was: %s", is->value[i].text, text_of(was, path));
    }
}

static void remark_hashes(Verdict *v, const JsonValues *was, const JsonValues *is)
{
    int differ = 0, count = 0;
    for (int i = 0; i < is->count; i++) {
        if (strncmp(is->value[i].path, "frame_sha256[", 13) != 0 || !is->value[i].text) continue;
        count++;
        differ += strcmp(text_of(was, is->value[i].path), is->value[i].text) != 0;
    }
    if (differ == 0 || !v->same_build) return;
    remark(v, v->first < 0 ? "bits differ in %d of %d frames, within tolerance" : "bits differ in %d of %d frames",
           differ, count);
}

/* Line of this frame, flattened. STATUS_IO when there is none. */
static Status truth_of(JsonValues *out, const char *folder, int frame)
{
    char   path[case_path_size + 32], source[case_path_size + 64], *text;
    size_t octets;
    snprintf(path, sizeof path, "%s/truth.jsonl", folder);
    Status status = text_read_file(&text, &octets, "regress", path, file_most);
    if (status != STATUS_OK) return status;
    status = STATUS_IO;
    int line = 1;
    for (char *at = text; *at && status == STATUS_IO; line++) {
        const size_t length = strcspn(at, "\n");
        JsonValues   values;
        snprintf(source, sizeof source, "%s:%d", path, line);
        if (length > 0) {
            const Status read = json_values_read(&values, at, length, "regress", source);
            if (read != STATUS_OK) status = read;
            else {
                const JsonValue *number = json_values_find(&values, "frame");
                if (number && number->number == frame) {
                    *out = values;
                    status = STATUS_OK;
                } else {
                    json_values_free(&values);
                }
            }
        }
        at += length + (at[length] == '\n');
    }
    if (status == STATUS_IO) log_error("regress: %s: has no line of frame %d", path, frame);
    free(text);
    return status;
}

/* False: images or profiles differ in size, which is reported in the result; or the baseline cannot be read
 * (*status). */
static bool same_size(Status *status, Verdict *v, const char *record, const RecordFrame *got)
{
    ChannelResult  *r = &v->channel[CHANNEL_SIZE];
    RecordFrameSize size;
    *status = record_frame_size(&size, record, got->number);
    r->there = true;
    if (*status != STATUS_OK) return false;
    const bool picture = size.width == got->width && size.height == got->height;
    const bool profile = size.bins == got->bins || size.bins == 0 || got->bins == 0;
    if (picture && profile) return true;
    r->frame = got->number;
    if (!r->failed && !picture)
        snprintf(r->line, sizeof r->line,
                 "expected %d x %d pixels, actual %d x %d, from frame %d on (sensor.width_px, sensor.height_px); "
                 "nothing "
                 "else is compared in such a frame",
                 size.width, size.height, got->width, got->height, got->number);
    else if (!r->failed)
        snprintf(r->line, sizeof r->line,
                 "expected %d range bins, actual %d, from frame %d on (radar.bins); nothing else is compared in such "
                 "a frame",
                 size.bins, got->bins, got->number);
    r->failed = true;
    return false;
}

static Status compare_frame(Verdict *v, const Case *c, const char *record, const char *run, int number)
{
    RecordFrame expected = {0}, got = {0};
    JsonValues  was = {0}, is = {0};
    Status      status = record_frame_from_run(&got, run, number);
    if (status == STATUS_OK && !same_size(&status, v, record, &got)) {
        record_frame_free(&got);
        return status;
    }
    if (status == STATUS_OK) status = record_frame_from_record(&expected, record, &got);
    if (status == STATUS_OK) status = record_frame_rename_materials(&got, &expected);
    if (status == STATUS_OK) status = truth_of(&was, record, number);
    if (status == STATUS_OK) status = truth_of(&is, run, number);
    if (status == STATUS_OK) {
        verdict_truth(v->channel, number, &was, &is, c->tolerance.truth);
        verdict_frame(v->channel, &expected, &got, &c->tolerance, !v->same_build);
    }
    json_values_free(&was);
    json_values_free(&is);
    record_frame_free(&expected);
    record_frame_free(&got);
    return status;
}

static Status compare_scores(Verdict *v, const Case *c, const char *record, const char *run)
{
    char           path[case_path_size + 32];
    JsonValues     was = {0}, is = {0};
    ChannelResult *r = &v->channel[CHANNEL_SCORES];
    *r = (ChannelResult){.there = true, .frame = -1};
    Status status = read_json(&is, c, run, "scores.json");
    snprintf(path, sizeof path, "%s/scores.json", record);
    if (status == STATUS_OK && access(path, F_OK) != 0) {
        r->failed = true;
        r->diffs = 1;
        snprintf(r->line, sizeof r->line,
                 "the baseline has none: `pitviper regress --update` approves those of this run");
    } else if (status == STATUS_OK) {
        status = read_json(&was, c, record, "scores.json");
        if (status == STATUS_OK) verdict_scores(r, &was, &is, &c->tolerance);
    }
    json_values_free(&was);
    json_values_free(&is);
    return status;
}

Status verdict_of(Verdict *out, const Case *c, const char *record, const char *run)
{
    JsonValues was = {0}, is = {0};
    *out = (Verdict){.first = -1};
    Status status = read_json(&was, c, record, "run.json");
    if (status == STATUS_OK) status = read_json(&is, c, run, "run.json");
    if (status == STATUS_OK) {
        remark_runs(out, &was, &is);
        verdict_counters(out->channel, &was, &is);
        if (strcmp(text_of(&was, "hosts[0]"), text_of(&is, "hosts[0]")) != 0) {
            out->channel[CHANNEL_POSE] = (ChannelResult){.there = true, .failed = true, .diffs = 1, .frame = -1};
            snprintf(out->channel[CHANNEL_POSE].line, sizeof out->channel->line, "the host is %.100s, was %.100s",
                     text_of(&is, "hosts[0]"), text_of(&was, "hosts[0]"));
        }
        out->channel[CHANNEL_TIME].there = true;
    }
    for (int i = 0; i < c->frames.count && status == STATUS_OK; i++)
        status = compare_frame(out, c, record, run, (int)c->frames.number[i]);
    if (status == STATUS_OK && case_has_scores(c)) status = compare_scores(out, c, record, run);
    for (int k = 0; k < CHANNEL_COUNT; k++) {
        ChannelResult *r = &out->channel[k];
        if (r->diffs > 1) {
            const size_t n = strlen(r->line);
            snprintf(r->line + n, sizeof r->line - n, ", and %d more", r->diffs - 1);
        }
        if (r->failed && out->first < 0) out->first = k;
    }
    if (status == STATUS_OK) remark_hashes(out, &was, &is);
    json_values_free(&was);
    json_values_free(&is);
    return status;
}
