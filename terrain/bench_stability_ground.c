#include "terrain/bench_stability.h"
Status terrain_bench_stability_ground(Bench *bench) { (void)bench; return STATUS_OK; }
