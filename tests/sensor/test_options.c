/* The options of `replay`, every one by the table itself: each changes what a run is told, and a variant of a sweep is
 * told the same as a run without one. What an option changes is found by comparing all of Options: an option that
 * changes nothing there fails, until this test can see what it changes, and with that whether a variant has it. */
#include "tests/check.h"

#include "sensor/settings/options.h"

enum { line_max = 40 };

/* What to give each option that takes an argument, in every form that it has, other than its default. */
static const char *const samples[][2] = {
    {"port", "3001"},
    {"cigi", "127.0.0.1:8004"},
    {"fly", "ir_ag"},
    {"sight", "radar"},
    {"head", "127.0.0.1:5010"},
    {"projector", "lwir"},
    {"out", "elsewhere"},
    {"bands", "lwir"},
    {"size", "64x48"},
    {"rate", "2"},
    {"from", "3"},
    {"from", "+12"},
    {"to", "4"},
    {"planes", "range,entity"},
    {"only", "3,7,12"},
    {"only", "9"},
    {"save-frame", "9,2"},
    {"host", "1:2:3"},
    {"host", "observer"},
    {"address", "127.0.0.1"},
    {"interface", "lo"},
    {"samples", "2"},
    {"config", "FILE"},
    {"set", "detector.smear=false"},
    {"set", "publish.coco_min_pixels=9"},
    {"threads", "3"},
    {"seed", "7"},
    {"speed", "2.5"},
    {"isa", "sse4.2"},
    {"pairs", "target"},
    {"sweep", "some.yaml"},
    {"video", "/tmp/clip.mp4"},
    {"stream", "udp://127.0.0.1:5004"},
    {"memory", "frames"},
};
enum { sample_count = sizeof samples / sizeof *samples };

/* A line that must be taken. */
static void parse(Options *o, int argc, const char *const *argv)
{
    char *copy[line_max];
    CHECK(argc < line_max);
    for (int i = 0; i < argc; i++) copy[i] = (char *)(uintptr_t)argv[i];
    copy[argc] = NULL;
    log_set_sink(check_listen, NULL);
    check_said[0] = 0;
    if (options_parse(o, COMMAND_REPLAY, argc, copy) != 0) fail_msg("%s: %s", argv[argc > 3 ? 3 : 1], check_said);
}

static bool same_text(const char *a, const char *b) { return a && b ? strcmp(a, b) == 0 : a == b; }

/* The first thing that two runs are told differently; NULL: none. out and sweep are the sweep's own. */
static const char *difference(const Options *a, const Options *b)
{
    const char *key = config_difference(&a->config, &b->config);
    if (key) return key;
    if (!same_text(a->log, b->log)) return "log";
    if (!same_text(a->isa, b->isa)) return "isa";
    if (a->threads != b->threads) return "threads";
    if (a->speed != b->speed) return "speed";
    if (a->no_skip != b->no_skip) return "no_skip";
    if (a->only_count != b->only_count || memcmp(a->only, b->only, sizeof a->only) != 0) return "only";
    if (a->save_count != b->save_count || memcmp(a->save, b->save, sizeof a->save) != 0) return "save-frame";
    if (a->host_count != b->host_count) return "host";
    if (a->given_count != b->given_count) return "given";
    for (int i = 0; i < a->given_count; i++)
        if (strcmp(a->given[i].flag, b->given[i].flag) != 0 || !same_text(a->given[i].argument, b->given[i].argument))
            return "given";
    return NULL;
}

/* As a variant reads it: settings from a file, the rest from the line that options_variant makes. */
static void parse_variant(Options *variant, const Options *o)
{
    const char *argv[options_variant_argv];
    char        settings[text_file_size];
    int         argc = 0;
    text_file(settings, "");
    FILE *file = fopen(settings, "w");
    CHECK(file);
    config_write_settings(file, &o->config);
    CHECK(fclose(file) == 0);
    options_variant(argv, o, settings, "folder");
    while (argv[argc]) argc++;
    CHECK(strcmp(argv[0], "pitviper") == 0 && strcmp(argv[1], "replay") == 0);
    parse(variant, argc - 1, argv + 1); /* the command takes its arguments from its own name on */
    assert_string_equal(variant->out, "folder");
    remove(settings);
}

/* o: room for three. argument NULL: there is none. */
static void check_option(Options *o, const char *name, const char *argument)
{
    Options   *plain = o, *given = o + 1, *variant = o + 2;
    const bool of_sweep = strcmp(name, "out") == 0 || strcmp(name, "sweep") == 0 || strcmp(name, "overwrite") == 0;
    char       flag[48];
    int        argc = 3;
    /* a sensor, so that what changes one can be given */
    const char *line[line_max] = {"replay", "--set", "sensor.preset=staring_lwir", "log.pcap"};
    parse(plain, argc + 1, line);
    snprintf(flag, sizeof flag, "--%s", name);
    line[argc++] = flag;
    if (argument) line[argc++] = argument;
    line[argc++] = "log.pcap";
    parse(given, argc, line);
    const char *changed = difference(plain, given);
    if (of_sweep)
        CHECK(!changed && (!same_text(plain->out, given->out) || !same_text(plain->sweep, given->sweep) ||
                           plain->overwrite != given->overwrite));
    else if (!changed) fail_msg("replay --%s: changes nothing that this test sees; let difference() see it", name);
    parse_variant(variant, given);
    const char *lost = difference(given, variant);
    if (lost) fail_msg("replay --%s %s: a variant of a sweep has lost %s", name, argument ? argument : "", lost);
    CHECK(!variant->sweep); /* or it would begin again */
}

static void every_option_reaches_a_variant(void **state)
{
    (void)state;
    char        file[text_file_size];
    const char *name;
    bool        argument;
    int         met = 0;
    Options    *o = malloc(3 * sizeof *o);
    CHECK(o);
    text_file(file, "sensor:\n  hfov_deg: 2.5\n");
    for (int i = 0; i < options_count(); i++) {
        if (!options_option(&name, &argument, COMMAND_REPLAY, i) || strcmp(name, "help") == 0) continue;
        int tried = 0;
        for (int k = 0; argument && k < sample_count; k++) {
            if (strcmp(samples[k][0], name) != 0) continue;
            check_option(o, name, strcmp(samples[k][1], "FILE") == 0 ? file : samples[k][1]);
            tried++;
        }
        if (!argument) check_option(o, name, NULL);
        else if (tried == 0) fail_msg("replay --%s: give it an argument in samples", name);
        met++;
    }
    CHECK(met >= 20);
    remove(file);
    free(o);
}

/* All of them on one line, some of them twice: the later one counts, as it does without a sweep. */
static void all_options_together_reach_a_variant(void **state)
{
    (void)state;
    static const char *const line[] = {"replay",    "--threads",
                                       "2",         "log.pcap",
                                       "--only",    "9",
                                       "--coco",    "--causal",
                                       "--no-png",  "--no-skip",
                                       "--isa",     "sse4.2",
                                       "--threads", "1",
                                       "--only",    "3,7",
                                       "--speed",   "max",
                                       "--speed",   "4",
                                       "--sweep",   "s.yaml",
                                       "--host",    "1:2:3",
                                       "--set",     "weather.visibility_m=9000",
                                       "--seed",    "3",
                                       "--from",    "1",
                                       "--pairs",   "all"};
    Options                 *o = malloc(2 * sizeof *o);
    CHECK(o);
    parse(&o[0], sizeof line / sizeof *line, line);
    parse_variant(&o[1], &o[0]);
    assert_null(difference(&o[0], &o[1]));
    CHECK(o[1].threads == 1 && o[1].only_count == 2 && o[1].only[1] == 7 && o[1].speed == 4 && o[1].no_skip);
    CHECK(o[1].config.publish.coco && !o[1].config.publish.png && o[1].config.exercise.causal && o[1].config.seed == 3);
    assert_string_equal(o[1].config.exercise.host, "1:2:3");
    free(o);
}

static void what_a_setting_names_is_marked_as_given(void **state)
{
    (void)state;
    static const struct {
        const char *option, *key;
    } flags[] = {{"--coco", "publish.coco"},
                 {"--no-png", "publish.png"},
                 {"--no-files", "publish.files"},
                 {"--causal", "exercise.causal"}};
    Options *o = malloc(sizeof *o);
    CHECK(o);
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++) {
        const char *line[] = {"replay", flags[i].option, "log.pcap"};
        parse(o, 3, line);
        CHECK(config_given(&o->config, flags[i].key));
    }
    free(o);
}

/* With axes to come: the settings need not go together yet. */
static void a_sweep_may_bring_what_a_setting_needs(void **state)
{
    (void)state;
    Options *o = malloc(sizeof *o);
    CHECK(o);
    const char *line[] = {"replay", "--sweep", "s.yaml", "--set", "detector.smear=false", "log.pcap"};
    parse(o, 6, line);
    CHECK(config_given(&o->config, "detector.smear"));
    char *alone[] = {(char[]){"replay"}, (char[]){"--set"}, (char[]){"detector.smear=false"}, (char[]){"log.pcap"},
                     NULL};
    assert_int_equal(options_parse(o, COMMAND_REPLAY, 4, alone), 3);
    CHECK(strstr(check_said, "overrides a sensor preset"));
    free(o);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_option_reaches_a_variant),
        cmocka_unit_test(all_options_together_reach_a_variant),
        cmocka_unit_test(what_a_setting_names_is_marked_as_given),
        cmocka_unit_test(a_sweep_may_bring_what_a_setting_needs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
