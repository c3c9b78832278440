/* The player: by stamp, or causally by arrival. */
#include "tests/check.h"

#include "sensor/node/player.h"

#include <unistd.h>

enum { report_count = 3 };

static uint8_t     bytes[report_count][256];
static DisDatagram datagram[report_count];
static Catalog    *catalog;

static int open_catalog(void **state)
{
    (void)state;
    char path[512];
    return etc_path(path, sizeof path, "catalog.csv") && catalog_open(&catalog, path, 0.05) == STATUS_OK ? 0 : -1;
}

static int close_catalog(void **state)
{
    (void)state;
    catalog_close(catalog);
    return 0;
}

/* Entity k reports at stamp_s[k] seconds past the hour and is received at capture_s[k]. */
static DisLog make_log(const double stamp_s[report_count], const double capture_s[report_count])
{
    for (int k = 0; k < report_count; k++) {
        DisEntityState pdu = {.header = {.version = 7, .exercise = (uint8_t)(1 + k % 2), .type = dis_pdu_entity_state, .family = 1,
                                         .timestamp = (uint32_t)(stamp_s[k] / 3600 * 2147483648.0) << 1},
                              .id = {1, 1, (uint16_t)(k + 1)}, .type = {1, 1, 222, 1, 1, 1, 0},
                              .p_ecef = {6378137, 10.0 * k, 0}, .dead_reckoning = 1};
        const size_t octets = dis_encode_entity_state(bytes[k], sizeof bytes[k], &pdu);
        CHECK(octets > 0);
        datagram[k] = (DisDatagram){.capture_s = capture_s[k], .packet = (uint32_t)k + 1, .octets = (uint32_t)octets, .bytes = bytes[k]};
    }
    return (DisLog){.count = report_count, .datagram = datagram};
}

static int count_at(const DisLog *log, int exercise, bool causal, double t_s)
{
    EntityTableConfig config = entity_table_default_config();
    EntityTable      *table  = NULL;
    Player           *player = NULL;
    char              heat[512];
    CHECK(etc_path(heat, sizeof heat, "heat.csv"));
    assert_int_equal(entity_table_create(&table, &config, catalog, heat), STATUS_OK);
    assert_int_equal(player_create(&player, exercise, causal), STATUS_OK);
    assert_int_equal(player_add_log(player, log), STATUS_OK);
    player_feed(player, table, t_s);
    const int count = entity_table_count(table);
    player_destroy(player);
    entity_table_destroy(table);
    return count;
}

/* The second report is stamped 101 and received two seconds late; the third is stamped before the second. */
static void a_late_report_counts_from_its_stamp_or_from_its_arrival(void **state)
{
    (void)state;
    static const double stamp_s[] = {100, 101, 100.5}, capture_s[] = {1000, 1003, 1003.1};
    const DisLog        log = make_log(stamp_s, capture_s);
    CHECK(count_at(&log, -1, false, 99.9) == 0);
    CHECK(count_at(&log, -1, false, 100.6) == 2); /* the third, by its stamp */
    CHECK(count_at(&log, -1, false, 101.1) == 3);
    CHECK(count_at(&log, -1, true, 101.1) == 1); /* the others had not come */
    CHECK(count_at(&log, -1, true, 102.9) == 1);
    CHECK(count_at(&log, -1, true, 103.05) == 2);
    CHECK(count_at(&log, -1, true, 103.2) == 3);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_late_report_counts_from_its_stamp_or_from_its_arrival),
        cmocka_unit_test(other_exercises_are_left_out),
    };
    return cmocka_run_group_tests(tests, open_catalog, close_catalog);
}
