#include "sensor/bench.h"

#include "sensor/bench/speed.h"
#include "sensor/bench/stability.h"

const BenchSuite sensor_benches[] = {
    {.name = "speed", .options = "size=WxH: 720x486,ground=KMxKM: 12x16; of posts 1 m apart,model=FILE: the target that fills "
     "the picture; models/brlcad/ktank.obj of the reference data, else the built-in tank",
     .help = "frames over a large ground with twenty vehicles: whole, by stage, against the tracer alone", .run = bench_speed},
    {.name = "stability", .help = "detectors of 1 to 16 bits, displays without contrast, threads that agree",
     .run = sensor_bench_stability},
};
const int sensor_bench_count = sizeof sensor_benches / sizeof *sensor_benches;
