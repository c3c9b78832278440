/* tests/sensor/test_cigi_recorded.c: notes of a CIGI host's time: what is written comes back to the bit; what was not
 * written so is none. Recordings as a whole: tests/system/test_cigi_recording.sh. */
#include "tests/check.h"

#include "sensor/node/cigi/cigi_recorded.h"

static CigiTimeNote some(uint64_t k)
{
    return (CigiTimeNote){1 + k * k * k, 1e9 * (2 * random_uniform(7, 0, 0, k) - 1), 1 + (int)(k * 31 % 65535)};
}

static void notes_come_back(void **state)
{
    (void)state;
    for (uint64_t k = 0; k < 2000; k++) {
        const CigiTimeNote first = some(k), second = some(k + 1);
        CigiTimeNote       got;
        char               text[2][cigi_time_note_size], notes[400];
        cigi_time_note_text(text[0], &first);
        cigi_time_note_text(text[1], &second);
        assert_true(strlen(text[0]) + 1 < sizeof text[0]);
        snprintf(notes, sizeof notes, "pitviper: no radar in frame 5 at 1.000000 s\n%s\nother\n%s", text[0], text[1]);
        const char *at = notes;
        CHECK(cigi_time_note_next(&got, &at) && got.datagram == first.datagram && got.offset_s == first.offset_s &&
              got.port == first.port);
        CHECK(cigi_time_note_next(&got, &at) && got.datagram == second.datagram && got.offset_s == second.offset_s);
        CHECK(!cigi_time_note_next(&got, &at));
    }
}

static void other_lines_are_none(void **state)
{
    (void)state;
    static const char *const other[] = {"",
                                        "\n\n",
                                        "pitviper: cigi",
                                        "pitviper: cigi port 8005 time 0x1p+2",
                                        "pitviper: cigi port 8005 time nan from datagram 1",
                                        "pitviper: cigi port 8005 time 0x1p+40 from datagram 1",
                                        "pitviper: cigi port 0 time 0x1p+2 from datagram 1",
                                        "pitviper: cigi port 65536 time 0x1p+2 from datagram 1",
                                        "pitviper: cigi port 8005 time 0x1p+2 from datagram 0",
                                        "pitviper: cigi port 8005 time 0x1p+2 from datagram -1",
                                        "pitviper: cigi port 8005 time 4 from datagram 1", /* not as written */
                                        "pitviper: cigi port 8005 time 0x1p+2 from datagram 1 "};
    CigiTimeNote             got;
    const char              *at = NULL;
    CHECK(!cigi_time_note_next(&got, &at));
    for (size_t k = 0; k < sizeof other / sizeof *other; k++) {
        at = other[k];
        CHECK(!cigi_time_note_next(&got, &at));
    }
    at = "pitviper: cigi port 8005 time 0x1p+2 from datagram 7";
    CHECK(cigi_time_note_next(&got, &at) && got.datagram == 7 && got.offset_s == 4 && got.port == 8005);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(notes_come_back), cmocka_unit_test(other_lines_are_none)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
