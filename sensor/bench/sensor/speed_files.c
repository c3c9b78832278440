/* sensor/bench/sensor/speed_files.c: the work after a frame: its files; and the memory of the process. */
#include "sensor/bench/sensor/speed_private.h"

#include "sensor/publish/files/frame_files.h"
#include "sensor/publish/images/image_file.h"
#include "terrain/landscape/quick_landscape.h"

#include <stdlib.h>
#include <unistd.h>

typedef struct Encode {
    FrameFiles   files;
    DisplaysOf   shown;
    FrameDisplay display[BAND_COUNT];
    Pool        *pool;
    Arena       *arena;
    Status       status;
    char         hash[sha256_text_size];
} Encode;

static void encode(void *user)
{
    Encode *e = user;
    arena_reset(e->arena);
    e->status = STATUS_OK;
    if (e->files.png) e->status = frame_displays_make(e->display, &e->shown, e->files.request->bands, e->pool, e->arena);
    if (e->status == STATUS_OK) e->status = frame_files_write(e->hash, &e->files, e->pool);
}

/* Values of the file's planes that differ from those of the picture. */
static double differing(const char *out, const Picture *p)
{
    const size_t count = (size_t)p->width * (size_t)p->height;
    char         path[temp_name_size];
    float       *read = malloc(count * sizeof *read);
    double       bad = NAN;
    snprintf(path, sizeof path, "%s/frames/lwir/000000.exr", out);
    if (read && image_read_f32(read, path, "Y") == STATUS_OK) {
        bad = 0;
        for (size_t i = 0; i < count; i++) bad += memcmp(&read[i], &p->lwir[i], sizeof *read) != 0;
    }
    free(read);
    return bad;
}

static void remove_folder(const char *out)
{
    static const char *const parts[] = {"optical", "mwir", "lwir", "truth"};
    char path[temp_name_size];
    for (int k = 0; k < 4; k++)
        for (int e = 0; e < 3; e++) {
            snprintf(path, sizeof path, "%s/frames/%s%s", out, parts[k],
                     e == 0   ? "/000000.exr"
                     : e == 1 ? "/000000.png"
                              : "");
            remove(path);
        }
    snprintf(path, sizeof path, "%s/frames", out);
    remove(path);
    remove(out);
}

Status speed_files(Speed *s)
{
    const Config config = config_default();
    const View   view = trial_view(&s->scene, 600, 100, 40 * rad_per_deg, s->width, s->height);
    const RenderRequest request = speed_request(&view, three_bands, true);
    TrialFrame   frame = speed_frame(s, &s->scene, &request, true);
    Chain       *chain[BAND_COUNT] = {NULL};
    FrameLevel   level[BAND_COUNT] = {{0}};
    char         out[temp_path_size], what[what_size];
    BenchTime    time[2];
    bench_progress(s->bench, "files");
    trial_frame(&frame);
    Status status = frame.status;
    if (status == STATUS_OK && !temp_folder(out)) status = STATUS_IO;
    if (status != STATUS_OK) return status;
    Arena *arena = arena_create();
    if (!arena) return STATUS_NO_MEMORY;
    status = frame_files_prepare(out, three_bands | frame_truth, 0);
    Encode with = {.pool = s->many,
                   .files = {.out = out,
                             .config = &config,
                             .world = &s->scene.world,
                             .picture = &frame.picture,
                             .snapshot = &frame.snapshot,
                             .request = &frame.request,
                             .host = "observer",
                             .config_sha256 = "",
                             .unix_s = s->scene.unix_s,
                             .png = true},
                   .shown = {.config = &config, .picture = &frame.picture, .chain = chain, .level = level},
                   .arena = arena};
    Encode without = with;
    with.files.display = with.display;
    without.files.png  = false;
    const BenchWork work[2] = {{encode, &with, 1}, {encode, &without, 1}};
    if (status == STATUS_OK) bench_time(time, s->bench, work, 2);
    if (status == STATUS_OK) status = with.status != STATUS_OK ? with.status : without.status;
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        snprintf(what, sizeof what, "files of a frame: EXR%s and hash, %s", k ? "" : ", PNG", all_threads);
        BenchRow row    = bench_row_of(what, &time[k], "frames/s", 1);
        row.error       = differing(out, &frame.picture);
        row.error_limit = 0;
        row.error_unit  = "values";
        row.against     = "read again";
        bench_add(s->bench, &row);
    }
    remove_folder(out);
    arena_destroy(arena);
    return status;
}

/* ---- memory ----------------------------------------------------------------------------------- */

void speed_memory(Speed *s)
{
    size_t posts, pyramids;
    quick_landscape_bytes(&posts, &pyramids, &s->landscape.elevation);
    const struct { const char *what; double mb; } rows[] = {
        {"memory: posts", 1e-6 * (double)posts}, {"memory: their pyramid", 1e-6 * (double)pyramids},
        {"memory: arena of a frame", 1e-6 * (double)arena_bytes(s->arena[0])},
        {"memory: resident at the end", bench_memory_mb("VmRSS:")}, {"memory: resident at most", bench_memory_mb("VmHWM:")}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        BenchRow row = bench_row(rows[k].what);
        row.median   = rows[k].mb;
        row.unit     = "MB";
        bench_add(s->bench, &row);
    }
}
