/* entities/import/gltf_private.h: a glTF 2.0 document as its reader's files see it. Indices and lengths of the document
 * are checked where they are used; everything may be wrong. */
#ifndef ENTITIES_IMPORT_GLTF_PRIVATE_H
#define ENTITIES_IMPORT_GLTF_PRIVATE_H

#include "entities/import/reader_private.h"

#include <jansson.h>

typedef struct GltfBuffer {
    char  *bytes; /* NULL: not read yet */
    size_t octets;
    bool   owned;
} GltfBuffer;

/* A primitive's triangles as they are drawn: morphed, and posed by a skin. */
typedef struct GltfShape {
    int vertices, triangles, material;
    double (*vertex)[3];
    float (*normal)[3]; /* NULL: none */
    uint32_t (*triangle)[3];
} GltfShape;

/* A node of the document that has a mesh, and the scene's nodes that draw it: one, or one for each instance. */
typedef struct GltfDrawn {
    int document_node, first, count;
} GltfDrawn;

typedef struct GltfDraw {
    int node, shape;
} GltfDraw;

typedef struct Gltf {
    json_t      *root;
    ReaderFiles *files;
    ReaderSaid  *said;
    ImportScene *scene;
    char        *text; /* text of the document */
    size_t       octets;
    const char  *binary; /* GLB's second chunk; NULL: none */
    size_t       binary_octets;
    GltfBuffer  *buffer;
    size_t       buffer_count;
    size_t       nodes, meshes; /* numbers of them in the document */
    double (*world)[12];        /* placements of the document's nodes: p_file = world (p_node, 1) */
    bool      *in_scene;        /* whether a node is in the scene, so that its world is set */
    int        node_room, drawn_room, drawn_count;
    GltfDrawn *drawn;
    int        shape_count, shape_room, draw_count, draw_room;
    GltfShape *shape;
    GltfDraw  *draw;
    int (*cached)[2]; /* for each mesh its first shape and their number; -1: not read yet */
} Gltf;

/* Member `key` when it is an index below `count`, else -1. */
int     gltf_index(const json_t *object, const char *key, size_t count);
json_t *gltf_item(const Gltf *g, const char *list, int index); /* NULL: there is no such item */
json_t *gltf_extension(const json_t *object, const char *name);
/* Reads `count` numbers. Returns false where there is no such array; *wrong: it is there, but is not an array of
 * `count` numbers. */
bool gltf_numbers(double *out, bool *wrong, const json_t *object, const char *key, size_t count);

/* ---- gltf_document.c ------------------------------------------------------------------------------ */

/* An accessor as doubles, `components` for each of *count, dequantised where it is normalised; malloc's. what: for
 * messages. `*out` is NULL after a failure. */
Status gltf_accessor(double **out, int *count, Gltf *g, int accessor, int components, const char *what);
/* Whether its numbers are in the file, and not in what an extension packs. */
bool gltf_accessor_is_stored(const Gltf *g, int accessor);
void gltf_buffers_close(Gltf *g);

/* ---- gltf_mesh.c ---------------------------------------------------------------------------------- */

/* Reads the shapes that `drawn` draws, and adds to shapes, draws and the scene's counts. */
Status gltf_draw(Gltf *g, const GltfDrawn *drawn);
void   gltf_shapes_close(Gltf *g);

/* ---- gltf_document.c ---------------------------------------------------------------------------- */

/* Refuses extensions that the file requires and this reader does not know; warns of ignored ones that concern shape. */
Status gltf_extensions(Gltf *g);
int    gltf_textures(const Gltf *g); /* number of uses of textures by materials */

/* Makes room for one more item of *list, whose items have `size` octets. */
bool gltf_room(void *list, int *room, int count, size_t size);
/* A 3 x 4 placement: out = a b. */
void gltf_place(double out[12], const double a[12], const double b[12]);

#endif
