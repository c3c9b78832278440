#include "render/bench_stability.h"
Status stability_pictures(Bench *bench) { (void)bench; return STATUS_OK; }
