/* sensor/publish/answers/answer_lines.c: answers.jsonl: its fields, and the file. */
#include "sensor/publish/answers/answer_lines_private.h"
#include "pitviper_output.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct AnswerLines {
    FILE *file;
    bool  failed; /* reported */
};

/* box_px .. track: only with class_name. */
typedef struct AnswerLine {
    int         frame, answer, of;
    const char *band, *form, *class_name; /* NULL: nothing was found */
    double      time_s;                   /* exercise time */
    double      box_px[4], los_rad[2], range_m, score;
    long long   track; /* 0: none */
    double      latency_ms, age_ms;
    bool        late;
} AnswerLine;

static const void *found(const void *of) { return ((const AnswerLine *)of)->class_name ? of : NULL; }

static const void *boxed(const void *of)
{
    const AnswerLine *line = found(of);
    return line && !isnan(line->box_px[0]) ? line : NULL;
}

static const void *sighted(const void *of)
{
    const AnswerLine *line = found(of);
    return line && !isnan(line->los_rad[0]) ? line : NULL;
}

#define OF_LINE(member)  FIELD_MEMBER(AnswerLine, member)
#define OF_FOUND(member) FIELD_IN(found, AnswerLine, member)

static const Field answer_rows[] = {
    {"frame", "", "from 0", "", "number of the frame that was answered", OF_LINE(frame)},
    {"band", "", "", "", "BAND that was answered", OF_LINE(band)},
    {"time_s", "s", "exercise time", "", "instant of that frame", OF_LINE(time_s)},
    {"answer", "", "from 1", "", "number of the detection among those of the answer; 0: it found nothing",
     OF_LINE(answer)},
    {"of", "", "", "", "detections of the answer: so many lines belong together", OF_LINE(of)},
    {"class", "", "", "when nothing was found", "the recogniser's own word, at most 31 characters; empty: none",
     OF_LINE(class_name)},
    {"box_px", "px", "image: left, top, right, bottom; from 0, the last two beyond it",
     "when nothing was found, or its line of sight alone", "bounding box", FIELD_IN(boxed, AnswerLine, box_px)},
    {"los_deg", "deg", "ENU at the sensor: from north over east 0 .. 360, above the horizontal",
     "when the recogniser gave none", "line of sight", FIELD_IN(sighted, AnswerLine, los_rad), .as = field_deg},
    {"range_m", "m", "from the sensor", "when the recogniser gave none", "range", OF_FOUND(range_m)},
    {"score", "", "0 .. 1", "when nothing was found, or the recogniser gave none", "confidence", OF_FOUND(score)},
    {"track", "", "", "when the recogniser gave none", "the same number for the same object in later frames",
     OF_FOUND(track), .unless_0 = true},
    {"latency_ms", "ms", "", "", "from the end of the frame's rendering until the answer was received",
     OF_LINE(latency_ms), .as = field_ms},
    {"age_ms", "ms", "", "in a replay at full speed",
     "from the frame's instant of the exercise until the answer was received: latency_ms and what the node took before",
     OF_LINE(age_ms), .as = field_ms},
    {"late", "", "", "", "a newer frame of the band was answered before: not in metadata", OF_LINE(late)},
    {"form", "", "", "", "how it came: ring, json or klv", OF_LINE(form)},
};
const FieldTable answer_fields = {answer_rows, sizeof answer_rows / sizeof *answer_rows};

Status answer_lines_open(AnswerLines **out, const char *folder)
{
    char         path[4096];
    AnswerLines *a = calloc(1, sizeof *a);
    if (!a) return STATUS_NO_MEMORY;
    const bool fits = snprintf(path, sizeof path, "%s/answers.jsonl", folder) < (int)sizeof path;
    if (!fits) errno = ENAMETOOLONG;
    a->file = fits ? output_file(path, 0) : NULL;
    if (a->file) {
        *out = a;
        return STATUS_OK;
    }
    log_error("answers: cannot write %s/answers.jsonl: %s; choose another place with --out", folder,
              output_reason(errno));
    free(a);
    return STATUS_IO;
}

/* Rounds a float to the decimal that its sender wrote, since the nearest double of the float shows further digits. */
static double digits(double value, double unit) { return round(value / unit) * unit; }

void answer_lines_write(AnswerLines *a, const Answer *answer, const AnswerArrival *arrival, AnswerCounters *counters)
{
    const int  lines = answer->count > 0 ? answer->count : 1;
    bool       ok = true;
    AnswerLine line = {.frame = answer->frame,
                       .of = answer->count,
                       .band = band_name(answer->band),
                       .form = answer_form_name[answer->form],
                       .time_s = answer->time_s,
                       .latency_ms = arrival->latency_ms,
                       .age_ms = arrival->age_ms,
                       .late = arrival->late};
    for (int i = 0; i < lines; i++) {
        const AnswerDetection *d = &answer->detection[i];
        line.answer = line.of > 0 ? i + 1 : 0;
        line.class_name = line.of > 0 ? d->class_name : NULL;
        for (int k = 0; k < 4; k++) line.box_px[k] = digits(d->box_px[k], 1e-4);
        memcpy(line.los_rad, d->los_rad, sizeof line.los_rad);
        line.range_m = d->range_m;
        line.score = digits(d->score, 1e-6);
        line.track = d->track;
        char *text = field_line(&answer_fields, &line, 12);
        ok = text && fprintf(a->file, "%s\n", text) > 0 && ok;
        free(text);
    }
    ok = fflush(a->file) == 0 && ok;
    counters->lines += ok ? (uint64_t)lines : 0;
    counters->lines_failed += ok ? 0 : (uint64_t)lines;
    if (!ok && !a->failed) log_warn("answers: cannot write answers.jsonl: %s; such lines are counted", strerror(errno));
    a->failed |= !ok;
    clearerr(a->file);
}

void answer_lines_close(AnswerLines *a)
{
    if (!a) return;
    if (fclose(a->file) != 0 && !a->failed) log_warn("answers: cannot write answers.jsonl: %s", strerror(errno));
    free(a);
}
