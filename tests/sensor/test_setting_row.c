/* A setting is one entry of a list: member, default, range, words, unit, help, parsing and printing come of it alone.
 * The entry that etc/ADDING.md shows is read from there, and is the one here. */
#include "tests/check.h"

#include "sensor/settings/config.h"

#include <stdlib.h>

/* clang-format off */
#define TOY_LAMP(ROW) \
    ROW(CHOICE, lamp., colour, LAMP_RED, LampColour, (LAMP_BLUE, "blue")(LAMP_RED, "red")(LAMP_DEEP, "deep-red"), "what it shines") \
    ROW(SWITCH, lamp., lit, true, "off|on", "whether it shines") \
    ROW(DOUBLE, lamp., power_w, 7.5, 0.5, 100, "W", "what it takes") \
    ROW(DOUBLE, lamp., limit_w, NAN, 0, 1, "W", "unset: none") \
    ROW(INT, lamp., count, 3, 1, 9, "", "how many") \
    ROW(BOOL, lamp., hot, false, "whether it is hot") \
    ROW(TEXT, lamp., at_s, "+12", 8, "s", "since when") \
    ROW(WORDS, lamp., rooms, "a,b", 16, "where") \
    ROW(PATH, lamp., table, "", 64, "its table") \
    ROW(NUMBERS, lamp., way, {0}, -5, 5, "m", "of its cable")
#define TOY_TOP(ROW) ROW(LONG, , seed, 1, 0, 1e15, "", "of all numbers")

typedef struct Toy {
    struct { TOY_LAMP(SETTING_MEMBER) } lamp;
    TOY_TOP(SETTING_MEMBER)
} Toy;
/* clang-format on */

#define TOY_ROW(...) SETTING_ROW(Toy, __VA_ARGS__)
static const Setting      keys[] = {TOY_LAMP(TOY_ROW) TOY_TOP(TOY_ROW)};
static const SettingTable table = {.module = "toy", .row = keys, .count = sizeof keys / sizeof *keys};
static const Toy          plain = {TOY_LAMP(SETTING_DEFAULT) TOY_TOP(SETTING_DEFAULT)};

static void defaults_and_words_are_those_of_the_entry(void **state)
{
    (void)state;
    char text[512];
    CHECK(table.count == 11 && settings_find(&table, "lamp.colour") == 0 && settings_find(&table, "seed") == 10);
    CHECK(plain.lamp.colour == LAMP_RED && plain.lamp.lit && plain.lamp.count == 3 && isnan(plain.lamp.limit_w));
    CHECK(LAMP_BLUE == 0 && LAMP_RED == 1 && LAMP_DEEP == 2 && sizeof plain.lamp.at_s == 8);
    settings_text(text, sizeof text, &table, &plain);
    assert_string_equal(text, "lamp.colour=red\nlamp.lit=on\nlamp.power_w=7.5\nlamp.limit_w=nan\nlamp.count=3\n"
                              "lamp.hot=false\nlamp.at_s=+12\nlamp.rooms=a,b\nlamp.table=\nlamp.way=[]\nseed=1\n");
}

static void written_and_helped(void **state)
{
    (void)state;
    char  *text = NULL;
    size_t octets;
    FILE  *to = open_memstream(&text, &octets);
    settings_write(to, &table, &plain, NULL);
    settings_write_keys(to, &table);
    fclose(to);
    static const char *const said[] = {"\nlamp:\n  # what it shines; blue|red|deep-red\n  colour: red\n",
                                       "  # whether it shines; off|on\n  lit: on\n",
                                       "  # what it takes; 0.5 .. 100 W\n  power_w: 7.5\n",
                                       "  # unset: none; 0 .. 1 W\n  # limit_w:\n",
                                       "  # whether it is hot; true or false\n  hot: false\n",
                                       "  # since when; s\n  at_s: +12\n",
                                       "  lamp.colour: one of blue|red|deep-red\n      what it shines\n",
                                       "  seed: a whole number in 0 .. 1e+15\n      of all numbers\n"};
    for (size_t i = 0; i < sizeof said / sizeof *said; i++)
        if (!strstr(text, said[i])) fail_msg("'%s' is not in\n%s", said[i], text);
    free(text);
}

static void parsed_or_refused(void **state)
{
    (void)state;
    static const struct {
        const char *key, *value, *said; /* said: NULL: it is good */
    } of[] = {{"lamp.colour", "deep-red", NULL},
              {"lamp.colour", "blue", NULL},
              {"lamp.colour", "deep", "toy: test: lamp.colour: 'deep' is not one of blue|red|deep-red"},
              {"lamp.colour", "rde", "; did you mean red?"},
              {"lamp.colour", "blue|red", "is not one of blue|red|deep-red"},
              {"lamp.colour", "", "lamp.colour: '' is not one of"},
              {"lamp.lit", "off", NULL},
              {"lamp.lit", "on", NULL},
              {"lamp.lit", "true", "lamp.lit: 'true' is not one of off|on"},
              {"lamp.power_w", "100", NULL},
              {"lamp.power_w", "101", "lamp.power_w: '101' is not a number in 0.5 .. 100 W"},
              {"lamp.count", "0", "is not a whole number in 1 .. 9"},
              {"lamp.at_s", "12345678", "longer than 7 characters"},
              {"lamp.clour", "red", "no such key: lamp.clour; did you mean lamp.colour?"}};
    Toy toy = plain, before;
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        memcpy(&before, &toy, sizeof toy);
        check_said[0] = 0;
        log_set_sink(check_listen, NULL);
        const Status status = settings_set(&toy, NULL, &table, of[i].key, of[i].value, "test");
        log_set_sink(NULL, NULL);
        if ((status == STATUS_OK) != !of[i].said) fail_msg("%s = %s: %s", of[i].key, of[i].value, check_said);
        if (of[i].said && !strstr(check_said, of[i].said)) fail_msg("said '%s', not '%s'", check_said, of[i].said);
        if (of[i].said) assert_memory_equal(&toy, &before, sizeof toy);
    }
    CHECK(toy.lamp.colour == LAMP_BLUE && toy.lamp.lit && toy.lamp.power_w == 100);
}

/* Each word of each choice of the program, set and printed: the text that is hashed has the word. */
static void words_of_the_program_come_back(void **state)
{
    (void)state;
    static char  text[config_text_size], want[256];
    char        *list = NULL;
    size_t       octets;
    int          words = 0;
    FILE        *to = open_memstream(&list, &octets);
    const Config config = config_default();
    config_write(to, &config);
    fclose(to);
    char section[64] = "", choices[256] = "", key[64];
    for (char *line = strtok(list, "\n"); line; line = strtok(NULL, "\n")) {
        if (line[0] != ' ' && line[0] != '#') sscanf(line, "%63[^:]", section);
        const char *last = strrchr(line, ' ');
        if (last && strchr(last, '|')) {
            snprintf(choices, sizeof choices, "%s", last + 1);
            continue;
        }
        if (*choices && sscanf(line, "  # %63[^:]", key) == 1) {
            for (char *rest = choices, *word; (word = strsep(&rest, "|")); words++) {
                char  *given = NULL;
                Config set = config;
                snprintf(want, sizeof want, "%s.%s", section, key);
                assert_int_equal(config_set(&set, want, word, "test"), STATUS_OK);
                FILE *out = open_memstream(&given, &octets);
                config_write_given(out, &set);
                fclose(out);
                snprintf(want, sizeof want, "  %s.%s = %s\n", section, key, word);
                assert_string_equal(given, want);
                free(given);
            }
        }
        *choices = 0;
    }
    assert_int_equal(words, 74);
    config_text(text, sizeof text, &config);
    CHECK(strstr(text, "sensor.antialias=adaptive\n") && strstr(text, "terrain.woods=on\n"));
    free(list);
}

#define QUOTED(...)  QUOTED_(__VA_ARGS__)
#define QUOTED_(...) #__VA_ARGS__

/* ADDING's entry, as it stands there, is one of the list above, as the compiler read it. */
static void adding_shows_this_entry(void **state)
{
    (void)state;
    static char page[1 << 17];
    FILE       *file = fopen("etc/ADDING.md", "r");
    assert_non_null(file);
    page[fread(page, 1, sizeof page - 1, file)] = 0;
    fclose(file);
    const char *entry = strstr(page, "```c setting\n");
    assert_non_null(entry);
    entry = strchr(entry, '\n') + 1;
    static char shown[1024], here[1024];
    const char *text = QUOTED(TOY_LAMP(ROW));
    for (size_t n = 0; *entry != '`'; entry++)
        if (!strchr(" \n\\", *entry)) shown[n++] = *entry;
    size_t n = 0;
    for (const char *end = strstr(text, " ROW(SWITCH"); text < end; text++)
        if (*text != ' ') here[n++] = *text;
    assert_string_equal(shown, here);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_and_words_are_those_of_the_entry),
        cmocka_unit_test(written_and_helped),
        cmocka_unit_test(parsed_or_refused),
        cmocka_unit_test(words_of_the_program_come_back),
        cmocka_unit_test(adding_shows_this_entry),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
