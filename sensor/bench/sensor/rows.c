/* sensor/bench/sensor/rows.c: the suites of whole frames, detectors and the live node. */
#include "sensor/bench/sensor/rows.h"

#include "sensor/bench/sensor/network.h"
#include "sensor/bench/sensor/precision.h"
#include "sensor/bench/sensor/quality.h"
#include "sensor/bench/sensor/skip.h"
#include "sensor/bench/sensor/speed.h"
#include "sensor/bench/sensor/stability.h"
#include "sensor/bench/sensor/woods.h"

const BenchSuite sensor_benches[] = {
    {.name = "speed",
     .options = "size=WxH: 720x486,ground=KMxKM: 12x16; of posts 1 m apart,model=FILE: fills the picture; "
                "models/brlcad/ktank.obj of the reference data or else the built-in tank,"
                "bands=optical|radar: pictures of all bands or the radar with phase alone; both",
     .help = "frames over a large ground with twenty vehicles: whole, by stage, against the tracer alone; set-up, a sweep",
     .run = bench_speed,
     .check = bench_speed_check,
     .reads =
         "Frames are whole, planes of truth and all, handed over in memory; stages are of one thread, where they add "
         "up to the frame (bars: their share), and `rays alone` is the least that a frame could take. Rows of the "
         "radar are of one with phase: its targets, and whole updates."},
    {.name = "speed",
     .help = "a 94 GHz seeker's radar: a target in a new bin of aspect and in one at hand, ten of them with clutter; "
             "what the ground's mirror costs",
     .run = bench_speed_radar},
    {.name = "woods",
     .options = "trees=N: at most; 3000000,level1-px=PX: plants lower than this are simplified; 24",
     .help = "frames of three million trees over 192 M posts, in full detail and with two levels of it",
     .run = bench_woods,
     .check = bench_woods_check,
     .reads = "Frames are whole, of all bands, one ray a pixel but for rows of the default quality. Errors are against 16 rays in every pixel in full "
              "detail; of two levels also by the same 16 rays in both, where no sampling is part of it."},
    {.name = "network", .help = "a live node, an exercise sent to it: what is lost, how late it is", .run = bench_live},
    {.name = "network",
     .help = "a live node with shared memory and video: when frames are there, how many are left out",
     .run = bench_publish,
     .reads = "Times are from the node's own latency ledger, from the end of rendering; error: 99 % of the frames."},
    {.name = "skip",
     .help = "what each exact skip saves, in the scene where it saves most",
     .run = bench_skip,
     .reads = "The time is of a frame with the skip, the ratio says how much longer it takes without; the planes are "
              "the same to the bit, or the row fails."},
    {.name = "precision",
     .help = "frames, models and detectors: settings, what each costs and how wrong it is",
     .run = bench_precision},
    {.name = "stability",
     .help = "detectors of 1 to 16 bits, displays without contrast, threads that agree",
     .run = sensor_bench_stability},
    {.name = "quality",
     .options = "table=FILE: written too; quality.* picks from etc/quality.csv",
     .help = "rays a pixel, at edges and over small targets together: time against error on bare ground and in woods, what quality.* picks from",
     .run = bench_quality,
     .check = bench_quality_check},
};
const int sensor_bench_count = sizeof sensor_benches / sizeof *sensor_benches;
