/* What is said, and by whom: a thread that is hushed takes nobody's word but its own. */
#include "tests/check.h"

#include <pthread.h>

static void *speak(void *unused)
{
    (void)unused;
    log_error("other: heard");
    return NULL;
}

static void a_hush_is_a_threads_own(void **state)
{
    (void)state;
    pthread_t other;
    log_set_sink(check_listen, NULL);
    check_said[0] = 0;
    log_suppress(true);
    log_error("hushed");
    assert_string_equal(check_said, "");
    assert_int_equal(pthread_create(&other, NULL, speak, NULL), 0);
    pthread_join(other, NULL);
    CHECK(strstr(check_said, "other: heard"));
    log_suppress(false);
    check_said[0] = 0;
    log_warn("again");
    CHECK(strstr(check_said, "again"));
    log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_hush_is_a_threads_own)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
