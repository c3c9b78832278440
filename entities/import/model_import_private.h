/* entities/import/model_import_private.h: the content of a model file as a flat scene, before axes and scale are
 * applied.
 *
 * A reader fills it from a format; model_import.c makes a Model of it. The readers check indices and counts, so that
 * everything here is in range; coordinates may still have any value (NaN too). */
#ifndef ENTITIES_IMPORT_MODEL_IMPORT_PRIVATE_H
#define ENTITIES_IMPORT_MODEL_IMPORT_PRIVATE_H

#include "entities/import/model_import.h"
#include "entities/import/sidecar.h"

enum {
    import_max_octets = 1 << 28, /* most octets of a file, decompressed */
    import_max_nodes = 65536,
    import_max_meshes = 16384, /* and so of parts */
    import_max_vertices = 1 << 23,
    import_max_triangles = 1 << 23,
    import_max_materials = 16384,
    import_max_depth = 256,
    import_max_seconds = 120,       /* most seconds of one core that the reader may take */
    import_max_memory = 2000000000, /* most memory that the reader may take besides what it has at its start */
};

/* A degree of freedom that the file itself has (OpenFlight). Axes are unit. */
typedef struct ImportDof {
    int    node;
    bool   slides, limited;
    double p_pivot_parent[3],
        axis_parent[3]; /* axes of the freedom in the axes of the node's parent, where the node stands at rest */
    double low, high;   /* in rad or in the file's units */
} ImportDof;

typedef struct ImportNode {
    char   name[model_name_size];
    int    parent; /* an earlier node; -1: the root, node 0 */
    double m[12];  /* 3 x 4, row by row: p_parent = m (p_node, 1) */
} ImportNode;

typedef struct ImportMaterial {
    char  name[model_name_size];
    int   has_colour;
    float rgb[3]; /* 0 .. 1, linear */
} ImportMaterial;

typedef struct ImportMesh {
    int node, material;
    int first_vertex, vertex_count, first_triangle, triangle_count;
    int has_normals;
} ImportMesh;

typedef struct ImportScene {
    int             node_count, material_count, mesh_count, vertex_count, triangle_count, dof_count;
    ImportNode     *node;
    ImportMaterial *material; /* at least one */
    ImportMesh     *mesh;
    double (*vertex)[3];     /* in the axes of the mesh's node */
    float (*normal)[3];      /* zero where the mesh has no normals */
    uint32_t (*triangle)[3]; /* indices of vertices, counted from the mesh's first */
    ImportDof *dof;
    double     forward[3], up[3];            /* from the file or its format; each along an axis */
    double     unit_m;                       /* from the same; metres a unit */
    char       unit_from[96], axes_from[96]; /* where they come from, for reports */
    bool       mirrored;                     /* the file's axes are left-handed: one coordinate has changed its sign */
    int        lost[IMPORT_LOST_COUNT];
} ImportScene;

/* Readers log one line on failure. path: of a regular file. extension: in lower case, without `.gz`. */
Status import_assimp(ImportScene *out, const char *path, const char *extension);
Status import_gltf(ImportScene *out, const char *path, const char *extension);
Status import_openflight(ImportScene *out, const char *path);
/* The extension in lower case, without its dot and without `.gz`; stem: length of what is before it. */
void import_split_extension(char out[16], size_t *stem, const char *path);
/* The model's file and the sidecar's, from the one that was named; reads the sidecar. */
Status import_find_files(ModelImport *report, Sidecar *sidecar, const char *path);
/* An OpenSceneGraph text, as osgconv writes it. path: for messages. text is taken apart. */
Status import_osgt(ImportScene *out, const char *path, char *text, size_t octets);
void   import_scene_close(ImportScene *scene); /* accepts zeroes */
/* Reads all of a file, `.gz` or plain. *out is NUL-terminated. With `quiet` nothing is logged. */
Status import_read_whole(char **out, size_t *octets, const char *path, bool quiet);

/* ---- import_joints.c ------------------------------------------------------------------ */

typedef struct ImportJoint {
    char      name[model_name_size];
    int       parent; /* number of the parent joint; -1: the hull */
    int       source; /* the first node that moves with it */
    double    p_pivot_file[3], axis_body[3];
    JointKind kind;
    uint32_t  dis_class, dis_metric;
    double    low, high, rest; /* rad or m; low > high: none */
    double    spin_rps, roll_radius_m;
    bool      from_file; /* it is a degree of freedom of the file, not one of the sidecar's */
} ImportJoint;

typedef struct ImportPlace {
    double m[12]; /* p_file = m (p_node, 1) */
    char  *path;  /* names from the root, with slashes */
    int    joint; /* joint that it moves with; -1: none */
    bool   dropped;
} ImportPlace;

typedef struct ImportJoints {
    int          count;
    ImportJoint *joint; /* joints, parents first */
    ImportPlace *place; /* [node_count] */
} ImportJoints;

/* r_body_from_file: rotation. scale_m: metres a unit. */
Status import_joints(ImportJoints *out, const ImportScene *scene, const Sidecar *sidecar,
                     const double r_body_from_file[9], double scale_m);
void   import_joints_close(ImportJoints *joints, int node_count);
/* `*` for any text, `?` for one character. */
bool import_matches(const char *pattern, const char *text);
/* The last rule that matches a node by name or path; NULL: none does. damage: only rules for that state. */
const SidecarRule *import_rule(const SidecarRules *rules, const ImportScene *scene, const ImportPlace *place, int node,
                               int damage);

/* ---- import_names.c -------------------------------------------------------------------- */

/* Logs why a joint of the sidecar has no node, with the names that there are and the most similar one. */
void import_report_missing_node(const ImportScene *scene, const ImportPlace *place, const Sidecar *sidecar, int joint);
/* Warns of names used by a sidecar that several nodes share, and of nodes without a name. */
void import_warn_names(const ImportScene *scene, const ImportPlace *place, const Sidecar *sidecar, const char *file);
/* How many nodes have no name, and how many share theirs. */
void import_count_names(int *unnamed, int *shared, const ImportScene *scene);

/* ---- import_surface.c ------------------------------------------------------------------ */

/* Material and heat role of a part without an entry in the sidecar. */
typedef struct ImportPaints {
    int count;
    char (*name)[32];
    float (*rgb)[3]; /* reflectance */
} ImportPaints;

Status import_paints_open(ImportPaints *out);
void   import_paints_close(ImportPaints *paints);
bool   import_paints_have(const ImportPaints *paints, const char *name);
/* The material of a part: by words in the name of the file's material, else by its colour, else paint_olive; *source:
 * which of these. */
const char *import_paint_guess(ImportMaterialSource *source, const ImportPaints *paints,
                               const ImportMaterial *material);
/* The heat role of a part by words in its path, of which the last one wins; HEAT_PASSIVE without any. */
HeatRole import_role_guess(const char *path);

/* One part's triangles in node axes -> vertices with normals by crease angle. `corner` is triangle * 3 + k.
 * Writes at most 3 * triangle_count vertices, whose count is returned; -1: no memory. */
int import_smooth(double (*vertex)[3], float (*normal)[3], uint32_t (*triangle)[3], const double (*corner)[3],
                  int triangle_count, double crease_rad);

/* ---- osg_text.c ----------------------------------------------------------------------------- */

/* OpenSceneGraph's text form as a tree: one element per line, `{` opens its children. */

typedef struct OsgElement {
    int first_word, words;
    int child, next; /* -1: none */
} OsgElement;

typedef struct OsgText {
    const char *path;
    int         element_count, element_room, word_count, word_room;
    OsgElement *element;
    char      **word;
    int        *by_id; /* element that defines this UniqueID; -1: none does */
    int         id_count;
} OsgText;

/* The tree of a text, which is split in place and must outlive it. STATUS_BAD_VALUE, not logged: it is
 * incomplete. Close it whatever open returns. */
Status osg_text_open(OsgText *out, const char *path, char *text, size_t octets);
void   osg_text_close(OsgText *text);

const char *osg_word(const OsgText *x, int element, int index); /* "" where the element has no such word */
/* The child with this first word; -1: none. */
int osg_find(const OsgText *x, int element, const char *name);
/* A repeated object is written as its id alone: the element with the full definition. */
int osg_resolve(const OsgText *x, int element);
/* Numbers among an element's words from `from` on; false when there are fewer than count. */
bool osg_numbers(double *out, int count, const OsgText *x, int element, int from);

#endif
