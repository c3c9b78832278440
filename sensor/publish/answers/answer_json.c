/* sensor/publish/answers/answer_json.c: an answer as JSON: one object with a list of detections, or lines of
 * answers.jsonl, one for each detection. */
#include "sensor/publish/answers/answer_private.h"

#include <jansson.h>
#include <math.h>

/* ---- the fields that an object may have ---------------------------------------------------------- */

typedef enum JsonType { A_NUMBER, AN_INTEGER, A_TEXT, A_BOOL, FOUR_NUMBERS, TWO_NUMBERS, A_LIST } JsonType;

typedef struct JsonField {
    const char *name;
    JsonType    type;
} JsonField;

static const JsonField answer_object[] = {{"frame", AN_INTEGER}, {"band", A_TEXT}, {"detections", A_LIST}};
/* Of a detection, there and in a line. */
static const JsonField detection_fields[] = {{"class", A_TEXT},        {"score", A_NUMBER},   {"box_px", FOUR_NUMBERS},
                                             {"los_deg", TWO_NUMBERS}, {"track", AN_INTEGER}, {"range_m", A_NUMBER}};
/* What a line has beside them. The last ones are about an earlier answer, and passed over. */
static const JsonField line_fields[] = {{"frame", AN_INTEGER}, {"band", A_TEXT},     {"answer", AN_INTEGER},
                                        {"of", AN_INTEGER},    {"time_s", A_NUMBER}, {"latency_ms", A_NUMBER},
                                        {"age_ms", A_NUMBER},  {"late", A_BOOL},     {"form", A_TEXT}};

#define COUNT(list) ((int)(sizeof(list) / sizeof *(list)))

static bool are_numbers(const json_t *value, size_t count)
{
    if (!json_is_array(value) || json_array_size(value) != count) return false;
    for (size_t i = 0; i < count; i++)
        if (!json_is_number(json_array_get(value, i))) return false;
    return true;
}

static bool is_of(const json_t *value, JsonType type)
{
    switch (type) {
    case A_NUMBER:
        return json_is_number(value);
    case AN_INTEGER:
        return json_is_integer(value);
    case A_TEXT:
        return json_is_string(value);
    case A_BOOL:
        return json_is_boolean(value);
    case FOUR_NUMBERS:
        return are_numbers(value, 4);
    case TWO_NUMBERS:
        return are_numbers(value, 2);
    case A_LIST:
        return json_is_array(value);
    }
    return false;
}

static const JsonField *find(const JsonField *list, int count, const char *name)
{
    for (int i = 0; i < count; i++)
        if (strcmp(list[i].name, name) == 0) return &list[i];
    return NULL;
}

/* Whether it is an object of these fields, and those of a detection if `detection`, each of its type. */
static bool has_only(const json_t *object, const JsonField *list, int count, bool detection)
{
    const char *name;
    json_t     *value;
    if (!json_is_object(object)) return false;
    json_object_foreach((json_t *)object, name, value)
    {
        const JsonField *field = find(list, count, name);
        if (!field && detection) field = find(detection_fields, COUNT(detection_fields), name);
        if (!field || !is_of(value, field->type)) return false;
    }
    return true;
}

/* ---- values, whose types are right ---------------------------------------------------------------- */

static void numbers(double *out, const json_t *object, const char *name, int count)
{
    const json_t *list = json_object_get(object, name);
    for (int i = 0; list && i < count; i++) out[i] = json_number_value(json_array_get(list, (size_t)i));
}

/* True where the field is not there; out keeps its value then. */
static bool integer(int64_t *out, const json_t *object, const char *name, int64_t low, int64_t high)
{
    const json_t *value = json_object_get(object, name);
    if (!value) return true;
    *out = json_integer_value(value);
    return *out >= low && *out <= high;
}

static AnswerReason take_detection(AnswerDetection *out, const json_t *object, const AnswerScope *scope)
{
    const json_t *score = json_object_get(object, "score"), *range = json_object_get(object, "range_m"),
                 *name = json_object_get(object, "class");
    int64_t track = 0;
    double  los_deg[2] = {NAN, NAN};
    *out = answer_detection_empty();
    numbers(out->box_px, object, "box_px", 4);
    numbers(los_deg, object, "los_deg", 2);
    for (int k = 0; k < 2; k++) out->los_rad[k] = los_deg[k] * rad_per_deg;
    if (score) out->score = json_number_value(score);
    if (range) out->range_m = json_number_value(range);
    if (!integer(&track, object, "track", 0, UINT32_MAX)) return ANSWER_FIELD;
    out->track = (uint32_t)track;
    if (name && !answer_class_set(out, json_string_value(name), json_string_length(name))) return ANSWER_TEXT;
    return answer_detection_check(out, scope);
}

/* The frame and the band of an object, both of which it must have. */
static AnswerReason take_frame(int *frame, Band *band, const json_t *object, const AnswerScope *scope)
{
    const char *name = json_string_value(json_object_get(object, "band"));
    int64_t     number = -1;
    if (!name || !integer(&number, object, "frame", 0, INT32_MAX) || number < 0) return ANSWER_FIELD;
    *frame = (int)number;
    for (int b = 0; b < BAND_COUNT; b++)
        if (scope->bands >> b & 1 && strcmp(name, band_name((Band)b)) == 0) {
            *band = (Band)b;
            return ANSWER_GOOD;
        }
    return ANSWER_BAND;
}

/* ---- the two shapes -------------------------------------------------------------------------------- */

/* {"frame": ..., "band": ..., "detections": [...]} */
static AnswerReason take_answer(Answer *out, const json_t *object, const AnswerScope *scope)
{
    const json_t *list = json_object_get(object, "detections");
    if (!has_only(object, answer_object, COUNT(answer_object), false)) return ANSWER_FIELD;
    AnswerReason reason = take_frame(&out->frame, &out->band, object, scope);
    if (reason == ANSWER_GOOD && json_array_size(list) > answer_detections_most) reason = ANSWER_COUNT;
    for (size_t i = 0; reason == ANSWER_GOOD && i < json_array_size(list); i++) {
        const json_t *one = json_array_get(list, i);
        reason = has_only(one, NULL, 0, true) ? take_detection(&out->detection[i], one, scope) : ANSWER_FIELD;
    }
    out->count = (int)json_array_size(list);
    return reason;
}

/* Line `number` from 0 on, which must be of the same frame and band as those before. of: so many that the lines say
 * there are; -1: none has said it. */
static AnswerReason take_line(Answer *out, int64_t *of, int number, const json_t *object, const AnswerScope *scope)
{
    int     frame = 0;
    Band    band = BAND_COUNT;
    int64_t all = -1;
    if (!has_only(object, line_fields, COUNT(line_fields), true)) return ANSWER_FIELD;
    const AnswerReason reason = take_frame(&frame, &band, object, scope);
    if (reason != ANSWER_GOOD) return reason;
    if (number > 0 && (frame != out->frame || band != out->band)) return ANSWER_FIELD;
    if (!integer(&all, object, "of", 0, answer_detections_most) || (number > 0 && all != *of)) return ANSWER_COUNT;
    *of = all;
    out->frame = frame;
    out->band = band;
    if (all == 0) { /* nothing was found: the only line, without anything of a detection */
        for (int i = 0; i < COUNT(detection_fields); i++)
            if (json_object_get(object, detection_fields[i].name)) return ANSWER_FIELD;
        return number == 0 ? ANSWER_GOOD : ANSWER_COUNT;
    }
    if (out->count == answer_detections_most) return ANSWER_COUNT;
    return take_detection(&out->detection[out->count++], object, scope);
}

static bool is_blank(uint8_t octet) { return octet == ' ' || octet == '\t' || octet == '\r' || octet == '\n'; }

AnswerReason answer_read_json(Answer *out, const uint8_t *bytes, size_t size, const AnswerScope *scope)
{
    AnswerReason reason = ANSWER_GOOD;
    int64_t      of = -1;
    int          number = 0;
    bool         whole = false; /* an object with all of it was there */
    out->numbered = true;
    out->number_bits = UINT32_MAX;
    while (reason == ANSWER_GOOD) {
        while (size > 0 && is_blank(*bytes)) bytes++, size--;
        if (size == 0) break;
        json_error_t error;
        json_t *object = json_loadb((const char *)bytes, size, JSON_REJECT_DUPLICATES | JSON_DISABLE_EOF_CHECK, &error);
        if (!object) return ANSWER_NO_JSON;
        const bool list = json_object_get(object, "detections") != NULL;
        if (whole || (list && number > 0)) reason = ANSWER_COUNT; /* two answers */
        else if (list) reason = take_answer(out, object, scope);
        else reason = take_line(out, &of, number, object, scope);
        whole |= list;
        number++;
        json_decref(object);
        bytes += error.position, size -= (size_t)error.position;
    }
    if (reason == ANSWER_GOOD && of > 0 && of != out->count) return ANSWER_COUNT;
    return reason;
}
