/* sensor/publish/files/frame_files.c: the files of one frame, one task per file. */

#include "sensor/publish/files/frame_files.h"
#include "pitviper_output.h"
#include "sensor/settings/publish_choice.h"
#include "sensor/publish/images/image_file.h"
#include "render/frame/picture.h"
#include "render/materials/materials.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { max_jobs = 16 };

/* ---- one frame ------------------------------------------------------------------------------ */

typedef struct FileJob {
    Status (*write)(const FrameFiles *frame, int band);
    int    band; /* BAND_COUNT: truth */
    Status status;
} FileJob;

typedef struct FileJobs {
    const FrameFiles *frame;
    char             *hash;
    Status            hash_status;
    int               count;
    FileJob           job[max_jobs];
} FileJobs;

bool frame_path(char path[frame_path_size], const FrameFiles *frame, const char *folder, const char *name,
                const char *ending)
{
    const int size =
        snprintf(path, frame_path_size, "%s/%s/%s/%06d.%s", frame->out, folder, name, frame->frame, ending);
    if (size >= 0 && size < frame_path_size) return true;
    log_error("out: a path of %d characters is too long; choose another place with --out", size);
    return false;
}

static PlaneSet planes_of(const Config *config)
{
    PlaneSet planes;
    return publish_planes_parse(&planes, config->publish.planes) ? planes : planes_named("", 0); /* it was checked */
}

bool frame_files_truth(const Config *config) { return planes_of(config) != 0; }

/* Lists the planes of one group that go into its file; of truth those in `kept`. */
static int group_planes(FrameArray out[frame_max_planes], const FrameFiles *frame, const char *group, PlaneSet kept)
{
    FrameArray all[frame_max_planes];
    const int  count = frame_planes(all, frame->picture, frame->request);
    int        n = 0;
    for (int i = 0; i < count; i++)
        if (strcmp(all[i].group, group) == 0 && all[i].kind != PLANE_PROFILE &&
            (all[i].kind != PLANE_TRUTH || kept >> plane_find(group, all[i].name) & 1))
            out[n++] = all[i];
    return n;
}

/* Planes of truth that are made for the file. */
typedef struct MadePlanes {
    int    count;
    char   name[planes_most][frame_plane_name_size]; /* of a band: with its name */
    float *values[planes_most];
} MadePlanes;

/* Makes each of `kept` whose band is in the request. STATUS_NO_MEMORY. */
static Status make_planes(MadePlanes *made, const FrameFiles *frame, PlaneSet kept)
{
    const Picture *picture = frame->picture;
    made->count = 0;
    for (int k = 0; k < plane_row_count && picture->material; k++) {
        const PlaneRow *row = &plane_rows[k];
        if (!row->make || !(kept >> k & 1) || !plane_of_bands(row, frame->request->bands, frame->request->optical))
            continue;
        float *values = malloc((size_t)picture->width * (size_t)picture->height * sizeof *values);
        if (!values) return STATUS_NO_MEMORY;
        row->make(values, row, picture, &frame->world->materials);
        if (row->bands)
            snprintf(made->name[made->count], sizeof made->name[0], "%s_%s", row->choice, band_name(plane_band(row)));
        else snprintf(made->name[made->count], sizeof made->name[0], "%s", row->name);
        made->values[made->count++] = values;
    }
    return STATUS_OK;
}

void frame_date(char out[32], double unix_s)
{
    const time_t whole = (time_t)floor(unix_s);
    struct tm    date;
    if (!gmtime_r(&whole, &date) || strftime(out, 32, "%Y:%m:%d %H:%M:%S", &date) == 0)
        strcpy(out, "1970:01:01 00:00:00");
}

/* Ids of the frame's table in order: value k of the entity plane is the k-th. */
static char *entity_ids(const Snapshot *snapshot)
{
    const size_t size = (size_t)snapshot->count * dis_id_text_size + 1;
    char        *text = calloc(size, 1), id[dis_id_text_size];
    if (!text) return NULL;
    for (int i = 0, n = 0; i < snapshot->count; i++) {
        dis_entity_id_text(id, snapshot->entity[i].id);
        n += snprintf(text + n, size - (size_t)n, "%s%s", i ? "," : "", id);
    }
    return text;
}

/* Value k of the material plane is the k-th: without "none", which is 0. */
static char *material_names(const Materials *materials)
{
    const size_t size = (size_t)materials->count * sizeof materials->material->name + 1;
    char        *text = calloc(size, 1);
    for (int i = 1, n = 0; text && i < materials->count; i++)
        n += snprintf(text + n, size - (size_t)n, "%s%s", i > 1 ? "," : "", materials->material[i].name);
    return text;
}

/* Value k of the cover plane is the k-th. */
static char *surface_names(void)
{
    char *text = calloc(SURFACE_COUNT, 64);
    for (int s = 1, n = 0; text && s < SURFACE_COUNT; s++)
        n += snprintf(text + n, 64, "%s%.60s", s > 1 ? "," : "", surface_name((SurfaceClass)s));
    return text;
}

/* `model:part,part,...;model:...` for the models in the frame: value k of the part plane is the k-th part of its
 * entity's model. */
static char *part_names(const FrameFiles *frame)
{
    const Catalog *catalog = frame->world->catalog;
    size_t         size = 1, n = 0;
    for (int m = 0; m < catalog_model_count(catalog); m++)
        size += (size_t)(catalog_model(catalog, m)->part_count + 2) * sizeof(((ModelPart *)0)->name);
    char *text = calloc(size, 1);
    for (int m = 0; text && m < catalog_model_count(catalog); m++) {
        const Model *model = catalog_model(catalog, m);
        bool         here = false; /* in any size: the parts are the same */
        for (int i = 0; i < frame->snapshot->count && catalog_class(catalog, m) == m; i++)
            here |= catalog_class(catalog, frame->snapshot->entity[i].model) == m;
        for (int i = 0; here && i < model->part_count; i++)
            if (i == 0)
                n += (size_t)snprintf(text + n, size - n, "%s%s:%s", n ? ";" : "", model->name, model->part[i].name);
            else n += (size_t)snprintf(text + n, size - n, ",%s", model->part[i].name);
    }
    return text;
}

enum { float_bits = 23 };

/* To the nearest float of so many bits of mantissa: relative error at most 2^-(bits + 1). */
static void round_floats(float *out, const float *in, size_t count, int bits)
{
    const uint32_t low = ((uint32_t)1 << (float_bits - bits)) - 1, infinite = UINT32_C(0xFF) << float_bits;
    for (size_t i = 0; i < count; i++) {
        uint32_t u;
        memcpy(&u, &in[i], sizeof u);
        const bool finite = (u & infinite) != infinite;
        if (finite && ((u + (low >> 1) + 1) & infinite) != infinite) u = (u + (low >> 1) + 1) & ~low;
        memcpy(&out[i], &u, sizeof u);
    }
}

/* Puts rounded copies in place of the floats of the planes: one block, which the caller frees. */
static Status round_planes(float **block, Plane *plane, int planes, int bits)
{
    *block = NULL;
    if (bits >= float_bits || planes == 0) return STATUS_OK;
    const size_t count = (size_t)plane->width * (size_t)plane->height;
    *block = malloc((size_t)planes * count * sizeof **block);
    if (!*block) return STATUS_NO_MEMORY;
    for (int i = 0; i < planes; i++) {
        if (plane[i].type != PLANE_F32) continue;
        round_floats(*block + (size_t)i * count, plane[i].values, count, bits);
        plane[i].values = *block + (size_t)i * count;
    }
    return STATUS_OK;
}

/* Noisy radiance hardly compresses; truth and radar have large uniform areas. Measured through OpenEXR, 720 x 486, a
 * frame of the demonstration, one core, ms of CPU and kB:
 *
 *             truth, 8 planes    lwir       optical, 3    radar
 *     none     15  11206        4  1408     14  4207     9  1408
 *     rle      47   7455        7  1408     22  4207    13  1317
 *     zips:1  265   5842       55  1227    127  3916    21   119
 *     zip:1   337   5496       46  1019    152  3356     9    97
 *     piz     431   5479       90  1017    247  3225    21   238 */
static const char *exr_compression(Band band, int bits)
{
    if (bits < float_bits) return "zip:4"; /* the octets that rounding leaves 0 take no room */
    if (band == BAND_COUNT) return "rle";
    return band == BAND_RADAR ? "zip:1" : "none";
}

static Status write_exr(const FrameFiles *frame, int band)
{
    char           path[frame_path_size], date[32];
    const char    *group = band < BAND_COUNT ? band_name((Band)band) : "truth";
    FrameArray     from[frame_max_planes];
    Plane          plane[frame_max_planes];
    MadePlanes     made = {0};
    ImageAttribute attribute[16];
    char          *ids = NULL, *names = NULL, *parts = NULL, *surfaces = NULL;
    float         *rounded = NULL;
    int            n = 0;
    const int      bits = frame->config->publish.exr_bits;
    const bool     truth = band == BAND_COUNT;
    int            planes = group_planes(from, frame, group, planes_of(frame->config));
    Status         status = truth ? make_planes(&made, frame, planes_of(frame->config)) : STATUS_OK;
    if (status == STATUS_OK && (planes + made.count == 0 || !frame_path(path, frame, "frames", group, "exr")))
        status = STATUS_BAD_VALUE;
    if (status != STATUS_OK) goto done;

    for (int i = 0; i < planes; i++)
        plane[i] = (Plane){from[i].name, from[i].type, frame->picture->width, frame->picture->height, from[i].values};
    for (int i = 0; i < made.count; i++)
        plane[planes++] = plane_f32(made.name[i], frame->picture->width, frame->picture->height, made.values[i]);
    status = round_planes(&rounded, plane, planes, bits);
    if (status != STATUS_OK) goto done;
    if (bits < float_bits) attribute[n++] = image_int("mantissa_bits", bits);
    attribute[n++] = image_string("band", group);
    if (!truth) attribute[n++] = image_string("unit", from->unit);
    if (!truth && from->model) attribute[n++] = image_string("model", from->model);
    if (!truth && from->wavelengths_um) attribute[n++] = image_string("wavelengths_um", from->wavelengths_um);
    attribute[n++] = image_int("frame", frame->frame);
    attribute[n++] = image_double("time_s", frame->time_s);
    attribute[n++] = image_string("host", frame->host);
    attribute[n++] = image_int("seed", (int)frame->config->seed);
    attribute[n++] = image_string("config_sha256", frame->config_sha256);
    if (truth) {
        ids = entity_ids(frame->snapshot);
        names = material_names(&frame->world->materials);
        attribute[n++] = image_string("entity_ids", ids ? ids : "");
        parts = part_names(frame);
        attribute[n++] = image_string("material_names", names ? names : "");
        attribute[n++] = image_string("part_names", parts ? parts : "");
        surfaces = frame->picture->instance ? surface_names() : NULL;
        if (surfaces) attribute[n++] = image_string("surface_names", surfaces);
    }
    frame_date(date, frame->unix_s);
    status = image_write_exr_as(path, exr_compression((Band)band, bits), plane, planes, date, attribute, n);
done:
    for (int i = 0; i < made.count; i++) free(made.values[i]);
    free(rounded);
    free(ids);
    free(names);
    free(parts);
    free(surfaces);
    return status;
}

static Status write_profile(const FrameFiles *frame, int band)
{
    char path[frame_path_size];
    if (!frame_path(path, frame, "profiles", band_name((Band)band), "csv")) return STATUS_BAD_VALUE;
    FILE *file = output_file(path, 0);
    if (!file) {
        log_error("replay: cannot write %s: %s", path, output_reason(errno));
        return STATUS_IO;
    }
    fprintf(file,
            "# range profile, unit relative, model pseudo-radar; a bin is %.9g m, its middle is given\n"
            "range_m,bounce_1,bounce_2,bounce_3\n",
            frame->request->profile_bin_m);
    for (int i = 0; i < frame->request->profile_bins; i++) {
        const double *bin = frame->picture->profile + (size_t)i * radar_bounces;
        fprintf(file, "%.3f,%.6g,%.6g,%.6g\n",
                frame->request->profile_near_m + (i + 0.5) * frame->request->profile_bin_m, bin[0], bin[1], bin[2]);
    }
    const bool ok = !ferror(file);
    if (fclose(file) == 0 && ok) return STATUS_OK;
    log_error("replay: cannot write %s: %s", path, strerror(errno));
    return STATUS_IO;
}

/* Over every plane, whichever planes of truth are written to files. */
static Status hash_planes(char hash[sha256_text_size], const FrameFiles *frame)
{
    FrameView view;
    view.plane_count = frame_planes(view.plane, frame->picture, frame->request);
    *view.sha256 = 0;
    const Status status = frame_sha256(&view);
    memcpy(hash, view.sha256, sha256_text_size);
    return status;
}

/* Task 0 computes the hash, each other one writes a file. */
static void run_job(void *user, int worker, int task)
{
    FileJobs *jobs = user;
    (void)worker;
    if (task == 0) {
        jobs->hash_status = jobs->hash ? hash_planes(jobs->hash, jobs->frame) : STATUS_OK;
        return;
    }
    FileJob *job = &jobs->job[task - 1];
    job->status = job->write(jobs->frame, job->band);
}

static void add_job(FileJobs *jobs, Status (*write)(const FrameFiles *, int), int band)
{
    jobs->job[jobs->count++] = (FileJob){write, band, STATUS_OK};
}

static Status run_jobs(FileJobs *jobs, Pool *pool)
{
    pool_run(pool, jobs->count + 1, run_job, jobs);
    for (int i = 0; i < jobs->count; i++)
        if (jobs->job[i].status != STATUS_OK) return jobs->job[i].status;
    return jobs->hash_status;
}

Status frame_files_write_displays(const FrameFiles *frame, Pool *pool)
{
    FileJobs jobs = {.frame = frame};
    for (int b = 0; b < BAND_COUNT; b++)
        if (frame->request->bands & detector_bands & 1u << b) add_job(&jobs, frame_files_write_display, b);
    return run_jobs(&jobs, pool);
}

Status frame_files_write(char hash[sha256_text_size], const FrameFiles *frame, Pool *pool)
{
    FileJobs jobs = {.frame = frame, .hash = hash};

    const bool truth = frame_files_truth(frame->config);
    if (truth) add_job(&jobs, write_exr, BAND_COUNT); /* the largest first */
    for (int b = 0; b < BAND_COUNT; b++)
        if (frame->request->bands >> b & 1) add_job(&jobs, write_exr, b);
    for (int b = 0; b <= BAND_COUNT; b++) {
        const bool raw = b < BAND_COUNT && frame->raw && frame->display[b].counts[0];
        if ((frame->png || raw) && (b == BAND_COUNT ? truth : frame->request->bands >> b & 1))
            add_job(&jobs, frame_files_write_display, b);
    }
    if (frame->picture->profile) add_job(&jobs, write_profile, BAND_RADAR);
    return run_jobs(&jobs, pool);
}
