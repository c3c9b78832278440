/* sensor/commands/sweep/variant_record.c: manifest.jsonl and variant.json of a sweep. */
#include "sensor/commands/sweep/sweep_private.h"

#include "sensor/frame/json_object.h"

#include <stdlib.h>

/* ---- read back -------------------------------------------------------------------------------- */

static void take_text(char *out, size_t size, const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    snprintf(out, size, "%s", text && strlen(text) < size ? text : "");
}

bool variant_run_read(VariantRun *out, const char *path)
{
    json_t *run = json_read_file(path);
    *out = (VariantRun){0};
    if (!json_is_object(run)) {
        json_decref(run);
        return false;
    }
    const json_t    *hashes = json_object_get(run, "frame_sha256"), *numbers = json_object_get(run, "frame_number");
    const json_int_t frames = json_integer_value(json_object_get(run, "frames")),
                     middle = json_integer_value(json_array_get(numbers, json_array_size(numbers) / 2));
    const size_t count = json_array_size(hashes);
    take_text(out->version, sizeof out->version, run, "pitviper");
    take_text(out->config_sha256, sizeof out->config_sha256, run, "config_sha256");
    take_text(out->log_sha256, sizeof out->log_sha256, run, "log_sha256");
    take_text(out->settings_sha256, sizeof out->settings_sha256, run, "settings_sha256");
    const char *status = json_string_value(json_object_get(run, "status"));
    out->complete = status && strcmp(status, "complete") == 0;
    out->frames = frames > 0 && frames <= INT32_MAX ? (int)frames : 0;
    out->middle_frame = middle >= 0 && middle <= INT32_MAX ? (int)middle : 0;
    out->hash = count > 0 && count <= INT32_MAX ? calloc(count, sizeof *out->hash) : NULL;
    for (size_t i = 0; out->hash && i < count; i++) {
        const char *text = json_string_value(json_array_get(hashes, i));
        snprintf(out->hash[out->hash_count++], sha256_text_size, "%s", text ? text : "");
    }
    json_decref(run);
    return true;
}

void variant_run_free(VariantRun *run)
{
    free(run->hash);
    *run = (VariantRun){0};
}

/* ---- written ---------------------------------------------------------------------------------- */

/* A line of manifest.jsonl. */
typedef struct VariantLine {
    const Sweep      *sweep;
    const Variant    *variant;
    const VariantRun *run;                                   /* NULL: there is none */
    int               number;                                /* from 1 */
    double            seconds;                               /* NaN: not given */
    const char       *status, *error, *log_sha256, *version; /* error: "": none */
} VariantLine;

static const void *variant_of(const void *of) { return ((const VariantLine *)of)->variant; }
static const void *run_of(const void *of) { return ((const VariantLine *)of)->run; }

static json_t *settings(FieldAt *at)
{
    const VariantLine *line = at->of;
    json_t            *object = json_object();
    char               value[sweep_value_size];
    for (int i = 0; i < line->sweep->axis_count; i++) {
        sweep_value(value, line->sweep, line->number - 1, i);
        json_object_set_new(object, line->sweep->axis[i].key, json_string(value));
    }
    return object;
}

static const void *next_hash(FieldAt *at, int i)
{
    const VariantRun *run = at->of;
    return i < run->hash_count ? run->hash[i] : NULL;
}

#define OF_LINE(member)    FIELD_MEMBER(VariantLine, member)
#define IN_VARIANT(member) FIELD_IN(variant_of, Variant, member)

static const Field key_rows[] = {
    {"KEY", "as in `pitviper check --default`", "", "", "its value as text", FIELD_ELSEWHERE("string")},
};

static const Field variant_rows[] = {
    {"variant", "", "", "", "its name, a hash of its settings", IN_VARIANT(name)},
    {"folder", "", "from the folder of manifest.jsonl", "", "where its products are", IN_VARIANT(name)},
    {"number", "", "from 1", "", "its position in the sweep", OF_LINE(number)},
    {"status", "", "", "", "`made`; `kept`: complete from an earlier run; `failed`", OF_LINE(status)},
    {"settings", "", "", "", "settings of the axes", .get = settings, FIELD_OBJECT(key_rows)},
    {"exercise", "", "", "when a recording was replayed", "name of its recording in exercises/", IN_VARIANT(exercise),
     .unless_empty = true},
    {"config_sha256", "", "", "", "as in its run.json", IN_VARIANT(config_sha256)},
    {"settings_sha256", "", "", "", "SHA-256 of its settings.yaml", IN_VARIANT(settings_sha256)},
    {"log_sha256", "", "", "", "SHA-256 of the log's octets", OF_LINE(log_sha256)},
    {"pitviper", "", "", "", "version of the program", OF_LINE(version)},
    {"error", "", "", "when it has not failed", "reason; details in log.txt of its folder", OF_LINE(error),
     .unless_empty = true},
    {"seconds", "s", "", "when it was kept", "run time", OF_LINE(seconds)},
    {"frames", "", "", "when it failed", "number of frames rendered", FIELD_IN(run_of, VariantRun, frames)},
    {"frame_sha256", "", "", "when it failed", "as in its run.json", .type = "list of strings", .in = run_of,
     .item = next_hash, .kind = FIELD_OF_OCTETS, .size = sha256_text_size},
};
const FieldTable variant_fields = {variant_rows, sizeof variant_rows / sizeof *variant_rows};

char *sweep_manifest_line(const SweepRun *s, const Variant *v, const Outcome *outcome)
{
    const VariantLine line = {&s->sweep,
                              v,
                              outcome->has_run ? &outcome->run : NULL,
                              v->number + 1,
                              outcome->seconds > 0 ? outcome->seconds : NAN,
                              outcome->status,
                              outcome->why,
                              v->log_sha256,
                              PITVIPER_VERSION};
    return field_line(&variant_fields, &line, 6);
}
