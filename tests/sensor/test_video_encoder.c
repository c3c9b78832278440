/* tests/sensor/test_video_encoder.c: encoded video: a packet for each image at once, the same bytes each time, pixels
 * that come back as they were; addresses of streams. The decoder is libavcodec's own, which shares no code with x264
 * and x265. labels: alone */
#include "tests/check.h"

#include "sensor/settings/config.h"
#include "sensor/settings/publish_choice.h"

#ifdef PITVIPER_VIDEO
#include "sensor/publish/video/video_encoder_private.h"
#include "sensor/publish/video/video_encoder_private.h"

#include <libavcodec/avcodec.h>

enum { width = 96, height = 64, frames = 5, octets_most = 1 << 20 };

/* A moving ramp with noise of two in 256 levels, and squares with hard edges. */
static void draw(uint16_t *out, int w, int h, int planes, int frame, int bits)
{
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++)
            for (int p = 0; p < planes; p++) {
                const bool   square = (x + 3 * frame) / 16 % 4 == p && y / 16 % 2 == 0;
                const double at = random_normal(1, 7, (uint32_t)frame, (uint64_t)((y * w + x) * planes + p));
                const double noise = at * 2 / 255;
                const double level = square ? 0.9 : 0.1 + 0.6 * ((x + p * 5 + frame) % w) / w;
                out[(y * w + x) * planes + p] = (uint16_t)lround(clamp(level + noise, 0, 1) * ((1 << bits) - 1));
            }
}

/* As the encoder takes it: octets for 8 bits. */
static const void *image_of(uint8_t *narrow, const uint16_t *wide, int count, int bits)
{
    if (bits > 8) return wide;
    for (int i = 0; i < count; i++) narrow[i] = (uint8_t)wide[i];
    return narrow;
}

static size_t encode_all(uint8_t *out, const EncoderConfig *config, bool check_keys)
{
    static uint16_t wide[width * height * 3];
    static uint8_t  narrow[width * height * 3];
    const int       planes = config->colour ? 3 : 1, bits = video_encoder_bits(config->codec);
    Encoder        *encoder;
    size_t          used = 0;
    assert_int_equal(video_encoder_open(&encoder, config), STATUS_OK);
    for (int f = 0; f < frames; f++) {
        VideoPacket packet;
        draw(wide, config->width, config->height, planes, f, bits);
        assert_int_equal(video_encoder_encode(&packet, encoder,
                                              image_of(narrow, wide, config->width * config->height * planes, bits),
                                              f == 3, 1780000000000000 + f),
                         STATUS_OK);
        CHECK(packet.count > 0 && used + packet.count <= octets_most);
        if (check_keys && config->codec != VIDEO_FFV1) assert_int_equal(packet.key, f == 0 || f == 3);
        memcpy(out + used, packet.bytes, packet.count);
        used += packet.count;
    }
    video_encoder_close(encoder);
    return used;
}

static void one_packet_for_each_image_and_the_same_bytes(void **state)
{
    (void)state;
    static uint8_t first[octets_most], again[octets_most];
    for (int codec = VIDEO_H264; codec <= VIDEO_FFV1; codec++) {
        const EncoderConfig config = {(enum VideoCodec)codec, width, height, codec == VIDEO_FFV1, 30};
        const size_t        count = encode_all(first, &config, true);
        assert_int_equal(encode_all(again, &config, false), count);
        assert_memory_equal(first, again, count);
    }
}

/* rms and largest difference of the last frame's grey levels, or R G B by BT.709; in 1 / 2^bits. */
static void decoded_error(double *rms, double *worst, const EncoderConfig *config, int start)
{
    static uint16_t wide[width * height * 3];
    static uint8_t  narrow[width * height * 3];
    const int       planes = config->colour ? 3 : 1, bits = video_encoder_bits(config->codec);
    const size_t    count = (size_t)(config->width * config->height * planes);
    Encoder        *encoder;
    assert_int_equal(video_encoder_open(&encoder, config), STATUS_OK);
    AVCodecParameters *parameters = avcodec_parameters_alloc();
    assert_int_equal(video_encoder_parameters(parameters, encoder), STATUS_OK);
    AVCodecContext *decoder = avcodec_alloc_context3(avcodec_find_decoder(parameters->codec_id));
    /* of the others all is in the packets */
    if (config->codec == VIDEO_FFV1) avcodec_parameters_to_context(decoder, parameters);
    decoder->thread_count = 1;
    decoder->flags = AV_CODEC_FLAG_LOW_DELAY;
    assert_int_equal(avcodec_open2(decoder, NULL, NULL), 0);
    AVPacket *packet = av_packet_alloc();
    AVFrame  *frame = av_frame_alloc();
    int       got = 0;
    double    sum = 0;
    *worst = 0;
    for (int f = 0; f < frames; f++) {
        VideoPacket coded;
        draw(wide, config->width, config->height, planes, f, bits);
        assert_int_equal(
            video_encoder_encode(&coded, encoder, image_of(narrow, wide, (int)count, bits), f == start, -1), STATUS_OK);
        if (f < start) continue; /* joins in the middle */
        assert_int_equal(av_new_packet(packet, (int)coded.count), 0);
        memcpy(packet->data, coded.bytes, coded.count);
        assert_int_equal(avcodec_send_packet(decoder, packet), 0);
        av_packet_unref(packet);
        assert_int_equal(avcodec_receive_frame(decoder, frame), 0); /* at once */
        got++;
    }
    assert_int_equal(got, frames - start);
    assert_int_equal(frame->width, config->width);
    assert_int_equal(frame->height, config->height);
    if (config->codec != VIDEO_FFV1)
        CHECK(frame->color_range == AVCOL_RANGE_JPEG || frame->format == AV_PIX_FMT_YUVJ420P);
    const bool octet = bits == 8, full = frame->format == AV_PIX_FMT_YUV444P || frame->format == AV_PIX_FMT_YUVJ444P;
    for (int y = 0; y < config->height; y++)
        for (int x = 0; x < config->width; x++) {
            double value[3] = {0};
            for (int p = 0; p < 3 && frame->data[p] && config->codec != VIDEO_FFV1; p++) {
                const int      half = p > 0 && !full;
                const int      i = half ? x / 2 : x;
                const uint8_t *row = frame->data[p] + (half ? y / 2 : y) * frame->linesize[p];
                value[p] = octet ? row[i] : ((const uint16_t *)(const void *)row)[i];
            }
            const double neutral = 1 << (bits - 1), Y = value[0], cb = value[1] - neutral, cr = value[2] - neutral;
            double       rgb[3] = {Y + 1.5748 * cr, Y - 0.187324 * cb - 0.468124 * cr, Y + 1.8556 * cb};
            for (int p = 0; p < planes; p++) {
                const double want = wide[(y * config->width + x) * planes + p];
                double       is = planes == 1 ? Y : rgb[p];
                if (config->codec == VIDEO_FFV1) {
                    static const int of_gbr[3] = {2, 0, 1};
                    const int        plane = planes == 3 ? of_gbr[p] : 0;
                    is = ((const uint16_t *)(const void *)(frame->data[plane] + y * frame->linesize[plane]))[x];
                }
                sum += (is - want) * (is - want);
                *worst = fmax(*worst, fabs(is - want));
            }
        }
    *rms = sqrt(sum / (double)count);
    av_frame_free(&frame);
    av_packet_free(&packet);
    avcodec_free_context(&decoder);
    avcodec_parameters_free(&parameters);
    video_encoder_close(encoder);
}

/* The image's noise is 2, 8, 32 of these levels: the error is smaller, and in 10 and 12 bits half of it. */
static void grey_levels_come_back(void **state)
{
    (void)state;
    static const double most_rms[] = {2, 4.5, 14, 0}; /* of 256, 1024, 4096 and 65536 levels */
    for (int codec = VIDEO_H264; codec <= VIDEO_FFV1; codec++)
        for (int start = 0; start <= 3; start += 3) {
            const EncoderConfig config = {(enum VideoCodec)codec, width, height, false, 30};
            double              rms, worst;
            decoded_error(&rms, &worst, &config, start);
            print_message("codec %d from frame %d: rms %.2f, worst %.0f of %d levels, PSNR %.1f dB\n", codec, start,
                          rms, worst, 1 << video_encoder_bits(config.codec),
                          20 * log10(((1 << video_encoder_bits(config.codec)) - 1) / fmax(rms, 1e-9)));
            CHECK_NEAR(rms, 0, most_rms[codec]);
        }
}

static void colours_and_odd_sizes_come_back(void **state)
{
    (void)state;
    double rms, worst;
    decoded_error(&rms, &worst, &(EncoderConfig){VIDEO_FFV1, width, height, true, 30}, 0);
    CHECK_NEAR(worst, 0, 0);
    decoded_error(&rms, &worst, &(EncoderConfig){VIDEO_H264, width - 1, height - 3, true, 30}, 0);
    print_message("colour, 4:4:4: rms %.2f, worst %.0f\n", rms, worst);
    CHECK_NEAR(rms, 0, 4);
    decoded_error(&rms, &worst, &(EncoderConfig){VIDEO_H264, width - 1, height - 3, false, 30}, 0);
    CHECK_NEAR(rms, 0, 2);
    decoded_error(&rms, &worst, &(EncoderConfig){VIDEO_H264_10, width, height - 3, false, 1}, 0);
    CHECK_NEAR(rms, 0, 4.5);
}

/* RGB to YCbCr and back in double, for uniform images, where 4:2:0 loses nothing. */
static void colour_conversion_is_bt709(void **state)
{
    (void)state;
    for (int bits = 8; bits <= 12; bits += 2)
        for (int i = 0; i < 500; i++) {
            const int top = (1 << bits) - 1;
            uint16_t  image[12] = {0}, plane[3][4];
            uint8_t   octets[12];
            int       rgb[3];
            for (int p = 0; p < 3; p++)
                rgb[p] = i < 8 ? (i >> p & 1) * top
                               : (int)(random_uniform(1, 3, (uint32_t)bits, (uint64_t)(3 * i + p)) * top);
            for (int k = 0; k < 12; k++) image[k] = (uint16_t)rgb[k % 3];
            const VideoPlanes planes = {.at = {(uint8_t *)plane[0], (uint8_t *)plane[1], (uint8_t *)plane[2]},
                                        .stride = {4, 4, 4},
                                        .layout = PIXELS_420,
                                        .width = 2,
                                        .height = 2,
                                        .bits = bits};
            video_pixels(&planes, image_of(octets, image, 12, bits), true);
            const double Y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2], half = 1 << (bits - 1);
            const double cb = (rgb[2] - Y) / 1.8556 + half, cr = (rgb[0] - Y) / 1.5748 + half;
            const double want[3] = {Y, fmin(cb, top), fmin(cr, top)};
            for (int p = 0; p < 3; p++)
                CHECK_NEAR(bits == 8 ? *(uint8_t *)plane[p] : plane[p][0], want[p], 0.51 + top * 1e-5);
        }
}

/* Planes amid rows and columns that are not theirs: every sample of each is written, and nothing else. */
static void nothing_is_written_beside_the_planes(void **state)
{
    (void)state;
    enum { wide = 8, high = 6, guard = 4, stride = 32, rows = high + 2 * guard, untouched = 0xA5 };
    static const PixelLayout layout[] = {PIXELS_GREY, PIXELS_420, PIXELS_444, PIXELS_RGB};
    for (int k = 0; k < 8; k++) {
        const int            bits = k % 2 ? 16 : 8, octets = bits / 8;
        const bool           colour = layout[k / 2] != PIXELS_GREY;
        _Alignas(16) uint8_t plane[3][rows * 2 * stride];
        uint8_t              narrow[3 * wide * high];
        uint16_t             image[3 * wide * high];
        for (int i = 0; i < 3 * wide * high; i++) image[i] = (uint16_t)(i % 100);
        memset(plane, untouched, sizeof plane);
        VideoPlanes planes = {.layout = layout[k / 2], .width = wide, .height = high, .bits = bits == 8 ? 8 : 12};
        if (layout[k / 2] == PIXELS_RGB) planes.bits = bits;
        for (int p = 0; p < 3; p++) planes.at[p] = plane[p] + guard * 2 * stride + guard, planes.stride[p] = 2 * stride;
        video_pixels(&planes, image_of(narrow, image, 3 * wide * high, bits), colour);
        for (int p = 0; p < 3; p++) {
            const bool half = p > 0 && layout[k / 2] == PIXELS_420;
            const bool none = p > 0 && (layout[k / 2] == PIXELS_GREY || layout[k / 2] == PIXELS_RGB);
            const int  row = none ? 0 : (half ? wide / 2 : wide) * octets * (layout[k / 2] == PIXELS_RGB ? 3 : 1);
            const int  count = none ? 0 : half ? high / 2 : high;
            for (int y = 0; y < rows; y++)
                for (int x = 0; x < 2 * stride; x++) {
                    const bool within = y >= guard && y < guard + count && x >= guard && x < guard + row;
                    CHECK(within == (plane[p][y * 2 * stride + x] != untouched));
                }
        }
    }
}
#endif

static void addresses_are_parsed_strictly(void **state)
{
    (void)state;
    static const char *const wrong[] = {"",
                                        "udp://",
                                        "239.1.2.3:5004",
                                        "udp://@239.1.2.3:5004",
                                        "udp://239.1.2.3",
                                        "udp://239.1.2.3:",
                                        "udp://239.1.2.3:0",
                                        "udp://239.1.2.3:65536",
                                        "udp://239.1.2.3:5004/",
                                        "udp://239.1.2.3:5004 ",
                                        "udp://239.1.2:5004",
                                        "udp://239.1.2.256:5004",
                                        "udp://01.2.3.4:5004",
                                        "udp://1.2.3.4:05004",
                                        "udp://a:5004",
                                        "udp://localhost:5004",
                                        "udp://1.2.3.4.5:5004",
                                        "udp:/1.2.3.4:5004",
                                        "UDP://1.2.3.4:5004",
                                        "udp://-1.2.3.4:5",
                                        "udp://0.0.0.0:5004",
                                        "udp://250.1.2.3:5004",
                                        "udp://1.2.3.4:99999999999999999999",
                                        "udp://[::1]:5004"};
    StreamUrl                url = {{9}, 9};
    const char              *why = NULL;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        if (publish_stream_parse(&url, &why, wrong[i])) fail_msg("`%s` was taken", wrong[i]);
        CHECK(why && *why && url.port == 9);
    }
    assert_true(publish_stream_parse(&url, &why, "udp://239.1.2.3:65535"));
    assert_memory_equal(url.address, ((uint8_t[4]){239, 1, 2, 3}), 4);
    assert_int_equal(url.port, 65535);
    assert_true(publish_stream_multicast(&url));
    assert_true(publish_stream_parse(&url, &why, "udp://127.0.0.1:1") && !publish_stream_multicast(&url));
    assert_true(publish_stream_parse(&url, &why, "udp://255.255.255.255:1"));
}

static void contradictions_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *bands, *video, *stream, *codec;
        bool        good;
    } cases[] = {
        {"lwir", "", "", "ffv1", true},
#ifdef PITVIPER_VIDEO
        {"lwir", "a.mp4", "udp://127.0.0.1:5004", "h264", true},
        {"lwir,mwir", "", "udp://127.0.0.1:65533", "h264", true},
        {"lwir,mwir", "", "udp://127.0.0.1:65534", "h264", false},
        {"optical,lwir,mwir,radar", "", "udp://127.0.0.1:65530", "h264", false},
        {"lwir", "a.mkv", "", "ffv1", true},
        {"lwir", "folder", "", "ffv1", true},
        {"lwir", "folder.2", "", "h264", true},
        {"lwir", "a.avi", "", "h264", false},
        {"lwir", "a.xyz", "", "h264", false},
        {"lwir", "a.265", "", "h264", false},
        {"lwir", "folder.d/", "", "h264", true},
        {"lwir", "a/b.MOV", "", "h264", false},
        {"lwir", "a.mp4", "", "ffv1", false},
        {"lwir", "a.TS", "", "ffv1", false},
        {"lwir", "", "udp://127.0.0.1:5004", "ffv1", false},
        {"lwir", "", "udp://127.0.0.1", "h264", false},
#else
        {"lwir", "a.mp4", "", "h264", false},
        {"lwir", "", "udp://127.0.0.1:5004", "h264", false},
#endif
    };
    log_set_level((LogLevel)(LOG_ERROR + 1));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Config config = config_default();
        strcpy(config.sensor.bands, cases[i].bands);
        strcpy(config.publish.video, cases[i].video);
        strcpy(config.publish.stream, cases[i].stream);
        assert_int_equal(config_set(&config, "publish.video_codec", cases[i].codec, "test"), STATUS_OK);
        if ((config_check(&config) == STATUS_OK) != cases[i].good) fail_msg("case %zu", i);
    }
    log_set_level(LOG_INFO);
    assert_int_equal(video_kind("x/.mp4"), VIDEO_FOLDER);
    assert_int_equal(video_kind("x/a.Mp4"), VIDEO_MP4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#ifdef PITVIPER_VIDEO
        cmocka_unit_test(one_packet_for_each_image_and_the_same_bytes),
        cmocka_unit_test(grey_levels_come_back),
        cmocka_unit_test(colours_and_odd_sizes_come_back),
        cmocka_unit_test(colour_conversion_is_bt709),
        cmocka_unit_test(nothing_is_written_beside_the_planes),
#endif
        cmocka_unit_test(addresses_are_parsed_strictly),
        cmocka_unit_test(contradictions_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
