/* Scenarios: what is wrong is refused in one line with file, line, key and range; nothing hostile takes long. */
#include "tests/check.h"

#include "entities/exercise/cast_private.h"

static Status read_text(Scenario *s, const char *text)
{
    char path[text_file_size];
    text_file(path, text);
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    const Status status = scenario_read(s, path);
    remove(path);
    return status;
}

/* Refused, and the message has all of these words, separated by `~`. */
static void refused(const char *text, const char *words)
{
    Scenario s;
    char     word[256];
    CHECK(read_text(&s, text) == STATUS_BAD_VALUE);
    CHECK(s.group == NULL && s.shot == NULL);
    for (const char *at = words; at; at = strchr(at, '~'), at = at ? at + 1 : NULL) {
        snprintf(word, sizeof word, "%.*s", (int)strcspn(at, "~"), at);
        if (!strstr(check_said, word)) fail_msg("'%s' is not in: %s", word, check_said);
    }
    CHECK(!strchr(check_said, '\n'));
}

#define TANK "  - {name: Tank, type: tank, id: 1, speed_mps: 8, route_m: [[0, 0], [50, 0]]}\n"

static void what_is_wrong_is_said(void **state)
{
    (void)state;
    refused("vehicles:\n" TANK "  - {name: A, type: tank}\n", ":3: vehicles: route_m~[[x, y], ...]");
    refused("vehicles:\n  - {name: A, route_m: [1, 2, 3]}\n", ":2: vehicles: route_m: 3 numbers");
    refused("vehicles:\n  - {name: A, route_m: [[0, 0], [5, 5], [5, 5]]}\n", ":2: ~place 2 is less than 0.1 m");
    refused("vehicles:\n  - {name: A, loop: true, route_m: [[0, 0], [5, 5], [9, 0], [0, 0]]}\n",
            ":2: ~a loop closes by itself");
    refused("vehicles:\n  - {name: A, loop: true, route_m: [[0, 0], [5, 5]]}\n", ":2: ~at least three places");
    refused("vehicles:\n  - {name: A, route_m: [[0, 60000]]}\n", ":2: route_m~-50000 .. 50000 m");
    refused("vehicles:\n  - {name: A, route_m: [0, 0], type: 1.1.222.1}\n",
            ":2: vehicles: type: '1.1.222.1'~seven numbers");
    refused("vehicles:\n  - {name: A, route_m: [0, 0], type: 1.1.222.1.1.1.256}\n", "seven numbers");
    refused("vehicles:\n  - {name: A, route_m: [0, 0], turret: spin}\n",
            ":2: turret: 'spin' is not one of none|still|swing");
    refused("vehicles:\n  - {name: A, route_m: [0, 0], wheels: 6}\n", ":2: no such key: wheels");
    refused("vehicles:\n  - {name: A, route_m: [0, 0], count: 0}\n", ":2: count: '0'~1 .. 50000");
    refused("vehicles:\n  - {name: A, route_m: [0, 0], appears_s: 5, leaves_s: 5}\n",
            "leaves_s is not after appears_s");
    refused("vehicles:\n  - {name: A, route_m: [[0, 0], [9, 9]], speed_mps: 1, unsteady_m: 8}\n",
            ":2: vehicles: unsteady_m~3.6");
    refused("vehicles:\n" TANK TANK, "given twice");
    refused("vehicles:\n" TANK "shots:\n  - {from: Tank 2, at_m: [0, 9], hit: ground}\n",
            ":4: shots: from: there is no 'Tank 2'");
    refused("vehicles:\n" TANK "shots:\n  - {from: Tank 1, at: \"\\ew\"}\n", ":4: shots: at: there is no '\\x1bw'");
    refused("vehicles:\n" TANK "shots:\n  - {from: Tank 1, at: Tank 1}\n", "shoots at itself");
    refused("vehicles:\n" TANK "shots:\n  - {from: Tank 1}\n", ":4: shots: give either at");
    refused("vehicles:\n" TANK "shots:\n  - {from: Tank 1, at_m: [0, 9]}\n", "a place is not an entity");
    refused("dis: {version: 4}\n", ":1: dis.version: '4'~5 .. 7");
    refused("dis: {updates: true, version: 5}\n", "dis.updates: version 5 has no Entity State Update");
    refused("dis: {clock: yesterday}\n", "dis.clock: 'yesterday'~2024-06-21T18:00:00Z");
    refused("faults: {bad_every_s: 1e-20}\nvehicles:\n" TANK, "faults.bad_every_s: 1e-20~0.001 .. 1e6 s");
    refused("faults: {loss: 1.5}\n", ":1: faults.loss: '1.5'~0 .. 1");
    refused("vehicles:\n  - {name: A, route_m: [0, 0], count: 50000}\n  - {name: B, route_m: [0, 0], count: 2}\n",
            "50002 entities~at most 50000");
    refused("vehicles: 3\n", ":1: vehicles: expected a list");
}

/* What only the cast finds out: models by name, shots that do not reach. */
static void what_cannot_be_cast(void **state)
{
    (void)state;
    static const struct {
        const char *text, *word;
    } bad[] = {
        {"vehicles:\n  - {name: A, type: tnak, route_m: [0, 0]}\n", ":2: vehicles: type: 'tnak'"},
        {"vehicles:\n  - {name: A, type: missile, route_m: [0, 0]}\n", ":2: vehicles: type: 'missile' is a munition"},
        {"vehicles:\n" TANK "shots:\n  - {from: Tank 1, at_m: [40000, 0], hit: ground}\n",
         ":4: shots: what is fired at 0 s does not get there"},
        {"ground: {elevation: /nowhere.tif}\n", "/nowhere.tif"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        Scenario s;
        Cast    *cast = NULL;
        CHECK(read_text(&s, bad[i].text) == STATUS_OK);
        CHECK(cast_create(&cast, &s) != STATUS_OK && cast == NULL);
        if (!strstr(check_said, bad[i].word)) fail_msg("'%s' is not in: %s", bad[i].word, check_said);
        scenario_destroy(&s);
    }
}

static void set_from_outside(void **state)
{
    (void)state;
    Scenario s;
    CHECK(read_text(&s, "seed: 3\n") == STATUS_OK);
    CHECK(s.seed == 3 && s.dis.version == 7 && s.group_count == 0);
    CHECK(scenario_set(&s, "dis.version", "6", "--set") == STATUS_OK && s.dis.version == 6);
    CHECK(scenario_set(&s, "dis.version", "8", "--set") == STATUS_BAD_VALUE && s.dis.version == 6);
    CHECK(scenario_set(&s, "place.lat_deg", "-90", "--set") == STATUS_OK && s.place.lat_deg == -90);
    CHECK(scenario_set(&s, "place.lat_deg", "90.001", "--set") == STATUS_BAD_VALUE && s.place.lat_deg == -90);
    CHECK(scenario_set(&s, "dis.versoin", "6", "--set") == STATUS_BAD_VALUE && strstr(check_said, "dis.versoin"));
    scenario_destroy(&s);
}

static void types(void **state)
{
    (void)state;
    DisEntityType t;
    CHECK(scenario_type_parse(&t, "1.2.225.20.1.255.7") && t.domain == 2 && t.country == 225 && t.specific == 255 &&
          t.extra == 7);
    CHECK(!scenario_type_parse(&t, "") && !scenario_type_parse(&t, "1.1.1.1.1.1") &&
          !scenario_type_parse(&t, "1.1.1.1.1.1.1.1"));
    CHECK(!scenario_type_parse(&t, "1.1.65536.1.1.1.1") && !scenario_type_parse(&t, "1..1.1.1.1.1") &&
          !scenario_type_parse(&t, "1.1.1.1.1.1.1 "));
}

/* The scenarios that come with the program are read and cast, every one. */
static void bundled_scenarios(void **state)
{
    (void)state;
    static const char *const names[] = {"demo",     "no-vehicles", "no-missile", "guns",
                                        "bad-pdus", "empty",       "aircraft",   "crowd"};
    log_set_sink(NULL, NULL);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char     name[64], path[512];
        Scenario s;
        Cast    *cast;
        snprintf(name, sizeof name, "scenarios/%s.yaml", names[i]);
        CHECK(etc_path(path, sizeof path, name));
        CHECK(scenario_read(&s, path) == STATUS_OK);
        CHECK(cast_create(&cast, &s) == STATUS_OK);
        CHECK(strcmp(names[i], "crowd") != 0 || cast->entity_count == 10000);
        cast_destroy(cast);
        scenario_destroy(&s);
    }
}

/* As many items, rounds and places as are let in: seconds, not hours. */
static void the_most_there_may_be(void **state)
{
    (void)state;
    const size_t size = 1 << 20;
    char        *text = malloc(size);
    size_t       n = 0;
    Scenario     s;
    Cast        *cast;
    CHECK(text != NULL);
    n += (size_t)snprintf(text, size, "vehicles:\n" TANK);
    for (int i = 0; i < scenario_max_groups - 1; i++) {
        n += (size_t)snprintf(text + n, size - n,
                              "  - {name: A, loop: true, speed_mps: 9, type: truck, count: 20, route_m: [");
        for (int k = 0; k < 40; k++)
            n += (size_t)snprintf(text + n, size - n, "%s%d,%d", k ? "," : "", (int)(900 * cos(k * 0.157)),
                                  (int)(900 * sin(k * 0.157)));
        n += (size_t)snprintf(text + n, size - n, "]}\n");
    }
    n += (size_t)snprintf(
        text + n, size - n,
        "shots:\n  - {from: Tank 1, at: A 7, rounds: %d, every_s: 0.01, entity: false, type: 2.2.0.2.0.0.0}\n",
        scenario_max_rounds);
    CHECK(n < size - 1 && read_text(&s, text) == STATUS_OK);
    const double begun_s = cpu_s();
    CHECK(cast_create(&cast, &s) == STATUS_OK);
    CHECK(cpu_s() - begun_s < 60); /* some two seconds */
    CHECK(cast->round_count == scenario_max_rounds);
    cast_destroy(cast);
    scenario_destroy(&s);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_wrong_is_said), cmocka_unit_test(what_cannot_be_cast),
        cmocka_unit_test(set_from_outside),      cmocka_unit_test(types),
        cmocka_unit_test(bundled_scenarios),     cmocka_unit_test(the_most_there_may_be),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
