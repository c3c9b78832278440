/* Every key of the configuration at the ends of floating point: refused with its name, or taken as a finite number. */
#include "tests/check.h"

#include "sensor/settings/config.h"

static void every_number_is_finite_or_refused(void **state)
{
    (void)state;
    static const char *const none[] = {
        "inf", "-inf", "nan", ".inf", ".nan", "1e999", "-1e999", "1e400", "99999999999999999999999e999"};
    static const char *const ends[] = {"1.7976931348623157e308",
                                       "-1.7976931348623157e308",
                                       "3.4028235e38",
                                       "-3.4028235e38",
                                       "5e-324",
                                       "-5e-324",
                                       "1e-310",
                                       "1e-400",
                                       "-0",
                                       "1e-20"};
    char                    *keys = NULL, section[64] = "", *rest = NULL;
    size_t                   octets = 0;
    int                      numbers = 0, taken = 0;
    FILE                    *to = open_memstream(&keys, &octets);
    const Config             defaults = config_default();
    CHECK(to != NULL);
    config_write(to, &defaults);
    CHECK(fclose(to) == 0);
    log_set_sink(check_listen, NULL);
    for (char *line = strtok_r(keys, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        const char  *name = line + strspn(line, " #");
        const size_t length = strspn(name, "abcdefghijklmnopqrstuvwxyz_0123456789");
        char         key[160];
        if (length == 0 || name[length] != ':') continue; /* its help */
        if (name == line && !name[length + 1]) {
            snprintf(section, sizeof section, "%.*s.", (int)length, name);
            continue;
        }
        snprintf(key, sizeof key, "%s%.*s", name == line ? "" : section, (int)length, name);
        Config config = defaults;
        if (config_set(&config, key, "no number", "test") == STATUS_OK || strstr(check_said, "no such key") ||
            !strstr(check_said, "number"))
            continue; /* text, a choice, or words of the help */
        numbers++;
        for (size_t t = 0; t < sizeof none / sizeof *none; t++) {
            check_said[0] = 0;
            if (config_set(&config, key, none[t], "test") == STATUS_OK) fail_msg("%s: %s is taken", key, none[t]);
            if (!strstr(check_said, key)) fail_msg("%s: %s: said: %s", key, none[t], check_said);
            CHECK(memcmp(&config, &defaults, sizeof config) == 0);
        }
        for (size_t t = 0; t < sizeof ends / sizeof *ends; t++) {
            config = defaults;
            check_said[0] = 0;
            if (config_set(&config, key, ends[t], "test") != STATUS_OK) {
                if (!strstr(check_said, key)) fail_msg("%s: %s: said: %s", key, ends[t], check_said);
                continue;
            }
            taken++;
            char text[32768];
            config_text(text, sizeof text, &config);
            if (strstr(text, "=inf") || strstr(text, ": inf") || strstr(text, " inf\n"))
                fail_msg("%s: %s", key, ends[t]);
            config_check(&config); /* says what it must, and ends */
        }
    }
    free(keys);
    print_message("%d keys are numbers; %d of their extremes are taken\n", numbers, taken);
    CHECK(numbers > 60 && taken > 20);
    log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_number_is_finite_or_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
