/* tests/entities/test_heat.c: first-order levels against the exponential on paper, and what counts as evidence. */
#include "tests/entities/entity_fixture.h"
#include "entities/effects/heat.h"

#include <unistd.h>

static const double forever_s = 3600;

static HeatTable shipped(void)
{
    HeatTable table;
    char path[512];
    CHECK(etc_path(path, sizeof path, "heat.csv"));
    CHECK(heat_table_open(&table, path) == STATUS_OK);
    return table;
}

static double rise(const HeatState *state, const HeatTable *table, HeatRole role, double t_s)
{
    float k[HEAT_ROLE_COUNT];
    heat_at(k, state, table, UINT32_MAX, t_s);
    return k[role];
}

/* A tank first seen driving at full speed is as warm as an hour of it makes it; from rest, 1 - exp(-t / tau). */
static void warms_and_cools_by_its_time_constants(void **state)
{
    (void)state;
    const HeatTable table = shipped();
    const HeatEvidence drives = {.type = tank_type, .speed_mps = 12}, stands = {.type = tank_type};
    const double tau_s = table.warm_up_s[HEAT_ENGINE_DECK], cool_s = table.cool_down_s[HEAT_ENGINE_DECK];
    const double full_k = table.rise_k[HEAT_ENGINE_DECK];
    HeatState s;

    heat_begin(&s, &table, &drives, 1000, forever_s);
    CHECK_NEAR(rise(&s, &table, HEAT_ENGINE_DECK, 1000), full_k * (1 - exp(-forever_s / tau_s)), 1e-5);

    heat_begin(&s, &table, &stands, 0, forever_s);
    CHECK_NEAR(rise(&s, &table, HEAT_ENGINE_DECK, 500), 0, 0);
    heat_report(&s, &table, &drives, 500);
    CHECK_NEAR(rise(&s, &table, HEAT_ENGINE_DECK, 500 + tau_s), full_k * (1 - exp(-1)), 1e-5);

    /* destroyed: the engine stops at once and the deck cools */
    const HeatEvidence wreck = {.type = tank_type, .speed_mps = 12, .appearance = 3 << 3};
    heat_report(&s, &table, &wreck, 500 + tau_s);
    const double wreck_k = table.rise_k[HEAT_WRECK] * exp(-2 * cool_s / table.cool_down_s[HEAT_WRECK]); /* all of it */
    CHECK_NEAR(rise(&s, &table, HEAT_ENGINE_DECK, 500 + tau_s + 2 * cool_s),
               full_k * (1 - exp(-1)) * exp(-2) + wreck_k, 1e-5);
    CHECK(heat_runs_until(&s) == -INFINITY);
}

/* Reports that say the same thing, or frames asked for in between, change nothing. */
static void does_not_depend_on_when_it_is_asked(void **state)
{
    (void)state;
    const HeatTable table = shipped();
    const HeatEvidence drives = {.type = tank_type, .speed_mps = 7}, stands = {.type = tank_type};
    HeatState often, once;

    heat_begin(&often, &table, &stands, 0, forever_s);
    heat_begin(&once, &table, &stands, 0, forever_s);
    heat_report(&often, &table, &drives, 10);
    heat_report(&once, &table, &drives, 10);
    for (double t_s = 10.37; t_s < 400; t_s += 1.7) heat_report(&often, &table, &drives, t_s);
    heat_report(&often, &table, &stands, 400);
    heat_report(&once, &table, &stands, 400);
    for (double t_s = 400.1; t_s < 800; t_s += 0.9) heat_report(&often, &table, &stands, t_s);
    for (int role = 0; role < HEAT_ROLE_COUNT; role++)
        CHECK_NEAR(rise(&often, &table, (HeatRole)role, 900), rise(&once, &table, (HeatRole)role, 900), 1e-4);
}

/* No power-plant bit: moving is evidence, for two minutes after it stopped; the bit alone is evidence too. */
static void engine_is_inferred(void **state)
{
    (void)state;
    const HeatTable table = shipped();
    const HeatEvidence drives = {.type = truck_type, .speed_mps = 3}, stands = {.type = truck_type};
    const HeatEvidence idles = {.type = truck_type, .appearance = power_plant_bit},
                       crawls = {.type = truck_type, .speed_mps = 0.1};
    HeatState s;

    heat_begin(&s, &table, &stands, 0, forever_s);
    CHECK(heat_runs_until(&s) == -INFINITY);
    heat_report(&s, &table, &crawls, 1);
    CHECK(heat_runs_until(&s) == -INFINITY);
    heat_report(&s, &table, &drives, 2);
    CHECK(heat_runs_until(&s) == INFINITY);
    heat_report(&s, &table, &stands, 100);
    heat_report(&s, &table, &stands, 105);
    CHECK(heat_runs_until(&s) == 220);
    CHECK(rise(&s, &table, HEAT_EXHAUST, 219) > rise(&s, &table, HEAT_EXHAUST, 150));
    CHECK(rise(&s, &table, HEAT_EXHAUST, 300) < rise(&s, &table, HEAT_EXHAUST, 220));
    /* at the end of the two minutes nothing jumps */
    CHECK_NEAR(rise(&s, &table, HEAT_EXHAUST, 220 + 1e-6), rise(&s, &table, HEAT_EXHAUST, 220 - 1e-6), 1e-3);
    heat_report(&s, &table, &idles, 300);
    CHECK(heat_runs_until(&s) == INFINITY);
}

/* Helicopters of a sender that never sets the bit fly all the same, and their turbines are hot from the first. */
static void flight_is_evidence(void **state)
{
    (void)state;
    const HeatTable table = shipped();
    const HeatEvidence hovers = {.type = helicopter_type}, wreck = {.type = helicopter_type, .appearance = 3 << 3};
    HeatState s;
    heat_begin(&s, &table, &hovers, 0, forever_s);
    CHECK_NEAR(rise(&s, &table, HEAT_TURBINE, 0), table.rise_k[HEAT_TURBINE], 0.01);
    CHECK(heat_runs_until(&s) == INFINITY);
    CHECK(rise(&s, &table, HEAT_TRACK, 100) == 0 && rise(&s, &table, HEAT_MOTOR, 100) == 0);
    heat_begin(&s, &table, &wreck, 0, forever_s);
    CHECK(rise(&s, &table, HEAT_TURBINE, 0) == 0);
}

/* Each shot is one second of full drive; ten together are ten seconds. */
static void shots_add_up(void **state)
{
    (void)state;
    const HeatTable table = shipped();
    const HeatEvidence stands = {.type = tank_type};
    const double tau_s = table.warm_up_s[HEAT_GUN], full_k = table.rise_k[HEAT_GUN];
    HeatState s;

    heat_begin(&s, &table, &stands, 0, forever_s);
    heat_fire(&s, &table, 50);
    CHECK_NEAR(rise(&s, &table, HEAT_GUN, 51), full_k * (1 - exp(-1 / tau_s)), 1e-5);
    CHECK(rise(&s, &table, HEAT_GUN, 200) < rise(&s, &table, HEAT_GUN, 51) && rise(&s, &table, HEAT_GUN, 200) > 0);
    heat_begin(&s, &table, &stands, 0, forever_s);
    for (int shot = 0; shot < 10; shot++) heat_fire(&s, &table, 50);
    CHECK_NEAR(rise(&s, &table, HEAT_GUN, 60), full_k * (1 - exp(-10 / tau_s)), 1e-5);
    for (int shot = 0; shot < 100000; shot++) heat_fire(&s, &table, 61); /* bounded */
    CHECK(rise(&s, &table, HEAT_GUN, 1e6) < 1e-3);
}

/* A missile burns for two seconds from its first report, then cools; its nose has r v^2 / (2 cp). */
static void a_missile_burns_and_its_nose_warms(void **state)
{
    (void)state;
    const HeatTable table = shipped();
    const HeatEvidence flies = {.type = missile_type, .speed_mps = 300};
    HeatState s;
    heat_begin(&s, &table, &flies, 10, forever_s);
    CHECK(rise(&s, &table, HEAT_MOTOR, 10) == 0 && rise(&s, &table, HEAT_NOSE, 10) == 0);
    const double burnt_out_k = table.rise_k[HEAT_MOTOR] * (1 - exp(-2 / table.warm_up_s[HEAT_MOTOR]));
    CHECK_NEAR(rise(&s, &table, HEAT_MOTOR, 12), burnt_out_k, 1e-4);
    CHECK_NEAR(rise(&s, &table, HEAT_MOTOR, 15), burnt_out_k * exp(-3 / table.cool_down_s[HEAT_MOTOR]), 1e-4);
    CHECK_NEAR(rise(&s, &table, HEAT_NOSE, 1000), 0.85 * 300 * 300 / (2 * 1005), 1e-4); /* 38.06 K */
    const HeatEvidence re_enters = {.type = missile_type, .speed_mps = 7000};
    heat_report(&s, &table, &re_enters, 1000);
    CHECK_NEAR(rise(&s, &table, HEAT_NOSE, 2000), table.rise_k[HEAT_NOSE], 1e-4); /* where it stops */
}

static void only_roles_asked_for(void **state)
{
    (void)state;
    const HeatTable table = shipped();
    const HeatEvidence drives = {.type = tank_type, .speed_mps = 12};
    HeatState s;
    float k[HEAT_ROLE_COUNT];
    heat_begin(&s, &table, &drives, 0, forever_s);
    heat_at(k, &s, &table, UINT32_C(1) << HEAT_TRACK, 0);
    for (int role = 0; role < HEAT_ROLE_COUNT; role++) CHECK((k[role] > 0) == (role == HEAT_TRACK));
}

static int errors;
static void count_errors(void *user, LogLevel level, const char *line)
{
    (void)user, (void)line;
    errors += level == LOG_ERROR;
}

static void bad_tables_are_refused(void **state)
{
    (void)state;
    static const char *const text[] = {
        "role,driver,rise_k,warm_up_s,cool_down_s\nhull,engine,5,10,10\n",                       /* roles missing */
        "role,driver,rise_k,warm_up_s\nhull,engine,5,10\n",                                      /* a column missing */
        "role,driver,rise_k,warm_up_s,cool_down_s\nhull,engine,5,0,10\n",                        /* no time at all */
        "role,driver,rise_k,warm_up_s,cool_down_s\nhull,steam,5,10,10\n",                        /* no such driver */
        "role,driver,rise_k,warm_up_s,cool_down_s\nkeel,engine,5,10,10\n",                       /* no such role */
        "role,driver,rise_k,warm_up_s,cool_down_s\nhull,engine,5,10,10\nhull,engine,5,10,10\n", /* twice */
    };
    log_set_sink(count_errors, NULL);
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        char path[text_file_size];
        HeatTable table = {.rise_k = {-1}};
        text_file(path, text[i]);
        errors = 0;
        CHECK(heat_table_open(&table, path) == STATUS_BAD_VALUE);
        CHECK(errors > 0 && table.rise_k[0] == -1);
        remove(path);
    }
    log_set_sink(NULL, NULL);
}

/* A person is warm from the first report and cools when fatally injured; a house is lived in; neither has an engine. */
static void what_lives_is_warm(void **state)
{
    (void)state;
    const HeatTable table = shipped();
    const HeatEvidence lives = {.type = {3, 1, 225, 1, 0, 0, 0}}, house = {.type = {5, 1, 225, 11, 0, 0, 0}};
    const HeatEvidence dies = {.type = {3, 1, 225, 1, 0, 0, 0}, .appearance = 3 << 3};
    const double tau_s = table.warm_up_s[HEAT_SKIN], cool_s = table.cool_down_s[HEAT_SKIN];
    HeatState s;

    heat_begin(&s, &table, &lives, 0, 1e6);
    /* 305 K in air of 288 K */
    CHECK_NEAR(288 + rise(&s, &table, HEAT_SKIN, 0), 305, 1e-4);
    const double cloth_k = rise(&s, &table, HEAT_CLOTHING, 0);
    CHECK(cloth_k > 3 && cloth_k < rise(&s, &table, HEAT_SKIN, 0));
    CHECK(rise(&s, &table, HEAT_DWELLING, 0) > 0 && rise(&s, &table, HEAT_ENGINE_DECK, 0) == 0);
    heat_report(&s, &table, &dies, 100);
    CHECK_NEAR(rise(&s, &table, HEAT_SKIN, 100 + cool_s), 17 * exp(-1), 1e-4);

    heat_begin(&s, &table, &lives, 0, tau_s);
    CHECK_NEAR(rise(&s, &table, HEAT_SKIN, 0), 17 * (1 - exp(-1)), 1e-4);

    heat_begin(&s, &table, &house, 0, 1e6);
    CHECK_NEAR(rise(&s, &table, HEAT_DWELLING, 50), table.rise_k[HEAT_DWELLING], 1e-3);
    CHECK(rise(&s, &table, HEAT_FLARE, 0) == 0);
}

/* A flare burns at 1500 .. 2000 K for four seconds from its first report, whatever is reported meanwhile. */
static void a_flare_burns_four_seconds(void **state)
{
    (void)state;
    const HeatTable table = shipped();
    const HeatEvidence falls = {.type = {8, 2, 225, 2, 0, 0, 0}, .speed_mps = 60};
    HeatState s;

    heat_begin(&s, &table, &falls, 200, 1e6);
    CHECK(rise(&s, &table, HEAT_FLARE, 200) == 0);
    for (double t_s = 201; t_s <= 204; t_s += 0.5) {
        heat_report(&s, &table, &falls, t_s);
        const double temp_k = 288 + rise(&s, &table, HEAT_FLARE, t_s);
        CHECK(temp_k > 1500 && temp_k < 2000);
    }
    const double burnt_k = table.rise_k[HEAT_FLARE] * (1 - exp(-4 / table.warm_up_s[HEAT_FLARE]));
    CHECK_NEAR(rise(&s, &table, HEAT_FLARE, 204), burnt_k, 1e-3);
    CHECK_NEAR(rise(&s, &table, HEAT_FLARE, 207), burnt_k * exp(-3 / table.cool_down_s[HEAT_FLARE]), 1e-2);
    CHECK(rise(&s, &table, HEAT_FLARE, 240) < 1e-6);
}

/* The skin of an aircraft takes the recovery temperature, as a missile's nose does. */
static void an_airframe_warms_by_its_speed(void **state)
{
    (void)state;
    const HeatTable table = shipped();
    const HeatEvidence flies = {.type = {1, 2, 225, 1, 0, 0, 0}, .speed_mps = 250};
    HeatState s;
    heat_begin(&s, &table, &flies, 0, 1e6);
    CHECK_NEAR(rise(&s, &table, HEAT_AIRFRAME, 0), 0.85 * 250 * 250 / (2 * 1005), 1e-3); /* 26.4 K */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(warms_and_cools_by_its_time_constants), cmocka_unit_test(does_not_depend_on_when_it_is_asked),
        cmocka_unit_test(engine_is_inferred),                    cmocka_unit_test(flight_is_evidence),
        cmocka_unit_test(shots_add_up),                          cmocka_unit_test(a_missile_burns_and_its_nose_warms),
        cmocka_unit_test(only_roles_asked_for),                  cmocka_unit_test(bad_tables_are_refused),
        cmocka_unit_test(what_lives_is_warm),                    cmocka_unit_test(a_flare_burns_four_seconds),
        cmocka_unit_test(an_airframe_warms_by_its_speed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
