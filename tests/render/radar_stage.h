/* tests/render/radar_stage.h: a shape or model as a radar target, its field by one call, and figures against a
 * reference. */
#ifndef TESTS_RENDER_RADAR_STAGE_H
#define TESTS_RENDER_RADAR_STAGE_H

#include "tests/check.h"

#include "render/scattering/field/total_field.h"
#include "render/scattering/field/radar_model.h"

typedef struct RadarStage {
    Model        model;
    RadarTarget *target;
    Pool        *pool;
    TubeHits     hits;
    TubeConfig   config;
} RadarStage;

static inline void stage_target(RadarStage *s, double frequency_hz)
{
    if (radar_target_create(&s->target, &s->model, NULL, "avx2") != STATUS_OK) fail_msg("no target");
    if (pool_create(&s->pool, 2) != STATUS_OK) fail_msg("no pool");
    s->config = tubes_default_config(frequency_hz);
}

static inline void stage_open(RadarStage *s, const char *shape, double frequency_hz)
{
    *s = (RadarStage){0};
    if (radar_shape_build(&s->model, shape, radar_sag_m(frequency_hz)) != STATUS_OK)
        fail_msg("%s does not build", shape);
    stage_target(s, frequency_hz);
}

static inline void stage_close(RadarStage *s)
{
    tubes_free(&s->hits);
    radar_target_destroy(s->target);
    pool_destroy(s->pool);
    model_destroy(&s->model);
}

static inline ScatterAntenna antenna_at(double az_deg, double el_deg, double range_m)
{
    ScatterAntenna a;
    radar_look(&a, az_deg * rad_per_deg, el_deg * rad_per_deg, range_m);
    return a;
}

static inline ScatterMatrix stage_bistatic(RadarStage *s, const ScatterAntenna *tx, const ScatterAntenna *rx)
{
    ScatterMatrix out;
    if (tubes_trace(&s->hits, s->target, tx, rx, &s->config, s->pool) != STATUS_OK) fail_msg("no rays");
    if (field_at(&out, s->config.frequency_hz, &s->hits, s->pool) != STATUS_OK) fail_msg("no field");
    return out;
}

static inline ScatterMatrix stage_look(RadarStage *s, double az_deg, double el_deg, double range_m)
{
    const ScatterAntenna a = antenna_at(az_deg, el_deg, range_m);
    return stage_bistatic(s, &a, &a);
}

static inline double decibels(double ratio) { return 10 * log10(ratio); }
static inline double phase_deg(double complex a, double complex b) { return carg(a * conj(b)) / rad_per_deg; }

#endif
