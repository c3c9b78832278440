/* sensor/publish/consumers/consumers.c: the consumers of consumers.h that are short: displays, calls, pictures, the
 * newest pictures, COCO. */
#include "sensor/publish/consumers/consumers.h"
#include "sensor/publish/images/image_file.h"

#include <stdlib.h>
#include <stdio.h>

/* ---- displays of each frame, for the consumers after it ------------------------------------------ */

typedef struct DisplayMaker {
    Consumer      consumer;
    const Config *config;
    Pool         *pool;
    bool          counts;
    Camera        camera;
} DisplayMaker;

static Status put_displays(Consumer *consumer, Frame *frame)
{
    DisplayMaker    *m = (DisplayMaker *)consumer;
    const DisplaysOf of = {.config = m->config,
                           .picture = &frame->seen.picture,
                           .camera = &m->camera,
                           .frame = frame->number,
                           .time_s = frame->time_s,
                           .rate_px_s = {frame->rate_px_s[0], frame->rate_px_s[1]},
                           .counts = m->counts};
    const Status     status = frame_displays_make(frame->display, &of, frame->request.bands, m->pool, frame->arena);
    if (frame->latency) latency_displayed(frame->latency, frame->latency_key, frame->times.rendered_s);
    return status;
}

static Status close_displays(Consumer *consumer)
{
    DisplayMaker *m = (DisplayMaker *)consumer;
    camera_close(&m->camera);
    free(m);
    return STATUS_OK;
}

Status consume_displays(Consumer **out, const Config *config, const Sensors *sensors, Pool *pool, bool counts)
{
    DisplayMaker *m = calloc(1, sizeof *m);
    if (!m) return STATUS_NO_MEMORY;
    *m = (DisplayMaker){.consumer = {WANT_CELLS, put_displays, NULL, close_displays, NULL},
                        .config = config,
                        .pool = pool,
                        .counts = counts};
    const Status status = camera_open(&m->camera, sensors, config, true);
    if (status == STATUS_OK) *out = &m->consumer;
    else free(m);
    return status;
}

/* ---- functions called with each frame, or with each frame and its hash -------------------------- */

typedef struct Call {
    Consumer   consumer;
    FrameCall *call;
    FrameDone *done;
    void      *user;
    bool       hashes;
} Call;

static Status put_call(Consumer *consumer, Frame *frame)
{
    const Call *c = (const Call *)consumer;
    c->call(c->user, frame);
    return STATUS_OK;
}

static Status put_hash(Consumer *consumer, Frame *frame)
{
    const Call  *c = (const Call *)consumer;
    const Status status = c->hashes ? frame_sha256(&frame->seen) : STATUS_OK;
    if (status == STATUS_OK) c->done(c->user, frame);
    return status;
}

static Status close_call(Consumer *consumer)
{
    free(consumer);
    return STATUS_OK;
}

static Status open_call(Consumer **out, const Call *made_of)
{
    Call *c = malloc(sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    *c = *made_of;
    *out = &c->consumer;
    return STATUS_OK;
}

Status consume_by_call(Consumer **out, FrameCall *call, void *user, bool targets)
{
    const Call made = {
        .consumer = {targets ? WANT_TARGETS : 0, put_call, NULL, close_call, NULL}, .call = call, .user = user};
    return open_call(out, &made);
}

Status consume_hashes(Consumer **out, FrameDone *done, void *user, bool hashes)
{
    return open_call(out, &(Call){.consumer = {hashes ? WANT_SHA256 : 0, put_hash, NULL, close_call, NULL},
                                  .done = done,
                                  .user = user,
                                  .hashes = hashes});
}

/* ---- image files of each frame ------------------------------------------------------------------- */

typedef struct Pictures {
    Consumer     consumer;
    PictureFiles of;
    RetryBackoff retry;
} Pictures;

static Status put_pictures(Consumer *consumer, Frame *frame)
{
    Pictures        *p = (Pictures *)consumer;
    const Config    *config = p->of.config;
    const FrameFiles files = {.out = p->of.out,
                              .config = config,
                              .world = frame->world,
                              .picture = &frame->seen.picture,
                              .snapshot = &frame->seen.snapshot,
                              .request = &frame->request,
                              .host = frame->host,
                              .config_sha256 = frame->provenance.config_sha256,
                              .frame = frame->number,
                              .time_s = frame->time_s,
                              .unix_s = frame->unix_s,
                              .png = config->publish.png,
                              .raw = config->detector.raw,
                              .display = frame->display};
    const bool       due = !p->of.patient || retry_due(&p->retry);
    Status           status = STATUS_IO;
    if (due) status = frame_files_write(*frame->seen.sha256 ? NULL : frame->seen.sha256, &files, p->of.pool);
    if (p->of.patient) retry_done(&p->retry, due, status);
    return status;
}

static Status close_pictures(Consumer *consumer)
{
    free(consumer);
    return STATUS_OK;
}

Status consume_pictures(Consumer **out, const PictureFiles *made_of)
{
    Pictures *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    const Config *config = made_of->config;
    *p = (Pictures){.consumer = {0, put_pictures, NULL, close_pictures, "image_files"},
                    .of = *made_of,
                    .retry = {.what = "picture files"}};
    if (frame_files_truth(config)) p->consumer.wants |= WANT_PLANES;
    if (config->publish.png) p->consumer.wants |= WANT_DISPLAY;
    if (config->detector.raw) p->consumer.wants |= WANT_COUNTS;
    *out = &p->consumer;
    return STATUS_OK;
}

/* ---- the newest display of each band as a file --------------------------------------------------- */

typedef struct Latest {
    Consumer     consumer;
    char         folder[frame_path_size];
    bool         patient;
    RetryBackoff retry;
    uint8_t     *shown; /* [capacity] */
    size_t       capacity;
} Latest;

/* A reader finds the earlier image or this one, never a part. */
static Status write_band(Latest *l, const Frame *frame, int band)
{
    const FrameDisplay *d = &frame->display[band];
    const Picture      *p = &frame->seen.picture;
    const size_t        count = (size_t)p->width * (size_t)p->height, octets = count * (size_t)d->planes;
    char                path[frame_path_size + 32];
    if (d->planes == 0) return STATUS_OK;
    if (octets > l->capacity) {
        uint8_t *larger = realloc(l->shown, octets);
        if (!larger) return STATUS_NO_MEMORY;
        l->shown = larger;
        l->capacity = octets;
    }
    snprintf(path, sizeof path, "%s/%s.png", l->folder, band_name((Band)band));
    frame_display_quantise(l->shown, d, count, 8);
    return image_write_png(path, l->shown, p->width, p->height, d->planes, 8);
}

static Status put_latest(Consumer *consumer, Frame *frame)
{
    Latest    *l = (Latest *)consumer;
    const bool due = !l->patient || retry_due(&l->retry);
    Status     status = due ? STATUS_OK : STATUS_IO;
    for (int b = 0; b < BAND_COUNT && status == STATUS_OK; b++) status = write_band(l, frame, b);
    if (l->patient) retry_done(&l->retry, due, status);
    return status;
}

static Status close_latest(Consumer *consumer)
{
    Latest *l = (Latest *)consumer;
    free(l->shown);
    free(l);
    return STATUS_OK;
}

static Status begin_latest(Consumer *consumer) { return frame_files_folder(((Latest *)consumer)->folder); }

Status consume_latest(Consumer **out, const char *folder, bool patient)
{
    Latest *l = calloc(1, sizeof *l);
    if (!l) return STATUS_NO_MEMORY;
    *l = (Latest){.consumer = {WANT_DISPLAY, put_latest, NULL, close_latest, "latest", begin_latest},
                  .patient = patient,
                  .retry = {.what = "latest pictures"}};
    snprintf(l->folder, sizeof l->folder, "%.*s/latest", frame_path_size - frame_path_room, folder);
    *out = &l->consumer;
    return STATUS_OK;
}

/* ---- coco.json ----------------------------------------------------------------------------------- */

typedef struct CocoConsumer {
    Consumer  consumer;
    Coco     *coco;
    bool      clutter;
    size_t    pixels;
    uint32_t *plane; /* [pixels]: clutter, as coco_clutter has it */
} CocoConsumer;

static int by_instance(const void *key, const void *row)
{
    const int instance = *(const int *)key, of = ((const ClutterRecord *)row)->instance;
    return (instance > of) - (instance < of);
}

static Status put_clutter(CocoConsumer *c, const Frame *frame)
{
    const Picture     *p = &frame->seen.picture;
    const FrameRecord *r = &frame->record;
    const size_t       pixels = (size_t)p->width * (size_t)p->height;
    if (!p->instance || r->clutter_count == 0) return STATUS_OK;
    if (pixels > c->pixels) {
        uint32_t *plane = realloc(c->plane, pixels * sizeof *plane);
        if (!plane) return STATUS_NO_MEMORY;
        c->plane = plane, c->pixels = pixels;
    }
    for (size_t px = 0; px < pixels; px++) {
        const int            instance = p->entity[px] == 0 && p->part[px] ? (int)p->instance[px] : 0;
        const ClutterRecord *of =
            instance ? bsearch(&instance, r->clutter, (size_t)r->clutter_count, sizeof *r->clutter, by_instance) : NULL;
        c->plane[px] = of ? (uint32_t)(of - r->clutter) + 1 : 0;
    }
    return coco_clutter(c->coco, r, c->plane);
}

static Status put_coco(Consumer *consumer, Frame *frame)
{
    CocoConsumer *c = (CocoConsumer *)consumer;
    const Status  status = coco_frame(c->coco, &frame->record, frame->seen.picture.entity);
    return status == STATUS_OK && c->clutter ? put_clutter(c, frame) : status;
}

static Status close_coco(Consumer *consumer)
{
    CocoConsumer *c = (CocoConsumer *)consumer;
    const Status  status = coco_close(c->coco);
    free(c->plane);
    free(c);
    return status;
}

static Status begin_coco(Consumer *consumer) { return coco_begin(((CocoConsumer *)consumer)->coco); }

Status consume_coco(Consumer **out, const char *folder, const Config *config, const char *config_sha256)
{
    CocoConsumer *c = calloc(1, sizeof *c);
    if (!c) return STATUS_NO_MEMORY;
    c->consumer = (Consumer){WANT_TARGETS | WANT_PLANES, put_coco, NULL, close_coco, "coco", begin_coco};
    c->clutter = config->publish.coco_clutter;
    const Status status = coco_open(
        &c->coco, folder, config->publish.png ? "png" : "exr",
        (CocoLimits){config->publish.coco_min_pixels, config->publish.coco_min_visible, config->publish.coco_min_snr},
        config_sha256, config->seed);
    if (status == STATUS_OK) *out = &c->consumer;
    else free(c);
    return status;
}
