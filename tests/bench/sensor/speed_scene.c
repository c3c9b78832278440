/* tests/bench/sensor/speed_scene.c: what the rows of `bench speed` stand on: its options, the ground, and the target
 * that fills a picture. */
#include "tests/bench/suites.h"
#include "pitviper_output.h"

#include "entities/import/model_import.h"
#include "tests/bench/sensor/speed_private.h"
#include "terrain/ground/landscape.h"

#include <errno.h>
#include <stdlib.h>
#include <unistd.h>

/* ---- options ---------------------------------------------------------------------------------- */

/* `12x16`, `720x486`. */
static bool pair_of(double out[2], const Bench *bench, const char *name, double low, double high)
{
    char        first[16];
    const char *text = bench_option(bench, name), *x = text ? strchr(text, 'x') : NULL;
    if (!text) return true;
    bool ok = x && x - text < (long)sizeof first;
    if (ok) {
        memcpy(first, text, (size_t)(x - text));
        first[x - text] = 0;
        ok = text_to_double(&out[0], first) && text_to_double(&out[1], x + 1);
    }
    for (int k = 0; k < 2 && ok; k++) ok = out[k] >= low && out[k] <= high;
    if (!ok) log_error("bench: --%s: '%s' is not AxB with both in %g .. %g", name, text, low, high);
    return ok;
}

static bool sizes_of(double size[2], double ground_km[2], const Bench *bench)
{
    const bool quick = bench_quick(bench);
    size[0] = quick ? 96 : 720, size[1] = quick ? 64 : 486;
    ground_km[0] = quick ? 2 : 12, ground_km[1] = quick ? 8 : 16;
    return pair_of(size, bench, "size", 16, 8192) && pair_of(ground_km, bench, "ground", 1, 32);
}

/* A file of a model is read whole: what is wrong with it is said now. */
static bool model_is_good(const char *file)
{
    Model       model;
    ModelImport report = {0};
    bool        imported;
    if (access(file, R_OK) != 0) {
        log_error("bench: --model: cannot read %s: %s", file, strerror(errno));
        return false;
    }
    if (model_open(&model, &report, &imported, file, 0.01) != STATUS_OK) return false;
    model_destroy(&model);
    return true;
}

Status bench_speed_check(const Bench *bench)
{
    double      size[2], ground_km[2];
    const char *bands = bench_option(bench, "bands"), *model = bench_option(bench, "model");
    if (bands && strcmp(bands, "optical") != 0 && strcmp(bands, "radar") != 0) {
        log_error("bench: --bands: '%s' is not optical (pictures of all bands) or radar; without it both", bands);
        return STATUS_BAD_VALUE;
    }
    return sizes_of(size, ground_km, bench) && (!model || model_is_good(model)) ? STATUS_OK : STATUS_BAD_VALUE;
}

Status speed_open(Speed *s)
{
    double size[2], ground_km[2];
    if (!sizes_of(size, ground_km, s->bench)) return STATUS_BAD_VALUE;
    s->width = (int)size[0];
    s->height = (int)size[1];
    s->east_m = floor(1000 * ground_km[0]);
    s->north_m = floor(1000 * ground_km[1]);
    Status status = pool_create(&s->one, 1);
    if (status == STATUS_OK) status = pool_create(&s->many, bench_threads(s->bench));
    for (int k = 0; k < 3 && status == STATUS_OK; k++)
        if (!(s->arena[k] = arena_create())) status = STATUS_NO_MEMORY;
    return status;
}

void speed_close(Speed *s)
{
    trial_scene_close(&s->close);
    trial_scene_close(&s->scene);
    landscape_destroy(&s->landscape);
    for (int k = 0; k < 3; k++) arena_destroy(s->arena[k]);
    pool_destroy(s->many);
    pool_destroy(s->one);
}

/* ---- the ground ------------------------------------------------------------------------------- */

Status speed_make_ground(Speed *s)
{
    const Geodetic origin = {48 * rad_per_deg, 11 * rad_per_deg, 500};
    double         times_s[2];
    char           what[what_size];
    bench_progress(s->bench, "ground");
    Status status = local_frame_at(&s->frame, &origin);
    if (status == STATUS_OK)
        status = landscape_quick(&s->landscape, times_s, &s->frame, s->east_m, s->north_m, s->many);
    if (status != STATUS_OK) return status;

    const ElevationLevel *level = &s->landscape.elevation.level[0];
    const size_t          posts = (size_t)level->nx * (size_t)level->ny;
    const size_t          stored = elevation_level_stored(level);
    uint16_t              low = 65535, high = 0; /* base 0, shift 0 everywhere */
    for (size_t i = 0; i < stored; i++) {
        low = level->stored[i] < low ? level->stored[i] : low;
        high = level->stored[i] > high ? level->stored[i] : high;
    }
    snprintf(what, sizeof what, "%.0f M posts, heights %.0f m apart", 1e-6 * (double)posts,
             (high - low) * level->step_m);
    BenchRow row = bench_row("ground: posts");
    row.against = what;
    row.median = times_s[0];
    row.unit = "s";
    row.rate = 1e-6 * (double)posts / times_s[0];
    row.rate_unit = "M posts/s";
    bench_add(s->bench, &row);
    row = bench_row("ground: pyramid");
    row.median = times_s[1];
    row.unit = "s";
    row.rate = 1e-6 * (double)posts / times_s[1];
    row.rate_unit = "M posts/s";
    row.error = fabs((double)elevation_highest(level, level->pyramid_count - 1, 0, 0) - high);
    row.error_limit = 0;
    row.error_unit = "posts";
    row.against = "top of the pyramid against the highest post";
    bench_add(s->bench, &row);
    return STATUS_OK;
}

/* ---- the close target ------------------------------------------------------------------------- */

/* Writes a text into a file of this folder. */
static bool write_text(const char *folder, const char *name, const char *format, const char *path)
{
    char text[temp_name_size];
    snprintf(text, sizeof text, "%s/%s", folder, name);
    FILE      *file = output_file(text, 0);
    const bool ok = file && fprintf(file, format, path) > 0;
    return file && fclose(file) == 0 && ok;
}

/* A catalog of one row: --model, else BRL-CAD's K-Tank of the reference data where there is one (+x is forward in it
 * and +z up), else the built-in tank. */
Status speed_open_close(Speed *s)
{
    static const DisEntityType tank = {1, 1, 222, 1, 1, 1, 0};
    static const char *const   files[] = {"catalog.csv", "ktank.yaml"};
    const char                *root = getenv("PITVIPER_DATA"), *file = bench_option(s->bench, "model");
    char                       path[1024], folder[temp_path_size], name[temp_name_size];
    const int  octets = snprintf(path, sizeof path, "%s/models/brlcad/ktank.obj", root ? root : "../shared/data");
    const bool ktank = !file && (size_t)octets < sizeof path && access(path, R_OK) == 0;
    char      *absolute = file || ktank ? realpath(ktank ? path : file, NULL) : NULL;
    if (file && !absolute) {
        log_error("bench: cannot read %s: %s", file, strerror(errno));
        return STATUS_IO;
    }
    bool ok = temp_folder(folder);
    ok = ok && write_text(folder, "ktank.yaml", "file: %s\naxes: +x +z\norigin: auto\n", absolute ? absolute : "none");
    ok = ok && write_text(folder, "catalog.csv", "type,model,origin\n1,%s,base\n",
                          ktank      ? "ktank.yaml"
                          : absolute ? absolute
                                     : "tank");
    snprintf(name, sizeof name, "%s/catalog.csv", folder);
    const Status status = ok ? trial_scene_open(&s->close, &s->landscape, name, &tank, 1, 1) : STATUS_IO;
    for (int k = 0; k < 2; k++) {
        snprintf(name, sizeof name, "%s/%s", folder, files[k]);
        remove(name);
    }
    remove(folder);
    const char *slash = absolute ? strrchr(absolute, '/') : NULL;
    snprintf(s->target, sizeof s->target, "%.60s", ktank ? "BRL-CAD's K-Tank" : slash ? slash + 1 : "built-in tank");
    free(absolute);
    return status;
}
