/* sensor/score/score.c: scores the answers of recognisers against the truth of a folder of products. */
#include "sensor/score/score.h"
#include "pitviper_file.h"
#include "sensor/frame/target_record.h"
#include "sensor/score/judge.h"
#include "sensor/score/sequences.h"

#include <assert.h>
#include <stdlib.h>
#include <sys/stat.h>

enum { truth_line_most = 256 << 20 };

ScoreRules score_default_rules(void)
{
    return (ScoreRules){
        .grow = 0.25, .iou = 0.3, .small_px = 100, .max_age_ms = INFINITY, .min_pixels = 5, .min_snr = 0.1};
}

typedef struct ScoreWork {
    const ScoreRequest *request;
    Sequences           sequences;
    AnswerSequences     names;
    CocoTruth           images; /* of OUT, for COCO results: read when the first ones come */
    bool                images_read, images_there;
    Answers             answers[score_recognisers_max];
    Judge               judge[score_recognisers_max];
    TruthFrame          frame;
    long long           frames;
} ScoreWork;

static bool is_folder(const char *path)
{
    struct stat there;
    return stat(path, &there) == 0 && S_ISDIR(there.st_mode);
}

/* ---- answers ---------------------------------------------------------------------------------------- */

/* Bands of the first frame of truth: a line that names none is of the only one. */
static Status find_default_band(ScoreWork *w)
{
    char       path[sequence_path_size];
    JsonStream stream = {0};
    bool       more;
    TruthFrame frame = {0};
    w->names = (AnswerSequences){w->sequences.count, w->sequences.name, -1};
    if (!sequence_path(path, w->request->out, w->sequences.name[0], "truth.jsonl")) return STATUS_BAD_VALUE;
    Status status = json_stream_open(&stream, path, truth_line_most);
    if (status == STATUS_OK) status = json_stream_line(&more, &stream);
    if (status == STATUS_OK && more) status = truth_line_read(&frame, &stream);
    for (int b = 0; b < BAND_COUNT; b++)
        if (frame.bands == 1u << b) w->names.default_band = b;
    truth_frame_free(&frame);
    json_stream_close(&stream);
    return status;
}

/* Whether the file begins as a list. */
static bool is_results(const char *path)
{
    char  why[file_why_size];
    FILE *file = file_open_stream(why, path);
    int   c = ' ';
    while (file && (c == ' ' || c == '\t' || c == '\n' || c == '\r')) c = fgetc(file);
    if (file) fclose(file);
    return c == '[';
}

static Status read_images(ScoreWork *w)
{
    char path[sequence_path_size], why[file_why_size];
    if (w->images_read) return STATUS_OK;
    w->images_read = true;
    if (!sequence_path(path, w->request->out, "", "coco.json") || !file_is_regular(why, path)) return STATUS_OK;
    w->images_there = true;
    return coco_truth_read(&w->images, path, false);
}

static Status read_file(ScoreWork *w, Answers *answers, const char *path, int sequence)
{
    Status status = is_results(path) ? read_images(w) : STATUS_OK;
    if (status != STATUS_OK) return status;
    return answers_read(answers, path, sequence, &w->names, w->images_there ? &w->images.images : NULL);
}

/* FOLDER/SEQUENCE/answers.jsonl of each sequence that has one. */
static Status read_folder(ScoreWork *w, Answers *answers, const char *folder)
{
    char   path[sequence_path_size], why[file_why_size], lacking[256] = "";
    int    read = 0;
    Status status = STATUS_OK;
    for (int i = 0; i < w->sequences.count && status == STATUS_OK; i++) {
        const char *name = w->sequences.name[i];
        if (!sequence_path(path, folder, name, "answers.jsonl")) return STATUS_BAD_VALUE;
        if (!file_is_regular(why, path)) {
            snprintf(lacking, sizeof lacking, "%s", name);
            continue;
        }
        read++;
        status = read_file(w, answers, path, i);
    }
    if (status != STATUS_OK) return status;
    if (read == 0) {
        log_error("score: %s has no answers.jsonl; name a file of answers, or let the run receive some "
                  "(publish.detections_port)",
                  folder);
        return STATUS_BAD_VALUE;
    }
    if (read < w->sequences.count)
        log_warn("score: %s/%s has no answers.jsonl, as %d of %d: nothing was answered there", folder, lacking,
                 w->sequences.count - read, w->sequences.count);
    return STATUS_OK;
}

static Status read_answers(ScoreWork *w, int i)
{
    const ScoreRequest *q = w->request;
    const char         *from = q->recognisers > 0 && *q->answers[i] ? q->answers[i] : q->out;
    const Status        status = is_folder(from) ? read_folder(w, &w->answers[i], from)
                                                 : read_file(w, &w->answers[i], from, w->sequences.count == 1 ? 0 : -1);
    if (status != STATUS_OK) return status;
    answers_sort(&w->answers[i]);
    w->judge[i] =
        (Judge){.rules = q->rules, .answers = &w->answers[i], .bands = q->bands ? q->bands : w->answers[i].bands};
    return STATUS_OK;
}

/* ---- truth ------------------------------------------------------------------------------------------ */

static Status judge_line(ScoreWork *w, const JsonStream *stream, int sequence, const CocoTruth *coco, int *before)
{
    const int recognisers = w->request->recognisers > 0 ? w->request->recognisers : 1;
    Status    status = truth_line_read(&w->frame, stream);
    if (status != STATUS_OK) return status;
    if (w->frame.frame <= *before) {
        log_error("score: %s:%ld: frame %d after frame %d; truth has each frame once, in rising order", stream->path,
                  stream->line, w->frame.frame, *before);
        return STATUS_BAD_VALUE;
    }
    *before = w->frame.frame;
    w->frames++;
    for (int i = 0; i < recognisers && status == STATUS_OK; i++)
        status = judge_frame(&w->judge[i], &w->frame, sequence, coco);
    return status;
}

/* Whether the last line is not whole: of a run that was killed. */
static bool is_cut(const JsonStream *stream)
{
    return stream->cut && (stream->length == 0 || stream->text[stream->length - 1] != '}');
}

static Status judge_lines(ScoreWork *w, const char *path, int sequence, const CocoTruth *coco)
{
    JsonStream stream;
    bool       more = true;
    int        before = -1;
    Status     status = json_stream_open(&stream, path, truth_line_most);
    while (status == STATUS_OK) {
        status = json_stream_line(&more, &stream);
        if (status != STATUS_OK || !more) break;
        if (is_cut(&stream)) {
            log_warn("score: %s:%ld: the last line is not complete, and left out", path, stream.line);
            break;
        }
        status = judge_line(w, &stream, sequence, coco, &before);
    }
    json_stream_close(&stream);
    return status;
}

static Status judge_sequence(ScoreWork *w, int sequence)
{
    char        path[sequence_path_size], why[file_why_size];
    CocoTruth   coco = {0};
    const char *out = w->request->out, *name = w->sequences.name[sequence];
    Status      status = STATUS_OK;
    for (int i = 0; i < score_recognisers_max; i++) w->judge[i].sequence = name;
    bool there = sequence_path(path, out, name, "coco.json") && file_is_regular(why, path);
    if (there) status = coco_truth_read(&coco, path, true);
    if (status == STATUS_OK && sequence_path(path, out, name, "truth.jsonl"))
        status = judge_lines(w, path, sequence, there ? &coco : NULL);
    for (int i = 0; i < score_recognisers_max && status == STATUS_OK; i++) status = judge_end_sequence(&w->judge[i]);
    coco_truth_free(&coco);
    return status;
}

/* ---- the report ------------------------------------------------------------------------------------- */

/* The file's name without folder and ending; of the default `answers`. Numbered where another has it. */
static void name_recogniser(ScoreReport *report, int i, const char *file)
{
    ScoreRecogniser *r = &report->recogniser[i];
    const char      *slash = strrchr(file, '/'), *base = slash ? slash + 1 : file;
    char             stem[48];
    const int        length = (int)strcspn(base, ".");
    snprintf(r->file, sizeof r->file, "%s", file);
    snprintf(stem, sizeof stem, "%.*s", length > 0 ? length : 7, length > 0 ? base : "answers");
    snprintf(r->name, sizeof r->name, "%s", stem);
    for (int k = 0, number = 1; k < i; k++) {
        if (strcmp(report->recogniser[k].name, r->name) != 0) continue;
        snprintf(r->name, sizeof r->name, "%s-%d", stem, ++number);
        k = -1;
    }
}

static Status make_report(ScoreReport *out, ScoreWork *w)
{
    const ScoreRequest *q = w->request;
    const int           count = q->recognisers > 0 ? q->recognisers : 1;
    ScoreReport         report = {.rules = q->rules,
                                  .sweep = w->sequences.sweep,
                                  .sequences = w->sequences.count,
                                  .class_count = target_class_count(),
                                  .frames = w->frames,
                                  .recognisers = count};
    snprintf(report.out, sizeof report.out, "%s", q->out);
    report.recogniser = calloc((size_t)count, sizeof *report.recogniser);
    if (!report.recogniser) return STATUS_NO_MEMORY;
    Status status = STATUS_OK;
    for (int i = 0; i < count && status == STATUS_OK; i++) {
        const bool given = q->recognisers > 0 && *q->answers[i];
        name_recogniser(&report, i, given ? q->answers[i] : "answers.jsonl");
        status = judge_report(&report.recogniser[i], &w->judge[i]);
    }
    if (status == STATUS_OK) *out = report;
    else score_report_free(&report);
    return status;
}

Status score_run(ScoreReport *out, const ScoreRequest *request)
{
    ScoreWork *w = calloc(1, sizeof *w);
    const int  recognisers = request->recognisers > 0 ? request->recognisers : 1;
    assert(target_class_count() <= score_classes_max && recognisers <= score_recognisers_max);
    *out = (ScoreReport){0};
    if (!w) return STATUS_NO_MEMORY;
    w->request = request;
    Status status = sequences_find(&w->sequences, request->out);
    if (status == STATUS_OK) status = find_default_band(w);
    for (int i = 0; i < recognisers && status == STATUS_OK; i++) status = read_answers(w, i);
    for (int i = 0; i < w->sequences.count && status == STATUS_OK; i++) status = judge_sequence(w, i);
    if (status == STATUS_OK) status = make_report(out, w);
    if (status == STATUS_NO_MEMORY) log_error("score: out of memory; score fewer answers at once");
    for (int i = 0; i < score_recognisers_max; i++) {
        judge_free(&w->judge[i]);
        answers_free(&w->answers[i]);
    }
    coco_truth_free(&w->images);
    truth_frame_free(&w->frame);
    sequences_free(&w->sequences);
    free(w);
    return status;
}

void score_report_free(ScoreReport *report)
{
    free(report->recogniser);
    *report = (ScoreReport){0};
}
