/* sensor/commands/terrain_again.c: a terrain store made again of whatever it names, as the user asks for. */
#include "sensor/commands/terrain_again.h"

#include "sensor/node/stop.h"
#include "sensor/settings/next_option.h"
#include "terrain/import/terrain_import.h"

#include <stdlib.h>

static const char help[] =
    "usage: pitviper terrain again STORE\n"
    "\n"
    "Makes a terrain store again with the sources and options that it was made with, which are printed first. A node does\n"
    "that by itself where all of them lie in the store's own folder: a store from elsewhere makes it read no other file.\n";

/* As the file has them, whole or damaged; malloc'd. NULL, logged: none. */
static char *options_of(const char *path)
{
    TerrainStore store;
    const char  *why;
    char        *options = NULL;
    if (store_open_why(&store, &why, path) == STATUS_OK) {
        options = strdup(store.options);
        store_close(&store);
    } else {
        options = store_recall(path);
        if (!options)
            log_error("terrain again: %s: %s; nothing says what it was made of: run `pitviper terrain import`", path, why);
    }
    return options;
}

int terrain_again_command(int argc, char **argv)
{
    if (argc == 2 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0)) {
        fputs(help, stdout);
        return 0;
    }
    if (argc != 2 || argv[1][0] == '-') return wrong_line("terrain", "again takes one STORE");
    char *options = options_of(argv[1]);
    if (!options) return 1;
    stop_by_signals();
    text_print(stdout, "%s", options);
    fflush(stdout);
    const Status status = terrain_store_rebuild(argv[1], options, true);
    free(options);
    if (status != STATUS_OK && stop_asked()) {
        log_warn("terrain again: stopped: %s is as it was", argv[1]);
        return stop_exit_code();
    }
    return status == STATUS_OK ? 0 : 1;
}
