/* tests/sensor/test_video_outputs.c: what a video shows beside its bands, and where it goes: names of bands and boxes
 * of targets to the bit, files that a thread writes, streams over UDP that a receiver takes apart. The clock is set
 * forward in place of waiting. labels: alone */
#include "tests/check.h"

#ifndef PITVIPER_VIDEO
int main(void)
{
    printf("skipped: built without FFmpeg's libraries\n");
    return 77;
}
#else
#include "sensor/frame/frame_display.h"
#include "sensor/publish/images/picture_text.h"
#include "sensor/publish/video/consume_video.h"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <sys/socket.h>

enum { most_pixels = 2 * 360 * 48 };
static time_t clock_ahead_s;
static bool   clock_stands;

int clock_gettime(clockid_t id, struct timespec *out)
{
    static int (*next)(clockid_t, struct timespec *);
    if (!next) *(void **)&next = dlsym(RTLD_NEXT, "clock_gettime");
    const int result = next(id, out);
    if (clock_stands) *out = (struct timespec){.tv_sec = 1000000};
    out->tv_sec += clock_ahead_s;
    return result;
}

/* A frame of MWIR in grey and LWIR, which is in grey or in colour. */
static Frame *make_frame(int width, int height, int number, double unix_s, bool colour)
{
    static Frame frame;
    static float plane[4][most_pixels];
    frame = (Frame){.number = number, .unix_s = unix_s};
    frame.seen.picture.width = width, frame.seen.picture.height = height;
    for (int b = 0; b < 4; b++)
        for (int i = 0; i < width * height; i++)
            plane[b][i] = 0.25f + (float)(i % width % 16 + 3 * number + 5 * b) / 128 + (float)(i / width % 8) / 64;
    const FrameDisplay of = {.detector = detector_default_config(), .level = {0, 1}};
    frame.display[BAND_MWIR] = frame.display[BAND_LWIR] = of;
    frame.display[BAND_MWIR].planes = 1, frame.display[BAND_MWIR].plane[0] = plane[0];
    frame.display[BAND_LWIR].planes = colour ? 3 : 1;
    for (int c = 0; c < 3; c++) frame.display[BAND_LWIR].plane[c] = plane[1 + c];
    return &frame;
}

static const unsigned two_bands = 1u << BAND_MWIR | 1u << BAND_LWIR;

static Consumer *open_video(Config *config, VideoOf of, const char *codec)
{
    Consumer *consumer = NULL;
    assert_int_equal(config_set(config, "publish.video_codec", codec, "test"), STATUS_OK);
    of.config = config, of.rate_hz = 10;
    assert_int_equal(consume_video(&consumer, &of), STATUS_OK);
    assert_int_equal(consumer->begin(consumer), STATUS_OK);
    return consumer;
}

/* Decodes a file; returns its pictures, with the first plane of the last as 16 bits. codec: what it must be. */
static int decode(const char *path, const char *codec, uint16_t *last, double *first_s)
{
    AVFormatContext *in = NULL;
    AVPacket        *packet = av_packet_alloc();
    AVFrame         *frame = av_frame_alloc();
    int              count = 0;
    assert_int_equal(avformat_open_input(&in, path, NULL, NULL), 0);
    CHECK(avformat_find_stream_info(in, NULL) >= 0);
    const AVCodec *with = avcodec_find_decoder(in->streams[0]->codecpar->codec_id);
    assert_string_equal(with->name, codec);
    AVCodecContext *decoder = avcodec_alloc_context3(with);
    avcodec_parameters_to_context(decoder, in->streams[0]->codecpar);
    decoder->thread_count = 1;
    assert_int_equal(avcodec_open2(decoder, NULL, NULL), 0);
    for (bool more = true; more;) {
        more = av_read_frame(in, packet) >= 0;
        if (!more || packet->stream_index == 0) assert_int_equal(avcodec_send_packet(decoder, more ? packet : NULL), 0);
        av_packet_unref(packet);
        while (avcodec_receive_frame(decoder, frame) == 0) {
            if (count++ == 0 && first_s) *first_s = (double)frame->pts * av_q2d(in->streams[0]->time_base);
            for (int y = 0; last && y < frame->height; y++)
                memcpy(last + y * frame->width, frame->data[0] + y * frame->linesize[0], 2 * (size_t)frame->width);
        }
    }
    avcodec_free_context(&decoder);
    av_frame_free(&frame);
    av_packet_free(&packet);
    avformat_close_input(&in);
    return count;
}

/* ---- names and boxes ----------------------------------------------------------------------------- */

/* Each band's name 2 dots from the upper left of its tile, a dot being a pixel, or two from 320 columns on. Targets
 * have a box in either tile, with their marking, or their id, two pixels above it; below it where there is no room. */
static void names_and_boxes_are_in_each_tile(void **state)
{
    static uint16_t     got[most_pixels], want[most_pixels], tile[most_pixels];
    static TargetRecord target[4] = {{.id = {1, 2, 3}, .box = {20, 25, 60, 40}, .marking = "M1"},
                                     {.id = {1, 2, 4}, .box = {100, 3, 140, 20}},
                                     {.id = {1, 2, 5}, .box = {0, 0, 0, 0}, .marking = "hidden"},
                                     {.id = {1, 2, 6}, .box = {150, 12, 170, 20}, .marking = "x"}};
    for (int k = 0; k < 6; k++) {
        const int width = k % 2 ? 360 : 200, height = 48, labels = k / 2, times = width < 320 ? 1 : 2;
        static const enum VideoLabels label[3] = {VIDEO_LABELS_OFF, VIDEO_LABELS_BANDS, VIDEO_LABELS_TARGETS};
        Config                        config = config_default();
        char                          path[temp_name_size];
        snprintf(path, sizeof path, "%s/labels%d.mkv", (const char *)*state, k);
        snprintf(config.publish.video, sizeof config.publish.video, "%s", path);
        config.publish.klv = KLV_OFF;
        config.publish.video_labels = label[labels];
        Consumer *video = open_video(&config, (VideoOf){.to = VIDEO_TO_FILE, .bands = two_bands}, "ffv1");
        CHECK(!!(video->wants & WANT_TARGETS) == (labels == 2) && !(video->wants & WANT_FOOTPRINT));
        Frame *frame = make_frame(width, height, k, 100, false);
        frame->record.target = target, frame->record.target_count = 4;
        assert_int_equal(video->put(video, frame), STATUS_OK);
        assert_int_equal(video->close(video), STATUS_OK);
        assert_int_equal(decode(path, "ffv1", got, NULL), 1);
        for (int b = 0; b < 2; b++) {
            frame_display_quantise(tile, &frame->display[b ? BAND_LWIR : BAND_MWIR], (size_t)(width * height), 16);
            for (int y = 0; y < height; y++)
                memcpy(want + y * 2 * width + b * width, tile + y * width, (size_t)width * sizeof *want);
        }
        for (int b = 0; b < 2 && labels > 0; b++) {
            const int     x0 = b * width;
            const Drawing d = {want, 2 * width, height, 1, true, 65535, x0, x0 + width};
            for (int i = 0; i < 4 && labels == 2; i++) {
                const int *box = target[i].box;
                if (i == 2) continue;
                picture_text_box(&d, (const int[]){box[0] + x0, box[1], box[2] + x0, box[3]});
                /* a letter is 7 dots high, and hangs 2 below */
                const bool above = box[1] - 10 * times >= 2;
                picture_text_draw(&d, box[0] + x0, above ? box[1] - 2 - 9 * times : box[3] + 3 * times, times,
                                  i == 1 ? "1:2:4" : target[i].marking);
            }
            picture_text_draw(&d, x0 + 2 * times, 2 * times, times, b ? "lwir" : "mwir");
        }
        for (int i = 0; i < 2 * width * height; i++)
            if (got[i] != want[i])
                fail_msg("case %d: column %d row %d: %d, want %d", k, i % (2 * width), i / 2 / width, got[i], want[i]);
    }
}

/* A band in grey beside one in colour has the same value in all three; a band without a display is black. */
static void grey_and_colour_side_by_side(void **state)
{
    enum { width = 48, height = 32 };
    static uint16_t got[2 * width * height], grey[width * height], colour[3 * width * height];
    for (int dark = 0; dark < 2; dark++) {
        Config config = config_default();
        char   path[temp_name_size];
        snprintf(path, sizeof path, "%s/colour%d.mkv", (const char *)*state, dark);
        snprintf(config.publish.video, sizeof config.publish.video, "%s", path);
        config.publish.klv = KLV_OFF, config.publish.video_labels = VIDEO_LABELS_OFF;
        Consumer *video = open_video(&config, (VideoOf){.to = VIDEO_TO_FILE, .bands = two_bands}, "ffv1");
        Frame    *frame = make_frame(width, height, 2, 100, true);
        frame_display_quantise(grey, &frame->display[BAND_MWIR], width * height, 16);
        frame_display_quantise(colour, &frame->display[BAND_LWIR], width * height, 16);
        if (dark) frame->display[BAND_MWIR].planes = 0;
        assert_int_equal(video->put(video, frame), STATUS_OK);
        assert_int_equal(video->close(video), STATUS_OK);
        assert_int_equal(decode(path, "ffv1", got, NULL), 1);
        for (int i = 0; i < width * height; i++) { /* of planes G, B, R the first */
            const int row = i / width, column = i % width;
            assert_int_equal(got[row * 2 * width + column], dark ? 0 : grey[i]);
            assert_int_equal(got[row * 2 * width + width + column], colour[3 * i + 1]);
        }
    }
}

/* ---- files in a thread of their own -------------------------------------------------------------- */

/* A folder has an MPEG-TS and an MP4 a band, each written by its own thread: all frames of a run that no disk holds up.
 */
static void files_that_threads_write(void **state)
{
    enum { frames = 24 };
    Config config = config_default();
    char   path[temp_name_size];
    snprintf(config.publish.video, sizeof config.publish.video, "%s/apart", (const char *)*state);
    config.publish.klv = KLV_ASYNC;
    for (int host = 0; host < 2; host++) {
        const VideoOf of = {.to = VIDEO_TO_FILE,
                            .bands = two_bands,
                            .patient = true,
                            .apart = true,
                            .host_folder = host ? "host" : NULL};
        Consumer     *video = open_video(&config, of, "h264");
        CHECK(video->wants & WANT_FOOTPRINT);
        for (int n = 0; n < frames; n++) {
            static RenderRequest request;
            Frame               *frame = make_frame(48, 32, n, 100 + 0.1 * n, false);
            request.view = (View){.width = 48, .height = 32, .focal_px = 100};
            frame->record = (FrameRecord){
                .request = &request, .p_eye_ecef = {6378137, 0, 0}, .r_ecef_from_cam = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
            assert_int_equal(video->put(video, frame), STATUS_OK);
        }
        assert_int_equal(video->close(video), STATUS_OK);
        for (int b = 0; b < 2; b++)
            for (int kind = 0; kind < 2; kind++) {
                double first_s;
                snprintf(path, sizeof path, "%s/apart%s/%s.%s", (const char *)*state, host ? "/host" : "",
                         b ? "lwir" : "mwir", kind ? "mp4" : "ts");
                assert_int_equal(decode(path, "h264", NULL, &first_s), frames);
                CHECK_NEAR(first_s, kind ? 0 : 100, 1e-3);
            }
    }
}

/* ---- streams ------------------------------------------------------------------------------------- */

static int receiver(int *port)
{
    struct sockaddr_in own = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t          octets = sizeof own;
    const int          s = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0), room = 1 << 20;
    own.sin_port = htons((uint16_t)*port);
    setsockopt(s, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    if (bind(s, (const struct sockaddr *)&own, sizeof own) != 0) {
        close(s);
        return -1;
    }
    getsockname(s, (struct sockaddr *)&own, &octets);
    *port = ntohs(own.sin_port);
    return s;
}

/* What has arrived goes into a file; returns the datagrams, which are of whole packets of 188 octets, at most seven. */
static int drain(int s, const char *path)
{
    uint8_t octets[2048];
    int     count = 0;
    FILE   *file = path ? fopen(path, "wb") : NULL;
    CHECK(!path || file);
    for (ssize_t n; (n = recv(s, octets, sizeof octets, 0)) >= 0; count++) {
        CHECK(n > 0 && n <= 7 * 188 && n % 188 == 0);
        for (ssize_t i = 0; i < n; i += 188) CHECK(octets[i] == 0x47);
        if (file) CHECK(fwrite(octets, 1, (size_t)n, file) == (size_t)n);
    }
    if (file) CHECK(fclose(file) == 0);
    return count;
}

/* The time in the stream's first picture (ST 0604): after its name a status, then the microseconds, big-endian, with an
 * octet of 0xFF after each second one. */
static uint64_t stamp_of(const char *path)
{
    static uint8_t octets[1 << 20];
    FILE          *file = fopen(path, "rb");
    CHECK(file);
    const size_t   count = fread(octets, 1, sizeof octets, file);
    const uint8_t *at = memmem(octets, count, "MISPmicrosectime", 16);
    uint64_t       us = 0;
    fclose(file);
    CHECK(at && at + 28 <= octets + count);
    for (int i = 0; i < 11; i++) {
        if (i % 3 == 2) assert_int_equal(at[17 + i], 0xFF);
        else us = us << 8 | at[17 + i];
    }
    return us;
}

/* Two bands at a port and the next but one. */
static void streams_are_whole_at_their_receivers(void **state)
{
    enum { frames = 12 };
    Config         config = config_default();
    StreamCounters sent = {0};
    char           path[temp_name_size];
    int            port = 0, s[2] = {-1, -1};
    for (int tries = 0; tries < 50 && s[1] < 0; tries++) {
        if (s[0] >= 0) close(s[0]);
        port = 0;
        s[0] = receiver(&port);
        int next = port + 2;
        s[1] = receiver(&next);
    }
    CHECK(s[0] >= 0 && s[1] >= 0);
    snprintf(config.publish.stream, sizeof config.publish.stream, "udp://127.0.0.1:%d", port);
    config.publish.klv = KLV_OFF;
    Consumer *video = open_video(&config, (VideoOf){.to = VIDEO_TO_STREAM, .bands = two_bands, .sent = &sent}, "h264");
    for (int n = 0; n < frames; n++)
        assert_int_equal(video->put(video, make_frame(48, 32, n, 100.00000047 + 0.1 * n, false)), STATUS_OK);
    assert_int_equal(video->close(video), STATUS_OK);
    int received = 0;
    for (int b = 0; b < 2; b++) {
        double first_s;
        snprintf(path, sizeof path, "%s/received%d.ts", (const char *)*state, b);
        const int count = drain(s[b], path);
        received += count;
        CHECK(count >= frames); /* a frame is sent at once */
        assert_int_equal(decode(path, "h264", NULL, &first_s), frames);
        CHECK_NEAR(first_s, 100, 1e-3);
        CHECK(stamp_of(path) == 100000000); /* to the nearest */
        close(s[b]);
    }
    CHECK(sent.sent == (uint64_t)received && sent.refused == 0 && sent.no_route == 0 && sent.lost == 0);
}

static int  gone, back;
static char last[512];
static void listen_to(void *user, LogLevel level, const char *line)
{
    (void)user, (void)level;
    if (strstr(line, "no program receives it")) gone++;
    if (strstr(line, "received again")) back++, snprintf(last, sizeof last, "%s", line);
    if (strstr(line, "datagrams: sent=")) snprintf(last, sizeof last, "%s", line);
}

/* A receiver that is absent is reported once, and once more when it has been there again for two seconds. */
static void a_receiver_goes_and_comes(void **state)
{
    (void)state;
    Config         config = config_default();
    StreamCounters sent = {.sent = 1000, .refused = 2000, .no_route = 3000, .lost = 4000};
    int            port = 0, s = receiver(&port), n = 0;
    CHECK(s >= 0 && close(s) == 0);
    snprintf(config.publish.stream, sizeof config.publish.stream, "udp://127.0.0.1:%d", port);
    config.publish.klv = KLV_OFF;
    log_set_sink(listen_to, NULL);
    gone = back = 0;
    clock_stands = true;
    Consumer *video =
        open_video(&config, (VideoOf){.to = VIDEO_TO_STREAM, .bands = 1u << BAND_LWIR, .sent = &sent}, "h264");
    for (; n < 10; n++) assert_int_equal(video->put(video, make_frame(48, 32, n, 100 + 0.1 * n, false)), STATUS_OK);
    CHECK(gone == 1 && back == 0);
    s = receiver(&port);
    CHECK(s >= 0);
    for (; n < 13; n++) assert_int_equal(video->put(video, make_frame(48, 32, n, 100 + 0.1 * n, false)), STATUS_OK);
    CHECK(back == 0 && drain(s, NULL) > 0); /* not yet: a report may be late */
    clock_ahead_s += 1;
    assert_int_equal(video->put(video, make_frame(48, 32, n, 100 + 0.1 * n, false)), STATUS_OK), n++;
    CHECK(back == 0);
    clock_ahead_s += 1; /* two in all */
    for (; n < 16; n++) assert_int_equal(video->put(video, make_frame(48, 32, n, 100 + 0.1 * n, false)), STATUS_OK);
    CHECK(gone == 1 && back == 1 && drain(s, NULL) > 0);
    close(s);
    for (; n < 19; n++) assert_int_equal(video->put(video, make_frame(48, 32, n, 100 + 0.1 * n, false)), STATUS_OK);
    CHECK(gone == 2 && back == 1);
    assert_int_equal(video->close(video), STATUS_OK);
    log_set_sink(NULL, NULL);
    clock_stands = false;
    CHECK(sent.refused > 2000 && sent.sent > 1000 && sent.no_route == 3000 && sent.lost == 4000);
    char want[96];
    snprintf(want, sizeof want, "datagrams: sent=%d refused=%d no_route=0 lost=0", (int)sent.sent - 1000,
             (int)sent.refused - 2000);
    CHECK(strstr(last, want));
}

static void several_hosts_need_a_folder(void **state)
{
    (void)state;
    Config    config = config_default();
    Consumer *video;
    log_set_sink(check_listen, NULL);
    strcpy(config.publish.video, "/tmp/one.mkv");
    VideoOf of = {.config = &config, .to = VIDEO_TO_FILE, .bands = two_bands, .rate_hz = 10, .host_folder = "host"};
    assert_int_equal(consume_video(&video, &of), STATUS_UNSUPPORTED);
    *config.publish.video = 0;
    strcpy(config.publish.stream, "udp://127.0.0.1:5004");
    of.to = VIDEO_TO_STREAM;
    assert_int_equal(consume_video(&video, &of), STATUS_UNSUPPORTED);
    log_set_sink(NULL, NULL);
}

static int make_folder(void **state)
{
    static char folder[temp_path_size];
    *state = folder;
    return temp_folder(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    char command[temp_path_size + 16];
    snprintf(command, sizeof command, "rm -rf '%s'", (const char *)*state);
    return system(command);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_and_boxes_are_in_each_tile), cmocka_unit_test(grey_and_colour_side_by_side),
        cmocka_unit_test(files_that_threads_write),         cmocka_unit_test(streams_are_whole_at_their_receivers),
        cmocka_unit_test(a_receiver_goes_and_comes),        cmocka_unit_test(several_hosts_need_a_folder),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
#endif
