/* tests/entities/buildings_fixture.h: cultures of a few buildings, and measures of the meshes made of them. */
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
                               .heated = true,
                               .chimneys = 0};

static inline void add(Culture *c, const Building *b, const double (*p)[2], int n)
{
    const int before = c->buildings;
    CHECK(culture_add_building(c, b, p, n) == STATUS_OK);
    assert_int_equal(c->buildings, before + 1);
}

static inline Scenery scenery_of(const Culture *c)
{
    Scenery s = {0};
    CHECK(scenery_add_buildings(&s, c, NULL, NULL) == STATUS_OK);
    return s;
}

/* Parts first .. end - 1 as a model of one part: what must be closed. Its arrays are the model's; only triangle_part
 * and part are its own. */
static inline Model whole(const Model *m, int first, int end)
{
    Model one = *m;
    one.triangle = m->triangle + m->part[first].first_triangle;
    one.triangle_count =
        m->part[end - 1].first_triangle + m->part[end - 1].triangle_count - m->part[first].first_triangle;
    one.part_count = 1;
    one.part = calloc(1, sizeof *one.part);
    one.triangle_part = calloc((size_t)one.triangle_count, sizeof *one.triangle_part);
    one.part[0] = m->part[first];
    one.part[0].first_triangle = 0, one.part[0].triangle_count = one.triangle_count;
    return one;
}

static inline void whole_free(Model *one) { free(one->part), free(one->triangle_part); }

/* Corner k of triangle t of a model in ENU of an object. */
static inline void corner_enu(double p[3], const Scenery *s, const Model *m, int t, int k)
{
    (void)s;
    const double *v = m->vertex[m->triangle[t][k]];
    p[0] = v[1], p[1] = v[0], p[2] = -v[2];
}

#endif
