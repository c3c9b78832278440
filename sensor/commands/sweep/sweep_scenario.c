/* sensor/commands/sweep/sweep_scenario.c: axes of a scenario: the exercises of a sweep, each recorded once. */
#include "sensor/commands/sweep/sweep_private.h"

#include "entities/exercise/scenario.h"
#include "pitviper_output.h"
#include "sensor/publish/files/frame_files.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

static const char of_scenario[] = "scenario.";

bool sweep_scenario_key(const char *key) { return strncmp(key, of_scenario, sizeof of_scenario - 1) == 0; }

static const char *scenario_key(const char *key) { return key + sizeof of_scenario - 1; }

ConfigKind sweep_key_kind(const char *key)
{
    SettingType type;
    if (!sweep_scenario_key(key)) return config_kind(key);
    if (!scenario_key_type(&type, scenario_key(key))) return CONFIG_NONE;
    if (type == SETTING_DOUBLE) return CONFIG_NUMBER;
    return type == SETTING_INT || type == SETTING_LONG ? CONFIG_WHOLE : CONFIG_WORD;
}

bool sweep_is_scenario(const char *path)
{
    const char *dot = path ? strrchr(path, '.') : NULL;
    return dot && (strcmp(dot, ".yaml") == 0 || strcmp(dot, ".yml") == 0);
}

Status sweep_scenario_try(const char *scenario, const char *key, const char *value, const char *source)
{
    Scenario tried;
    if (!scenario) {
        log_error(
            "sweep: %s: %s: is of a scenario, and a recording is replayed: `pitviper replay SCENARIO.yaml --sweep "
            "FILE`",
            source, key);
        return STATUS_BAD_VALUE;
    }
    Status status = scenario_read(&tried, scenario);
    if (status != STATUS_OK) return status;
    status = scenario_set_any(&tried, scenario_key(key), value, source);
    scenario_destroy(&tried);
    return status;
}

/* ---- a variant's exercise ------------------------------------------------------------------------------- */

/* `KEY=VALUE` of everything that is set over the file; 0-terminated, one after the other. */
typedef struct Settings {
    int  count;
    char text[sweep_axes_max + 4][sweep_value_size + 100];
} Settings;

static Status gather(Settings *out, Scenario *scenario, const Config *config, const Sweep *sweep, int variant)
{
    char   value[sweep_value_size], source[64];
    Status status = scenario_read(scenario, sweep->scenario);
    out->count = 0;
    if (status != STATUS_OK) return status;
    snprintf(source, sizeof source, "variant %d", variant + 1);
    for (int i = 0; i < sweep->axis_count && status == STATUS_OK; i++) {
        const char *key = sweep->axis[i].key;
        if (!sweep_scenario_key(key)) continue;
        sweep_value(value, sweep, variant, i);
        snprintf(out->text[out->count++], sizeof out->text[0], "%s=%s", scenario_key(key), value);
        status = scenario_set_any(scenario, scenario_key(key), value, source);
    }
    if (status == STATUS_OK && scenario->ground.planted) { /* the ground of the variant's node */
        snprintf(out->text[out->count++], sizeof out->text[0], "ground.seed=%lld", config->seed);
        snprintf(out->text[out->count++], sizeof out->text[0], "ground.relief_m=%.17g", config->terrain.relief_m);
        snprintf(out->text[out->count++], sizeof out->text[0], "ground.spacing_m=%.17g",
                 config->terrain.spacing_m > 0 ? config->terrain.spacing_m : 4);
        snprintf(out->text[out->count++], sizeof out->text[0], "ground.buildings=%s",
                 strcmp(config->terrain.buildings, "invented") == 0 ? "true" : "false");
    }
    return status == STATUS_OK ? scenario_check(scenario) : status;
}

Status sweep_exercise(char name[sweep_name_size], Config *config, const Sweep *sweep, int variant)
{
    char      sha256[sha256_text_size];
    Scenario  scenario = {0};
    Settings *set = calloc(1, sizeof *set);
    *name = 0;
    if (!set) return STATUS_NO_MEMORY;
    if (!sweep->scenario) {
        free(set);
        return STATUS_OK;
    }
    Status status = gather(set, &scenario, config, sweep, variant);
    if (status == STATUS_OK && scenario.ground.planted) {
        if (*config->terrain.place)
            log_error("sweep: terrain.place is that of the scenario, whose ground is invented: leave it out");
        char place[scenario_place_size];
        scenario_place_text(place, &scenario);
        if (*config->terrain.place) status = STATUS_BAD_VALUE;
        else status = config_set(config, "terrain.place", place, "the scenario");
    }
    scenario_destroy(&scenario);
    if (status == STATUS_OK) status = sha256_file(sha256, sweep->scenario);
    Sha256 *digest = status == STATUS_OK ? sha256_begin() : NULL;
    bool    good = digest && sha256_add(digest, sha256, strlen(sha256)) &&
                sha256_add(digest, PITVIPER_VERSION, sizeof PITVIPER_VERSION);
    for (int i = 0; i < set->count && good; i++) good = sha256_add(digest, set->text[i], strlen(set->text[i]) + 1);
    if (status == STATUS_OK) status = digest ? sha256_end(sha256, digest, good) : STATUS_NO_MEMORY;
    if (status == STATUS_OK) snprintf(name, sweep_name_size, "e%.10s", sha256);
    free(set);
    return status;
}

/* Runs `pitviper exercise`, its messages going into a file. Its exit code; -1: not started, or ended by a signal. */
static int record(const char *const argv[], const char *said)
{
    posix_spawn_file_actions_t files;
    pid_t                      process;
    int                        state = 0;
    const int                  log = output_open(said, 0);
    if (log < 0) log_error("sweep: cannot write %s: %s", said, output_reason(errno));
    if (log < 0 || posix_spawn_file_actions_init(&files) != 0) {
        if (log >= 0) close(log);
        return -1;
    }
    const bool ready = posix_spawn_file_actions_adddup2(&files, log, 1) == 0 &&
                       posix_spawn_file_actions_adddup2(&files, log, 2) == 0 &&
                       posix_spawn(&process, "/proc/self/exe", &files, NULL, (char *const *)argv, environ) == 0;
    posix_spawn_file_actions_destroy(&files);
    close(log);
    if (!ready) return -1;
    while (waitpid(process, &state, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(state) ? WEXITSTATUS(state) : -1;
}

Status sweep_exercise_need(char *path, size_t size, const char *out, const char *name, const Config *config,
                           const Sweep *sweep, int variant)
{
    char folder[sweep_path_size], part[sweep_path_size + 64], places[sweep_path_size + 64], said[sweep_path_size + 64];
    const char *argv[2 * (sweep_axes_max + 4) + 16];
    Scenario    scenario = {0};
    Settings   *set = calloc(1, sizeof *set);
    int         n = 0;
    if (!set) return STATUS_NO_MEMORY;
    snprintf(folder, sizeof folder, "%s/exercises", out);
    snprintf(path, size, "%s/%s.pcapng", folder, name);
    snprintf(part, sizeof part, "%s/%s.part.pcapng", folder, name);
    snprintf(places, sizeof places, "%s/%s.csv", folder, name);
    snprintf(said, sizeof said, "%s/%s.txt", folder, name);
    Status status = gather(set, &scenario, config, sweep, variant);
    if (status == STATUS_OK) status = frame_files_folder(folder);
    if (status == STATUS_OK && access(path, R_OK) != 0) {
        const char *const fixed[] = {"pitviper", "exercise", sweep->scenario, "--overwrite", "-o", part};
        for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++) argv[n++] = fixed[i];
        if (scenario.ground.planted) argv[n++] = "--places", argv[n++] = places;
        for (int i = 0; i < set->count; i++) argv[n++] = "--set", argv[n++] = set->text[i];
        argv[n] = NULL;
        if (record(argv, said) != 0) status = STATUS_BAD_VALUE;
        else if (output_rename(part, path) != 0) {
            log_error("sweep: cannot write %s: %s", path, output_reason(errno));
            status = STATUS_IO;
        }
    }
    scenario_destroy(&scenario);
    free(set);
    return status;
}
