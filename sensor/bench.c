#include "sensor/bench.h"

#include "sensor/bench/quality.h"
#include "sensor/bench/speed.h"

const BenchSuite sensor_benches[] = {
    {.name = "speed", .options = "size=WxH: 720x486,ground=KMxKM: 12x16; of posts 1 m apart,model=FILE: the target that fills "
     "the picture; models/brlcad/ktank.obj of the reference data, else the built-in tank",
     .help = "frames over a large ground with twenty vehicles: whole, by stage, against the tracer alone", .run = bench_speed},
    {.name = "quality", .options = "table=FILE: written too; quality.* picks from etc/quality.csv",
     .help = "rays a pixel, at edges and over small targets together: time against error, what quality.* picks from",
     .run = bench_quality},
};
const int sensor_bench_count = sizeof sensor_benches / sizeof *sensor_benches;
