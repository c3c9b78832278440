/* etc/fmu/child.h: a program that is started, watched, and never left behind.
 *
 * A thread of its own, the keeper, starts the program and waits for its end. The kernel terminates the program
 * (SIGTERM) when that thread ends before it, which is when this process ends, in whatever way. child_stop interrupts
 * the program (SIGINT), and kills it when it is still there 5 s later. */
#ifndef PITVIPER_FMU_CHILD_H
#define PITVIPER_FMU_CHILD_H

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

typedef struct Child {
    int       there; /* it was started; the following members are valid */
    pthread_t keeper;
    pid_t     program;
    int       ended[2]; /* a pipe: the keeper writes the program's status as of waitpid, -1 when it is not known */
    int       log;      /* what the program says */
    /* for the keeper */
    sem_t        started;
    int          reason; /* errno; 0: it was started */
    char *const *argument;
} Child;

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

/* In the forked process, which has one thread of a process of many: only calls that are safe in signal handlers. */
static inline void child_become(const Child *c, pid_t parent)
{
    static const int all[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGCHLD, SIGQUIT};
    const int        none = open("/dev/null", O_RDONLY);
    sigset_t         nothing;
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(127);
    setpgid(0, 0); /* an interrupt of the terminal is the tool's */
    sigemptyset(&nothing);
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) signal(all[i], SIG_DFL);
    sigprocmask(SIG_SETMASK, &nothing, NULL);
    dup2(none, 0), dup2(c->log, 1), dup2(c->log, 2);
    for (int i = 3; i < 4096; i++) close(i); /* the tool's, and other instances' */
    execv(c->argument[0], c->argument);
    _exit(127);
}

static inline void *child_keep(void *of)
{
    Child      *c = (Child *)of;
    const pid_t parent = getpid();
    int         status = -1;
    pid_t       got;
    c->program = fork();
    if (c->program == 0) child_become(c, parent);
    c->reason = c->program < 0 ? errno : 0;
    const int lives = c->program > 0;
    sem_post(&c->started);
    while (lives && (got = waitpid(c->program, &status, 0)) < 0 && errno == EINTR) {
    }
    if (lives && got < 0) status = -1; /* this process waits for no child: SIGCHLD is ignored */
    if (lives && write(c->ended[1], &status, sizeof status) < 0) return NULL;
    return NULL;
}

static inline void child_forget(Child *c)
{
    for (int i = 0; i < 2; i++)
        if (c->ended[i] >= 0) close(c->ended[i]);
    if (c->log >= 0) close(c->log);
    sem_destroy(&c->started);
    c->there = 0;
}

/* argument[0]: the program's path; NULL at the end. log: a path; empty: memory, which child_last_words reads. False:
 * errno says why. */
static inline int child_start(Child *c, char *const argument[], const char *log)
{
    sigset_t all, before;
    *c = (Child){.ended = {-1, -1}, .argument = argument};
    sem_init(&c->started, 0, 0);
    c->log = *log ? open(log, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644) : memfd_create("pitviper", MFD_CLOEXEC);
    c->reason = c->log < 0 || pipe2(c->ended, O_CLOEXEC) != 0 ? errno : 0;
    sigfillset(&all); /* the tool's signals are for its own threads */
    pthread_sigmask(SIG_SETMASK, &all, &before);
    if (c->reason == 0) c->reason = pthread_create(&c->keeper, NULL, child_keep, c);
    const int begun = c->reason == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    while (begun && sem_wait(&c->started) != 0) {
    }
    if (begun && c->reason != 0) pthread_join(c->keeper, NULL);
    c->there = c->reason == 0;
    if (c->there) return 1;
    const int reason = c->reason;
    child_forget(c);
    errno = reason;
    return 0;
}

/* Whether the program has ended, and how, in words. Its exit status: *code, or -1. Once. */
static inline int child_has_ended(char *how, size_t size, int *code, const Child *c)
{
    struct pollfd end = {c->ended[0], POLLIN, 0};
    int           status;
    *code = -1;
    if (poll(&end, 1, 0) <= 0) return 0;
    if (read(c->ended[0], &status, sizeof status) != (ssize_t)sizeof status || status == -1)
        snprintf(how, size, "in a way that is not known");
    else if (WIFSIGNALED(status)) snprintf(how, size, "by signal %d", WTERMSIG(status));
    else snprintf(how, size, "with status %d", *code = WEXITSTATUS(status));
    return 1;
}

/* The end of what the program said, at most size - 1 octets. */
static inline void child_last_words(char *out, size_t size, const Child *c)
{
    const off_t end = lseek(c->log, 0, SEEK_END), from = end > (off_t)size - 1 ? end - (off_t)size + 1 : 0;
    ssize_t     got = pread(c->log, out, size - 1, from);
    out[got > 0 ? got : 0] = 0;
    while (got > 0 && (out[got - 1] == '\n' || out[got - 1] == ' ')) out[--got] = 0;
}

static inline int child_ends_within(const Child *c, int ms)
{
    struct pollfd   end = {c->ended[0], POLLIN, 0};
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    const long long until_ms = now.tv_sec * 1000LL + now.tv_nsec / 1000000 + ms;
    for (;;) {
        const int got = poll(&end, 1, ms);
        if (got >= 0 || errno != EINTR) return got != 0;
        clock_gettime(CLOCK_MONOTONIC, &now);
        const long long left_ms = until_ms - (now.tv_sec * 1000LL + now.tv_nsec / 1000000);
        ms = left_ms > 0 ? (int)left_ms : 0;
    }
}

/* To it and what it has started in its group. */
static inline void child_signal(const Child *c, int signal_number)
{
    if (kill(-c->program, signal_number) != 0) kill(c->program, signal_number);
}

/* Ends the program, waits until it is gone, and frees what *c has. ended: child_has_ended has said so. */
static inline void child_stop(Child *c, int ended)
{
    enum { patience_ms = 5000 };
    if (!c->there) return;
    if (!ended && !child_ends_within(c, 0)) { /* it is there: the keeper has not waited for it */
        child_signal(c, SIGINT);
        if (!child_ends_within(c, patience_ms)) child_signal(c, SIGKILL);
    }
    pthread_join(c->keeper, NULL);
    child_forget(c);
}

#endif
