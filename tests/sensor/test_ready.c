/* When a live node is ready: said once with what it is ready with, again when more had to be made, and not oftener than
 * every ten seconds; a story on paper. */
#include "tests/check.h"

#include "sensor/node/live/ready.h"

static char said[4096];

static void hear(const char *line) { snprintf(said + strlen(said), sizeof said - strlen(said), "%s\n", line); }

/* What is said when the node is found so. */
static const char *at(Ready *r, double now_s, SessionReady is)
{
    static char path[64], line[512];
    FILE       *kept;
    snprintf(path, sizeof path, "/tmp/pitviper-ready-%d", (int)getpid());
    fflush(stderr);
    const int screen = dup(2);
    CHECK(screen >= 0 && freopen(path, "w", stderr));
    ready_check(r, &is, now_s);
    fflush(stderr);
    CHECK(dup2(screen, 2) == 2);
    close(screen);
    said[0] = 0;
    CHECK((kept = fopen(path, "r")) != NULL);
    while (fgets(line, sizeof line, kept)) {
        line[strcspn(line, "\n")] = 0;
        hear(line);
    }
    fclose(kept);
    unlink(path);
    return said;
}

static void a_story(void **state)
{
    (void)state;
    Ready r = {.heard_s = 100, .since_s = 100};
    assert_string_equal(at(&r, 105, (SessionReady){0}), ""); /* nothing was heard: nothing to be ready for */
    CHECK(!r.is && r.first_s == 0);
    assert_string_equal(at(&r, 106, (SessionReady){.entities = 3, .models = 1, .signatures = 40, .waiting = 50}), "");
    CHECK(!r.is && r.first_s == 0);
    assert_string_equal(at(&r, 108.5, (SessionReady){.entities = 3, .models = 2, .signatures = 216}),
                        "run: ready: 2 models, 216 signatures, 8.5 s after the first entity\n");
    CHECK_NEAR(r.first_s, 8.5, 1e-9);
    assert_string_equal(at(&r, 109, (SessionReady){.entities = 3, .models = 2, .signatures = 216}), "");
    /* another model: too soon to be said, then said with all that is new */
    assert_string_equal(at(&r, 110, (SessionReady){.entities = 4, .models = 3, .signatures = 216, .waiting = 108}), "");
    CHECK(!r.is);
    assert_string_equal(at(&r, 112, (SessionReady){.entities = 4, .models = 3, .signatures = 324}), "");
    CHECK(r.is);
    assert_string_equal(at(&r, 120, (SessionReady){.entities = 5, .models = 4, .signatures = 324, .waiting = 108}), "");
    assert_string_equal(at(&r, 123, (SessionReady){.entities = 5, .models = 4, .signatures = 432}),
                        "run: ready again: 2 more models, 216 signatures, in 3.0 s\n");
    CHECK_NEAR(r.first_s, 8.5, 1e-9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_story)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
