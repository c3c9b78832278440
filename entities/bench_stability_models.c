#include "entities/bench_stability.h"
Status entities_bench_stability_models(Bench *bench) { (void)bench; return STATUS_OK; }
