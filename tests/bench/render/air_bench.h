/* tests/bench/render/air_bench.h: what the benches of the air stand on: a model, its black bodies, an arena. */
#ifndef TESTS_BENCH_RENDER_AIR_BENCH_H
#define TESTS_BENCH_RENDER_AIR_BENCH_H

#include "render/air/air.h"

typedef struct AirBench {
    Atmosphere  *atmosphere;
    PlanckTable *planck[2]; /* mwir, lwir */
    Arena       *arena;
} AirBench;

static inline Status air_bench_open(AirBench *out)
{
    *out = (AirBench){.arena = arena_create()};
    Status status = out->arena ? atmosphere_open(&out->atmosphere, "us1976") : STATUS_NO_MEMORY;
    for (int k = 0; k < 2 && status == STATUS_OK; k++) {
        double low_m, high_m;
        air_band_edges(&low_m, &high_m, (AirBand)(AIR_MWIR + k));
        status = planck_table_create(&out->planck[k], low_m, high_m);
    }
    return status;
}

/* Also after a failure. */
static inline void air_bench_close(AirBench *bench)
{
    for (int k = 0; k < 2; k++) planck_table_destroy(bench->planck[k]);
    atmosphere_close(bench->atmosphere);
    arena_destroy(bench->arena);
}

#endif
