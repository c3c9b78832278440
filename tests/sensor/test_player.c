/* The player: by stamp, or causally by arrival. */
#include "tests/check.h"

#include "sensor/node/player/player.h"
#include "tests/sensor/open_catalog.h"

#include <stdlib.h>
#include <unistd.h>

enum { report_count = 3 };

static uint8_t     bytes[report_count][256];
static DisDatagram datagram[report_count];

/* Entity k reports at stamp_s[k] seconds past the hour and is received at capture_s[k]. */
static DisLog make_log(const double stamp_s[report_count], const double capture_s[report_count])
{
    for (int k = 0; k < report_count; k++) {
        DisEntityState pdu = {.header = {.version = 7,
                                         .exercise = (uint8_t)(1 + k % 2),
                                         .type = dis_pdu_entity_state,
                                         .family = 1,
                                         .timestamp = (uint32_t)(stamp_s[k] / 3600 * 2147483648.0) << 1},
                              .id = {1, 1, (uint16_t)(k + 1)},
                              .type = {1, 1, 222, 1, 1, 1, 0},
                              .p_ecef = {6378137, 10.0 * k, 0},
                              .dead_reckoning = 1};
        const size_t   octets = dis_encode_entity_state(bytes[k], sizeof bytes[k], &pdu);
        CHECK(octets > 0);
        datagram[k] = (DisDatagram){
            .capture_s = capture_s[k], .packet = (uint32_t)k + 1, .octets = (uint32_t)octets, .bytes = bytes[k]};
    }
    return (DisLog){.count = report_count, .datagram = datagram};
}

static int count_at(const DisLog *log, int exercise, bool causal, double t_s)
{
    EntityTableConfig config = entity_table_default_config();
    EntityTable      *table = NULL;
    Player           *player = NULL;
    assert_int_equal(entity_table_create(&table, &config, catalog), STATUS_OK);
    assert_int_equal(player_create(&player, exercise, causal), STATUS_OK);
    assert_int_equal(player_add_log(player, log), STATUS_OK);
    player_feed(player, table, t_s);
    const int count = entity_table_count(table);
    player_destroy(player);
    entity_table_destroy(table);
    return count;
}

/* The second report is stamped 101 and received an eighth of a second late; the third is stamped before the second. */
static void a_late_report_counts_from_its_stamp_or_from_its_arrival(void **state)
{
    (void)state;
    static const double stamp_s[] = {100, 101, 100.5}, capture_s[] = {1000, 1001.125, 1001.25};
    const DisLog        log = make_log(stamp_s, capture_s);
    CHECK(count_at(&log, -1, false, 99.9) == 0);
    CHECK(count_at(&log, -1, false, 100.6) == 2); /* the third, by its stamp */
    CHECK(count_at(&log, -1, false, 101.1) == 3);
    CHECK(count_at(&log, -1, true, 101.1) == 1); /* the others had not come */
    CHECK(count_at(&log, -1, true, 101.13) == 2);
    CHECK(count_at(&log, -1, true, 101.26) == 3);
}

static void other_exercises_are_left_out(void **state)
{
    (void)state;
    static const double at_s[] = {100, 100, 100}, capture_s[] = {1000, 1000, 1000};
    const DisLog        log = make_log(at_s, capture_s);
    CHECK(count_at(&log, -1, false, 101) == 3);
    CHECK(count_at(&log, 1, false, 101) == 2);
    CHECK(count_at(&log, 2, false, 101) == 1);
    CHECK(count_at(&log, 3, false, 101) == 0);
}

static EntityTable *make_table(void)
{
    EntityTableConfig config = entity_table_default_config();
    EntityTable      *table = NULL;
    assert_int_equal(entity_table_create(&table, &config, catalog), STATUS_OK);
    return table;
}

/* Added one by one between feeds, from memory that is used again, as a live node does. */
static void what_comes_bit_by_bit_counts_as_the_whole_log(void **state)
{
    (void)state;
    static const double stamp_s[] = {100, 101, 100.5}, capture_s[] = {1000, 1003, 1003.1},
                        at_s[] = {101.1, 103.05, 103.2};
    const DisLog log = make_log(stamp_s, capture_s);
    EntityTable *table = make_table();
    Player      *player = NULL;
    uint8_t      once[256];
    assert_int_equal(player_create(&player, -1, true), STATUS_OK);
    CHECK(isnan(player_time_s(player, 1000)) && player_last_s(player) == -INFINITY);
    for (int k = 0; k < report_count; k++) {
        DisDatagram one = log.datagram[k];
        memcpy(once, one.bytes, one.octets);
        one.bytes = once;
        assert_int_equal(player_add(player, &one, true), STATUS_OK);
        memset(once, 0xFF, sizeof once);
        player_feed(player, table, at_s[k]);
        CHECK(entity_table_count(table) == k + 1);
    }
    CHECK(player_counters(player)->datagrams == 3 && player_counters(player)->pdus[dis_pdu_entity_state] == 3);
    CHECK_NEAR(player_last_s(player), 103.1, 1e-6); /* a stamp's 1.7 us */
    player_destroy(player);
    entity_table_destroy(table);
}

/* Whatever counts at t arrived by then, and what arrived by then counts at t: to the last bit, at today's Unix
 * times. */
static void arrival_and_exercise_time_agree_to_the_last_bit(void **state)
{
    (void)state;
    for (int k = 0; k < 2000; k++) {
        const double capture[] = {1.7e9 + 1e8 * random_uniform(1, 0, 0, (uint64_t)k), 0, 0};
        const double stamp[] = {3599 * random_uniform(1, 1, 0, (uint64_t)k), 0, 0};
        DisLog       log = make_log(stamp, capture);
        Player      *player = NULL;
        log.count = 1;
        assert_int_equal(player_create(&player, -1, true), STATUS_OK);
        assert_int_equal(player_add_log(player, &log), STATUS_OK);
        const double t_s = stamp[0] + k / 30.0, until_s = player_arrival_s(player, t_s);
        CHECK(player_time_s(player, until_s) <= t_s);
        CHECK(player_time_s(player, nextafter(until_s, INFINITY)) > t_s);
        /* and in the whole nanoseconds of arrivals */
        const int64_t until_ns = dis_unix_ns_until(until_s);
        CHECK(player_time_s(player, dis_unix_s(until_ns)) <= t_s &&
              player_time_s(player, dis_unix_s(until_ns + 1)) > t_s);
        player_destroy(player);
    }
}

/* A missile that is there already, one that comes later, and a Fire that names the target of each. */
static void munitions_and_their_targets_are_known_when_they_were_heard(void **state)
{
    (void)state;
    uint8_t      octets[4][256];
    DisDatagram  heard[4];
    EntityTable *table = make_table();
    Player      *player = NULL;
    for (int k = 0; k < 4; k++) {
        const uint32_t stamp = (uint32_t)((100.0 + k) / 3600 * 2147483648.0) << 1;
        DisEntityState missile = {
            .header = {.version = 7, .exercise = 1, .type = dis_pdu_entity_state, .family = 1, .timestamp = stamp},
            .id = {1, 1, (uint16_t)(40 + k)},
            .type = {2, 1, 222, 1, 1, 1, 0},
            .p_ecef = {6378137, 10.0 * k, 0},
            .dead_reckoning = 1};
        DisFire fire = {.header = {.version = 7, .exercise = 1, .type = dis_pdu_fire, .family = 2, .timestamp = stamp},
                        .firing = {1, 1, 7},
                        .target = {1, 1, (uint16_t)(20 + k)},
                        .munition = {1, 1, (uint16_t)(40 + k - 1)},
                        .p_ecef = {6378137, 0, 0}};
        const size_t n = k % 2 ? dis_encode_fire(octets[k], sizeof octets[k], &fire)
                               : dis_encode_entity_state(octets[k], sizeof octets[k], &missile);
        CHECK(n > 0);
        heard[k] = (DisDatagram){.capture_s = 1000 + k, .octets = (uint32_t)n, .bytes = octets[k]};
    }
    const DisLog log = {.count = 4, .datagram = heard};
    DisEntityId  id = {0}, host = {0};
    bool         guided;
    assert_int_equal(player_create(&player, -1, true), STATUS_OK);
    assert_int_equal(player_add_log(player, &log), STATUS_OK);
    player_feed(player, table, 99.5);
    CHECK(!player_munition(&host, &guided, player, table)); /* added, but not heard yet */
    player_feed(player, table, 100.5);
    CHECK(player_munition(&host, &guided, player, table) && host.entity == 40 && guided);
    CHECK(!player_target(&id, player, (DisEntityId){1, 1, 40}));
    player_feed(player, table, 103.5);
    CHECK(player_munition(&host, &guided, player, table) && host.entity == 40); /* still the first */
    CHECK(player_target(&id, player, (DisEntityId){1, 1, 40}) && id.entity == 21);
    CHECK(player_target(&id, player, (DisEntityId){1, 1, 42}) && id.entity == 23);
    entity_table_expire(table, 113.5); /* 40 was heard 13.5 s ago, 42 11.5 s ago; 12 s are allowed */
    CHECK(player_munition(&host, &guided, player, table) && host.entity == 42);
    player_destroy(player);
    entity_table_destroy(table);
}

/* Heard one a second: a mine, a shell, a second shell, a missile, a second missile, a mine; the first missile is taken
 * away at 106, the second at 107; and one (37) that lies there until it is thrown. Categories by SISO-REF-010: 1
 * guided, 2 ballistic, 3 fixed. */
static void the_guided_one_carries_the_sensor_and_then_the_next(void **state)
{
    (void)state;
    static const struct {
        uint16_t entity;
        uint8_t  category;
        uint32_t gone;
    } say[] = {{30, 3, 0},        {31, 2, 0},        {32, 2, 0},        {33, 1, 0},        {34, 1, 0},
               {35, 3, 0},        {33, 1, 1u << 23}, {34, 1, 1u << 23}, {31, 2, 1u << 23}, {36, 0, 0},
               {32, 2, 1u << 23}, {36, 0, 1u << 23}, {37, 2, 0},        {37, 2, 0}};
    enum { says = sizeof say / sizeof *say };
    static const uint16_t want[says] = {0, 31, 31, 33, 33, 33, 34, 0, 0, 0, 0, 0, 0, 0};
    uint8_t               octets[says][256];
    DisDatagram           heard[says];
    EntityTable          *table = make_table();
    Player               *player = NULL;
    for (int k = 0; k < says; k++) {
        DisEntityState pdu = {.header = {.version = 7,
                                         .exercise = 1,
                                         .type = dis_pdu_entity_state,
                                         .family = 1,
                                         .timestamp = (uint32_t)((100.0 + k) / 3600 * 2147483648.0) << 1},
                              .id = {1, 1, say[k].entity},
                              .type = {2, 9, 225, say[k].category, 1, 1, 0},
                              .appearance = say[k].gone,
                              .velocity_mps = {0, k == 12 ? 0.5f : -50, 0},
                              .p_ecef = {6378137, 10.0 * k, 0},
                              .dead_reckoning = 2};
        const size_t   n = dis_encode_entity_state(octets[k], sizeof octets[k], &pdu);
        CHECK(n > 0);
        heard[k] = (DisDatagram){.capture_s = 1000 + k, .octets = (uint32_t)n, .bytes = octets[k]};
    }
    const DisLog log = {.count = says, .datagram = heard};
    DisEntityId  host = {0};
    bool         guided;
    assert_int_equal(player_create(&player, -1, true), STATUS_OK);
    assert_int_equal(player_add_log(player, &log), STATUS_OK);
    for (int k = 0; k < says; k++) {
        player_feed(player, table, 100.5 + k);
        const bool there = player_munition(&host, &guided, player, table);
        CHECK(there == (want[k] != 0));
        if (there) CHECK(host.entity == want[k] && guided == (want[k] == 33 || want[k] == 34));
    }
    player_destroy(player);
    entity_table_destroy(table);
}

/* A shell that lies there (30), and two shells of which the first bursts at 102.2 and the second falls silent at 103:
 * neither is gone back to, and no shell after a missile (at 109), which keeps the sensor when it has burst (at 110.2).
 */
static void no_spent_one_carries_the_sensor_again(void **state)
{
    (void)state;
    static const struct {
        uint16_t entity;
        uint8_t  category;
        bool     burst;
        double   t_s;
        uint16_t want;
    } say[] = {{30, 2, false, 99, 0},     {31, 2, false, 100, 31},  {32, 2, false, 101, 31}, {31, 2, true, 102.2, 32},
               {31, 2, false, 102.3, 32}, {32, 2, false, 103, 32},  {39, 1, false, 109, 39}, {31, 2, false, 110, 39},
               {39, 1, true, 110.2, 39},  {31, 2, false, 110.3, 39}};
    enum { says = sizeof say / sizeof *say };
    uint8_t      octets[says][256];
    DisDatagram  heard[says];
    EntityTable *table = make_table();
    Player      *player = NULL;
    for (int k = 0; k < says; k++) {
        const uint32_t stamp = (uint32_t)(say[k].t_s / 3600 * 2147483648.0) << 1;
        DisEntityState pdu = {
            .header = {.version = 7, .exercise = 1, .type = dis_pdu_entity_state, .family = 1, .timestamp = stamp},
            .id = {1, 1, say[k].entity},
            .type = {2, 9, 225, say[k].category, 1, 1, 0},
            .velocity_mps = {0, say[k].entity == 30 ? 0 : -50, 0},
            .p_ecef = {6378137, 10.0 * k, 0},
            .dead_reckoning = 2};
        DisDetonation burst = {
            .header = {.version = 7, .exercise = 1, .type = dis_pdu_detonation, .family = 2, .timestamp = stamp},
            .firing = {1, 1, 7},
            .munition = {1, 1, say[k].entity},
            .p_ecef = {6378137, 0, 0}};
        const size_t n = say[k].burst ? dis_encode_detonation(octets[k], sizeof octets[k], &burst)
                                      : dis_encode_entity_state(octets[k], sizeof octets[k], &pdu);
        CHECK(n > 0);
        heard[k] = (DisDatagram){.capture_s = 900 + say[k].t_s, .octets = (uint32_t)n, .bytes = octets[k]};
    }
    const DisLog log = {.count = says, .datagram = heard};
    DisEntityId  host = {0}, none = {0};
    bool         guided;
    assert_int_equal(player_create(&player, -1, true), STATUS_OK);
    assert_int_equal(player_add_log(player, &log), STATUS_OK);
    for (int k = 0; k < says; k++) {
        player_feed(player, table, say[k].t_s + 0.05);
        player_munition(&host, &guided, player, table); /* false, and nothing changed, where none is left */
        CHECK(host.entity == say[k].want);
    }
    /* 31 was heard again after 7.7 s: another munition with its id */
    CHECK(!player_spent(player, (DisEntityId){1, 1, 31}) && !player_spent(player, (DisEntityId){1, 1, 32}));
    CHECK(player_spent(player, (DisEntityId){1, 1, 39}));
    player_feed(player, table, 118);
    CHECK(!player_munition(&none, &guided, player, table)); /* unheard for 7 s */
    player_destroy(player);
    entity_table_destroy(table);
}

/* More Fires of one munition than are read ahead, 500 a second; in each block of 20 they arrive in the reverse order.
 * The target is that of the latest stamp that was fed, in one step and in many. */
static void a_long_log_is_fed_in_the_order_of_stamps(void **state)
{
    (void)state;
    enum { fires = 90000, block = 20 };
    uint8_t(*octets)[96] = malloc(fires * sizeof *octets);
    DisDatagram *heard = malloc(fires * sizeof *heard);
    CHECK(octets && heard);
    for (int i = 0; i < fires; i++) {
        const int     k = i / block * block + block - 1 - i % block; /* stamped as number k */
        const DisFire fire = {.header = {.version = 7,
                                         .exercise = 1,
                                         .type = dis_pdu_fire,
                                         .family = 2,
                                         .timestamp = (uint32_t)((100 + 0.002 * k) / 3600 * 2147483648.0) << 1},
                              .firing = {1, 1, 7},
                              .target = {1, 2, (uint16_t)(1 + k % 65000)},
                              .munition = {1, 1, 41},
                              .p_ecef = {6378137, 0, 0}};
        const size_t  n = dis_encode_fire(octets[i], sizeof octets[i], &fire);
        CHECK(n > 0);
        heard[i] = (DisDatagram){.capture_s = 1000 + 0.002 * i, .octets = (uint32_t)n, .bytes = octets[i]};
    }
    const DisLog log = {.count = fires, .datagram = heard};
    int          off = -1;
    for (int way = 0; way < 2; way++) {
        EntityTable *table = make_table();
        Player      *player = NULL;
        DisEntityId  id = {0};
        assert_int_equal(player_create(&player, -1, false), STATUS_OK);
        assert_int_equal(player_add_log(player, &log), STATUS_OK);
        for (int k = way ? 977 : 85001; k < fires; k += way ? 977 : fires) {
            const double t_s = 100 + 0.002 * (k + 0.5);
            player_feed(player, table, t_s);
            CHECK(player_target(&id, player, (DisEntityId){1, 1, 41}));
            const int behind =
                (1 + k % 65000 - id.entity + 65000) % 65000; /* the clock is a part of a second off, always */
            if (off < 0) off = behind;
            if (behind != off || off > 200) fail_msg("way %d, %d: %d behind, not %d", way, k, behind, off);
            CHECK(t_s - player_fed_s(player) >= 0 && t_s - player_fed_s(player) < 0.00201);
        }
        player_destroy(player);
        entity_table_destroy(table);
    }
    free(octets);
    free(heard);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_late_report_counts_from_its_stamp_or_from_its_arrival),
        cmocka_unit_test(other_exercises_are_left_out),
        cmocka_unit_test(what_comes_bit_by_bit_counts_as_the_whole_log),
        cmocka_unit_test(arrival_and_exercise_time_agree_to_the_last_bit),
        cmocka_unit_test(munitions_and_their_targets_are_known_when_they_were_heard),
        cmocka_unit_test(the_guided_one_carries_the_sensor_and_then_the_next),
        cmocka_unit_test(no_spent_one_carries_the_sensor_again),
        cmocka_unit_test(a_long_log_is_fed_in_the_order_of_stamps),
    };
    return cmocka_run_group_tests(tests, open_catalog, close_catalog);
}
