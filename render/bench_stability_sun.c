#include "render/bench_stability.h"
Status stability_sun(Bench *bench) { (void)bench; return STATUS_OK; }
