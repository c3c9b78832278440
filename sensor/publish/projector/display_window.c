/* sensor/publish/projector/display_window.c: starts pitviper-projector, gives it images through shared memory, and
 * takes what it says of them. */
#include "sensor/publish/projector/display_window.h"

#include "sensor/publish/consumers/consumer.h"
#include "sensor/publish/projector/window_wire.h"
#include "pitviper_library.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

struct DisplayWindow {
    DisplayWindowOf   of;
    pid_t             process; /* 0: there is none */
    int               socket, memory;
    WindowShared     *shared;
    uint32_t          own; /* image to fill */
    pthread_t         thread;
    bool              started; /* the thread */
    pthread_mutex_t   lock;    /* protects the following */
    pthread_cond_t    said;
    bool              opened, gone, closing;
    uint32_t          flipped; /* number of the last one */
    int64_t           flipped_ns;
    ProjectorCounters counters;
    LatencyHistogram  interval, off;
};

/* ---- start ---------------------------------------------------------------------------------------- */

#ifdef PITVIPER_SDL
static int spawn(pid_t *process, const char *program, int socket, int memory, const DisplayWindowOf *of)
{
    extern char              **environ;
    char                       display[16];
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t          attributes;
    sigset_t                   none;
    snprintf(display, sizeof display, "%d", of->display);
    char *arguments[] = {(char *)"pitviper-projector",
                         display,
                         (char *)of->size,
                         (char *)of->scale,
                         (char *)(of->vsync ? "on" : "off"),
                         (char *)of->gamepad,
                         (char *)of->head,
                         NULL};
    sigemptyset(&none);
    int error = posix_spawn_file_actions_init(&actions);
    if (error) return error;
    error = posix_spawnattr_init(&attributes);
    if (!error) error = posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    if (!error) error = posix_spawnattr_setsigmask(&attributes, &none);
    if (!error) error = posix_spawn_file_actions_adddup2(&actions, socket, window_socket);
    if (!error) error = posix_spawn_file_actions_adddup2(&actions, memory, window_memory);
    if (!error) error = posix_spawn(process, program, &actions, &attributes, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return error;
}

/* A descriptor out of the way of the numbers that two get in the new process. */
static int moved(int descriptor)
{
    const int far = fcntl(descriptor, F_DUPFD_CLOEXEC, window_memory + 1);
    close(descriptor);
    return far;
}

/* Makes memory and socket, and starts the program. Returns 0, or the error. */
static int start(DisplayWindow *w, const char *program)
{
    const size_t octets = window_octets(w->of.width, w->of.height);
    int          pair[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) != 0) return errno;
    w->socket = pair[0];
    const int far = moved(pair[1]);
    int       memory = memfd_create("projector", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    if (memory >= 0) memory = moved(memory);
    w->memory = memory;
    int error = far < 0 || memory < 0 || ftruncate(memory, (off_t)octets) != 0 ||
                        fcntl(memory, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0
                    ? errno
                    : 0;
    if (!error) {
        void *const at = mmap(NULL, octets, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, memory, 0);
        if (at == MAP_FAILED) error = errno;
        else w->shared = at;
    }
    if (!error) {
        *w->shared = (WindowShared){.waiting = 1, .width = w->of.width, .height = w->of.height};
        w->own = 2; /* the window's own is 0 */
        error = spawn(&w->process, program, far, memory, &w->of);
    }
    if (far >= 0) close(far);
    return error;
}
#endif

/* ---- what it says --------------------------------------------------------------------------------- */

/* Counts a flip; called with the lock held. */
static void count_flip(DisplayWindow *w, const WindowMessage *m)
{
    ProjectorCounters *c = &w->counters;
    c->shown++;
    c->late += m->newer != 0;
    if (w->flipped_ns > 0) {
        const double ms = 1e-6 * (double)(m->time_ns - w->flipped_ns);
        latency_count(&w->interval, ms);
        if (c->refresh_hz > 0) {
            const double refresh_ms = 1e3 / c->refresh_hz;
            latency_count(&w->off, fabs(ms - refresh_ms * round(ms / refresh_ms)));
        }
    }
    w->flipped = m->number;
    w->flipped_ns = m->time_ns;
}

/* A message, made safe: it is another program's. False: the window is gone. */
static bool take(DisplayWindow *w, WindowMessage *m)
{
    char text[window_text_size];
    m->text[window_text_size - 1] = 0;
    text_show(text, sizeof text, m->text, false);
    if (m->event == WINDOW_FLIPPED && w->of.flipped) w->of.flipped(w->of.user, m->number, 1e-9 * (double)m->time_ns);
    pthread_mutex_lock(&w->lock);
    if (m->event == WINDOW_FLIPPED) count_flip(w, m);
    if (m->event == WINDOW_OPENED) {
        w->opened = true;
        w->counters.refresh_hz = m->number < 10000000 ? 1e-3 * m->number : 0;
        memcpy(w->counters.what, text, sizeof text);
    }
    pthread_mutex_unlock(&w->lock);
    if (m->event == WINDOW_NOTED) log_info("projector: %s", text);
    if (m->event == WINDOW_FAILED) log_error("projector: %s", text);
    if (m->event == WINDOW_CLOSED) log_warn("projector: its window was closed; frames go on without it");
    return m->event == WINDOW_OPENED || m->event == WINDOW_FLIPPED ||
           m->event == WINDOW_NOTED; /* after anything else it ends */
}

static void *listen_to_it(void *user)
{
    DisplayWindow *w = user;
    WindowMessage  m;
    bool           there = true, told = false;
    publish_urgent();
    while (there) {
        const ssize_t got = recv(w->socket, &m, sizeof m, 0);
        if (got < 0 && errno == EINTR) continue;
        told = got == (ssize_t)sizeof m;
        there = told && take(w, &m);
        pthread_mutex_lock(&w->lock);
        w->gone = !there;
        if (!told && w->opened && !w->closing) log_warn("projector: its program has ended; frames go on without it");
        pthread_cond_broadcast(&w->said);
        pthread_mutex_unlock(&w->lock);
    }
    return NULL;
}

/* ---- open and close ------------------------------------------------------------------------------- */

#ifdef PITVIPER_SDL
Status display_window_open(DisplayWindow **out, const DisplayWindowOf *of)
{
    char           program[4096];
    DisplayWindow *w = calloc(1, sizeof *w);
    if (!w) return STATUS_NO_MEMORY;
    *w = (DisplayWindow){.of = *of, .socket = -1, .memory = -1};
    pthread_condattr_t steady;
    pthread_condattr_init(&steady);
    pthread_condattr_setclock(&steady, CLOCK_MONOTONIC);
    pthread_mutex_init(&w->lock, NULL);
    pthread_cond_init(&w->said, &steady);
    pthread_condattr_destroy(&steady);
    int error = library_module(program, sizeof program, "pitviper-projector") ? start(w, program) : ENOENT;
    if (!error && !(w->started = publish_thread(&w->thread, listen_to_it, w))) error = EAGAIN;
    if (error && error != ENOENT)
        log_error("projector: cannot start %s, which has the window: %s", program, strerror(error));
    pthread_mutex_lock(&w->lock);
    while (!error && !w->opened && !w->gone) pthread_cond_wait(&w->said, &w->lock);
    const bool opened = w->opened;
    pthread_mutex_unlock(&w->lock);
    if (opened) {
        log_info("projector: %s", w->counters.what);
        *out = w;
        return STATUS_OK;
    }
    if (!error)
        log_error(
            "projector: there is no window; DISPLAY names an X server, projector.display one of its displays, and "
            "without projector.band there is none");
    display_window_close(w, NULL);
    return STATUS_IO;
}
#else
Status display_window_open(DisplayWindow **out, const DisplayWindowOf *of)
{
    (void)out, (void)of, (void)listen_to_it;
    log_error("projector: this program was built without SDL2; install libsdl2-dev and build it again");
    return STATUS_UNSUPPORTED;
}
#endif

/* Waits until the program has ended by itself, for a second; else it is killed. */
static void end_process(pid_t process)
{
    static const struct timespec look = {.tv_nsec = 10000000};
    for (int i = 0; i < 100; i++) {
        if (waitpid(process, NULL, WNOHANG) == process) return;
        nanosleep(&look, NULL);
    }
    kill(process, SIGKILL);
    while (waitpid(process, NULL, 0) < 0 && errno == EINTR) {
    }
}

void display_window_close(DisplayWindow *w, ProjectorCounters *counters)
{
    if (!w) return;
    pthread_mutex_lock(&w->lock);
    w->closing = true;
    pthread_mutex_unlock(&w->lock);
    if (w->socket >= 0) shutdown(w->socket, SHUT_WR); /* it ends, and what it says until then is taken */
    if (w->process > 0) end_process(w->process);
    if (w->started) pthread_join(w->thread, NULL);
    if (w->shared && window_is_fresh(w->shared)) w->counters.dropped++; /* the last one was never taken */
    latency_figures(&w->counters.interval, &w->interval);
    latency_figures(&w->counters.off, &w->off);
    if (counters) *counters = w->counters;
    if (w->shared) munmap(w->shared, window_octets(w->of.width, w->of.height));
    if (w->memory >= 0) close(w->memory);
    if (w->socket >= 0) close(w->socket);
    pthread_mutex_destroy(&w->lock);
    pthread_cond_destroy(&w->said);
    free(w);
}

/* ---- images --------------------------------------------------------------------------------------- */

uint32_t *display_window_fill(DisplayWindow *w) { return window_image(w->shared, w->of.width, w->of.height, w->own); }

static void drop(DisplayWindow *w, uint32_t number)
{
    pthread_mutex_lock(&w->lock);
    w->counters.dropped++;
    pthread_mutex_unlock(&w->lock);
    if (w->of.dropped) w->of.dropped(w->of.user, number);
}

bool display_window_show(DisplayWindow *w, uint32_t number)
{
    const char look = 1;
    pthread_mutex_lock(&w->lock);
    const bool gone = w->gone;
    w->counters.dropped += gone;
    pthread_mutex_unlock(&w->lock);
    if (gone) return false;
    w->shared->number[w->own] = number;
    int undone;
    w->own = window_give(w->shared, w->own, &undone);
    if (undone) drop(w, w->shared->number[w->own]);
    send(w->socket, &look, 1, MSG_DONTWAIT | MSG_NOSIGNAL); /* full: it has enough to wake up */
    return true;
}

bool display_window_wait(DisplayWindow *w, uint32_t number, double wait_s)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    const int64_t ns = until.tv_nsec + llround(1e9 * wait_s);
    until.tv_sec += ns / 1000000000;
    until.tv_nsec = ns % 1000000000;
    int timed_out = 0;
    pthread_mutex_lock(&w->lock);
    while (!w->gone && (int32_t)(w->flipped - number) < 0 && !timed_out)
        timed_out = pthread_cond_timedwait(&w->said, &w->lock, &until);
    const bool flipped = (int32_t)(w->flipped - number) >= 0;
    w->counters.waited_out += !flipped && !w->gone;
    pthread_mutex_unlock(&w->lock);
    return flipped;
}
