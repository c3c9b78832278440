/* entities/import/assimp.c: files that assimp reads, in the reader's process. */

#include "entities/import/reader_private.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <stdlib.h>

/* The functions of assimp that are called here. */
/* clang-format off */
#define ASSIMP(X)                                                                                                    \
    X(aiCreatePropertyStore) X(aiGetErrorString) X(aiGetMaterialColor) X(aiGetMaterialString)                        \
    X(aiGetMaterialTextureCount) X(aiImportFileExWithProperties) X(aiIsExtensionSupported)                           \
    X(aiSetImportPropertyInteger)
/* clang-format on */
LIBRARY(assimp_library, ASSIMP, "assimp", PITVIPER_ASSIMP_FILE, "libassimp5");

/* ---- assimp's files --------------------------------------------------------------------------------- */

/* What the text of the model states and assimp does not hand on. */
typedef struct FileText {
    const char *extension;
    bool        has_unit, has_up;    /* of FBX and COLLADA */
    char        unit[24], up[24];    /* of COLLADA: the words of the file */
    double      stated_m, comment_m; /* unit that the format, or a comment, states; 0: none */
    char        stated[24], comment[24];
} FileText;

typedef struct Files {
    ReaderFiles *files;
    ReaderSaid  *said;
    ImportScene *scene;
    FileText     text;
    Status       status; /* of reading the model's own text */
    char  *bytes; /* the model's own text; NULL: not read yet. It is kept because assimp opens the file several times */
    size_t octets;
} Files;

typedef struct OpenFile {
    struct aiFile file;
    char         *bytes;
    size_t        octets, at;
    bool          shared; /* the bytes are shared with other openings */
} OpenFile;

static size_t file_read(struct aiFile *file, char *out, size_t size, size_t count)
{
    OpenFile *f = (OpenFile *)file;
    if (size == 0) return 0;
    const size_t whole = (f->octets - f->at) / size;
    if (count > whole) count = whole;
    memcpy(out, f->bytes + f->at, size * count);
    f->at += size * count;
    return count;
}

static size_t file_write(struct aiFile *file, const char *in, size_t size, size_t count)
{
    (void)file, (void)in, (void)size, (void)count;
    return 0;
}

static size_t file_tell(struct aiFile *file) { return ((OpenFile *)file)->at; }
static size_t file_size(struct aiFile *file) { return ((OpenFile *)file)->octets; }
static void   file_flush(struct aiFile *file) { (void)file; }

static enum aiReturn file_seek(struct aiFile *file, size_t offset, enum aiOrigin origin)
{
    OpenFile    *f = (OpenFile *)file;
    const size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? f->at : f->octets;
    const size_t to = from + offset; /* a negative offset arrives as a large one, and wraps back */
    if (to > f->octets) return aiReturn_FAILURE;
    f->at = to;
    return aiReturn_SUCCESS;
}

/* What follows `key` in the octets, up to one of `stop`. */
static bool find_after(char out[24], const char *bytes, size_t octets, const char *key, const char *stop)
{
    const char *at = memmem(bytes, octets, key, strlen(key));
    if (!at) return false;
    at += strlen(key);
    size_t n = 0;
    while (at + n < bytes + octets && n < 23 && !strchr(stop, at[n])) n++;
    memcpy(out, at, n);
    out[n] = 0;
    return true;
}

/* Reads the model's own octets before assimp does. */
static Status see_model(Files *file)
{
    FileText *t = &file->text;
    char      none[24];
    if (strcmp(t->extension, "fbx") == 0) {
        t->has_unit = find_after(none, file->bytes, file->octets, "UnitScaleFactor", "");
        t->has_up = find_after(none, file->bytes, file->octets, "UpAxis", "");
    } else if (strcmp(t->extension, "dae") == 0) {
        const char  *unit = memmem(file->bytes, file->octets, "<unit", 5);
        const size_t left = unit ? file->octets - (size_t)(unit - file->bytes) : 0;
        const char  *end = unit ? memchr(unit, '>', left) : NULL;
        t->has_unit = end && find_after(t->unit, unit, (size_t)(end - unit), "meter=\"", "\"");
        t->has_up = find_after(t->up, file->bytes, file->octets, "<up_axis>", "< \t\r\n");
    } else {
        t->stated_m = import_stated_unit(t->stated, t->extension, file->bytes, file->octets);
        const bool stl = strcmp(t->extension, "stl") == 0, obj = strcmp(t->extension, "obj") == 0;
        if (obj || stl || strcmp(t->extension, "ply") == 0)
            t->comment_m = import_comment_unit(t->comment, file->bytes, file->octets);
        if (obj) return import_obj_plain(&file->bytes, &file->octets, file->scene->lost, file->said, file->files);
    }
    return STATUS_OK;
}

static struct aiFile *files_open(struct aiFileIO *io, const char *name, const char *mode)
{
    Files *files = (Files *)io->UserData;
    (void)mode;
    const bool is_model = strcmp(name, files->files->shown) == 0;
    OpenFile  *f = calloc(1, sizeof *f);
    Status     status = f ? STATUS_OK : STATUS_NO_MEMORY;
    if (status == STATUS_OK && !is_model) status = reader_read(&f->bytes, &f->octets, files->files, name);
    if (status == STATUS_OK && is_model && !files->bytes) {
        status = reader_read(&files->bytes, &files->octets, files->files, name);
        if (status == STATUS_OK) status = files->status = see_model(files);
    }
    if (status == STATUS_OK) status = is_model ? files->status : STATUS_OK;
    if (status != STATUS_OK) {
        files->files->no_memory = files->files->no_memory || status == STATUS_NO_MEMORY;
        free(f);
        return NULL;
    }
    if (is_model) f->bytes = files->bytes, f->octets = files->octets, f->shared = true;
    f->file = (struct aiFile){file_read, file_write, file_tell, file_size, file_seek, file_flush, (char *)f};
    return &f->file;
}

static void files_close(struct aiFileIO *io, struct aiFile *file)
{
    (void)io;
    OpenFile *f = (OpenFile *)file;
    if (!f->shared) free(f->bytes);
    free(f);
}

/* ---- aiScene -> a flat scene ------------------------------------------------------------------------ */

static void copy_name(char out[model_name_size], const struct aiString *name)
{
    const size_t length = name->length < model_name_size - 1 ? name->length : model_name_size - 1;
    memcpy(out, name->data, length);
    out[length] = 0;
}

typedef struct Flat {
    ImportScene           scene;
    const struct aiScene *source;
    const char           *said; /* what is wrong with it */
} Flat;

/* Counts what the nodes below draw, meshes as often as they are drawn. */
static bool count_node(Flat *flat, const struct aiNode *node, int depth)
{
    ImportScene *s = &flat->scene;
    if (depth > import_max_depth) flat->said = "more than 256 levels of nodes";
    else if (++s->node_count > import_max_nodes) flat->said = "more than 65536 nodes";
    for (unsigned i = 0; i < node->mNumMeshes && !flat->said; i++) {
        const struct aiMesh *mesh = flat->source->mMeshes[node->mMeshes[i]];
        if (!(mesh->mPrimitiveTypes & aiPrimitiveType_TRIANGLE)) continue;
        if (mesh->mNumVertices > (unsigned)(import_max_vertices - s->vertex_count))
            flat->said = "more than 8 M vertices";
        else if (mesh->mNumFaces > (unsigned)(import_max_triangles - s->triangle_count))
            flat->said = "more than 8 M triangles";
        else if (++s->mesh_count > import_max_meshes) flat->said = "more than 16384 parts";
        if (flat->said) return false;
        s->vertex_count += (int)mesh->mNumVertices;
        s->triangle_count += (int)mesh->mNumFaces;
    }
    for (unsigned i = 0; i < node->mNumChildren && !flat->said; i++) count_node(flat, node->mChildren[i], depth + 1);
    return !flat->said;
}

static void fill_mesh(ImportScene *s, const struct aiMesh *mesh, int node)
{
    ImportMesh *m = &s->mesh[s->mesh_count++];
    *m = (ImportMesh){.node = node,
                      .material = (int)mesh->mMaterialIndex,
                      .first_vertex = s->vertex_count,
                      .vertex_count = (int)mesh->mNumVertices,
                      .first_triangle = s->triangle_count,
                      .has_normals = mesh->mNormals != NULL};
    for (unsigned v = 0; v < mesh->mNumVertices; v++) {
        double *p = s->vertex[s->vertex_count];
        float  *n = s->normal[s->vertex_count++];
        p[0] = mesh->mVertices[v].x, p[1] = mesh->mVertices[v].y, p[2] = mesh->mVertices[v].z;
        if (mesh->mNormals) n[0] = mesh->mNormals[v].x, n[1] = mesh->mNormals[v].y, n[2] = mesh->mNormals[v].z;
    }
    for (unsigned f = 0; f < mesh->mNumFaces; f++) {
        if (mesh->mFaces[f].mNumIndices != 3) continue;
        for (int k = 0; k < 3; k++) s->triangle[s->triangle_count][k] = mesh->mFaces[f].mIndices[k];
        s->triangle_count++;
        m->triangle_count++;
    }
}

static void fill_node(Flat *flat, const struct aiNode *node, int parent)
{
    ImportScene              *s = &flat->scene;
    const struct aiMatrix4x4 *t = &node->mTransformation;
    const int                 index = s->node_count++;
    ImportNode               *n = &s->node[index];
    copy_name(n->name, &node->mName);
    n->parent = parent;
    const double m[12] = {t->a1, t->a2, t->a3, t->a4, t->b1, t->b2, t->b3, t->b4, t->c1, t->c2, t->c3, t->c4};
    memcpy(n->m, m, sizeof m);
    for (unsigned i = 0; i < node->mNumMeshes; i++) {
        const struct aiMesh *mesh = flat->source->mMeshes[node->mMeshes[i]];
        if (mesh->mPrimitiveTypes & aiPrimitiveType_TRIANGLE) fill_mesh(s, mesh, index);
    }
    for (unsigned i = 0; i < node->mNumChildren; i++) fill_node(flat, node->mChildren[i], index);
}

static void fill_material(ImportMaterial *out, const struct aiMaterial *material)
{
    struct aiString  name = {0};
    struct aiColor4D colour;
    if (aiGetMaterialString(material, AI_MATKEY_NAME, &name) == aiReturn_SUCCESS) copy_name(out->name, &name);
    out->has_colour = aiGetMaterialColor(material, AI_MATKEY_BASE_COLOR, &colour) == aiReturn_SUCCESS ||
                      aiGetMaterialColor(material, AI_MATKEY_COLOR_DIFFUSE, &colour) == aiReturn_SUCCESS;
    /* a texture on white gives no colour */
    if (out->has_colour && aiGetMaterialTextureCount(material, aiTextureType_DIFFUSE) > 0) out->has_colour = 0;
    if (out->has_colour) out->rgb[0] = colour.r, out->rgb[1] = colour.g, out->rgb[2] = colour.b;
}

static int count_textures(const struct aiScene *source)
{
    int count = 0;
    for (unsigned m = 0; m < source->mNumMaterials; m++)
        for (int type = aiTextureType_DIFFUSE; type <= AI_TEXTURE_TYPE_MAX; type++)
            count += aiGetMaterialTextureCount(source->mMaterials[m], (enum aiTextureType)type) > 0;
    return count;
}

static void count_lost(ImportScene *s, const struct aiScene *source)
{
    s->lost[LOST_TEXTURES] = count_textures(source);
    s->lost[LOST_LIGHTS] = (int)source->mNumLights;
    s->lost[LOST_CAMERAS] = (int)source->mNumCameras;
    s->lost[LOST_ANIMATIONS] = (int)source->mNumAnimations;
    for (unsigned m = 0; m < source->mNumMeshes; m++) {
        s->lost[LOST_BONES] += (int)source->mMeshes[m]->mNumBones;
        s->lost[LOST_MORPH_TARGETS] += (int)source->mMeshes[m]->mNumAnimMeshes;
        s->lost[LOST_POINTS_AND_LINES] += (source->mMeshes[m]->mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0;
    }
}

/* ---- unit and axes ---------------------------------------------------------------------------------- */

/* A number in the scene's metadata; `otherwise` when it has none. */
static double metadata(const struct aiScene *source, const char *key, double otherwise)
{
    const struct aiMetadata *m = source->mMetaData;
    for (unsigned i = 0; m && i < m->mNumProperties; i++) {
        if (strcmp(m->mKeys[i].data, key) != 0) continue;
        const void *data = m->mValues[i].mData;
        char        text[32];
        double      value;
        switch (m->mValues[i].mType) {
        case AI_INT32:
            return *(const int32_t *)data;
        case AI_DOUBLE:
            return *(const double *)data;
        case AI_FLOAT: /* 2.54f is meant as 2.54 */
            snprintf(text, sizeof text, "%.7g", (double)*(const float *)data);
            return text_to_double(&value, text) ? value : otherwise;
        default:
            return otherwise;
        }
    }
    return otherwise;
}

/* An axis in FBX's settings: 0 .. 2 and a sign. Returns false when there is none. */
static bool fbx_axis(double out[3], const struct aiScene *source, const char *axis, int otherwise)
{
    char sign[24];
    snprintf(sign, sizeof sign, "%sSign", axis);
    const int k = (int)metadata(source, axis, otherwise);
    if (k < 0 || k > 2) return false;
    memset(out, 0, 3 * sizeof *out);
    out[k] = metadata(source, sign, 1) < 0 ? -1 : 1;
    return true;
}

/* FBX says centimetres a unit, which way is up, and which way a figure looks that faces who looks at it (FrontAxis);
 * CoordAxis, to the right of who looks, only tells left-handed axes, which are mirrored. */
static void fbx_frame(ImportScene *s, const struct aiScene *source, const FileText *text, ReaderSaid *said)
{
    double       forward[3], up[3], right[3], coordinate[3];
    const double factor = metadata(source, "UnitScaleFactor", 1);
    const bool   fine = factor > 1e-6 && factor < 1e9;
    if (!fine)
        reader_warns(said, "UnitScaleFactor %g is no unit: taken as centimetres; `scale` in its sidecar says otherwise",
                     factor);
    s->unit_m = 0.01 * (fine ? factor : 1);
    snprintf(s->unit_from, sizeof s->unit_from,
             text->has_unit ? "the file's UnitScaleFactor, %g cm" : "FBX's default, centimetres: the file says none",
             fine ? factor : 1);
    if (!fbx_axis(up, source, "UpAxis", 1)) {
        reader_warns(said, "UpAxis is no axis: taken as y up, z forward; `axes` in its sidecar says otherwise");
        return;
    }
    if (!fbx_axis(forward, source, "FrontAxis", 2) || v3_dot(up, forward) != 0) {
        memcpy(forward, up[2] != 0 ? (const double[3]){0, -1, 0} : (const double[3]){0, 0, 1}, sizeof forward);
        reader_warns(said, "FrontAxis is no axis beside UpAxis: taken as %s; `axes` in its sidecar says otherwise",
                     up[2] != 0 ? "-y" : "+z");
    }
    memcpy(s->up, up, sizeof up);
    memcpy(s->forward, forward, sizeof forward);
    v3_cross(right, up, forward);
    s->mirrored = fbx_axis(coordinate, source, "CoordAxis", 0) && v3_dot(right, coordinate) < 0;
    for (int i = 0; i < 12 && s->mirrored;
         i++) /* the root's first row, which changes the sign of one coordinate of the file */
        if (right[i / 4] != 0) s->node[0].m[i] = -s->node[0].m[i] + 0.0;
    snprintf(s->axes_from, sizeof s->axes_from, "%s%s",
             text->has_up ? "the file's UpAxis and FrontAxis" : "FBX's default: the file says none",
             s->mirrored ? ", left-handed by its CoordAxis: mirrored" : "");
}

/* Sets unit and axes by the format: assimp turns most formats to y up; those of scanners and printers (PLY, STL) have z
 * up. */
static void frame(ImportScene *s, const struct aiScene *source, const FileText *text, ReaderSaid *said)
{
    const char *e = text->extension;
    const bool  printed = strcmp(e, "3mf") == 0 || strcmp(e, "amf") == 0;
    const bool  z_up = printed || strcmp(e, "ply") == 0 || strcmp(e, "stl") == 0;
    memset(s->forward, 0, sizeof s->forward);
    memset(s->up, 0, sizeof s->up);
    s->forward[z_up ? 0 : 2] = 1;
    s->up[z_up ? 2 : 1] = 1;
    s->unit_m = 1;
    snprintf(s->unit_from, sizeof s->unit_from, "the format names no unit: metres");
    snprintf(s->axes_from, sizeof s->axes_from, "the format's habit");
    if (strcmp(e, "fbx") == 0) fbx_frame(s, source, text, said);
    if (strcmp(e, "dae") == 0) {
        if (text->has_unit)
            snprintf(s->unit_from, sizeof s->unit_from, "the file's <unit meter=\"%.20s\">, applied", text->unit);
        else snprintf(s->unit_from, sizeof s->unit_from, "COLLADA's default, metres: the file says none");
        if (text->has_up)
            snprintf(s->axes_from, sizeof s->axes_from, "the file's <up_axis> %.20s, turned to y up", text->up);
        else snprintf(s->axes_from, sizeof s->axes_from, "COLLADA's default: the file says none");
    }
    if (text->stated_m > 0) {
        s->unit_m = text->stated_m;
        if (text->stated[0]) snprintf(s->unit_from, sizeof s->unit_from, "the file's unit, %s", text->stated);
        else snprintf(s->unit_from, sizeof s->unit_from, "the format's default, millimetres: the file says none");
    }
    if (text->comment_m > 0 && text->comment_m != 1)
        reader_warns(
            said,
            "a comment says `%s`, the format has no unit: taken as metres; `scale: %g` in its sidecar takes it so",
            text->comment, text->comment_m);
}

static Status assimp_read(ImportScene *s, ReaderSaid *said, ReaderFiles *files, const char *extension)
{
    Flat                    flat = {0};
    Files                   own = {.files = files, .said = said, .scene = s, .text = {.extension = extension}};
    struct aiFileIO         io = {files_open, files_close, (char *)&own};
    struct aiPropertyStore *store = aiCreatePropertyStore();
    if (!store) return STATUS_NO_MEMORY;
    /* later versions turn FBX by themselves, but do not scale it */
    aiSetImportPropertyInteger(store, "AI_CONFIG_IMPORT_FBX_IGNORE_UP_DIRECTION", 1);
    flat.source = aiImportFileExWithProperties(
        files->shown, aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_ValidateDataStructure, &io, store);
    if (own.status != STATUS_OK) return own.status;
    if (!flat.source) return reader_fails(said, STATUS_BAD_VALUE, "%s", aiGetErrorString());
    if (flat.source->mNumMaterials > import_max_materials)
        return reader_fails(said, STATUS_BAD_VALUE, "more than 16384 materials");
    if (!flat.source->mRootNode || !count_node(&flat, flat.source->mRootNode, 1))
        return reader_fails(said, STATUS_BAD_VALUE, "%s", flat.said ? flat.said : "no nodes");
    memcpy(flat.scene.lost, s->lost, sizeof s->lost);
    *s = flat.scene;
    s->material_count = (int)flat.source->mNumMaterials;
    if (!import_scene_room(s)) return STATUS_NO_MEMORY;
    flat.scene = *s;
    flat.scene.node_count = flat.scene.mesh_count = flat.scene.vertex_count = flat.scene.triangle_count = 0;
    fill_node(&flat, flat.source->mRootNode, -1);
    *s = flat.scene;
    for (int m = 0; m < s->material_count; m++) fill_material(&s->material[m], flat.source->mMaterials[m]);
    count_lost(s, flat.source);
    frame(s, flat.source, &own.text, said);
    return STATUS_OK;
}

/* ---- in the parent ---------------------------------------------------------------------------------- */

Status import_assimp(ImportScene *out, const char *path, const char *extension)
{
    char   dotted[40];
    Status status = library_load(&assimp_library);
    if (status != STATUS_OK) return status;
    snprintf(dotted, sizeof dotted, ".%s", extension);
    if (!*extension || aiIsExtensionSupported(dotted) != AI_TRUE) {
        log_error(
            "model: no reader: file=%s: `.%s` is not a format that assimp or osgconv reads; convert it to glTF or OBJ",
            path, extension);
        return STATUS_UNSUPPORTED;
    }
    return reader_run(out, assimp_read, path, extension);
}
