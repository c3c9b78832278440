/* entities/models/model.h: the 3D model of an entity: nodes that move, parts that are rendered.
 *
 * Model axes are the entity's body axes: x forward, y right, z down, metres, origin at the centre of the
 * base (the ground contact, z = 0; everything above has z < 0). A model is immutable once built. */
#ifndef ENTITIES_MODELS_MODEL_H
#define ENTITIES_MODELS_MODEL_H

#include "pitviper.h"

enum {
    model_name_size = 96,    /* octets of names; models from files name a part by its whole path */
    model_damage_states = 4, /* DIS damage: 0 none, 1 slight, 2 moderate, 3 destroyed */
};

/* Heat roles of parts. One driver each; etc/heat.csv gives the figures. */
typedef enum HeatRole {
    HEAT_PASSIVE = 0, /* follows air and sun only */
    HEAT_HULL,        /* engine, weakly */
    HEAT_TURRET,
    HEAT_ENGINE_DECK, /* engine, strongly */
    HEAT_EXHAUST,     /* engine, hottest */
    HEAT_GUN,         /* firing */
    HEAT_TRACK,       /* motion */
    HEAT_WHEEL,       /* motion */
    HEAT_CABIN,       /* engine: heated or crewed */
    HEAT_ROTOR,       /* flight: friction and gearbox */
    HEAT_TURBINE,     /* flight: turbine casing and exhaust */
    HEAT_MOTOR,       /* burn: rocket motor and nozzle, after launch */
    HEAT_NOSE,        /* speed: aerodynamic heating */
    HEAT_AIRFRAME,    /* speed, slower: thin metal skin */
    HEAT_SKIN,        /* life: bare skin */
    HEAT_CLOTHING,    /* life: cloth over a body */
    HEAT_DWELLING,    /* life: walls and door of a house that is lived in */
    HEAT_WINDOW,      /* life: its panes */
    HEAT_FLUE,        /* life: chimney */
    HEAT_FLARE,       /* pyrotechnic: burning since it appeared */
    HEAT_FIRE,        /* burning: flames of an open fire */
    HEAT_EMBER,       /* burning: its glowing bed, a barrel's mouth */
    HEAT_SMOULDER,    /* burning: the crust of a heap that smoulders inside */
    HEAT_WRECK,       /* burning: all of a destroyed or flaming platform, on top of the others; no part has it */
    HEAT_ROLE_COUNT
} HeatRole;

const char *heat_role_name(HeatRole role);
bool        heat_role_find(HeatRole *out, const char *name); /* false: there is no such role */

/* How a node moves in its parent: first translate to `p_parent`, then turn by the joint's value. */
typedef enum JointKind { JOINT_FIXED, JOINT_ROTATION, JOINT_TRANSLATION } JointKind;

typedef struct ModelNode {
    char      name[model_name_size];
    int       parent;                /* index of the parent, an earlier node; -1 for the hull (node 0) */
    double    p_parent[3];           /* position of the pivot, in the parent's axes */
    double    r_parent_from_node[9]; /* rest attitude */
    JointKind joint;
    double    axis[3];      /* unit, in the node's rest axes; turning is right-handed about it */
    uint32_t  dis_class;    /* articulated-parameter class (4096 primary turret 1, ...), 0: none */
    uint32_t  dis_metric;   /* 11 azimuth, 13 elevation, 15 rotation, 1 position ... */
    double    low, high;    /* limits of the value; low > high: none */
    double spin_rps_moving; /* rate at which it turns by itself while the entity runs (rotors), rad/s; 0: it does not */
    double roll_radius_m;   /* wheels: value = distance travelled / radius; 0: no */
    double dis_scale;  /* joint value that a reported 1 means, where DIS counts 0 .. 1 (doors, gear); 0: the reported
                          value itself */
    double value_slow; /* value without a report while slower than articulation_slow_mps (gear down); 0: none */
} ModelNode;

typedef struct ModelPart {
    char     name[model_name_size];
    int      node;
    char     material[32]; /* a row of etc/materials.csv */
    HeatRole role;
    double   thickness_m; /* thickness of its skin; 0: by its role */
    int      first_triangle, triangle_count;
    /* Effect of damage, by the damage state of the appearance: hidden (bit 1 << state; 0 only of scenery whose
     * damage changes), or of another material ([0] is not used) (empty: the same). Parametric models have none; a
     * sidecar may. */
    uint8_t damage_hidden;
    char    damage_material[model_damage_states][32];
} ModelPart;

typedef struct Model {
    char       name[model_name_size];       /* the name in the truth records: tank, truck, helicopter, missile ... */
    double     length_m, width_m, height_m; /* bounding box at rest */
    double     box_low[3], box_high[3];     /* at rest, body axes */
    double     radius_m;                    /* radius of a sphere about the body origin that holds every pose */
    double     sag_m;                       /* largest distance between a curved surface and its facets */
    int        node_count, part_count, vertex_count, triangle_count;
    ModelNode *node;         /* nodes, parents before their children */
    ModelPart *part;         /* triangles of a part are contiguous, and so are parts of a node */
    double (*vertex)[3];     /* in the axes of the part's node */
    float (*normal)[3];      /* shading normal of each vertex, unit, outward */
    uint32_t (*triangle)[3]; /* counter-clockwise seen from outside (in right-handed body axes) */
    uint16_t *triangle_part; /* [triangle_count] */
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
 * calls last. radius_m is exact for what is fixed, and an upper bound within a few per cent for what moves.
 * STATUS_NO_MEMORY: nothing is filled in. */
Status model_measure(Model *model);
/* Corner 0 .. 3 triangle_count - 1 of a part, in the body with all joints as they were made, m. */
void model_corner(double p[3], const Model *model, const ModelPart *part, int corner);
/* Bounding box at rest of the parts whose role is not in `without` (1 << role); of all parts where no other is left. */
void model_box_without(double low[3], double high[3], const Model *model, uint32_t without);
void model_destroy(Model *model); /* frees and zeroes; accepts zeroes */

/* Figures of a model at rest, m; 0: left open, in proportion to those that are given. length, width: of the bounding
 * box; height: from the ground (z = 0), or from the lowest point where that is below it, to the top. */
typedef struct ModelSize {
    double length_m, width_m, height_m;
} ModelSize;

/* Scales a model to a size, with its joints; wheels and rotors stay round, and wheels on the ground. Sizes are reached
 * to 1e-3 where wheels and rotors allow it. STATUS_BAD_VALUE: a factor outside 0.02 .. 50; then, and without memory,
 * the model is in an undefined state, valid for model_destroy only. */
Status model_resize(Model *model, const ModelSize *size);
/* Scale factors along the body axes for the given size; false: outside 0.02 .. 50. */
bool model_scale_to(double factor[3], const Model *model, const ModelSize *size);
/* A promise every builder keeps; tests and importers call it: indices in range, closed parts, unit normals,
 * names set, parents first. On failure logs what is wrong. */
Status model_validate(const Model *model);
/* As model_validate, but parts need not be closed: what models from files must keep too. */
Status model_check(const Model *model);

/* How far a model is from closed parts: edges, by vertex position within a part. */
typedef struct ModelEdges {
    long long open;                         /* edges without their reverse */
    long long crowded;                      /* edges shared by more than two triangles */
    int       open_parts, inside_out_parts; /* parts with open edges; closed parts with negative volume */
} ModelEdges;

/* STATUS_NO_MEMORY is the only failure. model: one that passes model_check. */
Status model_edges(ModelEdges *out, const Model *model);

#endif
