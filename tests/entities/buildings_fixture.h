/* tests/entities/buildings_fixture.h: cultures of a few buildings and works, and measures of the meshes made of them.
 */
#ifndef TESTS_ENTITIES_BUILDINGS_FIXTURE_H
#define TESTS_ENTITIES_BUILDINGS_FIXTURE_H

#include "entities/scenery/scenery_buildings.h"
#include "tests/check.h"

#include <stdlib.h>

static const Building house = {.id = 7,
                               .base_m = 100,
                               .eaves_m = 5.5F,
                               .ridge_m = 9,
                               .use = BUILDING_HOUSE,
                               .roof = ROOF_GABLED,
                               .wall_fabric = FABRIC_BRICK,
                               .roof_fabric = FABRIC_TILE,
                               .levels = 2,
                               .heated = true};

static inline void add(Culture *c, const Building *b, const double (*p)[2], int n)
{
    const int before = c->buildings;
    CHECK(culture_add_building(c, b, p, n) == STATUS_OK);
    assert_int_equal(c->buildings, before + 1);
}

/* The scenery of one building. */
static inline Scenery scenery_of(const Building *b, const double (*p)[2], int n)
{
    Culture c = {0};
    Scenery s = {0};
    add(&c, b, p, n);
    CHECK(scenery_add_buildings(&s, &c, NULL, NULL) == STATUS_OK);
    assert_int_equal(s.models, 1);
    culture_free(&c);
    return s;
}

/* A triangle in ENU: its corners, its normal of length twice its area, its part. */
typedef struct Facet {
    double           p[3][3], n[3];
    double           facing; /* least cosine between its normal and those of its vertices */
    const ModelPart *part;
} Facet;

static inline Facet facet(const Scenery *s, int model, int t)
{
    const Model *m = &s->model[model];
    Facet        f = {.part = &m->part[m->triangle_part[t]]};
    double       u[3], v[3];
    for (int k = 0; k < 3; k++) { /* buildings have an object a model, in their order */
        m3_mul_v3(f.p[k], s->object[model].r_enu_from_body, m->vertex[m->triangle[t][k]]);
        v3_add(f.p[k], f.p[k], s->object[model].p_enu);
    }
    v3_sub(u, f.p[1], f.p[0]), v3_sub(v, f.p[2], f.p[0]);
    v3_cross(f.n, u, v);
    f.facing = 1;
    for (int k = 0; k < 3; k++) {
        const float *n = m->normal[m->triangle[t][k]];
        double       n_enu[3];
        m3_mul_v3(n_enu, s->object[model].r_enu_from_body, (const double[3]){n[0], n[1], n[2]});
        f.facing = fmin(f.facing, v3_dot(n_enu, f.n) / v3_length(f.n));
    }
    return f;
}

static inline bool is_part(const Facet *f, const char *name) { return !strcmp(f->part->name, name); }

/* All triangles of a record are one closed shell or several: each directed edge has its reverse, volume is positive. */
static inline void check_closed(const Scenery *s)
{
    for (int k = 0; k < s->models; k++) {
        const Model    *m = &s->model[k];
        const uint64_t *id = s->part_of + s->part_first[k];
        CHECK(model_check(m) == STATUS_OK);
        for (int first = 0, end; first < m->part_count; first = end) {
            for (end = first + 1; end < m->part_count && id[end] == id[first];) end++;
            /* the parts as one part of a model whose other arrays are the model's */
            const int from = m->part[first].first_triangle;
            const int to = m->part[end - 1].first_triangle + m->part[end - 1].triangle_count;
            ModelPart part = m->part[first];
            Model     one = *m;
            part.first_triangle = 0, part.triangle_count = to - from;
            one.triangle = m->triangle + from, one.triangle_count = to - from;
            one.part_count = 1, one.part = &part;
            one.triangle_part = calloc((size_t)(to - from), sizeof *one.triangle_part);
            const Status status = model_validate(&one);
            free(one.triangle_part);
            if (status != STATUS_OK) fail_msg("record %llu is not closed", (unsigned long long)id[first]);
        }
    }
}

static inline double highest(const Scenery *s, const char *name)
{
    double high_m = -INFINITY;
    for (int k = 0; k < s->models; k++)
        for (int t = 0; t < s->model[k].triangle_count; t++) {
            const Facet f = facet(s, k, t);
            for (int c = 0; c < 3 && is_part(&f, name); c++) high_m = fmax(high_m, f.p[c][2]);
        }
    return high_m;
}

/* Height of the highest facet of a part over a place that faces up; -infinity: there is none. */
static inline double height_over(const Scenery *s, const char *name, double x_m, double y_m)
{
    double high_m = -INFINITY;
    for (int t = 0; t < s->model[0].triangle_count; t++) {
        const Facet f = facet(s, 0, t);
        if (!is_part(&f, name) || !(f.n[2] > 1e-9)) continue;
        double weight[3];
        bool   in = true;
        for (int k = 0; k < 3; k++) {
            const double *a = f.p[(k + 1) % 3], *b = f.p[(k + 2) % 3];
            weight[k] = ((b[0] - a[0]) * (y_m - a[1]) - (b[1] - a[1]) * (x_m - a[0])) / f.n[2];
            in = in && weight[k] > -1e-9;
        }
        if (in) high_m = fmax(high_m, weight[0] * f.p[0][2] + weight[1] * f.p[1][2] + weight[2] * f.p[2][2]);
    }
    return high_m;
}

/* Of a part's facets that face up: what they cover from above, and the volume between them and a height. */
static inline double covered_m2(double *volume_m3, const Scenery *s, const char *name, double over_m)
{
    double area = 0, volume = 0;
    for (int t = 0; t < s->model[0].triangle_count; t++) {
        const Facet f = facet(s, 0, t);
        if (!is_part(&f, name) || !(f.n[2] > 1e-9)) continue;
        area += 0.5 * f.n[2];
        volume += 0.5 * f.n[2] * ((f.p[0][2] + f.p[1][2] + f.p[2][2]) / 3 - over_m);
    }
    if (volume_m3) *volume_m3 = volume;
    return area;
}

#endif
