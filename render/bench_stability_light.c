#include "render/bench_stability.h"
Status stability_light(Bench *bench) { (void)bench; return STATUS_OK; }
