/* entities/model.h: what an entity is made of: nodes that move, parts that are seen.
 *
 * Model axes are the entity's body axes: x forward, y right, z down, metres, origin at the centre of the
 * base (the ground contact, z = 0; everything above has z < 0). A model is immutable once built. */
#ifndef ENTITIES_MODEL_H
#define ENTITIES_MODEL_H

#include "pitviper.h"

/* What makes a part warm. One driver each; etc/heat.csv gives the figures. */
typedef enum HeatRole {
    HEAT_PASSIVE = 0,  /* follows air and sun only */
    HEAT_HULL,         /* engine, weakly */
    HEAT_TURRET,
    HEAT_ENGINE_DECK,  /* engine, strongly */
    HEAT_EXHAUST,      /* engine, hottest */
    HEAT_GUN,          /* firing */
    HEAT_TRACK,        /* motion */
    HEAT_WHEEL,        /* motion */
    HEAT_CABIN,        /* engine: heated or crewed */
    HEAT_ROTOR,        /* flight: friction and gearbox */
    HEAT_TURBINE,      /* flight: turbine casing and exhaust */
    HEAT_MOTOR,        /* burn: rocket motor and nozzle, after launch */
    HEAT_NOSE,         /* speed: aerodynamic heating */
    HEAT_WRECK,        /* burning: all of a destroyed or flaming platform, on top of the others; no part has it */
    HEAT_ROLE_COUNT
} HeatRole;

const char *heat_role_name(HeatRole role);

/* How a node moves in its parent: first translate to `p_parent`, then turn by the joint's value. */
typedef enum JointKind { JOINT_FIXED, JOINT_ROTATION, JOINT_TRANSLATION } JointKind;

typedef struct ModelNode {
    char      name[24];
    int       parent;           /* index of an earlier node; -1 for the hull (node 0) */
    double    p_parent[3];      /* pivot, in the parent's axes */
    double    r_parent_from_node[9]; /* rest attitude */
    JointKind joint;
    double    axis[3];          /* unit, in the node's rest axes; turning is right-handed about it */
    uint32_t  dis_class;        /* articulated-parameter class (4096 primary turret 1, ...), 0: none */
    uint32_t  dis_metric;       /* 11 azimuth, 13 elevation, 15 rotation, 1 position ... */
    double    low, high;        /* limits of the value; low > high: none */
    double    spin_rps_moving;  /* turns by itself while the entity runs (rotors), rad/s; 0: no */
    double    roll_radius_m;    /* wheels: value = distance travelled / radius; 0: no */
} ModelNode;

typedef struct ModelPart {
    char     name[24];
    int      node;
    char     material[32];      /* a row of etc/materials.csv */
    HeatRole role;
    int      first_triangle, triangle_count;
} ModelPart;

typedef struct Model {
    char       name[24];        /* as truth says it: tank, truck, helicopter, missile ... */
    double     length_m, width_m, height_m; /* bounding box at rest */
    double     box_low[3], box_high[3];     /* at rest, body axes */
    double     radius_m;        /* of a sphere about the body origin that holds every pose */
    double     sag_m;           /* largest distance between a curved surface and its facets */
    int        node_count, part_count, vertex_count, triangle_count;
    ModelNode *node;            /* parents first */
    ModelPart *part;            /* triangles of a part are contiguous; parts of a node too */
    double   (*vertex)[3];      /* node axes of the owning part */
    float    (*normal)[3];      /* unit shading normal a vertex, outward */
    uint32_t (*triangle)[3];    /* counter-clockwise seen from outside (in right-handed body axes) */
    uint16_t  *triangle_part;   /* [triangle_count] */
} Model;

/* Where one node is. */
typedef struct NodePose {
    double p_body[3];
    double r_body_from_node[9];
} NodePose;

/* Poses of all nodes for joint values [node_count] (NULL: rest, all 0; NaN and infinity count as 0; limits
 * applied). */
void model_pose(NodePose *pose, const Model *model, const double *value);
/* Fills box, length, width, height and radius_m from nodes, parts and vertices; what a builder or importer
 * calls last. radius_m is exact for what is fixed, and an upper bound within a few per cent for what moves. */
void model_measure(Model *model);
void model_destroy(Model *model); /* frees and zeroes; accepts zeroes */
/* A promise every builder keeps; tests and importers call it: indices in range, closed parts, unit normals,
 * names set, parents first. On failure logs what is wrong. */
Status model_validate(const Model *model);

#endif
