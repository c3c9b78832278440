/* Tables, numbers and foreign bytes. */
#include "tests/check.h"

static Status open_text(Table *table, const char *text)
{
    char path[text_file_size];
    text_file(path, text);
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    const Status status = table_open(table, path);
    remove(path);
    return status;
}

static void a_table_reads_comments_quotes_and_numbers(void **state)
{
    (void)state;
    Table table = {0};
    assert_int_equal(
        open_text(&table, "# about\n\nname, value ,\"a, b\"\r\n x ,1.5, \"say \"\"hi\"\", ok\" \ny,-2e3,\n"),
        STATUS_OK);
    assert_int_equal(table.columns, 3);
    assert_int_equal(table.rows, 2);
    assert_int_equal(table_column(&table, "value"), 1);
    assert_int_equal(table_column(&table, "a, b"), 2);
    assert_int_equal(table_column(&table, "absent"), -1);
    assert_string_equal(table_text(&table, 0, 0), "x");
    assert_string_equal(table_text(&table, 0, 2), "say \"hi\", ok");
    assert_string_equal(table_text(&table, 1, 2), "");
    double value = 0;
    assert_int_equal(table_number(&value, &table, 1, 1, -1e4, 0), STATUS_OK);
    CHECK_NEAR(value, -2000, 0);
    assert_int_equal(table_number(&value, &table, 0, 1, 2, 3), STATUS_BAD_VALUE);
    CHECK(strstr(check_said, ":4: column value: '1.5' is not a number in 2 .. 3"));
    assert_int_equal(table_number(&value, &table, 0, 0, 0, 9), STATUS_BAD_VALUE);
    table_close(&table);
}

static void malformed_tables_are_refused_with_the_line(void **state)
{
    (void)state;
    Table table = {0};
    assert_int_equal(open_text(&table, "a,b\n1,2\n3\n"), STATUS_BAD_VALUE);
    CHECK(strstr(check_said, ":3: 1 columns where the header has 2"));
    assert_int_equal(open_text(&table, "a,b\n1,2,3\n"), STATUS_BAD_VALUE);
    assert_int_equal(open_text(&table, "a,b\n\"open,2\n"), STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "quote"));
    assert_int_equal(open_text(&table, "# nothing\n"), STATUS_BAD_VALUE);
    assert_int_equal(open_text(&table, ""), STATUS_BAD_VALUE);
    assert_int_equal(table_open(&table, "/nonexistent/table.csv"), STATUS_IO);
    assert_null(table.cell);
}

/* Room for cells follows what the file holds, not its header's width times its lines: here 0.3 TB. */
static void a_wide_header_over_blank_lines_is_small(void **state)
{
    (void)state;
    enum { columns = 20000, blanks = 2000000 };
    char *text = malloc(2 * columns + blanks + 2 * columns + 8), *at = text, path[text_file_size];
    CHECK(text);
    for (int row = 0; row < 2; row++) {
        for (int i = 0; i < columns; i++) *at++ = 'a', *at++ = i < columns - 1 ? ',' : '\n';
        for (int i = 0; row == 0 && i < blanks; i++) *at++ = '\n';
    }
    *at = 0;
    text_file(path, text);
    Table table;
    CHECK(table_open(&table, path) == STATUS_OK);
    CHECK(table.rows == 1 && table.columns == columns && table.line[1] == blanks + 2);
    assert_string_equal(table_text(&table, 0, columns - 1), "a");
    table_close(&table);
    remove(path);
    free(text);
}

static void numbers_are_whole_strings(void **state)
{
    (void)state;
    double    d = 42;
    long long n = 42;
    CHECK(text_to_double(&d, "1e-3") && d == 1e-3);
    CHECK(text_to_double(&d, "-0") && d == 0);
    static const char *const bad[] = {"", " 1", "1 ", "1,5", "3x", "nan", "inf", "1e999", "0x10", "--1"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        CHECK(!text_to_double(&d, bad[i]));
        CHECK(!text_to_long(&n, bad[i]));
    }
    CHECK(text_to_long(&n, "-9223372036854775808") && n == INT64_MIN);
    CHECK(!text_to_long(&n, "9223372036854775808"));
    CHECK(!text_to_long(&n, "1.0"));
}

static void foreign_bytes_are_escaped(void **state)
{
    (void)state;
    char out[32];
    text_escape(out, sizeof out, "A\x1b[2J\\\xff", 7);
    assert_string_equal(out, "A\\x1b[2J\\x5c\\xff");
    text_escape(out, 6, "ab\x01zz", 5); /* an escape is never cut in two */
    assert_string_equal(out, "ab");
}

/* Every octet alone, and characters that are well formed, against the table of RFC 3629 as Unicode prints it. */
static void what_a_terminal_is_shown(void **state)
{
    (void)state;
    static const struct {
        const char *in, *out;
        bool        lines;
    } text[] = {{"plain, \\ too", "plain, \\ too", false},
                {"\xc3\xa9\xe6\xbc\xa2\xf0\x9f\x9a\x80", "\xc3\xa9\xe6\xbc\xa2\xf0\x9f\x9a\x80", false},
                {"a\033[31mb\a", "a\\x1b[31mb\\x07", false},
                {"a\tb\nc", "a\\x09b\\x0ac", false},
                {"a\tb\nc\r", "a\tb\nc\\x0d", true},
                {"\xc2\x9b"
                 "31m",
                 "\\xc2\\x9b31m", true}, /* CSI of C1 */
                {"\x9b"
                 "31m",
                 "\\x9b31m", true}, /* and bare */
                {"\xe2\x80\xae"
                 "gpj",
                 "\\xe2\\x80\\xaegpj", true}, /* right-to-left override */
                {"\xef\xbb\xbfx", "\\xef\\xbb\\xbfx", true},
                {"\xc0\xaf", "\\xc0\\xaf", true}, /* too long a form of '/' */
                {"\xe0\x9b\x9b", "\\xe0\\x9b\\x9b", true},
                {"\xed\xa0\x80", "\\xed\\xa0\\x80", true}, /* half of a pair */
                {"\xf4\x90\x80\x80", "\\xf4\\x90\\x80\\x80", true},
                {"\xe2\x82", "\\xe2\\x82", true}, /* it ends too soon */
                {"\xe2\x82\033", "\\xe2\\x82\\x1b", true}};
    char out[200];
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        text_show(out, sizeof out, text[i].in, text[i].lines);
        assert_string_equal(out, text[i].out);
    }
    text_show(out, 6, "ab\xc3\xa9\xc3\xa9", false); /* neither a character nor an escape is cut in two */
    assert_string_equal(out, "ab\xc3\xa9");
    text_show(out, 6, "ab\033z", false);
    assert_string_equal(out, "ab");
    for (int c = 1; c < 256; c++) {
        const char one[2] = {(char)c, 0};
        text_show(out, sizeof out, one, false);
        CHECK((c >= 0x20 && c < 0x7f) == (strlen(out) == 1) && (strlen(out) == 1 || strlen(out) == 4));
    }
}

/* A library's or a file's own words stay on the message's line, and move no cursor. */
static void a_message_is_one_line(void **state)
{
    (void)state;
    log_set_sink(check_listen, NULL);
    log_warn("%s: damaged", "a.dt1\n at\033[2J\r\x7f");
    log_set_sink(NULL, NULL);
    assert_string_equal(check_said, "a.dt1\\x0a at\\x1b[2J\\x0d\\x7f: damaged");
}

/* Texts of any length are printed whole. */
static void long_texts_are_printed_whole(void **state)
{
    (void)state;
    static const size_t lengths[] = {0, 1, 16382, 16383, 16384, 16385, 100000};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        const size_t n = lengths[i];
        char        *in = malloc(n + 1), *out = malloc(4 * n + 1);
        FILE        *file = tmpfile();
        CHECK(in && out && file);
        memset(in, '\a', n);
        in[n] = 0;
        text_print(file, "%s", in);
        rewind(file);
        CHECK(fread(out, 1, 4 * n + 1, file) == 4 * n);
        for (size_t k = 0; k < n; k++) assert_memory_equal(out + 4 * k, "\\x07", 4);
        fclose(file);
        free(in);
        free(out);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_message_is_one_line),
        cmocka_unit_test(a_table_reads_comments_quotes_and_numbers),
        cmocka_unit_test(malformed_tables_are_refused_with_the_line),
        cmocka_unit_test(a_wide_header_over_blank_lines_is_small),
        cmocka_unit_test(numbers_are_whole_strings),
        cmocka_unit_test(foreign_bytes_are_escaped),
        cmocka_unit_test(what_a_terminal_is_shown),
        cmocka_unit_test(long_texts_are_printed_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
