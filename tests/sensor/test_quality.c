/* Settings by what they are asked to keep: the pick over a table made by hand, tables that are broken, what is said,
 * and whether what is promised holds in scenes and on a ground that the table of etc/ was not measured on.
 * labels: slow */
#include "sensor/quality/quality.h"
#include "tests/sensor/error_scenes.h"

static const char good[] =
    "# by hand\n"
    "samples,edge_samples,target_samples,optical_percent,mwir_percent,lwir_percent,mwir_k,lwir_k,ms_megapixel\n"
    "1,0,0,10,20,5,2,2,10\n"
    "1,4,48,6,4,1,0.5,0.6,40\n"
    "2,4,48,4,3.5,0.8,0.3,0.4,90\n"
    "4,8,96,2,1,0.5,0.1,0.1,400\n";

/* Woods cost six times as much, and err more at a ray. */
static const char both[] =
    "scene,samples,edge_samples,target_samples,optical_percent,mwir_percent,lwir_percent,mwir_k,lwir_k,ms_megapixel\n"
    "bare,1,0,0,10,20,5,2,2,10\n"
    "bare,1,4,48,6,4,1,0.5,0.6,40\n"
    "bare,4,8,96,2,1,0.5,0.1,0.1,400\n"
    "woods,1,0,0,30,22,6,3,3,60\n"
    "woods,1,4,48,14,5,2,1,1,100\n"
    "woods,4,8,96,4,3,1,0.3,0.3,2400\n";

static QualityTable table_of(const char *text)
{
    char         path[text_file_size];
    QualityTable table;
    text_file(path, text);
    assert_int_equal(quality_open(&table, path), STATUS_OK);
    remove(path);
    return table;
}

static int picked(bool *reached, const QualityTable *table, double percent, double kelvin, double frame_ms,
                  unsigned bands)
{
    const QualityTarget target = {percent, kelvin, frame_ms, 0.5, 2, bands, QUALITY_BARE};
    return quality_pick(reached, table, &target);
}

/* A deadline that bare ground keeps with many rays is kept among trees with fewer: of each scene its own rows alone.
 * Half a megapixel at twice the table's time. */
static void woods_have_rows_of_their_own(void **state)
{
    (void)state;
    static const struct {
        double frame_ms;
        int    bare, woods; /* rows */
    } asked[] = {{5000, 2, 5}, {1000, 2, 4}, {400, 2, 4}, {100, 1, 4}, {99, 1, 3}, {60, 1, 3}, {12, 0, 3}};
    const QualityTable t = table_of(both);
    CHECK(t.count == 6 && t.row[2].scene == QUALITY_BARE && t.row[3].scene == QUALITY_WOODS);
    for (size_t k = 0; k < sizeof asked / sizeof *asked; k++)
        for (int scene = 0; scene < quality_scenes; scene++) {
            const QualityTarget target = {NAN, NAN, asked[k].frame_ms, 0.5, 2, 7, (QualityScene)scene};
            bool                reached;
            const int           row = quality_pick(&reached, &t, &target);
            CHECK(row == (scene == QUALITY_WOODS ? asked[k].woods : asked[k].bare));
            CHECK(reached == (t.row[row].ms_megapixel <= asked[k].frame_ms)); /* the promise */
        }
    /* rows of one scene serve no other: the same settings are wanted in both, and a cheap one on bare ground spares
     * none */
    for (int k = 0; k < t.count; k++) CHECK(quality_wanted(&t, k));
    /* a table without scenes holds in all */
    const QualityTable  one = table_of(good);
    const QualityTarget in_woods = {4, NAN, NAN, 0.5, 2, 7, QUALITY_WOODS};
    bool                reached;
    CHECK(quality_pick(&reached, &one, &in_woods) == 2 && reached);
    /* written with its scenes */
    char         path[text_file_size];
    QualityTable again;
    text_file(path, "");
    assert_int_equal(quality_write(path, &t, "again"), STATUS_OK);
    assert_int_equal(quality_open(&again, path), STATUS_OK);
    remove(path);
    CHECK(again.count == 6 && again.row[4].scene == QUALITY_WOODS && again.row[4].ms_megapixel == 100);
}

/* The scene is one of woods where the settings let plants grow. */
static void the_scene_is_that_of_the_settings(void **state)
{
    (void)state;
    static const struct {
        const char *woods, *trees, *says;
        int         samples;
        bool        adaptive;
    } of[] = {{"on", "300000", "in woods", 1, false},
              {"off", "300000", "on bare ground", 1, true},
              {"on", "0", "on bare ground", 1, true}};
    char path[text_file_size];
    text_file(path, both);
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        Config  config = config_default();
        Choices choices = {0};
        assert_int_equal(config_set(&config, "quality.table", path, "test"), STATUS_OK);
        assert_int_equal(config_set(&config, "quality.frame_ms", "30", "test"), STATUS_OK); /* 0.35 megapixels */
        assert_int_equal(config_set(&config, "terrain.woods", of[k].woods, "test"), STATUS_OK);
        assert_int_equal(config_set(&config, "terrain.woods_trees", of[k].trees, "test"), STATUS_OK);
        assert_int_equal(quality_choose(&config, &choices, 7), STATUS_OK);
        print_message("%s\n", choices.line[0]);
        CHECK(config.sensor.samples == of[k].samples && config_adaptive(&config) == of[k].adaptive);
        CHECK(strstr(choices.line[0], of[k].says) && !strstr(choices.line[0], "NOT reached"));
    }
    remove(path);
}

/* What the table of etc/ promises in woods is several times what it promises on bare ground, as it is measured to be
 * (etc/cost: rays among trees), and no row of it says that trees cost nothing. */
static void woods_are_promised_no_bare_times(void **state)
{
    (void)state;
    char         path[512];
    QualityTable table;
    int          pairs = 0;
    CHECK(etc_path(path, sizeof path, "quality.csv"));
    assert_int_equal(quality_open(&table, path), STATUS_OK);
    for (int k = 0; k < table.count; k++)
        for (int n = 0; n < table.count; n++) {
            const QualityRow *bare = &table.row[k], *woods = &table.row[n];
            if (bare->scene != QUALITY_BARE || woods->scene != QUALITY_WOODS || bare->samples != woods->samples ||
                bare->edge_samples != woods->edge_samples || bare->target_samples != woods->target_samples)
                continue;
            pairs++;
            CHECK(woods->ms_megapixel > 1.3 * bare->ms_megapixel);
        }
    CHECK(pairs >= 3);
}

static void the_quickest_that_keeps_it(void **state)
{
    (void)state;
    const QualityTable t = table_of(good);
    const unsigned     all = 7, lwir = 1u << BAND_LWIR;
    bool               reached;
    CHECK(t.count == 4 && t.row[1].kelvin[BAND_LWIR] == 0.6 && t.row[3].target_samples == 96);
    CHECK(picked(&reached, &t, 7, NAN, NAN, all) == 1 && reached);
    CHECK(picked(&reached, &t, 4, NAN, NAN, all) == 2 && reached); /* not above is kept */
    CHECK(picked(&reached, &t, 3.99, NAN, NAN, all) == 3 && reached);
    CHECK(picked(&reached, &t, 1, NAN, NAN, lwir) == 1 && reached); /* only bands that are wanted */
    CHECK(picked(&reached, &t, NAN, 0.45, NAN, all) == 2 && reached);
    CHECK(picked(&reached, &t, 7, 0.2, NAN, all) == 3 && reached);   /* both */
    CHECK(picked(&reached, &t, 1, NAN, NAN, all) == 3 && !reached);  /* none: the nearest */
    CHECK(picked(&reached, &t, NAN, NAN, 95, all) == 2 && reached);  /* half a megapixel, twice the time: 90 ms */
    CHECK(picked(&reached, &t, 7, NAN, 95, all) == 1 && reached);    /* in time, and no better than asked for */
    CHECK(picked(&reached, &t, 3, NAN, 95, all) == 2 && !reached);   /* in time, nearest */
    CHECK(picked(&reached, &t, 3, NAN, 1, all) == 0 && !reached);    /* none in time: the quickest */
    CHECK(picked(&reached, &t, 0, NAN, NAN, 1u << BAND_RADAR) == 0); /* radar alone: nothing to keep */
}

/* A row as good as a quicker one in everything is for nobody; one that is better in one band alone is for somebody. */
static void rows_for_nobody_are_told(void **state)
{
    (void)state;
    static const char *const rows[] = {"2,4,64,6,4,1,0.5,0.6,50\n", "2,4,64,9,4.5,2,0.6,0.7,90\n",
                                       "2,4,64,5.9,4,1,0.5,0.6,50\n", "2,4,64,9,4.5,2,0.6,0.35,91\n",
                                       "2,4,64,6,3.9,1,0.5,0.6,41\n"};
    static const bool        wanted[] = {false, false, true, true, true};
    char                     text[1024], path[512];
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        snprintf(text, sizeof text, "%s%s", good, rows[k]);
        const QualityTable t = table_of(text);
        CHECK(t.count == 5 && quality_wanted(&t, 4) == wanted[k] && quality_wanted(&t, 0));
    }
    QualityTable table;
    CHECK(etc_path(path, sizeof path, "quality.csv"));
    assert_int_equal(quality_open(&table, path), STATUS_OK);
    for (int k = 0; k < table.count; k++) CHECK(quality_wanted(&table, k));
}

static void broken_tables_are_refused(void **state)
{
    (void)state;
    static const char head[] =
        "samples,edge_samples,target_samples,optical_percent,mwir_percent,lwir_percent,mwir_k,lwir_k,ms_megapixel\n";
    static const char *const rows[] = {"",
                                       "1,0,0,10,20,5,2,2\n",
                                       "0,0,0,1,1,1,1,1,1\n",
                                       "17,0,0,1,1,1,1,1,1\n",
                                       "1,1,48,1,1,1,1,1,1\n",
                                       "1,4,0,1,1,1,1,1,1\n",
                                       "1,0,48,1,1,1,1,1,1\n",
                                       "1.5,0,0,1,1,1,1,1,1\n",
                                       "1,0,0,nan,1,1,1,1,1\n",
                                       "1,0,0,-1,1,1,1,1,1\n",
                                       "1,0,0,1,1,1,1,1,0\n",
                                       "1,0,0,1,1,1,1,1,inf\n",
                                       "1,0,0,,1,1,1,1,1\n",
                                       "1,4,7,1,1,1,1,1,1\n",
                                       "1,4,257,1,1,1,1,1,1\n",
                                       "1,0,0,1,1,1,1,1,1e300\n"};
    static const char *const scenes[] = {"bare,1,0,0,1,1,1,1,1,1\n", "woods,1,0,0,1,1,1,1,1,1\n",
                                         "bare,1,0,0,1,1,1,1,1,1\nsea,1,0,0,1,1,1,1,1,1\n",
                                         "bare,1,0,0,1,1,1,1,1,1\n,1,0,0,1,1,1,1,1,1\n"};
    char                     path[text_file_size], text[16384];
    QualityTable             table;
    log_suppress(true);
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        snprintf(text, sizeof text, "%s%s", head, rows[k]);
        text_file(path, text);
        CHECK(quality_open(&table, path) != STATUS_OK);
        remove(path);
    }
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) { /* a scene without rows, or unknown */
        snprintf(text, sizeof text, "scene,%s%s", head, scenes[k]);
        text_file(path, text);
        CHECK(quality_open(&table, path) == STATUS_BAD_VALUE);
        remove(path);
    }
    text_file(path, "samples,edge_samples\n1,0\n"); /* columns missing */
    CHECK(quality_open(&table, path) == STATUS_BAD_VALUE);
    remove(path);
    strcpy(text, head); /* too many */
    for (int k = 0; k <= quality_rows_max; k++) strcat(text, "1,0,0,1,1,1,1,1,1\n");
    text_file(path, text);
    CHECK(quality_open(&table, path) == STATUS_BAD_VALUE);
    remove(path);
    CHECK(quality_open(&table, "/nonexistent/quality.csv") != STATUS_OK);
    log_suppress(false);
    /* and what is written reads back */
    const QualityTable t = table_of(good);
    text_file(path, "");
    assert_int_equal(quality_write(path, &t, "again"), STATUS_OK);
    assert_int_equal(quality_open(&table, path), STATUS_OK);
    remove(path);
    CHECK(table.count == t.count && table.row[2].percent[1] == 3.5 && table.row[3].ms_megapixel == 400);
}

static void given_keys_stay_and_the_choice_is_said(void **state)
{
    (void)state;
    char    path[text_file_size], text[2][16384];
    Choices choices = {0};
    Config  config = config_default(), plain = config;
    text_file(path, good);
    assert_int_equal(quality_choose(&config, &choices, 7), STATUS_OK); /* nothing asked for */
    CHECK(choices.count == 0 && config.sensor.edge_samples == plain.sensor.edge_samples);
    assert_int_equal(config_set(&config, "quality.table", path, "test"), STATUS_OK);
    assert_int_equal(config_set(&config, "quality.radiance_rmse_percent", "3", "test"), STATUS_OK);
    assert_int_equal(config_set(&config, "sensor.edge_samples", "5", "test"), STATUS_OK);
    assert_int_equal(quality_choose(&config, &choices, 7), STATUS_OK);
    CHECK(config.sensor.samples == 4 && config.sensor.edge_samples == 5 && config.sensor.target_samples == 96);
    print_message("%s\n", choices.line[0]);
    CHECK(choices.count == 1 && strstr(choices.line[0], "3 % rmse") &&
          strstr(choices.line[0], "sensor.edge_samples as given"));
    CHECK(!strstr(choices.line[0], "NOT reached"));
    /* asking changes no hash, what is picked does */
    config.sensor = plain.sensor;
    config_text(text[0], sizeof text[0], &config);
    config_text(text[1], sizeof text[1], &plain);
    assert_string_equal(text[0], text[1]);
    /* out of reach */
    choices.count = 0;
    config = plain;
    assert_int_equal(config_set(&config, "quality.table", path, "test"), STATUS_OK);
    assert_int_equal(config_set(&config, "quality.temperature_rms_k", "0.01", "test"), STATUS_OK);
    log_suppress(true);
    assert_int_equal(quality_choose(&config, &choices, 7), STATUS_OK);
    print_message("%s\n", choices.line[0]);
    CHECK(strstr(choices.line[0], "NOT reached") && config.sensor.samples == 4);
    /* antialias off where the row says so; time by a factor */
    config = plain, choices.count = 0;
    assert_int_equal(config_set(&config, "quality.table", path, "test"), STATUS_OK);
    assert_int_equal(config_set(&config, "quality.frame_ms", "5", "test"), STATUS_OK);
    CHECK(quality_wants_factor(&config));
    assert_int_equal(quality_choose(&config, &choices, 7), STATUS_OK);
    CHECK(config.sensor.antialias == ANTIALIAS_OFF && config.sensor.samples == 1);
    assert_int_equal(config_set(&config, "quality.machine_factor", "0.1", "test"), STATUS_OK);
    CHECK(!quality_wants_factor(&config));
    assert_int_equal(quality_choose(&config, &choices, 7), STATUS_OK); /* 0.35 megapixels, 90 ms, a tenth: 3.1 ms */
    CHECK(config.sensor.samples == 2 && config.sensor.antialias == ANTIALIAS_ADAPTIVE);
    CHECK(config_set(&config, "quality.frame_ms", "0", "test") == STATUS_BAD_VALUE);
    CHECK(config_set(&config, "quality.machine_factor", "-1", "test") == STATUS_BAD_VALUE);
    CHECK(config_set(&config, "quality.radiance_rmse_percent", "nan", "test") == STATUS_BAD_VALUE);
    log_suppress(false);
    remove(path);
}

/* Another ground, other vehicles, other eyes than those the table was measured on. */
static void promises_hold_elsewhere(void **state)
{
    (void)state;
    static const ErrorScene scenes[] = {{"ground from 100 m", 700, 110, 45, 0, false, 0, false},
                                        {"vehicles at 80 m", 80, 15, 40, 6, false, 0, false},
                                        {"vehicles at 400 m", 400, 50, 15, 10, false, 0, false},
                                        {"horizon", 250, 9, 35, 3, false, 3, false}};
    static const double     asked_percent[] = {10, 5, 2.5};
    char                    path[512];
    QualityTable            table;
    int                     held = 0, cases = 0;
    CHECK(etc_path(path, sizeof path, "quality.csv"));
    assert_int_equal(quality_open(&table, path), STATUS_OK);
    for (int s = 0; s < 4; s++) {
        TrialScene scene;
        open_scene(&scene, &lab.ground, &scenes[s]);
        RenderRequest request = request_of(&scene, &scenes[s]);
        request.budget = false;
        request.samples = 16, request.edge_samples = request.target_samples = 0;
        const TrialFrame true_one = frame_of(&scene, &request, 0);
        for (int k = 0; k < 3; k++) {
            bool                reached;
            const QualityTarget target = {asked_percent[k], NAN, NAN, 1, 1, 7, QUALITY_BARE};
            const QualityRow   *r = &table.row[quality_pick(&reached, &table, &target)];
            CHECK(reached);
            request.samples = r->samples, request.edge_samples = r->edge_samples,
            request.target_samples = r->target_samples;
            const TrialFrame f = frame_of(&scene, &request, 1);
            for (int b = 0; b < radiance_bands; b++) {
                const double percent = 100 * apart(&f.picture, &true_one.picture, (Band)b);
                print_message(
                    "%-18s %-8s asked for %4.1f %%: samples %d, edge_samples %d, target_samples %d: %.2f %%%s\n",
                    scenes[s].name, band_name((Band)b), asked_percent[k], r->samples, r->edge_samples,
                    r->target_samples, percent, percent <= asked_percent[k] ? "" : "  *");
                cases++, held += percent <= asked_percent[k];
            }
        }
        trial_scene_close(&scene);
    }
    print_message("kept: %d of %d\n", held, cases);
    CHECK(held == cases);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_quickest_that_keeps_it),
                                       cmocka_unit_test(woods_have_rows_of_their_own),
                                       cmocka_unit_test(the_scene_is_that_of_the_settings),
                                       cmocka_unit_test(woods_are_promised_no_bare_times),
                                       cmocka_unit_test(rows_for_nobody_are_told),
                                       cmocka_unit_test(broken_tables_are_refused),
                                       cmocka_unit_test(given_keys_stay_and_the_choice_is_said),
                                       cmocka_unit_test(promises_hold_elsewhere)};
    return cmocka_run_group_tests(tests, lab_open, lab_close);
}
