/* tests/bench/sensor/node_process.c: pitviper as another process, for the benches of a live node. */
#include "tests/bench/sensor/node_process.h"

#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* Finds the program: beside this one, else on PATH. out: room for its path. */
static void find_pitviper(char out[PATH_MAX + 16])
{
    const ssize_t length = readlink("/proc/self/exe", out, PATH_MAX);
    out[length > 0 ? length : 0] = 0;
    char *slash = strrchr(out, '/');
    strcpy(slash ? slash + 1 : out, "pitviper");
    if (access(out, X_OK) != 0) strcpy(out, "pitviper");
}

pid_t node_start(const char *const *argument, int out, int err)
{
    char        path[PATH_MAX + 16];
    const pid_t self = getpid();
    find_pitviper(path);
    const pid_t child = fork(); /* of several threads, so what follows only calls the system */
    if (child != 0) return child;
    /* however the bench ends, its nodes end with it; in between it may have ended already */
    if (prctl(PR_SET_PDEATHSIG, SIGTERM) == 0 && getppid() == self && dup2(out, STDOUT_FILENO) >= 0 &&
        dup2(err, STDERR_FILENO) >= 0)
        execvpe(path, (char *const *)(uintptr_t)argument, environ);
    _exit(127);
}

int node_finish(pid_t child, double within_s, struct rusage *usage)
{
    const double begun_s = wall_clock_s();
    int          status = 0;
    pid_t        ended;
    while ((ended = wait4(child, &status, WNOHANG, usage)) == 0 && wall_clock_s() - begun_s < within_s) usleep(20000);
    if (ended == 0) {
        kill(child, SIGKILL);
        wait4(child, &status, 0, usage);
        return -1;
    }
    return ended == child && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool node_hears(int from, const char *text, double within_s)
{
    static char  said[4096];
    size_t       n = 0;
    const double begun_s = wall_clock_s();
    while (wall_clock_s() - begun_s < within_s && n < sizeof said - 1) {
        struct pollfd ready = {.fd = from, .events = POLLIN};
        if (poll(&ready, 1, 100) <= 0) continue;
        const ssize_t got = read(from, said + n, sizeof said - 1 - n);
        if (got <= 0) break;
        n += (size_t)got;
        said[n] = 0;
        if (strstr(said, text)) return true;
    }
    said[n] = 0;
    log_error("bench: the live node did not come to say '%s': %s", text, n ? said : "it says nothing");
    return false;
}

double node_number(const char *text, const char *const *key, int keys)
{
    char quoted[32];
    for (int k = 0; k < keys && text; k++) {
        snprintf(quoted, sizeof quoted, "\"%s\":", key[k]);
        text = strstr(text, quoted);
        if (text) text += strlen(quoted);
    }
    return text ? strtod(text, NULL) : NAN;
}
