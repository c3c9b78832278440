/* sensor/bench/sensor/network_node.c: this program as another process, for the benches of a live node. */
#include "sensor/bench/sensor/network_node.h"

#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

pid_t node_start(const char *const *argument, int out, int err)
{
    posix_spawn_file_actions_t actions;
    pid_t                      child = -1;
    if (posix_spawn_file_actions_init(&actions) != 0) return -1;
    posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, err, STDERR_FILENO);
    if (posix_spawn(&child, "/proc/self/exe", &actions, NULL, (char *const *)(uintptr_t)argument, environ) != 0)
        child = -1;
    posix_spawn_file_actions_destroy(&actions);
    return child;
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
