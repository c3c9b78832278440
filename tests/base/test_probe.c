/* Rows of CSV through a probe: what passes, what is refused, and that nothing is lost. */
#include "tests/check.h"

static const char *divide_row(void *state, const ProbeValue *in, ProbeValue *out)
{
    int *rows = state;
    ++*rows;
    if (in[1].number == 0) return "divisor is 0, \"that\" has no quotient";
    out[0].number = in[0].number / in[1].number;
    out[1].number = in[2].number;
    snprintf(out[2].buffer, sizeof out[2].buffer, "<%s>", in[3].text);
    out[2].text = out[2].buffer;
    return NULL;
}

static int    rows, closed;
static Status divide_open(void **state, int argc, char **argv)
{
    (void)argv;
    rows = closed = 0;
    *state = &rows;
    return argc == 1 ? STATUS_OK : STATUS_BAD_VALUE;
}
static void divide_close(void *state) { closed += state == &rows; }

static const Probe divide = {.name = "divide",
                             .help = "",
                             .in = "a,b,extra?,name$",
                             .out = "quotient,extra_again,said$",
                             .open = divide_open,
                             .row = divide_row,
                             .close = divide_close};

static Status through(char out[static 4096], const char *text, int argc)
{
    char  argument[] = "divide", *name = argument;
    FILE *in = fmemopen((void *)text, strlen(text), "r");
    FILE *to = fmemopen(out, 4096, "w");
    CHECK(in && to);
    const Status status = probe_run(&divide, argc, &name, in, to);
    fclose(in);
    fclose(to);
    return status;
}

static void rows_pass_through(void **state)
{
    (void)state;
    char out[4096];
    CHECK(
        through(out,
                "# a comment\nnote,b,a,name,more\r\n\"x, y\",3,1,\"N, \"\"n\"\"\",7\r\n\n,0,1,z,\n,2,,z,\n,2,1e999,z,\n"
                ",2,1,,\n1,2,3\n\"open,2,1,z,\n,-4,1,z,end",
                1) == STATUS_OK);
    assert_string_equal(out, "note,b,a,name,more,quotient,extra_again,said,error\n"
                             "\"x, y\",3,1,\"N, \"\"n\"\"\",7,0.3333333333333333,,\"<N, \"\"n\"\">\",\n"
                             ",0,1,z,,,,,\"divisor is 0, \"\"that\"\" has no quotient\"\n"
                             ",2,,z,,,,,a is empty\n"
                             ",2,1e999,z,,,,,a is not a number\n"
                             ",2,1,,,,,,name is empty\n"
                             "1,2,3,,,,3 columns where the header has 5\n"
                             "\"open,2,1,z,,,,,a quote is not closed\n"
                             ",-4,1,z,end,-0.25,,<z>,\n");
    CHECK(rows == 3 && closed == 1);
}

/* Seventeen digits where they are needed, and no more. */
static void numbers_read_back(void **state)
{
    (void)state;
    char out[4096];
    CHECK(through(out, "a,b,name,extra\n1,3,z,0.1\n2,3,z,1e300\n", 1) == STATUS_OK);
    const char *line = strchr(out, '\n') + 1;
    double      third, tenth;
    CHECK(sscanf(line, "1,3,z,0.1,%lf,%lf", &third, &tenth) == 2);
    CHECK(third == 1.0 / 3 && tenth == 0.1);
    CHECK(strstr(line, ",0.1,<z>") && strstr(line, ",1e+300,<z>"));
}

static void headers_are_checked(void **state)
{
    (void)state;
    char out[4096];
    log_set_sink(check_listen, NULL);
    CHECK(through(out, "a,c,name\n1,2,z\n", 1) == STATUS_BAD_VALUE && strstr(check_said, "no column b"));
    CHECK(through(out, "\n\n", 1) == STATUS_BAD_VALUE && strstr(check_said, "no header"));
    CHECK(through(out, "a,b,\"name\n", 1) == STATUS_BAD_VALUE && strstr(check_said, "not CSV"));
    closed = 0;
    CHECK(through(out, "a,b,name\n1,2,z\n", 2) == STATUS_BAD_VALUE); /* what open refuses is not closed */
    CHECK(closed == 0);
    log_set_sink(NULL, NULL);
}

/* A spreadsheet's UTF-8 mark and line ends are not part of a name. */
static void spreadsheets_are_read(void **state)
{
    (void)state;
    char out[4096] = {0};
    CHECK(through(out,
                  "\xef\xbb\xbf"
                  "a,b,name\r\n6,2,y\r\n",
                  1) == STATUS_OK);
    assert_string_equal(out, "a,b,name,quotient,extra_again,said,error\n6,2,y,3,,<y>,\n");
}

/* What stands behind a NUL is not silently left out. */
static void a_nul_is_not_an_end(void **state)
{
    (void)state;
    static const char text[] = "a,b,name\n6,2,y\0 and more\n\0\n8,2,y\n";
    char              out[4096] = {0}, argument[] = "divide", *name = argument;
    FILE *in = fmemopen((void *)(uintptr_t)text, sizeof text - 1, "r"), *to = fmemopen(out, sizeof out, "w");
    CHECK(in && to);
    CHECK(probe_run(&divide, 1, &name, in, to) == STATUS_OK);
    fclose(in);
    fclose(to);
    assert_string_equal(out, "a,b,name,quotient,extra_again,said,error\n"
                             "6,2,y and more,,,,the line holds a NUL octet\n"
                             ",,,,the line holds a NUL octet\n"
                             "8,2,y,4,,<y>,\n");
}

/* A line beyond the limit is refused as one row, and the next row is read from its own beginning. */
static void a_long_line_is_one_row(void **state)
{
    (void)state;
    enum { octets = 200000 };
    char  out[4096] = {0}, *text = malloc(octets + 100);
    FILE *to = tmpfile();
    CHECK(text && to);
    int n = sprintf(text, "a,b,name\n1,2,");
    memset(text + n, 'z', octets);
    sprintf(text + n + octets, "\n6,2,y\n");
    FILE *in = fmemopen(text, strlen(text), "r");
    char  argument[] = "divide", *name = argument;
    CHECK(probe_run(&divide, 1, &name, in, to) == STATUS_OK && rows == 1);
    fseek(to, -20, SEEK_END);
    CHECK(fread(out, 1, 19, to) > 0);
    CHECK(strstr(out, "6,2,y,3,,<y>,"));
    fclose(in);
    fclose(to);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(rows_pass_through),   cmocka_unit_test(numbers_read_back),
                                       cmocka_unit_test(headers_are_checked), cmocka_unit_test(spreadsheets_are_read),
                                       cmocka_unit_test(a_nul_is_not_an_end), cmocka_unit_test(a_long_line_is_one_row)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
