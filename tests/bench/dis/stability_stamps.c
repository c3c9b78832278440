/* tests/bench/dis/stability_stamps.c: time stamps about the hour's wrap, clocks over days, and fields at the edges of a
 * float. References: whole ticks in 64 bits, and the octets themselves. */
#include "tests/bench/suites.h"

#include "dis/pdu/decode.h"
#include "dis/clock/exercise_clock.h"
#include "dis/capture/log.h"
#include "dis/pdu/octets.h"

#include <stdlib.h>

static const double  tick_s = 3600.0 / 2147483648.0;
static const int64_t hour_ticks = INT64_C(1) << 31;

static double uniform(uint32_t stream, uint64_t index, double low, double high)
{
    return low + (high - low) * random_uniform(0x57AB, stream, 0, index);
}

/* ---- stamps --------------------------------------------------------------------------------- */

enum { near_ends = 48, special_ticks = 6 * near_ends };

/* Gives ticks about 0, the half hour and the full hour, and some in between. */
static uint32_t special_tick(int i)
{
    const int64_t about[6] = {0, hour_ticks / 2, hour_ticks, hour_ticks / 4, hour_ticks / 3, 123456789};
    return (uint32_t)((about[i / near_ends] + i % near_ends - near_ends / 2 + hour_ticks) % hour_ticks);
}

static void stamps_and_back(Bench *bench)
{
    static const double hours[] = {0, 1, 2, 23, 24, 1000, 100000, 400000};
    const int           randoms = bench_quick(bench) ? 20000 : 2000000;
    double              ticks = 0, late = 0, step_s = 0;
    for (int i = 0; i < special_ticks + randoms; i++) {
        const uint32_t k = i < special_ticks ? special_tick(i) : (uint32_t)uniform(1, (uint64_t)i, 0, 2147483648.0);
        for (uint32_t absolute = 0; absolute < 2; absolute++) {
            const uint32_t stamp = k << 1 | absolute;
            bench_worse(&ticks, (double)(dis_timestamp(dis_timestamp_seconds(stamp), absolute) >> 1) - (double)k);
            if (dis_timestamp_is_absolute(dis_timestamp(dis_timestamp_seconds(stamp), absolute)) != (bool)absolute)
                ticks = INFINITY;
        }
    }
    bench_stress(bench, "time stamp to seconds and back, about 0, 1/2 and 1 h", ticks, 1, "ticks", "the stamp");

    /* an instant as a stamp, on both sides of each full hour in floating point */
    for (size_t h = 0; h < sizeof hours / sizeof *hours; h++)
        for (int side = 0; side < 5; side++) {
            const double at_s = 3600 * hours[h];
            const double t_s[5] = {at_s, nextafter(at_s, INFINITY), nextafter(fmax(at_s, 1e-300), 0), at_s + tick_s,
                                   fabs(at_s - tick_s)};
            long double  off =
                (long double)dis_timestamp_seconds(dis_timestamp(t_s[side], true)) - fmodl(t_s[side], 3600);
            off -= 3600 * rintl(off / 3600);
            bench_worse(&late, (double)(off / tick_s));
        }
    bench_stress(bench, "an instant as a time stamp, on both sides of full hours", late, 1 + 1e-6, "ticks",
                 "long double");

    for (int i = 0; i < special_ticks; i++)
        for (int k = 0; k < special_ticks; k++) {
            const int64_t from = special_tick(i), to = special_tick(k);
            int64_t       step = (to - from + 2 * hour_ticks) % hour_ticks; /* the short way round */
            if (step >= hour_ticks / 2) step -= hour_ticks;
            const double got_s = dis_timestamp_step_s((uint32_t)from << 1, (uint32_t)to << 1 | 1);
            bench_worse(&step_s, got_s - (double)step * tick_s);
        }
    bench_stress(bench, "step from one time stamp to another, both ways over the hour", step_s, 0, "s", "64-bit ticks");
}

/* ---- exercise clock ------------------------------------------------------------------------- */

/* One sender's truth: instants in ticks since some full hour. */
typedef struct Trip {
    int64_t first_tick, step_ticks;
    double  jitter_s;            /* of capture, both ways */
    bool    absolute, backwards; /* every packet after the next one */
} Trip;

/* Worst difference between exercise time and truth over the trip, s. */
static double clock_error_s(const Trip *trip, int packets)
{
    ExerciseClock *clock = NULL;
    double         worst = 0;
    if (exercise_clock_create(&clock) != STATUS_OK) return INFINITY;
    for (int n = 0; n < packets; n++) {
        const int     sent = n > 0 && trip->backwards ? ((n - 1) ^ 1) + 1 : n;
        const int64_t tick = trip->first_tick + sent * trip->step_ticks;
        const double  truth_s = (double)tick * tick_s;
        /* the first packet ties the ruler */
        const double   capture_s = 1.7e9 + truth_s + (n ? uniform(2, (uint64_t)n, -trip->jitter_s, trip->jitter_s) : 0);
        const uint32_t stamp = (uint32_t)(tick % hour_ticks) << 1 | trip->absolute;
        /* all bits zero means no stamp: the time is then the arrival time, with its jitter */
        const double got_s = exercise_clock_time(clock, 1, 2, stamp, capture_s);
        if (stamp != 0) bench_worse(&worst, got_s - truth_s);
        else bench_worse(&worst, fmax(fabs(got_s - truth_s) - trip->jitter_s - 1e-6, 0));
    }
    exercise_clock_destroy(clock);
    return worst;
}

static void clocks(Bench *bench)
{
    const int     days = bench_quick(bench) ? 2 : 40;
    const int64_t second = (int64_t)(1 / tick_s);
    double        steady = 0, jitter = 0, silence = 0;
    for (int c = 0; c < 2 * 5; c++) {
        const int64_t about[5] = {1, hour_ticks - 1, hour_ticks - 2, hour_ticks / 2, 12345};
        const Trip    even = {about[c / 2], 7 * second + 3, 0, c & 1, false};
        const Trip    shaken = {about[c / 2], second / 60 + 1, 0.06, c & 1, true};
        const Trip    rare = {about[c / 2], 1799 * second, 0.07, c & 1, false};
        const Trip    rarer = {about[c / 2], 47 * hour_ticks + hour_ticks / 2, 0.07, c & 1, false};
        bench_worse(&steady, clock_error_s(&even, days * 86400 / 7));
        bench_worse(&jitter, clock_error_s(&shaken, days * 20000));
        bench_worse(&silence, clock_error_s(&rare, days * 48));
        bench_worse(&silence, clock_error_s(&rarer, days * 48));
    }
    /* whole ticks on both sides; capture at 1.7e9 s steps by 2.4e-7 s and only chooses the hour */
    const char *ticks = "64-bit ticks";
    bench_stress(bench, "exercise clock unwrapped over days, both kinds of stamp", steady, 1e-9, "s", ticks);
    bench_stress(bench, "the same, packets 60 ms early and late, two by two reversed", jitter, 1e-9, "s", ticks);
    bench_stress(bench, "the same, silences of 30 minutes and of 47.5 hours", silence, 1e-8, "s", ticks);
}

/* Another sender is tied by the least of its delays, which half of the PDUs have shown: how its distance from the truth
 * changes over the other half. */
static void second_sender(Bench *bench)
{
    ExerciseClock *clock = NULL;
    double         low = INFINITY, high = -INFINITY;
    const double   spread_s = 0.06;
    const int      packets = bench_quick(bench) ? 20000 : 1000000;
    if (exercise_clock_create(&clock) != STATUS_OK) return;
    for (int n = 0; n < packets; n++) {
        const double t_s = 3500 + 5.0 * n, own_s = 0.25 * tick_s + 1700 + 5.0 * n;
        exercise_clock_time(clock, 1, 1, dis_timestamp(t_s, false),
                            1e9 + t_s + uniform(3, (uint64_t)n, -0.5 * spread_s, 0.5 * spread_s));
        const uint32_t stamp = dis_timestamp(own_s, false);
        const double   heard_s = 1e9 + t_s + uniform(4, (uint64_t)n, -0.5 * spread_s, 0.5 * spread_s);
        const double   off_s = exercise_clock_time(clock, 2, 1, stamp, heard_s) - t_s;
        if (stamp == 0 || n < packets / 2) continue;
        if (!(off_s >= low)) low = off_s;
        if (!(off_s <= high)) high = off_s;
    }
    exercise_clock_destroy(clock);
    bench_stress(bench, "a second sender at another time of the hour: drift over days", high - low,
                 2 * tick_s + 3 * spread_s / (0.5 * packets), "s", "two ticks, and 3 J / N of a jitter J");
}

static void hostile_clock(Bench *bench)
{
    const double   captures[] = {0,     -0.0,  1e-310, 5e-324,   -1,        1e11, 1.0000001e11, 1e18,
                                 -1e18, 1e300, -1e308, INFINITY, -INFINITY, NAN,  1.7e9};
    ExerciseClock *clock = NULL;
    double         bad = 0;
    const int      packets = bench_quick(bench) ? 20000 : 1000000;
    if (exercise_clock_create(&clock) != STATUS_OK) return;
    for (int n = 0; n < packets; n++) {
        const uint32_t word = (uint32_t)uniform(5, (uint64_t)n, 0, 4294967296.0);
        const uint32_t stamp = n % 3 ? word : special_tick(n / 3 % special_ticks) << 1 | (uint32_t)(n & 1);
        const size_t   c = (size_t)uniform(6, (uint64_t)n, 0, sizeof captures / sizeof *captures);
        const double   t_s = exercise_clock_time(clock, (uint16_t)(word % 6000), 1, stamp, captures[c]);
        bad += !(fabs(t_s) <= 2.1e11);
    }
    exercise_clock_destroy(clock);
    bench_stress(bench, "wild stamps and capture times: times not finite", bad, 0, "times", "finite, within 2e11 s");
}

/* ---- retiming ------------------------------------------------------------------------------- */

/* Takes a capture without times of its own: 26 hours of stamps from just before the wrap. */
static void retimed_log(Bench *bench)
{
    enum { packets = 2600 };
    const int64_t step_ticks = (int64_t)(36.1 / tick_s);
    DisLog        log = {.count = packets, .datagram = calloc(packets, sizeof *log.datagram)};
    uint8_t      *octets = calloc(packets, 144);
    double        worst = 0;
    for (int n = 0; log.datagram && octets && n < packets; n++) {
        uint8_t *at = octets + 144 * (size_t)n;
        at[0] = 6, at[1] = 1, at[2] = dis_pdu_entity_state, at[3] = 1, at[13] = 1, at[15] = 1, at[17] = 1;
        dis_store_u32(at + 4, (uint32_t)((hour_ticks - 5 + n * step_ticks) % hour_ticks) << 1);
        dis_store_u16(at + 8, 144);
        log.datagram[n] = (DisDatagram){.capture_s = 1e9, .packet = (uint32_t)n + 1, .octets = 144, .bytes = at};
    }
    if (!log.datagram || !octets || !dis_log_retime(&log)) worst = INFINITY;
    for (int n = 0; log.datagram && octets && n < packets; n++)
        bench_worse(&worst, log.datagram[n].capture_s - (1e9 + (double)n * (double)step_ticks * tick_s));
    free(log.datagram);
    free(octets);
    /* the double nearest to 1e9 s and some is 6e-8 s away */
    bench_stress(bench, "a capture without times: 26 h made from its stamps", worst, 1.2e-7, "s", "64-bit ticks");
}

static void unix_times(Bench *bench)
{
    double    off_s = 0, back = 0;
    const int randoms = bench_quick(bench) ? 20000 : 1000000;
    for (int n = 0; n < randoms; n++) {
        const int64_t about[5] = {0, INT64_C(999999999), INT64_C(1700000000) * 1000000000, (INT64_C(1) << 53),
                                  INT64_C(8899999999) * 1000000000};
        const int64_t ns = n < 500 ? about[n / 100] + n % 100 : (int64_t)uniform(7, (uint64_t)n, 0, 8.9e18);
        const double  unix_s = dis_unix_s(ns);
        bench_worse(&off_s, (double)((long double)unix_s - (long double)ns / 1000000000.0L));
        if (dis_unix_s(ns + 1) < unix_s) back++;
        const int64_t until = dis_unix_ns_until(unix_s);
        if (until < ns || dis_unix_s(until) > unix_s || dis_unix_s(until + 1) <= unix_s) back++;
    }
    /* at 8.9e9 s a double steps by 1.9 us: the limit is half of that, and a rounding of the sum's smaller term */
    bench_stress(bench, "Unix nanoseconds to seconds, 1970 .. 2255", off_s, 1e-6, "s", "long double");
    bench_stress(bench, "the same: steps back in time, and inverses that miss", back, 0, "instants",
                 "order of whole numbers");
}

/* ---- octets --------------------------------------------------------------------------------- */

static const uint32_t special_f32[] = {0x00000000, 0x80000000, 0x00000001, 0x80000001, 0x007FFFFF,
                                       0x00800000, 0x7F7FFFFF, 0xFF7FFFFF, 0x7F800000, 0xFF800000,
                                       0x7FC00000, 0xFFC00000, 0x7F800001, 0x7FBFFFFF};
static const uint64_t special_f64[] = {0,
                                       UINT64_C(1) << 63,
                                       1,
                                       (UINT64_C(1) << 63) | 1,
                                       0x000FFFFFFFFFFFFF,
                                       0x0010000000000000,
                                       0x7FEFFFFFFFFFFFFF,
                                       0xFFEFFFFFFFFFFFFF,
                                       0x7FF0000000000000,
                                       0xFFF0000000000000,
                                       0x7FF8000000000000,
                                       0x7FF0000000000001,
                                       0x7FF7FFFFFFFFFFFF};

static double lost_octets(uint8_t *pdu, size_t octets)
{
    static DisPdu decoded;
    uint8_t       again[512];
    double        lost = 0;
    const size_t  written =
        dis_decode(&decoded, pdu, octets) == STATUS_OK ? dis_encode(again, sizeof again, &decoded) : 0;
    if (written != octets) return INFINITY;
    for (size_t k = 0; k < octets; k++) lost += again[k] != pdu[k];
    return lost;
}

/* Every special number at every field that is a float, and at every other place as well. */
static void fields(Bench *bench)
{
    static const struct {
        uint8_t type;
        size_t  fixed, count_at;
    } kinds[4] = {{dis_pdu_entity_state, 144, 19},
                  {dis_pdu_entity_state_update, 72, 19},
                  {dis_pdu_fire, 96, 0},
                  {dis_pdu_detonation, 104, 101}};
    double lost = 0;
    for (size_t kind = 0; kind < 4; kind++) {
        const size_t octets = kinds[kind].fixed + (kinds[kind].count_at ? 32 : 0);
        for (size_t at = dis_header_octets; at + 4 <= octets; at += 4)
            for (size_t s = 0; s < sizeof special_f32 / sizeof *special_f32 + sizeof special_f64 / sizeof *special_f64;
                 s++) {
                uint8_t      pdu[512] = {7, 1, kinds[kind].type, 1};
                const size_t singles = sizeof special_f32 / sizeof *special_f32;
                if (s < singles) {
                    dis_store_u32(pdu + at, special_f32[s]);
                } else if (at + 8 <= octets) {
                    dis_store_u32(pdu + at, (uint32_t)(special_f64[s - singles] >> 32));
                    dis_store_u32(pdu + at + 4, (uint32_t)special_f64[s - singles]);
                }
                dis_store_u16(pdu + 8, (uint16_t)octets);
                if (kinds[kind].count_at) pdu[kinds[kind].count_at] = 2;
                lost += lost_octets(pdu, octets);
            }
    }
    bench_stress(bench, "denormals, infinities, NaNs at every field: decode, encode", lost, 0, "octets",
                 "of those, encoded again");
}

Status bench_stability_stamps(Bench *bench)
{
    stamps_and_back(bench);
    clocks(bench);
    second_sender(bench);
    hostile_clock(bench);
    retimed_log(bench);
    unix_times(bench);
    fields(bench);
    return STATUS_OK;
}
