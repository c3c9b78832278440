/* entities/import/model_import.h: imports 3D models from files.
 *
 * glTF 2.0; OBJ, FBX, AC3D, 3DS, ASE, PLY, STL and other formats of assimp, plain or as `.gz`; OpenFlight (`.flt`)
 * through osgconv of Debian's openscenegraph. Unit and axes are the file's where it or its format states them. Nodes
 * and materials become parts, named after their nodes; joints come from the file (OpenFlight's degrees of freedom) or
 * the sidecar, see entities/import/sidecar.h. All other nodes are merged into the moving node above them. Facets keep
 * their own plane; shading normals are the file's, else by crease angle. The reader runs in a separate process with
 * limits on time and memory: a hostile file causes an error line only. */
#ifndef ENTITIES_IMPORT_MODEL_IMPORT_H
#define ENTITIES_IMPORT_MODEL_IMPORT_H

#include "entities/models/model.h"

/* Things that a file may have and a Model has not. */
typedef enum ImportLost {
    LOST_TEXTURES,
    LOST_LIGHTS,
    LOST_CAMERAS,
    LOST_ANIMATIONS,
    LOST_BONES,
    LOST_MORPH_TARGETS,    /* glTF's stand at their default weights */
    LOST_POINTS_AND_LINES, /* meshes of points or lines */
    LOST_LEVELS_OF_DETAIL, /* levels of detail other than the finest */
    LOST_SWITCHED_OFF,     /* children of switches */
    LOST_EXTERNAL_REFERENCES,
    LOST_FREEDOM_OFFSETS, /* degrees of freedom that are drawn off their zero, or that scale */
    LOST_OTHER,           /* objects of a kind unknown here, and all below them */
    IMPORT_LOST_COUNT
} ImportLost;

const char *import_lost_name(ImportLost lost);

/* Where a part's material comes from. */
typedef enum ImportMaterialSource {
    MATERIAL_BY_SIDECAR,
    MATERIAL_BY_NAME,    /* from words in the file's name for the material */
    MATERIAL_BY_COLOUR,  /* the paint nearest to the file's colour */
    MATERIAL_BY_DEFAULT, /* paint_olive */
    MATERIAL_SOURCE_COUNT
} ImportMaterialSource;

/* Statistics of an import. */
typedef struct ModelImport {
    char       file[1024];                   /* path of the model's own file */
    char       sidecar[1024];                /* empty: none */
    long long  octets;                       /* octets of the model's own file on disk */
    char       unit_from[96], axes_from[96]; /* where scale and axes come from */
    double     scale_m;                      /* p_body = scale_m r_body_from_file (p_file - p_origin_file) */
    double     r_body_from_file[9], p_origin_file[3];
    bool       axes_assumed; /* the axes are not from the sidecar */
    bool       scale_assumed;
    bool       mirrored; /* the file's axes are left-handed */
    int        source_nodes, source_meshes, source_materials;
    int        unnamed_nodes, shared_names; /* nodes without a name; with one that another has, too */
    int        dropped_meshes;              /* meshes that the sidecar drops */
    int        empty_meshes;                /* meshes of which nothing is left */
    int        degenerate_triangles;        /* dropped */
    int        smoothed_parts;              /* parts whose file had no normals */
    int        joints_from_file;
    int        material_parts[MATERIAL_SOURCE_COUNT];
    int        lost[IMPORT_LOST_COUNT];
    ModelEdges edges;
} ModelImport;

/* path: a model's file, or a sidecar (`.yaml`) that names it. Beside a model `tank.glb` or `tank.obj.gz` its sidecar
 * `tank.yaml` is read when there is one. report may be NULL. On failure one line is logged, and outputs are untouched:
 * STATUS_IO (not there), STATUS_BAD_VALUE (broken file or sidecar, over a limit), STATUS_UNSUPPORTED (no reader).
 * Limits: 256 MiB unpacked, 8 M vertices and triangles, 65536 nodes, 256 levels, 16384 parts, 256 joints. */
Status model_import(Model *out, ModelImport *report, const char *path);

/* Logs one line with what was assumed and found: unit, axes, size, what was lost, and which keys change that. */
void model_import_say(const ModelImport *report, const Model *model);
/* Whether a name means a file: it has a slash or a dot. */
bool model_is_path(const char *name);
/* Logs that there is no built-in model of this name, with the nearest one. Returns STATUS_UNSUPPORTED. */
Status model_say_unknown(const char *name);
/* Builds a parametric model by its name, or imports one by its path (*imported: which of them). sag_m: as for
 * parametric_build. Failures are logged. */
Status model_open(Model *out, ModelImport *report, bool *imported, const char *name, double sag_m);

#endif
