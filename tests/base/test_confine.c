/* tests/base/test_confine.c: a process that has confined itself is asked to do what it may not, and what it must still
 * do. The twin does the same without: there all of it works, so that what fails is refused by the confinement alone. */
#include "tests/check.h"

#include "pitviper_confine.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <sys/wait.h>

static char folder[64], inside[96], outside[96], made[96];

/* 0, or the error. */
static int result(long value) { return value < 0 ? errno : 0; }

static int closed(int file)
{
    const int error = result(file);
    if (file >= 0) close(file);
    return error;
}

static int try_inet(void) { return closed(socket(AF_INET, SOCK_STREAM, 0)); }
static int try_inet6(void) { return closed(socket(AF_INET6, SOCK_DGRAM, 0)); }
static int try_local(void) { return closed(socket(AF_UNIX, SOCK_STREAM, 0)); }
static int try_netlink(void) { return closed(socket(AF_NETLINK, SOCK_RAW, 0)); }

static int try_fork(void)
{
    const pid_t process = fork();
    if (process == 0) _exit(0);
    const int error = result(process);
    if (process > 0) waitpid(process, NULL, 0);
    return error;
}

static int try_exec(void) /* of what is no program: it comes back */
{
    char *const arguments[] = {inside, NULL};
    execv(inside, arguments);
    return errno == EACCES ? 0 : errno; /* not executable: it was asked for */
}

static int try_vfork(void) { return result(syscall(SYS_unshare, 0)); }
static int try_signal_to_parent(void) { return result(kill(getppid(), 0)); }
static int try_trace(void) { return result(ptrace(PTRACE_TRACEME, 0, NULL, NULL)); }
static int try_ring(void)
{
    char      parameters[256] = {0};
    const int file = (int)syscall(425, 4, parameters); /* io_uring_setup: it would open sockets past a filter */
    return file < 0 && errno == EPERM ? EPERM : closed(file < 0 ? open("/dev/null", O_RDONLY) : file);
}
static int try_write_file(void) { return closed(open(inside, O_WRONLY)); }
static int try_make_file(void)
{
    const int error = closed(open(made, O_CREAT | O_RDONLY, 0600));
    unlink(made);
    return error;
}
static int try_make_folder(void)
{
    const int error = result(mkdir(made, 0700));
    rmdir(made);
    return error;
}
static int try_remove(void) /* of what is not there */
{
    unlink(made);
    return unlink(made) < 0 && errno == ENOENT ? 0 : errno;
}
static int try_rename(void) { return rename(made, made) < 0 && errno == ENOENT ? 0 : errno; }
static int try_limit(void)
{
    struct rlimit limit;
    getrlimit(RLIMIT_CORE, &limit);
    return result(setrlimit(RLIMIT_CORE, &limit));
}
static int try_passwd(void) { return closed(open("/etc/passwd", O_RDONLY)); }
static int try_outside(void) { return closed(open(outside, O_RDONLY)); }
static int try_up(void)
{
    char path[128];
    snprintf(path, sizeof path, "%s/../../etc/passwd", folder);
    return closed(open(path, O_RDONLY));
}
static int try_link(void)
{
    char path[128];
    snprintf(path, sizeof path, "%s/link", folder);
    return closed(open(path, O_RDONLY));
}

static void *nothing(void *user) { return user; }
static int   try_thread(void)
{
    pthread_t thread;
    const int error = pthread_create(&thread, NULL, nothing, NULL);
    if (!error) pthread_join(thread, NULL);
    return error;
}
static int try_read(void)
{
    char      octets[8];
    const int file = open(inside, O_RDONLY);
    const int error = file < 0 || read(file, octets, sizeof octets) != 4 ? (errno ? errno : EIO) : 0;
    if (file >= 0) close(file);
    return error;
}
static int try_memory(void)
{
    char *block = malloc(64 << 20);
    if (!block) return ENOMEM;
    memset(block, 1, 64 << 20);
    block = realloc(block, 96 << 20);
    free(block);
    return block ? 0 : ENOMEM;
}
static int try_much_memory(void)
{
    void *block = mmap(NULL, 1000000000, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (block == MAP_FAILED) return errno;
    munmap(block, 1000000000);
    return 0;
}
static int try_time(void)
{
    struct timespec t = {0, 1000};
    return result(nanosleep(&t, NULL)) || !(wall_clock_s() > 0);
}
static int try_stat(void)
{
    struct stat about;
    return result(stat(outside, &about)); /* names may be looked at, not opened */
}

/* calls, files, limits: which confinement is asked to refuse it; none: it must go on working */
typedef enum Part { CALLS = 1, FILES = 2, LIMITS = 4 } Part;
static const struct Try {
    const char *what;
    int (*act)(void);
    int refused_by, perhaps_by; /* perhaps: by newer kernels' Landlock */
} tries[] = {
    {"a TCP socket", try_inet, CALLS, 0},
    {"a UDP socket", try_inet6, CALLS, 0},
    {"a local socket", try_local, CALLS, 0},
    {"a netlink socket", try_netlink, CALLS, 0},
    {"a process", try_fork, CALLS, 0},
    {"a program", try_exec, CALLS, 0},
    {"unshare", try_vfork, CALLS, 0},
    {"a signal to the parent", try_signal_to_parent, CALLS, FILES},
    {"ptrace", try_trace, CALLS, 0},
    {"io_uring", try_ring, CALLS, 0},
    {"a file opened for writing", try_write_file, CALLS | FILES, 0},
    {"a new file", try_make_file, CALLS | FILES, 0},
    {"a new folder", try_make_folder, CALLS | FILES, 0},
    {"removal", try_remove, CALLS, 0},
    {"renaming", try_rename, CALLS, 0},
    {"another limit", try_limit, CALLS, 0},
    {"/etc/passwd", try_passwd, FILES, 0},
    {"a file outside the folder", try_outside, FILES, 0},
    {"a file outside by ..", try_up, FILES, 0},
    {"a file outside by a link", try_link, FILES, 0},
    {"1 GB of address space", try_much_memory, LIMITS, 0},
    {"a thread", try_thread, 0, 0},
    {"a file inside the folder", try_read, 0, 0},
    {"64 MB", try_memory, 0, 0},
    {"time", try_time, 0, 0},
    {"stat", try_stat, 0, 0},
};
enum { try_count = sizeof tries / sizeof *tries };

/* The error of each, in a process that has confined itself so. */
static void tried(int error[try_count], int parts, bool *held)
{
    int ends[2], how;
    CHECK(pipe(ends) == 0);
    const pid_t process = fork();
    CHECK(process >= 0);
    if (process == 0) {
        char        why[confine_why_size];
        const char *readable[] = {folder, "/nowhere/at/all"};
        bool        landlock = true;
        if (parts & LIMITS) confine_limits(200000000);
        if (parts & FILES) landlock = confine_files(why, readable, 2);
        if (parts & CALLS && !confine_calls(why)) _exit(3);
        for (int n = 0; n < try_count; n++) {
            errno = 0;
            error[n] = tries[n].act();
        }
        if (write(ends[1], error, try_count * sizeof *error) != (ssize_t)(try_count * sizeof *error) ||
            write(ends[1], &landlock, sizeof landlock) != sizeof landlock)
            _exit(4);
        _exit(0);
    }
    CHECK(read(ends[0], error, try_count * sizeof *error) == (ssize_t)(try_count * sizeof *error));
    CHECK(read(ends[0], held, sizeof *held) == sizeof *held);
    CHECK(waitpid(process, &how, 0) == process && WIFEXITED(how) && WEXITSTATUS(how) == 0);
    close(ends[0]);
    close(ends[1]);
    unlink(made);
}

static void only_what_reading_needs_goes_on(void **state)
{
    (void)state;
    static const int parts[] = {0, CALLS, FILES, LIMITS, CALLS | FILES | LIMITS};
    for (size_t p = 0; p < sizeof parts / sizeof *parts; p++) {
        int  error[try_count];
        bool held = true;
        tried(error, parts[p], &held);
        if (!held) print_message("no Landlock here: files are not tried\n");
        for (int n = 0; n < try_count; n++) {
            int by = tries[n].refused_by & parts[p];
            if (!held) by &= ~FILES;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
            by &= ~LIMITS;
#endif
            const bool denied =
                error[n] == EPERM || error[n] == EACCES || error[n] == ENOSYS || (by & LIMITS && error[n] == ENOMEM);
            if (!by && denied && tries[n].perhaps_by & parts[p]) continue;
            if (by ? !denied : error[n] != 0)
                fail_msg("confined by %d: %s: %s", parts[p], tries[n].what, error[n] ? strerror(error[n]) : "it works");
        }
    }
}

/* A failed assertion of a library ends it as always: by its own signal. */
static void abort_is_an_abort(void **state)
{
    (void)state;
    int         how;
    const pid_t process = fork();
    CHECK(process >= 0);
    if (process == 0) {
        char why[confine_why_size];
        confine_limits(0);
        signal(SIGABRT, SIG_DFL);
        if (confine_calls(why)) abort();
        _exit(3);
    }
    CHECK(waitpid(process, &how, 0) == process && WIFSIGNALED(how) && WTERMSIG(how) == SIGABRT && !WCOREDUMP(how));
}

int main(void)
{
    char link[128];
    snprintf(folder, sizeof folder, "/tmp/pitviper-test-XXXXXX");
    if (!mkdtemp(folder)) return 1;
    snprintf(inside, sizeof inside, "%s/in", folder);
    snprintf(made, sizeof made, "%s/made", folder);
    snprintf(outside, sizeof outside, "%s-out", folder);
    snprintf(link, sizeof link, "%s/link", folder);
    FILE *in = fopen(inside, "w"), *out = fopen(outside, "w");
    if (!in || !out || fputs("here", in) < 0 || fputs("there", out) < 0 || fclose(in) || fclose(out) ||
        symlink(outside, link))
        return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_what_reading_needs_goes_on),
        cmocka_unit_test(abort_is_an_abort),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(inside);
    unlink(link);
    unlink(outside);
    rmdir(folder);
    return failed;
}
