/* sensor/publish/video/consume_video.c: the consumer that publishes videos and streams. */
#include "sensor/publish/video/consume_video.h"

#include "sensor/frame/frame_display.h"
#include "sensor/publish/files/frame_files.h"
#include "sensor/publish/images/image_file.h"
#include "sensor/publish/images/picture_text.h"
#include "sensor/publish/video/video_encoder_private.h"
#include "sensor/publish/video/video_output_private.h"

#include <stdlib.h>

static const int64_t key_interval_90k = 90000;

/* One video, of one band or of several side by side. It is encoded once for all its outputs. */
typedef struct Channel {
    unsigned     bands;
    VideoOutput *output[3];
    VideoWriter *writer[3]; /* of each output; NULL: it is written at once */
    int          outputs;
    bool         klv;               /* of its one band, for some output */
    Encoder     *encoder;           /* NULL: not yet, or not at present */
    RetryBackoff retry;             /* of the encoder */
    char         what[48];          /* in its messages */
    int64_t      last_90k, key_90k; /* of the last frame and key frame; INT64_MIN: none yet */
} Channel;

typedef struct Video {
    Consumer         consumer;
    enum VideoLabels labels;
    VideoOf          of;
    unsigned         to; /* VideoTo: the outputs of `of` that are configured */
    enum KlvMode     klv;
    int              channels;
    Channel          channel[BAND_COUNT + 1];
    uint8_t         *image, *tile; /* for the largest frame so far */
    size_t           image_octets;
    KlvAnswers       found; /* by a recogniser */
} Video;

/* ---- one frame ---------------------------------------------------------------------------------- */

static Status make_room(Video *v, size_t octets)
{
    if (octets <= v->image_octets) return STATUS_OK;
    free(v->image);
    free(v->tile);
    v->image = malloc(octets);
    v->tile = malloc(octets);
    v->image_octets = v->image && v->tile ? octets : 0;
    return v->image_octets ? STATUS_OK : STATUS_NO_MEMORY;
}

/* Puts the tile of one band into a column of the image. */
static void put_tile(uint8_t *image, const uint8_t *tile, const EncoderConfig *c, int column, int width, int planes)
{
    const size_t octets = video_encoder_bits(c->codec) == 8 ? 1 : 2, values = c->colour ? 3 : 1;
    for (int y = 0; y < c->height; y++) {
        uint8_t       *to = image + ((size_t)y * (size_t)c->width + (size_t)column) * values * octets;
        const uint8_t *from = tile + (size_t)y * (size_t)width * (size_t)planes * octets;
        if ((int)values == planes) {
            memcpy(to, from, (size_t)width * values * octets);
            continue;
        }
        for (size_t x = 0; x < (size_t)width; x++)
            for (size_t p = 0; p < values; p++) memcpy(to + (x * values + p) * octets, from + x * octets, octets);
    }
}

/* Names of bands, and boxes and names of targets, as publish.video_labels has it, on the tile that begins at a column.
 */
static void label(Video *v, const EncoderConfig *form, Band band, int column, int width, const Frame *frame)
{
    const int     bits = video_encoder_bits(form->codec), times = width < 320 ? 1 : 2;
    const Drawing d = {v->image, form->width,     form->height, form->colour ? 3 : 1,
                       bits > 8, (1 << bits) - 1, column,       column + width};
    for (int i = 0; v->labels == VIDEO_LABELS_TARGETS && i < frame->record.target_count; i++) {
        const TargetRecord *t = &frame->record.target[i];
        char                id[dis_id_text_size];
        dis_entity_id_text(id, t->id);
        if (target_box_is_empty(t->box)) continue;
        const int box[4] = {t->box[0] + column, t->box[1], t->box[2] + column, t->box[3]};
        picture_text_box(&d, box);
        picture_text_draw(&d, box[0], box[1] >= 10 * times + 2 ? box[1] - 9 * times - 2 : box[3] + 3 * times, times,
                          *t->marking ? t->marking : id);
    }
    picture_text_draw(&d, column + 2 * times, 2 * times, times, band_name(band));
}

/* The image of a channel, and its form. A band without a display is black. */
static Status compose(EncoderConfig *form, Video *v, const Channel *c, const Frame *frame)
{
    const int width = frame->seen.picture.width, height = frame->seen.picture.height;
    const int tiles = __builtin_popcount(c->bands);
    *form = (EncoderConfig){
        .codec = v->of.config->publish.video_codec, .width = tiles * width, .height = height, .rate_hz = v->of.rate_hz};
    for (int b = 0; b < BAND_COUNT; b++)
        if (c->bands >> b & 1 && frame->display[b].planes == 3) form->colour = true;
    const int    bits = video_encoder_bits(form->codec);
    const size_t octets = (size_t)form->width * (size_t)height * (form->colour ? 3 : 1) * (bits == 8 ? 1 : 2);
    const Status status = make_room(v, octets);
    if (status != STATUS_OK) return status;
    for (int b = 0, column = 0; b < BAND_COUNT; b++) {
        const FrameDisplay *display = &frame->display[b];
        const int           planes = display->planes ? display->planes : 1;
        if (!(c->bands >> b & 1)) continue;
        if (display->planes) frame_display_quantise(v->tile, display, (size_t)width * (size_t)height, bits);
        else memset(v->tile, 0, (size_t)width * (size_t)height * (bits == 8 ? 1 : 2));
        put_tile(v->image, v->tile, form, column, width, planes);
        if (v->labels != VIDEO_LABELS_OFF) label(v, form, (Band)b, column, width, frame);
        column += width;
    }
    return STATUS_OK;
}

/* Time of a frame, which is later than that of the last frame whatever the clock of the exercise does. */
static int64_t time_of(const Channel *c, double unix_s)
{
    const int64_t at = (int64_t)llround(unix_s * 90000);
    return at > c->last_90k ? at : c->last_90k + 1;
}

static bool key_is_due(const Channel *c, int64_t pts_90k)
{
    bool due = c->key_90k == INT64_MIN || pts_90k - c->key_90k >= key_interval_90k;
    for (int i = 0; i < c->outputs && !due; i++)
        due = c->writer[i] ? video_writer_needs_key(c->writer[i]) : video_output_needs_key(c->output[i]);
    return due;
}

static Status encode(VideoPacket *packet, Video *v, Channel *c, const EncoderConfig *form, int64_t pts_90k,
                     int64_t unix_us)
{
    const EncoderConfig *had = c->encoder ? video_encoder_config(c->encoder) : NULL;
    if (had && (had->width != form->width || had->height != form->height || had->colour != form->colour)) {
        log_error("video: %s: the image's size or its colours changed during the run", c->what);
        return STATUS_UNSUPPORTED;
    }
    Status status = had ? STATUS_OK : video_encoder_open(&c->encoder, form);
    if (status == STATUS_OK)
        status = video_encoder_encode(packet, c->encoder, v->image, key_is_due(c, pts_90k), unix_us);
    if (status == STATUS_OK) return STATUS_OK;
    video_encoder_close(c->encoder);
    c->encoder = NULL;
    return status;
}

static Status put_channel(Video *v, Channel *c, const Frame *frame)
{
    EncoderConfig form;
    uint8_t       klv[klv_most_octets];
    VideoUnit     unit = {.pts_90k = time_of(c, frame->unix_s), .klv = klv};
    const bool    due = !v->of.patient || retry_due(&c->retry);
    Status        status = due ? compose(&form, v, c, frame) : STATUS_IO;
    if (status == STATUS_OK)
        status = encode(&unit.packet, v, c, &form, unit.pts_90k, (int64_t)floor(frame->unix_s * 1e6 + 0.5));
    if (v->of.patient) retry_done(&c->retry, due, status);
    if (status != STATUS_OK) return v->of.patient ? STATUS_OK : status;
    if (c->klv)
        unit.klv_count =
            klv_of_band(klv, &v->found, v->of.config->publish.vmti, frame, (Band)__builtin_ctz(c->bands), v->of.geoid);
    c->last_90k = unit.pts_90k;
    if (unit.packet.key) c->key_90k = unit.pts_90k;
    for (int i = 0; i < c->outputs; i++) {
        if (c->writer[i]) {
            video_writer_put(c->writer[i], c->encoder, &unit, frame);
            continue;
        }
        const Status one = video_output_put(c->output[i], c->encoder, &unit);
        if (status == STATUS_OK) status = one;
    }
    return status;
}

static Status put(Consumer *consumer, Frame *frame)
{
    Video *v = (Video *)consumer;
    Status status = STATUS_OK;
    for (int i = 0; i < v->channels && status == STATUS_OK; i++) status = put_channel(v, &v->channel[i], frame);
    return status;
}

/* ---- its channels ------------------------------------------------------------------------------- */

static Status close_video(Consumer *consumer)
{
    Video *v = (Video *)consumer;
    Status status = STATUS_OK;
    for (int i = 0; i < v->channels; i++) {
        Channel *c = &v->channel[i];
        for (int k = 0; k < c->outputs; k++) {
            const Status one = c->writer[k] ? video_writer_close(c->writer[k]) : video_output_close(c->output[k]);
            if (status == STATUS_OK) status = one;
            if (!c->writer[k]) free(c->output[k]);
        }
        video_encoder_close(c->encoder);
        retry_end(&c->retry);
    }
    free(v->image);
    free(v->tile);
    free(v);
    return status;
}

static Channel *add_channel(Video *v, unsigned bands)
{
    Channel *c = &v->channel[v->channels++];
    *c = (Channel){.bands = bands, .last_90k = INT64_MIN, .key_90k = INT64_MIN};
    if (bands & (bands - 1)) snprintf(c->what, sizeof c->what, "the video of all bands");
    else snprintf(c->what, sizeof c->what, "the video of %.16s", band_name((Band)__builtin_ctz(bands)));
    c->retry.what = c->what;
    return c;
}

static Status add_output(VideoOutput **out, Video *v, Channel *c, VideoKind kind)
{
    VideoOutput *o = calloc(1, sizeof *o);
    const bool   one = (c->bands & (c->bands - 1)) == 0;
    const Band   band = (Band)__builtin_ctz(c->bands);
    if (!o) return STATUS_NO_MEMORY;
    c->output[c->outputs++] = o;
    o->kind = kind;
    o->klv = kind == VIDEO_TS && one ? v->klv : KLV_OFF;
    o->patient = v->of.patient;
    o->needs_key = true;
    o->retry.what = o->path;
    c->klv = c->klv || o->klv != KLV_OFF;
    snprintf(o->title, sizeof o->title, "%s", one ? band_name(band) : "all bands");
    *out = o;
    return STATUS_OK;
}

static Status add_stream(Video *v, Channel *c)
{
    const Config *config = v->of.config;
    StreamUrl     url;
    VideoOutput  *o;
    const Band    band = (Band)__builtin_ctz(c->bands);
    if (!(v->to & VIDEO_TO_STREAM) || !video_stream_url(&url, config, v->of.bands, band)) return STATUS_OK;
    const Status status = add_output(&o, v, c, VIDEO_TS);
    if (status == STATUS_OK) o->sent = v->of.sent;
    return status == STATUS_OK ? video_udp_open(&o->udp, &url, config->network.interface, config->network.ttl) : status;
}

static Status add_file(Video *v, Channel *c, VideoKind kind)
{
    VideoOutput *o;
    const Status status = add_output(&o, v, c, kind);
    if (status != STATUS_OK) return status;
    const Band band = (Band)__builtin_ctz(c->bands);
    if (!video_path(o->path, v->of.config, v->of.host_folder, band, kind)) return STATUS_BAD_VALUE;
    if (!v->of.apart) return STATUS_OK;
    if (v->of.latency) latency_expect(v->of.latency, video_file_name);
    return video_writer_open(&c->writer[c->outputs - 1], o);
}

static Status add_channels(Video *v)
{
    const Config   *config = v->of.config;
    const VideoKind asked = v->to & VIDEO_TO_FILE ? video_kind(config->publish.video) : VIDEO_NONE;
    const unsigned  bands = v->of.bands;
    const bool      single = asked > VIDEO_FOLDER, alone = (bands & (bands - 1)) == 0;
    VideoKind       kind[2];
    const int       kinds = asked == VIDEO_FOLDER ? video_folder_kinds(kind, config) : 0;
    Status          status = STATUS_OK;
    for (int b = 0; b < BAND_COUNT && status == STATUS_OK; b++) {
        if (!(bands >> b & 1) || (!kinds && !(v->to & VIDEO_TO_STREAM))) continue;
        Channel *c = add_channel(v, 1u << b);
        status = add_stream(v, c);
        for (int k = 0; k < kinds && status == STATUS_OK; k++) status = add_file(v, c, kind[k]);
        if (single && alone && status == STATUS_OK) status = add_file(v, c, asked);
    }
    if (single && status == STATUS_OK && !(alone && v->channels)) status = add_file(v, add_channel(v, bands), asked);
    return status;
}

/* The folder; files are opened with their first frame. */
static Status begin(Consumer *consumer)
{
    const VideoOf *of = &((const Video *)consumer)->of;
    char           path[video_path_size];
    if (!(of->to & VIDEO_TO_FILE) || video_kind(of->config->publish.video) != VIDEO_FOLDER) return STATUS_OK;
    const Status status = frame_files_folder(of->config->publish.video);
    if (status != STATUS_OK || !of->host_folder) return status;
    if (snprintf(path, sizeof path, "%s/%s", of->config->publish.video, of->host_folder) >= (int)sizeof path)
        return STATUS_BAD_VALUE;
    return frame_files_folder(path);
}

Status video_prepare(const Config *config)
{
    if (!video_wanted(config)) return STATUS_OK;
    const Status status = config->publish.video_labels == VIDEO_LABELS_OFF ? STATUS_OK : image_read_prepare();
    return status == STATUS_OK ? library_load(&video_library) : status;
}

Status consume_video(Consumer **out, const VideoOf *of)
{
    const unsigned to = of->to & video_wanted(of->config);
    if (of->host_folder && video_hosts_check(of->config, 2) != STATUS_OK) return STATUS_UNSUPPORTED;
    Video *v = calloc(1, sizeof *v);
    if (!v) return STATUS_NO_MEMORY;
    v->consumer = (Consumer){WANT_DISPLAY, put, NULL, close_video, "video", begin};
    v->of = *of;
    v->of.to = to;
    v->found = (KlvAnswers){.from = of->answers};
    v->to = to;
    v->labels = of->config->publish.video_labels;
    v->klv = of->config->publish.klv;
    const Status status = add_channels(v);
    for (int i = 0; i < v->channels; i++)
        if (v->channel[i].klv) v->consumer.wants |= WANT_FOOTPRINT;
    if (v->consumer.wants & WANT_FOOTPRINT && of->config->publish.vmti == VMTI_TRUTH) v->consumer.wants |= WANT_TARGETS;
    if (v->labels == VIDEO_LABELS_TARGETS) v->consumer.wants |= WANT_TARGETS;
    if (status == STATUS_OK) *out = &v->consumer;
    else close_video(&v->consumer);
    return status;
}
