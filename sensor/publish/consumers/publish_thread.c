/* sensor/publish/consumers/publish_thread.c: threads that publish: their precedence over rendering, and their end. */
#include "sensor/publish/consumers/consumer.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

/* ---- precedence ---------------------------------------------------------------------------------- */

/* struct sched_attr of sched_setattr(2), for which glibc has no declaration. */
typedef struct SchedAttributes {
    uint32_t size, policy;
    uint64_t flags;
    int32_t  nice;
    uint32_t priority;
    uint64_t runtime_ns, deadline_ns, period_ns;
} SchedAttributes;

/* Without rights (RLIMIT_NICE, CAP_SYS_NICE) the niceness stays as it is; the slice needs none. Kernels from 6.12 on
 * let a thread of a shorter slice run as soon as it wakes up, others ignore it. */
void publish_urgent(void)
{
    enum { nicer = 10, least_nice = -20 };
    static const uint64_t slice_ns = 500000; /* the kernel's own is some 3 ms */
    const int             nice = getpriority(PRIO_PROCESS, 0);
    const int             wanted = nice - nicer > least_nice ? nice - nicer : least_nice;
    const pid_t           thread = (pid_t)syscall(SYS_gettid);
    const int             had = setpriority(PRIO_PROCESS, (id_t)thread, wanted) == 0 ? wanted : nice;
    SchedAttributes attributes = {.size = sizeof attributes, .nice = had, .runtime_ns = slice_ns}; /* SCHED_OTHER: 0 */
    syscall(SYS_sched_setattr, thread, &attributes, 0);
}

/* ---- their start and their end ------------------------------------------------------------------- */

bool publish_thread(pthread_t *out, void *(*work)(void *user), void *user)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const bool started = pthread_create(out, NULL, work, user) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return started;
}

static atomic_bool hangs;

bool publish_hangs(void) { return atomic_load(&hangs); }

bool publish_ended(pthread_t thread, const _Atomic uint64_t *steps, const char *what)
{
    const double patience_s = publish_hangs() ? 0.5 : 5; /* what hangs is mostly one disk */
    uint64_t     seen = atomic_load(steps);
    double       since_s = wall_clock_s();
    for (;;) {
        struct timespec until;
        clock_gettime(CLOCK_REALTIME, &until);
        until.tv_nsec += 100000000;
        if (until.tv_nsec >= 1000000000) until.tv_nsec -= 1000000000, until.tv_sec++;
        if (pthread_timedjoin_np(thread, NULL, &until) == 0) return true;
        const uint64_t now = atomic_load(steps);
        if (now != seen) seen = now, since_s = wall_clock_s();
        if (wall_clock_s() - since_s < patience_s) continue;
        log_error("session: %s: the system has taken nothing for %g s; given up, its last frames are not there", what,
                  patience_s);
        atomic_store(&hangs, true);
        return false;
    }
}
