/* sensor/bench/terrain/rows.c: the suites of earth, elevation and landscape. */
#include "sensor/bench/terrain/rows.h"

#include "sensor/bench/terrain/stability.h"

const BenchSuite terrain_benches[] = {
    {.name = "precision", .help = "places, the geoid, the sun", .run = bench_precision_earth},
    {.name = "precision", .help = "posts, detail", .run = bench_precision_land},
    {.name = "stability", .help = "places from pole to pole, frames, sun, geoid; grids with cliffs, spikes and voids",
     .run = terrain_bench_stability},
};
const int terrain_bench_count = sizeof terrain_benches / sizeof *terrain_benches;
