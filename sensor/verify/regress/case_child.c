/* sensor/verify/regress/case_child.c: runs this program as a child process with output in files and a time limit. */
#include "sensor/verify/regress/run_case.h"
#include "pitviper_output.h"

#include "pitviper_file.h"
#include "sensor/node/run/stop.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

bool case_child_add(ChildLine *line, const char *argument)
{
    if (line->count == child_arguments_max) return false;
    line->argument[line->count++] = argument;
    line->argument[line->count] = NULL;
    return true;
}

/* Copies the environment of this process, with LC_ALL=C and TZ=UTC. etc: `PITVIPER_ETC=...`; empty: it is unset; NULL:
 * as it is. */
static char **environment(char *etc)
{
    static char locale[] = "LC_ALL=C", zone[] = "TZ=UTC";
    size_t      count = 0, n = 0;
    while (environ[count]) count++;
    char **out = calloc(count + 4, sizeof *out);
    for (size_t i = 0; out && i < count; i++)
        if (strncmp(environ[i], "LC_", 3) != 0 && strncmp(environ[i], "LANG", 4) != 0 &&
            strncmp(environ[i], "TZ=", 3) != 0 && !(etc && strncmp(environ[i], "PITVIPER_ETC=", 13) == 0))
            out[n++] = environ[i];
    if (out) {
        out[n++] = locale;
        out[n++] = zone;
        out[n] = etc && *etc ? etc : NULL;
    }
    return out;
}

static int spawn(pid_t *child, const ChildLine *line, const char *out_path, const char *error_path)
{
    char                       etc[case_path_size + 16] = "";
    posix_spawn_file_actions_t files;
    posix_spawnattr_t          how;
    sigset_t                   none, usual;
    const int                  out = output_open(out_path, 0);
    const int                  error = out >= 0 ? output_open(error_path, 0) : -1;
    int                        failure = error < 0 ? errno : 0;
    if (line->tables && *line->tables) snprintf(etc, sizeof etc, "PITVIPER_ETC=%.4095s", line->tables);
    char **with = failure ? NULL : environment(line->tables ? etc : NULL);
    if (!with) {
        if (out >= 0) close(out);
        if (error >= 0) close(error);
        return failure ? failure : ENOMEM;
    }
    sigemptyset(&none);
    sigfillset(&usual);
    sigdelset(&usual, SIGHUP); /* nohup stays */
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files, error, STDERR_FILENO);
    posix_spawnattr_init(&how);
    posix_spawnattr_setflags(&how, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setpgroup(&how, 0);
    posix_spawnattr_setsigmask(&how, &none);
    posix_spawnattr_setsigdefault(&how, &usual);
    failure = posix_spawn(child, line->program ? line->program : "/proc/self/exe", &files, &how,
                          (char *const *)line->argument, with);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&how);
    close(out);
    close(error);
    free(with);
    return failure;
}

Status case_child_run(ChildEnd *end, const ChildLine *line, const char *out_path, const char *error_path,
                      double timeout_s)
{
    const double begun_s = wall_clock_s();
    pid_t        child;
    int          state = 0;
    *end = (ChildEnd){0};
    const int failure = spawn(&child, line, out_path, error_path);
    if (failure) {
        log_error("regress: cannot start %s %s: %s", line->argument[0], line->argument[1], strerror(failure));
        return STATUS_IO;
    }
    for (pid_t got; (got = waitpid(child, &state, WNOHANG)) != child;) {
        if (got < 0 && errno != EINTR) {
            log_error("regress: lost %s %s: %s", line->argument[0], line->argument[1], strerror(errno));
            return STATUS_IO;
        }
        end->timed_out = wall_clock_s() - begun_s > timeout_s;
        end->stopped = stop_asked();
        if (end->timed_out || end->stopped) {
            kill(-child, SIGKILL);
            kill(child, SIGKILL); /* in case it has no process group yet */
            while (waitpid(child, &state, 0) < 0 && errno == EINTR) {
            }
            break;
        }
        nanosleep(&(struct timespec){0, 5000000}, NULL);
    }
    end->signal = WIFSIGNALED(state) ? WTERMSIG(state) : 0;
    end->code = WIFEXITED(state) ? WEXITSTATUS(state) : 0;
    end->seconds = wall_clock_s() - begun_s;
    return STATUS_OK;
}

static bool plain(const char *text)
{
    return *text &&
           strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%") == strlen(text);
}

/* Appends a word, after `before`. Returns the new length. */
static size_t put_word(char *out, size_t n, size_t out_size, const char *before, const char *text)
{
    if (n + 8 >= out_size) return n;
    n += (size_t)snprintf(out + n, out_size - n, plain(text) ? "%s" : "%s'", before);
    if (n + 8 < out_size && plain(text)) return n + strlen(strncat(out + n, text, out_size - n - 1));
    for (const char *c = text; *c && n + 8 < out_size; c++)
        n += (size_t)snprintf(out + n, out_size - n, *c == '\'' ? "'\\''" : "%c", *c);
    return n + (n + 2 < out_size ? (size_t)snprintf(out + n, out_size - n, "'") : 0);
}

void case_child_text(char *out, size_t out_size, const ChildLine *line)
{
    char          self[PATH_MAX];
    const ssize_t got = readlink("/proc/self/exe", self, sizeof self - 1);
    size_t        n = 0;
    self[got > 0 ? got : 0] = 0;
    *out = 0;
    if (line->tables && *line->tables) n = put_word(out, n, out_size, "PITVIPER_ETC=", line->tables);
    else if (line->tables) n = put_word(out, n, out_size, "env -u ", "PITVIPER_ETC");
    for (int i = 0; i < line->count; i++) {
        const char *text = i > 0 ? line->argument[i] : line->program ? line->program : got > 0 ? self : "pitviper";
        n = put_word(out, n, out_size, n ? " " : "", text);
    }
}

void case_child_tail(char *out, size_t out_size, const char *path)
{
    char  why[file_why_size];
    FILE *file = file_open_stream(why, path);
    *out = 0;
    if (!file) return;
    if (fseek(file, 0, SEEK_END) == 0) {
        const long octets = ftell(file), from = octets > (long)out_size - 1 ? octets - (long)out_size + 1 : 0;
        if (octets > 0 && fseek(file, from, SEEK_SET) == 0) {
            const size_t got = fread(out, 1, out_size - 1, file);
            out[got] = 0;
            for (size_t i = 0; i < got; i++) /* output of libraries may hold any octet */
                if ((out[i] < ' ' && out[i] != '\n') || out[i] == 0x7f || (unsigned char)out[i] >= 0x80) out[i] = '?';
            const char *line = from > 0 ? strchr(out, '\n') : NULL;
            if (line) memmove(out, line + 1, strlen(line));
        }
    }
    fclose(file);
}
