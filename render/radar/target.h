/* render/radar/target.h: a target ready for radar rays, in its own frame: body axes, the phase centre at the body's
 * origin.
 *
 * Its model's geometry is traced by render/parts, whose intersections are double throughout (Embree only finds
 * candidates); moved parts are posed in double. Nothing here depends on where the target stands in the world:
 * radar_antenna brings an antenna into its frame, in double, once. */
#ifndef RENDER_RADAR_TARGET_H
#define RENDER_RADAR_TARGET_H

#include "render/parts/parts.h"
#include "render/radar/radar_materials.h"
#include "render/radar/scatter.h"
#include "render/radar/edge_pairs.h"
#include "render/radar/flat_faces.h"

typedef struct RadarTarget {
    const Model          *model;
    const RadarMaterials *materials; /* NULL: all metal */
    Tracer      *tracer;
    PosedEntity  entity;             /* in body axes */
    NodePose    *pose;               /* [node_count] */
    int         *material;           /* [part_count], of materials, as undamaged */
    double       chord_m, chord_rms_m; /* from curved surfaces (by vertex normals) to their facets, at the middle of sides:
                                      * the largest, and over their area. Two-way phases are wrong by up to 2 k of it */
    double       curve_m;            /* radius of curvature: a twentieth of the area is curved more; INFINITY: flat */
    WedgeList    wedges;             /* of all parts, node axes */
    Wedge       *wedge;              /* [wedge_count], body axes: of metal parts that are there */
    int          wedge_count;
    EdgePairs    pairs;              /* of wedges that face one another, numbers of `wedges` */
    EdgePair    *pair;               /* [pair_count], numbers of `wedge` */
    int          pair_count;
    int         *placed;             /* [wedges.count]: number in `wedge`; -1: not there */
    FlatFaces    faces;
} RadarTarget;

/* model and materials must outlive it; its joints are at rest. isa: as tracer_create. */
Status radar_target_create(RadarTarget **out, const Model *model, const RadarMaterials *materials, const char *isa);
void   radar_target_destroy(RadarTarget *target);
/* pose: one a node, body axes; NULL: at rest. damage: parts that it hides are left out. */
void   radar_target_pose(RadarTarget *target, const NodePose *pose, int damage);

/* An antenna at p_antenna, seen from a target whose origin is at p_target: any frame in which both are given, double,
 * m. */
void radar_antenna(ScatterAntenna *out, const double p_antenna[3], const double p_target[3],
                   const double r_from_body[9]);

/* The same from angles: azimuth clockwise from the nose as seen from above, elevation upwards (body axes have z
 * down). */
void radar_look(ScatterAntenna *out, double azimuth_rad, double elevation_rad, double range_m);

/* Chord error that keeps the phase within 2.4 degrees: lambda / 300, 720 deg of phase over lambda of depth. */
double radar_sag_m(double frequency_hz);

#endif
