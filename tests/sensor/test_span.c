/* tests/sensor/test_span.c: moments of a recording, and lists of planes, as people write them. labels: physics */
#include "tests/check.h"

#include "sensor/settings/publish_choice.h"
#include "sensor/settings/config.h"

static void moments_are_of_three_kinds(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double      t_s; /* in a recording from 1350 to 1380 s */
    } moment[] = {{"1360.5", 1360.5}, {"+12", 1362},      {"+0", 1350}, {"-5", 1375},
                  {"-0", 1380},       {"-0.25", 1379.75}, {"0", 0}};
    for (size_t i = 0; i < sizeof moment / sizeof *moment; i++) {
        CHECK(config_span_good(moment[i].text));
        CHECK_NEAR(config_span_time_s(moment[i].text, 1350, 1380), moment[i].t_s, 0);
    }
    CHECK(config_span_good("") && isnan(config_span_time_s("", 1350, 1380)));
    static const char *const bad[] = {"noon", "+", "-", "++1", "1 s", "nan", "inf", "0x10"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK(!config_span_good(bad[i]) && isnan(config_span_time_s(bad[i], 1350, 1380)));
    CHECK(config_span_backward("5", "4") && config_span_backward("+5", "+4") && config_span_backward("-4", "-5"));
    CHECK(!config_span_backward("4", "5") && !config_span_backward("5", "+4") && !config_span_backward("-4", "5") &&
          !config_span_backward("", "5"));
}

/* What lies outside names the span in absolute seconds and from both ends. */
static void what_lies_outside_states_the_span(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to, *why;
    } outside[] = {{"+31", "", "--from +31 is after its end"},    {"99999", "", "--from 99999 is after its end"},
                   {"", "5", "--to 5 is before its start"},       {"", "-40", "--to -40 is before its start"},
                   {"-1", "+1", "--from -1 is after --to +1"},    {"12", "20", "--to 20 is before its start"},
                   {"+99", "+100", "--from +99 is after its end"}},
      inside[] = {{"", "", ""},       {"+30", "", ""},    {"", "+0", ""},    {"+12", "-5", ""},
                  {"0", "99999", ""}, {"-99", "+99", ""}, {"+31", "+32", ""}};
    log_set_sink(check_listen, NULL);
    for (size_t i = 0; i < sizeof outside / sizeof *outside; i++) {
        check_said[0] = 0;
        CHECK(config_span_outside(outside[i].from, outside[i].to, 1350, 1380));
        CHECK(strstr(check_said, outside[i].why) && strstr(check_said, "1350.000 to 1380.000 s") &&
              strstr(check_said, "+0 to +30.000") && strstr(check_said, "-30.000 to -0"));
    }
    check_said[0] = 0;
    for (size_t i = 0; i < sizeof inside / sizeof *inside; i++)
        CHECK(!config_span_outside(inside[i].from, inside[i].to, 1350, 1380));
    CHECK(!*check_said);
    log_set_sink(NULL, NULL);
}

static void planes_are_listed_by_name(void **state)
{
    (void)state;
    static const struct {
        const char *list;
        const char *name[20]; /* of the planes in files/truth */
    } chosen[] = {{"none", {0}},
                  {"range,entity,part,material,temperature,normal",
                   {"range_m", "entity", "part", "material", "temp_k", "nx", "ny", "nz"}},
                  {"instance,cover", {"instance", "cover"}},
                  {"emissivity", {"emissivity_mwir", "emissivity_lwir"}},
                  {"all",
                   {"range_m", "entity", "part", "material", "temp_k", "nx", "ny", "nz", "instance", "cover",
                    "emissivity_mwir", "emissivity_lwir"}}};
    PlaneSet planes;
    for (size_t i = 0; i < sizeof chosen / sizeof *chosen; i++) {
        PlaneSet want = 0;
        for (int k = 0; chosen[i].name[k]; k++) want |= (PlaneSet)1 << plane_find("truth", chosen[i].name[k]);
        CHECK(publish_planes_parse(&planes, chosen[i].list) && planes == want);
    }
    CHECK(plane_find("truth", "Y") == -1 && plane_find("lwir", "Y") >= 0 && publish_planes_name(9) == NULL);
    static const char *const bad[] = {
        "", ",", "range,", ",range", "rang", "ranges", "range entity", "all,range", "none,range", "part,entity,part"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) CHECK(!publish_planes_parse(&planes, bad[i]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moments_are_of_three_kinds),
        cmocka_unit_test(what_lies_outside_states_the_span),
        cmocka_unit_test(planes_are_listed_by_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
