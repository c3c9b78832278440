/* render/scattering/field/radar_target_private.h: a target ready for radar rays, in its own frame: body axes, the phase
 * centre at the body's origin.
 *
 * Its model's geometry is traced by render/trace/parts, whose intersections are double throughout (Embree only finds
 * candidates); moved parts are posed in double. Nothing here depends on where the target stands in the world:
 * radar_antenna brings an antenna into its frame, in double, once. */
#ifndef RENDER_SCATTERING_FIELD_RADAR_TARGET_PRIVATE_H
#define RENDER_SCATTERING_FIELD_RADAR_TARGET_PRIVATE_H

#include "render/trace/parts/parts.h"
#include "render/scattering/field/edge_field_private.h"
#include "render/scattering/radar_surfaces.h"

/* ---- flat faces -------------------------------------------------------------------------------------- */

/* The flat faces of a model: triangles of one part that touch and lie in one plane. Triangles whose vertex normals make
 * them stand for a curved surface are left out. A sum over faces, other than one over triangles, has borders at real
 * edges alone. */
typedef struct FlatFaces {
    int       count;
    int      *first;    /* [count + 1]: of each, in triangle */
    uint32_t *triangle; /* of the model, by face and then by number */
    bool      convex;   /* one node of these faces alone, that no damage hides, and either a closed convex body or one
                         * face: a ray that leaves a face on the side it came from meets nothing */
} FlatFaces;

/* model: one that passes model_check. STATUS_NO_MEMORY is the only failure. */
Status radar_flat_faces_find(FlatFaces *out, const Model *model);
void   radar_flat_faces_free(FlatFaces *faces); /* frees and zeroes; accepts zeroes */

/* ---- the target ---------------------------------------------------------------------------------------- */

typedef struct RadarTarget {
    const Model          *model;
    const RadarMaterials *materials; /* NULL: all metal */
    Tracer               *tracer;
    PosedEntity           entity;   /* in body axes */
    NodePose             *pose;     /* [node_count] */
    int                  *material; /* [part_count], of materials, as undamaged */
    double chord_m, chord_rms_m;    /* from curved surfaces (by vertex normals) to their facets, at the middle of sides:
                                     * the largest, and over their area. Two-way phases are wrong by up to 2 k of it */
    double    curve_m;              /* radius of curvature: a twentieth of the area is curved more; INFINITY: flat */
    WedgeList wedges;               /* of all parts, node axes */
    Wedge    *wedge;                /* [wedge_count], body axes: of metal parts that are there */
    int       wedge_count;
    EdgePairs pairs; /* of wedges that face one another, numbers of `wedges` */
    EdgePair *pair;  /* [pair_count], numbers of `wedge` */
    int       pair_count;
    int      *placed; /* [wedges.count]: number in `wedge`; -1: not there */
    FlatFaces faces;
} RadarTarget;

/* model and materials must outlive it; its joints are at rest. isa: as tracer_create. */
Status radar_target_create(RadarTarget **out, const Model *model, const RadarMaterials *materials, const char *isa);
void   radar_target_destroy(RadarTarget *target);
/* pose: one a node, body axes; NULL: at rest. damage: parts that it hides are left out. */
void radar_target_pose(RadarTarget *target, const NodePose *pose, int damage);

/* An antenna at p_antenna, seen from a target whose origin is at p_target: any frame in which both are given, double,
 * m. */
void radar_antenna(ScatterAntenna *out, const double p_antenna[3], const double p_target[3],
                   const double r_from_body[9]);

/* The same from angles: azimuth clockwise from the nose as seen from above, elevation upwards (body axes have z
 * down). */
void radar_look(ScatterAntenna *out, double azimuth_rad, double elevation_rad, double range_m);

/* Chord error that keeps the phase within 2.4 degrees: lambda / 300, 720 deg of phase over lambda of depth. */
double radar_sag_m(double frequency_hz);

/* ---- its triangles and faces as antennas see them ------------------------------------------------------ */

/* Corners of a triangle of the model, target frame. */
static inline void radar_target_corners(double corner[3][3], const RadarTarget *target, uint32_t triangle)
{
    const Model    *model = target->model;
    const NodePose *at = &target->pose[model->part[model->triangle_part[triangle]].node];
    for (int k = 0; k < 3; k++) {
        m3_mul_v3(corner[k], at->r_body_from_node, model->vertex[model->triangle[triangle][k]]);
        v3_add(corner[k], corner[k], at->p_body);
    }
}

/* Unit normal by the right hand; returns the area, m^2. */
static inline double radar_corners_normal(double n[3], const double corner[3][3])
{
    double ab[3], ac[3];
    v3_sub(ab, corner[1], corner[0]);
    v3_sub(ac, corner[2], corner[0]);
    v3_cross(n, ab, ac);
    const double area2 = v3_length(n);
    v3_normalize(n, n);
    return 0.5 * area2;
}

/* Finds the flat faces that are wholly seen: all antennas are on one side, and rays from each antenna meet the face
 * first everywhere. seen [faces]: given as zeroes, becomes 1 for these. Returns the number of rays; -1: out of memory.
 */
long long radar_flat_faces_seen(uint8_t *seen, const RadarTarget *target, const ScatterAntenna antenna[2], int antennas,
                                Pool *pool);

#endif
