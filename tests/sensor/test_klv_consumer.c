/* The consumer that writes packets of metadata into files, and which targets they have. */
#include "tests/sensor/klv_lab.h"

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
    KlvDetections  found = {.from = NULL};
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

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(packets_of_frames_in_files)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
