#include "sensor/node/frame_files.h"

#include "sensor/detector/colour.h"
#include "sensor/detector/noise3d.h"
#include "sensor/detector/quantise.h"
#include "sensor/settings/plane_choice.h"
#include "sensor/publish/image_file.h"
#include "sensor/publish/truth_preview.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { path_size = 4096, max_planes = 24, max_jobs = 16 };

/* Bands whose pictures come from a detector. */
static const unsigned detector_bands = 1u << BAND_OPTICAL | 1u << BAND_MWIR | 1u << BAND_LWIR;

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

static void frame_path(char path[path_size], const FrameFiles *frame, const char *folder, const char *name,
                       const char *ending)
{
    snprintf(path, path_size, "%s/%s/%s/%06d.%s", frame->out, folder, name, frame->frame, ending);
}

static unsigned planes_of(const Config *config)
{
    unsigned planes;
    return plane_choice_parse(&planes, config->publish.planes) ? planes : planes_all; /* it was checked */
}

bool frame_files_truth(const Config *config) { return planes_of(config) != planes_none; }

/* The planes of one band, with the names of their channels; of truth those in `kept`. */
static int band_planes(Plane plane[max_planes], const FrameFiles *frame, int band, unsigned kept)
{
    const Picture *p = frame->picture;
    static const char *const rgb[3] = {"R", "G", "B"}, *const normal[3] = {"nx", "ny", "nz"};
    const int w = p->width, h = p->height;
    int       n = 0;
    switch (band) {
    case BAND_OPTICAL:
        for (int c = 0; c < 3 && p->optical[c]; c++) plane[n++] = plane_f32(p->optical[1] ? rgb[c] : "Y", w, h, p->optical[c]);
        break;
    case BAND_MWIR: plane[n++] = plane_f32("Y", w, h, p->mwir); break;
    case BAND_LWIR: plane[n++] = plane_f32("Y", w, h, p->lwir); break;
    case BAND_RADAR: plane[n++] = plane_f32("Y", w, h, p->radar); break;
    default:
        if (kept >> PLANE_RANGE & 1) plane[n++] = plane_f32("range_m", w, h, p->range_m);
        if (kept >> PLANE_ENTITY & 1) plane[n++] = plane_u32("entity", w, h, p->entity);
        if (kept >> PLANE_PART & 1) plane[n++] = plane_u32("part", w, h, p->part);
        if (kept >> PLANE_MATERIAL & 1) plane[n++] = plane_u32("material", w, h, p->material);
        if (kept >> PLANE_TEMPERATURE & 1) plane[n++] = plane_f32("temp_k", w, h, p->temp_k);
        for (int k = 0; k < 3 && kept >> PLANE_NORMAL & 1; k++) plane[n++] = plane_f32(normal[k], w, h, p->normal[k]);
    }
    return n;
}

static void date_time(char out[32], double unix_s)
{
    const time_t whole = (time_t)floor(unix_s);
    struct tm    date;
    if (!gmtime_r(&whole, &date) || strftime(out, 32, "%Y:%m:%d %H:%M:%S", &date) == 0) strcpy(out, "1970:01:01 00:00:00");
}

/* Ids of the frame's table in order, so that value k of the entity plane is the k-th. */
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

/* `model:part,part,...;model:...` for the models that the frame holds: value k of the part plane is the k-th
 * part of its entity's model. */
static char *part_names(const FrameFiles *frame)
{
    const Catalog *catalog = frame->world->catalog;
    size_t         size = 1, n = 0;
    for (int m = 0; m < catalog_model_count(catalog); m++)
        size += (size_t)(catalog_model(catalog, m)->part_count + 2) * sizeof(((ModelPart *)0)->name);
    char *text = calloc(size, 1);
    for (int m = 0; text && m < catalog_model_count(catalog); m++) {
        const Model *model = catalog_model(catalog, m);
        bool         here  = false; /* in any size: the parts are the same */
        for (int i = 0; i < frame->snapshot->count && catalog_class(catalog, m) == m; i++)
            here |= catalog_class(catalog, frame->snapshot->entity[i].model) == m;
        for (int i = 0; here && i < model->part_count; i++)
            if (i == 0)
                n += (size_t)snprintf(text + n, size - n, "%s%s:%s", n ? ";" : "", model->name, model->part[i].name);
            else
                n += (size_t)snprintf(text + n, size - n, ",%s", model->part[i].name);
    }
    return text;
}

static Status write_exr(const FrameFiles *frame, int band)
{
    char           path[path_size], date[32];
    Plane          plane[max_planes];
    ImageAttribute attribute[16];
    char          *ids = NULL, *names = NULL, *parts = NULL;
    int            n   = 0;
    const int      planes = band_planes(plane, frame, band, planes_of(frame->config));

    attribute[n++] = image_string("band", band < BAND_COUNT ? band_name((Band)band) : "truth");
    if (band < BAND_COUNT) attribute[n++] = image_string("unit", band == BAND_RADAR ? "relative" : "W/(m2 sr)");
    if (band == BAND_RADAR) attribute[n++] = image_string("model", "pseudo-radar");
    if (band == BAND_OPTICAL) /* what the planes see, um; in the order of their names */
        attribute[n++] = image_string("wavelengths_um", frame->request->optical == OPTICAL_RGB   ? "R 0.6-0.7, G 0.5-0.6, B 0.4-0.5"
                                                        : frame->request->optical == OPTICAL_NIR
                                                            ? channel_in(SPECTRAL_NIR)->edges_um
                                                            : channel_in(SPECTRAL_PAN)->edges_um);
    attribute[n++] = image_int("frame", frame->frame);
    attribute[n++] = image_double("time_s", frame->time_s);
    attribute[n++] = image_string("host", frame->host);
    attribute[n++] = image_int("seed", (int)frame->config->seed);
    attribute[n++] = image_string("config_sha256", frame->config_sha256);
    if (band == BAND_COUNT) {
        ids            = entity_ids(frame->snapshot);
        names          = material_names(&frame->world->materials);
        attribute[n++] = image_string("entity_ids", ids ? ids : "");
        parts          = part_names(frame);
        attribute[n++] = image_string("material_names", names ? names : "");
        attribute[n++] = image_string("part_names", parts ? parts : "");
    }
    date_time(date, frame->unix_s);
    frame_path(path, frame, "frames", band < BAND_COUNT ? band_name((Band)band) : "truth", "exr");
    const Status status = image_write_exr(path, plane, planes, date, attribute, n);
    free(ids);
    free(names);
    free(parts);
    return status;
}

/* The planes that a band's detector looks at; how many. */
static int band_radiance(const float *plane[3], const Picture *p, int band)
{
    int n = 0;
    if (band == BAND_MWIR || band == BAND_LWIR) {
        plane[0] = band == BAND_MWIR ? p->mwir : p->lwir;
        return plane[0] != NULL;
    }
    while (band == BAND_OPTICAL && n < 3 && p->optical[n]) {
        plane[n] = p->optical[n];
        n++;
    }
    return n;
}

static double mean_radiance(const Picture *picture, int band)
{
    const float *plane[3];
    const size_t count  = (size_t)picture->width * (size_t)picture->height;
    const int    planes = band_radiance(plane, picture, band);
    double       sum    = 0;
    for (int c = 0; c < planes; c++)
        for (size_t i = 0; i < count; i++) sum += plane[c][i];
    return planes ? fmax(0, sum / ((double)count * planes)) : 0;
}

/* Without a sensor: a share of the picture's mean in each optical channel. */
static double optical_sigma(const Picture *picture, const Config *config)
{
    return config->detector.noise * config->detector.noise_optical * mean_radiance(picture, BAND_OPTICAL);
}

void frame_expose(TruthNoise *noise, Chain *const chain[BAND_COUNT], const Picture *picture, const Config *config)
{
    const float *plane[3];
    *noise = (TruthNoise){.netd_mwir_k = config->detector.noise * config->detector.netd_mwir_k,
                          .netd_lwir_k = config->detector.noise * config->detector.netd_lwir_k};
    for (int b = 0; b < BAND_COUNT; b++)
        if (chain[b] && band_radiance(plane, picture, b)) chain_expose(chain[b], plane);
    noise->optical_w_m2_sr = optical_sigma(picture, config);
    if (chain[BAND_OPTICAL])
        noise->optical_w_m2_sr = chain_sigma(chain[BAND_OPTICAL], 0, mean_radiance(picture, BAND_OPTICAL));
    for (int b = BAND_MWIR; b <= BAND_LWIR; b++) {
        double      *netd_k = b == BAND_MWIR ? &noise->netd_mwir_k : &noise->netd_lwir_k, low_m, high_m, slope;
        const double mean   = mean_radiance(picture, b);
        if (!chain[b] || !(mean > 0)) continue;
        preset_band(&low_m, &high_m, (Band)b, OPTICAL_PAN, -1);
        planck_band(low_m, high_m, planck_band_inverse(low_m, high_m, mean), &slope);
        *netd_k = chain_sigma(chain[b], 0, mean) / slope;
    }
}

/* What the display of one band shows: gain and level, quantisation; and noise, without a sensor. In radiance, or
 * in counts of the band's sensor. */
static DetectorConfig detector_of(const FrameFiles *frame, int band)
{
    const Config  *c     = frame->config;
    const Chain   *chain = frame->chain[band];
    DetectorConfig d     = detector_default_config();
    d.bits               = c->detector.bits;
    d.gain               = c->detector.gain;
    d.offset             = c->detector.offset;
    d.auto_level         = strcmp(c->detector.level, "auto") == 0;
    if (band == BAND_OPTICAL) {
        d.display_gamma = true;
        if (!chain) d.min_span = 1e-3; /* W/(m2 sr): grey things under some 4 lux; a night shows as one */
        d.noise_sigma   = optical_sigma(frame->noise_of ? frame->noise_of : frame->picture, c);
        d.level_low     = 0;
        d.level_high    = c->detector.optical_high_w_m2_sr;
    } else {
        const bool   mwir = band == BAND_MWIR;
        double       low_m, high_m, slope; /* W/(m2 sr K) at 300 K, where the figure is defined */
        preset_band(&low_m, &high_m, (Band)band, OPTICAL_PAN, -1);
        const double at_300_k = planck_band(low_m, high_m, 300, &slope);
        d.noise_sigma = c->detector.noise * slope * (mwir ? c->detector.netd_mwir_k : c->detector.netd_lwir_k);
        d.min_span    = 2 * slope; /* never stretch less than 2 K over the screen */
        d.level_low   = planck_band(low_m, high_m, mwir ? c->detector.mwir_low_k : c->detector.lwir_low_k, NULL);
        d.level_high  = planck_band(low_m, high_m, mwir ? c->detector.mwir_high_k : c->detector.lwir_high_k, NULL);
        if (chain)
            d.min_span = chain_counts_at(chain, 0, at_300_k + d.min_span) - chain_counts_at(chain, 0, at_300_k);
    }
    if (chain) {
        d.level_low  = chain_counts_at(chain, 0, d.level_low);
        d.level_high = chain_counts_at(chain, 0, d.level_high);
    }
    return d;
}

/* White balance of this frame's day, in radiance or in counts. Photons of a band are in proportion to its radiance, so
 * white is asked for at a radiance that any sensor can count. */
static DisplayColour colour_of(const FrameFiles *frame)
{
    const Chain  *chain = frame->chain[BAND_OPTICAL];
    const double *white = frame->picture->white_w_m2_sr, mean = (white[0] + white[1] + white[2]) / 3;
    DisplayColour colour;
    if (!chain || !(mean > 0)) {
        display_colour(&colour, white, chain ? chain_counts_at(chain, 0, 0) : 0, INFINITY);
        return colour;
    }
    const double zero = chain_counts_at(chain, 0, 0);
    double       counts[3];
    for (int c = 0; c < 3; c++) counts[c] = chain_counts_at(chain, c, white[c] / mean) - zero;
    display_colour(&colour, counts, zero, chain_full(chain) - zero);
    return colour;
}

static Status write_raw(const FrameFiles *frame, int band, int planes)
{
    const Chain *chain = frame->chain[band];
    const int    w     = frame->picture->width, h = frame->picture->height;
    const size_t count = (size_t)w * (size_t)h;
    char         path[path_size];
    frame_path(path, frame, "raw", band_name((Band)band), "png");
    if (planes == 1) return image_write_png(path, chain_counts(chain, 0), w, h, 1, 16);
    uint16_t *rgb = malloc(3 * count * sizeof *rgb);
    if (!rgb) return STATUS_NO_MEMORY;
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < count; i++) rgb[3 * i + (size_t)c] = chain_counts(chain, c)[i];
    const Status status = image_write_png(path, rgb, w, h, 3, 16);
    free(rgb);
    return status;
}

/* One task a band at a time, frame after frame: the level's memory is its own. */
static DetectorLevel follow_level(const FrameFiles *frame, int band, const DetectorConfig *detector, DetectorLevel now)
{
    FrameLevel *state = &frame->level[band];
    if (!detector->auto_level) return now;
    if (!state->known) state->level = now;
    detector_level_follow(&state->level, now, frame->time_s - state->time_s, frame->config->detector.agc_s);
    state->known  = true;
    state->time_s = frame->time_s;
    return state->level;
}

/* Runs the band's detector; display picture and raw counts, as asked for. */
static Status write_png(const FrameFiles *frame, int band)
{
    char           path[path_size];
    const Picture *p      = frame->picture;
    const size_t   count  = (size_t)p->width * (size_t)p->height;
    const int      bits   = band == BAND_COUNT ? 8 : frame->config->detector.bits;
    const bool     rgb    = band == BAND_COUNT || (band == BAND_OPTICAL && p->optical[1]);
    Chain         *chain  = band < BAND_COUNT ? frame->chain[band] : NULL;
    uint8_t       *shown  = malloc(count * 6);
    float         *noisy  = malloc(count * 3 * sizeof *noisy);
    Status         status = STATUS_NO_MEMORY;
    if (!shown || !noisy) goto done;
    status = STATUS_OK;

    if (band == BAND_COUNT) {
        truth_preview(shown, p->range_m, p->entity, p->normal[2], count, frame->snapshot);
    } else if (band == BAND_RADAR) {
        detector_display_db(shown, p->radar, count, detector_radar_range_db, bits);
    } else {
        const float         *in[3] = {NULL, NULL, NULL}, *out[3] = {noisy, noisy + count, noisy + 2 * count};
        const int            planes   = band_radiance(in, p, band);
        DetectorConfig       detector = detector_of(frame, band);
        if (chain) {
            chain_run(chain, in, &p->small, frame->frame, frame->rate_px_s);
            for (int c = 0; c < planes; c++) out[c] = chain_values(chain, c);
            if (frame->config->detector.raw) status = write_raw(frame, band, planes);
        } else {
            for (int c = 0; c < planes; c++)
                detector_noise(noisy + (size_t)c * count, in[c], 0, count, detector.noise_sigma,
                               (uint64_t)frame->config->seed, (uint32_t)(3 * band + c), (uint32_t)frame->frame);
        }
        if (rgb) {
            float *const        coloured[3] = {noisy, noisy + count, noisy + 2 * count};
            const DisplayColour colour      = colour_of(frame);
            display_colour_apply(coloured, out, count, &colour);
            for (int c = 0; c < 3; c++) out[c] = coloured[c];
            /* counts of white whose bands' mean is 1 W/(m2 sr) */
            if (chain && colour.white > 0)
                detector.level_high = colour.zero + colour.white * frame->config->detector.optical_high_w_m2_sr;
        }
        const DetectorLevel level = follow_level(frame, band, &detector, detector_level(&detector, out, planes, count));
        frame->level[band].shown  = level;
        if (rgb)
            detector_display_rgb(shown, out, count, &detector, level);
        else
            detector_display(shown, out[0], count, &detector, level);
    }
    if (frame->png && status == STATUS_OK) {
        frame_path(path, frame, "frames", band < BAND_COUNT ? band_name((Band)band) : "truth", "png");
        status = image_write_png(path, shown, p->width, p->height, rgb ? 3 : 1, bits);
    }

done:
    free(shown);
    free(noisy);
    return status;
}

static Status write_profile(const FrameFiles *frame, int band)
{
    char path[path_size];
    (void)band;
    frame_path(path, frame, "profiles", "radar", "csv");
    FILE *file = fopen(path, "w");
    if (!file) {
        log_error("replay: cannot write %s: %s", path, strerror(errno));
        return STATUS_IO;
    }
    fprintf(file, "# range profile, unit relative, model pseudo-radar; a bin is %.9g m, its middle is given\n"
                  "range_m,bounce_1,bounce_2,bounce_3\n", frame->request->profile_bin_m);
    for (int i = 0; i < frame->request->profile_bins; i++) {
        const double *bin = frame->picture->profile + (size_t)i * radar_bounces;
        fprintf(file, "%.3f,%.6g,%.6g,%.6g\n", frame->request->profile_near_m + (i + 0.5) * frame->request->profile_bin_m,
                bin[0], bin[1], bin[2]);
    }
    const bool ok = !ferror(file);
    if (fclose(file) == 0 && ok) return STATUS_OK;
    log_error("replay: cannot write %s: %s", path, strerror(errno));
    return STATUS_IO;
}

static Status hash_planes(char hash[sha256_text_size], const FrameFiles *frame)
{
    Plane plane[max_planes];
    char  name[max_planes][32];
    int   planes = 0;
    for (int b = 0; b <= BAND_COUNT; b++) {
        if (b < BAND_COUNT && !(frame->request->bands >> b & 1)) continue;
        const int added = band_planes(plane + planes, frame, b, planes_all); /* whatever is kept */
        for (int i = planes; i < planes + added; i++) {
            snprintf(name[i], sizeof name[i], "%s/%s", b < BAND_COUNT ? band_name((Band)b) : "truth", plane[i].name);
            plane[i].name = name[i];
        }
        planes += added;
    }
    if (frame->picture->profile) {
        strcpy(name[planes], "radar/profile");
        plane[planes] = plane_f64(name[planes], radar_bounces, frame->request->profile_bins, frame->picture->profile);
        planes++;
    }
    return plane_hash(hash, plane, planes);
}

/* Task 0 hashes, each other one writes a file. */
static void run_job(void *user, int worker, int task)
{
    FileJobs *jobs = user;
    (void)worker;
    if (task == 0) {
        jobs->hash_status = jobs->hash ? hash_planes(jobs->hash, jobs->frame) : STATUS_OK;
        return;
    }
    FileJob *job = &jobs->job[task - 1];
    job->status  = job->write(jobs->frame, job->band);
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
        if (frame->request->bands & detector_bands & 1u << b) add_job(&jobs, write_png, b);
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
        const bool raw = b < BAND_COUNT && frame->chain[b] && frame->config->detector.raw;
        if ((frame->png || raw) && (b == BAND_COUNT ? truth : frame->request->bands >> b & 1)) add_job(&jobs, write_png, b);
    }
    if (frame->picture->profile) add_job(&jobs, write_profile, BAND_RADAR);
    return run_jobs(&jobs, pool);
}

Status frame_files_hash(char hash[sha256_text_size], const FrameFiles *frame) { return hash_planes(hash, frame); }
