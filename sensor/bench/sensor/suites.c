/* sensor/bench/sensor/suites.c: all suites of `pitviper bench`, in the order of the libraries. */
#include "sensor/bench/sensor/suites.h"

#include "sensor/bench/dis/rows.h"
#include "sensor/bench/entities/rows.h"
#include "sensor/bench/render/rows.h"
#include "sensor/bench/sensor/rows.h"
#include "sensor/bench/terrain/rows.h"

const BenchSuite *bench_next_suite(size_t state[2])
{
    static const struct { const BenchSuite *first; const int *count; } list[] = {
        {dis_benches, &dis_bench_count},
        {terrain_benches, &terrain_bench_count},
        {entities_benches, &entities_bench_count},
        {render_benches, &render_bench_count},
        {sensor_benches, &sensor_bench_count},
    };
    for (; state[0] < sizeof list / sizeof *list; state[0]++, state[1] = 0)
        if (state[1] < (size_t)*list[state[0]].count) return list[state[0]].first + state[1]++;
    return NULL;
}
