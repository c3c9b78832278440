/* sensor/verify/regress/case_child.c: runs this program as a child process with output in files and a time limit. */
#include "sensor/verify/regress/run_case.h"
#include "pitviper_output.h"

#include "pitviper_confine.h"
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

static bool begins(const char *text, const char *head) { return strncmp(text, head, strlen(head)) == 0; }

/* Whether a variable of this process goes on to a child. apart: without its display. */
static bool is_kept(const char *variable, bool etc, bool apart)
{
    static const char *const never[] = {"LC_", "LANG", "TZ="}, *const shown[] = {"DISPLAY=", "WAYLAND_DISPLAY="};
    bool kept = !(etc && begins(variable, "PITVIPER_ETC="));
    for (int i = 0; i < 3; i++) kept = kept && !begins(variable, never[i]);
    for (int i = 0; i < 2; i++) kept = kept && !(apart && begins(variable, shown[i]));
    return kept;
}

/* Copies the environment of this process, with LC_ALL=C and TZ=UTC. etc: `PITVIPER_ETC=...`; empty: it is unset; NULL:
 * as it is. */
static char **environment(char *etc, bool apart)
{
    static char locale[] = "LC_ALL=C", zone[] = "TZ=UTC";
    size_t      count = 0, n = 0;
    while (environ[count]) count++;
    char **out = calloc(count + 4, sizeof *out);
    for (size_t i = 0; out && i < count; i++)
        if (is_kept(environ[i], etc != NULL, apart)) out[n++] = environ[i];
    if (out) {
        out[n++] = locale;
        out[n++] = zone;
        out[n] = etc && *etc ? etc : NULL;
    }
    return out;
}

/* A program of others, by fork: between that and exec only calls that are safe after it. Returns errno. */
static int spawn_apart(pid_t *child, const ChildLine *line, const int file[2], char *const *with)
{
    sigset_t none;
    sigemptyset(&none);
    *child = fork();
    if (*child < 0) return errno;
    if (*child > 0) return 0;
    char      why[confine_why_size];
    const int nothing = open("/dev/null", O_RDONLY);
    setpgid(0, 0);
    for (int number = 1; number < NSIG; number++)
        if (number != SIGKILL && number != SIGSTOP && number != SIGHUP) signal(number, SIG_DFL);
    sigprocmask(SIG_SETMASK, &none, NULL);
    dup2(nothing, STDIN_FILENO);
    dup2(file[0], STDOUT_FILENO);
    dup2(file[1], STDERR_FILENO);
    static const char no_folder[] = "cannot enter the folder of the case\n",
                      no_filter[] = "cannot be kept from the network\n";
    if (line->folder && chdir(line->folder) != 0) {
        if (write(STDERR_FILENO, no_folder, sizeof no_folder - 1) < 0) _exit(125);
        _exit(126);
    }
    if (!confine_network(why)) {
        if (write(STDERR_FILENO, no_filter, sizeof no_filter - 1) < 0) _exit(125);
        _exit(126);
    }
    execve(line->program, (char *const *)(uintptr_t)line->argument, (char *const *)with);
    _exit(127);
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
    char **with = failure ? NULL : environment(line->tables ? etc : NULL, line->apart);
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
    if (line->apart) failure = spawn_apart(child, line, (const int[2]){out, error}, with);
    else
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
    for (siginfo_t ended = {0};;) { /* it is not reaped yet: its number still names its process group */
        const int got = waitid(P_PID, (id_t)child, &ended, WEXITED | WNOHANG | WNOWAIT);
        if (got == 0 && ended.si_pid == child) break;
        if (got < 0 && errno != EINTR) {
            log_error("regress: lost %s %s: %s", line->argument[0], line->argument[1], strerror(errno));
            return STATUS_IO;
        }
        end->timed_out = wall_clock_s() - begun_s > timeout_s;
        end->stopped = stop_asked();
        if (end->timed_out || end->stopped) break;
        nanosleep(&(struct timespec){0, 5000000}, NULL);
    }
    kill(-child, SIGKILL);                                    /* also what it left behind */
    if (end->timed_out || end->stopped) kill(child, SIGKILL); /* in case it has no process group yet */
    while (waitpid(child, &state, 0) < 0 && errno == EINTR) {
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
    const char *gap = "";
    *out = 0;
    if (line->folder) {
        n = put_word(out, n, out_size, "cd ", line->folder);
        gap = " && ";
    }
    if (line->tables) {
        if (n + 8 < out_size) n += (size_t)snprintf(out + n, out_size - n, "%s", gap);
        n = put_word(out, n, out_size, *line->tables ? "PITVIPER_ETC=" : "env -u ",
                     *line->tables ? line->tables : "PITVIPER_ETC");
        gap = " ";
    }
    for (int i = 0; i < line->count; i++, gap = " ") {
        const char *text = i > 0 ? line->argument[i] : line->program ? line->program : got > 0 ? self : "pitviper";
        n = put_word(out, n, out_size, gap, text);
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
