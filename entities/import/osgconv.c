/* entities/import/osgconv.c: OpenFlight into OpenSceneGraph's text, by osgconv in a process of its own, with limits on
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

/* This process's environment but for what steers OpenSceneGraph: its optimizer would merge what has names. */
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
    char program[] = "osgconv", option[] = "-O", options[] = "preserveObject precision 9";
    char *argument[] = {program, option, options, (char *)(uintptr_t)from, (char *)(uintptr_t)to, NULL};
    pid_t child;
    int ended = 0;
    enum { not_there = 127 };
    char **environment = osg_environment();
    if (!environment) return STATUS_NO_MEMORY;
    child = fork();
    if (child == 0) { /* without network: osgconv would fetch what a file names by address */
        char why[confine_why_size];
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
        log_error("model: cannot convert: file=%s: there is no osgconv; OpenFlight needs it: apt-get install openscenegraph", path);
        return STATUS_IO;
    }
    if (!WIFEXITED(ended) || WEXITSTATUS(ended) != 0 || access(to, R_OK) != 0) {
        log_error("model: cannot convert: file=%s: osgconv gave up (%s %d): is it whole, and OpenFlight?", path,
                  WIFSIGNALED(ended) ? "signal" : "exit", WIFSIGNALED(ended) ? WTERMSIG(ended) : WEXITSTATUS(ended));
        return STATUS_BAD_VALUE;
    }
    return STATUS_OK;
}

/* osgconv fetches what a file names by address, with a plug-in of its own: such a file is refused. Records of OpenFlight: an
 * opcode and a length of 16 bits, highest octet first; 63 is an external reference, 64 a texture, whose names follow. */
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
        if (length < 4) break; /* not OpenFlight: osgconv says so */
        at += length;
        if (opcode != external && opcode != texture) continue;
        const size_t count = rest < name_octets ? rest : name_octets;
        memcpy(name, head + 4, count);
        name[count] = 0;
        if (!strstr(name, "://")) continue;
        text_escape(shown, sizeof shown, name, strlen(name));
        log_error("model: cannot be read: file=%s: it names an address of the network, and nothing is fetched: put the file beside "
                  "the model and name that: %s", path, shown);
        status = STATUS_BAD_VALUE;
    }
    free(bytes);
    return status;
}

Status import_openflight(ImportScene *out, const char *path)
{
    const char *root = getenv("TMPDIR");
    char folder[512], text_path[560], whole[PATH_MAX];
    char *text = NULL;
    size_t octets = 0;
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
