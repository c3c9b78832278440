/* terrain/elevation/raster_child.c: the process that reads rasters, seen from the program. */
#include "terrain/elevation/raster_child.h"

#include "pitviper_library.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

static const double   usual_patience_s = 120;
static _Atomic double patience_s = usual_patience_s;

void raster_child_patience(double s) { atomic_store(&patience_s, s > 0 ? s : usual_patience_s); }

struct RasterChild {
    pid_t           process; /* process that starts readers; 0: there is none */
    int             socket[wire_channels];
    WireChannel    *channel; /* [wire_channels] memory shared with the reader */
    bool            taken[wire_channels];
    bool            dead; /* it has been given up: nothing is asked of it any more */
    pthread_mutex_t lock;
    pthread_cond_t  given;
};

/* Makes shared memory that neither process can shrink while the other uses it. */
static int shared_memory(size_t octets)
{
    const int memory = memfd_create("rasters", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    if (memory >= 0 && ftruncate(memory, (off_t)octets) == 0 &&
        fcntl(memory, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) == 0)
        return memory;
    const int error = errno;
    if (memory >= 0) close(memory);
    errno = error;
    return -1;
}

/* ---- the process that starts readers ------------------------------------------------------------------ */

static struct {
    pthread_mutex_t lock;
    pid_t           process, owner; /* owner: the process that may talk to it; a fork of this one may not */
    int             socket;
} starter = {PTHREAD_MUTEX_INITIALIZER, 0, 0, -1};

static int spawn(pid_t *process, const char *program, int orders)
{
    extern char              **environ;
    char                      *arguments[] = {(char *)"pitviper-rasters", NULL};
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t          attributes;
    sigset_t                   none;
    sigemptyset(&none);
    int error = posix_spawn_file_actions_init(&actions);
    if (error) return error;
    error = posix_spawnattr_init(&attributes);
    if (!error) error = posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    if (!error) error = posix_spawnattr_setsigmask(&attributes, &none);
    for (int n = 0; n < wire_orders && !error; n++)
        error = posix_spawn_file_actions_addopen(&actions, n, "/dev/null", O_RDWR, 0);
    if (!error) error = posix_spawn_file_actions_adddup2(&actions, orders, wire_orders);
    if (!error) error = posix_spawn(process, program, &actions, &attributes, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return error;
}

/* Forgets the process that starts readers, which ends by itself. Call with the lock held. */
static void starter_gone(void)
{
    if (starter.socket >= 0) close(starter.socket);
    if (starter.process > 0 && starter.owner == getpid()) {
        kill(starter.process, SIGKILL);
        while (waitpid(starter.process, NULL, 0) < 0 && errno == EINTR) {
        }
    }
    starter.socket = -1;
    starter.process = 0;
}

/* Starts the process that starts readers, unless it runs. Returns 0, or the error. Call with the lock held. */
static int starter_ready(const char *program)
{
    struct pollfd there = {.fd = starter.socket};
    int           pair[2];
    if (starter.socket >= 0 && starter.owner == getpid() && poll(&there, 1, 0) == 0) return 0;
    starter_gone();
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) != 0) return errno;
    const int far = fcntl(pair[1], F_DUPFD_CLOEXEC,
                          wire_orders + 1); /* out of the way of the number that it gets in the new process */
    int       error = far < 0 ? errno : 0;
    close(pair[1]);
    if (!error) error = spawn(&starter.process, program, far);
    starter.owner = getpid();
    if (far >= 0) close(far);
    if (error) close(pair[0]);
    else starter.socket = pair[0];
    return error;
}

/* Sends an order to the process that starts readers, and reads its answer. descriptors: wire_descriptors of them, or
 * NULL. Returns false when that process is gone. Call with the lock held. */
static bool starter_asked(int32_t *answer, WireOrderKind kind, pid_t process, const int *descriptors)
{
    WireOrder    order = {(int32_t)kind, (int32_t)process};
    struct iovec text = {&order, sizeof order};
    union {
        struct cmsghdr header;
        char           octets[CMSG_SPACE(wire_descriptors * sizeof(int))];
    } control;
    struct msghdr message = {.msg_iov = &text, .msg_iovlen = 1};
    if (descriptors) {
        memset(&control, 0, sizeof control);
        message.msg_control = &control;
        message.msg_controllen = sizeof control;
        struct cmsghdr *c = CMSG_FIRSTHDR(&message);
        c->cmsg_level = SOL_SOCKET;
        c->cmsg_type = SCM_RIGHTS;
        c->cmsg_len = CMSG_LEN(wire_descriptors * sizeof(int));
        memcpy(CMSG_DATA(c), descriptors, wire_descriptors * sizeof(int));
    }
    ssize_t got = sendmsg(starter.socket, &message, MSG_NOSIGNAL);
    if (got == (ssize_t)sizeof order) do
            got = recv(starter.socket, answer, sizeof *answer, 0);
        while (got < 0 && errno == EINTR);
    return got == (ssize_t)sizeof *answer;
}

static const char *other_program;

void raster_child_program(const char *path)
{
    pthread_mutex_lock(&starter.lock);
    starter_gone();
    other_program = path;
    pthread_mutex_unlock(&starter.lock);
}

/* Returns 0, or the error. */
static int start_reader(pid_t *process, const char *program, const int descriptors[wire_descriptors])
{
    int32_t answer = 0;
    pthread_mutex_lock(&starter.lock);
    int error = starter_ready(program);
    if (!error && !starter_asked(&answer, WIRE_START, 0, descriptors)) {
        starter_gone(); /* that process was killed meanwhile: try once more */
        error = starter_ready(program);
        if (!error && !starter_asked(&answer, WIRE_START, 0, descriptors)) error = ECHILD;
    }
    pthread_mutex_unlock(&starter.lock);
    if (!error && answer <= 0) error = answer < 0 ? -answer : ECHILD;
    if (!error) *process = (pid_t)answer;
    return error;
}

/* ---- start and end ------------------------------------------------------------------------------------ */

Status raster_child_start(RasterChild **out, const char *key)
{
    char         program[wire_path_size];
    const size_t octets = wire_channels * sizeof(WireChannel);
    int          far[wire_descriptors];
    if (other_program) snprintf(program, sizeof program, "%s", other_program);
    else if (!library_module(program, sizeof program, "pitviper-rasters")) return STATUS_IO;
    RasterChild *child = calloc(1, sizeof *child);
    if (!child) return STATUS_NO_MEMORY;
    pthread_mutex_init(&child->lock, NULL);
    pthread_cond_init(&child->given, NULL);
    child->channel = MAP_FAILED;
    for (int n = 0; n < wire_descriptors; n++) far[n] = -1;
    for (int n = 0; n < wire_channels; n++) child->socket[n] = -1;
    int error = 0;
    for (int n = 0; n < wire_channels && !error; n++) {
        int pair[2];
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) == 0) child->socket[n] = pair[0], far[n] = pair[1];
        else error = errno;
    }
    if (!error && (far[wire_channels] = shared_memory(octets)) < 0) error = errno;
    if (!error) child->channel = mmap(NULL, octets, PROT_READ | PROT_WRITE, MAP_SHARED, far[wire_channels], 0);
    if (!error && child->channel == MAP_FAILED) error = errno;
    if (!error) error = start_reader(&child->process, program, far);
    for (int n = 0; n < wire_descriptors; n++)
        if (far[n] >= 0) close(far[n]);
    if (!error) {
        *out = child;
        return STATUS_OK;
    }
    log_error("%s: cannot start %s, which reads rasters: %s%s", key, program, strerror(error),
              error == EFBIG ? "; `ulimit -f unlimited` lets it share memory" : "");
    raster_child_stop(child);
    return error == ENOMEM ? STATUS_NO_MEMORY : STATUS_IO;
}

/* Ends a reader. Returns its status as waitpid gives it; 0: unknown. */
static int end_process(RasterChild *child)
{
    int32_t how = 0;
    if (child->process <= 0) return 0;
    pthread_mutex_lock(&starter.lock);
    if (starter.socket < 0 || starter.owner != getpid() || !starter_asked(&how, WIRE_END, child->process, NULL))
        how = 0;
    pthread_mutex_unlock(&starter.lock);
    child->process = 0;
    return how;
}

void raster_child_stop(RasterChild *child)
{
    if (!child) return;
    end_process(child);
    for (int n = 0; n < wire_channels; n++)
        if (child->socket[n] >= 0) close(child->socket[n]);
    if (child->channel != MAP_FAILED) munmap(child->channel, wire_channels * sizeof *child->channel);
    pthread_mutex_destroy(&child->lock);
    pthread_cond_destroy(&child->given);
    free(child);
}

/* ---- channels ----------------------------------------------------------------------------------------- */

WireChannel *raster_child_take(RasterChild *child)
{
    pthread_mutex_lock(&child->lock);
    for (;;) {
        for (int n = 0; n < wire_channels; n++)
            if (!child->taken[n]) {
                child->taken[n] = true;
                pthread_mutex_unlock(&child->lock);
                return &child->channel[n];
            }
        pthread_cond_wait(&child->given, &child->lock);
    }
}

void raster_child_give(RasterChild *child, WireChannel *channel)
{
    pthread_mutex_lock(&child->lock);
    child->taken[channel - child->channel] = false;
    pthread_cond_signal(&child->given);
    pthread_mutex_unlock(&child->lock);
}

/* ---- what goes wrong ----------------------------------------------------------------------------------- */

typedef enum Fault { FAULT_ENDED, FAULT_SILENT, FAULT_NONSENSE, FAULT_STOP } Fault;

/* The file that the reader says it works at. It may say anything, so the text is made safe. */
static void file_at(char out[wire_path_size], const WireChannel *channel)
{
    memcpy(out, channel->at, wire_path_size);
    out[wire_path_size - 1] = 0;
    if (!*out) snprintf(out, wire_path_size, "a file");
}

/* Gives up a reader. The first thread that notices ends the process and logs why; other threads may come here at the
 * same time or later. */
static void give_up(RasterChild *child, const WireChannel *channel, Fault fault)
{
    char path[wire_path_size], key[wire_key_size];
    pthread_mutex_lock(&child->lock);
    if (!child->dead) {
        child->dead = true;
        const int how = end_process(child), number = WIFSIGNALED(how) ? WTERMSIG(how) : WEXITSTATUS(how);
        file_at(path, channel);
        memcpy(key, channel->request.key, sizeof key);
        key[sizeof key - 1] = 0;
        const bool  vectors = channel->request.ask == WIRE_VECTORS || channel->request.ask == WIRE_FEATURES;
        const char *copies = vectors ? "ogr2ogr" : "gdal_translate";
        if (fault == FAULT_SILENT)
            log_error(
                "%s: %s: its reader did nothing for %.0f s and was ended: the file is broken, or its disk does not answer; "
                "%s makes a plain copy: %s %s",
                key, path, atomic_load(&patience_s), copies, copies, vectors ? "OUT.gpkg FILE" : "FILE OUT.tif");
        else if (fault == FAULT_NONSENSE)
            log_error(
                "%s: %s: its reader sent what no reader sends, and was ended: the file is broken or hostile; leave it out",
                key, path);
        else if (fault == FAULT_ENDED)
            log_error(
                "%s: %s: its reader broke off (%s %d): the file is broken, or needs more than %d MB; fetch it again, or %s",
                key, path, WIFSIGNALED(how) ? "signal" : "exit", number, (int)raster_most_memory_mb,
                vectors ? "cut out an area: ogr2ogr -spat WEST SOUTH EAST NORTH OUT.gpkg FILE"
                        : "gdal_translate -co TILED=YES FILE OUT.tif");
    }
    pthread_mutex_unlock(&child->lock);
}

Status raster_child_distrust(RasterChild *child, WireChannel *channel)
{
    give_up(child, channel, FAULT_NONSENSE);
    return STATUS_BAD_VALUE;
}

/* ---- requests ------------------------------------------------------------------------------------------ */

/* Logs what the reader had to say. */
static void relay(const WireChannel *channel)
{
    if (!*(const volatile char *)channel->log) return;
    char *said = malloc(wire_log_octets + 2);
    if (!said) return;
    memcpy(said, channel->log, wire_log_octets);
    said[wire_log_octets] = said[wire_log_octets + 1] = 0;
    for (const char *at = said; at[0] && at[1]; at += strlen(at) + 1) {
        if (at[0] == '0' + LOG_ERROR) log_error("%s", at + 1);
        else if (at[0] == '0' + LOG_WARN) log_warn("%s", at + 1);
        else if (at[0] == '0' + LOG_INFO) log_info("%s", at + 1);
        else log_detail("%s", at + 1);
    }
    free(said);
}

static bool is_dead(RasterChild *child)
{
    pthread_mutex_lock(&child->lock);
    const bool dead = child->dead;
    pthread_mutex_unlock(&child->lock);
    return dead;
}

Status raster_child_ask(RasterChild *child, WireChannel *channel, WireReply *reply)
{
    enum { look_ms = 100 };
    const int socket = child->socket[channel - child->channel];
    char      octet = 1;
    if (is_dead(child)) return STATUS_IO;
    channel->reply = (WireReply){.status = STATUS_IO};
    channel->log[0] = 0;
    if (send(socket, &octet, 1, MSG_NOSIGNAL) != 1) {
        give_up(child, channel, FAULT_ENDED);
        return STATUS_IO;
    }
    uint64_t alive = 0;
    double   alive_s = wall_clock_s();
    for (;;) {
        struct pollfd wait = {.fd = socket, .events = POLLIN};
        const int     ready = poll(&wait, 1, look_ms);
        if (ready > 0) {
            const ssize_t got = recv(socket, &octet, 1, MSG_DONTWAIT);
            if (got == 1) break;
            if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
            give_up(child, channel, FAULT_ENDED);
            return STATUS_IO;
        }
        if (work_stop_asked()) {
            give_up(child, channel, FAULT_STOP);
            return STATUS_IO;
        }
        const uint64_t now = *(const volatile uint64_t *)&channel->alive;
        if (now != alive) alive_s = wall_clock_s();
        alive = now;
        if (is_dead(child)) return STATUS_IO;
        if (wall_clock_s() - alive_s > atomic_load(&patience_s)) {
            give_up(child, channel, FAULT_SILENT);
            return STATUS_IO;
        }
    }
    memcpy(reply, &channel->reply, sizeof *reply);
    relay(channel);
    if (reply->status < STATUS_OK || reply->status > STATUS_NO_MEMORY) return raster_child_distrust(child, channel);
    return STATUS_OK;
}
