/* pitviper_confine.c: limits, Landlock and a seccomp filter for a process that reads other people's files. */
#include "pitviper_confine.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

void confine_limits(uint64_t more_octets)
{
    const struct rlimit none = {0, 0};
    setrlimit(RLIMIT_CORE, &none);
    setrlimit(RLIMIT_FSIZE, &none);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    FILE         *statm = fopen("/proc/self/statm", "r");
    unsigned long pages = 0;
    if (statm && fscanf(statm, "%lu", &pages) != 1) pages = 0;
    if (statm) fclose(statm);
    if (pages > 0 && more_octets > 0) {
        const rlim_t        most = (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + more_octets;
        const struct rlimit memory = {most, most};
        setrlimit(RLIMIT_AS, &memory);
    }
#else
    (void)more_octets;
#endif
}

static bool failed(char why[confine_why_size], const char *call)
{
    snprintf(why, confine_why_size, "%s: %s", call, strerror(errno));
    return false;
}

/* ---- Landlock ------------------------------------------------------------------------------------------ */

/* Of <linux/landlock.h>, which may be older than the kernel. */
enum {
    call_create_ruleset = 444,
    call_add_rule = 445,
    call_restrict_self = 446,
    want_version = 1 << 0,
    rule_path_beneath = 1,
    right_read_file = 1 << 2,
    right_read_folder = 1 << 3,
};
typedef struct LandlockRuleset {
    uint64_t files, network, scoped;
} LandlockRuleset;
typedef struct __attribute__((packed)) LandlockBeneath {
    uint64_t rights;
    int32_t  folder;
} LandlockBeneath;

bool confine_files(char why[confine_why_size], const char *const *readable, int count)
{
    const long version = syscall(call_create_ruleset, NULL, 0, want_version);
    if (version < 1) return failed(why, "Landlock");
    /* all that this version can forbid: 13 rights over files at first, then moving between folders, truncating, ioctl
     * of devices; TCP ports from 4 on; abstract sockets and signals from 6 on */
    const int       file_rights = version >= 5 ? 16 : version >= 3 ? 15 : version == 2 ? 14 : 13;
    LandlockRuleset all = {(1u << file_rights) - 1, version >= 4 ? 3 : 0, version >= 6 ? 3 : 0};
    const size_t size = version >= 6 ? sizeof all : version >= 4 ? offsetof(LandlockRuleset, scoped) : sizeof all.files;
    const int    set = (int)syscall(call_create_ruleset, &all, size, 0);
    if (set < 0) return failed(why, "landlock_create_ruleset");
    bool good = true;
    for (int k = 0; good && k < count; k++) {
        struct stat     about;
        LandlockBeneath rule = {.folder = open(readable[k], O_PATH | O_CLOEXEC)};
        if (rule.folder < 0) continue;
        if (fstat(rule.folder, &about) == 0 && (S_ISREG(about.st_mode) || S_ISDIR(about.st_mode))) {
            rule.rights = S_ISDIR(about.st_mode) ? right_read_file | right_read_folder : right_read_file;
            good = syscall(call_add_rule, set, rule_path_beneath, &rule, 0) == 0 || failed(why, "landlock_add_rule");
        }
        close(rule.folder);
    }
    if (good) good = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 || failed(why, "no_new_privs");
    if (good) good = syscall(call_restrict_self, set, 0) == 0 || failed(why, "landlock_restrict_self");
    close(set);
    return good;
}

/* ---- system calls -------------------------------------------------------------------------------------- */

#if defined(__x86_64__)
enum { this_machine = (int)AUDIT_ARCH_X86_64 };
#elif defined(__aarch64__)
enum { this_machine = (int)AUDIT_ARCH_AARCH64 };
#else
#error "pitviper_confine.c: name this machine's AUDIT_ARCH"
#endif

/* Calls that are allowed with any arguments. */
static const int harmless[] = {
    /* files and descriptors that are there */
    SYS_read,
    SYS_write,
    SYS_readv,
    SYS_writev,
    SYS_pread64,
    SYS_preadv,
    SYS_lseek,
    SYS_close,
    SYS_close_range,
    SYS_fstat,
    SYS_newfstatat,
    SYS_statx,
    SYS_faccessat,
    SYS_faccessat2,
    SYS_readlinkat,
    SYS_getdents64,
    SYS_getcwd,
    SYS_statfs,
    SYS_fstatfs,
    SYS_fcntl,
    SYS_dup,
    SYS_dup3,
    SYS_fadvise64,
    SYS_readahead,
    SYS_flock,
    SYS_umask,
    /* waiting */
    SYS_ppoll,
    SYS_pselect6,
    SYS_pipe2,
    SYS_eventfd2,
    SYS_epoll_create1,
    SYS_epoll_ctl,
    SYS_epoll_pwait,
    SYS_futex,
    SYS_nanosleep,
    SYS_clock_nanosleep,
    SYS_restart_syscall,
    /* memory */
    SYS_mmap,
    SYS_munmap,
    SYS_mremap,
    SYS_mprotect,
    SYS_madvise,
    SYS_brk,
    SYS_mincore,
    SYS_membarrier,
    SYS_mlock,
    SYS_munlock,
    /* threads, signals of this process, time, what the machine is */
    SYS_set_robust_list,
    SYS_get_robust_list,
    SYS_rseq,
    SYS_set_tid_address,
    SYS_gettid,
    SYS_getpid,
    SYS_getppid,
    SYS_getuid,
    SYS_geteuid,
    SYS_getgid,
    SYS_getegid,
    SYS_getpgid,
    SYS_sched_yield,
    SYS_sched_getaffinity,
    SYS_sched_getparam,
    SYS_sched_getscheduler,
    SYS_sched_get_priority_max,
    SYS_sched_get_priority_min,
    SYS_getpriority,
    SYS_getcpu,
    SYS_rt_sigaction,
    SYS_rt_sigprocmask,
    SYS_rt_sigreturn,
    SYS_sigaltstack,
    SYS_clock_gettime,
    SYS_clock_getres,
    SYS_gettimeofday,
    SYS_getrusage,
    SYS_times,
    SYS_uname,
    SYS_sysinfo,
    SYS_getrandom,
    SYS_getrlimit,
    SYS_exit,
    SYS_exit_group,
#if defined(__x86_64__)
    SYS_stat,
    SYS_lstat,
    SYS_access,
    SYS_readlink,
    SYS_getdents,
    SYS_dup2,
    SYS_poll,
    SYS_select,
    SYS_pipe,
    SYS_epoll_wait,
    SYS_time,
    SYS_arch_prctl,
#endif
};

typedef struct Filter {
    struct sock_filter step[400];
    int                count;
} Filter;

static void put(Filter *f, uint16_t code, uint32_t k, uint8_t yes, uint8_t no)
{
    f->step[f->count++] = (struct sock_filter)BPF_JUMP(code, k, yes, no);
}

/* Loads half of an argument, 0 the low one, which comes first on these machines. */
static void load_argument(Filter *f, int number, uint32_t half)
{
    put(f, BPF_LD | BPF_W | BPF_ABS, (uint32_t)offsetof(struct seccomp_data, args) + 8 * (uint32_t)number + 4 * half, 0,
        0);
}

static void put_return(Filter *f, uint32_t action) { put(f, BPF_RET | BPF_K, action, 0, 0); }

static uint32_t fails_with(int error) { return SECCOMP_RET_ERRNO | (uint32_t)error; }

/* Decides a call of this number: it is allowed when (argument & mask) == value; else it fails. */
static void put_if(Filter *f, int call, int argument, uint32_t mask, uint32_t value, int error)
{
    put(f, BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)call, 0, 5);
    load_argument(f, argument, 0);
    put(f, BPF_ALU | BPF_AND | BPF_K, mask, 0, 0);
    put(f, BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1);
    put_return(f, SECCOMP_RET_ALLOW);
    put_return(f, fails_with(error));
}

bool confine_calls(char why[confine_why_size])
{
    enum { newest = 463 }; /* above it: calls that C libraries of later years try first, and do without */
    Filter         f = {.count = 0};
    const uint32_t writing = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND | (O_TMPFILE & ~O_DIRECTORY);
    const uint32_t thread = CLONE_VM | CLONE_THREAD | CLONE_SIGHAND;
    put(&f, BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, arch), 0, 0);
    put(&f, BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)this_machine, 1, 0);
    put_return(&f, fails_with(EPERM));
    put(&f, BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr), 0, 0);
    for (size_t k = 0; k < sizeof harmless / sizeof *harmless; k++) {
        put(&f, BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)harmless[k], 0, 1);
        put_return(&f, SECCOMP_RET_ALLOW);
    }
    put_if(&f, SYS_openat, 2, writing, 0, EACCES);
#if defined(__x86_64__)
    put_if(&f, SYS_open, 1, writing, 0, EACCES);
#endif
    put_if(&f, SYS_clone, 0, thread, thread, EPERM);
    put_if(&f, SYS_tgkill, 0, UINT32_MAX, (uint32_t)getpid(), EPERM); /* abort() */
    put_if(&f, SYS_prctl, 0, UINT32_MAX, PR_SET_NAME, EPERM);         /* sets names of threads */
    put(&f, BPF_JMP | BPF_JEQ | BPF_K, SYS_prlimit64, 0, 6);          /* only reading of limits is allowed */
    for (uint32_t half = 0; half < 2; half++) {
        load_argument(&f, 2, half);
        put(&f, BPF_JMP | BPF_JEQ | BPF_K, 0, 0, half ? 1 : 3);
    }
    put_return(&f, SECCOMP_RET_ALLOW);
    put_return(&f, fails_with(EPERM));
    put(&f, BPF_JMP | BPF_JEQ | BPF_K, SYS_clone3, 1, 0); /* its flags are out of a filter's sight */
    put(&f, BPF_JMP | BPF_JGT | BPF_K, newest, 0, 1);
    put_return(&f, fails_with(ENOSYS));
    put_return(&f, fails_with(EPERM));
    const struct sock_fprog program = {.len = (unsigned short)f.count, .filter = f.step};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return failed(why, "no_new_privs");
    return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0 || failed(why, "seccomp");
}

bool confine_network(char why[confine_why_size])
{
    enum { other_abi = 0x40000000 }; /* x32: the same calls by other numbers */
    Filter f = {.count = 0};
    put(&f, BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, arch), 0, 0);
    put(&f, BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)this_machine, 1, 0);
    put_return(&f, fails_with(EPERM));
    put(&f, BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr), 0, 0);
    put(&f, BPF_JMP | BPF_JGE | BPF_K, other_abi, 3, 0);
    put(&f, BPF_JMP | BPF_JEQ | BPF_K, SYS_socket, 2, 0);
    put(&f, BPF_JMP | BPF_JEQ | BPF_K, SYS_io_uring_setup, 1, 0); /* would allow sockets, too */
    put_return(&f, SECCOMP_RET_ALLOW);
    put_return(&f, fails_with(EPERM));
    const struct sock_fprog program = {.len = (unsigned short)f.count, .filter = f.step};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return failed(why, "no_new_privs");
    return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0 || failed(why, "seccomp");
}
