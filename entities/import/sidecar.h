/* entities/import/sidecar.h: properties that a model file lacks: NAME.yaml beside it.
 *
 *     file: tank.glb                  # when it has another name; relative to the sidecar
 *     name: T-54                      # in the truth records; else the file's name
 *     scale: 0.01                     # metres a unit of the file
 *     axes: +z +y                     # of the file: forward and up
 *     origin: auto                    # centre of the base, or x y z
 *     crease_deg: 30                  # sharper edges are not smoothed, where the file has no normals
 *     drop: [crew_*, air*]            # parts to remove
 *     joints:
 *       - {nodes: Joint_Turret, class: primary_turret_1, metric: azimuth}
 *       - {name: gun, nodes: Joint_MainGun, class: primary_gun_1, metric: elevation, limits_deg: -5 18, rest_deg: 15}
 *       - {nodes: "wheel_*", each: true, pivot: centre, roll_radius: auto}
 *     materials: {"*olive*": paint_olive, "*": paint_sand}    # of the file -> row of etc/materials.csv
 *     node_materials: {"window_*": glass_window}              # the same by part, before the above
 *     roles: {"hull*": hull, "*exhaust*": exhaust}           # heat, a row of etc/heat.csv
 *     thickness_mm: {"hull*": 12}                            # of the skin; conductivity and density are the material's
 *     damage: {destroyed: {hide: [antenna], materials: {"*": metal_dark}}}
 *
 * A pattern is matched (`*` and `?`, slashes too, case counts) against a node's own name and against its
 * path from the root, names joined by slashes. Nodes below a matched node are matched with it. Where several
 * patterns agree with the same node the last one in the file wins: write the general pattern first, then the
 * exceptions. Places and vectors are in the file's own axes and units. */
#ifndef ENTITIES_IMPORT_SIDECAR_H
#define ENTITIES_IMPORT_SIDECAR_H

#include "entities/models/model.h"

enum { sidecar_max_octets = 1 << 20, sidecar_max_patterns = 16, sidecar_max_joints = 256, sidecar_max_rules = 4096 };

typedef struct SidecarRule {
    char pattern[model_name_size];
    char value[32]; /* empty for lists: drop, hide */
    int  line;
    int  damage; /* the state it belongs to; 0 outside `damage` */
} SidecarRule;

typedef struct SidecarRules {
    int          count;
    SidecarRule *rule;
} SidecarRules;

typedef enum PivotKind { PIVOT_NODE, PIVOT_GIVEN, PIVOT_CENTRE } PivotKind; /* NODE: the node's origin */
typedef enum AxisKind { AXIS_DEFAULT, AXIS_BODY, AXIS_FILE } AxisKind;

typedef struct SidecarJoint {
    char      name[model_name_size];   /* empty: the node's */
    char      parent[model_name_size]; /* a joint further up in the list; empty: by the file's hierarchy */
    int       line, pattern_count;
    char      pattern[sidecar_max_patterns][model_name_size];
    bool      each; /* every matched node is a joint of its own */
    PivotKind pivot;
    double    p_pivot_file[3];
    AxisKind  axis;
    double    axis_xyz[3];           /* unit; in body or file axes */
    uint32_t  dis_class, dis_metric; /* 0: none */
    bool      slides, has_limits;
    double    low, high;     /* rad or m */
    double    rest;          /* value at which the file draws it, rad or m */
    double    spin_rps;      /* rad/s */
    double    roll_radius_m; /* < 0: from the size of the part; 0: does not roll */
} SidecarJoint;

typedef struct Sidecar {
    char          path[512];             /* as it was opened, for messages */
    char          file[512];             /* empty: not named */
    char          name[model_name_size]; /* empty: not named */
    double        scale_m;               /* 0: not named */
    bool          has_axes;
    double        forward[3], up[3]; /* unit, along the file's axes */
    bool          has_origin;
    double        p_origin_file[3];
    double        crease_rad;
    int           joint_count;
    SidecarJoint *joint;
    SidecarRules  drop, materials, node_materials, roles, thickness, damage_hide, damage_materials;
} Sidecar;

/* What holds without a sidecar. */
Sidecar sidecar_default(void);
/* A file that is wrong: one line with file, line, key, value and what is accepted, and *out untouched. A key that
 * is not there leaves its default. The names of materials are the importer's to check. */
Status sidecar_read(Sidecar *out, const char *path);
/* The same from memory; path is for the messages. */
Status sidecar_parse(Sidecar *out, const char *path, const char *text, size_t octets);
/* Every key with its type, unit, range and meaning, from the tables of the reader. */
void sidecar_write_keys(FILE *to);
void sidecar_close(Sidecar *sidecar); /* accepts zeroes */
/* Names as in the files; NULL where there is none (a number is then shown). */
const char *sidecar_class_text(char out[32], uint32_t dis_class);
const char *sidecar_metric_text(uint32_t dis_metric);

#endif
