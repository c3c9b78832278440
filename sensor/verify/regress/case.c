/* sensor/verify/regress/case.c: reads case.yaml: its keys, default tolerances and checks. */
#include "sensor/verify/regress/case.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

#define CASE_ROW(...) SETTING_ROW(Case, __VA_ARGS__)

static const Setting      keys[] = {CASE_TOP(CASE_ROW) CASE_SCORES(CASE_ROW) CASE_TOLERANCE(CASE_ROW)};
static const SettingTable table = {
    .module = "regress", .row = keys, .count = sizeof keys / sizeof *keys, .all_keys = "`pitviper regress --keys`"};

Case case_default(void)
{
    return (Case){CASE_TOP(SETTING_DEFAULT) CASE_SCORES(SETTING_DEFAULT) CASE_TOLERANCE(SETTING_DEFAULT)};
}

/* Checks that involve several keys. */
static Status check(const Case *c, const char *path)
{
    const char *wrong = NULL;
    if (!*c->purpose) wrong = "purpose: is missing; one sentence what the case is for";
    else if (!*c->log && !*c->scenario)
        wrong = "log: or scenario: is missing; name a recording, or a scenario such as demo";
    else if (*c->log && *c->scenario) wrong = "log: and scenario: are both given; leave one out";
    else if (!*c->log && c->log_may_be_absent)
        wrong = "log_may_be_absent: applies to a log, and a scenario is given; leave it out";
    else if (*c->log && *c->scenario_set)
        wrong = "scenario_set: applies to a scenario, and a log is given; leave it "
                "out";
    else if (*c->config && *c->config_file) wrong = "config: and config_file: are both given; leave one out";
    else if (*c->scores.command && *c->scores.answers)
        wrong = "scores.command: and scores.answers: are both given; leave one out";
    else if (c->frames.count == 0) wrong = "frames: is missing; list the frames to compare, such as [3, 7, 12]";
    else if (c->frames.count > case_frames_max) wrong = "frames: more than 64; a baseline is kept small";
    for (int i = 0; !wrong && i < c->frames.count; i++) {
        if (c->frames.number[i] != floor(c->frames.number[i]))
            wrong = "frames: must be whole numbers, such as [3, 7, 12]";
        if (i > 0 && !(c->frames.number[i - 1] < c->frames.number[i]))
            wrong = "frames: must be in ascending order, "
                    "without duplicates";
    }
    if (!wrong) return STATUS_OK;
    log_error("regress: %s: %s", path, wrong);
    return STATUS_BAD_VALUE;
}

/* Copies the last component of the folder's absolute path. */
static void name_of(char out[128], const char *folder)
{
    char       *whole = realpath(folder, NULL);
    const char *last = whole ? strrchr(whole, '/') : NULL;
    text_escape(out, 128, last && last[1] ? last + 1 : folder, strnlen(last && last[1] ? last + 1 : folder, 100));
    free(whole);
}

Status case_read_file(Case *out, const char *path)
{
    Case   read = *out;
    Status status = settings_read(&read, NULL, &table, path);
    if (status == STATUS_OK) status = check(&read, path);
    if (status == STATUS_OK) *out = read;
    return status;
}

Status case_read(Case *out, const char *folder)
{
    char path[case_path_size];
    Case read = case_default();
    if (snprintf(read.folder, sizeof read.folder, "%s", folder) >= (int)sizeof read.folder - 64) {
        log_error("regress: %.200s...: the path is too long; change to a nearer folder", folder);
        return STATUS_BAD_VALUE;
    }
    name_of(read.name, folder);
    snprintf(path, sizeof path, "%.4000s/case.yaml", folder);
    if (access(path, F_OK) != 0) {
        log_error("regress: there is no %s; a case is a folder that holds one (`pitviper regress --help`)", path);
        return STATUS_BAD_VALUE;
    }
    const Status status = case_read_file(&read, path);
    if (status == STATUS_OK) *out = read;
    return status;
}

bool case_path(char out[case_path_size], char reason[256], const Case *c, const char *name)
{
    char        variable[64];
    const char *rest = name, *before = c->folder, *slash = "/";
    if (strncmp(name, "${", 2) == 0) {
        const char *end = strchr(name, '}');
        if (!end || end - name - 2 >= (long)sizeof variable) {
            snprintf(reason, 256, "%.100s: the ${ is not closed", name);
            return false;
        }
        snprintf(variable, sizeof variable, "%.*s", (int)(end - name - 2), name + 2);
        before = getenv(variable);
        rest = end + 1;
        slash = "";
        if (!before || !*before) {
            snprintf(reason, 256, "%s is not set; it should name the folder of the recordings", variable);
            return false;
        }
    } else if (*name == '/') {
        before = slash = "";
    }
    if (snprintf(out, case_path_size, "%s%s%s", before, slash, rest) < case_path_size) return true;
    snprintf(reason, 256, "%.100s...: the path is too long", name);
    return false;
}

/* Replaces every `from/` at the start of a path, which follows a quote, a comma or a blank, by `to`. */
static Status replace_folder(char **text, const char *from, const char *to)
{
    const size_t length = strlen(from);
    char        *made = NULL;
    size_t       octets;
    FILE        *file = length > 1 ? open_memstream(&made, &octets) : NULL;
    if (length <= 1) return STATUS_OK;
    if (!file) return STATUS_NO_MEMORY;
    for (const char *at = *text; *at; at++) {
        const bool starts = at > *text && strchr("\", '", at[-1]);
        if (starts && strncmp(at, from, length) == 0 && at[length] == '/') {
            fputs(to, file);
            at += length;
        } else {
            fputc(*at, file);
        }
    }
    if (fclose(file) != 0) {
        free(made);
        return STATUS_NO_MEMORY;
    }
    free(*text);
    *text = made;
    return STATUS_OK;
}

bool case_has_scores(const Case *c) { return *c->scores.command || *c->scores.answers; }

Status case_relative(char **text, const Case *c)
{
    const char *data = getenv("PITVIPER_DATA");
    char       *folder = realpath(c->folder, NULL), *shared = data && *data ? realpath(data, NULL) : NULL;
    Status      status = folder ? replace_folder(text, folder, "") : STATUS_OK;
    if (status == STATUS_OK && shared) status = replace_folder(text, shared, "${PITVIPER_DATA}/");
    free(folder);
    free(shared);
    return status;
}

void case_write_keys(FILE *to)
{
    const Case        plain = case_default();
    static const bool none[sizeof keys / sizeof *keys] = {false};
    fputs("# case.yaml of `pitviper regress`: every key with its default, commented out. purpose, frames, and one of\n"
          "# scenario and log are required.\n",
          to);
    settings_write(to, &table, &plain, none);
}
