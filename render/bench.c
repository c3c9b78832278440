#include "render/bench.h"

#include "render/bench_stability.h"

const BenchSuite render_benches[] = {
    {.name = "stability", .help = "rays, light and pictures under stress: needles, far origins, 1 K, 200 km, 8192 px",
        .run = bench_stability},
};
const int render_bench_count = sizeof render_benches / sizeof *render_benches;
