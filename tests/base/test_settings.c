/* Settings: what is wrong is refused with its line; lists and numbers; what is written reads back the same. */
#include "tests/check.h"

#include "pitviper_settings.h"

typedef struct Thing {
    double     size_m;
    char       name[8];
    NumberList way;
} Thing;

typedef struct Box {
    int       count, deep;
    double    weight_kg, unset;
    bool      open;
    long long seed;
    char      label[24];
    Thing     thing[2];
    int       things;
} Box;

static void *add_thing(void *owner)
{
    Box *box = owner;
    return box->things < 2 ? &box->thing[box->things++] : NULL;
}

static const Setting thing_rows[] = {
    {"size_m", SETTING_DOUBLE, SETTING_AT(Thing, size_m), 0, 10, NULL, "m", ""},
    {"name", SETTING_TEXT, SETTING_AT(Thing, name), 0, 0, NULL, "", ""},
    {"way", SETTING_NUMBERS, SETTING_AT(Thing, way), -100, 100, NULL, "m", ""},
};
static const SettingTable thing_table = {.module = "test", .row = thing_rows, .count = 3};
static const SettingList  lists[] = {{"things", &thing_table, add_thing}};
static const Setting      box_rows[] = {
         {"count", SETTING_INT, SETTING_AT(Box, count), 0, 9, NULL, "", "how many"},
         {"inside.deep", SETTING_INT, SETTING_AT(Box, deep), -5, 5, NULL, "px", "of it"},
         {"inside.weight_kg", SETTING_DOUBLE, SETTING_AT(Box, weight_kg), NAN, NAN, NULL, "kg", ""},
         {"inside.unset", SETTING_DOUBLE, SETTING_AT(Box, unset), 0, 1, NULL, "", "or not"},
         {"inside.open", SETTING_BOOL, SETTING_AT(Box, open), 0, 1, NULL, "", ""},
         {"inside.label", SETTING_TEXT, SETTING_AT(Box, label), 0, 0, NULL, "", "on the lid"},
         {"seed", SETTING_LONG, SETTING_AT(Box, seed), 0, 1e15, NULL, "", ""},
};
static const SettingTable table = {
    .module = "test", .row = box_rows, .count = 7, .list = lists, .list_count = 1, .all_keys = "ask"};

/* What a table reads itself: a text, a list as words, each of several, a map. */
typedef struct Own {
    char said[128];
    int  deep, lines;
} Own;

static Status own(const char **complaint, void *out, const Setting *row, SettingValue *value)
{
    Own         *o = out;
    const size_t n = strlen(o->said);
    o->lines += value->line;
    if (strcmp(value->text, "odd") == 0) *complaint = "odd";
    if (value->key && strcmp(value->key, "no") == 0) value->wrong_key = true;
    snprintf(o->said + n, sizeof o->said - n, "%s:%s%s%s;", row->name, value->key ? value->key : "",
             value->key ? "=" : "", value->text);
    return strcmp(value->text, "bad") == 0 || *complaint || value->wrong_key ? STATUS_BAD_VALUE : STATUS_OK;
}

static const Setting own_rows[] = {
    {"one", SETTING_OWN, SETTING_AT(Own, said), 0, 0, "a good word", "", "of one"},
    {"each", SETTING_EACH, SETTING_AT(Own, said), 0, 0, "a word or several", "", ""},
    {"map", SETTING_MAP, SETTING_AT(Own, said), 0, 0, "`word: word`", "", ""},
    {"a.b.deep", SETTING_INT, SETTING_AT(Own, deep), 0, 9, NULL, "", ""},
};
static const SettingTable own_table = {
    .module = "test", .row = own_rows, .count = 4, .prefix = "own.", .own = own, .all_keys = "ask"};

static Status parse_own(Own *o, const char *text)
{
    *o = (Own){.deep = 0};
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    const Status status = settings_parse(o, NULL, &own_table, "own.yaml", text, strlen(text));
    log_set_sink(NULL, NULL);
    return status;
}

static void what_a_table_reads_itself(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said;
    } bad[] = {
        {"one: bad\n", "test: own.yaml:1: own.one: 'bad' is not a good word"},
        {"one: odd\n", "own.one: 'odd' is odd"},
        {"one: {a: b}\n", "own.one: '{...}' is not a good word"},
        {"one: [a, [b]]\n", "own.one: '[...]' is not a good word"},
        {"one: [a, b c]\n", "own.one: '[...]' is not a good word"},
        {"one: \"a\\0\"\n", "is not a good word"},
        {"each:\n  - a\n  - bad\n", "own.yaml:3: own.each: 'bad' is not a word or several"},
        {"each: [[a]]\n", "own.each: '[...]' is not"},
        {"each: {a: b}\n", "own.each: '{...}' is not"},
        {"map: [a]\n", "own.map: '[...]' is not `word: word`"},
        {"map: a\n", "own.map: 'a' is not `word: word`"},
        {"map:\n  a: b\n  no: c\n", "own.yaml:3: own.map: 'no' is not"},
        {"map: {[a]: b}\n", "own.map: '[...]' is not"},
        {"map: {\"a\\0\": b}\n", "own.map: "},
        {"one: a\none: b\n", "own.one is given twice"},
        {"a: {b: {deep: 1, deep: 2}}\n", "own.a.b.deep is given twice"},
        {"a: {b: {depe: 1}}\n", "no such key: own.a.b.depe; did you mean own.a.b.deep?"},
        {"a: {c: {deep: 1}}\n", "no such key: own.a.c"},
        {"nothing: 1\n", "no such key: own.nothing; all keys: ask"},
    };
    Own o;
    assert_int_equal(parse_own(&o, "one: [1, 2.5, -3]\neach: [x y, z]\nmap: {k: v, '*': w}\na:\n  b: {deep: 4}\n"),
                     STATUS_OK);
    assert_string_equal(o.said, "one:1 2.5 -3;each:x y;each:z;map:k=v;map:*=w;");
    CHECK(o.deep == 4 && o.lines == 1 + 2 + 2 + 3 + 3);
    assert_int_equal(parse_own(&o, "each: x\n"), STATUS_OK);
    assert_string_equal(o.said, "each:x;");
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        if (parse_own(&o, bad[i].text) == STATUS_OK) fail_msg("accepted: %s", bad[i].text);
        if (!strstr(check_said, bad[i].said)) fail_msg("said '%s' where '%s' was wanted", check_said, bad[i].said);
    }
    log_set_sink(check_listen, NULL);
    assert_int_equal(settings_set(&o, NULL, &own_table, "one", "a", "--set"), STATUS_BAD_VALUE); /* in files alone */
    log_set_sink(NULL, NULL);
}

static Status read_text(Box *box, bool *given, const char *text)
{
    char path[text_file_size];
    text_file(path, text);
    check_said[0] = 0;
    log_set_sink(check_listen, NULL);
    const Status status = settings_read(box, given, &table, path);
    remove(path);
    return status;
}

static void sections_lists_and_numbers(void **state)
{
    (void)state;
    Box  box = {.deep = 3};
    bool given[7] = {false};
    assert_int_equal(read_text(&box, given,
                               "count: 4\ninside:\n  weight_kg: -1e300\n  open: true\nseed: 123456789012\n"
                               "things:\n  - name: a\n    way: [[1, 2], [3, -4.5]]\n  - {size_m: 2, way: [7]}\n"),
                     STATUS_OK);
    CHECK(box.count == 4 && box.deep == 3 && box.open && box.seed == 123456789012);
    CHECK_NEAR(box.weight_kg, -1e300, 0);
    CHECK(given[0] && !given[1] && given[2] && !given[5]);
    assert_int_equal(box.things, 2);
    assert_string_equal(box.thing[0].name, "a");
    assert_int_equal(box.thing[0].way.count, 4);
    CHECK_NEAR(box.thing[0].way.number[3], -4.5, 0);
    CHECK(box.thing[1].way.count == 1 && box.thing[1].size_m == 2);
    assert_int_equal(read_text(&box, NULL, ""), STATUS_OK);
    assert_int_equal(read_text(&box, NULL, "inside:\n"), STATUS_OK); /* a section with nothing in it */
}

static void what_is_wrong_is_said_with_its_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said;
    } bad[] = {
        {"count: 4\ncuont: 5\n", ":2: no such key: cuont; did you mean count?"},
        {"inside:\n  weihgt_gk: 1\n", ":2: no such key: inside.weihgt_gk; did you mean inside.weight_kg?"},
        {"weight_kg: 1\n", "no such key: weight_kg; did you mean inside.weight_kg?"},
        {"thigs: []\n", "no such key: thigs; did you mean things?"},
        {"sedges: 1\n", "no such key: sedges; all keys: ask"}, /* three slips from any */
        {"saad: 1\n", "no such key: saad; all keys: ask"},     /* two, in a short word */
        {"count: 4\ncount: 5\n", ":2: count is given twice"},
        {"count: 10\n", ":1: count: '10' is not a whole number in 0 .. 9"},
        {"count: 1.5\n", "'1.5' is not a whole number"},
        {"inside:\n  deep: 6\n", ":2: inside.deep: '6' is not a whole number in -5 .. 5 px"},
        {"inside: 3\n", "no such key: inside"},
        {"inside.deep: {a: 1}\n", "needs one value"},
        {"things: 3\n", "things: expected a list"},
        {"things: [3]\n", ":1: things: expected `- key: value`"},
        {"things:\n  - name: a\n  - name: b\n  - name: c\n", ":4: things: no room for more"},
        {"things:\n  - name: a\n    name: b\n", ":3: name is given twice"},
        {"things:\n  - nmae: a\n", ":2: no such key: nmae"},
        {"things:\n  - way: [1, [2, [3]]]\n", "needs a list of at most 256 numbers in -100 .. 100 m"},
        {"things:\n  - way: [1, 101]\n", "needs a list"},
        {"count: 1\n---\ncount: 2\n", "a second document"},
        {"count: \"1\\0\"\n", "is not a whole number"},
        {"[1]: 2\n", "a key must be a word"},
        {"a: &x [*x]\n", "no such key"},
        {"things: &x [*x]\n", "things: expected `- key: value`"},
        {"- a\n", "expected `key: value` lines"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        Box box = {0};
        if (read_text(&box, NULL, bad[i].text) == STATUS_OK) fail_msg("accepted: %s", bad[i].text);
        if (!strstr(check_said, bad[i].said)) fail_msg("said '%s' where '%s' was wanted", check_said, bad[i].said);
    }
    Box box = {0};
    assert_int_equal(settings_read(&box, NULL, &table, "/dev/zero"), STATUS_IO); /* endless */
    assert_int_equal(settings_read(&box, NULL, &table, "/nowhere/at/all"), STATUS_IO);
    assert_int_equal(settings_read(&box, NULL, &table, "/"), STATUS_IO);
}

static void written_settings_read_back(void **state)
{
    (void)state;
    const Box box = {.count = 7,
                     .deep = -2,
                     .weight_kg = 0.1 + 0.2,
                     .unset = NAN,
                     .open = true,
                     .seed = 999999999999,
                     .label = "it's: #1 'here'"};
    char      path[text_file_size];
    text_file(path, "");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    settings_write(file, &table, &box, NULL);
    assert_int_equal(fclose(file), 0);

    Box back = {.unset = NAN};
    assert_int_equal(settings_read(&back, NULL, &table, path), STATUS_OK);
    remove(path);
    char want[512], got[512];
    settings_text(want, sizeof want, &table, &box);
    settings_text(got, sizeof got, &table, &back);
    assert_string_equal(got, want);
    CHECK(strstr(want, "inside.weight_kg=0.30000000000000004\n"));
}

typedef struct Places {
    char one[64], several[64], either[64];
} Places;

static const Setting place_rows[] = {
    {"one", SETTING_PATH, SETTING_AT(Places, one), 0, 0, NULL, "", ""},
    {"several", SETTING_PATHS, SETTING_AT(Places, several), 0, 0, NULL, "", ""},
    {"in.either", SETTING_NAME_OR_PATH, SETTING_AT(Places, either), 0, 0, NULL, "", ""},
};
static const SettingTable place_table = {.module = "test", .row = place_rows, .count = 3};

/* The file is in /tmp. */
static void paths_are_relative_to_their_file(void **state)
{
    (void)state;
    char   path[text_file_size];
    Places p = {{0}, {0}, {0}};
    text_file(path, "one: a/b.csv\n\nseveral: x.tif, /y.tif ,../z, \nin:\n  either: plain\n");
    assert_int_equal(settings_read(&p, NULL, &place_table, path), STATUS_OK);
    assert_string_equal(p.one, "/tmp/a/b.csv");
    assert_string_equal(p.several, "/tmp/x.tif,/y.tif ,/tmp/../z,");
    assert_string_equal(p.either, "plain");
    assert_int_equal(settings_line(&place_table, "one", path), 1);
    assert_int_equal(settings_line(&place_table, "several", path), 3);
    assert_int_equal(settings_line(&place_table, "in.either", path), 5);
    assert_int_equal(settings_line(&place_table, "either", path), 0);
    assert_int_equal(settings_read_as(&p, NULL, &place_table, path, "other/case.yaml"), STATUS_OK);
    assert_string_equal(p.one, "other/a/b.csv");
    remove(path);

    assert_int_equal(settings_set(&p, NULL, &place_table, "one", "c.csv", "--set"), STATUS_OK);
    assert_string_equal(p.one, "c.csv");
    assert_int_equal(settings_set_from(&p, NULL, &place_table, "in.either", "./c", "x:1", "/far/away.yaml"), STATUS_OK);
    assert_string_equal(p.either, "/far/./c");
    assert_int_equal(settings_set_from(&p, NULL, &place_table, "one", "", "x:1", "/far/away.yaml"), STATUS_OK);
    assert_string_equal(p.one, "");
    assert_int_equal(settings_set_from(&p, NULL, &place_table, "one", "c", "x:1", "/dev/stdin"), STATUS_OK);
    assert_string_equal(p.one, "c"); /* a pipe is in no folder */
    log_set_sink(check_listen, NULL);
    assert_int_equal(settings_set_from(&p, NULL, &place_table, "one", "1234567890123456789012345678901234567890", "x:1",
                                       "/a/folder/with/a/long/name/x.yaml"),
                     STATUS_BAD_VALUE);
    log_set_sink(NULL, NULL);
    CHECK(strstr(check_said, "longer than 63"));
    assert_int_equal(settings_set(&p, NULL, &place_table, "several", "none/a,none/b", "--set"), STATUS_OK);
    assert_int_equal(settings_set(&p, NULL, &place_table, "one", "/proc/self/../../dev/null", "--set"), STATUS_OK);
    settings_absolute(&p, &place_table);
    assert_string_equal(p.one, "/dev/null");
    CHECK(strlen(p.several) > 60 || (p.several[0] == '/' && strstr(p.several, "/none/a,/")));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sections_lists_and_numbers),       cmocka_unit_test(what_is_wrong_is_said_with_its_line),
        cmocka_unit_test(what_a_table_reads_itself),        cmocka_unit_test(written_settings_read_back),
        cmocka_unit_test(paths_are_relative_to_their_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
