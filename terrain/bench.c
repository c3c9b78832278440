#include "terrain/bench.h"

const BenchSuite terrain_benches[] = {
    {.name = "precision", .help = "places, the geoid, the sun", .run = bench_precision_earth},
    {.name = "precision", .help = "posts, textures", .run = bench_precision_land},
};
const int terrain_bench_count = sizeof terrain_benches / sizeof *terrain_benches;
