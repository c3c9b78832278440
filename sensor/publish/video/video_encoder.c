/* sensor/publish/video/video_encoder.c: images to packets of compressed video, through libavcodec, whose functions
 * are loaded when first needed. */
#include "sensor/publish/video/video_encoder_private.h"

#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
#include <stdatomic.h>
#include <stdlib.h>

/* ---- the functions of FFmpeg's libraries that video_encoder.c and video_transport.c call --------- */

/* clang-format off */
#define FFMPEG(X)                                                                                                    \
    X(av_d2q) X(av_dict_free) X(av_dict_set) X(av_frame_alloc) X(av_frame_free) X(av_frame_get_buffer)               \
    X(av_frame_make_writable) X(av_frame_new_side_data) X(av_frame_remove_side_data) X(av_free) X(av_freep)          \
    X(av_log_set_callback) X(av_malloc) X(av_packet_alloc) X(av_packet_free) X(av_packet_new_side_data)              \
    X(av_packet_rescale_ts) X(av_packet_unref) X(av_rescale) X(av_strerror) X(av_write_frame) X(av_write_trailer)    \
    X(avcodec_alloc_context3) X(avcodec_find_encoder_by_name) X(avcodec_free_context) X(avcodec_open2)               \
    X(avcodec_parameters_alloc) X(avcodec_parameters_copy) X(avcodec_parameters_free)                                \
    X(avcodec_parameters_from_context) X(avcodec_receive_packet) X(avcodec_send_frame)                               \
    X(avformat_alloc_output_context2) X(avformat_free_context) X(avformat_new_stream) X(avformat_write_header)       \
    X(avio_alloc_context) X(avio_context_free) X(avio_flush)
/* clang-format on */
LIBRARY(video_library, FFMPEG, "FFmpeg", PITVIPER_FFMPEG_FILE, "libavformat59");

/* ---- images to the planes of a video frame ------------------------------------------------------- */

static void copy_rows(const VideoPlanes *out, const void *image, int values)
{
    const size_t octets = (size_t)values * (size_t)out->width * (out->bits == 8 ? 1 : 2);
    for (int y = 0; y < out->height; y++)
        memcpy(out->at[0] + y * out->stride[0], (const uint8_t *)image + (size_t)y * octets, octets);
}

static void neutral_chroma(const VideoPlanes *out)
{
    const bool     half = out->layout == PIXELS_420;
    const uint16_t middle = (uint16_t)(1 << (out->bits - 1));
    const int      w = half ? out->width / 2 : out->width, h = half ? out->height / 2 : out->height;
    for (int p = 1; p < 3; p++)
        for (int y = 0; y < h; y++) {
            uint8_t *row = out->at[p] + y * out->stride[p];
            if (out->bits == 8) memset(row, middle, (size_t)w);
            for (int x = 0; out->bits > 8 && x < w; x++) ((uint16_t *)(void *)row)[x] = middle;
        }
}

/* ITU-R BT.709: Y = 0.2126 R + 0.7152 G + 0.0722 B, Cb = (B - Y) / 1.8556, Cr = (R - Y) / 1.5748; times 2^16. The
 * weights of Y sum to 2^16, those of a difference to 0: grey stays grey, to the value. */
enum { fixed_bits = 16, y_r = 13933, y_g = 46871, y_b = 4732 };
static const int chroma_weight[2][3] = {{-7509, -25259, 32768}, {32768, -29763, -3005}};

/* The following are compiled for octets and for 16-bit values: octet is a constant where they are called. */
#define FOR_BOTH static inline __attribute__((always_inline))

FOR_BOTH int64_t pixel_at(const void *image, size_t i, bool octet)
{
    return octet ? ((const uint8_t *)image)[i] : ((const uint16_t *)image)[i];
}

FOR_BOTH void store(uint8_t *row, int i, int64_t value, bool octet)
{
    if (octet) row[i] = (uint8_t)value;
    else ((uint16_t *)(void *)row)[i] = (uint16_t)value;
}

/* r, g, b: times 2^weight_bits. */
FOR_BOTH int64_t chroma(const int w[3], int64_t r, int64_t g, int64_t b, int weight_bits, int bits)
{
    const int     shift = fixed_bits + weight_bits;
    const int64_t value =
        (w[0] * r + w[1] * g + w[2] * b + ((int64_t)1 << (bits - 1 + shift)) + ((int64_t)1 << (shift - 1))) >>
        shift; /* of a positive number */
    return value >> bits ? ((int64_t)1 << bits) - 1 : value;
}

FOR_BOTH void luma_row(uint8_t *to, const void *image, size_t at, int width, bool octet)
{
    for (int x = 0; x < width; x++, at += 3)
        store(to, x,
              (y_r * pixel_at(image, at, octet) + y_g * pixel_at(image, at + 1, octet) +
               y_b * pixel_at(image, at + 2, octet) + (1 << (fixed_bits - 1))) >>
                  fixed_bits,
              octet);
}

/* Takes one value of a pixel, or the weighted sum, 1 2 1, of the columns left, here and right in two rows. */
FOR_BOTH int64_t sum_of(const void *image, size_t here, size_t left, size_t right, size_t row, bool octet)
{
    int64_t sum = 0;
    for (size_t k = 0; k < 2; k++)
        sum += pixel_at(image, left + k * row, octet) + 2 * pixel_at(image, here + k * row, octet) +
               pixel_at(image, right + k * row, octet);
    return sum;
}

FOR_BOTH void colour_planes(const VideoPlanes *out, const void *image, bool octet)
{
    const size_t row = 3 * (size_t)out->width;
    const int    bits = out->bits;
    for (int y = 0; y < out->height; y++)
        luma_row(out->at[0] + y * out->stride[0], image, (size_t)y * row, out->width, octet);
    for (int p = 1; p < 3; p++) {
        const int *w = chroma_weight[p - 1];
        for (int y = 0; out->layout == PIXELS_444 && y < out->height; y++)
            for (int x = 0; x < out->width; x++) {
                const size_t at = (size_t)y * row + 3 * (size_t)x;
                store(out->at[p] + y * out->stride[p], x,
                      chroma(w, pixel_at(image, at, octet), pixel_at(image, at + 1, octet),
                             pixel_at(image, at + 2, octet), 0, bits),
                      octet);
            }
        for (int y = 0; out->layout == PIXELS_420 && y < out->height; y += 2)
            for (int x = 0; x < out->width; x += 2) {
                const size_t at = (size_t)y * row + 3 * (size_t)x, left = x > 0 ? at - 3 : at, right = at + 3;
                store(out->at[p] + y / 2 * out->stride[p], x / 2,
                      chroma(w, sum_of(image, at, left, right, row, octet),
                             sum_of(image, at + 1, left + 1, right + 1, row, octet),
                             sum_of(image, at + 2, left + 2, right + 2, row, octet), 3, bits),
                      octet);
            }
    }
}

void video_pixels(const VideoPlanes *out, const void *image, bool colour)
{
    if (out->layout == PIXELS_RGB) {
        copy_rows(out, image, 3);
    } else if (colour) {
        if (out->bits == 8) colour_planes(out, image, true);
        else colour_planes(out, image, false);
    } else {
        copy_rows(out, image, 1);
        if (out->layout != PIXELS_GREY) neutral_chroma(out);
    }
}

/* ---- packets ------------------------------------------------------------------------------------- */

struct Encoder {
    EncoderConfig      config;
    PixelLayout        layout;
    AVCodecContext    *context;
    AVCodecParameters *parameters;
    AVFrame           *frame;
    AVPacket          *packet;
    int64_t            count; /* images so far */
    atomic_int         holds;
};

/* Per codec: bits, its encoder, and the library's formats by layout. Quality (CRF; lower is better): such that an image
 * with noise of 2 in 256 levels comes back with a smaller error than that, and a smaller one with more bits
 * (tests/sensor/test_video_encoder.c). */
static const struct Form {
    int                bits;
    const char        *library, *quality;
    enum AVPixelFormat format[4];
} forms[] = {
    {8, "libx264", "14", {AV_PIX_FMT_GRAY8, AV_PIX_FMT_YUV420P, AV_PIX_FMT_YUV444P, AV_PIX_FMT_NONE}},
    {10, "libx264", "10", {AV_PIX_FMT_GRAY10LE, AV_PIX_FMT_YUV420P10LE, AV_PIX_FMT_YUV444P10LE, AV_PIX_FMT_NONE}},
    {12, "libx265", "8", {AV_PIX_FMT_GRAY12LE, AV_PIX_FMT_YUV420P12LE, AV_PIX_FMT_YUV444P12LE, AV_PIX_FMT_NONE}},
    {16, "ffv1", NULL, {AV_PIX_FMT_GRAY16LE, AV_PIX_FMT_NONE, AV_PIX_FMT_NONE, AV_PIX_FMT_RGB48LE}},
};

int video_encoder_bits(enum VideoCodec codec) { return forms[codec].bits; }

const EncoderConfig *video_encoder_config(const Encoder *encoder) { return &encoder->config; }

static void library_message(void *from, int level, const char *format, va_list arguments)
{
    char text[256];
    (void)from;
    if (level > AV_LOG_ERROR) return;
    vsnprintf(text, sizeof text, format, arguments);
    text[strcspn(text, "\n")] = 0;
    log_detail("video: library: %s", text);
}

void video_quiet_libraries(void) { av_log_set_callback(library_message); }

static PixelLayout layout_of(const EncoderConfig *c)
{
    const bool odd = c->width % 2 || c->height % 2;
    if (c->codec == VIDEO_FFV1) return c->colour ? PIXELS_RGB : PIXELS_GREY;
    return !odd ? PIXELS_420 : c->colour ? PIXELS_444 : PIXELS_GREY;
}

enum { ffv1_slices = 4 };

/* Key frames come by request alone, once a second of exercise time. */
static bool set_options(AVDictionary **out, const EncoderConfig *c)
{
    static const char *const options[][3][2] = {
        {{"x264-params", "repeat-headers=1:force-cfr=1:scenecut=0"}},
        {{"x264-params", "repeat-headers=1:force-cfr=1:scenecut=0"}},
        {{"x265-params", "repeat-headers=1:log-level=none:info=0:pools=none:frame-threads=1:wpp=0:keyint=-1:scenecut=0:"
                         "bframes=0:rc-lookahead=0"}},
        {{"coder", "range_def"}, {"slices", "4"}, {"slicecrc", "1"}},
    };
    bool good = true;
    for (int i = 0; i < 3 && options[c->codec][i][0]; i++)
        good = good && av_dict_set(out, options[c->codec][i][0], options[c->codec][i][1], 0) >= 0;
    if (c->codec == VIDEO_FFV1) return good;
    return good && av_dict_set(out, "udu_sei", "1", 0) >= 0 && av_dict_set(out, "preset", "ultrafast", 0) >= 0 &&
           av_dict_set(out, "tune", "zerolatency", 0) >= 0 && av_dict_set(out, "forced-idr", "1", 0) >= 0 &&
           av_dict_set(out, "crf", forms[c->codec].quality, 0) >= 0;
}

static Status open_context(Encoder *e)
{
    const EncoderConfig *c = &e->config;
    const AVCodec       *codec = avcodec_find_encoder_by_name(forms[c->codec].library);
    AVDictionary        *options = NULL;
    if (!codec) {
        log_error("video: FFmpeg's libraries here have no encoder %s; choose another publish.video_codec",
                  forms[c->codec].library);
        return STATUS_UNSUPPORTED;
    }
    AVCodecContext *x = e->context = avcodec_alloc_context3(codec);
    if (!x) return STATUS_NO_MEMORY;
    x->width = c->width;
    x->height = c->height;
    x->pix_fmt = forms[c->codec].format[e->layout];
    x->framerate = av_d2q(c->rate_hz, 1000000);
    x->time_base = av_inv_q(x->framerate);
    x->gop_size = c->codec == VIDEO_FFV1 ? 1 : 1 << 20;
    x->max_b_frames = 0;
    x->thread_count = c->codec == VIDEO_FFV1 ? ffv1_slices : 1; /* a thread each; the bytes depend on slices alone */
    x->thread_type = FF_THREAD_SLICE;
    x->level = c->codec == VIDEO_FFV1 ? 3 : FF_LEVEL_UNKNOWN;
    x->flags = AV_CODEC_FLAG_GLOBAL_HEADER; /* for .mp4 and .mkv; MPEG-TS uses those in the key frames */
    x->color_range = AVCOL_RANGE_JPEG;
    x->colorspace = e->layout == PIXELS_RGB ? AVCOL_SPC_RGB : AVCOL_SPC_BT709;
    x->color_primaries = AVCOL_PRI_BT709;
    x->color_trc = AVCOL_TRC_IEC61966_2_1;
    x->chroma_sample_location = e->layout == PIXELS_420 ? AVCHROMA_LOC_LEFT : AVCHROMA_LOC_UNSPECIFIED;
    const bool good = set_options(&options, c);
    const int  opened = good ? avcodec_open2(x, codec, &options) : AVERROR(ENOMEM);
    av_dict_free(&options);
    if (opened < 0) {
        log_error("video: the encoder %s refuses images of %d x %d: %s; choose another size or publish.video_codec",
                  codec->name, c->width, c->height, av_err2str(opened));
        return STATUS_UNSUPPORTED;
    }
    e->parameters = avcodec_parameters_alloc();
    return e->parameters && avcodec_parameters_from_context(e->parameters, e->context) >= 0 ? STATUS_OK
                                                                                            : STATUS_NO_MEMORY;
}

static Status open_frame(Encoder *e)
{
    e->frame = av_frame_alloc();
    e->packet = av_packet_alloc();
    if (!e->frame || !e->packet) return STATUS_NO_MEMORY;
    e->frame->width = e->config.width;
    e->frame->height = e->config.height;
    e->frame->format = e->context->pix_fmt;
    e->frame->color_range = e->context->color_range;
    return av_frame_get_buffer(e->frame, 0) == 0 ? STATUS_OK : STATUS_NO_MEMORY;
}

Status video_encoder_open(Encoder **out, const EncoderConfig *config)
{
    Status status = library_load(&video_library);
    if (status != STATUS_OK) return status;
    Encoder *e = calloc(1, sizeof *e);
    if (!e) return STATUS_NO_MEMORY;
    video_quiet_libraries();
    atomic_init(&e->holds, 1);
    e->config = *config;
    e->layout = layout_of(config);
    status = open_context(e);
    if (status == STATUS_OK) status = open_frame(e);
    if (status == STATUS_OK) *out = e;
    else video_encoder_close(e);
    return status;
}

void video_encoder_hold(Encoder *e) { atomic_fetch_add(&e->holds, 1); }

void video_encoder_close(Encoder *e)
{
    if (!e || atomic_fetch_sub(&e->holds, 1) > 1) return;
    avcodec_parameters_free(&e->parameters);
    avcodec_free_context(&e->context);
    av_frame_free(&e->frame);
    av_packet_free(&e->packet);
    free(e);
}

static const uint8_t identifier[2][16] = {
    {'M', 'I', 'S', 'P', 'm', 'i', 'c', 'r', 'o', 's', 'e', 'c', 't', 'i', 'm', 'e'},
    {0xA8, 0x68, 0x7D, 0xD4, 0xD7, 0x59, 0x37, 0x58, 0xA5, 0xCE, 0xF0, 0x33, 0x8B, 0x65, 0x45, 0xF1}}; /* H.265 */

/* MISB ST 0604: the MISP precision time stamp, user data of an SEI message: an identifier of 16 octets, the status of
 * the clock (0x9F: whether it is locked to a reference is not known; ST 0603), and microseconds, with 0xFF after each
 * two octets, so that no start code appears. */
static int put_time_stamp(Encoder *e, int64_t unix_us)
{
    enum { octets = 16 + 1 + 11 };
    av_frame_remove_side_data(e->frame, AV_FRAME_DATA_SEI_UNREGISTERED);
    if (unix_us < 0 || e->config.codec == VIDEO_FFV1) return 0;
    AVFrameSideData *data = av_frame_new_side_data(e->frame, AV_FRAME_DATA_SEI_UNREGISTERED, octets);
    if (!data) return AVERROR(ENOMEM);
    memcpy(data->data, identifier[e->context->codec_id == AV_CODEC_ID_HEVC], 16);
    data->data[16] = 0x9F;
    for (int k = 0, at = 17; k < 8; k++) {
        data->data[at++] = (uint8_t)(unix_us >> (56 - 8 * k));
        if (k % 2 == 1 && k < 7) data->data[at++] = 0xFF;
    }
    return 0;
}

/* libx265 writes an identifier of its own before ours, where a reader looks for ours: out with it. The message is 28
 * octets then, not 44; it has no zeros side by side before a small value, so its octets are the stream's. */
static void bare_time_stamp(AVPacket *packet)
{
    enum { id = 16, whole = 2 * id + 12 };
    static const uint8_t library[id] = {0x2C, 0xA2, 0xDE, 0x09, 0xB5, 0x17, 0x47, 0xDB,
                                        0xBB, 0x55, 0xA4, 0xFE, 0x7F, 0xC2, 0xFC, 0x4E};
    for (int i = 2; i + whole <= packet->size; i++) {
        uint8_t *at = packet->data + i;
        if (at[-1] != whole || at[-2] != 5 || memcmp(at, library, id) != 0 || memcmp(at + id, identifier[1], id) != 0)
            continue;
        at[-1] = whole - id;
        memmove(at, at + id, (size_t)(packet->size - i - id));
        packet->size -= id;
        return;
    }
}

Status video_encoder_encode(VideoPacket *out, Encoder *e, const void *image, bool key, int64_t unix_us)
{
    int failed = av_frame_make_writable(e->frame);
    if (failed == 0) failed = put_time_stamp(e, unix_us);
    if (failed == 0) {
        VideoPlanes planes = {.layout = e->layout,
                              .width = e->config.width,
                              .height = e->config.height,
                              .bits = forms[e->config.codec].bits};
        for (int p = 0; p < 3; p++) {
            planes.at[p] = e->frame->data[p];
            planes.stride[p] = e->frame->linesize[p];
        }
        video_pixels(&planes, image, e->config.colour);
        e->frame->pict_type = key || e->count == 0 ? AV_PICTURE_TYPE_I : AV_PICTURE_TYPE_NONE;
        e->frame->pts = e->count++;
        av_packet_unref(e->packet);
        failed = avcodec_send_frame(e->context, e->frame);
    }
    if (failed == 0) failed = avcodec_receive_packet(e->context, e->packet);
    if (failed < 0) {
        log_error("video: the encoder %s failed: %s", forms[e->config.codec].library, av_err2str(failed));
        return STATUS_IO;
    }
    if (e->config.codec == VIDEO_HEVC_12) bare_time_stamp(e->packet);
    *out = (VideoPacket){e->packet->data, (size_t)e->packet->size, e->packet->flags & AV_PKT_FLAG_KEY};
    return STATUS_OK;
}

Status video_encoder_parameters(struct AVCodecParameters *out, const Encoder *e)
{
    return avcodec_parameters_copy(out, e->parameters) >= 0 ? STATUS_OK : STATUS_NO_MEMORY;
}
