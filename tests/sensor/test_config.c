/* The configuration: what is wrong is refused with file, line, key, value and range; nothing half-applied. */
#include "tests/check.h"

#include "sensor/settings/config.h"

static Status read_text(Config *config, const char *text)
{
    char path[text_file_size];
    text_file(path, text);
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    const Status status = config_read(config, path);
    remove(path);
    return status;
}

static void a_file_fills_over_the_defaults(void **state)
{
    (void)state;
    Config config = config_default();
    assert_int_equal(read_text(&config, "# a comment\nsensor:\n  width_px: 320\n  hfov_deg: 2.5\nseed: 77\n"
                                        "exercise:\n  causal: true\n  host: 1:2:3\n"),
                     STATUS_OK);
    assert_int_equal(config.sensor.width_px, 320);
    assert_int_equal(config.sensor.height_px, config_default().sensor.height_px);
    CHECK_NEAR(config.sensor.hfov_deg, 2.5, 0);
    CHECK(config.seed == 77 && config.exercise.causal);
    assert_string_equal(config.exercise.host, "1:2:3");
    assert_int_equal(read_text(&config, ""), STATUS_OK);
}

static void what_is_wrong_is_said_and_nothing_applied(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said;
    } bad[] = {
        {"sensor:\n  width_px: 320\n  wdith_px: 3\n", ":3: no such key: sensor.wdith_px"},
        {"sensor:\n  width_px: 1,5\n", ":2: sensor.width_px: '1,5' is not a whole number in 8 .. 8192 px"},
        {"sensor:\n  width_px: 7\n", "in 8 .. 8192"},
        {"terrain:\n  detail: maybe\n", ":2: terrain.detail: 'maybe' is not"},
        {"terrain:\n  woods: yes\n", ":2: terrain.woods: 'yes' is not one of on|off"},
        {"terrain:\n  woods_trees: 4000001\n", "is not a whole number in 0 .. 4000000"},
        {"terrain:\n  woods_leaves: few\n", "terrain.woods_leaves: 'few' is not one of on|off"},
        {"terrain:\n  woods_sway: 6\n", "in 0 .. 5"},
        {"terrain:\n  woods_level1_px: -1\n", "in 0 .. 1000 px"},
        {"terrain:\n  woods_half_m: 50001\n", "in 0 .. 50000 m"},
        {"sensor:\n  hfov_deg: nan\n", "sensor.hfov_deg: 'nan' is not a number in 0.01 .. 120 deg"},
        {"sensor:\n  width_px: 320\n  width_px: 321\n", ":3: sensor.width_px is given twice"},
        {"sensor:\n  optical: sepia\n", "'sepia' is not one of rgb|pan|nir"},
        {"sensor:\n  optical: rg\n", "'rg' is not one of rgb|pan|nir"},
        {"sensor:\n  width_px: [1, 2]\n", "needs one value"},
        {"sensor: [1, 2]\n", "no such key: sensor"},
        {"- a\n- b\n", "expected `section:`"},
        {"sensor:\n\twidth_px: 3\n", ":2: "},
        {"exercise:\n  causal: yes\n", "is not true or false"},
        {"exercise:\n  host: 123456789012345678901234567890\n", "longer than"},
        {"a: &x\n  b: *x\n", "no such key"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        Config config = config_default(), before;
        memcpy(&before, &config, sizeof config);
        if (read_text(&config, bad[i].text) == STATUS_OK) fail_msg("accepted: %s", bad[i].text);
        if (!strstr(check_said, bad[i].said)) fail_msg("said '%s' where '%s' was wanted", check_said, bad[i].said);
        assert_memory_equal(&config, &before, sizeof config);
    }
}

static void the_canonical_text_names_every_change(void **state)
{
    (void)state;
    static char plain[16384], changed[16384];
    Config      config = config_default();
    config_text(plain, sizeof plain, &config);
    assert_int_equal(config_set(&config, "sensor.hfov_deg", "6.000000000000001", "test"), STATUS_OK);
    config_text(changed, sizeof changed, &config);
    assert_string_not_equal(plain, changed);
    CHECK(strstr(plain, "sensor.bands=optical,mwir,lwir,radar\n"));
    CHECK(strstr(plain, "seed=1\n"));
    CHECK(strlen(plain) < sizeof plain / 2);
}

/* What a preset must leave alone is what somebody set, by file or by line, even to the default's own value. */
static void what_was_given_is_known(void **state)
{
    (void)state;
    Config config = config_default();
    CHECK(!config_given(&config, "sensor.width_px") && !config_given(&config, "sensor.hfov_deg"));
    assert_int_equal(read_text(&config, "sensor:\n  width_px: 720\n"), STATUS_OK);
    CHECK(config_given(&config, "sensor.width_px") && !config_given(&config, "sensor.hfov_deg"));
    assert_int_equal(config_set(&config, "sensor.hfov_deg", "6", "test"), STATUS_OK);
    CHECK(config_given(&config, "sensor.hfov_deg"));
    assert_int_equal(config_set(&config, "sensor.height_px", "3", "test"), STATUS_BAD_VALUE);
    CHECK(!config_given(&config, "sensor.height_px"));

    /* a key that only a sensor can obey */
    assert_int_equal(config_set(&config, "detector.f_number", "2", "test"), STATUS_OK);
    assert_int_equal(config_check(&config), STATUS_BAD_VALUE);
    assert_int_equal(config_set(&config, "sensor.preset", "tv", "test"), STATUS_OK);
    assert_int_equal(config_check(&config), STATUS_OK);
}

static void ranges_of_several_keys_are_checked(void **state)
{
    (void)state;
    Config config = config_default();
    assert_int_equal(config_check(&config), STATUS_OK);
    strcpy(config.exercise.from_s, "5"), strcpy(config.exercise.to_s, "4");
    assert_int_equal(config_check(&config), STATUS_BAD_VALUE);
    config = config_default();
    config.detector.bits = 12;
    assert_int_equal(config_check(&config), STATUS_BAD_VALUE);
}

static void a_store_is_the_whole_ground(void **state)
{
    (void)state;
    static const char *const other[][3] = {
        {"terrain.elevation", "a.tif", "terrain.store and terrain.elevation exclude"},
        {"terrain.cover", "a.tif", "terrain.store and terrain.cover exclude"},
        {"terrain.orthophoto", "a.tif", "terrain.store and terrain.orthophoto exclude"},
        {"terrain.spacing_m", "2", "terrain.store and terrain.spacing_m exclude"},
        {"terrain.ground", "fit", "mapped read-only"},
        {"terrain.store", "/nowhere.store", "cannot read /nowhere.store"}};
    Config c = config_default();
    assert_int_equal(config_set(&c, "terrain.store", "/proc/self/exe", "test"), STATUS_OK);
    assert_int_equal(config_check(&c), STATUS_OK);
    log_set_sink(check_listen, NULL);
    for (size_t k = 0; k < sizeof other / sizeof *other; k++) {
        Config both = c;
        assert_int_equal(config_set(&both, other[k][0], other[k][1], "test"), STATUS_OK);
        assert_int_equal(config_check(&both), STATUS_BAD_VALUE);
        if (!strstr(check_said, other[k][2])) fail_msg("said: %s", check_said);
    }
    log_set_sink(NULL, NULL);
}

/* Planes that a world without plants lacks cannot be asked for; `all` takes what there is. */
static void planes_of_plants_need_plants(void **state)
{
    (void)state;
    static const char *const planes[] = {"instance", "range,cover", "all", "range"};
    for (int woods = 0; woods < 2; woods++)
        for (int k = 0; k < 4; k++) {
            Config c = config_default();
            CHECK(c.terrain.woods);
            assert_int_equal(config_set(&c, "terrain.woods", woods ? "on" : "off", "test"), STATUS_OK);
            assert_int_equal(config_set(&c, "publish.planes", planes[k], "test"), STATUS_OK);
            *check_said = 0;
            log_set_sink(check_listen, NULL);
            const Status status = config_check(&c);
            log_set_sink(NULL, NULL);
            assert_int_equal(status, woods || k >= 2 ? STATUS_OK : STATUS_BAD_VALUE);
            CHECK(status == STATUS_OK || strstr(check_said, "terrain.woods"));
        }
}

static void where_it_comes_from_and_goes_to_is_not_hashed(void **state)
{
    (void)state;
    static const char *const        same[][2] = {{"network.address", "239.1.2.3"}, {"network.ttl", "3"},
                                                 {"publish.dis", "truth"},         {"publish.files", "false"},
                                                 {"record.path", "a.pcapng"},      {"exercise.port", "4000"},
                                                 {"exercise.to_s", "12"}},
                             *const other[][2] = {{"seed", "2"},
                                                  {"terrain.woods", "off"},
                                                  {"exercise.listen_s", "3"},
                                                  {"node.site", "7"}};
    static char                     plain[16384], text[16384];
    Config                          config = config_default();
    config_text(plain, sizeof plain, &config);
    for (size_t i = 0; i < sizeof same / sizeof same[0]; i++) {
        assert_int_equal(config_set(&config, same[i][0], same[i][1], "test"), STATUS_OK);
        config_text(text, sizeof text, &config);
        if (strcmp(text, plain) != 0) fail_msg("%s changes the text", same[i][0]);
    }
    for (size_t i = 0; i < sizeof other / sizeof other[0]; i++) {
        config = config_default();
        assert_int_equal(config_set(&config, other[i][0], other[i][1], "test"), STATUS_OK);
        config_text(text, sizeof text, &config);
        if (strcmp(text, plain) == 0) fail_msg("%s does not", other[i][0]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_fills_over_the_defaults),
        cmocka_unit_test(what_is_wrong_is_said_and_nothing_applied),
        cmocka_unit_test(the_canonical_text_names_every_change),
        cmocka_unit_test(what_was_given_is_known),
        cmocka_unit_test(ranges_of_several_keys_are_checked),
        cmocka_unit_test(a_store_is_the_whole_ground),
        cmocka_unit_test(planes_of_plants_need_plants),
        cmocka_unit_test(where_it_comes_from_and_goes_to_is_not_hashed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
