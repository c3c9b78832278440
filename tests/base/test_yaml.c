/* YAML that would keep its parser busy for minutes is refused, in time that grows with its length alone. */
#include "tests/check.h"

#include "pitviper_settings.h"

static char *repeated(const char *head, const char *part, int times, const char *tail)
{
    const size_t n = strlen(head) + strlen(part) * (size_t)times + strlen(tail) + 1;
    char        *text = malloc(n), *to = text;
    CHECK(text);
    to = stpcpy(to, head);
    for (int i = 0; i < times; i++) to = stpcpy(to, part);
    stpcpy(to, tail);
    return text;
}

/* Takes the text. */
static Status said_of(char *text)
{
    *check_said = 0;
    log_set_sink(check_listen, NULL);
    const double begun_s = cpu_s();
    const Status status = yaml_check("test", "a.yaml", text, strlen(text));
    /* some 20 ms for a megabyte; a minute and more without the limits */
    CHECK(cpu_s() - begun_s < 10);
    log_set_sink(NULL, NULL);
    free(text);
    return status;
}

static void ordinary_files_pass(void **state)
{
    (void)state;
    assert_int_equal(said_of(strdup("")), STATUS_OK);
    assert_int_equal(said_of(strdup("a: &x [1, 2]\nb: *x\nc:\n  - {d: e}\n")), STATUS_OK);
    assert_int_equal(said_of(strdup("%YAML 1.1\n---\na: 1\n")), STATUS_OK);
    assert_int_equal(said_of(repeated("", "key: value\n", 80000, "")), STATUS_OK);
    assert_int_equal(said_of(repeated("", "[", 32, "]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]")), STATUS_OK);
    assert_int_equal(said_of(repeated("[", "&a 1,", 255, "&a 1]")), STATUS_OK);
    assert_string_equal(check_said, "");
}

static void too_much_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *head, *part;
        int         times;
        const char *tail, *reason;
    } cases[] = {
        {"", "[", 33, "", "nest deeper"},
        {"", "[", 1000000, "", "nest deeper"},
        {"", "{a: ", 100000, "", "nest deeper"},
        {"", "- ", 500000, "x", "nest deeper"},
        {"", "? ", 500000, "x", "nest deeper"},
        {"[", "&a 1,", 200000, "]", "more than 256 anchors"},
        {"", "%TAG !a! b\n", 90000, "--- x\n", "more than 8 directives"},
        {"a: 1\n", "---\nb: 2\n", 1, "", "a second document"},
        {"{ not: [ closed", "", 0, "", "did not find"},
        {"a: 1\n...\n", "%YAML x\n", 1, "", "did not find"}, /* behind the document, where no reader looks */
        {"a: 1\n", "%TAG !a! b\r", 9, "", "more than 8 directives"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(said_of(repeated(cases[i].head, cases[i].part, cases[i].times, cases[i].tail)),
                         STATUS_BAD_VALUE);
        assert_non_null(strstr(check_said, cases[i].reason));
        assert_non_null(strstr(check_said, "a.yaml:"));
    }
}

static void a_nul_is_named_with_its_line(void **state)
{
    (void)state;
    log_set_sink(check_listen, NULL);
    assert_int_equal(yaml_check("test", "a.yaml", "a: 1\nb: \0 2\n", 12), STATUS_BAD_VALUE);
    log_set_sink(NULL, NULL);
    assert_non_null(strstr(check_said, "a.yaml:2: holds a NUL"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ordinary_files_pass),
        cmocka_unit_test(too_much_is_refused),
        cmocka_unit_test(a_nul_is_named_with_its_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
