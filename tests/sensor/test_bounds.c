/* Every setting of a run, of a scenario and of a case of the regression against tests/data/settings.csv: its default,
 * its words, and each bound, which is tried: it is taken, what lies beyond is refused with a line that names the
 * setting and its range. */
#include "tests/check.h"

#include "entities/exercise/scenario.h"
#include "entities/import/sidecar.h"
#include "pitviper_table.h"
#include "sensor/commands/commands.h"
#include "sensor/settings/config_private.h"
#include "sensor/settings/options.h"
#include "sensor/verify/regress/case.h"

#define OF_SCENARIO(...) SETTING_ROW(Scenario, __VA_ARGS__)
#define OF_GROUP(...)    SETTING_ROW(ScenarioGroup, __VA_ARGS__)
#define OF_SHOT(...)     SETTING_ROW(ScenarioShot, __VA_ARGS__)
#define OF_CASE(...)     SETTING_ROW(Case, __VA_ARGS__)
static const Setting scenario_keys[] = {SCENARIO_ROWS(OF_SCENARIO)}, group_keys[] = {SCENARIO_GROUP(OF_GROUP)},
                     shot_keys[] = {SCENARIO_SHOT(OF_SHOT)},
                     case_keys[] = {CASE_TOP(OF_CASE) CASE_SCORES(OF_CASE) CASE_TOLERANCE(OF_CASE)};

/* The program's readers, each with one key: settings that stand at the top of a file or of an option, and items of
 * lists. */
static Status read_file(Status (*read)(const char *path), const char *text)
{
    char path[text_file_size];
    text_file(path, text);
    const Status status = read(path);
    remove(path);
    return status;
}
static Status of_scenario(const char *path)
{
    Scenario     s;
    const Status status = scenario_read(&s, path);
    if (status == STATUS_OK) scenario_destroy(&s);
    return status;
}
static Status of_case(const char *path)
{
    static Case c;
    c = case_default();
    return case_read_file(&c, path);
}

static Status give_run(const char *name, const char *value)
{
    static Config c;
    c = config_default();
    return config_set(&c, name, value, "test");
}
static Status give_scenario(const char *name, const char *value)
{
    static Scenario s;
    s = (Scenario){SCENARIO_ROWS(SETTING_DEFAULT)};
    return scenario_set(&s, name, value, "test");
}
static char   document[20000];
static Status give_vehicle(const char *name, const char *value)
{
    const bool numbers = strcmp(name, "route_m") == 0;
    snprintf(document, sizeof document, "vehicles:\n- {%s: %s%s%s}\n", name, numbers ? "[[0, " : "", value,
             numbers ? "]]" : "");
    return read_file(of_scenario, document);
}
static Status give_shot(const char *name, const char *value)
{
    const bool numbers = strcmp(name, "at_m") == 0 || strcmp(name, "launch_m") == 0;
    snprintf(document, sizeof document, "shots:\n- {%s: %s%s%s}\n", name, numbers ? "[0, " : "", value,
             numbers ? "]" : "");
    return read_file(of_scenario, document);
}
static Status give_case(const char *name, const char *value)
{
    const char *dot = strchr(name, '.');
    const bool  numbers = strcmp(name, "frames") == 0;
    snprintf(document, sizeof document, "%.*s%s%s: %s%s%s\n", dot ? (int)(dot - name) : 0, name, dot ? ":\n  " : "",
             dot ? dot + 1 : name, numbers ? "[0, " : "", value, numbers ? "]" : "");
    return read_file(of_case, document);
}

typedef struct Owner {
    const char    *of;
    const Setting *row;
    int            count;
    Status (*give)(const char *name, const char *value);
    const void *defaults;
} Owner;

enum { OF, NAME, KIND, DEFAULT, LEAST, MOST, UNIT, CHOICES, column_count };
static const char *const column_names[] = {"of", "name", "kind", "default", "least", "most", "unit", "choices"};
static const char *const kinds[] = {[SETTING_DOUBLE] = "double",
                                    [SETTING_INT] = "int",
                                    [SETTING_LONG] = "long",
                                    [SETTING_BOOL] = "bool",
                                    [SETTING_TEXT] = "text",
                                    [SETTING_SWITCH] = "switch",
                                    [SETTING_CHOICE] = "choice",
                                    [SETTING_WORDS] = "words",
                                    [SETTING_NUMBERS] = "numbers",
                                    [SETTING_PATH] = "path",
                                    [SETTING_PATHS] = "paths",
                                    [SETTING_NAME_OR_PATH] = "name_or_path",
                                    [SETTING_NAME_OR_PATHS] = "name_or_paths"};

static int faults;
#define FAULT(...)                                                                                                     \
    do {                                                                                                               \
        print_error(__VA_ARGS__);                                                                                      \
        faults++;                                                                                                      \
    } while (0)

/* Tries a value. Whether another setting or a missing one spoils the file is not asked: refused is what names this key
 * and says `range`. */
static void expect(const Owner *o, const char *name, const char *value, const char *range, bool taken)
{
    check_said[0] = 0;
    const Status status = o->give(name, value);
    const bool   refused = status != STATUS_OK && strstr(check_said, name) && strstr(check_said, range);
    if (refused == taken || (!taken && status == STATUS_OK))
        FAULT("%s: %s: %.40s is %s; said: %s\n", o->of, name, value,
              taken ? "refused" : "taken, or refused without its range", check_said);
}

/* least, most: as the list has them. */
static void try_numbers(const Owner *o, const Setting *row, const char *least, const char *most, const char *unit)
{
    const bool whole = row->type == SETTING_INT || row->type == SETTING_LONG;
    double     low, high;
    char       range[128], value[64];
    CHECK(text_to_double(&low, least) && text_to_double(&high, most) && low < high);
    snprintf(range, sizeof range, " in %.10g .. %.10g%s%s", low, high, *unit ? " " : "", unit);
    expect(o, row->name, least, range, true);
    expect(o, row->name, most, range, true);
    snprintf(value, sizeof value, whole ? "%.0f" : "%.17g", whole ? low - 1 : nextafter(low, -INFINITY));
    expect(o, row->name, value, range, false);
    snprintf(value, sizeof value, whole ? "%.0f" : "%.17g", whole ? high + 1 : nextafter(high, INFINITY));
    expect(o, row->name, value, range, false);
    expect(o, row->name, ".nan", range, false);
    if (row->type != SETTING_NUMBERS) expect(o, row->name, "", range, false);
    if (!whole) return;
    snprintf(value, sizeof value, "%.1f", low + 0.5);
    expect(o, row->name, value, range, false);
}

static void try_words(const Owner *o, const char *name, const char *choices)
{
    char all[256], *rest = NULL;
    CHECK(snprintf(all, sizeof all, "%s", choices) < (int)sizeof all);
    for (char *word = strtok_r(all, "|", &rest); word; word = strtok_r(NULL, "|", &rest))
        expect(o, name, word, "is not ", true);
    expect(o, name, "neither", strcmp(choices, "true|false") == 0 ? "true or false" : choices, false);
    expect(o, name, choices, "is not ", false);
}

static void try_length(const Owner *o, const char *name, const char *most)
{
    static char text[20000];
    char        longer[64];
    const int   n = atoi(most);
    CHECK(n > 0 && n < (int)sizeof text - 2);
    snprintf(longer, sizeof longer, "longer than %d characters", n);
    memset(text, 'a', sizeof text);
    text[n] = 0;
    expect(o, name, text, longer, true);
    text[n] = 'a', text[n + 1] = 0;
    expect(o, name, text, longer, false);
}

static bool same_default(const Owner *o, const Setting *row, const char *want)
{
    static char        text[20000];
    const SettingTable one = {.module = "test", .row = row, .count = 1};
    double             a, b;
    settings_text(text, sizeof text, &one, o->defaults);
    text[strcspn(text, "\n")] = 0;
    const char *got = strchr(text, '=') + 1;
    if (strcmp(want, "unset") == 0) return strstr(got, "nan") != NULL;
    if (row->type == SETTING_DOUBLE) return text_to_double(&a, got) && text_to_double(&b, want) && a == b;
    return strcmp(got, want) == 0;
}

static void check_setting(const Owner *o, const Setting *row, const Table *list, const int at[column_count], int line)
{
    const char *cell[column_count];
    for (int c = 0; c < column_count; c++) cell[c] = table_text(list, line, at[c]);
    if (strcmp(cell[KIND], kinds[row->type]) != 0) {
        FAULT("%s: %s is %s, in the list %s\n", o->of, row->name, kinds[row->type], cell[KIND]);
        return;
    }
    if (!same_default(o, row, cell[DEFAULT])) FAULT("%s: %s: its default is not %s\n", o->of, row->name, cell[DEFAULT]);
    if (strcmp(row->unit, cell[UNIT]) != 0)
        FAULT("%s: %s is in %s, in the list in %s\n", o->of, row->name, row->unit, cell[UNIT]);
    switch (row->type) {
    case SETTING_DOUBLE:
    case SETTING_INT:
    case SETTING_LONG:
    case SETTING_NUMBERS:
        try_numbers(o, row, cell[LEAST], cell[MOST], cell[UNIT]);
        break;
    case SETTING_BOOL:
    case SETTING_SWITCH:
    case SETTING_CHOICE:
        if (row->choices && strcmp(row->choices, cell[CHOICES]) != 0)
            FAULT("%s: %s: its words are %s, in the list %s\n", o->of, row->name, row->choices, cell[CHOICES]);
        try_words(o, row->name, cell[CHOICES]);
        break;
    default:
        try_length(o, row->name, cell[MOST]);
    }
}

static void every_setting_is_as_the_list_has_it(void **state)
{
    (void)state;
    static const Config        run = {CONFIG_ROWS(SETTING_DEFAULT)};
    static const Scenario      scenario = {SCENARIO_ROWS(SETTING_DEFAULT)};
    static const ScenarioGroup group = {SCENARIO_GROUP(SETTING_DEFAULT)};
    static const ScenarioShot  shot = {SCENARIO_SHOT(SETTING_DEFAULT)};
    static Case                one;
    one = case_default();
#define COUNT(keys) (int)(sizeof(keys) / sizeof *(keys))
    const Owner owners[] = {{"run", config_table.row, config_table.count, give_run, &run},
                            {"scenario", scenario_keys, COUNT(scenario_keys), give_scenario, &scenario},
                            {"vehicles", group_keys, COUNT(group_keys), give_vehicle, &group},
                            {"shots", shot_keys, COUNT(shot_keys), give_shot, &shot},
                            {"case", case_keys, COUNT(case_keys), give_case, &one}};
    Table       list;
    int         at[column_count], seen = 0;
    assert_int_equal(table_open(&list, "tests/data/settings.csv"), STATUS_OK);
    CHECK(table_columns(at, &list, column_names, column_count, "test"));
    log_set_sink(check_listen, NULL);
    for (size_t k = 0; k < sizeof owners / sizeof *owners; k++)
        for (int i = 0; i < owners[k].count; i++) {
            const Owner *o = &owners[k];
            int          line = 0;
            while (line < list.rows && (strcmp(table_text(&list, line, at[OF]), o->of) != 0 ||
                                        strcmp(table_text(&list, line, at[NAME]), o->row[i].name) != 0))
                line++;
            if (line == list.rows) {
                FAULT(
                    "%s: %s is not in tests/data/settings.csv; add its row there, with what physics or a standard says of "
                    "its bounds\n",
                    o->of, o->row[i].name);
                continue;
            }
            seen++;
            check_setting(o, &o->row[i], &list, at, line);
        }
    log_set_sink(NULL, NULL);
    if (seen != list.rows)
        FAULT("%d rows of tests/data/settings.csv are of no setting; take them out\n", list.rows - seen);
    table_close(&list);
    assert_int_equal(faults, 0);
}

/* ---- sidecars ---------------------------------------------------------------------------------------------- */

static void numbers_of_sidecars(void **state)
{
    (void)state;
    static const struct {
        const char *text, *name, *range, *taken[2], *refused[2]; /* text: with %s where the number goes */
    } fields[] = {
        /* a unit of a millionth of a metre to a thousand kilometres */
        {"scale: %s\n", "scale", "in 1e-06 .. 1000000 metres", {"1e-6", "1e6"}, {"9.99999e-7", "1000000.1"}},
        {"crease_deg: %s\n", "crease_deg", "in 0 .. 180 deg", {"0", "180"}, {"-1e-9", "180.00001"}},
        {"origin: [0, 0, %s]\n", "origin", "in -1e9 .. 1e9", {"-1e9", "1e9"}, {"-1000000001", "1000000001"}},
        {"thickness_mm: {a: %s}\n", "thickness_mm", "0.1 .. 1000 mm", {"0.1", "1000"}, {"0.09999", "1000.01"}},
        {"joints:\n- {nodes: a, rest_deg: %s}\n",
         "joints.rest_deg",
         "in -360 .. 360 deg",
         {"-360", "360"},
         {"-360.01", "360.01"}},
        {"joints:\n- {nodes: a, spin_rpm: %s}\n",
         "joints.spin_rpm",
         "in -100000 .. 100000 turns",
         {"-1e5", "1e5"},
         {"-100001", "100001"}},
        {"joints:\n- {nodes: a, limits_deg: [-3600, %s]}\n",
         "joints.limits_deg",
         "in -3600 .. 3600 deg",
         {"-3600", "3600"},
         {"3600.1", "nan"}},
        {"joints:\n- {nodes: a, limits_m: [%s, 1000]}\n",
         "joints.limits_m",
         "in -1000 .. 1000 m",
         {"-1000", "1000"},
         {"-1000.1", "1000.1"}},
        {"joints:\n- {nodes: a, roll_radius: %s}\n",
         "joints.roll_radius",
         "in 0.01 .. 10 m",
         {"0.01", "10"},
         {"0.00999", "10.01"}},
        {"joints:\n- {nodes: a, pivot: [%s, 0, 0]}\n",
         "joints.pivot",
         "in -1e9 .. 1e9",
         {"-1e9", "1e9"},
         {"-1000000001", "1000000001"}},
    };
    char text[256], format[96];
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        for (int k = 0; k < 4; k++) {
            Sidecar     s = sidecar_default();
            const char *at = strchr(fields[i].text, '%'),
                       *value = k < 2 ? fields[i].taken[k] : fields[i].refused[k - 2];
            snprintf(format, sizeof format, "%.*s", (int)(at - fields[i].text), fields[i].text);
            snprintf(text, sizeof text, "%s%s%s", format, value, at + 2);
            check_said[0] = 0;
            const Status status = sidecar_parse(&s, "test.yaml", text, strlen(text));
            const bool   refused =
                status != STATUS_OK && strstr(check_said, fields[i].name) && strstr(check_said, fields[i].range);
            if (refused != (k >= 2))
                fail_msg("%s: %s is %s; said: %s", fields[i].name, value, k < 2 ? "refused" : "taken", check_said);
            if (status == STATUS_OK) sidecar_close(&s);
        }
    log_set_sink(NULL, NULL);
}

/* ---- command lines ----------------------------------------------------------------------------------------- */

static int parse_replay(int argc, char **argv)
{
    static Options o;
    return options_parse(&o, COMMAND_REPLAY, argc, argv);
}
static int parse_run(int argc, char **argv)
{
    static Options o;
    return options_parse(&o, COMMAND_RUN, argc, argv);
}

/* Each is given with an option that no command has behind it, so that a command that takes the number stops there. */
static void numbers_on_command_lines(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        int (*command)(int argc, char **argv);
        const char *flag, *taken[2], *refused[2], *range;
    } flags[] = {
        {"pitviper replay", parse_replay, "--threads", {"1", "256"}, {"0", "257"}, "1 .. 256"},
        {"pitviper run", parse_run, "--threads", {"1", "256"}, {"1.5", "-1"}, "1 .. 256"},
        {"pitviper replay", parse_replay, "--speed", {"0.001", "1e6"}, {"0.000999", "1000001"}, "0.001 .. 1000000"},
        {"pitviper replay", parse_replay, "--speed", {"max", "1"}, {"nan", "-1"}, "0.001 .. 1000000"},
        {"pitviper replay", parse_replay, "--only", {"0", "999999"}, {"-1", "1000000"}, "0 .. 999999"},
        {"pitviper replay", parse_replay, "--save-frame", {"0", "999999"}, {"-1", "1000000"}, "0 .. 999999"},
        {"pitviper run", parse_run, "--for", {"1e-9", "1e8"}, {"0", "100000001"}, "above 0, up to 1e8"},
        {"pitviper run", parse_run, "--frames", {"1", "1000000000"}, {"0", "1000000001"}, "1 .. 1000000000"},
        {"pitviper replay", parse_replay, "--size", {"8x8", "8192x8192"}, {"7x8", "8x8193"}, "8 .. 8192 px"},
        {"pitviper frame", frame_command, "--threads", {"1", "256"}, {"0", "257"}, "1 .. 256"},
        {"pitviper explain", explain_command, "--threads", {"1", "256"}, {"0", "257"}, "1 .. 256"},
        {"pitviper terrain", terrain_command, "--threads", {"1", "256"}, {"0", "257"}, "1 .. 256"},
        {"pitviper inspect", inspect_command, "--port", {"0", "65535"}, {"-1", "65536"}, "0 .. 65535"},
        {"pitviper inspect", inspect_command, "--exercise", {"0", "255"}, {"-1", "256"}, "0 .. 255"},
        {"pitviper exercise", exercise_command, "--ttl", {"0", "255"}, {"-1", "256"}, "0 .. 255"},
        {"pitviper exercise", exercise_command, "--speed", {"0.01", "1000"}, {"0.00999", "1000.1"}, "0.01 .. 1000"},
        {"pitviper record", record_command, "--port", {"1", "65535"}, {"0", "65536"}, "1 .. 65535"},
        {"pitviper record", record_command, "--for", {"1e-9", "1e9"}, {"0", "1000000001"}, "above 0, up to 1e9"},
        {"pitviper record", record_command, "--count", {"1", "1000000000000"}, {"0", "1.5"}, "from 1 on"},
        {"pitviper model", model_command, "--sag", {"1e-5", "0.1"}, {"9.99e-6", "0.1001"}, "1e-05 .. 0.1 m"},
        {"pitviper model", model_command, "--length", {"0.001", "2000"}, {"0.000999", "2000.1"}, "0.001 .. 2000 m"},
        {"pitviper model", model_command, "--height", {"0.001", "2000"}, {"nan", "-1"}, "0.001 .. 2000 m"},
        {"pitviper heat", heat_command, "--heading", {"-360", "360"}, {"-360.1", "360.1"}, "-360 .. 360 deg"},
        {"pitviper heat", heat_command, "--step", {"1", "600"}, {"0.5", "1200"}, "divisor of 600 s"},
        {"pitviper heat", heat_command, "--step", {"60", "300"}, {"7", "nan"}, "divisor of 600 s"},
        {"pitviper heat",
         heat_command,
         "--drive",
         {"00:00-24:00", "06:00-07:30"},
         {"06:00-24:01", "07:00-06:00"},
         "hours of the day"},
        {"pitviper rcs", rcs_command, "--frequency", {"0.1", "300"}, {"0.0999", "300.1"}, "0.1 .. 300 GHz"},
        {"pitviper rcs", rcs_command, "--elevation", {"-90", "90"}, {"-90.1", "90.1"}, "-90 .. 90 deg"},
        {"pitviper rcs", rcs_command, "--range", {"0.001", "1e9"}, {"0.000999", "1000000001"}, "0.001 .. 1e9 m"},
        {"pitviper rcs", rcs_command, "--rays", {"0.25", "16"}, {"0.2499", "16.1"}, "0.25 .. 16"},
        {"pitviper rcs", rcs_command, "--splits", {"0", "5"}, {"-1", "6"}, "0 .. 5"},
        {"pitviper rcs", rcs_command, "--warp", {"0", "20"}, {"-0.1", "20.1"}, "0 .. 20 mm"},
        {"pitviper rcs", rcs_command, "--cell", {"0.01", "10"}, {"0.00999", "10.1"}, "0.01 .. 10 m"},
        {"pitviper rcs", rcs_command, "--image", {"-720", "720"}, {"-720.1", "720.1"}, "within 720 deg"},
        {"pitviper rcs", rcs_command, "--azimuth", {"-720:720:0.04", "0:0:1"}, {"-721:0:1", "0:360:0"}, "FROM:TO:STEP"},
        {"pitviper rcs", rcs_command, "--joint", {"a=-3600", "a=3600"}, {"a=-3600.1", "a=3600.1"}, "-3600 .. 3600 deg"},
    };
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
        for (int k = 0; k < 4; k++) {
            char  name[64], flag[64], value[64], none[] = "--no-such-option", first[8];
            char *argv[] = {name, flag, value, none, NULL, NULL};
            snprintf(name, sizeof name, "%s", flags[i].name);
            snprintf(flag, sizeof flag, "%s", flags[i].flag);
            snprintf(value, sizeof value, "%s", k < 2 ? flags[i].taken[k] : flags[i].refused[k - 2]);
            check_said[0] = 0;
            /* two have a word before their options */
            const bool action = flags[i].command == terrain_command || flags[i].command == model_command;
            snprintf(first, sizeof first, "%s", flags[i].command == model_command ? "info" : "import");
            if (action) memmove(argv + 2, argv + 1, 3 * sizeof *argv), argv[1] = first;
            const int  code = flags[i].command(4 + action, argv);
            const bool taken = strstr(check_said, none) != NULL;
            if (code == 0 || taken != (k < 2) ||
                (!taken && !(strstr(check_said, flag) && strstr(check_said, flags[i].range))))
                fail_msg("%s %s %s: code %d; said: %s", name, flag, value, code, check_said);
        }
    log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_setting_is_as_the_list_has_it),
                                       cmocka_unit_test(numbers_of_sidecars),
                                       cmocka_unit_test(numbers_on_command_lines)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
