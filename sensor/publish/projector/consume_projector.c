/* sensor/publish/projector/consume_projector.c: the consumer that shows one band of each frame on a display. */
#include "sensor/publish/projector/consume_projector.h"

#include "sensor/publish/projector/drive_table.h"
#include "sensor/publish/projector/display_window.h"

#include <stdlib.h>

static const char in_ledger[] = "projector";

/* What drive levels are made from. */
typedef enum Source { OF_DISPLAY, OF_COUNTS, OF_RADIANCE } Source;

/* Images whose flip is not known yet: three at most are on their way, but what is said of them may be taken late on a
 * busy machine. */
enum { pending_most = 256 };
typedef struct Pending {
    uint32_t number; /* 0: none */
    uint64_t key;    /* in the ledger */
    double   rendered_s;
} Pending;

typedef struct Projector {
    Consumer         consumer;
    ProjectorOf      of;
    Band             band;
    Source           source;
    DriveTable       table; /* no rows: none */
    size_t           count; /* pixels */
    uint16_t        *level; /* [3][count] of planes */
    uint8_t         *shown; /* [3 count] of the display image */
    DisplayWindow   *window;
    uint32_t         number; /* of the newest image */
    pthread_mutex_t  lock;   /* protects the following */
    Pending          pending[pending_most];
    LatencyHistogram after;
} Projector;

/* ---- drive levels --------------------------------------------------------------------------------- */

/* Values of the band's planes as levels, into p->level. Returns how many planes there are; 0: none. */
static int levels_of_radiance(Projector *p, const Frame *frame)
{
    const char *name = band_name(p->band);
    int         planes = 0;
    for (int i = 0; i < frame->seen.plane_count && planes < 3; i++) {
        const FrameArray *a = &frame->seen.plane[i];
        if (a->kind != PLANE_RADIANCE || a->type != PLANE_F32 || strcmp(a->group, name) != 0) continue;
        if ((size_t)a->size[0] * (size_t)a->size[1] != p->count) return 0;
        drive_levels_of_radiance(p->level + (size_t)planes++ * p->count, &p->table, a->values, p->count);
    }
    return planes;
}

static int levels_of_counts(Projector *p, const Frame *frame)
{
    const FrameDisplay *d = &frame->display[p->band];
    for (int k = 0; k < d->planes; k++) {
        uint16_t *to = p->level + (size_t)k * p->count;
        if (!d->counts[k]) return 0;
        if (p->table.rows > 0) drive_levels_of_counts(to, &p->table, d->counts[k], p->count);
        else memcpy(to, d->counts[k], p->count * sizeof *to);
    }
    return d->planes;
}

static int levels_of_display(Projector *p, const Frame *frame)
{
    const FrameDisplay *d = &frame->display[p->band];
    if (d->planes == 0) return 0;
    frame_display_quantise(p->shown, d, p->count, 8);
    for (size_t i = 0; i < p->count; i++)
        for (int k = 0; k < d->planes; k++)
            p->level[(size_t)k * p->count + i] = p->shown[i * (size_t)d->planes + (size_t)k];
    return d->planes;
}

/* Levels of a grey image, or of R, G, B, as pixels of the display. */
static void fill(uint32_t *out, const Projector *p, int planes)
{
    const uint16_t *r = p->level, *g = planes == 3 ? r + p->count : r, *b = planes == 3 ? g + p->count : r;
    if (p->of.config->projector.bits == 16)
        for (size_t i = 0; i < p->count; i++) out[i] = (uint32_t)r[i] << 8; /* its high octet red, its low one green */
    else
        for (size_t i = 0; i < p->count; i++) out[i] = (uint32_t)r[i] << 16 | (uint32_t)g[i] << 8 | b[i];
}

/* ---- frame by frame ------------------------------------------------------------------------------- */

/* Settles an image that is pending, as shown at_s or never; of one that is not, nothing. */
static void settle(Projector *p, uint32_t number, bool shown, double at_s)
{
    pthread_mutex_lock(&p->lock);
    Pending *e = &p->pending[number % pending_most];
    if (e->number == number && number != 0) {
        if (shown) latency_count(&p->after, 1e3 * fmax(0, at_s - e->rendered_s));
        if (shown && p->of.latency) latency_done_at(p->of.latency, e->key, e->rendered_s, in_ledger, at_s);
        else if (p->of.latency) latency_left_out(p->of.latency, e->key, in_ledger);
        *e = (Pending){0};
    }
    pthread_mutex_unlock(&p->lock);
}

static void flipped(void *user, uint32_t number, double at_s) { settle(user, number, true, at_s); }
static void dropped(void *user, uint32_t number) { settle(user, number, false, 0); }

static Status put(Consumer *consumer, Frame *frame)
{
    Projector *p = (Projector *)consumer;
    int (*const levels[])(Projector *, const Frame *) = {levels_of_display, levels_of_counts, levels_of_radiance};
    const int planes = levels[p->source](p, frame);
    if (planes == 0) {
        log_error("projector: frame %d has no %s of %s", frame->number, p->source == OF_RADIANCE ? "values" : "counts",
                  band_name(p->band));
        return STATUS_BAD_VALUE;
    }
    fill(display_window_fill(p->window), p, planes);
    const uint32_t number = ++p->number;
    settle(p, number - pending_most, false, 0); /* so far back it is known, or never told */
    pthread_mutex_lock(&p->lock);
    p->pending[number % pending_most] = (Pending){number, frame->latency_key, frame->provenance.rendered_s};
    pthread_mutex_unlock(&p->lock);
    const int wait_ms = p->of.config->projector.wait_ms;
    if (!display_window_show(p->window, number)) settle(p, number, false, 0);
    else if (wait_ms > 0) display_window_wait(p->window, number, 1e-3 * wait_ms);
    return STATUS_OK;
}

static Status close_projector(Consumer *consumer)
{
    Projector *p = (Projector *)consumer;
    display_window_close(p->window, p->of.counters);
    for (uint32_t k = 0; k < pending_most; k++) settle(p, p->pending[k].number, false, 0);
    if (p->window && p->of.counters) latency_figures(&p->of.counters->after, &p->after);
    drive_table_free(&p->table);
    free(p->level);
    free(p->shown);
    pthread_mutex_destroy(&p->lock);
    free(p);
    return STATUS_OK;
}

/* ---- its making ----------------------------------------------------------------------------------- */

static Status choose_band(Projector *p)
{
    const char *text = p->of.config->projector.band;
    char        there[120] = "";
    for (int b = 0; b < BAND_COUNT; b++) {
        if (!(p->of.bands >> b & 1)) continue;
        const size_t n = strlen(there);
        snprintf(there + n, sizeof there - n, "%s%s", n ? ", " : "", band_name((Band)b));
        if (strcmp(text, band_name((Band)b)) != 0) continue;
        p->band = (Band)b;
        return STATUS_OK;
    }
    log_error("projector: projector.band: '%s' is no band of this run: %s", text, there);
    return STATUS_BAD_VALUE;
}

/* What levels are made from; what the settings mean together. */
static Status choose_source(Projector *p)
{
    const Config *config = p->of.config;
    const int     bits = config->projector.bits, most = bits == 16 ? 65535 : 255;
    Status        status = STATUS_OK;
    if (*config->projector.table) status = drive_table_read(&p->table, config->projector.table, most);
    if (status != STATUS_OK) return status;
    p->source = p->table.rows == 0 ? bits == 16 ? OF_COUNTS : OF_DISPLAY : p->table.counts ? OF_COUNTS : OF_RADIANCE;
    if (p->source == OF_COUNTS && !p->of.count_bits[p->band]) {
        log_error("projector: %s has no raw counts without a sensor (sensor.preset); projector.table with a column "
                  "radiance needs none",
                  band_name(p->band));
        return STATUS_BAD_VALUE;
    }
    if (bits == 16 && p->band == BAND_OPTICAL && config_optical(config) == OPTICAL_RGB) {
        log_error("projector: projector.bits: 16 takes red and green for one value; choose another band, or "
                  "sensor.optical: pan");
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

Status consume_projector(Consumer **out, const ProjectorOf *of)
{
    static const char *const scale[] = {[PROJECTOR_ONE] = "one", [PROJECTOR_WHOLE] = "whole", [PROJECTOR_FIT] = "fit"};
    static const char *const axes[] = {
        [PROJECTOR_NO_GAMEPAD] = "none", [PROJECTOR_LEVEL] = "level", [PROJECTOR_BODY] = "body"};
    const Config *config = of->config;
    Projector    *p = calloc(1, sizeof *p);
    if (!p) return STATUS_NO_MEMORY;
    p->of = *of;
    p->count = (size_t)config->sensor.width_px * (size_t)config->sensor.height_px;
    p->consumer = (Consumer){.put = put, .close = close_projector};
    pthread_mutex_init(&p->lock, NULL);
    Status status = choose_band(p);
    if (status == STATUS_OK) status = choose_source(p);
    if (status == STATUS_OK) {
        p->level = malloc(3 * p->count * sizeof *p->level);
        p->shown = malloc(3 * p->count);
        if (!p->level || !p->shown) status = STATUS_NO_MEMORY;
    }
    if (p->source != OF_RADIANCE) p->consumer.wants = p->source == OF_COUNTS ? WANT_COUNTS : WANT_DISPLAY;
    if (status == STATUS_OK)
        status = display_window_open(
            &p->window, &(DisplayWindowOf){.width = config->sensor.width_px,
                                           .height = config->sensor.height_px,
                                           .display = config->projector.display,
                                           .size = config->projector.window,
                                           .scale = scale[config->projector.scale],
                                           .vsync = config->projector.vsync,
                                           .gamepad = axes[of->live ? config->projector.gamepad : PROJECTOR_NO_GAMEPAD],
                                           .head = config->exercise.head,
                                           .flipped = flipped,
                                           .dropped = dropped,
                                           .user = p});
    if (status != STATUS_OK) {
        close_projector(&p->consumer);
        return status;
    }
    if (of->latency) latency_expect(of->latency, in_ledger);
    *out = &p->consumer;
    return STATUS_OK;
}
