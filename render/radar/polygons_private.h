/* render/radar/polygons_private.h: between polygons.c, the triangles of faces, and polygons_seen.c, which faces these
 * are. */
#ifndef RENDER_RADAR_POLYGONS_PRIVATE_H
#define RENDER_RADAR_POLYGONS_PRIVATE_H

#include "render/radar/polygons.h"

/* Corners of a triangle of the model, target frame. */
static inline void corners_of(double corner[3][3], const RadarTarget *target, uint32_t triangle)
{
    const Model    *model = target->model;
    const NodePose *at = &target->pose[model->part[model->triangle_part[triangle]].node];
    for (int k = 0; k < 3; k++) {
        m3_mul_v3(corner[k], at->r_body_from_node, model->vertex[model->triangle[triangle][k]]);
        v3_add(corner[k], corner[k], at->p_body);
    }
}

/* Unit normal by the right hand; returns the area, m^2. */
static inline double normal_of(double n[3], const double corner[3][3])
{
    double ab[3], ac[3];
    v3_sub(ab, corner[1], corner[0]);
    v3_sub(ac, corner[2], corner[0]);
    v3_cross(n, ab, ac);
    const double area2 = v3_length(n);
    v3_normalize(n, n);
    return 0.5 * area2;
}

/* seen [faces], zeroes: becomes 1 for each flat face with all antennas on one side that rays from each
 * meet first wherever they go. Returns the number of rays; -1: out of memory. */
long long polygons_seen(uint8_t *seen, const RadarTarget *target, const ScatterAntenna antenna[2], int antennas,
                        Pool *pool);

#endif
