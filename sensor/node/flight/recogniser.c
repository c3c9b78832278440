/* sensor/node/flight/recogniser.c: starts and ends the recogniser of a loop. */
#include "sensor/node/flight/recogniser.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

enum { own_variables = 3, variable_size = 4200 };

/* This process's environment and three more variables. NULL: out of memory. */
static char **environment(char own[own_variables][variable_size])
{
    int count = 0;
    while (environ[count]) count++;
    char **all = calloc((size_t)count + own_variables + 1, sizeof *all);
    int    n = 0;
    for (int k = 0; all && k < own_variables; k++) all[n++] = own[k];
    for (int i = 0; all && i < count; i++)
        if (strncmp(environ[i], "PITVIPER_MEMORY=", 16) != 0 && strncmp(environ[i], "PITVIPER_PORT=", 14) != 0 &&
            strncmp(environ[i], "PITVIPER_OUT=", 13) != 0)
            all[n++] = environ[i];
    return all;
}

Status recogniser_start(Recogniser *out, const char *command, const char *memory, int port, const char *folder)
{
    static char                own[own_variables][variable_size];
    char                      *line[] = {(char[]){"sh"}, (char[]){"-c"}, (char *)(uintptr_t)command, NULL};
    posix_spawn_file_actions_t files;
    posix_spawnattr_t          how;
    sigset_t                   none, usual;
    pid_t                      child;
    *out = (Recogniser){0};
    snprintf(own[0], variable_size, "PITVIPER_MEMORY=%.100s", memory);
    snprintf(own[1], variable_size, "PITVIPER_PORT=%d", port);
    snprintf(own[2], variable_size, "PITVIPER_OUT=%.4096s", folder);
    char **with = environment(own);
    if (!with) return STATUS_NO_MEMORY;
    sigemptyset(&none);
    sigfillset(&usual);
    sigdelset(&usual, SIGHUP); /* nohup stays */
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, STDERR_FILENO, STDOUT_FILENO);
    posix_spawnattr_init(&how);
    posix_spawnattr_setflags(&how, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setpgroup(&how, 0);
    posix_spawnattr_setsigmask(&how, &none);
    posix_spawnattr_setsigdefault(&how, &usual);
    const int failure = posix_spawn(&child, "/bin/sh", &files, &how, line, with);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&how);
    free(with);
    if (failure) {
        log_error("fly: --recogniser: /bin/sh does not start: %s", strerror(failure));
        return STATUS_IO;
    }
    out->pid = child;
    return STATUS_OK;
}

static bool reap(Recogniser *r)
{
    if (!r->ended && r->pid > 0 && waitpid(r->pid, &r->status, WNOHANG) == r->pid) r->ended = true;
    return r->ended;
}

bool recogniser_gone(void *user)
{
    Recogniser *r = user;
    if (r->ended) return true;
    if (!reap(r)) return false;
    if (WIFSIGNALED(r->status)) log_warn("fly: the recogniser was ended by signal %d", WTERMSIG(r->status));
    else log_warn("fly: the recogniser ended with code %d", WEXITSTATUS(r->status));
    return true;
}

/* Whether it ends within half a second. */
static bool ends_soon(Recogniser *r)
{
    for (int i = 0; i < 50; i++) {
        if (reap(r)) return true;
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    return false;
}

void recogniser_stop(Recogniser *r)
{
    if (r->pid <= 0) return;
    if (!ends_soon(r)) {
        kill(-r->pid, SIGTERM);
        ends_soon(r);
    }
    kill(-r->pid, SIGKILL); /* and what it started; ESRCH: all have ended */
    if (!r->ended) waitpid(r->pid, &r->status, 0);
    r->ended = true;
    r->pid = 0;
}
