/* sensor/commands/sweep/sweep.c: `replay --sweep`: validates every variant, then has one after another made. */
#include "sensor/commands/sweep/sweep_private.h"

#include "pitviper_output.h"
#include "sensor/node/run/stop.h"
#include "sensor/publish/files/frame_files.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

enum { path_size = 4200 };

/* ---- before the first run ------------------------------------------------------------------------- */

static int by_key(const void *a, const void *b) { return strcmp(*(const char *const *)a, *(const char *const *)b); }

/* Names a variant by the values of its axes sorted by key: independent of its number and of the order in the file. */
static Status name_variant(char name[sweep_name_size], const Sweep *sweep, int number)
{
    char  *line[sweep_axes_max], value[sweep_value_size], sha256[sha256_text_size], *text = NULL;
    size_t octets;
    int    lines = 0;
    Status status = STATUS_OK;
    for (; lines < sweep->axis_count && status == STATUS_OK; lines++) {
        sweep_value(value, sweep, number, lines);
        if (asprintf(&line[lines], "%s=%s\n", sweep->axis[lines].key, value) < 0) line[lines] = NULL;
        if (!line[lines]) status = STATUS_NO_MEMORY;
    }
    FILE *all = status == STATUS_OK ? open_memstream(&text, &octets) : NULL;
    if (all) {
        qsort(line, (size_t)lines, sizeof *line, by_key);
        for (int i = 0; i < lines; i++) fputs(line[i], all);
        status = fclose(all) == 0 ? sha256_bytes(sha256, text, octets) : STATUS_NO_MEMORY;
        if (status == STATUS_OK) snprintf(name, sweep_name_size, "v%.10s", sha256);
    } else {
        status = STATUS_NO_MEMORY;
    }
    free(text);
    for (int i = 0; i < lines; i++) free(line[i]);
    return status;
}

/* Writes the command that reproduces the variant, with the options that are not settings but change the products. */
static void write_again(FILE *file, const Options *o, const char *exercise)
{
    char escaped[1024];
    fprintf(file,
            "# A variant of a sweep: what it sets is not commented out.\n"
            "# To reproduce: pitviper replay %s%s%s --config THIS",
            *exercise ? "exercises/" : "LOG", exercise, *exercise ? ".pcapng" : "");
    for (int i = 0; i < o->given_count; i++) {
        const OptionGiven *given = &o->given[i];
        if (given->same_products) continue;
        if (given->argument) text_escape(escaped, sizeof escaped, given->argument, strlen(given->argument));
        fprintf(file, " %s%s%s", given->flag, given->argument ? " " : "", given->argument ? escaped : "");
    }
    fputc('\n', file);
}

/* Writes all settings as the text of settings.yaml, with its hash. */
static Status settings_text_of(char **text, size_t *octets, char sha256[sha256_text_size], const Options *o,
                               const Config *config, const char *exercise)
{
    *text = NULL;
    FILE *file = open_memstream(text, octets);
    if (!file) return STATUS_NO_MEMORY;
    write_again(file, o, exercise);
    config_write_settings(file, config);
    return fclose(file) == 0 ? sha256_bytes(sha256, *text, *octets) : STATUS_NO_MEMORY;
}

static Status try_variant(Variant *variant, const SweepRun *s)
{
    char   words[sweep_words_size], *text = NULL;
    size_t octets;
    Run   *run = calloc(1, sizeof *run); /* too large for a stack */
    if (!run) return STATUS_NO_MEMORY;
    run->options = *s->options;
    Status status = sweep_config(&run->options.config, &s->sweep, &s->options->config, variant->number);
    if (status == STATUS_OK)
        status = sweep_exercise(variant->exercise, &run->options.config, &s->sweep, variant->number);
    if (status == STATUS_OK) status = config_check(&run->options.config);
    if (status == STATUS_OK)
        status = settings_text_of(&text, &octets, variant->settings_sha256, s->options, &run->options.config,
                                  variant->exercise);
    free(text);
    if (status == STATUS_OK) status = run_prepare(run);
    if (status == STATUS_OK) {
        strcpy(variant->config_sha256, run->config_sha256);
        status = name_variant(variant->name, &s->sweep, variant->number);
    } else {
        sweep_settings_words(words, &s->sweep, variant->number, ", ");
        log_error("sweep: in variant %d, %s; nothing has been run", variant->number + 1, words);
    }
    free(run);
    return status;
}

static int by_settings(const void *a, const void *b)
{
    const Variant *x = a, *y = b;
    const int      settings = strcmp(x->settings_sha256, y->settings_sha256);
    return settings ? settings : (x->number > y->number) - (x->number < y->number);
}

static int by_number(const void *a, const void *b)
{
    const Variant *x = a, *y = b;
    return (x->number > y->number) - (x->number < y->number);
}

/* Leaves only the first of equal variants: a list may hold equal values. */
static void drop_repeated(SweepRun *s)
{
    int kept = 0;
    qsort(s->variant, (size_t)s->count, sizeof *s->variant, by_settings);
    for (int i = 0; i < s->count; i++)
        if (i == 0 || strcmp(s->variant[i].settings_sha256, s->variant[kept - 1].settings_sha256) != 0)
            s->variant[kept++] = s->variant[i];
    s->repeated = s->count - kept;
    s->count = kept;
    qsort(s->variant, (size_t)s->count, sizeof *s->variant, by_number);
}

static Status prepare(SweepRun *s)
{
    const Options *o = s->options;
    if (o->host_count > 1) {
        log_error("sweep: only one --host; to vary it, make exercise.host an axis");
        return STATUS_BAD_VALUE;
    }
    const char *const of_one[][2] = {
        {"video", o->config.publish.video}, {"stream", o->config.publish.stream}, {"memory", o->config.publish.memory}};
    for (int i = 0; i < 3; i++)
        if (*of_one[i][1]) {
            log_error("sweep: publish.%s names one place, and variants are many; replay one variant with it",
                      of_one[i][0]);
            return STATUS_BAD_VALUE;
        }
    Status status = sweep_read_of(&s->sweep, o->sweep, &o->config, sweep_is_scenario(o->log) ? o->log : NULL);
    if (status != STATUS_OK) return status;
    s->variant = calloc((size_t)s->sweep.count, sizeof *s->variant);
    if (!s->variant) return STATUS_NO_MEMORY;
    for (s->count = 0; s->count < s->sweep.count && status == STATUS_OK; s->count++) {
        s->variant[s->count].number = s->count;
        status = try_variant(&s->variant[s->count], s);
    }
    if (status == STATUS_OK) drop_repeated(s);
    return status;
}

/* What would fail in every variant, log, host or span, is told once and before anything is written: where no axis is
 * about it, the first variant stands for all. */
static Status look_at_first(const SweepRun *s, SweepLook *look)
{
    if (s->sweep.scenario) return STATUS_OK;
    for (int i = 0; i < s->sweep.axis_count; i++)
        if (strncmp(s->sweep.axis[i].key, "exercise.", 9) == 0 || strcmp(s->sweep.axis[i].key, "sensor.rate_hz") == 0)
            return STATUS_OK;
    Run *run = calloc(1, sizeof *run);
    if (!run) return STATUS_NO_MEMORY;
    run->options = *s->options;
    Status status = sweep_config(&run->options.config, &s->sweep, &s->options->config, s->variant[0].number);
    if (status == STATUS_OK) status = look(run);
    if (status == STATUS_BAD_VALUE || status == STATUS_IO)
        log_error("sweep: so in every variant; nothing has been run");
    run_close(run);
    free(run);
    return status;
}

static bool is_run(const VariantRun *run, const Variant *v)
{
    return strcmp(run->version, PITVIPER_VERSION) == 0 && strcmp(run->config_sha256, v->config_sha256) == 0 &&
           strcmp(run->log_sha256, v->log_sha256) == 0;
}

static bool read_run(VariantRun *out, const char *folder, const char *name)
{
    char path[path_size + 32];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return variant_run_read(out, path);
}

static bool has_coco(const char *folder)
{
    char path[path_size + 32];
    snprintf(path, sizeof path, "%s/coco.json", folder);
    return access(path, R_OK) == 0;
}

/* Refuses when the folder of a variant holds a run of another log, other settings or another version. */
static Status check_folders(const SweepRun *s)
{
    char   folder[path_size];
    Status status = STATUS_OK;
    for (int i = 0; i < s->count && status == STATUS_OK && !s->options->overwrite; i++) {
        const Variant *v = &s->variant[i];
        VariantRun     run;
        snprintf(folder, sizeof folder, "%s/%s", s->options->out, v->name);
        bool other = read_run(&run, folder, "run.json") && run.complete && !is_run(&run, v);
        variant_run_free(&run);
        /* these settings are not in config_sha256: time span and planes */
        if (!other && read_run(&run, folder, "variant.json")) {
            other = strcmp(run.settings_sha256, v->settings_sha256) != 0;
            variant_run_free(&run);
        }
        if (!other) continue;
        log_error("sweep: %s holds a run of another log, other settings or another version; choose another folder "
                  "with --out, "
                  "or --overwrite, which deletes it",
                  folder);
        status = STATUS_BAD_VALUE;
    }
    return status;
}

/* What a variant replays, and its hash; of an exercise that is still to be recorded there is none. */
static Status note_log(SweepRun *s, Variant *v)
{
    if (!s->sweep.scenario) {
        snprintf(v->log, sizeof v->log, "%s", s->options->log);
        if (!*s->log_sha256) {
            const Status status = sha256_file(s->log_sha256, s->options->log);
            if (status != STATUS_OK) return status;
        }
        strcpy(v->log_sha256, s->log_sha256);
        return STATUS_OK;
    }
    if (snprintf(v->log, sizeof v->log, "%s/exercises/%s.pcapng", s->options->out, v->exercise) >= (int)sizeof v->log)
        return STATUS_BAD_VALUE;
    return access(v->log, R_OK) == 0 ? sha256_file(v->log_sha256, v->log) : STATUS_OK;
}

static Status open_products(SweepRun *s)
{
    const Options *o = s->options;
    Status         status = STATUS_OK;
    for (int i = 0; i < s->count && status == STATUS_OK; i++) status = note_log(s, &s->variant[i]);
    if (status == STATUS_OK) status = check_folders(s);
    if (status == STATUS_OK) status = frame_files_folder(o->out);
    if (status == STATUS_OK) status = output_hold("sweep", o->out);
    if (status != STATUS_OK) return status;
    status = sweep_manifest_begin(s);
    return status == STATUS_OK ? coco_merge_open(&s->coco, o->out) : status;
}

/* ---- one variant ------------------------------------------------------------------------------ */

/* Whether the folder holds a complete run of these settings; its run.json is then in the outcome. */
static bool is_kept(Outcome *outcome, const Variant *v, const char *folder, bool coco)
{
    VariantRun variant, run;
    const bool whole = read_run(&variant, folder, "variant.json") && is_run(&variant, v) &&
                       strcmp(variant.settings_sha256, v->settings_sha256) == 0 && (!coco || has_coco(folder));
    const bool kept = read_run(&run, folder, "run.json") && whole && is_run(&run, v) && run.complete;
    variant_run_free(&variant);
    if (kept) *outcome = (Outcome){.status = "kept", .has_run = true, .run = run};
    else variant_run_free(&run);
    return kept;
}

static Status write_file(const char *path, const char *text, size_t octets)
{
    FILE *file = output_begin(path, 0);
    if (file) fwrite(text, 1, octets, file);
    if (file && output_end(file, path)) return STATUS_OK;
    log_error("sweep: cannot write %s: %s", path, output_reason(errno));
    return STATUS_IO;
}

/* Has the variant made. Returns its exit code; -1: ended by a signal, or not started. */
static int run_variant(SweepRun *s, const Variant *v, const char *folder)
{
    Options    *o = malloc(sizeof *o);
    char        settings[path_size + 32], said[path_size + 32];
    const char *argv[options_variant_argv];
    snprintf(settings, sizeof settings, "%s/settings.yaml", folder);
    snprintf(said, sizeof said, "%s/log.txt", folder);
    if (!o) return -1;
    *o = *s->options;
    o->log = v->log;
    options_variant(argv, o, settings, folder);
    const int code = sweep_worker_make(&s->worker, said, argv);
    free(o);
    return code;
}

/* Finds the last error that the run logged. */
static void find_reason(char *why, size_t size, const char *folder, int code)
{
    const char *const head = log_head(LOG_ERROR);
    char              path[path_size + 32], *text = NULL;
    size_t            octets;
    if (code >= 0) snprintf(why, size, "exit code %d", code);
    else snprintf(why, size, "ended by a signal, or could not be started");
    snprintf(path, sizeof path, "%s/log.txt", folder);
    if (access(path, R_OK) != 0 || text_read_file(&text, &octets, "sweep", path, 1 << 24) != STATUS_OK) return;
    for (char *line = text, *end; *line; line = end) {
        end = line + strcspn(line, "\n");
        if (strncmp(line, head, strlen(head)) == 0)
            text_escape(why, size, line + strlen(head), (size_t)(end - line) - strlen(head));
        end += *end == '\n';
    }
    free(text);
}

/* Writes the settings file, which must read back as the settings that were validated. */
static Status write_settings(const char *path, const Options *o, const Variant *v, const Config *config)
{
    char    sha256[sha256_text_size], *text = NULL, *again = NULL;
    size_t  octets;
    Config *back = malloc(sizeof *back);
    Status  status = back ? settings_text_of(&text, &octets, sha256, o, config, v->exercise) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) {
        *back = config_default();
        status = write_file(path, text, octets);
    }
    if (status == STATUS_OK) status = config_read(back, path);
    if (status == STATUS_OK) status = settings_text_of(&again, &octets, sha256, o, back, v->exercise);
    if (status == STATUS_OK && strcmp(sha256, v->settings_sha256) != 0) {
        const char *key = config_difference(config, back);
        log_error("sweep: %s: %s: a configuration file cannot hold this value (it does not read back equal); choose "
                  "another",
                  path, key ? key : "a setting");
        status = STATUS_BAD_VALUE;
    }
    free(back);
    free(text);
    free(again);
    return status;
}

static void make_variant(Outcome *outcome, SweepRun *s, const Variant *v, const char *folder, const Config *config)
{
    char path[path_size + 32];
    *outcome = (Outcome){.status = "failed"};
    if (frame_files_folder(folder) != STATUS_OK) {
        snprintf(outcome->why, sizeof outcome->why, "its folder cannot be written");
        return;
    }
    snprintf(path, sizeof path, "%s/variant.json", folder);
    output_remove(path);
    snprintf(path, sizeof path, "%s/settings.yaml", folder);
    if (write_settings(path, s->options, v, config) != STATUS_OK) {
        snprintf(outcome->why, sizeof outcome->why, "its settings cannot be written or read back");
        return;
    }
    const double begun_s = wall_clock_s();
    const int    code = run_variant(s, v, folder);
    outcome->seconds = wall_clock_s() - begun_s;
    outcome->has_run = code == 0 && read_run(&outcome->run, folder, "run.json");
    if (stop_asked() && code != 0) {
        *outcome = (Outcome){.status = "stopped", .seconds = outcome->seconds};
        return;
    }
    if (outcome->has_run && is_run(&outcome->run, v)) outcome->status = "made";
    else if (code == 0) snprintf(outcome->why, sizeof outcome->why, "run.json is not of these settings and this log");
    else find_reason(outcome->why, sizeof outcome->why, folder, code);
}

/* Runs the variant, or keeps the run in its folder. */
static Status make_or_keep(Outcome *outcome, SweepRun *s, Variant *v, const char *folder)
{
    Config *config = malloc(sizeof *config);
    Status  status = config ? sweep_config(config, &s->sweep, &s->options->config, v->number) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = sweep_exercise(v->exercise, config, &s->sweep, v->number);
    if (status == STATUS_OK && s->sweep.scenario && !*v->log_sha256) {
        status = sweep_exercise_need(v->log, sizeof v->log, s->options->out, v->exercise, config, &s->sweep, v->number);
        if (status == STATUS_OK) status = sha256_file(v->log_sha256, v->log);
        if (status == STATUS_BAD_VALUE) { /* of this variant alone */
            *outcome = (Outcome){.status = "failed"};
            snprintf(outcome->why, sizeof outcome->why, "its exercise cannot be made: exercises/%s.txt", v->exercise);
            free(config);
            return STATUS_OK;
        }
    }
    if (status == STATUS_OK && !is_kept(outcome, v, folder, config->publish.coco))
        make_variant(outcome, s, v, folder, config);
    free(config);
    return status;
}

static Status one_variant(SweepRun *s, int place)
{
    Variant *v = &s->variant[place];
    char     folder[path_size], path[path_size + 32];
    Outcome  outcome;
    if (snprintf(folder, sizeof folder, "%s/%s", s->options->out, v->name) >= (int)sizeof folder)
        return STATUS_BAD_VALUE;
    Status status = make_or_keep(&outcome, s, v, folder);
    if (status != STATUS_OK) return status;
    s->stopped = strcmp(outcome.status, "stopped") == 0;
    s->made += strcmp(outcome.status, "made") == 0;
    s->kept += strcmp(outcome.status, "kept") == 0;
    s->failed += strcmp(outcome.status, "failed") == 0;
    sweep_report_variant(s, v, &outcome, place);

    char *text = sweep_manifest_line(s, v, &outcome);
    if (!text) status = STATUS_NO_MEMORY;
    if (text && (fprintf(s->manifest, "%s\n", text) < 0 || fflush(s->manifest) != 0)) {
        log_error("sweep: cannot write %s/manifest.jsonl: %s", s->options->out, strerror(errno));
        status = STATUS_IO;
    }
    if (status == STATUS_OK && strcmp(outcome.status, "made") == 0) {
        snprintf(path, sizeof path, "%s/variant.json", folder);
        status = write_file(path, text, strlen(text));
    }
    free(text);
    if (status == STATUS_OK && outcome.has_run && has_coco(folder)) status = coco_merge_add(s->coco, v->name);
    variant_run_free(&outcome.run);
    return status;
}

static Status run_all(SweepRun *s)
{
    Status status = open_products(s);
    if (status == STATUS_OK && s->repeated > 0)
        log_print("%d variant%s left out: equal to others\n", s->repeated, s->repeated == 1 ? "" : "s");
    for (int i = 0; i < s->count && status == STATUS_OK && !s->stopped; i++) {
        s->stopped = stop_asked();
        if (!s->stopped) status = one_variant(s, i);
    }
    sweep_worker_end(&s->worker);
    const Status ended = sweep_manifest_end(s);
    if (status == STATUS_OK) status = ended;
    const Status merged = coco_merge_close(s->coco, status == STATUS_OK);
    if (status == STATUS_OK) status = merged;
    if (s->stopped)
        log_warn("sweep: stopped with %d of %d variants made; the same command resumes "
                 "it",
                 s->made + s->kept, s->count);
    if (status == STATUS_OK)
        log_print("%d variants in %s: %d made, %d kept, %d failed; see "
                  "manifest.html\n",
                  s->count, s->options->out, s->made, s->kept, s->failed);
    return status;
}

int sweep_replay(const Options *options, SweepLook *look)
{
    SweepRun     s = {.options = options};
    const Status tried = prepare(&s);
    Status       status = tried == STATUS_OK ? look_at_first(&s, look) : tried;
    if (status == STATUS_OK) status = run_all(&s);
    if (status == STATUS_NO_MEMORY) log_error("sweep: out of memory");
    free(s.variant);
    sweep_close(&s.sweep);
    if (tried == STATUS_BAD_VALUE) return 2;
    if (status == STATUS_OK && s.stopped) return stop_exit_code();
    return status != STATUS_OK || s.failed > 0;
}
