/* sensor/score/answers.c: reads the answers of a recogniser, lines of JSON or COCO results, into the order of frames.
 */
#include "sensor/score/answers.h"
#include "sensor/frame/target_record.h"
#include "sensor/score/json_member.h"

#include <ctype.h>
#include <stdlib.h>
#include <strings.h>

/* ---- order ---------------------------------------------------------------------------------------- */

static inline int compare(double a, double b)
{
    if (isnan(a) || isnan(b)) return isnan(a) - isnan(b); /* absent numbers are last */
    return (a > b) - (a < b);
}

int answers_order(const void *a, const void *b)
{
    const Answer *x = a, *y = b;
    if (x->sequence != y->sequence) return x->sequence < y->sequence ? -1 : 1;
    if (x->frame != y->frame) return x->frame < y->frame ? -1 : 1;
    if (x->band != y->band) return x->band < y->band ? -1 : 1;
    if (x->found != y->found) return x->found ? -1 : 1;
    int order = compare(y->score, x->score);
    if (!order) order = x->line_of_sight - y->line_of_sight;
    for (int k = 0; k < 4 && !order; k++) order = compare(x->box[k], y->box[k]);
    if (!order) order = x->class_number - y->class_number;
    if (!order) order = compare(x->range_m, y->range_m);
    if (!order) order = (x->track > y->track) - (x->track < y->track);
    if (!order) order = compare(x->latency_ms, y->latency_ms);
    return order ? order : x->late - y->late;
}

void answers_sort(Answers *answers)
{
    if (answers->count) qsort(answers->one, answers->count, sizeof *answers->one, answers_order);
}

const Answer *answers_of(size_t *count, const Answers *answers, int sequence, int frame, Band band)
{
    size_t low = 0, high = answers->count, end;
    while (low < high) {
        const size_t  middle = (low + high) / 2;
        const Answer *a = &answers->one[middle];
        const bool    before = a->sequence != sequence ? a->sequence < sequence
                               : a->frame != frame     ? a->frame < frame
                                                       : a->band < band;
        if (before) low = middle + 1;
        else high = middle;
    }
    for (end = low; end < answers->count; end++) {
        const Answer *a = &answers->one[end];
        if (a->sequence != sequence || a->frame != frame || a->band != band) break;
    }
    *count = end - low;
    return answers->one ? answers->one + low : NULL;
}

/* ---- one answer ------------------------------------------------------------------------------------ */

static Status wrong(const JsonStream *s, const char *what)
{
    log_error("score: %s:%ld: %s; `pitviper help answers` has the fields", s->path, s->line, what);
    return STATUS_BAD_VALUE;
}

static Status add(Answers *answers, const Answer *one, const JsonStream *s)
{
    if (answers->count == answers->room) {
        const size_t room = answers->room ? 2 * answers->room : 1024;
        if (answers->count >= answers_most) return wrong(s, "more than 100 million answers");
        Answer *grown = realloc(answers->one, room * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        answers->one = grown;
        answers->room = room;
    }
    answers->one[answers->count++] = *one;
    answers->bands |= 1u << one->band;
    answers->lines_of_sight |= one->line_of_sight;
    answers->tracks |= one->track != 0;
    return STATUS_OK;
}

uint8_t answers_class(const char *word)
{
    for (int k = 1; k <= target_class_count(); k++)
        if (strcasecmp(word, target_class_name(k)) == 0) return (uint8_t)k;
    return 0;
}

/* Counts a word that is no class. */
static Status count_word(Answers *answers, const char *word)
{
    char shown[score_word_size];
    if (strcasecmp(word, "unknown") == 0) return STATUS_OK;
    text_escape(shown, sizeof shown, word, strlen(word));
    for (int i = 0; i < answers->words; i++)
        if (strcmp(answers->word[i].word, shown) == 0) return answers->word[i].count++, STATUS_OK;
    if (answers->words == answers_words_most) return STATUS_OK;
    if (answers->words == answers->words_room) {
        const int  room = answers->words_room ? 2 * answers->words_room : 16;
        ScoreWord *grown = realloc(answers->word, (size_t)room * sizeof *grown);
        if (!grown) return STATUS_NO_MEMORY;
        answers->word = grown;
        answers->words_room = room;
    }
    ScoreWord *w = &answers->word[answers->words++];
    memcpy(w->word, shown, sizeof w->word);
    w->count = 1;
    return STATUS_OK;
}

static bool given(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return value && !json_is_null(value);
}

/* ---- lines ----------------------------------------------------------------------------------------- */

static int sequence_named(const AnswerSequences *sequences, const char *name)
{
    for (int i = 0; i < sequences->count; i++)
        if (strcmp(sequences->name[i], name) == 0) return i;
    return -1;
}

/* What it is of. */
static Status read_place(Answer *a, const json_t *from, const JsonStream *s, int sequence,
                         const AnswerSequences *sequences)
{
    long long   frame;
    const char *name = json_string_value(json_object_get(from, "sequence"));
    a->sequence = name ? sequence_named(sequences, name) : sequence;
    if (name && a->sequence < 0) return wrong(s, "`sequence` names no folder of OUT that has truth");
    if (a->sequence < 0)
        return wrong(s, "OUT has several sequences: each line needs `sequence`, the name of its folder in OUT");
    if (!json_member_whole(&frame, from, "frame", 0, INT32_MAX)) return wrong(s, "`frame` is no whole number from 0");
    const int band = given(from, "band") ? json_member_band(from, "band") : sequences->default_band;
    if (band < 0 && given(from, "band")) return wrong(s, "`band` is none of optical, mwir, lwir, radar");
    if (band < 0) return wrong(s, "`band` is missing, and truth has several");
    a->frame = (int)frame;
    a->band = (uint8_t)band;
    return STATUS_OK;
}

static Status read_position(Answer *a, const json_t *from, const JsonStream *s)
{
    if (given(from, "box_px")) {
        double edge[4];
        if (!json_member_numbers(edge, 4, from, "box_px") || !(edge[2] > edge[0] && edge[3] > edge[1]))
            return wrong(s, "`box_px` is no list of left, top, right, bottom with left < right and top < bottom");
        for (int k = 0; k < 2; k++) a->box[k] = edge[k], a->box[2 + k] = edge[2 + k] - edge[k];
        return STATUS_OK;
    }
    a->line_of_sight = true;
    if (!json_member_numbers(a->box, 2, from, "los_deg") || !(fabs(a->box[0]) <= 720 && fabs(a->box[1]) <= 90))
        return wrong(s, "neither `box_px`, nor `los_deg` with an azimuth and an elevation in -90 .. 90");
    return STATUS_OK;
}

static Status read_numbers(Answer *a, const json_t *from, const JsonStream *s)
{
    long long track = 0;
    a->score = given(from, "score") ? json_member_number(from, "score") : 1;
    if (!(fabs(a->score) <= 1e9)) return wrong(s, "`score` is no number");
    if (given(from, "track") && !json_member_whole(&track, from, "track", 0, UINT32_MAX))
        return wrong(s, "`track` is no whole number in 0 .. 4294967295");
    a->track = (uint32_t)track;
    a->range_m = json_member_number(from, "range_m");
    if (given(from, "range_m") && !(a->range_m >= 0 && a->range_m <= 1e9))
        return wrong(s, "`range_m` is no distance in 0 .. 1e9 m");
    return STATUS_OK;
}

static Status read_line(Answers *answers, const json_t *from, const JsonStream *s, int sequence,
                        const AnswerSequences *sequences)
{
    Answer      a = {.range_m = NAN};
    const char *word = json_string_value(json_object_get(from, "class"));
    if (!json_is_object(from)) return wrong(s, "this line is no JSON object");
    Status status = read_place(&a, from, s, sequence, sequences);
    if (status != STATUS_OK) return status;
    a.latency_ms = (float)json_member_number(from, "latency_ms");
    if (given(from, "latency_ms") && !(fabsf(a.latency_ms) <= 1e9f)) return wrong(s, "`latency_ms` is no number");
    a.late = json_is_true(json_object_get(from, "late"));
    a.found = given(from, "class") || given(from, "box_px") || given(from, "los_deg");
    if (!a.found) return add(answers, &a, s);
    if (given(from, "class") && !word) return wrong(s, "`class` is no text");
    status = read_position(&a, from, s);
    if (status == STATUS_OK) status = read_numbers(&a, from, s);
    if (status != STATUS_OK) return status;
    a.class_number = word ? answers_class(word) : 0;
    if (word && !a.class_number) status = count_word(answers, word);
    return status == STATUS_OK ? add(answers, &a, s) : status;
}

static Status read_lines(Answers *answers, JsonStream *s, int sequence, const AnswerSequences *sequences)
{
    for (;;) {
        bool   more;
        Status status = json_stream_line(&more, s);
        if (status != STATUS_OK || !more) return status;
        json_t *line;
        status = json_member_load(&line, s->text, s->length);
        if (status == STATUS_NO_MEMORY) return status;
        if (!line && s->cut) {
            log_warn("score: %s:%ld: the last line is not complete, and left out", s->path, s->line);
            return STATUS_OK;
        }
        status = read_line(answers, line, s, sequence, sequences);
        json_decref(line);
        if (status != STATUS_OK) return status;
    }
}

/* ---- COCO results ---------------------------------------------------------------------------------- */

static Status read_result(Answers *answers, const json_t *from, const JsonStream *s, int sequence,
                          const CocoImages *images, const int *of_variant)
{
    Answer    a = {.range_m = NAN, .latency_ms = NAN, .found = true};
    long long image_id, category;
    double    box[4];
    char      word[48];
    if (!json_is_object(from)) return wrong(s, "this item is no JSON object");
    if (!json_member_whole(&image_id, from, "image_id", 0, 1LL << 52)) return wrong(s, "`image_id` is no whole number");
    if (!json_member_whole(&category, from, "category_id", 0, INT32_MAX))
        return wrong(s, "`category_id` is no whole number from 0");
    if (!json_member_numbers(box, 4, from, "bbox") || !(box[2] > 0 && box[3] > 0))
        return wrong(s, "`bbox` is no list of left, top, width, height");
    const CocoImage *image = coco_image(images, image_id);
    if (!image) return wrong(s, "`image_id` is of no image of OUT/coco.json");
    a.sequence = image->variant < 0 ? sequence : of_variant[image->variant];
    if (a.sequence < 0) return wrong(s, "the image is of no sequence of OUT that has truth");
    a.frame = image->frame;
    a.band = image->band;
    memcpy(a.box, box, sizeof a.box);
    Status status = read_numbers(&a, from, s);
    if (status == STATUS_OK && category >= 1 && category <= target_class_count()) {
        a.class_number = (uint8_t)category;
    } else if (status == STATUS_OK) {
        snprintf(word, sizeof word, "category %lld", category);
        status = count_word(answers, word);
    }
    return status == STATUS_OK ? add(answers, &a, s) : status;
}

static Status read_results(Answers *answers, JsonStream *s, int sequence, const AnswerSequences *sequences,
                           const CocoImages *images)
{
    JsonLists lists = {.stream = s};
    bool      more;
    int      *of_variant = calloc((size_t)images->names + 1, sizeof *of_variant);
    Status    status = of_variant ? json_lists_next(&more, &lists) : STATUS_NO_MEMORY;
    for (int i = 0; of_variant && i < images->names; i++) of_variant[i] = sequence_named(sequences, images->name[i]);
    while (status == STATUS_OK) {
        status = json_lists_item(&more, &lists);
        if (status != STATUS_OK || !more) break;
        json_t *item;
        status = json_member_load(&item, s->text, s->length);
        if (status == STATUS_NO_MEMORY) break;
        status = read_result(answers, item, s, sequence, images, of_variant);
        json_decref(item);
    }
    free(of_variant);
    return status;
}

/* ---- files ----------------------------------------------------------------------------------------- */

Status answers_read_stream(Answers *answers, JsonStream *s, int sequence, const AnswerSequences *sequences,
                           const CocoImages *images)
{
    const int first = json_stream_peek(s);
    if (first == '[' && images) return read_results(answers, s, sequence, sequences, images);
    if (first != '[') return read_lines(answers, s, sequence, sequences);
    log_error("score: %s: COCO results need the coco.json of OUT, and there is none; run with --coco", s->path);
    return STATUS_BAD_VALUE;
}

Status answers_read(Answers *answers, const char *path, int sequence, const AnswerSequences *sequences,
                    const CocoImages *images)
{
    JsonStream stream;
    Status     status = json_stream_open(&stream, path, 1 << 20);
    if (status == STATUS_OK) status = answers_read_stream(answers, &stream, sequence, sequences, images);
    json_stream_close(&stream);
    return status;
}

void answers_free(Answers *answers)
{
    free(answers->one);
    free(answers->word);
    *answers = (Answers){0};
}
