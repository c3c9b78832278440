/* etc/fmu/child.h: a program that is started, watched, and never left behind.
 *
 * Between it and this process stands a watcher, a process of its own without threads: it holds one end of a
 * lifeline. When child_stop says so, or the other end is closed because this process has ended in whatever way, the
 * watcher interrupts the program (SIGINT), kills it 5 s later if it is still there, and ends. The program is killed
 * with its watcher. */
#ifndef PITVIPER_FMU_CHILD_H
#define PITVIPER_FMU_CHILD_H

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct Child {
    pid_t watcher;  /* 0: none */
    int   lifeline; /* ends the program when it is closed */
    int   ended;    /* readable when the program has ended: its status as of waitpid, an int */
    int   log;      /* what the program says; -1: not to be read */
} Child;

static inline void child_close(int *file)
{
    if (*file >= 0) close(*file);
    *file = -1;
}

/* The path of a program, as a shell finds it; false: there is none that can be started. */
static inline int child_find(char *path, size_t size, const char *program)
{
    const char *at = getenv("PATH");
    if (strchr(program, '/')) return snprintf(path, size, "%s", program) < (int)size && access(path, X_OK) == 0;
    for (; at && *at; at += strcspn(at, ":"), at += *at == ':') {
        const int folder = (int)strcspn(at, ":");
        if (snprintf(path, size, "%.*s/%s", folder, at, program) < (int)size && access(path, X_OK) == 0) return 1;
    }
    return 0;
}

/* In a process that was forked from one that may have threads: only calls that are safe in signal handlers. */
static inline void child_close_others(int a, int b, int c)
{
    for (int i = 3; i < 4096; i++) {
        if (i == a || i == b || i == c) continue;
        close(i);
    }
#ifdef SYS_close_range
    if (a < 4096 && b < 4096 && c < 4096) syscall(SYS_close_range, 4096u, ~0u, 0u);
#endif
}

static inline void child_signals_default(void)
{
    static const int all[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGCHLD, SIGQUIT};
    sigset_t         none;
    sigemptyset(&none);
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) signal(all[i], SIG_DFL);
    sigprocmask(SIG_SETMASK, &none, NULL);
}

static inline void child_watch(pid_t program, int lifeline, int ended)
{
    enum { look_ms = 20, patience = 5000 / look_ms };
    int           status, asked = 0;
    struct pollfd line = {lifeline, POLLIN, 0};
    signal(SIGPIPE, SIG_IGN);
    while (waitpid(program, &status, WNOHANG) == 0) {
        if (asked == 0 && poll(&line, 1, look_ms) > 0) kill(program, SIGINT), asked = 1;
        if (asked == 0) continue;
        poll(NULL, 0, look_ms);
        if (asked++ == patience) kill(program, SIGKILL);
    }
    if (write(ended, &status, sizeof status) < 0) _exit(1);
    _exit(0);
}

/* argument[0]: the program's path; NULL at the end. log: a path; empty: a file without a name, which child_last_words
 * reads. False: errno says why. */
static inline int child_start(Child *out, char *const argument[], const char *log)
{
    int line[2] = {-1, -1}, end[2] = {-1, -1}, none = open("/dev/null", O_RDONLY | O_CLOEXEC);
    *out = (Child){0, -1, -1, -1};
    out->log = *log ? open(log, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)
                    : open("/tmp", O_RDWR | O_TMPFILE | O_CLOEXEC, 0600);
    if (none < 0 || out->log < 0 || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, line) != 0 ||
        pipe2(end, O_CLOEXEC) != 0)
        goto fail;
    out->watcher = fork();
    if (out->watcher < 0) goto fail;
    if (out->watcher == 0) {
        setpgid(0, 0); /* an interrupt of the terminal is the tool's */
        child_signals_default();
        dup2(none, 0), dup2(out->log, 1), dup2(out->log, 2);
        child_close_others(line[0], end[1], -1);
        const pid_t watcher = getpid(), program = fork();
        if (program == 0) {
            prctl(PR_SET_PDEATHSIG, SIGKILL);
            if (getppid() != watcher) _exit(127);
            execv(argument[0], argument);
            _exit(127);
        }
        if (program < 0) _exit(1);
        child_watch(program, line[0], end[1]);
    }
    close(none), close(line[0]), close(end[1]);
    out->lifeline = line[1], out->ended = end[0];
    return 1;

fail:;
    const int reason = errno;
    child_close(&none), child_close(&line[0]), child_close(&line[1]), child_close(&end[0]), child_close(&end[1]);
    child_close(&out->log);
    out->watcher = 0;
    errno = reason;
    return 0;
}

/* Whether the program has ended, and how, in words. Its exit status: *code, or -1. */
static inline int child_has_ended(char *how, size_t size, int *code, const Child *c)
{
    struct pollfd end = {c->ended, POLLIN, 0};
    int           status;
    *code = -1;
    if (poll(&end, 1, 0) <= 0) return 0;
    if (read(c->ended, &status, sizeof status) != (ssize_t)sizeof status) snprintf(how, size, "with its watcher");
    else if (WIFSIGNALED(status)) snprintf(how, size, "by signal %d", WTERMSIG(status));
    else snprintf(how, size, "with status %d", *code = WEXITSTATUS(status));
    return 1;
}

/* The end of what the program said, at most size - 1 octets. */
static inline void child_last_words(char *out, size_t size, const Child *c)
{
    const off_t end = lseek(c->log, 0, SEEK_END), from = end > (off_t)size - 1 ? end - (off_t)size + 1 : 0;
    ssize_t     got = c->log >= 0 ? pread(c->log, out, size - 1, from) : 0;
    out[got > 0 ? got : 0] = 0;
    while (got > 0 && (out[got - 1] == '\n' || out[got - 1] == ' ')) out[--got] = 0;
}

/* Ends the program, waits until it is gone, and frees what *c has. */
static inline void child_stop(Child *c)
{
    if (c->watcher <= 0) return;
    send(c->lifeline, "", 1, MSG_NOSIGNAL); /* a process forked from this one may hold it, too */
    child_close(&c->lifeline);
    if (c->ended >= 0) { /* a tool that ignores SIGCHLD leaves nothing to wait for */
        struct pollfd end = {c->ended, POLLIN, 0};
        while (poll(&end, 1, 10000) < 0 && errno == EINTR) {
        }
    }
    while (waitpid(c->watcher, NULL, 0) < 0 && errno == EINTR) {
    }
    child_close(&c->ended), child_close(&c->log);
    c->watcher = 0;
}

#endif
