/* sensor/bench/turn.h: shared by the suites that plot time against error. */
#ifndef SENSOR_BENCH_TURN_H
#define SENSOR_BENCH_TURN_H

#include "sensor/bench/bench.h"

enum { bench_settings_max = 16 };

static inline bool bench_default_dominated(const BenchTunable *knob, const BenchSetting *point, int count)
{
    for (int k = 0; k < count; k++)
        if (point[k].is_default) return !bench_on_front(knob, point, count, k);
    return false;
}

/* Times the settings of a tunable in turn, work[k] being point[k]'s, and passes them on. A default that would fail
 * gets twice as many rounds first: a load on the machine should not decide. */
static inline void bench_tunable(Bench *bench, const BenchTunable *knob, const BenchWork *work, BenchSetting *point, int count)
{
    BenchTime time[bench_settings_max];
    bench_progress(bench, knob->name);
    bench_time(time, bench, work, count);
    for (int k = 0; k < count; k++) point[k].time = time[k];
    if (!bench_quick(bench) && bench_default_dominated(knob, point, count)) {
        bench_time_more(time, bench, work, count);
        for (int k = 0; k < count; k++) point[k].time = time[k];
    }
    bench_knob(bench, knob, point, count);
}

/* For qsort of doubles. */
static inline int bench_by_value(const void *pa, const void *pb)
{
    const double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

/* A number that contributes to a largest error; NaN propagates. */
static inline void bench_worst(double *worst, double error)
{
    if (!(error <= *worst)) *worst = error;
}

#endif
