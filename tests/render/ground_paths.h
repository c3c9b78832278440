/* tests/render/ground_paths.h: a target's fields along the paths to it, direct and by way of the ground. */
#ifndef TESTS_RENDER_GROUND_PATHS_H
#define TESTS_RENDER_GROUND_PATHS_H

#include "tests/render/radar_stage.h"

#include "entities/catalog/catalog.h"
#include "render/scattering/paths/ground_bounce.h"

static const double x_hz = 10e9, truck_hz = 3e9;

static const GroundSurface mirror = {.eps = 1 - 1e16 * I};

static inline double wave_number(double f_hz) { return 2 * pi_rad * f_hz / light_mps; }

/* Body axes have z down; a plane so much beneath the origin. */
static inline GroundPlane level(double height_m) { return (GroundPlane){{0, 0, -1}, height_m}; }

/* ---- fields by ray tubes ------------------------------------------------------------------------------------ */

typedef struct Paths {
    GroundFields   s;
    GroundLeg      direct, image;
    ScatterAntenna a, i;
    double         seen_deepest_m; /* x of the hit of the image that lies lowest along x */
} Paths;

static inline ScatterMatrix trace(RadarStage *s, const ScatterAntenna *tx, const ScatterAntenna *rx,
                                  const GroundPlane *plane, bool edges, const bool image[2], double *least_x)
{
    TotalField    field = {0};
    ScatterMatrix m;
    CHECK(total_field_trace(&field, s->target, tx, rx, &s->config, edges, s->pool) == STATUS_OK);
    CHECK(ground_hide(&field, s->target, plane, image, s->pool) == STATUS_OK);
    CHECK(total_field_sweep(&m, &(FrequencySweep){.count = 1, .first_hz = s->config.frequency_hz}, &field, s->pool) ==
          STATUS_OK);
    for (size_t h = 0; least_x && h < field.hits.count; h++) *least_x = fmin(*least_x, (double)field.hits.first[0][h]);
    total_field_free(&field);
    return m;
}

static inline void trace_paths(Paths *p, RadarStage *s, const ScatterAntenna *a, const GroundPlane *plane,
                               const GroundSurface *surface, bool edges)
{
    const double extra_m = ground_image(&p->i, a, plane), k = wave_number(s->config.frequency_hz);
    double       h[3], v[3];
    scatter_basis(h, v, a->u);
    p->a = *a;
    p->seen_deepest_m = INFINITY;
    ground_leg_direct(&p->direct, a, h);
    CHECK(ground_leg_image(&p->image, &(GroundMirror){a, &p->i, extra_m, plane}, surface, k, h));
    p->s.direct = trace(s, a, a, plane, edges, (bool[]){false, false}, NULL);
    p->s.once = trace(s, a, &p->i, plane, edges, (bool[]){false, true}, NULL);
    p->s.twice = trace(s, &p->i, &p->i, plane, edges, (bool[]){true, true}, &p->seen_deepest_m);
}

static inline double rms_of(const ScatterMatrix *s)
{
    return sqrt(pow(cabs(s->hh), 2) + pow(cabs(s->hv), 2) + pow(cabs(s->vh), 2) + pow(cabs(s->vv), 2));
}

#endif
