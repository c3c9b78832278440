#include "entities/bench_stability.h"
Status entities_bench_stability_inputs(Bench *bench) { (void)bench; return STATUS_OK; }
