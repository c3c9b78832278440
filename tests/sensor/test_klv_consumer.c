/* The consumer that writes packets of metadata into files, and which targets they have. */
#include "tests/sensor/klv_lab.h"

#include <netinet/in.h>
#include <pitviper_memory.h>
#include <sys/socket.h>

static size_t read_file(uint8_t *octets, size_t most, const char *folder, const char *name)
{
    char path[160];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file) return SIZE_MAX;
    const size_t count = fread(octets, 1, most, file);
    fclose(file);
    remove(path);
    return count;
}

/* A file a band that is asked for, the packets of its frames one behind the other. */
static void packets_of_frames_in_files(void **state)
{
    (void)state;
    static uint8_t got[4 * klv_most_octets], want[4 * klv_most_octets];
    char           folder[] = "/tmp/pitviper-klv-XXXXXX";
    Config         config = config_default();
    TargetRecord   target = {.id = {1, 2, 3}, .pixels = 40, .box = {10, 20, 30, 24}, .class_number = 1};
    KlvAnswers     found = {.from = NULL};
    static uint8_t packet[klv_most_octets];
    CHECK(mkdtemp(folder));
    for (int vmti = 0; vmti < 3; vmti++) {
        Consumer      *consumer;
        size_t         used = 0;
        const KlvFiles of = {
            .out = folder, .config = &config, .bands = 1u << BAND_OPTICAL | 1u << BAND_LWIR, .patient = vmti == 1};
        config.publish.vmti = vmti == 0 ? VMTI_OFF : vmti == 1 ? VMTI_ATR : VMTI_TRUTH;
        assert_int_equal(consume_klv(&consumer, &of), STATUS_OK);
        CHECK(consumer->wants == (unsigned)(WANT_FOOTPRINT | (vmti == 2 ? WANT_TARGETS : 0)));
        assert_int_equal(consumer->begin(consumer), STATUS_OK);
        for (int n = 0; n < 2; n++) {
            Frame frame = {.unix_s = 1750000000 + n};
            scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
            lab.record.frame = n;
            lab.record.target = &target, lab.record.target_count = 1;
            memcpy(target.p_ecef, lab.record.p_eye_ecef, sizeof target.p_ecef);
            frame.record = lab.record;
            assert_int_equal(consumer->put(consumer, &frame), STATUS_OK);
            /* targets of truth alone: no recogniser has answered */
            KlvTargets targets;
            KlvTarget  kept[klv_most_targets];
            klv_truth_targets(&targets, kept, &lab.record);
            const size_t count = klv_frame(want + used, &lab.record, frame.unix_s, &(KlvSource){.band = BAND_LWIR},
                                           vmti == 2 ? &targets : NULL);
            CHECK(klv_of_band(packet, &found, config.publish.vmti, &frame, BAND_LWIR, NULL) == count);
            assert_memory_equal(packet, want + used, count);
            used += count;
        }
        assert_int_equal(consumer->close(consumer), STATUS_OK);
        CHECK(read_file(got, sizeof got, folder, "lwir.klv") == used);
        assert_memory_equal(got, want, used);
        CHECK(read_file(got, sizeof got, folder, "optical.klv") < used &&
              read_file(got, sizeof got, folder, "mwir.klv") == SIZE_MAX);
    }
    /* a folder that is not there */
    Consumer *consumer;
    log_set_sink(check_listen, NULL);
    assert_int_equal(consume_klv(&consumer, &(KlvFiles){.out = "/nowhere/at/all", .config = &config, .bands = 1}),
                     STATUS_OK);
    assert_int_equal(consumer->begin(consumer), STATUS_IO);
    CHECK(strstr(check_said, "/nowhere/at/all/optical.klv"));
    assert_int_equal(consumer->close(consumer), STATUS_OK);
    /* a full disk ends a replay, and a live node's run not */
    for (int patient = 0; patient < 2; patient++) {
        assert_int_equal(
            consume_klv(&consumer, &(KlvFiles){.out = folder, .config = &config, .bands = 1, .patient = patient}),
            STATUS_OK);
        assert_int_equal(consumer->begin(consumer), STATUS_OK);
        Frame frame = {.unix_s = 1750000000, .record = lab.record};
        check_full_disk(true);
        const Status status = consumer->put(consumer, &frame), again = consumer->put(consumer, &frame);
        check_full_disk(false);
        CHECK(status == (patient ? STATUS_OK : STATUS_IO) && again == status);
        consumer->close(consumer);
        read_file(got, sizeof got, folder, "optical.klv");
    }
    log_set_sink(NULL, NULL);
    CHECK(rmdir(folder) == 0);
}

/* Answers of a recogniser to frame 6 of LWIR, whose time is 1000.5 s: in packets of that band until a second later, of
 * earlier ones likewise; in none of another band, and in none that asks for no targets, or for truth. */
static void answers_last_for_a_second(void **state)
{
    (void)state;
    Answers           *from = NULL;
    AnswerCounters     count = {.lines = 0};
    int                port = 20000 + (int)getpid() % 20000;
    PitviperDetections answer = {.byte_order = PITVIPER_MEMORY_BYTE_ORDER,
                                 .version = PITVIPER_DETECTIONS_VERSION,
                                 .detection_size = sizeof(PitviperDetection),
                                 .frame = 6,
                                 .band = BAND_LWIR,
                                 .count = 1};
    memcpy(answer.magic, PITVIPER_DETECTIONS_MAGIC, sizeof answer.magic);
    answer.detection[0] = (PitviperDetection){
        .left = 1, .top = 2, .right = 11, .bottom = 12, .score = 0.5f, .track = 9, .class_name = "tank"};
    log_set_sink(check_listen, NULL);
    for (int i = 0; i < 50 && !from; i++) answers_open(&from, &(AnswersOf){++port, {1 << BAND_LWIR, 640, 480}});
    CHECK(from);
    AnswerFrame six = {.number = 6, .time_s = 3, .unix_s = 1000.5};
    scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
    answer_camera(&six.camera, &lab.record);
    answers_frame(from, &six);
    KlvAnswers found = {.from = from};
    for (int answered = 0; answered < 2; answered++) {
        static const struct {
            double          unix_s;
            Band            band;
            enum VmtiSource vmti;
            bool            has;
        } of[] = {{1000.5, BAND_LWIR, VMTI_ATR, true},    {1001.5, BAND_LWIR, VMTI_ATR, true},
                  {1001.625, BAND_LWIR, VMTI_ATR, false}, {999.5, BAND_LWIR, VMTI_ATR, true},
                  {999.375, BAND_LWIR, VMTI_ATR, false},  {1000.5, BAND_MWIR, VMTI_ATR, false},
                  {1000.5, BAND_LWIR, VMTI_OFF, false}};
        for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
            scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
            Frame frame = {.unix_s = of[k].unix_s, .record = lab.record};
            lab.used = klv_of_band(lab.octets, &found, of[k].vmti, &frame, of[k].band, NULL);
            CHECK(lab.used > 0 && has(74) == (answered && of[k].has));
            if (has(74))
                CHECK(number(find(tag_of(74), 7), false) == 6 && number(find(tag_of(74), 2), false) == 1000500000);
        }
        scene(&somewhere, (double[3]){0, 0, 0}, (double[3]){0, 0, 0});
        Frame frame = {.unix_s = 1000.5, .record = lab.record};
        lab.used = klv_of_band(lab.octets, &found, VMTI_TRUTH, &frame, BAND_LWIR, NULL);
        CHECK(number(find(tag_of(74), 5), false) == 0); /* the truth's: there is none */
        if (answered) break;
        const int                s = socket(AF_INET, SOCK_DGRAM, 0);
        const struct sockaddr_in node = {
            .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
        CHECK(sendto(s, &answer, PITVIPER_DETECTIONS_SIZE(1), 0, (const struct sockaddr *)&node, sizeof node) > 0);
        for (int i = 0; i < 1000000 && answer_datagrams(&count, ANSWER_GOOD) == 0; i++) {
            usleep(100);
            answers_counters(from, &count);
        }
        CHECK(answer_datagrams(&count, ANSWER_GOOD) == 1);
        close(s);
    }
    answers_close(from, NULL);
    log_set_sink(NULL, NULL);
}

/* Without a grid of the geoid metadata goes on, and that is said; with one it is the configured one. */
static void the_geoid_is_optional(void **state)
{
    (void)state;
    Geoid  geoid;
    Config config = config_default();
    strcpy(config.terrain.geoid, "/nowhere/at/all.gtx");
    CHECK(!klv_geoid_open(&geoid, &config));
    /* PROJ's .gtx: south, west and steps as big-endian double, rows and columns, then heights as float; 12.5 m
     * everywhere */
    static const uint8_t head[40] = {0x40, 0x44, 0,    0,    0, 0, 0, 0, 0x40, 0x14, 0,    0,    0, 0,
                                     0,    0,    0x3F, 0xF0, 0, 0, 0, 0, 0,    0,    0x3F, 0xF0, 0, 0,
                                     0,    0,    0,    0,    0, 0, 0, 8, 0,    0,    0,    8};
    static const uint8_t metres[4] = {0x41, 0x48, 0, 0};
    char                 path[text_file_size];
    text_file(path, "");
    FILE *file = fopen(path, "wb");
    CHECK(file && fwrite(head, 1, sizeof head, file) == sizeof head);
    for (int i = 0; i < 64; i++) CHECK(fwrite(metres, 1, 4, file) == 4);
    CHECK(fclose(file) == 0);
    strcpy(config.terrain.geoid, path);
    CHECK(klv_geoid_open(&geoid, &config));
    CHECK_NEAR(geoid_height_m(&geoid, 43.5 * rad_per_deg, 8.5 * rad_per_deg), 12.5, 1e-6);
    geoid_close(&geoid);
    remove(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(packets_of_frames_in_files),
                                       cmocka_unit_test(answers_last_for_a_second),
                                       cmocka_unit_test(the_geoid_is_optional)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
