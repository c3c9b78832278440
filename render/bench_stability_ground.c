#include "render/bench_stability.h"
Status stability_ground(Bench *bench) { (void)bench; return STATUS_OK; }
