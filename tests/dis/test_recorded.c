/* tests/dis/test_recorded.c: real traffic of other people's simulators, held against what others say is in it. */
#include "tests/check.h"
#include "tests/dis/random_pdu.h"

#include "dis/pdu/decode.h"
#include "dis/clock/exercise_clock.h"
#include "dis/capture/log.h"

static const char *const captures[] = {"dis/vrf-dis5-tow-vs-armor", "dis/vrf-dis7-gaz69-blocks",
                                       "dis/vrf-dis7-gaz69-straight", "dis/singles"};

static DisPdu decoded;

/* Opens a capture by its name without ending; false when the reference data is absent. */
static bool open_capture(DisLog *log, const char *name)
{
    char file[128], path[512];
    snprintf(file, sizeof file, "%s.pcap", name);
    if (!reference_path(path, file)) return false;
    CHECK(dis_log_open(log, path, dis_port) == STATUS_OK);
    CHECK(!log->truncated);
    return true;
}

static bool next(DisHeader *header, const uint8_t **pdu, const DisLog *log, int *datagram, const uint8_t **at,
                 DisCounters *counters)
{
    for (; *datagram < log->count; (*datagram)++, *at = NULL) {
        const DisDatagram *d = &log->datagram[*datagram];
        if (!*at) *at = d->bytes;
        if (dis_next_pdu(header, pdu, at, d->bytes + d->octets, counters)) return true;
    }
    return false;
}

/* Counts of the data's own README (tshark 4.0.17, and a walk by length for the bundles). */
static void captures_hold_what_others_count(void **state)
{
    (void)state;
    static const struct {
        int      datagrams;
        uint64_t pdus, entity_state, fire, detonation, attribute;
    } want[4] = {
        {759, 759, 462, 15, 13, 0}, {1222, 2083, 775, 0, 0, 861}, {174, 300, 116, 0, 0, 126}, {10, 10, 3, 1, 0, 0}};
    for (int i = 0; i < 4; i++) {
        DisLog log;
        if (!open_capture(&log, captures[i])) skip();
        DisCounters    counters = {0};
        DisHeader      header;
        const uint8_t *pdu, *at = NULL;
        uint64_t       pdus = 0;
        for (int datagram = 0; next(&header, &pdu, &log, &datagram, &at, &counters);) pdus++;
        CHECK(log.count == want[i].datagrams && pdus == want[i].pdus);
        CHECK(counters.pdus[1] == want[i].entity_state && counters.pdus[2] == want[i].fire);
        CHECK(counters.pdus[3] == want[i].detonation && counters.pdus[72] == want[i].attribute);
        for (int why = 0; why < DIS_DROP_COUNT; why++) CHECK(counters.dropped[why] == 0);
        dis_log_close(&log);
    }
}

static void every_recorded_pdu_comes_back_octet_for_octet(void **state)
{
    (void)state;
    static uint8_t back[8192];
    for (int i = 0; i < 4; i++) {
        DisLog log;
        if (!open_capture(&log, captures[i])) skip();
        DisCounters    counters = {0};
        DisHeader      header;
        const uint8_t *pdu, *at = NULL;
        int            checked = 0;
        for (int datagram = 0; next(&header, &pdu, &log, &datagram, &at, &counters);) {
            const Status status = dis_decode(&decoded, pdu, header.length);
            if (status == STATUS_UNSUPPORTED) continue;
            CHECK(status == STATUS_OK);
            CHECK(dis_encode(back, sizeof back, &decoded) == header.length); /* no surplus octets */
            CHECK(memcmp(back, pdu, header.length) == 0);
            checked++;
        }
        CHECK(checked > 0);
        dis_log_close(&log);
    }
}

/* ---- tshark's decode, field by field ------------------------------------------------------------------ */

/* Text of one field as tshark would write the value. */
static void check_text(const char *want, const char *format, double value, int line, int column)
{
    char got[64];
    snprintf(got, sizeof got, format, value);
    if (strcmp(want, got) != 0) fail_msg("line %d, column %d: got %s, tshark says %s", line, column, got, want);
}

static void entity_states_read_as_tshark_reads_them(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) {
        DisLog log;
        if (!open_capture(&log, captures[i])) skip();
        char name[128], path[512], text[2048];
        snprintf(name, sizeof name, "%s.espdu.tsv", captures[i]);
        if (!reference_path(path, name)) skip();
        FILE *tsv = fopen(path, "r");
        CHECK(tsv && fgets(text, sizeof text, tsv)); /* the header */

        int line = 1, datagram = 0;
        while (fgets(text, sizeof text, tsv)) {
            line++;
            char *field[27];
            int   fields = 0;
            text[strcspn(text, "\n")] = 0;
            for (char *rest = text; fields < 27 && rest;) field[fields++] = strsep(&rest, "\t");
            CHECK(fields == 27);
            const uint32_t packet = (uint32_t)strtoul(field[0], NULL, 10);
            while (datagram < log.count && log.datagram[datagram].packet < packet) datagram++;
            CHECK(datagram < log.count && log.datagram[datagram].packet == packet);
            const DisDatagram *d = &log.datagram[datagram];
            DisEntityState    *es = &decoded.entity_state;
            CHECK(dis_decode(&decoded, d->bytes, d->octets) == STATUS_OK); /* tshark shows the first PDU only */

            const double integer[] = {es->header.version, es->header.exercise};
            for (int k = 0; k < 2; k++) check_text(field[1 + k], "%.0f", integer[k], line, 1 + k);
            /* tshark divides by 2^31 - 1 and cuts to microseconds: within 3 us of ours */
            CHECK_NEAR(dis_timestamp_seconds(es->header.timestamp), strtod(field[3], NULL), 3e-6);
            const double number[] = {es->header.length, es->id.site, es->id.application,
                                     es->id.entity,     es->force,   es->variable_count};
            for (int k = 0; k < 6; k++) check_text(field[4 + k], "%.0f", number[k], line, 4 + k);
            const float euler_rad[3] = {es->psi_rad, es->theta_rad, es->phi_rad};
            for (int k = 0; k < 3; k++) {
                check_text(field[10 + k], "%.6g", (double)es->velocity_mps[k], line, 10 + k);
                check_text(field[13 + k], "%.15g", es->p_ecef[k], line, 13 + k);
                check_text(field[16 + k], "%.6g", (double)euler_rad[k], line, 16 + k);
                check_text(field[20 + k], "%.6g", (double)es->acceleration_mps2[k], line, 20 + k);
                check_text(field[23 + k], "%.6g", (double)es->angular_rate_rps[k], line, 23 + k);
            }
            CHECK(es->appearance == strtoul(field[19], NULL, 16));
            CHECK(strlen(field[26]) == strnlen(es->marking, sizeof es->marking));
            CHECK(memcmp(field[26], es->marking, strlen(field[26])) == 0);
        }
        fclose(tsv);
        CHECK(line > 100);
        dis_log_close(&log);
    }
}

/* ---- what the README of the data tells of the shots ----------------------------------------------------- */

static void shots_are_those_of_the_scenario(void **state)
{
    (void)state;
    DisLog log;
    if (!open_capture(&log, captures[0])) skip();
    DisCounters    counters = {0};
    DisHeader      header;
    const uint8_t *pdu, *at = NULL;
    int            hits = 0, ground = 0, fires = 0;
    for (int datagram = 0; next(&header, &pdu, &log, &datagram, &at, &counters);) {
        if (header.type == dis_pdu_fire) {
            DisFire *fire = &decoded.fire;
            CHECK(dis_decode(&decoded, pdu, header.length) == STATUS_OK);
            CHECK(fire->munition.entity == 81 + fires); /* 81 .. 95, in order */
            CHECK(fire->firing.entity == 66 || fire->firing.entity == 68 || fire->firing.entity == 69);
            CHECK(fire->descriptor.type.kind == 2 && fire->descriptor.type.country == 225);
            fires++;
        }
        if (header.type != dis_pdu_detonation) continue;
        DisDetonation *d = &decoded.detonation;
        CHECK(dis_decode(&decoded, pdu, header.length) == STATUS_OK);
        if (d->result == dis_result_entity_impact) {
            CHECK(d->target.entity == (d->munition.entity == 82 ? 72 : 74));
            CHECK(d->munition.entity == 82 || d->munition.entity == 88 || d->munition.entity == 90);
            hits++;
        } else {
            CHECK(d->result == dis_result_ground_impact && dis_entity_id_is_none(d->target));
            ground++;
        }
        const double r_m = v3_length(d->p_ecef);
        CHECK(r_m > 6.3e6 && r_m < 6.4e6);
    }
    CHECK(fires == 15 && hits == 3 && ground == 10);
    dis_log_close(&log);
}

/* Header stamps of the DIS 5 log made its packet times (README), so exercise time and capture time agree. */
static void exercise_clock_follows_the_stamps(void **state)
{
    (void)state;
    DisLog log;
    if (!open_capture(&log, captures[0])) skip();
    ExerciseClock *clock;
    CHECK(exercise_clock_create(&clock) == STATUS_OK);
    DisCounters    counters = {0};
    DisHeader      header;
    const uint8_t *pdu, *at = NULL;
    double         first_s = NAN, last_s = NAN;
    for (int datagram = 0; next(&header, &pdu, &log, &datagram, &at, &counters);) {
        const double t_s = exercise_clock_time(clock, 1, 3001, header.timestamp, log.datagram[datagram].capture_s);
        if (isnan(first_s)) first_s = t_s;
        CHECK_NEAR(t_s, dis_timestamp_seconds(header.timestamp), 1e-9);
        CHECK_NEAR(t_s - first_s, log.datagram[datagram].capture_s - log.datagram[0].capture_s, 2e-6);
        last_s = t_s;
    }
    CHECK_NEAR(last_s - first_s, 62.075, 5e-4);
    exercise_clock_destroy(clock);
    dis_log_close(&log);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(captures_hold_what_others_count),
        cmocka_unit_test(every_recorded_pdu_comes_back_octet_for_octet),
        cmocka_unit_test(entity_states_read_as_tshark_reads_them),
        cmocka_unit_test(shots_are_those_of_the_scenario),
        cmocka_unit_test(exercise_clock_follows_the_stamps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
