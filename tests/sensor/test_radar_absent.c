/* Notes of frames without radar: written into a recording, read back by number and time; what is no such note, or is
 * spoilt, is passed over. */
#include "tests/check.h"

#include "dis/capture/log.h"
#include "dis/capture/recorder.h"
#include "sensor/node/session/session.h"

#include <unistd.h>

static void notes_come_back(void **state)
{
    (void)state;
    static const int     number[4] = {7, 3, 2000000000, 0};
    static const double  t_s[4] = {1.75, 1368.333333, 0.1, -0.5};
    static const uint8_t pdu[12] = {7, 1, 1, 1, [9] = 12};
    char                 path[80], text[session_radar_absent_size];
    DisRecorder         *r;
    DisLog               log;
    RadarAbsent         *a;
    snprintf(path, sizeof path, "/tmp/pitviper-absent-%d.pcapng", (int)getpid());
    CHECK(dis_recorder_open(&r, path, "a test") == STATUS_OK);
    for (int i = 0; i < 4; i++) {
        CHECK(dis_recorder_add(r, 1000000000 * (int64_t)(i + 1), NULL, 3000, pdu, sizeof pdu) == STATUS_OK);
        session_radar_absent_text(text, number[i], t_s[i]);
        CHECK(dis_recorder_note(r, 1000000000 * (int64_t)(i + 1) + 1, text) == STATUS_OK);
        CHECK(dis_recorder_note(r, 1000000000 * (int64_t)(i + 1) + 2, "another note") == STATUS_OK);
    }
    CHECK(dis_recorder_close(r) == STATUS_OK);
    CHECK(dis_log_open(&log, path, dis_port_default) == STATUS_OK && log.count == 4 && !log.truncated);
    CHECK(session_radar_absent_read(&a, log.notes) == STATUS_OK && a);
    for (int i = 0; i < 4; i++) {
        CHECK(session_radar_absent_in(a, number[i], t_s[i]) && session_radar_absent_in(a, number[i], t_s[i] + 1e-6));
        CHECK(!session_radar_absent_in(a, number[i], t_s[i] + 0.25) &&
              !session_radar_absent_in(a, number[i] - 1, t_s[i]));
    }
    session_radar_absent_free(a);
    dis_log_close(&log);
    unlink(path);

    /* pcap has no place for them */
    snprintf(path, sizeof path, "/tmp/pitviper-absent-%d.pcap", (int)getpid());
    CHECK(dis_recorder_open(&r, path, NULL) == STATUS_OK);
    CHECK(dis_recorder_note(r, 5, text) == STATUS_UNSUPPORTED);
    CHECK(dis_recorder_close(r) == STATUS_OK);
    unlink(path);
}

static void spoilt_notes_are_passed_over(void **state)
{
    (void)state;
    static const char *const bad[] = {"",
                                      "\n\n",
                                      "pitviper: no radar in frame",
                                      "pitviper: no radar in frame 5 at nan s\n",
                                      "pitviper: no radar in frame -5 at 1.000000 s\n",
                                      "pitviper: no radar in frame 5 at 1e300 s\n",
                                      "pitviper: no radar in frame 5 at 1.000000 s and more\n",
                                      "pitviper: no radar in frame 99999999999 at 1.000000 s\n",
                                      " pitviper: no radar in frame 5 at 1.000000 s\n"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        RadarAbsent *a = NULL;
        CHECK(session_radar_absent_read(&a, bad[i]) == STATUS_OK && !a);
    }
    RadarAbsent *a;
    CHECK(session_radar_absent_read(&a, "x\npitviper: no radar in frame 5 at 1.000000 s") == STATUS_OK &&
          session_radar_absent_in(a, 5, 1));
    session_radar_absent_free(a);
    CHECK(session_radar_absent_read(&a, NULL) == STATUS_OK && !a && !session_radar_absent_in(a, 5, 1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(notes_come_back),
        cmocka_unit_test(spoilt_notes_are_passed_over),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
