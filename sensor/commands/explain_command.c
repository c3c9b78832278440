/* sensor/commands/explain_command.c: `pitviper explain OUT FRAME X Y`: what one pixel of a rendered frame is made of.
 */
#include "sensor/commands/commands.h"

#include "pitviper_file.h"
#include "sensor/frame/json_object.h"
#include "sensor/settings/command_line.h"
#include "sensor/verify/explain/explain.h"

#include <dirent.h>
#include <stdlib.h>
#include <sys/stat.h>

enum { path_size = 4096, most_octets = 1 << 29 };

static const char help[] =
    "usage: pitviper explain OUT FRAME X Y [options]\n"
    "\n"
    "Explains one pixel of a rendered frame: its rays, what each met (surface, material, range), its temperature's\n"
    "terms, the light that it emits and reflects, what the air and smoke take and add, and the detector's steps to the\n"
    "displayed grey. The sum of the terms is the pixel's value to the bit: exit code 0, else 1.\n"
    "\n"
    "OUT is a folder of `pitviper replay`, with the frame's file in it (`replay LOG --save-frame FRAME`). X and Y are\n"
    "column and row, from 0 at the top left. The frame is rendered again: neither the log nor elevation files are\n"
    "needed, and tables and models must be those of the frame.\n"
    "\n"
    "  --json               every ray and all figures, as JSON\n"
    "  --threads N          number of threads (default: one per processor)\n"
    "  --force              render with other tables or models too; they are listed\n"
    "  --help               print this help\n";

typedef struct ExplainOptions {
    const char *out;
    int         frame, x, y, threads;
    bool        json, forced;
} ExplainOptions;

/* A whole number in 0 .. 999999999; false, logged: it is none. */
static bool take(int *out, const char *what, const char *text)
{
    long long number;
    if (text_to_long(&number, text) && number >= 0 && number <= 999999999) {
        *out = (int)number;
        return true;
    }
    command_line_wrong("explain", "%s: '%s' is not a whole number in 0 .. 999999999", what, text);
    return false;
}

/* Returns 0 to go on; else the program exits with this code - 1. */
static int parse(ExplainOptions *o, int argc, char **argv)
{
    enum { JSON = 256, THREADS, FORCE, HELP };
    static const struct option options[] = {{"json", 0, NULL, JSON},
                                            {"threads", 1, NULL, THREADS},
                                            {"force", 0, NULL, FORCE},
                                            {"help", 0, NULL, HELP},
                                            {NULL, 0, NULL, 0}};
    *o = (ExplainOptions){.threads = thread_processors()};
    optind = 0; /* start anew */
    for (int option; (option = command_line_option(argc, argv, "h", options)) != -1;) {
        switch (option) {
        case JSON:
            o->json = true;
            break;
        case FORCE:
            o->forced = true;
            break;
        case THREADS:
            if (!command_line_threads(&o->threads, "explain", optarg)) return 1 + 2;
            break;
        case HELP:
        case 'h':
            fputs(help, stdout);
            return 1;
        default:
            return 1 + 2; /* reported by command_line_option */
        }
    }
    if (argc - optind < 4)
        return 1 + command_line_wrong("explain", "OUT FRAME X Y are needed: a folder, a frame, a column and a row");
    if (argc - optind > 4)
        return 1 + command_line_wrong("explain", "one pixel at a time, not also '%s'", argv[optind + 4]);
    o->out = argv[optind];
    return take(&o->frame, "FRAME", argv[optind + 1]) && take(&o->x, "X", argv[optind + 2]) &&
                   take(&o->y, "Y", argv[optind + 3])
               ? 0
               : 1 + 2;
}

/* ---- the frame's file ------------------------------------------------------------------------------ */

/* Frames of OUT/truth.jsonl: whether `frame` is one of them, and the first and last. False: there are none. */
static bool frames_of(bool *has, int first_last[2], const ExplainOptions *o)
{
    char   path[path_size], why[file_why_size], *line = NULL;
    size_t room = 0;
    int    frames = 0;
    *has = false;
    snprintf(path, sizeof path, "%s/truth.jsonl", o->out);
    FILE *from = file_open_stream(why, path);
    while (from && getline(&line, &room, from) > 0) {
        int frame;
        if (sscanf(line, "{\"frame\":%d", &frame) != 1) continue;
        if (frames++ == 0) first_last[0] = frame;
        first_last[1] = frame;
        *has |= frame == o->frame;
    }
    free(line);
    if (from) fclose(from);
    return frames > 0;
}

/* A folder in OUT that has the frame's file: that of one of several hosts. */
static bool find_host(char out[path_size], const ExplainOptions *o)
{
    DIR *folder = opendir(o->out);
    bool found = false;
    for (struct dirent *entry; folder && !found && (entry = readdir(folder));) {
        char path[path_size], why[file_why_size];
        if (entry->d_name[0] == '.') continue;
        if (snprintf(path, sizeof path, "%s/%s/frame_%06d.pvf", o->out, entry->d_name, o->frame) >= (int)sizeof path)
            continue;
        found = file_is_regular(why, path);
        if (found) snprintf(out, path_size, "%.2000s/%.255s", o->out, entry->d_name);
    }
    if (folder) closedir(folder);
    return found;
}

/* Says why there is no frame file, and how to make one. */
static void say_missing(const ExplainOptions *o)
{
    char        path[path_size], host[path_size];
    struct stat there;
    bool        has;
    int         range[2] = {0, 0};
    if (stat(o->out, &there) != 0 || !S_ISDIR(there.st_mode)) {
        log_error("explain: there is no folder '%s'; name one that `pitviper replay LOG --out OUT` wrote", o->out);
        return;
    }
    if (find_host(host, o)) {
        log_error("explain: %s has a folder for each of its hosts; name one of them: %s", o->out, host);
        return;
    }
    snprintf(path, sizeof path, "%s/run.json", o->out);
    json_t *run = json_read_file(path);
    if (!run) {
        log_error(
            "explain: %s is not a folder of products: it has no run.json; name one that `pitviper replay LOG --out "
            "OUT` wrote",
            o->out);
        return;
    }
    const bool any = frames_of(&has, range, o);
    if (any && !has)
        log_error(
            "explain: %s has no frame %d; its frames are %d to %d (`replay --only N --save-frame N` makes another)",
            o->out, o->frame, range[0], range[1]);
    else
        log_error(
            "explain: frame %d was not saved, and a picture alone does not say what it was made from: replay %s "
            "again with the same options and --only %d --save-frame %d --out ANOTHER, then explain ANOTHER %d %d %d",
            o->frame,
            json_object_get(run, "log_sha256") ? "the log" : "its recording (`pitviper run --record LOG` makes one)",
            o->frame, o->frame, o->frame, o->x, o->y);
    json_decref(run);
}

static Status read_frame(SavedFrame *file, char **bytes, const ExplainOptions *o, Arena *arena)
{
    char   path[path_size], why[file_why_size];
    size_t count;
    if (snprintf(path, sizeof path, "%s/frame_%06d.pvf", o->out, o->frame) >= (int)sizeof path ||
        !file_is_regular(why, path)) {
        say_missing(o);
        return STATUS_BAD_VALUE;
    }
    Status status = text_read_file(bytes, &count, "explain", path, most_octets);
    if (status == STATUS_OK) status = saved_frame_parse(file, (const uint8_t *)*bytes, count, path, arena);
    if (status != STATUS_OK) return status;
    const View *view = &file->request.view;
    if (o->x < view->width && o->y < view->height) return STATUS_OK;
    log_error("explain: column %d, row %d is outside the picture of %d x %d: columns are 0 to %d, rows 0 to %d", o->x,
              o->y, view->width, view->height, view->width - 1, view->height - 1);
    return STATUS_BAD_VALUE;
}

int explain_command(int argc, char **argv)
{
    ExplainOptions o;
    char          *bytes = NULL;
    SavedScene    *scene = NULL;
    SavedFrame    *file = NULL;
    Explained     *explained = NULL;
    Pool          *pool = NULL;
    const int      stop = parse(&o, argc, argv);
    if (stop) return stop - 1;
    thread_flush_denormals();
    Arena *arena = arena_create();
    scene = arena ? arena_alloc(arena, 1, sizeof *scene) : NULL;
    file = arena ? arena_alloc(arena, 1, sizeof *file) : NULL;
    explained = arena ? arena_alloc(arena, 1, sizeof *explained) : NULL;
    Status status = scene && file && explained ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK) status = read_frame(file, &bytes, &o, arena);
    if (status == STATUS_OK) status = pool_create(&pool, o.threads);
    if (status == STATUS_OK) status = saved_scene_open(scene, file, o.forced, "avx2", pool);
    if (status == STATUS_OK) status = explain_pixel(explained, file, scene, o.x, o.y, pool, arena);
    if (status == STATUS_OK && o.json) status = explain_print_json(stdout, explained);
    else if (status == STATUS_OK) explain_print(stdout, explained);
    if (status == STATUS_NO_MEMORY) log_error("explain: out of memory");
    const bool good = status == STATUS_OK && explained->wrong == 0 && explained->differ == 0;
    if (explained) explain_close(explained);
    if (scene) saved_scene_close(scene);
    pool_destroy(pool);
    free(bytes);
    arena_destroy(arena);
    return good ? 0 : 1;
}
