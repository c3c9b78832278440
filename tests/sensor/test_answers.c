/* Answers of a recogniser: PVDETECT datagrams of all versions, octet by octet; those that are received: which frame
 * they are about, what is kept, counted and written. JSON: test_answer_json.c; KLV: test_answer_klv.c. */
#include "tests/sensor/answer_lab.h"

#include "sensor/frame/target_record.h"

#include <pitviper_memory.h>

/* ---- PVDETECT ---------------------------------------------------------------------------------------------- */

static PitviperDetections detections_of(int frame, uint32_t band, uint32_t count)
{
    PitviperDetections d = {.byte_order = PITVIPER_MEMORY_BYTE_ORDER,
                            .version = PITVIPER_DETECTIONS_VERSION,
                            .detection_size = sizeof(PitviperDetection),
                            .frame = frame,
                            .band = band,
                            .count = count};
    memcpy(d.magic, PITVIPER_DETECTIONS_MAGIC, sizeof d.magic);
    for (uint32_t i = 0; i < pitviper_detections_most; i++)
        d.detection[i] = (PitviperDetection){.left = (float)i,
                                             .top = 0,
                                             .right = (float)i + 1,
                                             .bottom = 48,
                                             .score = 0.5f,
                                             .track = i,
                                             .class_name = "tank"};
    return d;
}

static AnswerReason parse(const PitviperDetections *d, size_t size)
{
    Answer out;
    return answer_read(&out, (const uint8_t *)d, size, &answer_scope);
}

static void each_octet_of_a_detection_is_checked(void **state)
{
    (void)state;
    const PitviperDetections good = detections_of(3, BAND_LWIR, 2);
    PitviperDetections       d;
    const size_t             size = PITVIPER_DETECTIONS_SIZE(2);
    CHECK(parse(&good, size) == ANSWER_GOOD);
    CHECK(parse(&good, size - 1) == ANSWER_SIZE && parse(&good, size + 1) == ANSWER_SIZE);
    CHECK(parse(&good, 31) == ANSWER_SIZE && parse(&good, sizeof good) == ANSWER_SIZE);
    const PitviperDetections none = detections_of(3, BAND_LWIR, 0), all = detections_of(3, BAND_LWIR, 64);
    CHECK(parse(&none, PITVIPER_DETECTIONS_SIZE(0)) == ANSWER_GOOD && parse(&all, sizeof all) == ANSWER_GOOD);
#define SPOILT(change, reason)                                                                                         \
    d = good;                                                                                                          \
    change;                                                                                                            \
    CHECK(parse(&d, size) == (reason))
    SPOILT(d.magic[7] = 0, ANSWER_MAGIC);
    SPOILT(d.byte_order = 0x04030201, ANSWER_ORDER);
    SPOILT(d.version = 0, ANSWER_VERSION);
    SPOILT(d.version = 4, ANSWER_VERSION);
    SPOILT(d.version = 2, ANSWER_VERSION); /* with the size of another */
    SPOILT(d.version = 1, ANSWER_VERSION); /* with the size of another */
    SPOILT(d.detection_size = 49, ANSWER_VERSION);
    SPOILT(d.count = 65, ANSWER_COUNT);
    SPOILT(d.count = UINT32_MAX, ANSWER_COUNT);
    SPOILT(d.band = BAND_MWIR, ANSWER_BAND); /* not rendered */
    SPOILT(d.band = UINT32_MAX, ANSWER_BAND);
    SPOILT(d.reserved = 1, ANSWER_RESERVED);
    SPOILT(d.detection[1].reserved[1] = 1, ANSWER_RESERVED);
    SPOILT(d.detection[1].left = NAN, ANSWER_BOX);
    SPOILT(d.detection[1].left = -1, ANSWER_BOX);
    SPOILT(d.detection[1].right = 64.5f, ANSWER_BOX);
    SPOILT(d.detection[1].right = d.detection[1].left, ANSWER_BOX);
    SPOILT(d.detection[1].bottom = INFINITY, ANSWER_BOX);
    SPOILT(d.detection[1].top = 48, ANSWER_BOX);
    SPOILT(d.detection[1].score = 1.01f, ANSWER_SCORE);
    SPOILT(d.detection[1].score = NAN, ANSWER_SCORE);
    SPOILT(memset(d.detection[1].class_name, 'a', sizeof d.detection[1].class_name), ANSWER_TEXT);
    SPOILT(d.detection[1].class_name[1] = '\n', ANSWER_TEXT);
    SPOILT(d.detection[1].class_name[9] = 'x', ANSWER_TEXT); /* behind the end */
    /* what version 3 has behind it */
    SPOILT(d.detection[1].flags = 4, ANSWER_RESERVED);
    SPOILT(d.detection[1].los_az_rad = 0.1f, ANSWER_SIGHT); /* which it does not have, by its flags */
    SPOILT(d.detection[1].los_el_rad = NAN, ANSWER_SIGHT);
    SPOILT(d.detection[1].flags = PITVIPER_DETECTION_NO_BOX, ANSWER_BOX);
    SPOILT(d.detection[1].range_m = -1, ANSWER_RANGE);
    SPOILT(d.detection[1].range_m = NAN, ANSWER_RANGE);
    SPOILT(d.detection[1].range_m = INFINITY, ANSWER_RANGE);
    d = good;
    d.detection[1].flags = PITVIPER_DETECTION_SIGHT;
    d.detection[1].los_az_rad = 6, d.detection[1].los_el_rad = -1.5f;
    CHECK(parse(&d, size) == ANSWER_GOOD);
    for (int k = 0; k < 4; k++) { /* each of its numbers, without a value or out of range */
        static const float bad[4] = {NAN, INFINITY, -7, 7};
        const float        kept = d.detection[1].los_el_rad;
        d.detection[1].los_el_rad = bad[k];
        CHECK(parse(&d, size) == ANSWER_SIGHT);
        d.detection[1].los_el_rad = kept;
    }
    d.detection[1].los_az_rad = 6.3f;
    CHECK(parse(&d, size) == ANSWER_SIGHT);
    d.detection[1].flags |= PITVIPER_DETECTION_NO_BOX; /* with a box all the same */
    CHECK(parse(&d, size) == ANSWER_BOX);
}

static const AnswerDetection *only(Answer *out, const PitviperDetections *d)
{
    CHECK(answer_read(out, (const uint8_t *)d, PITVIPER_DETECTIONS_SIZE(1), &answer_scope) == ANSWER_GOOD);
    CHECK(out->form == ANSWER_RING && out->count == 1 && out->numbered && out->frame == d->frame && !out->timed);
    return &out->detection[0];
}

/* Version 3: a box, a line of sight, or both; a range. A program that leaves zeros there means a box alone. */
static void a_line_of_sight_in_version_3(void **state)
{
    (void)state;
    Answer                 out;
    PitviperDetections     d = detections_of(3, BAND_LWIR, 1);
    const AnswerDetection *one = only(&out, &d);
    CHECK(one->box_px[3] == 48 && isnan(one->los_rad[0]) && isnan(one->los_rad[1]) && isnan(one->range_m));
    d.detection[0].flags = PITVIPER_DETECTION_SIGHT;
    d.detection[0].los_az_rad = -0.5f, d.detection[0].los_el_rad = 0.25f, d.detection[0].range_m = 1250;
    one = only(&out, &d);
    CHECK(one->box_px[3] == 48 && one->los_rad[1] == 0.25 && one->range_m == 1250);
    CHECK_NEAR(one->los_rad[0], 2 * 3.141592653589793 - 0.5, 1e-15);
    d.detection[0].flags |= PITVIPER_DETECTION_NO_BOX;
    d.detection[0].right = d.detection[0].bottom = 0;
    one = only(&out, &d);
    for (int k = 0; k < 4; k++) CHECK(isnan(one->box_px[k]));
    CHECK(one->los_rad[1] == 0.25 && one->score == 0.5 && strcmp(one->class_name, "tank") == 0);
}

/* A datagram of an older version, of which a detection has so many octets and a class so many. */
static size_t older(uint8_t *bytes, int version, size_t octets, size_t class_octets, int count)
{
    const size_t       head = PITVIPER_DETECTIONS_SIZE(0);
    PitviperDetections d = detections_of(3, BAND_LWIR, (uint32_t)count);
    d.version = (uint16_t)version, d.detection_size = (uint16_t)octets;
    memcpy(bytes, &d, head);
    for (int i = 0; i < count; i++) {
        uint8_t *at = bytes + head + (size_t)i * octets;
        memcpy(at, &d.detection[i], 24 + class_octets);
        memset(at + 24 + class_octets, 0, 8);
    }
    return head + (size_t)count * octets;
}

/* Our own names fit, the longest too; and so do datagrams of versions 2 and 1, whose classes have 31 and 15 characters.
 */
static void older_versions_and_long_classes(void **state)
{
    (void)state;
    enum { count = 3 };
    static const struct {
        size_t octets, class_octets;
    } version[] = {{48, 16}, {64, 32}};
    Answer             out;
    uint8_t            bytes[sizeof(PitviperDetections)];
    const size_t       head = PITVIPER_DETECTIONS_SIZE(0);
    PitviperDetections d = detections_of(3, BAND_LWIR, count);
    for (int k = 1; k <= target_class_count(); k++) {
        CHECK(strlen(target_class_name(k)) < sizeof d.detection[0].class_name);
        memset(d.detection[2].class_name, 0, sizeof d.detection[2].class_name);
        strcpy(d.detection[2].class_name, target_class_name(k));
        CHECK(answer_read(&out, (const uint8_t *)&d, PITVIPER_DETECTIONS_SIZE(count), &answer_scope) == ANSWER_GOOD);
        assert_string_equal(out.detection[2].class_name, target_class_name(k));
    }
    for (int v = 0; v < 2; v++) {
        const size_t octets = version[v].octets, letters = version[v].class_octets;
        const size_t size = older(bytes, v + 1, octets, letters, count);
        CHECK(answer_read(&out, bytes, size, &answer_scope) == ANSWER_GOOD);
        CHECK(out.count == count && out.detection[2].box_px[2] == 3 && out.detection[2].track == 2 &&
              strcmp(out.detection[2].class_name, "tank") == 0 && isnan(out.detection[2].los_rad[0]));
        for (size_t cut = 0; cut < size; cut++) CHECK(answer_read(&out, bytes, cut, &answer_scope) != ANSWER_GOOD);
        uint8_t *last = bytes + head + 2 * octets;
        memset(last + 24, 'a', letters - 1);
        CHECK(answer_read(&out, bytes, size, &answer_scope) == ANSWER_GOOD &&
              strlen(out.detection[2].class_name) == letters - 1);
        last[24 + letters - 1] = 'a'; /* without an end */
        CHECK(answer_read(&out, bytes, size, &answer_scope) == ANSWER_TEXT);
        last[24 + letters - 1] = 0;
        bytes[head + octets + octets - 4] = 1;
        CHECK(answer_read(&out, bytes, size, &answer_scope) == ANSWER_RESERVED);
    }
    CHECK(answer_read(&out, (const uint8_t *)"", 0, &answer_scope) == ANSWER_SIZE);
    CHECK(answer_read(&out, (const uint8_t *)"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[", 34, &answer_scope) == ANSWER_MAGIC);
}

/* ---- what is received --------------------------------------------------------------------------------------- */

static void the_newest_answers_are_kept(void **state)
{
    (void)state;
    static const size_t size = PITVIPER_DETECTIONS_SIZE(1);
    static const char   json_four[] = "{\"frame\":4,\"band\":\"lwir\",\"detections\":[]}", half[] = "{\"frame\":6";
    Answers            *second = NULL;
    static Answer       got;
    AnswerCounters      count;
    int                 port;
    const int           from = socket(AF_INET, SOCK_DGRAM, 0);
    log_set_sink(check_listen, NULL);
    Answers *to = open_answers(&port, NULL);
    CHECK(answers_open(&second, &(AnswersOf){port, answer_scope}) == STATUS_IO);
    CHECK(strstr(check_said, "publish.detections_port"));
    CHECK(!answers_latest(to, BAND_LWIR, &got));

    const PitviperDetections five = detections_of(5, BAND_LWIR, 1), six = detections_of(6, BAND_LWIR, 1);
    deliver(to, from, port, &five, size); /* no such frame yet */
    CHECK(!answers_latest(to, BAND_LWIR, &got));
    for (int n = 0; n <= 6; n++) tell_frame(to, n, 0.1 * n, 1000 + 0.1 * n, 0, 0);
    deliver(to, from, port, &six, size);
    deliver(to, from, port, &five, size); /* late */
    deliver(to, from, port, &six, size - 1);
    PitviperDetections again = six;
    strcpy(again.detection[0].class_name, "truck");
    deliver(to, from, port, &again, size);                    /* it has been answered */
    deliver(to, from, port, json_four, sizeof json_four - 1); /* late, in another form */
    deliver(to, from, port, json_four, sizeof json_four - 1); /* repeated */
    deliver(to, from, port, half, sizeof half - 1);
    CHECK(answers_latest(to, BAND_LWIR, &got) && got.frame == 6 && got.time_s == 0.1 * 6 && got.count == 1);
    CHECK(got.unix_s == 1000 + 0.1 * 6 && strcmp(got.detection[0].class_name, "tank") == 0);
    for (int n = 7; n < 7 + answer_frames_kept; n++) tell_frame(to, n, 0.1 * n, 0, 0, 0);
    deliver(to, from, port, &six, size); /* too old */
    answers_close(to, &count);
    const uint64_t *ring = count.datagrams[ANSWER_RING], *json = count.datagrams[ANSWER_JSON];
    CHECK(ring[ANSWER_GOOD] == 1 && ring[ANSWER_FRAME] == 2 && ring[ANSWER_LATE] == 1 && ring[ANSWER_SIZE] == 1 &&
          ring[ANSWER_REPEATED] == 1 && count.lost_kernel == 0 && count.lines == 0);
    CHECK(json[ANSWER_LATE] == 1 && json[ANSWER_REPEATED] == 1 && json[ANSWER_NO_JSON] == 1);
    CHECK(strstr(check_said, "1 datagrams taken; refused size 1, json 1, unknown_frame 2, late 2, repeated 2"));
    log_set_sink(NULL, NULL);
    close(from);
}

/* Sends a line of JSON about a frame and says what became of it. */
static AnswerReason told(Answers *to, int from, int port, const void *octets, size_t size, AnswerForm form)
{
    AnswerCounters before, after;
    answers_counters(to, &before);
    deliver(to, from, port, octets, size);
    answers_counters(to, &after);
    for (int i = 0; i < ANSWER_REASONS; i++)
        if (after.datagrams[form][i] != before.datagrams[form][i]) return (AnswerReason)i;
    return ANSWER_REASONS;
}

/* A VMTI local set without targets, by its time, its number (negative: none), or both. */
static size_t nothing_found(uint8_t out[64], int64_t time_us, int number)
{
    static const uint8_t key[16] = {0x06, 0x0E, 0x2B, 0x34, 0x02, 0x0B, 0x01, 0x01,
                                    0x0E, 0x01, 0x03, 0x03, 0x06, 0x00, 0x00, 0x00};
    size_t               at = 17;
    unsigned             sum = 0;
    memcpy(out, key, sizeof key);
    if (time_us >= 0) {
        out[at++] = 2, out[at++] = 8;
        for (int k = 7; k >= 0; k--) out[at++] = (uint8_t)(time_us >> 8 * k);
    }
    if (number >= 0) {
        out[at++] = 7, out[at++] = 3;
        for (int k = 2; k >= 0; k--) out[at++] = (uint8_t)(number >> 8 * k);
    }
    out[at++] = 1, out[at++] = 2;
    out[16] = (uint8_t)(at + 2 - 17);
    for (size_t i = 0; i < at; i++) sum += i % 2 ? out[i] : (unsigned)out[i] << 8;
    out[at++] = (uint8_t)(sum >> 8), out[at++] = (uint8_t)sum;
    return at;
}

/* KLV names its frame by the exercise time, to 100 us, by the low 24 bits of its number, or by both, which must agree.
 */
static void a_frame_by_its_time_or_number(void **state)
{
    (void)state;
    static const int64_t second = 1750000000000000;
    static const struct {
        int64_t      time_us;
        int          number;
        AnswerReason reason;
        int          frame;
    } of[] = {{second + 1 * 20000 + 99, -1, ANSWER_GOOD, 16777217},
              {second + 2 * 20000 - 100, -1, ANSWER_GOOD, 16777218},
              {second + 3 * 20000 + 101, -1, ANSWER_FRAME, 0},
              {second + 3 * 20000 - 101, -1, ANSWER_FRAME, 0},
              {-1, 4, ANSWER_GOOD, 16777220},
              {-1, 4, ANSWER_REPEATED, 0},
              {-1, 50, ANSWER_FRAME, 0},
              {second + 5 * 20000, 6, ANSWER_FRAME, 0},
              {second + 5 * 20000, 5, ANSWER_GOOD, 16777221},
              {second + 6 * 20000 + 50, -1, ANSWER_GOOD, 16777222}, /* the nearer one of two that are 120 us apart */
              {second + 6 * 20000 + 80, -1, ANSWER_GOOD, 16777223},
              {0, -1, ANSWER_FRAME, 0},
              {INT64_MAX, -1, ANSWER_FRAME, 0}};
    static Answer got;
    uint8_t       octets[64];
    int           port;
    const int     from = socket(AF_INET, SOCK_DGRAM, 0);
    log_set_sink(check_listen, NULL);
    Answers *to = open_answers(&port, NULL);
    for (int n = 0; n < 7; n++) tell_frame(to, (1 << 24) + n, 0.02 * n, 1750000000 + 0.02 * n, 0, 0);
    tell_frame(to, (1 << 24) + 7, 0.12012, 1750000000.12012, 0, 0);
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        const AnswerReason reason =
            told(to, from, port, octets, nothing_found(octets, of[i].time_us, of[i].number), ANSWER_KLV);
        if (reason != of[i].reason) fail_msg("%zu: %s", i, answer_reason_name[reason]);
        if (reason == ANSWER_GOOD)
            CHECK(answers_latest(to, BAND_LWIR, &got) && got.frame == of[i].frame && got.count == 0);
    }
    answers_close(to, NULL);
    log_set_sink(NULL, NULL);
    close(from);
}

/* A flood of answers to three frames, in two forms: each datagram is in a count, and three are written. */
static void a_flood_is_counted_and_bounded(void **state)
{
    (void)state;
    enum { sent = 20000, frames = 3 };
    char           folder[] = "/tmp/pitviper-answers-XXXXXX", path[64], line[512];
    AnswerCounters count;
    int            port, lines = 0;
    CHECK(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/answers.jsonl", folder);
    log_set_sink(check_listen, NULL);
    Answers                 *to = open_answers(&port, folder);
    const int                from = socket(AF_INET, SOCK_DGRAM, 0);
    const struct sockaddr_in node = {
        .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    PitviperDetections answer[frames];
    for (int n = 0; n < frames; n++) {
        answer[n] = detections_of(n, BAND_LWIR, 2);
        strcpy(answer[n].detection[1].class_name, "surveillance_aircraft");
        answer[n].detection[1].score = 0.9f;
        tell_frame(to, n, 0.25 * n, 0, wall_clock_s(), 0);
        deliver(to, from, port, &answer[n], PITVIPER_DETECTIONS_SIZE(2));
    }
    for (int i = frames; i < sent; i++) {
        static const char again[] = "{\"frame\":2,\"band\":\"lwir\",\"detections\":[]}";
        const void       *octets = i % 2 ? (const void *)again : &answer[i % frames];
        CHECK(sendto(from, octets, i % 2 ? sizeof again - 1 : PITVIPER_DETECTIONS_SIZE(2), 0,
                     (const struct sockaddr *)&node, sizeof node) > 0);
    }
    answers_close(to, &count);
    uint64_t all = count.lost_kernel;
    for (int i = 0; i < ANSWER_REASONS; i++) all += answer_datagrams(&count, (AnswerReason)i);
    CHECK(all == sent && answer_datagrams(&count, ANSWER_GOOD) == frames && count.lines == 2 * frames &&
          count.lines_failed == 0);
    CHECK(answer_datagrams(&count, ANSWER_REPEATED) + count.lost_kernel == sent - frames);
    FILE *file = fopen(path, "r");
    CHECK(file);
    for (; fgets(line, sizeof line, file); lines++) {
        char want[256];
        if (lines % 2 == 0) continue;
        snprintf(
            want, sizeof want,
            "{\"frame\":%d,\"band\":\"lwir\",\"time_s\":%.15g%s,\"answer\":2,\"of\":2,\"class\":\"surveillance_aircraft\","
            "\"box_px\":[1.0,0.0,2.0,48.0],\"score\":0.9,\"track\":1,\"latency_ms\":",
            lines / 2, 0.25 * (lines / 2), lines / 2 ? "" : ".0");
        if (strncmp(line, want, strlen(want)) != 0) printf("%s\n%s", want, line);
        CHECK(strncmp(line, want, strlen(want)) == 0 && strstr(line, ",\"late\":false,\"form\":\"ring\"}"));
    }
    CHECK(lines == 2 * frames);
    fclose(file);
    unlink(path);
    rmdir(folder);
    log_set_sink(NULL, NULL);
    close(from);
}

static double ms_of(const char *line, const char *name)
{
    const char *at = strstr(line, name);
    return at ? strtod(at + strlen(name), NULL) : NAN;
}

/* A line's numbers: boxes to 1e-4 px and scores to 1e-6, as they were sent and not as a float has them; milliseconds
 * from the end of the rendering and from the frame's instant until the answer came, absent where these are not known.
 */
static void an_answer_in_its_line(void **state)
{
    (void)state;
    static const char json[] =
        "{\"frame\":1,\"band\":\"lwir\",\"detections\":[{\"class\":\"jeep\",\"los_deg\":[-10,2.5],"
        "\"range_m\":1200.25}]}";
    char folder[] = "/tmp/pitviper-answers-XXXXXX", path[64], line[2][512];
    int  port;
    CHECK(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/answers.jsonl", folder);
    log_set_sink(check_listen, NULL);
    Answers           *to = open_answers(&port, folder);
    const int          from = socket(AF_INET, SOCK_DGRAM, 0);
    const double       rendered_s = wall_clock_s() - 10;
    PitviperDetections answer = detections_of(0, BAND_LWIR, 1);
    answer.detection[0].left = 10.1234f, answer.detection[0].right = 20.05f, answer.detection[0].score = 0.123457f;
    tell_frame(to, 0, 1, 0, rendered_s, rendered_s - 5);
    tell_frame(to, 1, 2, 0, 0, 0);
    const double before_ms = 1e3 * (wall_clock_s() - rendered_s);
    deliver(to, from, port, &answer, PITVIPER_DETECTIONS_SIZE(1));
    const double after_ms = 1e3 * (wall_clock_s() - rendered_s);
    deliver(to, from, port, json, sizeof json - 1);
    answers_close(to, NULL);
    FILE *file = fopen(path, "r");
    CHECK(file && fgets(line[0], sizeof line[0], file) && fgets(line[1], sizeof line[1], file));
    CHECK(strstr(line[0], "\"box_px\":[10.1234,0.0,20.05,48.0],\"score\":0.123457,\"latency_ms\":"));
    const double latency_ms = ms_of(line[0], "\"latency_ms\":"), age_ms = ms_of(line[0], "\"age_ms\":");
    CHECK(latency_ms >= before_ms - 0.01 && latency_ms <= after_ms + 0.01);
    CHECK_NEAR(age_ms - latency_ms, 5000, 0.01);
    assert_string_equal(line[1],
                        "{\"frame\":1,\"band\":\"lwir\",\"time_s\":2.0,\"answer\":1,\"of\":1,\"class\":\"jeep\","
                        "\"los_deg\":[350.0,2.5],\"range_m\":1200.25,\"late\":false,\"form\":\"json\"}\n");
    fclose(file);
    unlink(path);
    rmdir(folder);
    log_set_sink(NULL, NULL);
    close(from);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_octet_of_a_detection_is_checked),
        cmocka_unit_test(a_line_of_sight_in_version_3),
        cmocka_unit_test(older_versions_and_long_classes),
        cmocka_unit_test(the_newest_answers_are_kept),
        cmocka_unit_test(a_frame_by_its_time_or_number),
        cmocka_unit_test(a_flood_is_counted_and_bounded),
        cmocka_unit_test(an_answer_in_its_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
