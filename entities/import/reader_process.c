/* entities/import/reader_process.c: a reader of model files in a process of its own, and the files that it sees.
 *
 * Readers have crashed on broken files often enough: they run in a child, which hands the flat scene back in memory
 * that both have: header, then arrays. The result is validated like untrusted input. */
#include "entities/import/reader_private.h"
#include "pitviper_confine.h"
#include "pitviper_file.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <strings.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

/* ---- files: the model's own and those of its folder ------------------------------------------- */

void reader_files(ReaderFiles *out, const char *path)
{
    *out = (ReaderFiles){.path = path};
    snprintf(out->shown, sizeof out->shown, "%s", path);
    const size_t length = strlen(out->shown);
    if (length > 3 && strcasecmp(out->shown + length - 3, ".gz") == 0) out->shown[length - 3] = 0;
    const char *slash = strrchr(out->shown, '/');
    out->folder = slash ? (size_t)(slash - out->shown) + 1 : 0;
}

/* The first name; a library asks for a file several times, and by more than one. */
static Status refuse(ReaderFiles *files, const char *name)
{
    if (!*files->refused) snprintf(files->refused, sizeof files->refused, "%s", name);
    return STATUS_IO;
}

Status reader_read(char **out, size_t *octets, ReaderFiles *files, const char *name)
{
    char        packed[1100];
    struct stat there;
    const bool  is_model = strcmp(name, files->shown) == 0;
    if (!is_model && (strncmp(name, files->shown, files->folder) != 0 || strstr(name + files->folder, "..") ||
                      name[files->folder] == '/'))
        return refuse(files, name);
    Status status = import_read_whole(out, octets, is_model ? files->path : name, true);
    snprintf(packed, sizeof packed, "%s.gz", name);
    if (status != STATUS_OK && status != STATUS_NO_MEMORY && !is_model)
        status = import_read_whole(out, octets, packed, true);
    files->no_memory = files->no_memory || status == STATUS_NO_MEMORY;
    if (status != STATUS_OK && stat(name, &there) == 0 && !S_ISREG(there.st_mode)) return refuse(files, name);
    return status;
}

Status reader_fails(ReaderSaid *said, Status status, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vsnprintf(said->error, sizeof said->error, format, list);
    va_end(list);
    return status;
}

void reader_warns(ReaderSaid *said, const char *format, ...)
{
    if (said->warnings == sizeof said->warning / sizeof *said->warning) return;
    va_list list;
    va_start(list, format);
    vsnprintf(said->warning[said->warnings++], sizeof *said->warning, format, list);
    va_end(list);
}

/* ---- whole files ---------------------------------------------------------------------------- */

Status import_read_whole(char **out, size_t *octets, const char *path, bool quiet)
{
    char        refused[file_why_size];
    const char *why = NULL;
    const int   file_at = file_open(refused, NULL, path, FILE_FROM_DISK);
    gzFile      file = NULL;
    char       *text = NULL;
    size_t      size = 0, capacity = 1 << 16;
    Status      status = STATUS_IO;

    if (file_at < 0) why = refused;
    else if (!(file = gzdopen(file_at, "rb"))) {
        why = strerror(errno);
        close(file_at);
    }
    while (!why) {
        char *larger = realloc(text, capacity + 1);
        if (!larger) {
            status = STATUS_NO_MEMORY;
            why = "no memory";
            break;
        }
        text = larger;
        const int got = gzread(file, text + size, (unsigned)(capacity - size));
        int       code;
        if (got > 0) size += (size_t)got;
        gzerror(file, &code);
        if (got < 0 || (code != Z_OK && code != Z_STREAM_END)) {
            status = STATUS_BAD_VALUE;
            why = "the packed data are broken or cut short";
        } else if (size < capacity) {
            break;
        } else if (capacity >= import_max_octets) {
            status = STATUS_BAD_VALUE;
            why = "larger than 256 MiB";
        } else {
            capacity *= 2;
        }
    }
    if (file) gzclose(file);
    if (why) {
        if (!quiet) log_error("model: cannot read: file=%s: %s", path, why);
        free(text);
        return status;
    }
    text[size] = 0;
    *out = text;
    *octets = size;
    return STATUS_OK;
}

/* ---- the scene in shared memory --------------------------------------------------------------- */

/* The scene's pointers mean nothing to the other side. */
typedef struct Header {
    int         status;
    ReaderSaid  said;
    char        refused[1100];
    ImportScene scene;
} Header;

bool import_scene_room(ImportScene *s)
{
    s->node = calloc((size_t)s->node_count + 1, sizeof *s->node);
    s->material = calloc((size_t)s->material_count + 1, sizeof *s->material);
    s->mesh = calloc((size_t)s->mesh_count + 1, sizeof *s->mesh);
    s->vertex = calloc((size_t)s->vertex_count + 1, sizeof *s->vertex);
    s->normal = calloc((size_t)s->vertex_count + 1, sizeof *s->normal);
    s->triangle = calloc((size_t)s->triangle_count + 1, sizeof *s->triangle);
    return s->node && s->material && s->mesh && s->vertex && s->normal && s->triangle;
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

/* ---- in the child -------------------------------------------------------------------------------- */

static char *put(char *at, const void *bytes, size_t octets)
{
    memcpy(at, bytes, octets);
    return at + octets;
}

static void child_reads(char *out, Reader *read, const char *path, const char *extension)
{
    static Header header; /* large for a stack */
    ReaderFiles   files;
    reader_files(&files, path);
    ImportScene *s = &header.scene;
    header.status = read(s, &header.said, &files, extension);
    if (files.no_memory ||
        header.status == STATUS_NO_MEMORY) /* without its materials, for example, it would be another */
        header.status = reader_fails(&header.said, STATUS_NO_MEMORY, "out of memory");
    s->lost[LOST_EXTERNAL_REFERENCES] += *files.refused != 0;
    snprintf(header.refused, sizeof header.refused, "%s", files.refused);
    out = put(out, &header, sizeof header);
    if (header.status == STATUS_OK) {
        out = put(out, s->node, (size_t)s->node_count * sizeof *s->node);
        out = put(out, s->material, (size_t)s->material_count * sizeof *s->material);
        out = put(out, s->mesh, (size_t)s->mesh_count * sizeof *s->mesh);
        out = put(out, s->vertex, (size_t)s->vertex_count * sizeof *s->vertex);
        out = put(out, s->normal, (size_t)s->vertex_count * sizeof *s->normal);
        put(out, s->triangle, (size_t)s->triangle_count * sizeof *s->triangle);
    }
    _exit(0); /* no clean-up: the process is the clean-up */
}

/* Limits time and memory; no core file, no terminal output, ends with its parent. */
static void child_limits(void)
{
    const struct rlimit no_core = {0, 0}, cpu = {import_max_seconds, import_max_seconds + 1};
    setrlimit(RLIMIT_CORE, &no_core);
    setrlimit(RLIMIT_CPU, &cpu);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) /* their shadows are terabytes of address space */
    FILE         *statm = fopen("/proc/self/statm", "r");
    unsigned long pages = 0;
    if (statm) {
        if (fscanf(statm, "%lu", &pages) != 1) pages = 0;
        fclose(statm);
    }
    if (pages > 0) {
        const rlim_t        most = (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + import_max_memory;
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

static bool is_axis(const double a[3]) { return v3_dot(a, a) == 1 && fabs(a[0]) + fabs(a[1]) + fabs(a[2]) == 1; }

bool import_scene_is_sound(ImportScene *s)
{
    int vertices = 0, triangles = 0;
    if (!is_axis(s->forward) || !is_axis(s->up) || v3_dot(s->forward, s->up) != 0) return false;
    if (!(s->unit_m >= 1e-9 && s->unit_m <= 1e9)) return false;
    s->unit_from[sizeof s->unit_from - 1] = s->axes_from[sizeof s->axes_from - 1] = 0;
    for (int i = 0; i < IMPORT_LOST_COUNT; i++)
        if (s->lost[i] < 0) return false;
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

static void log_said(Header *header, const char *path)
{
    char      said[1400];
    const int most = (int)(sizeof header->said.warning / sizeof *header->said.warning);
    for (int i = 0; i < header->said.warnings && i < most; i++) {
        header->said.warning[i][sizeof *header->said.warning - 1] = 0;
        text_escape(said, sizeof said, header->said.warning[i], strlen(header->said.warning[i]));
        log_warn("model: %s: %s", path, said);
    }
    header->refused[sizeof header->refused - 1] = 0;
    text_escape(said, sizeof said, header->refused, strlen(header->refused));
    if (*header->refused)
        log_warn("model: %s names a file that is outside its folder or no regular file, and is left out: %s", path,
                 said);
}

static Status take_scene(ImportScene *out, const char *bytes, size_t octets, const char *path)
{
    const char                 *at = bytes, *end = bytes + octets;
    static _Thread_local Header header;
    ImportScene                 s = {0};
    if (!take(&header, sizeof header, &at, end)) goto broken;
    if (header.status != STATUS_OK) {
        char said[1000];
        header.said.error[sizeof header.said.error - 1] = 0;
        text_escape(said, sizeof said, header.said.error, strlen(header.said.error));
        log_error("model: cannot be read: file=%s: %s", path, said);
        return header.status == STATUS_NO_MEMORY || header.status == STATUS_UNSUPPORTED ? (Status)header.status
                                                                                        : STATUS_BAD_VALUE;
    }
    if (!in_range(header.scene.node_count, 1, import_max_nodes) ||
        !in_range(header.scene.material_count, 0, import_max_materials) ||
        !in_range(header.scene.mesh_count, 0, import_max_meshes) ||
        !in_range(header.scene.vertex_count, 0, import_max_vertices) ||
        !in_range(header.scene.triangle_count, 0, import_max_triangles))
        goto broken;
    s = header.scene;
    s.dof_count = 0;
    s.dof = NULL;
    if (!import_scene_room(&s)) {
        import_scene_close(&s);
        return STATUS_NO_MEMORY;
    }
    if (!take(s.node, (size_t)s.node_count * sizeof *s.node, &at, end) ||
        !take(s.material, (size_t)s.material_count * sizeof *s.material, &at, end) ||
        !take(s.mesh, (size_t)s.mesh_count * sizeof *s.mesh, &at, end) ||
        !take(s.vertex, (size_t)s.vertex_count * sizeof *s.vertex, &at, end) ||
        !take(s.normal, (size_t)s.vertex_count * sizeof *s.normal, &at, end) ||
        !take(s.triangle, (size_t)s.triangle_count * sizeof *s.triangle, &at, end) || !import_scene_is_sound(&s))
        goto broken;
    log_said(&header, path);
    *out = s;
    return STATUS_OK;

broken:
    import_scene_close(&s);
    log_error("model: cannot be read: file=%s: the reader came back with half a scene; is the file whole?", path);
    return STATUS_BAD_VALUE;
}

Status reader_run(ImportScene *out, Reader *read, const char *path, const char *extension)
{
    /* a whole scene of the most that is read; pages are taken as they are written */
    const size_t most = sizeof(Header) + import_max_nodes * sizeof(ImportNode) +
                        import_max_materials * sizeof(ImportMaterial) + import_max_meshes * sizeof(ImportMesh) +
                        import_max_vertices * (sizeof(double[3]) + sizeof(float[3])) +
                        import_max_triangles * sizeof(uint32_t[3]);
    Status status = STATUS_IO;
    char  *shared = mmap(NULL, most, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (shared == MAP_FAILED) {
        log_error("model: cannot read: file=%s: no memory for its reader: %s", path, strerror(errno));
        return STATUS_NO_MEMORY;
    }
    const pid_t child = fork();
    if (child == 0) {
        child_limits();
        char        why[confine_why_size], folder[1100];
        const char *slash = strrchr(path, '/');
        snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path) + 1 : 1, slash ? path : ".");
        const char *const readable[] = {folder, path}; /* the model itself may be a link */
        confine_limits(import_max_memory);
        confine_files(why, readable, 2); /* without Landlock reader_read's rule still holds */
        if (!confine_calls(why)) _exit(4);
        child_reads(shared, read, path, extension);
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
    status = take_scene(out, shared, most, path);

done:
    munmap(shared, most);
    return status;
}
