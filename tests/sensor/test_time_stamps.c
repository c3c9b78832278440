/* Senders whose time stamps are no clock, through the player and the entity table: where a mover of 250 m/s is shown in
 * every frame against where it was.
 *
 * The judge is the mover's own line: it reports its true position at known instants, so nothing of the clock enters the
 * truth. What may remain is the arrival jitter that the clock allows before it doubts stamps, times the speed. */
#include "tests/check.h"

#include "sensor/node/player/player.h"
#include "tests/sensor/open_catalog.h"

#include <stdio.h>
#include <stdlib.h>

enum { most_reports = 2000, octets_most = 160 };

static const double speed_mps = 250, span_s = 60, frame_s = 0.05, sim0_s = 3570, unix0_s = 1.75e9 + 0.375;
static const double tick_s = 3600.0 / 2147483648.0;

typedef enum Kind {
    STAMP_ZERO,
    STAMP_CONSTANT,
    STAMP_CONSTANT_ABSOLUTE,
    STAMP_MS,
    STAMP_US,
    STAMP_US_SHIFTED,
    STAMP_UNIX_S,
    STAMP_COUNT,
    STAMP_COUNT_PER_ENTITY,
    STAMP_RANDOM,
    STAMP_SWAPPED,
    STAMP_HALF,
    STAMP_DOUBLE,
    STAMP_RELATIVE,
    STAMP_ABSOLUTE,
    STAMP_JITTER,
    KIND_COUNT
} Kind;

static const char *const kind_name[KIND_COUNT] = {"zero",
                                                  "constant",
                                                  "constant, absolute",
                                                  "milliseconds",
                                                  "microseconds",
                                                  "microseconds, shifted",
                                                  "Unix seconds",
                                                  "counter of PDUs",
                                                  "counter of an entity's PDUs",
                                                  "random",
                                                  "octets swapped",
                                                  "half rate",
                                                  "double rate",
                                                  "relative",
                                                  "absolute",
                                                  "relative, +-50 ms of jitter"};

static uint8_t     bytes[2 * most_reports][octets_most];
static DisDatagram datagram[2 * most_reports];

static uint32_t good_stamp(double sim_s, bool absolute)
{
    return (uint32_t)(uint64_t)llround(fmod(sim_s, 3600) / tick_s) << 1 | absolute;
}

/* The k-th PDU of the sender, the n-th of its entity, at sim_s. */
static uint32_t stamp_of(Kind kind, double sim_s, int k, int n, int entity)
{
    const double passed_s = sim_s - sim0_s;
    switch (kind) {
    case STAMP_ZERO:
        return 0;
    case STAMP_CONSTANT:
        return 0x6A09E666;
    case STAMP_CONSTANT_ABSOLUTE:
        return 0x6A09E667;
    case STAMP_MS:
        return (uint32_t)llround(1e3 * (passed_s + 77));
    case STAMP_US:
        return (uint32_t)llround(1e6 * (passed_s + 77));
    case STAMP_US_SHIFTED:
        return (uint32_t)llround(1e6 * (passed_s + 77)) << 1;
    case STAMP_UNIX_S:
        return (uint32_t)floor(unix0_s + passed_s);
    case STAMP_COUNT:
        return (uint32_t)k + 1;
    case STAMP_COUNT_PER_ENTITY:
        return (uint32_t)n + 1 + 1000 * (uint32_t)entity;
    case STAMP_RANDOM:
        return (uint32_t)(4294967296.0 * random_uniform(9, 1, 0, (uint64_t)k));
    case STAMP_SWAPPED:
        return __builtin_bswap32(good_stamp(sim_s, false));
    case STAMP_HALF:
        return good_stamp(sim0_s + 0.5 * passed_s, false);
    case STAMP_DOUBLE:
        return good_stamp(sim0_s + 2 * passed_s, false);
    case STAMP_ABSOLUTE:
        return good_stamp(sim_s, true);
    case STAMP_RELATIVE:
    case STAMP_JITTER:
    case KIND_COUNT:
        break;
    }
    return good_stamp(sim_s, false);
}

static const double top_m = 6383137;

/* One sender with a mover (entity 1) and one that stands (entity 2), the latter half a heartbeat later. beside:
 * another, proper, sender is heard first. */
static DisLog make_log(Kind kind, double heartbeat_s, bool beside)
{
    int count = 0, k = 0;
    if (beside) {
        DisEntityState other = {.header = {.version = 7,
                                           .exercise = 1,
                                           .type = dis_pdu_entity_state,
                                           .family = 1,
                                           .timestamp = good_stamp(sim0_s + 1234 - 0.4, false)},
                                .id = {2, 9, 1},
                                .type = {1, 1, 222, 1, 1, 1, 0},
                                .p_ecef = {6378137, 0, 900},
                                .dead_reckoning = 1};
        const size_t   octets = dis_encode_entity_state(bytes[count], octets_most, &other);
        datagram[count] = (DisDatagram){.capture_s = unix0_s - 0.4, .octets = (uint32_t)octets, .bytes = bytes[count]};
        count++;
    }
    for (int n = 0; n * heartbeat_s <= span_s; n++)
        for (int entity = 1; entity <= 2; entity++, k++, count++) {
            const double   passed_s = (n + 0.5 * (entity - 1)) * heartbeat_s;
            const double   jitter_s = kind == STAMP_JITTER ? 0.1 * random_uniform(9, 2, 0, (uint64_t)k) - 0.05 : 0;
            DisEntityState pdu = {.header = {.version = 7,
                                             .exercise = 1,
                                             .type = dis_pdu_entity_state,
                                             .family = 1,
                                             .timestamp = stamp_of(kind, sim0_s + passed_s, k, n, entity)},
                                  .id = {1, 1, (uint16_t)entity},
                                  .type = {1, 2, 222, 1, 1, 1, 0},
                                  .p_ecef = {top_m, entity == 1 ? speed_mps * passed_s : 5000, 0},
                                  .velocity_mps = {0, entity == 1 ? (float)speed_mps : 0, 0},
                                  .dead_reckoning = 2};
            const size_t   octets = dis_encode_entity_state(bytes[count], octets_most, &pdu);
            CHECK(octets > 0 && count < 2 * most_reports);
            datagram[count] = (DisDatagram){
                .capture_s = unix0_s + passed_s + jitter_s, .octets = (uint32_t)octets, .bytes = bytes[count]};
        }
    return (DisLog){.count = count, .datagram = datagram};
}

/* A player of the log, and a table for it. */
static void start(Player **player, EntityTable **table, const DisLog *log, bool causal)
{
    const EntityTableConfig config = entity_table_default_config();
    assert_int_equal(entity_table_create(table, &config, catalog), STATUS_OK);
    assert_int_equal(player_create(player, -1, causal), STATUS_OK);
    assert_int_equal(player_add_log(*player, log), STATUS_OK);
}

/* Worst distance of the mover from its line over the frames from its sender's second report on, m; frames after the
 * last report left out. */
static double worst_m(Kind kind, double heartbeat_s, bool beside, bool causal)
{
    const DisLog log = make_log(kind, heartbeat_s, beside);
    EntityTable *table = NULL;
    Player      *player = NULL;
    double       worst = 0;
    start(&player, &table, &log, causal);
    for (int f = 0; f * frame_s < span_s; f++) {
        const double   passed_s = 0.5 * heartbeat_s + 0.06 + f * frame_s;
        const double   t_s = player_time_s(player, unix0_s + passed_s);
        SnapshotEntity e;
        if (passed_s > span_s) break;
        player_feed(player, table, t_s);
        const EntityHandle handle = entity_table_find(table, (DisEntityId){1, 1, 1});
        if (!entity_table_pose(&e, table, handle, t_s)) {
            worst = INFINITY;
            break;
        }
        worst = fmax(worst, fabs(e.p_ecef[1] - speed_mps * passed_s));
    }
    player_destroy(player);
    entity_table_destroy(table);
    return worst;
}

/* The dead-reckoning threshold of 1 m, and the speed times what the clock allows as jitter of arrivals: nothing where
 * the stamps stand still or jump, dis/clock/exercise_clock.h's 0.15 s where they run, but at another rate. */
static void a_mover_stays_where_it_is(void **state)
{
    (void)state;
    static const double heartbeat_s[] = {0.12, 0.2, 1, 5};
    const bool          show = getenv("PITVIPER_SHOW") != NULL;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const bool   runs = kind == STAMP_US || kind == STAMP_US_SHIFTED || kind == STAMP_HALF || kind == STAMP_DOUBLE;
        const double allowed_s = runs ? 0.15 : kind == STAMP_JITTER ? 0.1 : 0;
        if (show) printf("%-28s", kind_name[kind]);
        for (int h = 0; h < 4; h++)
            for (int way = 0; way < 4; way++) {
                const double m = worst_m((Kind)kind, heartbeat_s[h], way & 1, way & 2);
                if (show) printf(" %8.1f%s", m, way == 3 ? " |" : "");
                else CHECK_NEAR(m, 0, 1 + speed_mps * allowed_s);
            }
        if (show) printf("\n");
    }
}

/* ---- jitter ------------------------------------------------------------------------------------ */

/* Two senders with exact stamps, their movers side by side on lines, 5 Hz; arrivals late by up to jitter_s, so in
 * another order; one in five lost. The judge: where each is by its own sender's clock, sender 1's at its first report
 * received. */
typedef struct Jitter {
    double jitter_s, offset_s; /* offset: of sender 2's clock */
    bool   absolute;
    int    copies;     /* of every datagram, later by 0.3 s each */
    bool   first_late; /* the first report too: the judge's zero is then known as the others are */
} Jitter;

typedef struct Sent {
    double   capture_s;
    uint16_t sender;
    double   passed_s, late_s;
} Sent;

static int by_arrival(const void *a, const void *b)
{
    const Sent *p = a, *q = b;
    return p->capture_s < q->capture_s ? -1 : p->capture_s > q->capture_s;
}

static const double fast_mps = 200, reports_hz = 5;

static Sent   sent[2 * most_reports]; /* of the log made last */
static DisLog make_jittery(const Jitter *j, uint32_t seed)
{
    int count = 0;
    for (int n = 0; n / reports_hz <= span_s; n++)
        for (uint16_t sender = 1; sender <= 2; sender++)
            for (int c = 0; c < j->copies; c++) {
                const uint64_t k = (uint64_t)(4 * n + 2 * (sender - 1) + c);
                const double   passed_s = n / reports_hz + 0.05 * (sender - 1);
                if (n + c > 0 && random_uniform(seed, 1, 0, k) < 0.2) continue;
                const double late_s = j->jitter_s * random_uniform(seed, 2, 0, k) + 0.3 * c;
                sent[count++] =
                    (Sent){unix0_s + passed_s + late_s - (n + c == 0 && sender == 1 && !j->first_late ? late_s : 0),
                           sender, passed_s, late_s};
            }
    qsort(sent, (size_t)count, sizeof *sent, by_arrival);
    CHECK(count < 2 * most_reports);
    for (int k = 0; k < count; k++) {
        const double         clock_s = sim0_s + sent[k].passed_s + (sent[k].sender == 2 ? j->offset_s : 0);
        const DisEntityState pdu = {.header = {.version = 7,
                                               .exercise = 1,
                                               .type = dis_pdu_entity_state,
                                               .family = 1,
                                               .timestamp = good_stamp(clock_s, j->absolute)},
                                    .id = {sent[k].sender, 1, 1},
                                    .type = {1, 2, 222, 1, 1, 1, 0},
                                    .p_ecef = {top_m, fast_mps * sent[k].passed_s, 100.0 * sent[k].sender},
                                    .velocity_mps = {0, (float)fast_mps, 0},
                                    .dead_reckoning = 2};
        const size_t         octets = dis_encode_entity_state(bytes[k], octets_most, &pdu);
        datagram[k] = (DisDatagram){.capture_s = sent[k].capture_s, .octets = (uint32_t)octets, .bytes = bytes[k]};
    }
    return (DisLog){.count = count, .datagram = datagram};
}

/* of[s]: worst distance of sender s + 1's mover from its line from from_s on; leap: the farthest that one moves between
 * two frames beside its speed. */
typedef struct Missed {
    double   of[2], share, leap; /* share: of sender 2, in units of v J / N + 0.03 m, N its PDUs so far */
    uint64_t by_arrival;
} Missed;

static Missed follow_jittery(const Jitter *j, uint32_t seed, bool causal, double from_s)
{
    const DisLog log = make_jittery(j, seed);
    EntityTable *table = NULL;
    Player      *player = NULL;
    Missed       missed = {0};
    double       before[2] = {NAN, NAN};
    start(&player, &table, &log, causal);
    for (double t_s = sim0_s + 0.01; t_s < sim0_s + span_s - 5; t_s += frame_s) {
        player_feed(player, table, t_s);
        for (int s = 0; s < 2; s++) {
            SnapshotEntity e;
            if (!entity_table_pose(&e, table, entity_table_find(table, (DisEntityId){(uint16_t)(s + 1), 1, 1}), t_s))
                continue;
            const double off_m = e.p_ecef[1] - fast_mps * (t_s - sim0_s), n = 0.8 * reports_hz * (t_s - sim0_s);
            if (t_s - sim0_s >= from_s) {
                missed.of[s] = fmax(missed.of[s], fabs(off_m));
                if (s) missed.share = fmax(missed.share, fabs(off_m) / (fast_mps * j->jitter_s / n + 0.03));
                if (isfinite(before[s])) missed.leap = fmax(missed.leap, fabs(off_m - before[s]));
            }
            before[s] = off_m;
        }
    }
    missed.by_arrival = player_counters(player)->stamps_doubted;
    player_destroy(player);
    entity_table_destroy(table);
    return missed;
}

/* A sender against its own stamps: 0.1 m, whatever the jitter, over the hour too. Between two with clocks of their own
 * the offset is known to some J / N: live after N PDUs, of a recording after all of them; and it comes without a leap:
 * within half of what the movers fly in a frame. Senders of absolute time have no offset. */
static void jitter_of_seconds_moves_nothing(void **state)
{
    (void)state;
    static const double jitter_s[] = {0, 0.25, 0.4, 1, 2};
    const bool          show = getenv("PITVIPER_SHOW") != NULL;
    for (int k = 0; k < 5; k++)
        for (int way = 0; way < 4; way++)
            for (uint32_t seed = 1; seed <= 6; seed++) {
                const Jitter j = {jitter_s[k], way & 1 ? 0 : 777.7, way & 1, 1 + (seed == 6), false};
                const bool   causal = way & 2;
                const Missed m = follow_jittery(&j, seed, causal, causal ? 10 : 0);
                if (show) {
                    printf("J %.2f %s %s: own %.3f m, other %.3f m, %.2f J/N, leap %.3f m, %d by arrival\n", j.jitter_s,
                           j.absolute ? "absolute" : "relative", causal ? "causal" : "whole", m.of[0], m.of[1], m.share,
                           m.leap, (int)m.by_arrival);
                    continue;
                }
                CHECK_NEAR(m.of[0], 0, 0.1);
                CHECK_NEAR(m.of[1], 0,
                           j.absolute ? 0.1
                           : causal   ? INFINITY
                                      : 3 * fast_mps * j.jitter_s / (0.8 * 300) + 0.1);
                if (causal && !j.absolute) CHECK_NEAR(m.share, 0, 7); /* of 24 runs, at their worst: exp(-7) */
                CHECK_NEAR(m.leap, 0, 0.5 * fast_mps * frame_s + 0.1);
                CHECK(m.by_arrival == 0);
            }
}

/* ---- what can be known of an offset ------------------------------------------------------------- */

/* How much sender 2's least delay exceeds sender 1's, of what arrived by passed_s, and its mean delay. */
typedef struct Delays {
    double least_apart_s, mean_apart_s;
    int    count; /* of the sender with fewer */
} Delays;

static Delays delays_until(const DisLog *log, double capture_s)
{
    double least_s[2] = {INFINITY, INFINITY}, sum_s[2] = {0};
    int    heard[2] = {0};
    for (int k = 0; k < log->count && sent[k].capture_s <= capture_s; k++) {
        const int s = sent[k].sender - 1;
        least_s[s] = fmin(least_s[s], sent[k].late_s);
        sum_s[s] += sent[k].late_s;
        heard[s]++;
    }
    return (Delays){least_s[1] - least_s[0], sum_s[1] / heard[1] - sum_s[0] / heard[0],
                    heard[0] < heard[1] ? heard[0] : heard[1]};
}

/* Two senders with relative stamps, live, 50 seeds. All that tells their offset is that no delay is negative, so it
 * cannot be known better than the difference of their least delays. Those of N uniform delays up to J are exponential
 * with mean J / N: the difference has an rms of sqrt(2) J / N, and exceeds 3 J / N in exp(-3), 5 %, of pairs. The judge
 * knows the delays: in every run the pose comes to where they say, and over the runs rms and share are those. The twin,
 * mean delays, is worse. */
static void an_offset_is_known_as_well_as_the_least_delays(void **state)
{
    (void)state;
    enum { seeds = 50, times = 4 };
    static const double at_s[times] = {12, 20, 35, 50};
    const bool          show = getenv("PITVIPER_SHOW") != NULL;
    double              sum2[times] = {0}, worst_m[times] = {0}, mean2[times] = {0};
    int                 beyond[times] = {0};
    for (uint32_t seed = 1; seed <= seeds; seed++) {
        const Jitter j = {.jitter_s = 1, .offset_s = 777.7, .copies = 1, .first_late = true};
        const DisLog log = make_jittery(&j, seed);
        EntityTable *table = NULL;
        Player      *player = NULL;
        int          next = 0;
        start(&player, &table, &log, true);
        const double zero_s = player_time_s(player, sent[0].capture_s);
        for (double t_s = zero_s; next < times; t_s += frame_s) {
            const double   passed_s = t_s - zero_s;
            SnapshotEntity e[2];
            player_feed(player, table, t_s);
            bool both = true;
            for (uint16_t s = 0; s < 2; s++)
                both &= entity_table_pose(&e[s], table,
                                          entity_table_find(table, (DisEntityId){(uint16_t)(s + 1), 1, 1}), t_s);
            if (passed_s < at_s[next]) continue;
            CHECK(both);
            const Delays d = delays_until(&log, sent[0].capture_s + passed_s);
            const double off_m = e[0].p_ecef[1] - e[1].p_ecef[1], unit_m = fast_mps * j.jitter_s / d.count;
            sum2[next] += off_m / unit_m * (off_m / unit_m) / seeds;
            mean2[next] += pow(fast_mps * d.mean_apart_s / unit_m, 2) / seeds;
            beyond[next] += fabs(off_m) > 3 * unit_m + 0.1;
            worst_m[next] = fmax(worst_m[next], fabs(off_m - fast_mps * d.least_apart_s));
            next++;
        }
        player_destroy(player);
        entity_table_destroy(table);
    }
    for (int i = 0; i < times; i++) {
        if (show)
            printf(
                "after %2.0f s: rms %.2f J/N, %d of %d beyond 3 J/N + 0.1 m, %.3f m from the least delays; by the mean %.2f J/N\n",
                at_s[i], sqrt(sum2[i]), beyond[i], seeds, worst_m[i], sqrt(mean2[i]));
        CHECK_NEAR(sqrt(sum2[i]), sqrt(2), 0.7); /* of 50: 0.23 */
        CHECK(beyond[i] <= 8);                   /* more than that of 50 by chance: 1 in 5000 */
        CHECK(sqrt(mean2[i]) > 1.8 * sqrt(sum2[i]));
    }
    CHECK_NEAR(worst_m[times - 1], 0, 0.1); /* earlier poses are still coming round */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mover_stays_where_it_is),
        cmocka_unit_test(jitter_of_seconds_moves_nothing),
        cmocka_unit_test(an_offset_is_known_as_well_as_the_least_delays),
    };
    return cmocka_run_group_tests(tests, open_catalog, close_catalog);
}
