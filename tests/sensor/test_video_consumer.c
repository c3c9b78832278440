/* tests/sensor/test_video_consumer.c: videos in files: bands side by side to the bit, gaps in time, a full disk, an
 * encoder that fails, a run that is killed. Two functions of the libraries are replaced here: the encoder fails when
 * told to, and the clock is set forward in place of waiting. labels: alone */
#include "tests/check.h"

#ifndef PITVIPER_VIDEO
int main(void)
{
    printf("skipped: built without FFmpeg's libraries\n");
    return 77;
}
#else
#include "sensor/frame/frame_display.h"
#include "sensor/publish/video/consume_video.h"

#include <dlfcn.h>
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <signal.h>
#include <sys/resource.h>
#include <time.h>

enum { width = 48, height = 32, pixels = width * height };
static bool   encoder_fails;
static time_t clock_ahead_s;
static int    warnings, again; /* messages that the consumer goes on without something, and that it has it again */

int avcodec_send_frame(AVCodecContext *context, const AVFrame *frame)
{
    static int (*next)(AVCodecContext *, const AVFrame *);
    if (!next) *(void **)&next = dlsym(RTLD_NEXT, "avcodec_send_frame");
    return encoder_fails ? AVERROR_EXTERNAL : next(context, frame);
}

int clock_gettime(clockid_t id, struct timespec *out)
{
    static int (*next)(clockid_t, struct timespec *);
    if (!next) *(void **)&next = dlsym(RTLD_NEXT, "clock_gettime");
    const int result = next(id, out);
    out->tv_sec += clock_ahead_s;
    return result;
}

static void count_messages(void *user, LogLevel level, const char *line)
{
    (void)user, (void)level;
    warnings += strstr(line, "going on without") != NULL;
    again += strstr(line, " again; ") != NULL;
}

/* A frame of two bands, whose grey levels differ. */
static Frame *make_frame(int number, double unix_s)
{
    static Frame frame;
    static float plane[2][pixels];
    frame = (Frame){.number = number, .unix_s = unix_s};
    frame.seen.picture.width = width, frame.seen.picture.height = height;
    for (int b = 0; b < 2; b++) {
        for (int i = 0; i < pixels; i++)
            plane[b][i] = (float)(i % width + 3 * number + 20 * b) / 256 + (float)(i / width % 8) / 64;
        frame.display[b ? BAND_LWIR : BAND_MWIR] =
            (FrameDisplay){.planes = 1, .plane = {plane[b]}, .detector = detector_default_config(), .level = {0, 1}};
    }
    return &frame;
}

static Consumer *open_video(Config *config, const char *path, const char *codec, bool patient)
{
    Consumer *consumer = NULL;
    *config = config_default();
    snprintf(config->publish.video, sizeof config->publish.video, "%s", path);
    assert_int_equal(config_set(config, "publish.video_codec", codec, "test"), STATUS_OK);
    config->publish.klv = KLV_OFF;
    const VideoOf of = {.config = config,
                        .to = VIDEO_TO_FILE,
                        .bands = 1u << BAND_MWIR | 1u << BAND_LWIR,
                        .rate_hz = 10,
                        .patient = patient};
    assert_int_equal(consume_video(&consumer, &of), STATUS_OK);
    assert_int_equal(consumer->begin(consumer), STATUS_OK);
    CHECK(consumer->wants & WANT_DISPLAY);
    warnings = again = 0;
    return consumer;
}

/* Decodes a file; returns its pictures, and their times in s and the last one's first plane. */
static int decode(const char *path, double *time_s, int most, uint16_t *last)
{
    AVFormatContext *in = NULL;
    AVPacket        *packet = av_packet_alloc();
    AVFrame         *frame = av_frame_alloc();
    int              count = 0;
    assert_int_equal(avformat_open_input(&in, path, NULL, NULL), 0);
    CHECK(avformat_find_stream_info(in, NULL) >= 0);
    assert_int_equal(in->nb_streams, 1);
    AVCodecContext *decoder = avcodec_alloc_context3(avcodec_find_decoder(in->streams[0]->codecpar->codec_id));
    avcodec_parameters_to_context(decoder, in->streams[0]->codecpar);
    decoder->thread_count = 1;
    assert_int_equal(avcodec_open2(decoder, NULL, NULL), 0);
    for (bool more = true; more;) {
        more = av_read_frame(in, packet) >= 0;
        assert_int_equal(avcodec_send_packet(decoder, more ? packet : NULL), 0);
        av_packet_unref(packet);
        while (avcodec_receive_frame(decoder, frame) == 0) {
            CHECK(count < most && !frame->decode_error_flags);
            time_s[count++] = (double)frame->pts * av_q2d(in->streams[0]->time_base);
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

static void bands_are_side_by_side_to_the_bit(void **state)
{
    static uint16_t image[2 * pixels], band[pixels];
    Config          config;
    char            path[temp_name_size];
    double          time_s[8];
    snprintf(path, sizeof path, "%s/both.mkv", (const char *)*state);
    Consumer *video = open_video(&config, path, "ffv1", false);
    /* the third of four is left out, and the clock of the exercise stands still once */
    static const double at_s[] = {0, 0.1, 0.3, 0.3};
    for (int f = 0; f < 4; f++) assert_int_equal(video->put(video, make_frame(f, 1.8e9 + at_s[f])), STATUS_OK);
    assert_int_equal(video->close(video), STATUS_OK);
    assert_int_equal(decode(path, time_s, 8, image), 4);
    for (int f = 0; f < 3; f++) CHECK_NEAR(time_s[f], at_s[f], 0.0006); /* Matroska counts ms */
    const Frame *frame = make_frame(3, 0);
    for (int b = 0; b < 2; b++) {
        frame_display_quantise(band, &frame->display[b ? BAND_LWIR : BAND_MWIR], pixels, 16);
        for (int y = 0; y < height; y++)
            assert_memory_equal(image + y * 2 * width + b * width, band + y * width, width * sizeof *band);
    }
}

/* Time stamps of MPEG-TS have 33 bits: they wrap after 95443.7 s; and exercises may be before 1970. */
static void time_stamps_wrap(void **state)
{
    static const double begin_s[] = {95443.3, -0.45, -1e9};
    Config              config;
    char                path[temp_name_size];
    double              time_s[16];
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/wraps%d.ts", (const char *)*state, i);
        Consumer *video = open_video(&config, path, "h264", false);
        for (int f = 0; f < 10; f++)
            assert_int_equal(video->put(video, make_frame(f, begin_s[i] + 0.1 * f)), STATUS_OK);
        assert_int_equal(video->close(video), STATUS_OK);
        assert_int_equal(decode(path, time_s, 16, NULL), 10);
        for (int f = 1; f < 10; f++) CHECK_NEAR(time_s[f] - time_s[f - 1], 0.1, 3e-5);
        CHECK_NEAR(remainder(time_s[0] - begin_s[i], 0x1p33 / 90000), 0, 3e-5);
    }
}

/* MP4 and Matroska lose what they keep at that moment, from a key frame on. */
static void disk_full_for_a_while(const char *path, int frames_least)
{
    struct rlimit before, small;
    Config        config;
    double        time_s[80];
    Consumer     *video = open_video(&config, path, "h264", true);
    getrlimit(RLIMIT_FSIZE, &before);
    for (int f = 0; f < 15; f++) assert_int_equal(video->put(video, make_frame(f, 100 + 0.1 * f)), STATUS_OK);
    small = (struct rlimit){1024, before.rlim_max}; /* less than there is: every write fails with EFBIG */
    setrlimit(RLIMIT_FSIZE, &small);
    for (int f = 15; f < 40; f++) {
        assert_int_equal(video->put(video, make_frame(f, 100 + 0.1 * f)), STATUS_OK);
        if (f == 30) clock_ahead_s += 11; /* a try that fails again is not reported */
    }
    assert_int_equal(warnings, 1);
    setrlimit(RLIMIT_FSIZE, &before);
    clock_ahead_s += 11;
    for (int f = 40; f < 60; f++) assert_int_equal(video->put(video, make_frame(f, 100 + 0.1 * f)), STATUS_OK);
    assert_int_equal(again, 1);
    assert_int_equal(video->close(video), STATUS_OK);
    const int count = decode(path, time_s, 80, NULL);
    print_message("%s: %d of 60 pictures\n", path, count);
    CHECK(count >= frames_least && count <= 45);
    for (int i = 1; i < count; i++) CHECK(time_s[i] > time_s[i - 1]);
    CHECK_NEAR(time_s[count - 1] - time_s[0], 5.9, 1e-3);
}

static void a_full_disk_is_survived(void **state)
{
    char path[temp_name_size];
    static const struct {
        const char *name;
        int         least;
    } cases[] = {{"full.ts", 35}, {"full.mkv", 30}, {"full.mp4", 30}};
    signal(SIGXFSZ, SIG_IGN);
    log_set_sink(count_messages, NULL);
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/%s", (const char *)*state, cases[i].name);
        disk_full_for_a_while(path, cases[i].least);
    }
    log_set_sink(NULL, NULL);
}

static void a_full_disk_ends_a_replay(void **state)
{
    struct rlimit before;
    Config        config;
    char          path[temp_name_size];
    signal(SIGXFSZ, SIG_IGN);
    log_set_level((LogLevel)(LOG_ERROR + 1));
    getrlimit(RLIMIT_FSIZE, &before);
    snprintf(path, sizeof path, "%s/ends.ts", (const char *)*state);
    Consumer *video = open_video(&config, path, "h264", false);
    assert_int_equal(video->put(video, make_frame(0, 100)), STATUS_OK);
    setrlimit(RLIMIT_FSIZE, &(struct rlimit){16, before.rlim_max});
    assert_int_equal(video->put(video, make_frame(1, 101)), STATUS_IO);
    setrlimit(RLIMIT_FSIZE, &before);
    video->close(video);
    log_set_level(LOG_INFO);
}

static void a_failing_encoder_is_survived(void **state)
{
    Config config;
    char   path[temp_name_size];
    double time_s[80];
    snprintf(path, sizeof path, "%s/failing.ts", (const char *)*state);
    log_set_sink(count_messages, NULL);
    Consumer *video = open_video(&config, path, "h264", true);
    for (int f = 0; f < 40; f++) {
        encoder_fails = f >= 13 && f < 20;
        if (f == 25) clock_ahead_s += 11;
        assert_int_equal(video->put(video, make_frame(f, 100 + 0.1 * f)), STATUS_OK);
    }
    assert_int_equal(video->close(video), STATUS_OK);
    CHECK(warnings == 1 && again == 1);
    assert_int_equal(decode(path, time_s, 80, NULL), 40 - (25 - 13));
    CHECK_NEAR(time_s[13] - time_s[12], 1.3, 1e-3); /* a gap, no slip */
    snprintf(path, sizeof path, "%s/ends.mp4", (const char *)*state);
    video = open_video(&config, path, "h264", false);
    encoder_fails = true;
    assert_int_equal(video->put(video, make_frame(0, 100)), STATUS_IO);
    encoder_fails = false;
    video->close(video);
    log_set_sink(NULL, NULL);
}

/* What is in the file before it is closed: at least up to the last key frame. */
static void a_killed_run_leaves_a_film(void **state)
{
    static const char *const names[] = {"killed.mp4", "killed.mkv", "killed.ts"};
    Config                   config;
    char                     path[temp_name_size];
    double                   time_s[80];
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/%s", (const char *)*state, names[i]);
        Consumer *video = open_video(&config, path, "h264", false);
        for (int f = 0; f < 35; f++) assert_int_equal(video->put(video, make_frame(f, 100 + 0.1 * f)), STATUS_OK);
        const int count = decode(path, time_s, 80, NULL);
        print_message("%s: %d of 35 pictures\n", names[i], count);
        CHECK(count >= (i == 1 ? 20 : 30));
        assert_int_equal(video->close(video), STATUS_OK);
        assert_int_equal(decode(path, time_s, 80, NULL), 35);
    }
}

static void names_and_addresses(void **state)
{
    Config config = config_default();
    char   text[1024], found[video_path_size];
    strcpy(config.publish.stream, "udp://239.1.2.3:5004");
    video_watch_lines(text, sizeof text, &config, 1u << BAND_MWIR | 1u << BAND_LWIR);
    CHECK(strstr(text, "mwir") && strstr(text, "ffplay") && strstr(text, "udp://239.1.2.3:5004 ") &&
          strstr(text, "lwir") && strstr(text, "vlc udp://@239.1.2.3:5006\n"));
    strcpy(config.publish.stream, "udp://10.1.2.3:5004");
    video_watch_lines(text, sizeof text, &config, 1u << BAND_RADAR);
    CHECK(strstr(text, "vlc udp://@:5004\n"));
    snprintf(config.publish.video, sizeof config.publish.video, "%s/v", (const char *)*state);
    CHECK(!video_earlier(found, &config, 1u << BAND_LWIR, NULL));
    snprintf(config.publish.video, sizeof config.publish.video, "%s/killed.ts", (const char *)*state);
    CHECK(video_earlier(found, &config, 1u << BAND_LWIR, NULL) && strstr(found, "killed.ts"));
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
        cmocka_unit_test(bands_are_side_by_side_to_the_bit),
        cmocka_unit_test(a_full_disk_is_survived),
        cmocka_unit_test(time_stamps_wrap),
        cmocka_unit_test(a_full_disk_ends_a_replay),
        cmocka_unit_test(a_failing_encoder_is_survived),
        cmocka_unit_test(a_killed_run_leaves_a_film),
        cmocka_unit_test(names_and_addresses),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
#endif
