/* tests/sensor/test_html.c: a page is whole or absent, text stays text, pictures arrive as they were. */
#include "sensor/publish/files/html_page.h"
#include "tests/check.h"

#include <stdlib.h>
#include <unistd.h>

static char path[] = "/tmp/pitviper_html_XXXXXX";

static char *written(void)
{
    static char text[8192];
    FILE       *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    return text;
}

static void test_text_is_escaped(void **state)
{
    (void)state;
    FILE *page = html_begin(path, "a < b & \"c\"");
    assert_non_null(page);
    html_text(page, "%s %d", "<script>", 7);
    assert_int_equal(html_end(page, path), STATUS_OK);
    const char *text = written();
    assert_non_null(strstr(text, "<title>a &lt; b &amp; &quot;c&quot;</title>"));
    assert_non_null(strstr(text, "&lt;script&gt; 7"));
    assert_null(strstr(text, "<script>"));
    assert_non_null(strstr(text, "</body></html>"));
}

/* RFC 4648, section 10. */
static void test_base64(void **state)
{
    static const char *const vector[][2] = {{"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}};
    (void)state;
    FILE *page = html_begin(path, "t");
    assert_non_null(page);
    for (int i = 0; i < 4; i++) html_image(page, "png", vector[i][0], strlen(vector[i][0]), "an \"alt\"");
    assert_int_equal(html_end(page, path), STATUS_OK);
    for (int i = 0; i < 4; i++) {
        char image[64];
        snprintf(image, sizeof image, "base64,%s\" alt=\"an &quot;alt&quot;\">", vector[i][1]);
        assert_non_null(strstr(written(), image));
    }
}

static void test_no_place(void **state)
{
    (void)state;
    log_set_sink(check_listen, NULL);
    assert_null(html_begin("/nowhere/at/all.html", "t"));
    assert_non_null(strstr(check_said, "/nowhere/at/all.html"));
    log_set_sink(NULL, NULL);
}

static void test_full_disk(void **state)
{
    (void)state;
    log_set_sink(check_listen, NULL);
    char full[] = "/tmp/pitviper_full_XXXXXX", part[64];
    close(mkstemp(full));
    unlink(full);
    snprintf(part, sizeof part, "%s.part", full);
    FILE *page = html_begin(full, "t");
    assert_non_null(page);
    check_full_disk(true);
    const Status ended = html_end(page, full);
    check_full_disk(false);
    assert_int_equal(ended, STATUS_IO);
    assert_int_not_equal(access(full, F_OK), 0);
    assert_int_not_equal(access(part, F_OK), 0);
    log_set_sink(NULL, NULL);
}

int main(void)
{
    close(mkstemp(path));
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text_is_escaped),
        cmocka_unit_test(test_base64),
        cmocka_unit_test(test_no_place),
        cmocka_unit_test(test_full_disk),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(path);
    return failed;
}
