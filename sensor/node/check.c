#include "sensor/node/check.h"

#include "sensor/node/host_run.h"
#include "sensor/node/next_option.h"

#include <errno.h>
#include <stdio.h>
#include <unistd.h>

static const char help[] =
    "usage: pitviper check FILE ...\n"
    "       pitviper check --default > node.yaml\n"
    "\n"
    "Reads files of settings as `replay` and `run` would, and says which keys they set, or what is wrong: file, line,\n"
    "key, value and what is accepted. Files that a setting names must be there.\n"
    "\n"
    "  --default          print every key with its default, unit, range and meaning: a file to begin with\n";

/* Settings that hold file names, separated by commas where several may be. */
static bool files_are_there(const char *path, const Config *config)
{
    const struct { const char *key, *value; } named[] = {
        {"terrain.elevation", config->terrain.elevation}, {"terrain.cover", config->terrain.cover},
        {"terrain.orthophoto", config->terrain.orthophoto}, {"terrain.geoid", config->terrain.geoid}};
    bool good = true;
    for (size_t i = 0; i < sizeof named / sizeof *named; i++) {
        char one[sizeof config->terrain.elevation];
        for (const char *at = named[i].value; *at;) {
            const size_t length = strcspn(at, ",");
            snprintf(one, sizeof one, "%.*s", (int)length, at);
            if (*one && access(one, R_OK) != 0) {
                log_error("check: %s: %s: cannot read %s: %s; paths are as seen from the folder you are in", path,
                          named[i].key, one, strerror(errno));
                good = false;
            }
            at += length + (at[length] == ',');
        }
    }
    return good;
}

static bool air_is_there(const Config *config)
{
    Atmosphere *atmosphere = NULL;
    const bool  there =
        atmosphere_open_at(&atmosphere, config->weather.atmosphere, config->weather.visibility_m) == STATUS_OK;
    atmosphere_close(atmosphere);
    return there;
}

static bool check_file(const char *path)
{
    static Run run; /* too large for a stack */
    Config    *config = &run.options.config;
    run  = (Run){0};
    *config = config_default();
    if (config_read(config, path) != STATUS_OK || config_check(config) != STATUS_OK) return false;
    const Config given = *config; /* a preset fills in what it says */
    if (run_prepare(&run) != STATUS_OK || !air_is_there(config) || !files_are_there(path, config)) {
        log_error("check: %s: not good", path);
        return false;
    }
    text_print(stdout, "%s: good\n", path);
    config_write_given(stdout, &given);
    return true;
}

int check_command(int argc, char **argv)
{
    enum { DEFAULT = 1, HELP };
    static const struct option options[] = {{"default", 0, NULL, DEFAULT}, {"help", 0, NULL, HELP}, {NULL, 0, NULL, 0}};
    bool defaults = false, good = true;
    optind = 0;
    for (int option; (option = next_option(argc, argv, "", options)) != -1;) {
        if (option == HELP) {
            fputs(help, stdout);
            return 0;
        }
        if (option == '?') {
            fputs("see `pitviper check --help`\n", stderr);
            return 2;
        }
        defaults = true;
    }
    if (defaults ? optind != argc : optind == argc) {
        fputs("usage: pitviper check FILE ... | --default; see `pitviper check --help`\n", stderr);
        return 2;
    }
    if (defaults) {
        const Config config = config_default();
        config_write(stdout, &config);
    }
    for (int i = optind; i < argc; i++) good &= check_file(argv[i]);
    if (fflush(stdout) != 0) {
        log_error("check: cannot write: %s", strerror(errno));
        return 1;
    }
    return good ? 0 : 1;
}
