/* What a causal run makes its choices from: the rule, case by case, with the answer on paper. */
#include "tests/check.h"

#include "dis/pdu/decode.h"
#include "sensor/node/player/player.h"

enum { most = 3000 };

static uint8_t     report[2][256], comment[40]; /* usable Entity States of exercises 1 and 2; a Comment */
static size_t      report_octets;
static DisDatagram datagram[most];
static DisLog      log_ = {.datagram = datagram};

static void make_pdus(void)
{
    for (int k = 0; k < 2; k++) {
        DisEntityState pdu = {
            .header = {.version = 7, .exercise = (uint8_t)(k + 1), .type = dis_pdu_entity_state, .family = 1},
            .id = {10, 20, 30},
            .p_ecef = {6378137, 0, 0}};
        report_octets = dis_encode_entity_state(report[k], sizeof report[k], &pdu);
        CHECK(report_octets > 0);
    }
    static const uint8_t head[] = {7, 1, 22, 5, 0, 0, 0, 0, 0, 32, 0, 0, 0x12, 0x67, 0, 1, 0, 0}; /* from 4711:1 */
    memcpy(comment, head, sizeof head);
}

static void add(const uint8_t *bytes, size_t octets, double capture_s)
{
    CHECK(log_.count < most);
    datagram[log_.count++] = (DisDatagram){.capture_s = capture_s, .bytes = bytes, .octets = (uint32_t)octets};
}

static void it_begins_with_the_first_usable_report(void **state)
{
    (void)state;
    Config config = config_default();
    DisLog view, heard;
    double until_s = 0;
    make_pdus();
    log_.count = 0;
    config.exercise.listen_s = 2;
    CHECK(!player_opening(&view, &heard, &until_s, &log_, &config)); /* nothing at all */
    add(comment, 32, 100);
    add(comment, 32, 101);
    CHECK(!player_opening(&view, &heard, &until_s, &log_, &config)); /* nobody is anywhere */
    add(report[0], report_octets, 150);
    add(report[0], report_octets, 152); /* to the moment */
    add(report[0], report_octets, nextafter(152, 200));
    add(report[0], report_octets, 160);
    CHECK(player_opening(&view, &heard, &until_s, &log_, &config));
    CHECK(until_s == 152 && view.count == 6 && view.datagram == datagram && heard.count == 4 &&
          heard.datagram == datagram);
    config.exercise.listen_s = 100;
    CHECK(player_opening(&view, &heard, &until_s, &log_, &config) && heard.count == 6); /* the log is shorter */
    config.exercise.exercise = 2;
    CHECK(!player_opening(&view, &heard, &until_s, &log_, &config));
    add(report[1], report_octets, 170);
    CHECK(player_opening(&view, &heard, &until_s, &log_, &config) && until_s == 270 && heard.count == 7);
}

static void a_long_murmur_before_is_not_kept(void **state)
{
    (void)state;
    const Config config = config_default();
    DisLog       view, heard;
    double       until_s;
    make_pdus();
    log_.count = 0;
    for (int i = 0; i < 2000; i++) add(comment, 32, i);
    add(report[0], report_octets, 2000);
    add(report[0], report_octets, 2500);
    CHECK(player_opening(&view, &heard, &until_s, &log_, &config));
    CHECK(view.datagram == datagram + 2000 - player_opening_before && view.count == player_opening_before + 2);
    CHECK(heard.datagram == view.datagram && heard.count == player_opening_before + 1);
}

static void own_datagrams_are_known_by_their_sender(void **state)
{
    (void)state;
    Config config = config_default();
    make_pdus();
    config.node.site = 4711;
    config.node.application = 1;
    log_.count = 0;
    add(comment, 32, 1);
    add(report[0], report_octets, 2);
    add(comment, 32, 3);
    add(comment, 8, 4); /* nobody's: it is cut off */
    CHECK(player_own(&datagram[0], &config) && !player_own(&datagram[1], &config) &&
          !player_own(&datagram[3], &config));
    CHECK(player_drop_own(&log_, &config) == 2 && log_.count == 2 && datagram[0].capture_s == 2 &&
          datagram[1].capture_s == 4);
    config.node.application = 20;
    config.node.site = 10;
    CHECK(player_drop_own(&log_, &config) == 1); /* its own entities too */
}

static void a_report_must_be_somewhere(void **state)
{
    (void)state;
    const Config   config = config_default();
    DisEntityState pdu = {.header = {.version = 7, .exercise = 1, .type = dis_pdu_entity_state, .family = 1},
                          .id = {10, 20, 30},
                          .p_ecef = {6378137, 0, 0}};
    uint8_t        bytes[256];
    DisHeader      header;
    for (int k = 0; k < 4; k++) {
        DisEntityState bad = pdu;
        if (k == 1) bad.p_ecef[0] = 0; /* the centre of the Earth */
        if (k == 2) bad.p_ecef[1] = NAN;
        if (k == 3) bad.id = (DisEntityId){0, 0, 0};
        const size_t      n = dis_encode_entity_state(bytes, sizeof bytes, &bad);
        const DisDatagram one = {.bytes = bytes, .octets = (uint32_t)n};
        CHECK(player_starts(&header, &one, &config) == (k == 0));
    }
    CHECK(header.exercise == 1 && header.version == 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_begins_with_the_first_usable_report),
        cmocka_unit_test(a_long_murmur_before_is_not_kept),
        cmocka_unit_test(own_datagrams_are_known_by_their_sender),
        cmocka_unit_test(a_report_must_be_somewhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
