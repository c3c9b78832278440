/* entities/import/osg_text.c: OpenFlight into OpenSceneGraph's text, by osgconv in a process of its own, with limits on
 * time and memory. */

#include "entities/import/model_import_private.h"
#include "pitviper_confine.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Waits for a process, up to `seconds`; false: it had to be stopped. */
static bool wait_for(int *ended, pid_t child, double seconds)
{
    const double until = wall_clock_s() + seconds;
    for (;;) {
        const pid_t got = waitpid(child, ended, WNOHANG);
        if (got == child || (got < 0 && errno != EINTR)) return got == child;
        if (wall_clock_s() > until) break;
        nanosleep(&(struct timespec){0, 5000000}, NULL);
    }
    kill(child, SIGKILL);
    while (waitpid(child, ended, 0) < 0 && errno == EINTR) {
    }
    return false;
}

/* This process's environment without the variables that steer OpenSceneGraph, whose optimizer would merge named nodes.
 * */
static char **osg_environment(void)
{
    size_t count = 0, kept = 0;
    while (environ[count]) count++;
    char **out = calloc(count + 2, sizeof *out);
    if (!out) return NULL;
    for (size_t i = 0; i < count; i++)
        if (strncmp(environ[i], "OSG_", 4) != 0) out[kept++] = environ[i];
    static char off[] = "OSG_OPTIMIZER=OFF";
    out[kept] = off;
    return out;
}

static Status convert(const char *from, const char *to, const char *path)
{
    char  program[] = "osgconv", option[] = "-O", options[] = "preserveObject precision 9";
    char *argument[] = {program, option, options, (char *)(uintptr_t)from, (char *)(uintptr_t)to, NULL};
    pid_t child;
    int   ended = 0;
    enum { not_there = 127 };
    char **environment = osg_environment();
    if (!environment) return STATUS_NO_MEMORY;
    child = fork();
    if (child == 0) { /* without network: osgconv would fetch what a file names by address */
        char      why[confine_why_size];
        const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
        for (int fd = 0; fd < 3; fd++) dup2(nowhere, fd);
        if (!confine_network(why)) _exit(not_there - 1);
        execvpe(program, argument, environment);
        _exit(errno == ENOENT ? not_there : not_there - 1);
    }
    free(environment);
    if (child < 0) {
        log_error("model: cannot convert: file=%s: fork: %s", path, strerror(errno));
        return STATUS_IO;
    }
    const struct rlimit memory = {2 * (rlim_t)import_max_memory, 2 * (rlim_t)import_max_memory}, no_core = {0, 0},
                        size = {import_max_octets, import_max_octets};
    prlimit(child, RLIMIT_AS, &memory, NULL);
    prlimit(child, RLIMIT_CORE, &no_core, NULL);
    prlimit(child, RLIMIT_FSIZE, &size, NULL);
    if (!wait_for(&ended, child, import_max_seconds)) {
        log_error("model: cannot convert: file=%s: osgconv took more than %d s", path, import_max_seconds);
        return STATUS_BAD_VALUE;
    }
    if (WIFEXITED(ended) && WEXITSTATUS(ended) == not_there) {
        log_error(
            "model: cannot convert: file=%s: there is no osgconv; OpenFlight needs it: apt-get install openscenegraph",
            path);
        return STATUS_IO;
    }
    if (!WIFEXITED(ended) || WEXITSTATUS(ended) != 0 || access(to, R_OK) != 0) {
        log_error("model: cannot convert: file=%s: osgconv gave up (%s %d): is it whole, and OpenFlight?", path,
                  WIFSIGNALED(ended) ? "signal" : "exit", WIFSIGNALED(ended) ? WTERMSIG(ended) : WEXITSTATUS(ended));
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

/* osgconv fetches what a file names by address, with a plug-in of its own: such a file is refused. Records of
 * OpenFlight: an opcode and a length of 16 bits, highest octet first; 63 is an external reference, 64 a texture, whose
 * names follow. */
static Status refuse_addresses(const char *path)
{
    enum { external = 63, texture = 64, name_octets = 200 };
    char  *bytes;
    size_t octets;
    Status status = import_read_whole(&bytes, &octets, path, false);
    if (status != STATUS_OK) return status;
    for (size_t at = 0; at + 4 <= octets && status == STATUS_OK;) {
        const uint8_t *head = (const uint8_t *)bytes + at;
        const int      opcode = head[0] << 8 | head[1];
        const size_t   length = (size_t)head[2] << 8 | head[3], rest = octets - at - 4;
        char           name[name_octets + 1], shown[400];
        if (length < 4) break; /* it is not OpenFlight, which osgconv will report */
        at += length;
        if (opcode != external && opcode != texture) continue;
        const size_t count = rest < name_octets ? rest : name_octets;
        memcpy(name, head + 4, count);
        name[count] = 0;
        if (!strstr(name, "://")) continue;
        text_escape(shown, sizeof shown, name, strlen(name));
        log_error(
            "model: cannot be read: file=%s: it names an address of the network, and nothing is fetched: put the file beside "
            "the model and name that: %s",
            path, shown);
        status = STATUS_BAD_VALUE;
    }
    free(bytes);
    return status;
}

Status import_openflight(ImportScene *out, const char *path)
{
    const char *root = getenv("TMPDIR");
    char        folder[512], text_path[560], whole[PATH_MAX];
    char       *text = NULL;
    size_t      octets = 0;
    if (!realpath(path, whole)) { /* so that no name looks like an option */
        log_error("model: cannot open: file=%s: %s", path, strerror(errno));
        return STATUS_IO;
    }
    Status status = refuse_addresses(path);
    if (status != STATUS_OK) return status;
    if ((size_t)snprintf(folder, sizeof folder, "%s/pitviper-flt-XXXXXX", root && *root ? root : "/tmp") >=
            sizeof folder ||
        !mkdtemp(folder)) {
        log_error("model: cannot convert: file=%s: no folder for the conversion: %s", path, folder);
        return STATUS_IO;
    }
    snprintf(text_path, sizeof text_path, "%s/model.osgt", folder);
    status = convert(whole, text_path, path);
    if (status == STATUS_OK) status = import_read_whole(&text, &octets, text_path, false);
    if (status == STATUS_OK) status = import_osgt(out, path, text, octets);
    free(text);
    remove(text_path);
    rmdir(folder);
    return status;
}

/* ---- the text as a tree of elements --------------------------------------------------------- */

/* Splits a line into words in place; `"a b"` is one word, without its quotes. Returns false when there is no memory. */
static bool split_words(OsgText *x, char *line)
{
    for (char *at = line;;) {
        while (*at == ' ' || *at == '\t' || *at == '\r') at++;
        if (!*at) return true;
        if (x->word_count == x->word_room) {
            const int room = x->word_room ? 2 * x->word_room : 4096;
            char    **grown = realloc(x->word, (size_t)room * sizeof *grown);
            if (!grown) return false;
            x->word = grown;
            x->word_room = room;
        }
        if (*at == '"') {
            char *to = ++at;
            x->word[x->word_count++] = at;
            while (*at && *at != '"') {
                if (*at == '\\' && at[1]) at++;
                *to++ = *at++;
            }
            if (*at) at++;
            *to = 0;
        } else {
            x->word[x->word_count++] = at;
            while (*at && *at != ' ' && *at != '\t' && *at != '\r') at++;
            if (*at) *at++ = 0;
        }
    }
}

const char *osg_word(const OsgText *x, int element, int index)
{
    const OsgElement *e = &x->element[element];
    return index < e->words ? x->word[e->first_word + index] : "";
}

static Status read_tree(OsgText *x, char *text)
{
    enum { depth_max = 2048 };
    int open[depth_max], last[depth_max];
    int depth = 0;
    open[0] = last[0] = -1;
    for (char *line = text, *next; line; line = next) {
        next = strchr(line, '\n');
        if (next) *next++ = 0;
        const int first = x->word_count;
        if (*line == '#') continue;
        if (!split_words(x, line)) return STATUS_NO_MEMORY;
        int words = x->word_count - first;
        if (words == 0) continue;
        if (words == 1 && strcmp(x->word[first], "}") == 0) {
            if (depth == 0) return STATUS_BAD_VALUE;
            depth--;
            x->word_count = first;
            continue;
        }
        const bool opens = strcmp(x->word[first + words - 1], "{") == 0;
        if (opens) words--;
        if (x->element_count == x->element_room) {
            const int   room = x->element_room ? 2 * x->element_room : 4096;
            OsgElement *grown = realloc(x->element, (size_t)room * sizeof *grown);
            if (!grown) return STATUS_NO_MEMORY;
            x->element = grown;
            x->element_room = room;
        }
        const int e = x->element_count++;
        x->element[e] = (OsgElement){first, words, -1, -1};
        if (last[depth] >= 0) x->element[last[depth]].next = e;
        else if (open[depth] >= 0) x->element[open[depth]].child = e;
        last[depth] = e;
        if (!opens) continue;
        if (++depth == depth_max) return STATUS_BAD_VALUE;
        open[depth] = e;
        last[depth] = -1;
    }
    return depth == 0 && x->element_count > 0 ? STATUS_OK : STATUS_BAD_VALUE;
}

/* The child whose first word this is; -1: there is none. */
int osg_find(const OsgText *x, int element, const char *name)
{
    if (element < 0) return -1;
    for (int c = x->element[element].child; c >= 0; c = x->element[c].next)
        if (strcmp(osg_word(x, c, 0), name) == 0) return c;
    return -1;
}

static long long id_of(const OsgText *x, int element)
{
    long long id = -1;
    const int c = osg_find(x, element, "UniqueID");
    return c >= 0 && text_to_long(&id, osg_word(x, c, 1)) && id >= 0 && id < x->id_count ? id : -1;
}

/* A repeated object is written as its id alone. */
int osg_resolve(const OsgText *x, int element)
{
    const long long id = id_of(x, element);
    return id >= 0 && x->by_id[id] >= 0 ? x->by_id[id] : element;
}

static Status number_objects(OsgText *x)
{
    x->id_count = x->element_count + 1; /* ids count objects, and an object is more than one element */
    x->by_id = malloc((size_t)x->id_count * sizeof *x->by_id);
    if (!x->by_id) return STATUS_NO_MEMORY;
    for (int i = 0; i < x->id_count; i++) x->by_id[i] = -1;
    for (int e = 0; e < x->element_count; e++) {
        const int       first = x->element[e].child;
        const long long id = first >= 0 && x->element[first].next >= 0 ? id_of(x, e) : -1;
        if (id >= 0 && x->by_id[id] < 0) x->by_id[id] = e;
    }
    return STATUS_OK;
}

/* Numbers among an element's words from `from` on; false when there are fewer than count. */
bool osg_numbers(double *out, int count, const OsgText *x, int element, int from)
{
    for (int i = 0; i < count; i++)
        if (element < 0 || !text_to_double(out + i, osg_word(x, element, from + i))) return false;
    return true;
}

Status osg_text_open(OsgText *out, const char *path, char *text, size_t octets)
{
    *out = (OsgText){.path = path};
    const Status status = strlen(text) == octets ? read_tree(out, text) : STATUS_BAD_VALUE;
    return status == STATUS_OK ? number_objects(out) : status;
}

void osg_text_close(OsgText *x)
{
    free(x->element);
    free(x->word);
    free(x->by_id);
}
