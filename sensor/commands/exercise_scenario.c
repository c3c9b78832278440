/* sensor/commands/exercise_scenario.c: the scenario that a command names, a file or a bundled one, and its keys of the
 * command line. */
#include "sensor/commands/exercise_scenario_private.h"

#include "pitviper.h"

#include <dirent.h>
#include <stdio.h>
#include <sys/stat.h>

enum { path_size = 4096 };

bool exercise_scenario_set(Scenario *scenario, const char *command, const char *text)
{
    char        key[96];
    const char *equals = strchr(text, '=');
    if (!equals || equals - text >= (long)sizeof key) {
        log_error("%s: --set: '%s' is not KEY=VALUE, for example dis.version=6", command, text);
        return false;
    }
    memcpy(key, text, (size_t)(equals - text));
    key[equals - text] = 0;
    return scenario_set_any(scenario, key, equals + 1, "--set") == STATUS_OK;
}

static bool is_file(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 && !S_ISDIR(about.st_mode);
}

/* Lists the scenarios that come with the program. */
static WordMeant scenario_meant(const char *name)
{
    WordMeant meant = word_meant(name);
    char      folder[path_size];
    DIR      *there = etc_path(folder, sizeof folder, "scenarios") ? opendir(folder) : NULL;
    for (struct dirent *entry; there && (entry = readdir(there));) {
        char  known[256];
        char *dot;
        snprintf(known, sizeof known, "%s", entry->d_name);
        if (!(dot = strrchr(known, '.')) || strcmp(dot, ".yaml") != 0) continue;
        *dot = 0;
        word_consider(&meant, known);
    }
    if (there) closedir(there);
    return meant;
}

/* A file, or the name of a scenario that comes with the program; a folder of that name is neither. */
Status exercise_scenario_read(Scenario *scenario, const char *command, const char *which)
{
    char path[path_size], name[256];
    snprintf(path, sizeof path, "%s", which);
    if (!is_file(path) && !strchr(which, '/') && !strchr(which, '.') && strlen(which) < 200) {
        snprintf(name, sizeof name, "scenarios/%s.yaml", which);
        char bundled[path_size];
        if (!etc_path(bundled, sizeof bundled, name) || !is_file(bundled)) {
            WordMeant meant = scenario_meant(which);
            log_error("%s: there is no file '%s' and no scenario of that name%s `pitviper exercise --help` lists "
                      "them",
                      command, which, *word_hint(&meant) ? meant.hint : ";");
            return STATUS_BAD_VALUE;
        }
        memcpy(path, bundled, sizeof path);
    }
    return scenario_read(scenario, path);
}

double exercise_scenario_epoch(const Scenario *scenario)
{
    static const double undated_unix_s = 1e9;       /* a round time, recognisable as not a date */
    static const double summer_unix_s = 1718992800; /* 2024-06-21 18:00 UTC */
    double              unix_s;
    if (*scenario->dis.date && text_to_unix_s(&unix_s, scenario->dis.date)) return unix_s;
    return scenario->dis.stamps == SCENARIO_STAMPS_ABSOLUTE ? summer_unix_s : undated_unix_s;
}
