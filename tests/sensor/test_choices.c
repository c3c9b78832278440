/* What replay picks by itself, and that it says so. */
#include "tests/check.h"

#include "dis/pdu/decode.h"
#include "sensor/node/choices/choices.h"

static bool says(const Choices *choices, const char *text)
{
    for (int i = 0; i < choices->count; i++)
        if (strstr(choices->line[i], text)) return true;
    return false;
}

static void the_exercise_heard_most_is_taken(void **state)
{
    (void)state;
    static uint8_t       bytes[5][160];
    static DisDatagram   datagram[5];
    static const uint8_t exercise[5] = {7, 3, 7, 3, 7};
    Config               config = config_default();
    Choices              choices = {0};
    for (int k = 0; k < 5; k++) {
        DisEntityState pdu = {.header = {.version = 6, .exercise = exercise[k], .type = dis_pdu_entity_state},
                              .id = {1, 1, 1},
                              .p_ecef = {6378137, 0, 0}};
        datagram[k] = (DisDatagram){.octets = (uint32_t)dis_encode_entity_state(bytes[k], sizeof bytes[k], &pdu),
                                    .bytes = bytes[k]};
    }
    DisLog log = {.count = 5, .datagram = datagram};
    assert_int_equal(choice_exercise(&choices, &log, &config), 7);
    CHECK(says(&choices, "exercise: 7, heard most of 2 (exercise.exercise)"));
    choices.count = 0;
    config.exercise.exercise = 3;
    assert_int_equal(choice_exercise(&choices, &log, &config), 3);
    config.exercise.exercise = -2;
    assert_int_equal(choice_exercise(&choices, &log, &config), -1);
    config.exercise.exercise = -1;
    log.count = 1;
    assert_int_equal(choice_exercise(&choices, &log, &config), -1); /* there is but one: nothing to choose */
    config.exercise.causal = true;
    assert_int_equal(choice_exercise(&choices, &log, &config), 7); /* and others may come */
    CHECK(choices.count == 0);
}

/* At the equator on the day of the equinox the sun goes down by a quarter degree a minute from 18:07 UTC on. */
static void optical_pictures_of_the_night_are_said_to_be_black(void **state)
{
    (void)state;
    static const struct {
        const char *utc;
        bool        black;
    } at[] = {{"2026-03-20T12:00:00Z", false}, {"2026-03-20T18:20:00Z", false}, {"2026-03-20T18:27:00Z", false},
              {"2026-03-20T18:40:00Z", true},  {"2026-03-21T00:00:00Z", true},  {"2026-03-21T06:10:00Z", false}};
    const LocalFrame frame = {0};
    for (size_t k = 0; k < sizeof at / sizeof at[0]; k++)
        for (unsigned bands = 1; bands < 1u << BAND_COUNT; bands++) {
            double   unix_s;
            HostPlan plan = {.start_s = 100, .end_s = k % 2 ? INFINITY : 130};
            Choices  choices = {0};
            CHECK(text_to_unix_s(&unix_s, at[k].utc));
            choice_report_night(&choices, bands, unix_s - 100, &plan, &frame);
            CHECK(choices.count == (at[k].black && bands >> BAND_OPTICAL & 1));
            if (choices.count) CHECK(says(&choices, "optical: black") && says(&choices, "exercise.utc"));
        }
}

/* Senders whose stamps are no clock, and absolute stamps that disagree, are said. */
static void stamps_that_are_no_clock_are_said(void **state)
{
    (void)state;
    Survey     survey = {.first_s = 0,
                         .clock_start_unix_s = NAN,
                         .absolute_unix_s = 5e8,
                         .absolute_stamps = 20,
                         .absolute_left_out = 1,
                         .doubts = {.count = 6}};
    Config     config = config_default();
    Choices    choices = {0};
    LocalFrame frame = {0};
    double     unix_s;
    for (int i = 0; i < 6; i++)
        survey.doubts.sender[i] =
            (ExerciseClockAnomaly){.site = 3, .application = (uint16_t)(40 + i), .pdus = 90, .by_arrival = 89};
    CHECK(choice_time(&unix_s, &choices, &survey, &config, &frame) == STATUS_OK);
    CHECK(says(&choices, "time stamps of 3:40 stand still: 89 of its 90 PDUs count from their arrival"));
    CHECK(says(&choices, "3:43") && !says(&choices, "3:44") && says(&choices, "2 more senders"));
    CHECK(says(&choices, "1 of 20 absolute stamps disagree and are left out"));
    survey.absolute_unix_s = NAN;
    choices.count = 0;
    CHECK(choice_time(&unix_s, &choices, &survey, &config, &frame) == STATUS_OK);
    CHECK(says(&choices, "local solar 10:00 on 21 June, the absolute stamps of the log do not agree"));
    choices.count = 0;
    survey.absolute_stamps = 1;
    survey.absolute_left_out = 0;
    survey.doubts = (ExerciseClockAnomalies){.unstamped = 7, .stamped = 93};
    CHECK(choice_time(&unix_s, &choices, &survey, &config, &frame) == STATUS_OK);
    CHECK(says(&choices, "21 June, the log's one absolute stamp is too little to go by"));
    CHECK(says(&choices, "clock: 7 of 100 PDUs have no time stamp (0)"));
    choices.count = 0;
    survey.doubts.stamped = 0;
    CHECK(choice_time(&unix_s, &choices, &survey, &config, &frame) == STATUS_OK);
    CHECK(says(&choices, "clock: no PDU has a time stamp, all are 0"));
}

static void the_time_of_day_comes_from_the_best_that_is_known(void **state)
{
    (void)state;
    Survey     survey = {.first_s = 1000, .clock_start_unix_s = NAN, .absolute_unix_s = NAN};
    Config     config = config_default();
    Choices    choices = {0};
    LocalFrame frame = {.origin = {0, 90 * rad_per_deg, 0}};
    double     unix_s = 0;
    log_set_sink(check_listen, NULL);

    /* local solar 10:00 at 90 E is 04:00 UTC; 2026-06-21 is 20625 days after 1970-01-01 */
    assert_int_equal(choice_time(&unix_s, &choices, &survey, &config, &frame), STATUS_OK);
    CHECK_NEAR(unix_s + 1000, 20625.0 * 86400 + 4 * 3600, 1e-3);
    CHECK(says(&choices, "local solar 10:00 on 21 June"));

    /* 15 degrees an hour, to the west later; it goes before what the log says */
    Survey told = survey;
    told.clock_start_unix_s = 6e8;
    frame.origin.lon_rad = -123.75 * rad_per_deg;
    strcpy(config.exercise.local_solar, "2026-06-21T10:00:00");
    assert_int_equal(choice_time(&unix_s, &choices, &told, &config, &frame), STATUS_OK);
    CHECK_NEAR(unix_s + 1000, 20625.0 * 86400 + 18.25 * 3600, 1e-3);
    CHECK(says(&choices, "local solar 2026-06-21T10:00:00 is 2026-06-21T18:15:00Z (exercise.local_solar)"));
    strcpy(config.exercise.local_solar, "2026-06-21T10:00:00Z");
    assert_int_equal(choice_time(&unix_s, &choices, &told, &config, &frame), STATUS_BAD_VALUE);
    *config.exercise.local_solar = 0;
    frame.origin.lon_rad = 90 * rad_per_deg;

    survey.absolute_unix_s = 5e8;
    assert_int_equal(choice_time(&unix_s, &choices, &survey, &config, &frame), STATUS_OK);
    CHECK_NEAR(unix_s, 5e8, 0);
    survey.clock_start_unix_s = 6e8;
    assert_int_equal(choice_time(&unix_s, &choices, &survey, &config, &frame), STATUS_OK);
    CHECK_NEAR(unix_s, 6e8, 0);

    static const struct {
        const char *text;
        double      unix_s;
    } good[] = {
        {"1970-01-01T00:00:00Z", 0}, {"2000-02-29T12:30:15.5Z", 951827415.5}, {"2026-06-21T10:00:00Z", 1782036000}};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) { /* wanted values: date -u -d TEXT +%s */
        strcpy(config.exercise.utc, good[i].text);
        assert_int_equal(choice_time(&unix_s, &choices, &survey, &config, &frame), STATUS_OK);
        CHECK_NEAR(unix_s + 1000, good[i].unix_s, 1e-6);
    }
    static const char *const bad[] = {
        "2026-02-31T00:00:00Z", "1900-02-29T00:00:00Z",  "2026-06-21", "2026-13-01T00:00:00Z", "2026-06-21T24:00:00Z",
        "2026-06-21T10:00:00",  "2026-06-21T10:00:00Zx", "noon"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        strcpy(config.exercise.utc, bad[i]);
        if (choice_time(&unix_s, &choices, &survey, &config, &frame) != STATUS_BAD_VALUE)
            fail_msg("accepted: %s", bad[i]);
        CHECK(strstr(check_said, "exercise.utc"));
    }
}

/* Tracks at the Earth's surface; a missile k flies from start to end. */
static Track track(uint16_t entity, uint8_t kind, uint8_t domain, TrackPoint *point, int count, double start_s,
                   double end_s)
{
    for (int i = 0; i < count; i++) {
        point[i] = (TrackPoint){.t_s = count > 1 ? start_s + (end_s - start_s) * i / (count - 1) : start_s,
                                .p_ecef = {6378137 + 10.0 * kind, 100.0 * i, entity}};
    }
    return (Track){.id = {1, 1, entity}, .type = {kind, domain, 225, 1, 1, 1, 0}, .count = count, .point = point};
}

static void the_longest_flight_that_hit_is_the_host(void **state)
{
    (void)state;
    static TrackPoint points[5][4];
    Track             tracks[5] = {track(10, 1, 1, points[0], 4, 0, 100), track(20, 2, 2, points[1], 4, 5, 30),
                                   track(21, 2, 2, points[2], 4, 5, 15), track(22, 2, 2, points[3], 4, 5, 12),
                                   track(23, 2, 2, points[4], 1, 40, 40)};
    Shot     shots[4] = {{.munition = {1, 1, 20}, .result = dis_result_ground_impact, .fire_s = 5, .detonation_s = 30},
                         {.munition = {1, 1, 21},
                          .target = {1, 1, 10},
                          .hit = {1, 1, 10},
                          .result = dis_result_entity_impact,
                          .fire_s = 5,
                          .detonation_s = 15},
                         {.munition = {1, 1, 22},
                          .hit = {1, 1, 10},
                          .result = dis_result_entity_impact,
                          .fire_s = 5,
                          .detonation_s = 12},
                         {.munition = {1, 1, 23}, .result = dis_result_none, .fire_s = 40, .detonation_s = NAN}};
    Survey   survey = {.track_count = 5, .track = tracks, .shot_count = 4, .shot = shots, .first_s = 0, .last_s = 100};
    Config   config = config_default();
    Choices  choices = {0};
    HostPlan plan;
    log_set_sink(check_listen, NULL);
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(plan.host.entity == 21 && plan.aim.entity == 10 && plan.munition && plan.start_s == 5 && plan.end_s == 15);
    CHECK(says(&choices, "notional") && says(&choices, "target of its Fire PDU"));

    shots[1].result = shots[2].result = dis_result_ground_impact; /* nobody hit: the longest flight */
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(plan.host.entity == 20);

    survey.track_count = 1; /* no munition: the observer */
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(dis_entity_id_is_none(plan.host) && plan.aim.entity == 10 && !plan.munition);

    strcpy(config.exercise.host, "1:1:99");
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "1:1:99 is not in the log"));
    strcpy(config.exercise.host, "1:1");
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_BAD_VALUE);
    config.exercise.host[0] = 0;
    strcpy(config.exercise.aim, "9:9:9");
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_BAD_VALUE);
    survey.track_count = 0;
    config.exercise.aim[0] = 0;
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_BAD_VALUE);
}

/* What has been heard so far: 20 has burst, 21 flies since 5 s, 22 was taken away, 23 fell silent 13 s ago, 24 has just
 * been seen for the first time. */
static void a_causal_host_is_one_that_is_still_there(void **state)
{
    (void)state;
    static TrackPoint points[6][4];
    Track             tracks[6] = {track(10, 1, 1, points[0], 4, 0, 30), track(20, 2, 2, points[1], 4, 1, 20),
                                   track(21, 2, 2, points[2], 4, 5, 29), track(22, 2, 2, points[3], 4, 2, 29),
                                   track(23, 2, 2, points[4], 4, 0, 17), track(24, 2, 2, points[5], 1, 30, 30)};
    points[3][3].deactivated = true;
    Shot     shots[2] = {{.munition = {1, 1, 20},
                          .hit = {1, 1, 10},
                          .result = dis_result_entity_impact,
                          .fire_s = 1,
                          .detonation_s = 20},
                         {.munition = {1, 1, 21}, .target = {1, 1, 10}, .fire_s = 5, .detonation_s = NAN}};
    Survey   survey = {.track_count = 6, .track = tracks, .shot_count = 2, .shot = shots, .first_s = 0, .last_s = 30};
    Config   config = config_default();
    Choices  choices = {0};
    HostPlan plan;
    log_set_sink(check_listen, NULL);
    config.exercise.causal = true;
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(plan.host.entity == 21 && plan.aim.entity == 10 && plan.munition && !plan.any_munition);
    tracks[2] = tracks[1]; /* 21 as ended as 20 is: the one seen once */
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(plan.host.entity == 24 && dis_entity_id_is_none(plan.aim));
    CHECK(says(&choices, "once that is heard"));
    survey.track_count = 5;
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(dis_entity_id_is_none(plan.host) && plan.aim.entity == 10 && !plan.any_munition &&
          says(&choices, "flies here now"));

    strcpy(config.exercise.host, "1:1:99"); /* may come */
    strcpy(config.exercise.aim, "9:9:9");
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(plan.host.entity == 99 && plan.aim.entity == 9 && says(&choices, "1:1:99, not heard so far"));
    strcpy(config.exercise.host, "munition");
    config.exercise.aim[0] = 0;
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(plan.any_munition && dis_entity_id_is_none(plan.host) && dis_entity_id_is_none(plan.aim));
    config.exercise.causal = false; /* of a whole log: from the first that flies to the end of the last */
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(plan.any_munition && dis_entity_id_is_none(plan.host) && plan.start_s == 0 && plan.end_s == 29);
    survey.track_count = 1; /* a vehicle */
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_BAD_VALUE);
    CHECK(strstr(check_said, "none flies in the log") && strstr(check_said, "--host observer"));
}

/* A mine that lies there all the time, a shell that hits, a missile that hits nothing, another that flies longer; all
 * are munitions, and categories 3, 2, 1, 1. */
static void a_guided_munition_goes_before_any_other_and_a_mine_never(void **state)
{
    (void)state;
    static TrackPoint points[5][4];
    Track             tracks[5] = {track(10, 1, 1, points[0], 4, 0, 100), track(20, 2, 4, points[1], 4, 0, 100),
                                   track(21, 2, 2, points[2], 4, 5, 40), track(22, 2, 2, points[3], 4, 5, 12),
                                   track(23, 2, 2, points[4], 4, 5, 15)};
    Shot              shots[1] = {{.munition = {1, 1, 21},
                                   .hit = {1, 1, 10},
                                   .result = dis_result_entity_impact,
                                   .fire_s = 5,
                                   .detonation_s = 40}};
    Survey   survey = {.track_count = 5, .track = tracks, .shot_count = 1, .shot = shots, .first_s = 0, .last_s = 100};
    Config   config = config_default();
    Choices  choices = {0};
    HostPlan plan;
    tracks[1].type.category = 3;
    tracks[2].type.category = 2;
    log_set_sink(check_listen, NULL);
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(plan.host.entity == 23);
    tracks[3].type.category = tracks[4].type.category = 3; /* mines, too */
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(plan.host.entity == 21 && says(&choices, "of unguided munitions"));
    for (int i = 1; i < 4; i++)
        points[2][i].p_ecef[1] = points[2][0].p_ecef[1]; /* of any category, but it lies there */
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(dis_entity_id_is_none(plan.host) && plan.aim.entity == 10 && says(&choices, "no munition flies here"));
    points[2][0].v_ecef_mps[2] = 90; /* not so one that says that it flies */
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(plan.host.entity == 21);
    tracks[2].type.category = 3;
    assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
    CHECK(dis_entity_id_is_none(plan.host) && plan.aim.entity == 10);
}

/* exercise.host: observer, with whatever flies; with its aim, and the default one. */
static void an_observer_may_be_asked_for(void **state)
{
    (void)state;
    static TrackPoint points[3][4];
    Track             tracks[3] = {track(10, 1, 1, points[0], 4, 0, 100), track(11, 1, 1, points[1], 3, 20, 100),
                                   track(20, 2, 2, points[2], 4, 5, 30)};
    Survey            survey = {.track_count = 3, .track = tracks, .first_s = 0, .last_s = 100};
    Config            config = config_default();
    HostPlan          plan;
    log_set_sink(check_listen, NULL);
    strcpy(config.exercise.host, "observer");
    assert_int_equal(config_check(&config), STATUS_OK);
    for (int causal = 0; causal < 2; causal++) {
        Choices choices = {0};
        config.exercise.causal = causal;
        config.exercise.aim[0] = 0;
        assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
        CHECK(dis_entity_id_is_none(plan.host) && !plan.any_munition && !plan.munition && plan.aim.entity == 10);
        CHECK(says(&choices, "host: a stand-off observer (exercise.host)"));
        strcpy(config.exercise.aim, "1:1:11");
        assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_OK);
        CHECK(plan.aim.entity == 11 && plan.start_s == 20);
        assert_int_equal(choice_named_host(&plan, &choices, &survey, &config, (DisEntityId){0}),
                         STATUS_OK); /* --host, several */
        CHECK(dis_entity_id_is_none(plan.host) && plan.aim.entity == 11);
    }
    static const char *const bad[] = {"Observer", "observers", "0:0:0", "munitions"};
    for (int i = 0; i < 4; i++) {
        Choices choices = {0};
        strcpy(config.exercise.host, bad[i]);
        assert_int_equal(choice_host(&plan, &choices, &survey, &config), STATUS_BAD_VALUE);
        CHECK(strstr(check_said, "nor observer"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_exercise_heard_most_is_taken),
        cmocka_unit_test(optical_pictures_of_the_night_are_said_to_be_black),
        cmocka_unit_test(stamps_that_are_no_clock_are_said),
        cmocka_unit_test(the_time_of_day_comes_from_the_best_that_is_known),
        cmocka_unit_test(the_longest_flight_that_hit_is_the_host),
        cmocka_unit_test(a_causal_host_is_one_that_is_still_there),
        cmocka_unit_test(a_guided_munition_goes_before_any_other_and_a_mine_never),
        cmocka_unit_test(an_observer_may_be_asked_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
