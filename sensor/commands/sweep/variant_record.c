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

char *variant_line(const VariantRecord *r)
{
    json_t *settings = json_object();
    for (int i = 0; i < r->setting_count; i++) json_object_set_new(settings, r->key[i], json_string(r->value[i]));
    json_t *line =
        json_pack("{s:s,s:s,s:i,s:s,s:o,s:s,s:s,s:s,s:s}", "variant", r->name, "folder", r->name, "number", r->number,
                  "status", r->status, "settings", settings, "config_sha256", r->config_sha256, "settings_sha256",
                  r->settings_sha256, "log_sha256", r->log_sha256, "pitviper", PITVIPER_VERSION);
    if (!line) return NULL;
    if (*r->error) json_object_set_new(line, "error", json_string(r->error));
    if (r->seconds > 0) json_object_set_new(line, "seconds", json_real(r->seconds));
    if (r->run) {
        json_t *hashes = json_array();
        for (int i = 0; i < r->run->hash_count; i++) json_array_append_new(hashes, json_string(r->run->hash[i]));
        json_object_set_new(line, "frames", json_integer(r->run->frames));
        json_object_set_new(line, "frame_sha256", hashes);
    }
    char *text = json_dumps(line, JSON_COMPACT | JSON_REAL_PRECISION(6));
    json_decref(line);
    return text;
}
