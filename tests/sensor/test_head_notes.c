/* Poses of a head in the notes of a recording: they come back to the bit, in order of time, among other notes; of a
 * time the one that holds then. */
#include "tests/check.h"

#include "sensor/node/session/head_notes.h"

#include <stdlib.h>

static void they_come_back(void **state)
{
    (void)state;
    enum { count = 5 };
    HeadNote   note[count];
    char       text[4096] = "pitviper: no radar in frame 3 at 1.000000 s\n", line[head_note_size];
    HeadNotes *read;
    for (int i = 0; i < count; i++) {
        note[i] = (HeadNote){.t_s = 1350 + 0.1 * i,
                             .pose = {.flags = (unsigned)i % 4,
                                      .sequence = 0xFFFFFFFEu + (unsigned)i,
                                      .buttons = 1u << i,
                                      .time_us = 1000003u * (unsigned)i,
                                      .yaw_deg = (double)(float)(0.1 * i - 0.2),
                                      .pitch_deg = -30,
                                      .zoom = 1}};
        if (i % 2) note[i].pose.lat_deg = 47.1 + i, note[i].pose.lon_deg = -180 + 1e-9 * i, note[i].pose.height_m = 0.1;
    }
    static const int order[count] = {3, 0, 4, 1, 2};
    for (int i = 0; i < count; i++) {
        head_note_text(line, &note[order[i]]);
        strcat(strcat(text, line), "\nother\n");
    }
    assert_int_equal(head_notes_read(&read, text), STATUS_OK);
    assert_non_null(read);
    assert_int_equal(read->count, count);
    for (int i = 0; i < count; i++) {
        uint8_t a[head_octets_most], b[head_octets_most];
        CHECK(read->note[i].t_s == note[i].t_s);
        const size_t octets = head_pose_write(a, &note[i].pose);
        assert_int_equal(head_pose_write(b, &read->note[i].pose), octets);
        assert_memory_equal(a, b, octets);
    }
    assert_int_equal(head_notes_at(read, 1349.99), -1);
    for (int i = 0; i < count; i++) {
        assert_int_equal(head_notes_at(read, note[i].t_s), i);
        assert_int_equal(head_notes_at(read, note[i].t_s + 0.05), i);
    }
    free(read);
}

static void others_are_passed_over(void **state)
{
    (void)state;
    char           line[head_note_size + 8];
    const HeadNote note = {.t_s = 5, .pose = {.sequence = 1, .zoom = 1}};
    HeadNotes     *read;
    head_note_text(line, &note);
    const size_t length = strlen(line);
    for (size_t i = 0; i < length; i++) { /* an octet of it is another */
        char spoilt[head_note_size + 8];
        memcpy(spoilt, line, length + 1);
        spoilt[i] = spoilt[i] == '1' ? 'g' : spoilt[i] == ' ' ? '_' : 'G';
        assert_int_equal(head_notes_read(&read, spoilt), STATUS_OK);
        if (read) print_error("%s\n", spoilt);
        assert_null(read);
    }
    line[length] = '0';
    line[length + 1] = 0;
    assert_int_equal(head_notes_read(&read, line), STATUS_OK);
    assert_null(read);
    assert_int_equal(head_notes_read(&read, NULL), STATUS_OK);
    assert_null(read);
    assert_int_equal(head_notes_read(&read, ""), STATUS_OK);
    assert_null(read);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(they_come_back), cmocka_unit_test(others_are_passed_over)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
