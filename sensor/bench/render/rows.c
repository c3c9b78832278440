/* sensor/bench/render/rows.c: the benchmark suites of rays, air and light. */
#include "sensor/bench/render/rows.h"

#include "sensor/bench/render/stability.h"


const BenchSuite render_benches[] = {
    {.name = "precision", .help = "black bodies, light on surfaces, smoke", .run = bench_precision_light},
    {.name = "precision", .help = "a frame's tables of the air and the sky", .run = bench_precision_air},
    {.name = "precision", .help = "rays against ground and parts", .run = bench_precision_trace},
    {.name = "precision", .help = "the ground's heat: steps, elements, slopes, shade", .run = bench_precision_heat},
    {.name = "precision", .help = "a vehicle's heat: steps", .run = bench_precision_network},
    {.name = "precision", .help = "a vehicle's heat: patches", .run = bench_precision_patches},
    {.name = "precision", .help = "hot gas: grey gases", .run = bench_precision_gas},
    {.name = "precision", .help = "the radar field of a target: tubes, mirrors, edges, reuse", .run = bench_precision_radar},
    {.name = "speed", .help = "a step of a vehicle's heat", .run = bench_speed_network},
    {.name = "crowd", .help = "frames in a world of 100,000 entities, and of tanks stacked in one place",
     .run = bench_speed_crowd},
    {.name = "stability", .help = "rays, light and pictures under stress: needles, far origins, 1 K, 200 km, 8192 px", .run = bench_stability},
};
const int render_bench_count = sizeof render_benches / sizeof *render_benches;
