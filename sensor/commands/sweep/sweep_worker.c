/* sensor/commands/sweep/sweep_worker.c: the process that makes a sweep's variants, one after another, and what the
 * sweep tells it. */
#include "sensor/commands/sweep/sweep_private.h"

#include "pitviper_output.h"
#include "sensor/node/run/stop.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

const char sweep_worker_option[] = "--variants";

/* A variant as it is told: octets of what follows, then texts that end with 0: the file of its messages and the words
 * of its command line. The answer is its exit code. */
enum { told_most = 1 << 20, words_most = options_variant_argv + 1 };

/* False: the other end has gone, or a stop was asked for. */
static bool receive(int from, void *octets, size_t count)
{
    for (char *at = octets; count > 0;) {
        const ssize_t got = recv(from, at, count, 0);
        if (got < 0 && errno == EINTR && !stop_asked()) continue;
        if (got <= 0) return false;
        at += got, count -= (size_t)got;
    }
    return true;
}

static bool transmit(int to, const void *octets, size_t count)
{
    for (const char *at = octets; count > 0;) {
        const ssize_t put = send(to, at, count, MSG_NOSIGNAL);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return false;
        at += put, count -= (size_t)put;
    }
    return true;
}

/* ---- the worker ------------------------------------------------------------------------------------- */

/* Standard output and error go there. A file that they went to before is closed, and may be opened again. */
static bool speak_into(const char *path)
{
    const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    fflush(stdout);
    clearerr(stdout);
    if (nowhere >= 0) dup2(nowhere, 1), dup2(nowhere, 2), close(nowhere);
    const int file = path ? output_open(path, 0) : -1;
    if (file < 0) return !path;
    const bool good = dup2(file, 1) == 1 && dup2(file, 2) == 2;
    close(file);
    return good;
}

/* The texts of a variant. NULL: there is none any more. */
static char *next_variant(char *word[words_most + 1], int from)
{
    uint32_t octets;
    int      words = 0;
    if (!receive(from, &octets, sizeof octets) || octets == 0 || octets > told_most) return NULL;
    char *told = malloc(octets);
    if (!told || !receive(from, told, octets) || told[octets - 1]) {
        free(told);
        return NULL;
    }
    for (char *at = told; at < told + octets && words < words_most; at += strlen(at) + 1) word[words++] = at;
    word[words] = NULL;
    return told;
}

int sweep_worker(SweepVariant *make)
{
    const int  sweep = fcntl(0, F_DUPFD_CLOEXEC, 3), nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
    MadeWorld *made = NULL;
    char      *word[words_most + 1], *told;
    if (sweep < 0 || nothing < 0 || dup2(nothing, 0) != 0 || made_world_create(&made) != STATUS_OK) return 1;
    close(nothing);
    while (!stop_asked() && (told = next_variant(word, sweep))) {
        int32_t code = 1;
        int     words = 0;
        while (word[words]) words++;
        if (words > 1 && speak_into(word[0])) code = make(words - 1, word + 1, made);
        speak_into(NULL);
        free(told);
        if (!transmit(sweep, &code, sizeof code)) break;
    }
    made_world_destroy(made);
    close(sweep);
    return 0;
}

/* ---- the sweep's side ------------------------------------------------------------------------------- */

/* said: the file of its messages until the first variant. */
static bool start(SweepWorker *w, const char *said)
{
    const char *const argv[] = {"pitviper", "replay", sweep_worker_option, log_is_verbose() ? "--verbose" : NULL, NULL};
    int               end[2];
    posix_spawn_file_actions_t files;
    const int                  log = output_open(said, 0);
    if (log < 0) log_error("sweep: cannot write %s: %s", said, output_reason(errno));
    if (log < 0) return false;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, end) != 0) {
        close(log);
        return false;
    }
    bool ready = posix_spawn_file_actions_init(&files) == 0;
    if (ready) {
        ready = posix_spawn_file_actions_adddup2(&files, end[1], 0) == 0 &&
                posix_spawn_file_actions_adddup2(&files, log, 1) == 0 &&
                posix_spawn_file_actions_adddup2(&files, log, 2) == 0 &&
                posix_spawn(&w->process, "/proc/self/exe", &files, NULL, (char *const *)argv, environ) == 0;
        posix_spawn_file_actions_destroy(&files);
    }
    close(log);
    close(end[1]);
    w->socket = end[0];
    w->there = ready;
    if (!ready) close(end[0]);
    return ready;
}

int sweep_worker_end(SweepWorker *w)
{
    int state = 0;
    if (!w->there) return -1;
    close(w->socket);
    while (waitpid(w->process, &state, 0) < 0 && errno == EINTR) {
    }
    w->there = false;
    return WIFEXITED(state) ? WEXITSTATUS(state) : -1;
}

static bool tell(const SweepWorker *w, const char *said, const char *const argv[])
{
    char  *text = NULL;
    size_t octets;
    FILE  *all = open_memstream(&text, &octets);
    if (!all) return false;
    fwrite(said, 1, strlen(said) + 1, all);
    for (int i = 0; argv[i]; i++) fwrite(argv[i], 1, strlen(argv[i]) + 1, all);
    bool           good = fclose(all) == 0 && octets <= told_most;
    const uint32_t count = (uint32_t)octets;
    good = good && transmit(w->socket, &count, sizeof count) && transmit(w->socket, text, octets);
    free(text);
    return good;
}

/* Passes on a stop as SIGTERM, so that the worker ends after its frame; Ctrl-C reaches it from the terminal. */
static bool wait_for(int32_t *code, const SweepWorker *w)
{
    bool          told = false;
    struct pollfd answer = {.fd = w->socket, .events = POLLIN};
    while (poll(&answer, 1, 50) <= 0) {
        if (stop_asked() && !told) kill(w->process, SIGTERM);
        told = stop_asked();
    }
    size_t got = 0;
    while (got < sizeof *code) {
        const ssize_t n = recv(w->socket, (char *)code + got, sizeof *code - got, 0);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        got += (size_t)n;
    }
    return true;
}

int sweep_worker_make(SweepWorker *w, const char *said, const char *const argv[])
{
    int32_t code;
    bool    told = w->there && tell(w, said, argv);
    if (!told) { /* none yet, or it was ended between two variants */
        sweep_worker_end(w);
        told = start(w, said) && tell(w, said, argv);
    }
    const bool answered = told && wait_for(&code, w);
    if (answered && code == 0) return 0;
    const int ended = sweep_worker_end(w); /* after a failure the next one begins anew */
    return answered ? code : ended == 0 ? 1 : ended;
}
