/* tests/render/polygon_stage.h: plates as models, and their field with flat faces in closed form or by tubes. */
#ifndef TESTS_RENDER_POLYGON_STAGE_H
#define TESTS_RENDER_POLYGON_STAGE_H

#include "tests/render/hand_models.h"
#include "tests/render/radar_stage.h"

#include "render/scattering/field/radar_model.h"
#include "render/scattering/field/total_field.h"

static const double x_hz = 10e9, w_hz = 94e9;

static TotalField field; /* of the last look */

static inline ScatterMatrix look(RadarStage *s, const ScatterAntenna *tx, const ScatterAntenna *rx, int polygon_faces)
{
    ScatterMatrix out;
    s->config.polygon_faces = polygon_faces;
    if (total_field_trace(&field, s->target, tx, rx, &s->config, false, s->pool) != STATUS_OK) fail_msg("no look");
    if (total_field_sweep(&out, &(FrequencySweep){.count = 1, .first_hz = s->config.frequency_hz}, &field, s->pool) !=
        STATUS_OK)
        fail_msg("no field");
    return out;
}

static inline double power_apart(const ScatterMatrix *a, const ScatterMatrix *b)
{
    return scatter_power(a->hh - b->hh) + scatter_power(a->vv - b->vv) + scatter_power(a->hv - b->hv) +
           scatter_power(a->vh - b->vh);
}

/* A flat face of four corners; its normal by the right hand. */
static inline void put_quad(Model *m, int part, const double p[4][3])
{
    double    ab[3], ac[3], n[3];
    const int first = m->vertex_count;
    v3_sub(ab, p[1], p[0]);
    v3_sub(ac, p[2], p[0]);
    v3_cross(n, ab, ac);
    CHECK(v3_normalize(n, n));
    for (int k = 0; k < 4; k++) {
        hand_vertex(m, p[k][0], p[k][1], p[k][2]);
        for (int c = 0; c < 3; c++) m->normal[first + k][c] = (float)n[c];
    }
    if (m->part[part].triangle_count == 0) m->part[part].first_triangle = m->triangle_count;
    hand_triangle(m, part, first, first + 1, first + 2);
    hand_triangle(m, part, first, first + 2, first + 3);
}

/* A plate across x at x_m, width y by height z about a middle. */
static inline void put_plate(Model *m, int part, double x_m, double y_m, double width_m, double height_m)
{
    const double y = 0.5 * width_m, z = 0.5 * height_m;
    const double p[4][3] = {{x_m, y_m - y, -z}, {x_m, y_m + y, -z}, {x_m, y_m + y, z}, {x_m, y_m - y, z}};
    put_quad(m, part, p);
}

static inline void open_model(RadarStage *s, double frequency_hz)
{
    CHECK(model_measure(&s->model) == STATUS_OK);
    stage_target(s, frequency_hz);
}

static inline void close_stage(RadarStage *s)
{
    total_field_free(&field);
    stage_close(s);
}

#endif
