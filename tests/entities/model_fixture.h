/* tests/entities/model_fixture.h: building a built-in model and measuring its parts. */
#ifndef TESTS_ENTITIES_MODEL_FIXTURE_H
#define TESTS_ENTITIES_MODEL_FIXTURE_H

#include "tests/check.h"

#include "entities/shapes/mesh_builder.h"
#include "entities/shapes/parametric.h"

/* Every model that somebody may meet (`marker` is for tests of the picture alone). */
static const char *const model_names[] = {"tank",     "truck",    "helicopter", "missile", "unknown",
                                          "carrier",  "launcher", "aircraft",   "ship",    "person",
                                          "building", "decoy",    "flare"};
enum { model_name_count = sizeof model_names / sizeof model_names[0] };

static inline Model build(const char *name, double sag_m)
{
    Model m = {0};
    if (parametric_build(&m, name, sag_m) != STATUS_OK) fail_msg("%s at %g does not build", name, sag_m);
    return m;
}

static inline int find_node(const Model *m, const char *name)
{
    for (int i = 0; i < m->node_count; i++)
        if (!strcmp(m->node[i].name, name)) return i;
    fail_msg("%s has no node %s", m->name, name);
    return -1;
}

static inline const ModelPart *find_part(const Model *m, const char *name)
{
    for (int i = 0; i < m->part_count; i++)
        if (!strcmp(m->part[i].name, name)) return &m->part[i];
    fail_msg("%s has no part %s", m->name, name);
    return NULL;
}

/* Box of one part in body axes for joint values (NULL: rest). */
static inline void part_box(double low[3], double high[3], const Model *m, const char *name, const double *value)
{
    NodePose         pose[64];
    const ModelPart *part = find_part(m, name);
    CHECK(m->node_count <= 64);
    model_pose(pose, m, value);
    for (int i = 0; i < 3; i++) {
        low[i] = INFINITY;
        high[i] = -INFINITY;
    }
    for (int t = part->first_triangle; t < part->first_triangle + part->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            double p[3];
            m3_mul_v3(p, pose[part->node].r_body_from_node, m->vertex[m->triangle[t][k]]);
            v3_add(p, p, pose[part->node].p_body);
            for (int i = 0; i < 3; i++) {
                low[i] = fmin(low[i], p[i]);
                high[i] = fmax(high[i], p[i]);
            }
        }
}

static inline double part_volume_m3(const Model *m, const ModelPart *part)
{
    double sum = 0;
    for (int t = part->first_triangle; t < part->first_triangle + part->triangle_count; t++) {
        const uint32_t *v = m->triangle[t];
        double          cross[3];
        v3_cross(cross, m->vertex[v[1]], m->vertex[v[2]]);
        sum += v3_dot(m->vertex[v[0]], cross) / 6;
    }
    return sum;
}

#endif
