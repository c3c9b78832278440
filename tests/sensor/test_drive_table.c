/* Drive levels of a scene projector by a table: numbers worked out by hand, in both directions; what is outside; tables
 * that are refused, each with a line that names what is wrong. */
#include "tests/check.h"

#include "sensor/publish/projector/drive_table.h"

#include <unistd.h>

static char said[512];

static void note(void *user, LogLevel level, const char *line)
{
    (void)user, (void)level;
    snprintf(said, sizeof said, "%s", line);
}

static Status read_text(DriveTable *out, const char *text, int most)
{
    char      path[] = "/tmp/drive_tableXXXXXX";
    const int file = mkstemp(path);
    CHECK(file >= 0 && write(file, text, strlen(text)) == (ssize_t)strlen(text));
    close(file);
    *said = 0;
    log_set_sink(note, NULL);
    const Status status = drive_table_read(out, path, most);
    log_set_sink(NULL, NULL);
    unlink(path);
    return status;
}

static void levels_are_linear_between_rows(void **state)
{
    (void)state;
    DriveTable  t;
    const float radiance[] = {-1, 0, 1, 2, 2.5f, 3, 4, 1e9f, NAN, INFINITY, -INFINITY};
    /* up from 10 to 30 over 0 .. 2, down to 0 over 2 .. 4; halves go up */
    const uint16_t expected[] = {10, 10, 20, 30, 23, 15, 0, 0, 10, 0, 10};
    enum { count = sizeof expected / sizeof *expected };
    uint16_t level[count];
    assert_int_equal(read_text(&t, "radiance,level\n0,10\n2,30\n4,0\n", 255), STATUS_OK);
    CHECK(!t.counts && t.rows == 3);
    drive_levels_of_radiance(level, &t, radiance, count);
    for (int i = 0; i < count; i++) assert_int_equal(level[i], expected[i]);
    drive_table_free(&t);
}

static void every_count_has_its_level(void **state)
{
    (void)state;
    DriveTable t;
    assert_int_equal(read_text(&t, "level,counts\n0,100\n65535,65535\n", 65535), STATUS_OK);
    CHECK(t.counts);
    for (int k = 0; k < 65536; k++) {
        const uint16_t count = (uint16_t)k;
        uint16_t       level;
        const double   exact = k <= 100 ? 0 : (k - 100) * 65535.0 / 65435.0;
        drive_levels_of_counts(&level, &t, &count, 1);
        assert_true(fabs(level - exact) <= 0.5 + 1e-6);
    }
    drive_table_free(&t);
}

/* Rows that crowd in places, against a search row by row. */
static void rows_in_any_place(void **state)
{
    (void)state;
    enum { rows = 600 };
    static char   text[rows * 48 + 32];
    static double value[rows], level[rows];
    DriveTable    t;
    size_t        n = (size_t)snprintf(text, sizeof text, "radiance,level\n");
    for (int i = 0; i < rows; i++) {
        const double last = i > 0 ? value[i - 1] : -5;
        value[i] = last + pow(10, -6 + 7 * random_uniform(3, 1, 0, (uint64_t)i));
        level[i] = floor(65535 * random_uniform(3, 2, 0, (uint64_t)i));
        n += (size_t)snprintf(text + n, sizeof text - n, "%.17g,%g\n", value[i], level[i]);
    }
    assert_int_equal(read_text(&t, text, 65535), STATUS_OK);
    for (int k = 0; k < 20000; k++) {
        const int    near = (int)(rows * random_uniform(3, 3, 0, (uint64_t)k));
        const double share = 1.1 * random_uniform(3, 4, 0, (uint64_t)k) - 0.05;
        const double v = k % 3 == 0 ? value[near] : value[0] + (value[rows - 1] - value[0]) * share;
        int          low = 0;
        while (low + 1 < rows && value[low + 1] <= v) low++;
        double exact = level[low];
        if (low + 1 < rows && v > value[0])
            exact += (v - value[low]) * (level[low + 1] - level[low]) / (value[low + 1] - value[low]);
        assert_true(fabs(drive_level(&t, v) - exact) <= 0.5 + 1e-6);
    }
    drive_table_free(&t);
}

static void what_is_wrong_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said;
    } wrong[] = {
        {"radiance,level\n0,10\n", "row"},
        {"level\n1\n2\n", "radiance and counts"},
        {"radiance,counts,level\n0,0,1\n1,1,2\n", "not both"},
        {"radiance,level\n0,10\n1e-31,20\n", "above that of the row before"},
        {"radiance,level\n1,10\n1,20\n", "above that of the row before"},
        {"radiance,level\n1,10\n0,20\n", "above that of the row before"},
        {"counts,level\n1,10\n0,20\n", "above that of the row before"},
        {"counts,level\n0.5,10\n1,20\n", "counts"},
        {"counts,level\n0,10\n65536,20\n", "counts"},
        {"radiance,level\n0,-1\n1,20\n", "level"},
        {"radiance,level\n0,1\n1,256\n", "at most 255"},
        {"radiance,level\n0,1\n1,nan\n", "level"},
        {"radiance,level\nnan,1\n1,2\n", "radiance"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        DriveTable t;
        assert_int_equal(read_text(&t, wrong[i].text, 255), STATUS_BAD_VALUE);
        if (!strstr(said, wrong[i].said)) print_error("%s: %s\n", wrong[i].text, said);
        CHECK(strstr(said, wrong[i].said));
        CHECK(strstr(said, "projector"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(levels_are_linear_between_rows),
                                       cmocka_unit_test(every_count_has_its_level), cmocka_unit_test(rows_in_any_place),
                                       cmocka_unit_test(what_is_wrong_is_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
