/* sensor/verify/regress/case.c: reads case.yaml: its keys, default tolerances and checks. */
#include "sensor/verify/regress/case_private.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

#define AT(member) SETTING_AT(Case, member)

static const Setting keys[] = {
    {"purpose", SETTING_TEXT, AT(purpose), 0, 0, NULL, "", "purpose of the case, in one sentence"},
    {"scenario", SETTING_TEXT, AT(scenario), 0, 0, NULL, "",
     "scenario of `pitviper exercise`: a name, or a YAML file in the case's folder"},
    {"scenario_set", SETTING_TEXT, AT(scenario_set), 0, 0, NULL, "",
     "settings of the scenario: KEY=VALUE, separated by blanks or lines"},
    {"log", SETTING_TEXT, AT(log), 0, 0, NULL, "",
     "recording, in place of a scenario: in the case's folder, or "
     "${PITVIPER_DATA}/..."},
    {"config", SETTING_TEXT, AT(config), 0, 0, NULL, "",
     "settings of `pitviper replay`, indented below `config: |`; paths in them are relative to the case's folder"},
    {"config_file", SETTING_TEXT, AT(config_file), 0, 0, NULL, "",
     "file of settings in the case's folder, in place "
     "of config"},
    {"frames", SETTING_NUMBERS, AT(frames), 0, 999999, NULL, "", "numbers of the frames to compare, as in replay"},
    {"causal", SETTING_BOOL, AT(causal), 0, 1, NULL, "", "replay --causal"},
    {"log_may_be_absent", SETTING_BOOL, AT(log_may_be_absent), 0, 1, NULL, "",
     "a missing log skips the case instead of failing it"},
    {"timeout_s", SETTING_DOUBLE, AT(timeout_s), 0.1, 86400, NULL, "s", "time limit of each process of the case"},
    {"tolerance.range_rel", SETTING_DOUBLE, AT(tolerance.range_rel), 0, 1, NULL, "", "range, relative"},
    {"tolerance.normal", SETTING_DOUBLE, AT(tolerance.normal), 0, 2, NULL, "", "each component of a normal"},
    {"tolerance.temp_k", SETTING_DOUBLE, AT(tolerance.temp_k), 0, 1000, NULL, "K", "surface temperature"},
    {"tolerance.optical_rel", SETTING_DOUBLE, AT(tolerance.optical_rel), 0, 10, NULL, "", "optical radiance, relative"},
    {"tolerance.optical_w_m2_sr", SETTING_DOUBLE, AT(tolerance.optical_w_m2_sr), 0, 1e4, NULL, "W/(m2 sr)",
     "optical radiance, absolute, in addition"},
    {"tolerance.mwir_k", SETTING_DOUBLE, AT(tolerance.mwir_k), 0, 1000, NULL, "K", "apparent temperature"},
    {"tolerance.lwir_k", SETTING_DOUBLE, AT(tolerance.lwir_k), 0, 1000, NULL, "K", "apparent temperature"},
    {"tolerance.radar_db", SETTING_DOUBLE, AT(tolerance.radar_db), 0, 100, NULL, "dB", "radar image"},
    {"tolerance.profile_db", SETTING_DOUBLE, AT(tolerance.profile_db), 0, 100, NULL, "dB", "range profile"},
    {"tolerance.radar_span_db", SETTING_DOUBLE, AT(tolerance.radar_span_db), 1, 200, NULL, "dB",
     "radar: power this far below the brightest counts as zero"},
    {"tolerance.share", SETTING_DOUBLE, AT(tolerance.share), 0, 1, NULL, "",
     "share of pixels that may be beyond tolerance, of temperature and radiance"},
    {"tolerance.edge_share", SETTING_DOUBLE, AT(tolerance.edge_share), 0, 1, NULL, "",
     "share of edge pixels whose ids may differ, with different libraries or ISA"},
    {"tolerance.truth", SETTING_DOUBLE, AT(tolerance.truth), 0, 1e6, NULL, "",
     "factor on the tolerances of truth.jsonl"},
};
static const SettingTable table = {
    .module = "regress", .row = keys, .count = sizeof keys / sizeof *keys, .all_keys = "`pitviper regress --keys`"};

/* Below any significance for a user of the products, above the rounding of sensor/verify/regress/verdict_private.h: a
 * value that crosses from one step to the next is still within. No allowance for threads, ISAs and builds, which give
 * the same bits (tests/system/test_determinism*.sh). */
Case case_default(void)
{
    return (Case){
        .timeout_s = 300,
        .tolerance = {.range_rel = 3e-5,   /* 6 cm in 2 km: two steps of the baseline */
                      .normal = 0.004,     /* 0.2 degree: two steps of the baseline */
                      .temp_k = 0.05,      /* surface temperature: as in the thermal bands */
                      .optical_rel = 0.01, /* a step of the baseline is 0.8 %; the sun 0.1 degree off is 7 x .share */
                      .optical_w_m2_sr = 1e-3, /* half a step of 8 bits on a screen; a dark night */
                      .mwir_k = 0.05,
                      .lwir_k = 0.05, /* NETD of the sensors of this band */
                      .radar_db = 0.1,
                      .profile_db = 0.1,   /* stated accuracy of the radar models: Mie, trihedral */
                      .radar_span_db = 60, /* range of the display */
                      .share = 0.001,      /* 6 pixels of 96 x 64 */
                      .edge_share = 0.02,  /* ISAs of the ray tracer differ in t for 5 % of the rays, in ids for none */
                      .truth = 1}};
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
