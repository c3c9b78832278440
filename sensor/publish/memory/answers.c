/* sensor/publish/memory/answers.c: writes answers.jsonl line by line. */
#include "sensor/publish/memory/answers.h"

#include "pitviper_output.h"
#include "render/scene/view.h"
#include "sensor/publish/json_write.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

struct Answers {
    FILE *file;
    bool  failed; /* reported */
};

Status answers_open(Answers **out, const char *folder)
{
    char     path[4096];
    Answers *a = calloc(1, sizeof *a);
    if (!a) return STATUS_NO_MEMORY;
    const bool fits = snprintf(path, sizeof path, "%s/answers.jsonl", folder) < (int)sizeof path;
    if (!fits) errno = ENAMETOOLONG;
    a->file = fits ? output_file(path, 0) : NULL;
    if (a->file) {
        *out = a;
        return STATUS_OK;
    }
    log_error("detections: cannot write %s/answers.jsonl: %s; choose another place with --out", folder,
              output_reason(errno));
    free(a);
    return STATUS_IO;
}

/* As a sender wrote it, and not the nearest double of its float. */
static double digits(float value, double unit) { return round((double)value / unit) * unit; }

/* Detection `number` of the answer, from 1 on; 0: there is none. */
static json_t *line_of(const PitviperDetections *answer, const AnsweredFrame *frame, uint32_t number)
{
    json_t *line = json_pack("{s:i,s:s,s:f,s:I,s:I}", "frame", answer->frame, "band", band_name((Band)answer->band), "time_s",
                             frame->time_s, "answer", (json_int_t)number, "of", (json_int_t)answer->count);
    if (line && number > 0) {
        const PitviperDetection *d = &answer->detection[number - 1];
        json_object_set_new(line, "class", json_string(d->class_name));
        json_object_set_new(line, "box_px", json_pack("[f,f,f,f]", digits(d->left, 1e-4), digits(d->top, 1e-4),
                                                      digits(d->right, 1e-4), digits(d->bottom, 1e-4)));
        set_number(line, "score", digits(d->score, 1e-6));
        if (d->track) json_object_set_new(line, "track", json_integer((json_int_t)d->track));
    }
    if (line) set_number(line, "latency_ms", round(1e3 * frame->latency_ms) * 1e-3);
    if (line) json_object_set_new(line, "late", json_boolean(frame->late));
    return line;
}

static bool put(FILE *file, json_t *line)
{
    char      *text = line ? json_dumps(line, JSON_COMPACT | JSON_REAL_PRECISION(12)) : NULL;
    const bool ok   = text && fprintf(file, "%s\n", text) > 0;
    free(text);
    json_decref(line);
    return ok;
}

void answers_write(Answers *a, const PitviperDetections *answer, const AnsweredFrame *frame, AnswerCounters *counters)
{
    const uint32_t lines = answer->count > 0 ? answer->count : 1;
    bool           ok = true;
    for (uint32_t i = 0; i < lines; i++) ok = put(a->file, line_of(answer, frame, answer->count > 0 ? i + 1 : 0)) && ok;
    ok = fflush(a->file) == 0 && ok;
    counters->lines += ok ? lines : 0;
    counters->lines_failed += ok ? 0 : lines;
    if (!ok && !a->failed) log_warn("detections: cannot write answers.jsonl: %s; such lines are counted", strerror(errno));
    a->failed |= !ok;
    clearerr(a->file);
}

void answers_close(Answers *a)
{
    if (!a) return;
    if (fclose(a->file) != 0 && !a->failed) log_warn("detections: cannot write answers.jsonl: %s", strerror(errno));
    free(a);
}
