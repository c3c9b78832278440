/* entities/import/assimp.c: files that assimp reads.
 *
 * assimp has crashed on broken files often enough that it reads in a child process, which hands the flat scene back in
 * a memory file: header, then arrays. The result is validated like untrusted input. */
#include "entities/import/assimp_library.h"
#include "entities/import/model_import_private.h"

#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <signal.h>
#include <unistd.h>

/* ---- in the child: assimp's files ---------------------------------------------------------------- */

/* The model `tank.obj.gz` is `tank.obj` to assimp; files it names (materials, buffers) are in the same folder. */
typedef struct Files {
    const char *path; /* as it is on disk */
    char shown[1024]; /* without .gz */
    size_t folder;    /* length of the folder's name with its slash */
    bool no_memory;     /* for a file of it */
    char refused[1100]; /* a file outside the folder, or what is no file */
} Files;

typedef struct OpenFile {
    struct aiFile file;
    char *bytes;
    size_t octets, at;
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
static void file_flush(struct aiFile *file) { (void)file; }

static enum aiReturn file_seek(struct aiFile *file, size_t offset, enum aiOrigin origin)
{
    OpenFile *f = (OpenFile *)file;
    const size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? f->at : f->octets;
    const size_t to = from + offset; /* a negative offset arrives as a large one, and wraps back */
    if (to > f->octets) return aiReturn_FAILURE;
    f->at = to;
    return aiReturn_SUCCESS;
}

/* The first name; assimp asks for a file several times, and by more than one. */
static void refuse(Files *files, const char *name)
{
    if (!*files->refused) snprintf(files->refused, sizeof files->refused, "%s", name);
}

static struct aiFile *files_open(struct aiFileIO *io, const char *name, const char *mode)
{
    Files *files = (Files *)io->UserData;
    char packed[1100];
    (void)mode;
    const bool is_model = strcmp(name, files->shown) == 0;
    if (!is_model && (strncmp(name, files->shown, files->folder) != 0 || strstr(name + files->folder, ".."))) {
        refuse(files, name);
        return NULL;
    }
    OpenFile *f = calloc(1, sizeof *f);
    Status status = f ? STATUS_OK : STATUS_NO_MEMORY;
    snprintf(packed, sizeof packed, "%s.gz", name);
    if (status == STATUS_OK) status = import_read_whole(&f->bytes, &f->octets, is_model ? files->path : name, true);
    if (status != STATUS_OK && status != STATUS_NO_MEMORY && !is_model)
        status = import_read_whole(&f->bytes, &f->octets, packed, true);
    if (status != STATUS_OK) {
        struct stat there;
        files->no_memory = files->no_memory || status == STATUS_NO_MEMORY;
        if (stat(name, &there) == 0 && !S_ISREG(there.st_mode)) refuse(files, name);
        free(f);
        return NULL;
    }
    f->file = (struct aiFile){file_read, file_write, file_tell, file_size, file_seek, file_flush, (char *)f};
    return &f->file;
}

static void files_close(struct aiFileIO *io, struct aiFile *file)
{
    (void)io;
    OpenFile *f = (OpenFile *)file;
    free(f->bytes);
    free(f);
}

/* ---- in the child: aiScene -> a memory file -------------------------------------------------------- */

typedef struct Header {
    int status;
    char said[256], refused[1100];
    int node_count, material_count, mesh_count, vertex_count, triangle_count;
    int lost[IMPORT_LOST_COUNT];
} Header;

static void copy_name(char out[model_name_size], const struct aiString *name)
{
    const size_t length = name->length < model_name_size - 1 ? name->length : model_name_size - 1;
    memcpy(out, name->data, length);
    out[length] = 0;
}

typedef struct Flat {
    ImportScene scene;
    const struct aiScene *source;
    const char *said; /* what is wrong */
} Flat;

/* Counts what the nodes below draw, meshes as often as they are drawn. */
static bool count_node(Flat *flat, const struct aiNode *node, int depth)
{
    ImportScene *s = &flat->scene;
    if (depth > import_max_depth)
        flat->said = "more than 256 levels of nodes";
    else if (++s->node_count > import_max_nodes)
        flat->said = "more than 65536 nodes";
    for (unsigned i = 0; i < node->mNumMeshes && !flat->said; i++) {
        const struct aiMesh *mesh = flat->source->mMeshes[node->mMeshes[i]];
        if (!(mesh->mPrimitiveTypes & aiPrimitiveType_TRIANGLE)) continue;
        if (mesh->mNumVertices > (unsigned)(import_max_vertices - s->vertex_count))
            flat->said = "more than 8 M vertices";
        else if (mesh->mNumFaces > (unsigned)(import_max_triangles - s->triangle_count))
            flat->said = "more than 8 M triangles";
        else if (++s->mesh_count > import_max_meshes)
            flat->said = "more than 16384 parts";
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
        float *n = s->normal[s->vertex_count++];
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
    ImportScene *s = &flat->scene;
    const struct aiMatrix4x4 *t = &node->mTransformation;
    const int index = s->node_count++;
    ImportNode *n = &s->node[index];
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
    struct aiString name = {0};
    struct aiColor4D colour;
    if (aiGetMaterialString(material, AI_MATKEY_NAME, &name) == aiReturn_SUCCESS) copy_name(out->name, &name);
    out->has_colour = aiGetMaterialColor(material, AI_MATKEY_BASE_COLOR, &colour) == aiReturn_SUCCESS ||
                      aiGetMaterialColor(material, AI_MATKEY_COLOR_DIFFUSE, &colour) == aiReturn_SUCCESS;
    /* a texture on white gives no colour */
    if (out->has_colour && aiGetMaterialTextureCount(material, aiTextureType_DIFFUSE) > 0) out->has_colour = 0;
    if (out->has_colour) out->rgb[0] = colour.r, out->rgb[1] = colour.g, out->rgb[2] = colour.b;
}

static bool scene_room(ImportScene *s)
{
    s->node = calloc((size_t)s->node_count + 1, sizeof *s->node);
    s->material = calloc((size_t)s->material_count + 1, sizeof *s->material);
    s->mesh = calloc((size_t)s->mesh_count + 1, sizeof *s->mesh);
    s->vertex = calloc((size_t)s->vertex_count + 1, sizeof *s->vertex);
    s->normal = calloc((size_t)s->vertex_count + 1, sizeof *s->normal);
    s->triangle = calloc((size_t)s->triangle_count + 1, sizeof *s->triangle);
    return s->node && s->material && s->mesh && s->vertex && s->normal && s->triangle;
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
        s->lost[LOST_POINTS_AND_LINES] += (source->mMeshes[m]->mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0;
    }
}

/* True when all of it went out. */
static bool put(int fd, const void *bytes, size_t octets)
{
    const char *at = bytes;
    while (octets > 0) {
        const ssize_t written = write(fd, at, octets);
        if (written <= 0) return false;
        at += written;
        octets -= (size_t)written;
    }
    return true;
}

static void child_reads(int fd, const char *path)
{
    Flat flat = {0};
    Header header = {.status = STATUS_BAD_VALUE};
    Files files = {.path = path};
    snprintf(files.shown, sizeof files.shown, "%s", path);
    const size_t length = strlen(files.shown);
    if (length > 3 && strcasecmp(files.shown + length - 3, ".gz") == 0) files.shown[length - 3] = 0;
    const char *slash = strrchr(files.shown, '/');
    files.folder = slash ? (size_t)(slash - files.shown) + 1 : 0;

    struct aiFileIO io = {files_open, files_close, (char *)&files};
    flat.source = aiImportFileEx(files.shown,
                                 aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_ValidateDataStructure, &io);
    if (!flat.source) {
        snprintf(header.said, sizeof header.said, "%s", aiGetErrorString());
    } else if (flat.source->mNumMaterials > import_max_materials) {
        flat.said = "more than 16384 materials";
    } else if (!flat.source->mRootNode || !count_node(&flat, flat.source->mRootNode, 1)) {
        if (!flat.said) flat.said = "no nodes";
    } else {
        ImportScene *s = &flat.scene;
        s->material_count = (int)flat.source->mNumMaterials;
        if (!scene_room(s)) {
            files.no_memory = true;
        } else {
            s->node_count = s->mesh_count = s->vertex_count = s->triangle_count = 0;
            fill_node(&flat, flat.source->mRootNode, -1);
            for (int m = 0; m < s->material_count; m++) fill_material(&s->material[m], flat.source->mMaterials[m]);
            count_lost(s, flat.source);
            s->lost[LOST_EXTERNAL_REFERENCES] = *files.refused != 0;
            snprintf(header.refused, sizeof header.refused, "%s", files.refused);
            header.status = STATUS_OK;
        }
    }
    if (files.no_memory) { /* without its materials, for example, it would be another model */
        header.status = STATUS_NO_MEMORY;
        flat.said = "out of memory";
    }
    if (flat.said) snprintf(header.said, sizeof header.said, "%s", flat.said);
    const ImportScene *s = &flat.scene;
    header.node_count = s->node_count;
    header.material_count = s->material_count;
    header.mesh_count = s->mesh_count;
    header.vertex_count = s->vertex_count;
    header.triangle_count = s->triangle_count;
    memcpy(header.lost, s->lost, sizeof header.lost);
    bool written = put(fd, &header, sizeof header);
    if (header.status == STATUS_OK)
        written = written && put(fd, s->node, (size_t)s->node_count * sizeof *s->node) &&
                  put(fd, s->material, (size_t)s->material_count * sizeof *s->material) &&
                  put(fd, s->mesh, (size_t)s->mesh_count * sizeof *s->mesh) &&
                  put(fd, s->vertex, (size_t)s->vertex_count * sizeof *s->vertex) &&
                  put(fd, s->normal, (size_t)s->vertex_count * sizeof *s->normal) &&
                  put(fd, s->triangle, (size_t)s->triangle_count * sizeof *s->triangle);
    _exit(written ? 0 : 3); /* no clean-up: the process is the clean-up */
}

/* Limits time and memory; no core file, no terminal output, ends with its parent. */
static void child_limits(void)
{
    const struct rlimit no_core = {0, 0}, cpu = {import_max_seconds, import_max_seconds + 1};
    setrlimit(RLIMIT_CORE, &no_core);
    setrlimit(RLIMIT_CPU, &cpu);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) /* their shadows are terabytes of address space */
    FILE *statm = fopen("/proc/self/statm", "r");
    unsigned long pages = 0;
    if (statm) {
        if (fscanf(statm, "%lu", &pages) != 1) pages = 0;
        fclose(statm);
    }
    if (pages > 0) {
        const rlim_t most = (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + import_max_memory;
        const struct rlimit memory = {most, most};
        setrlimit(RLIMIT_AS, &memory);
    }
#endif
    const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (nowhere >= 0) {
        dup2(nowhere, 0);
        dup2(nowhere, 1);
        dup2(nowhere, 2);
    }
}

/* ---- in the parent: what came back ------------------------------------------------------------------ */

static bool take(void *out, size_t octets, const char **at, const char *end)
{
    if ((size_t)(end - *at) < octets) return false;
    memcpy(out, *at, octets);
    *at += octets;
    return true;
}

static bool in_range(int value, int low, int high) { return value >= low && value <= high; }

/* False when an index or a count is not what a whole scene has. */
static bool scene_is_sound(ImportScene *s)
{
    int vertices = 0, triangles = 0;
    for (int i = 0; i < s->node_count; i++) {
        s->node[i].name[model_name_size - 1] = 0;
        if (i == 0 ? s->node[i].parent != -1 : !in_range(s->node[i].parent, 0, i - 1)) return false;
    }
    for (int i = 0; i < s->material_count; i++) s->material[i].name[model_name_size - 1] = 0;
    for (int i = 0; i < s->mesh_count; i++) {
        const ImportMesh *m = &s->mesh[i];
        if (!in_range(m->node, 0, s->node_count - 1) || !in_range(m->material, 0, s->material_count - 1)) return false;
        if (m->first_vertex != vertices || !in_range(m->vertex_count, 0, s->vertex_count - vertices)) return false;
        if (m->first_triangle != triangles || !in_range(m->triangle_count, 0, s->triangle_count - triangles))
            return false;
        vertices += m->vertex_count;
        triangles += m->triangle_count;
        for (int t = m->first_triangle; t < triangles; t++)
            for (int k = 0; k < 3; k++)
                if (s->triangle[t][k] >= (uint32_t)m->vertex_count) return false;
    }
    return vertices == s->vertex_count && triangles == s->triangle_count;
}

static Status take_scene(ImportScene *out, const char *bytes, size_t octets, const char *path)
{
    const char *at = bytes, *end = bytes + octets;
    Header header;
    ImportScene s = {0};
    if (!take(&header, sizeof header, &at, end)) goto broken;
    if (header.status != STATUS_OK) {
        char said[300];
        header.said[sizeof header.said - 1] = 0;
        text_escape(said, sizeof said, header.said, strlen(header.said));
        log_error("model: cannot be read: file=%s: %s", path, said);
        return header.status == STATUS_NO_MEMORY ? STATUS_NO_MEMORY : STATUS_BAD_VALUE;
    }
    if (!in_range(header.node_count, 1, import_max_nodes) ||
        !in_range(header.material_count, 0, import_max_materials) ||
        !in_range(header.mesh_count, 0, import_max_meshes) || !in_range(header.vertex_count, 0, import_max_vertices) ||
        !in_range(header.triangle_count, 0, import_max_triangles))
        goto broken;
    s.node_count = header.node_count;
    s.material_count = header.material_count;
    s.mesh_count = header.mesh_count;
    s.vertex_count = header.vertex_count;
    s.triangle_count = header.triangle_count;
    memcpy(s.lost, header.lost, sizeof s.lost);
    if (!scene_room(&s)) {
        import_scene_close(&s);
        return STATUS_NO_MEMORY;
    }
    if (!take(s.node, (size_t)s.node_count * sizeof *s.node, &at, end) ||
        !take(s.material, (size_t)s.material_count * sizeof *s.material, &at, end) ||
        !take(s.mesh, (size_t)s.mesh_count * sizeof *s.mesh, &at, end) ||
        !take(s.vertex, (size_t)s.vertex_count * sizeof *s.vertex, &at, end) ||
        !take(s.normal, (size_t)s.vertex_count * sizeof *s.normal, &at, end) ||
        !take(s.triangle, (size_t)s.triangle_count * sizeof *s.triangle, &at, end) || at != end || !scene_is_sound(&s))
        goto broken;
    header.refused[sizeof header.refused - 1] = 0;
    if (*header.refused)
        log_warn("model: %s names a file that is outside its folder or no regular file, and is left out: %s", path,
                 header.refused);
    *out = s;
    return STATUS_OK;

broken:
    import_scene_close(&s);
    log_error("model: cannot be read: file=%s: the reader came back with half a scene; is the file whole?", path);
    return STATUS_BAD_VALUE;
}

void import_scene_close(ImportScene *s)
{
    free(s->node);
    free(s->material);
    free(s->mesh);
    free(s->vertex);
    free(s->normal);
    free(s->triangle);
    free(s->dof);
    memset(s, 0, sizeof *s);
}

/* Default of forward and up axes: glTF's by its standard; assimp turns most others to y up as well; scanners and
 * printers (PLY, STL) have z up. */
static void format_axes(ImportScene *s, const char *extension)
{
    const bool z_up = strcmp(extension, "ply") == 0 || strcmp(extension, "stl") == 0;
    s->forward[z_up ? 0 : 2] = 1;
    s->up[z_up ? 2 : 1] = 1;
}

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
    status = STATUS_IO;
    const int fd = memfd_create("model", MFD_CLOEXEC);
    if (fd < 0) {
        log_error("model: cannot read: file=%s: memfd_create: %s", path, strerror(errno));
        return STATUS_IO;
    }
    const pid_t child = fork();
    if (child == 0) {
        child_limits();
        child_reads(fd, path);
    }
    int ended = 0;
    if (child < 0) {
        log_error("model: cannot read: file=%s: fork: %s", path, strerror(errno));
        goto done;
    }
    while (waitpid(child, &ended, 0) < 0)
        if (errno != EINTR) {
            log_error("model: cannot read: file=%s: waitpid: %s", path, strerror(errno));
            goto done;
        }
    status = STATUS_BAD_VALUE;
    if (WIFSIGNALED(ended) && (WTERMSIG(ended) == SIGXCPU || WTERMSIG(ended) == SIGKILL)) {
        log_error("model: cannot be read: file=%s: the reader took more than %d s", path, import_max_seconds);
        goto done;
    }
    if (!WIFEXITED(ended) || WEXITSTATUS(ended) != 0) {
        log_error("model: cannot be read: file=%s: the reader broke off (%s %d): the file is broken, or needs more "
                  "than %d MB",
                  path, WIFSIGNALED(ended) ? "signal" : "exit",
                  WIFSIGNALED(ended) ? WTERMSIG(ended) : WEXITSTATUS(ended), import_max_memory / 1000000);
        goto done;
    }
    struct stat info;
    if (fstat(fd, &info) != 0) info.st_size = 0;
    void *bytes = mmap(NULL, (size_t)info.st_size, PROT_READ, MAP_PRIVATE, fd, 0);
    if (bytes == MAP_FAILED) {
        log_error("model: cannot read: file=%s: nothing came back from the reader: %s", path, strerror(errno));
        status = STATUS_NO_MEMORY;
        goto done;
    }
    status = take_scene(out, bytes, (size_t)info.st_size, path);
    munmap(bytes, (size_t)info.st_size);
    if (status == STATUS_OK) format_axes(out, extension);

done:
    close(fd);
    return status;
}
